//! How the cost of `froude identify` and `froude compare` grows: seconds over two decades in rows, configurations, groups, sources, columns
//! that are not used, and the length of the header, with the exponent of the last decade.
//!
//! ```text
//! cargo run --release -p froude --example growth
//! ```
#![allow(clippy::unwrap_used, clippy::print_stdout, missing_docs)]

use std::fmt::Write as _;
use std::path::Path;
use std::time::Instant;

use froude::pipeline::{Job, identify};

/// Observations of a quadratic drag under a scatter of a per cent, none of them twice, with whatever columns are asked for.
fn table(rows: usize, label: &str, every: usize, unused: usize, header: usize) -> String {
    let mut out = format!("{label},speed [m/s],f_x [N]");
    for j in 0..unused {
        write!(out, ",u{j:0header$} [N]").unwrap();
    }
    out.push('\n');
    for i in 0..rows {
        let speed = 0.1 + 0.01 * (i % 90) as f64;
        // The fractions of multiples of the golden section lie evenly and never repeat.
        let scatter = 0.99 + 0.02 * (0.618_033_988_749_895 * i as f64).fract();
        write!(out, "g{},{speed:.2},{:.12}", i / every, -3.0 * speed * speed * scatter).unwrap();
        for j in 0..unused {
            write!(out, ",{}", (i * 31 + j * 17) % 97).unwrap();
        }
        out.push('\n');
    }
    out
}

fn seconds(folder: &Path, files: &[(String, String)], input: &str) -> f64 {
    for (name, text) in files {
        std::fs::write(folder.join(name), text).unwrap();
    }
    let mut job = Job::new(folder.join(input));
    job.out = Some(folder.join("out"));
    let begun = Instant::now();
    identify(&job, &|_| {}).unwrap();
    let took = begun.elapsed().as_secs_f64();
    let _ = std::fs::remove_dir_all(folder.join("out"));
    took
}

fn campaign(sources: usize, more: &str) -> String {
    let mut out = "schema = 1\nname = \"growth\"\n".to_owned();
    for k in 0..sources {
        write!(out, "[[source]]\nname = \"s{k}\"\nkind = \"tank\"\ntable = \"t.csv\"\n{more}").unwrap();
    }
    out
}

fn main() {
    let folder = tempfile::tempdir().unwrap();
    let one = |name: &str, text: String| vec![(name.to_owned(), text)];
    let with = |sources: usize, more: &str, table: String| {
        vec![("c.toml".to_owned(), campaign(sources, more)), ("t.csv".to_owned(), table)]
    };
    type Files = Box<dyn Fn(usize) -> (Vec<(String, String)>, &'static str)>;
    let sweeps: [(&str, [usize; 3], Files); 6] = [
        ("rows", [1_000, 10_000, 100_000], Box::new(move |n| (one("t.csv", table(n, "run", n, 0, 0)), "t.csv"))),
        (
            "configurations",
            [40, 400, 4_000],
            Box::new(move |n| (one("t.csv", table(3 * n, "configuration", 3, 0, 0)), "t.csv")),
        ),
        (
            "groups",
            [40, 400, 4_000],
            Box::new(move |n| (with(1, "group = \"run\"\n", table(3 * n, "run", 3, 0, 0)), "c.toml")),
        ),
        (
            "sources",
            [2, 20, 200],
            Box::new(move |n| (with(n, "models = [\"quadratic\"]\n", table(12, "run", 12, 0, 0)), "c.toml")),
        ),
        ("unused columns", [90, 900, 9_000], Box::new(move |n| (one("t.csv", table(12, "run", 12, n, 0)), "t.csv"))),
        (
            "bytes of the header",
            [10_000, 100_000, 1_000_000],
            Box::new(move |n| (one("t.csv", table(12, "run", 12, n / 900, 894)), "t.csv")),
        ),
    ];
    println!("{:<20} {:>30} {:>30}  exponent", "in", "numbers", "seconds");
    for (name, numbers, files) in sweeps {
        let took = numbers.map(|n| {
            let (files, input) = files(n);
            (0..3).map(|_| seconds(folder.path(), &files, input)).fold(f64::INFINITY, f64::min)
        });
        let exponent = (took[2] / took[1]).log10();
        println!(
            "{name:<20} {:>30} {:>30}  {exponent:.2}",
            format!("{numbers:?}"),
            took.map(|t| format!("{t:.3}")).join(" ")
        );
    }
}
