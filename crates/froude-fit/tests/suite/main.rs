//! Laws, closed forms and certified values that the fits must meet.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
#![allow(clippy::needless_range_loop, clippy::cast_possible_wrap)]

mod bounds;
mod closed_forms;
mod components;
mod condensed;
mod constraints;
mod covariance;
mod coverage;
mod errors;
mod nist;
mod nonlinear;
mod nonlinear_nist;
mod odr;
mod priors;
mod propagation;
mod rank;
mod scaling;
mod selection;

use faer::Mat;
use froude_fit::Problem;
use rand::{Rng, RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

/// Names `b0`, `b1`, …
pub(crate) fn names(p: usize) -> Vec<String> {
    (0..p).map(|j| format!("b{j}")).collect()
}

/// A single-component problem from rows.
pub(crate) fn single(rows: &[Vec<f64>], response: &[f64]) -> Problem {
    let p = rows[0].len();
    Problem::single(Mat::from_fn(rows.len(), p, |i, j| rows[i][j]), response.to_vec(), names(p))
}

/// Columns `1, x, x², …`.
pub(crate) fn polynomial(x: &[f64], p: usize) -> Vec<Vec<f64>> {
    x.iter().map(|x| (0..p as i32).map(|k| x.powi(k)).collect()).collect()
}

/// A generator of its own for each test.
pub(crate) fn rng(seed: u64) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(seed)
}

/// A standard normal number.
pub(crate) fn normal(rng: &mut impl Rng) -> f64 {
    rng.sample(StandardNormal)
}

/// `|a − b| ≤ tolerance (1 + |b|)`, in words when not.
#[track_caller]
pub(crate) fn assert_close(a: f64, b: f64, tolerance: f64) {
    assert!((a - b).abs() <= tolerance * (1.0 + b.abs()), "{a} is not {b} within {tolerance}");
}
