//! Froude's side of the comparison with other programs.
//!
//! ```text
//! peer-bench make DIR ROWS      write the problem that both sides solve
//! peer-bench make-hour DIR S    write the long record of an axis, S seconds of it
//! peer-bench CASE DIR THREADS   solve it, print one line of JSON
//! ```
//!
//! Cases: `columns`, `forward-backward`, `harmonics`, `resample`, `hour`. The problem and the peers are described in `bench/peers/README.md`.

mod hour;
mod make;
mod meter;
mod signals;

use std::error::Error;
use std::num::NonZeroUsize;
use std::path::Path;

use froude_fit::stream::reduce_columns;
use meter::{Row, measure};

type Outcome<T> = Result<T, Box<dyn Error + Send + Sync>>;

fn main() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [case, dir, number] = &arguments[..] else {
        return Err("usage: peer-bench make DIR ROWS | peer-bench CASE DIR THREADS".into());
    };
    let dir = Path::new(dir);
    if case == "make" {
        return make::make(dir, number.parse::<f64>()? as usize);
    }
    if case == "make-hour" {
        return hour::make(dir, number.parse()?);
    }
    let threads: NonZeroUsize = number.parse()?;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads.get()).build()?;
    let row = pool.install(|| match case.as_str() {
        "columns" => columns(dir),
        "forward-backward" => signals::filter(dir),
        "harmonics" => signals::harmonics(dir),
        "resample" => signals::resample(dir),
        "hour" => hour::identify(dir),
        other => Err(format!("there is no case {other}").into()),
    })?;
    println!("{}", row.json(case, threads.get()));
    Ok(())
}

/// The ten regressors of the drag-like problem, and the response.
#[inline]
fn design([u, v, theta, w, y]: [f64; 5]) -> [f64; 11] {
    let (uu, vv, ww) = (u * u.abs(), v * v.abs(), w * w.abs());
    [u, uu, v, vv, w, ww, theta, v * u.abs(), u * v.abs(), 1.0, y]
}

/// The five raw columns, read from `dir`.
fn raw(dir: &Path) -> Outcome<[Vec<f64>; 5]> {
    let [u, v, theta, w, y] = make::RAW.map(|name| make::read(&dir.join(name)));
    Ok([u?, v?, theta?, w?, y?])
}

/// The eleven columns in memory.
fn in_memory(dir: &Path, limit: usize) -> Outcome<Vec<Vec<f64>>> {
    let raw = raw(dir)?;
    let n = raw[0].len().min(limit);
    let mut columns: Vec<Vec<f64>> = (0..11).map(|_| make::on_huge_pages(n)).collect();
    for column in &mut columns { column.resize(n, 0.0); }
    for i in 0..n {
        for (column, value) in columns.iter_mut().zip(design(std::array::from_fn(|k| raw[k][i]))) {
            column[i] = value;
        }
    }
    Ok(columns)
}

fn columns(dir: &Path) -> Outcome<Row> {
    let columns = in_memory(dir, usize::MAX)?;
    let all: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
    measure(9, || {
        Ok(reduce_columns(&all[..10], &all[10..])?.solve(0)?.coefficients)
    })
}

/// The eight regressors of the force record that `verb.py` reads, and both forces.
#[inline]
fn force_row([fx, fy, vx, vy, theta, omega]: [f64; 6]) -> [f64; 10] {
    let (s, c) = theta.sin_cos();
    let (u, v) = (c * vx + s * vy, c * vy - s * vx);
    let (uu, vv, ww) = (u * u.abs(), v * v.abs(), omega * omega.abs());
    [u, uu, v, vv, omega, ww, v * u.abs(), u * v.abs(), fx, fy]
}
