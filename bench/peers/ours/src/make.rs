//! The problem that both sides solve, written once.

use std::fmt::Write as _;
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

use crate::{Outcome, design, force_row};

/// Raw columns: little-endian doubles, one file each.
pub const RAW: [&str; 5] = ["u.f64", "v.f64", "theta.f64", "w.f64", "y.f64"];

/// True coefficients of the ten regressors, noise 0.1: those of a drag fit.
const TRUE: [f64; 10] = [0.02, 1.2, 0.4, 2.2, 0.01, 0.6, 0.0, 1.5, 0.3, 0.05];

/// True coefficients of the force along x; along y they are reversed.
const FORCE: [f64; 8] = [0.02, 1.2, 0.4, 2.2, 0.01, 0.6, 0.3, 1.5];

/// A seeded stream of standard normal numbers (xorshift64*, Box and Muller).
pub struct Normal {
    state: u64,
    spare: Option<f64>,
}

impl Normal {
    pub fn seeded(seed: u64) -> Self {
        Self { state: seed, spare: None }
    }

    fn uniform(&mut self) -> f64 {
        self.state ^= self.state >> 12;
        self.state ^= self.state << 25;
        self.state ^= self.state >> 27;
        let random = self.state.wrapping_mul(0x2545_F491_4F6C_DD1D);
        ((random >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    pub fn next(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let (radius, turn) = ((-2.0 * self.uniform().ln()).sqrt(), std::f64::consts::TAU * self.uniform());
        self.spare = Some(radius * turn.sin());
        radius * turn.cos()
    }
}

pub fn make(dir: &Path, rows: usize) -> Outcome<()> {
    fs::create_dir_all(dir)?;
    columns(dir, rows)?;
    record(&dir.join("record.csv"), rows)
}

fn columns(dir: &Path, rows: usize) -> Outcome<()> {
    let mut normal = Normal::seeded(1);
    let mut files = Vec::new();
    for name in RAW {
        files.push(BufWriter::new(File::create(dir.join(name))?));
    }
    for _ in 0..rows {
        let mut row = [normal.next(), normal.next(), normal.next(), normal.next(), 0.0];
        let clean: f64 = design(row).iter().zip(TRUE).map(|(x, b)| x * b).sum();
        row[4] = clean + 0.1 * normal.next();
        for (file, value) in files.iter_mut().zip(row) {
            file.write_all(&value.to_le_bytes())?;
        }
    }
    for mut file in files {
        file.flush()?;
    }
    Ok(())
}

/// A force record at 1 kHz, six decimals: about 65 MB a million rows.
fn record(path: &Path, rows: usize) -> Outcome<()> {
    let mut normal = Normal::seeded(2);
    let mut file = BufWriter::with_capacity(1 << 20, File::create(path)?);
    let mut line = String::new();
    writeln!(file, "t,fx,fy,vx,vy,theta,omega")?;
    let round = |value: f64| (value * 1e6).round() / 1e6;
    for i in 0..rows {
        let t = i as f64 * 1e-3;
        let (vx, vy, omega) = (round(normal.next()), round(normal.next()), round(normal.next()));
        let theta = round(0.7 * (std::f64::consts::PI * t).sin());
        let x = force_row([0.0, 0.0, vx, vy, theta, omega]);
        let fx: f64 = x.iter().zip(FORCE).map(|(x, b)| x * b).sum();
        let fy: f64 = x.iter().zip(FORCE.iter().rev()).map(|(x, b)| x * b).sum();
        let (fx, fy) = (round(fx + 0.1 * normal.next()), round(fy + 0.1 * normal.next()));
        line.clear();
        writeln!(line, "{t:.3},{fx},{fy},{vx},{vy},{theta},{omega}")?;
        file.write_all(line.as_bytes())?;
    }
    file.flush()?;
    Ok(())
}

/// A raw column.
pub fn read(path: &Path) -> Outcome<Vec<f64>> {
    let bytes = fs::read(path)?;
    let numbers = bytes.as_chunks::<8>().0;
    let mut column = on_huge_pages(numbers.len());
    column.extend(numbers.iter().map(|bytes| f64::from_le_bytes(*bytes)));
    Ok(column)
}

/// An empty column with room for `n` numbers on huge pages, where numpy puts its large arrays too.
pub fn on_huge_pages(n: usize) -> Vec<f64> {
    const PAGE: usize = 4096;
    let mut column: Vec<f64> = Vec::with_capacity(n);
    let start = (column.as_mut_ptr() as usize).next_multiple_of(PAGE);
    let end = (column.as_mut_ptr() as usize + n * 8) / PAGE * PAGE;
    if start < end {
        // SAFETY: the pages lie inside the allocation; the advice does not change what they hold.
        let _ = unsafe { rustix::mm::madvise(start as *mut _, end - start, rustix::mm::Advice::LinuxHugepage) };
    }
    column
}
