//! Least squares with bounds on each coefficient, solved exactly.
//!
//! The active set method of Stark & Parker (1995), *Bounded-variable least
//! squares: an algorithm and applications*, Computational Statistics 10, which
//! with zero lower bounds is Lawson & Hanson's NNLS. Each step is a QR solve on
//! the free columns; the set of bounds that hold is found in finitely many
//! steps, and the Karush–Kuhn–Tucker conditions of the result are measured.

use faer::{Mat, MatRef};

use crate::dense::{column_norm, dot, mul_vec, norm};
use crate::rank::PivotedQr;
use crate::report::{End, Report};

/// A gradient counts as zero below this part of `‖a_j‖ ‖b‖`.
///
/// Rounding of the product leaves about 10⁻¹⁵; a bound kept by mistake below
/// this moves the coefficients by as little.
const GRADIENT_TOLERANCE: f64 = 1e-12;

/// Where a coefficient stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// At its lower bound.
    Lower,
    /// At its upper bound.
    Upper,
}

/// The result of [`bounded_least_squares`].
#[derive(Debug, Clone)]
pub struct Bounded {
    /// The coefficients.
    pub x: Vec<f64>,
    /// The bound that holds, for each coefficient.
    pub active: Vec<Option<Side>>,
    /// Largest violation of the optimality conditions: gradient of free
    /// coefficients, wrong-signed gradient at bounds, as part of `‖a_j‖ ‖b‖`.
    pub kkt: f64,
    /// How it ended.
    pub report: Report,
}

/// `min ‖A x − b‖` with `lower ≤ x ≤ upper`.
///
/// Bounds may be infinite; `lower[j] ≤ upper[j]`. Columns of `A` should be of
/// comparable length. Where `A` does not determine `x`, one of the minimisers
/// is returned: `A x` is unique, `x` is not.
///
/// # Panics
///
/// When the lengths of `b`, `lower` or `upper` do not match `A`.
#[must_use]
pub fn bounded_least_squares(a: MatRef<'_, f64>, b: &[f64], lower: &[f64], upper: &[f64]) -> Bounded {
    let p = a.ncols();
    assert!(b.len() == a.nrows() && lower.len() == p && upper.len() == p, "lengths must match the design");
    let start = PivotedQr::new(a).solve(b);
    let mut x: Vec<f64> = (0..p).map(|j| start[j].max(lower[j]).min(upper[j])).collect();
    let mut active: Vec<Option<Side>> = (0..p)
        .map(|j| {
            if x[j] <= lower[j] {
                Some(Side::Lower)
            } else if x[j] >= upper[j] {
                Some(Side::Upper)
            } else {
                None
            }
        })
        .collect();
    let tolerance: Vec<f64> = (0..p).map(|j| GRADIENT_TOLERANCE * column_norm(a, j) * norm(b)).collect();
    let limit = 20 * p + 100;
    let mut blocked = vec![false; p];
    let mut end = End::IterationLimit;
    let mut iterations = 0;
    while iterations < limit {
        iterations += 1;
        let moved = descend(a, b, lower, upper, &mut x, &mut active);
        if moved {
            blocked.fill(false);
        }
        let gradient = gradient(a, b, &x);
        let candidate = (0..p)
            .filter(|&j| !blocked[j] && lower[j] < upper[j])
            .map(|j| (j, violation(gradient[j], active[j]) - tolerance[j]))
            .filter(|&(j, excess)| excess > 0.0 && active[j].is_some())
            .max_by(|x, y| x.1.total_cmp(&y.1));
        match candidate {
            None => {
                end = End::Converged;
                break;
            }
            Some((j, _)) => {
                active[j] = None;
                // If it comes straight back, it is not tried again before
                // something else has moved.
                blocked[j] = true;
            }
        }
    }
    let gradient = gradient(a, b, &x);
    let kkt = (0..p)
        .filter(|&j| lower[j] < upper[j])
        .map(|j| {
            let size = column_norm(a, j) * norm(b);
            if size > 0.0 { violation(gradient[j], active[j]).max(0.0) / size } else { 0.0 }
        })
        .fold(0.0, f64::max);
    Bounded { x, active, kkt, report: Report { end, iterations } }
}

/// How far a gradient of `½‖Ax − b‖²` breaks the condition of its coefficient.
fn violation(gradient: f64, side: Option<Side>) -> f64 {
    match side {
        None => gradient.abs(),
        Some(Side::Lower) => -gradient,
        Some(Side::Upper) => gradient,
    }
}

fn gradient(a: MatRef<'_, f64>, b: &[f64], x: &[f64]) -> Vec<f64> {
    let residual: Vec<f64> = mul_vec(a, x).iter().zip(b).map(|(f, y)| f - y).collect();
    crate::dense::tr_mul_vec(a, &residual)
}

/// Minimises over the free coefficients, stopping at bounds on the way; says
/// whether anything moved.
fn descend(
    a: MatRef<'_, f64>,
    b: &[f64],
    lower: &[f64],
    upper: &[f64],
    x: &mut [f64],
    active: &mut [Option<Side>],
) -> bool {
    let mut has_moved = false;
    loop {
        let free: Vec<usize> = (0..x.len()).filter(|&j| active[j].is_none()).collect();
        if free.is_empty() {
            return has_moved;
        }
        let residual: Vec<f64> = mul_vec(a, x).iter().zip(b).map(|(f, y)| y - f).collect();
        let columns = Mat::from_fn(a.nrows(), free.len(), |i, k| a[(i, free[k])]);
        let step = PivotedQr::new(columns.as_ref()).solve(&residual);
        let mut length = 1.0;
        let mut stop = None;
        for (k, &j) in free.iter().enumerate() {
            let (bound, side) = if step[k] < 0.0 { (lower[j], Side::Lower) } else { (upper[j], Side::Upper) };
            if step[k] != 0.0 && bound.is_finite() {
                let reach = ((bound - x[j]) / step[k]).max(0.0);
                if reach < length {
                    length = reach;
                    stop = Some((j, bound, side));
                }
            }
        }
        if length > 0.0 && dot(&step, &step) > 0.0 {
            has_moved = true;
        }
        for (k, &j) in free.iter().enumerate() {
            x[j] = (x[j] + length * step[k]).max(lower[j]).min(upper[j]);
        }
        match stop {
            Some((j, bound, side)) => {
                x[j] = bound;
                active[j] = Some(side);
            }
            None => return has_moved,
        }
    }
}
