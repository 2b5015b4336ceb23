//! Time and memory of a solution, before it starts.

use crate::problem::Problem;
use crate::{fast, is_plain};

/// Time and memory of a solution, before it starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Forecast {
    /// Unknowns.
    pub unknowns: usize,
    /// Time, s, on as many threads as there are.
    pub seconds: f64,
    /// Memory, bytes.
    pub memory_bytes: f64,
}

/// Time of a near pair and of a pair of boxes over a whole solution, one thread, s: as measured on a processor with AVX-512.
pub(crate) const NEAR_S: f64 = 25e-9;

pub(crate) const FAR_S: f64 = 40e-6;

/// Time of a pair of panels in the plain solver, s.
pub(crate) const PLAIN_S: f64 = 80e-9;

/// Multiplications of the plain solver's factorisation a second.
pub(crate) const PLAIN_PER_S: f64 = 2e10;

/// What a problem will take.
#[must_use]
pub fn forecast(problem: &Problem) -> Forecast {
    let n = problem.facets.len() as f64;
    let threads = std::thread::available_parallelism().map_or(1.0, |t| t.get() as f64);
    if is_plain(problem) {
        // A matrix for each class of signs: a body with three planes has six.
        let classes = if problem.mirrors.is_empty() { 1.0 } else { 6.0 };
        let images = f64::from(1_u32 << problem.mirrors.len());
        let seconds = n * n * images * PLAIN_S / threads + classes * n.powi(3) / 1.5 / PLAIN_PER_S;
        return Forecast { unknowns: problem.facets.len(), seconds, memory_bytes: 8.0 * (classes + 2.0) * n * n };
    }
    let cost = fast::cost(problem);
    let blocks = problem.columns().div_ceil(8) as f64;
    let seconds = blocks * (cost.near_pairs as f64 * NEAR_S + cost.far_pairs as f64 * FAR_S) / threads + 0.1;
    Forecast { unknowns: cost.unknowns, seconds, memory_bytes: cost.memory_bytes as f64 }
}

/// A time as a person says it.
pub(crate) fn duration(seconds: f64) -> String {
    if seconds < 1.0 {
        "less than a second".to_owned()
    } else if seconds < 120.0 {
        format!("{seconds:.0} s")
    } else {
        format!("{:.0} min", seconds / 60.0)
    }
}
