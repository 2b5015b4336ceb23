//! The fits of a campaign: hundreds of rows, ten coefficients. Each variant stands beside the plain fit that it extends.
#![allow(missing_docs, clippy::unwrap_used)]

use divan::{Bencher, black_box};
use faer::Mat;
use froude_fit::{Bound, CovarianceKind, Options, Problem, fit};

const ROWS: usize = 360;
const COLUMNS: usize = 10;

fn main() {
    divan::main();
}

/// A smooth, well-determined design and a response with a deterministic ripple.
fn problem() -> Problem {
    let x = |i: usize| i as f64 / ROWS as f64;
    let design = Mat::from_fn(ROWS, COLUMNS, |i, j| (std::f64::consts::PI * (j + 1) as f64 * x(i)).cos());
    let response = (0..ROWS).map(|i| (7.0 * x(i)).sin() + 0.01 * (997.0 * x(i)).sin()).collect();
    let names = (0..COLUMNS).map(|j| format!("c{j}")).collect();
    let mut problem = Problem::single(design, response, names);
    problem.cluster = Some((0..ROWS).map(|i| i / 40).collect());
    problem
}

#[divan::bench(args = ["plain", "HC3", "CR3", "bounded"])]
fn one_fit(bencher: Bencher<'_, '_>, variant: &str) {
    let problem = problem();
    let options = match variant {
        "HC3" => Options { covariance: CovarianceKind::Hc3, ..Options::default() },
        "CR3" => Options { covariance: CovarianceKind::Cr3, ..Options::default() },
        "bounded" => Options { bounds: vec![Bound::NON_NEGATIVE; COLUMNS], ..Options::default() },
        _ => Options::default(),
    };
    bencher.bench(|| fit(black_box(&problem), &options).unwrap());
}
