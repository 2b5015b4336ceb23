//! From input errors to the uncertainty of coefficients (GUM, linear).
//!
//! An error shared by many rows, such as a calibration factor, does not average
//! down with their number. Its way into the coefficients is the sensitivity of
//! a fit: `u²(β) = s² (S d)(S d)ᵀ`, with `d` the change of each response per
//! unit of the error.
//!
//! When the error enters the design and not the response (density, an angle
//! offset), the change to give is that of the response *less that of the
//! prediction*: `d = ∂y/∂e − (∂X/∂e) β`.
//!
//! **Source.** JCGM 100:2008 (GUM), 5.1, 5.2 and G.4.

use faer::{Mat, MatRef};

use crate::dense::mul_vec;
use crate::error::FitError;
use crate::problem::size;

pub use crate::distribution::coverage_factor;

/// Covariance of the coefficients from one input error.
///
/// `sensitivity` is [`crate::Fit::sensitivity`], `p × n`; `derivative` the
/// change of each row per unit of the error, length `n`; `standard` the
/// standard uncertainty of the error. `groups` says which rows share one draw:
/// `None` means all of them (a campaign), else rows with equal group (a setup,
/// a run, a sample) share theirs and groups are independent.
///
/// # Errors
///
/// [`FitError::Size`] when lengths differ; [`FitError::Option`] when `standard`
/// is negative or not finite.
pub fn shared_error(
    sensitivity: MatRef<'_, f64>,
    derivative: &[f64],
    standard: f64,
    groups: Option<&[usize]>,
) -> Result<Mat<f64>, FitError> {
    let (p, n) = sensitivity.shape();
    let of_rows = "one per row of the fit";
    size("derivative", derivative.len(), n, of_rows)?;
    if !(standard >= 0.0 && standard.is_finite()) {
        return Err(FitError::Option {
            option: "the standard uncertainty of an input",
            value: standard,
            must: "zero or positive, and finite",
        });
    }
    let mut moves: Vec<Vec<f64>> = Vec::new();
    if let Some(groups) = groups {
        size("groups", groups.len(), n, of_rows)?;
        let mut of_group = std::collections::BTreeMap::new();
        for (i, &group) in groups.iter().enumerate() {
            let sum = of_group.entry(group).or_insert_with(|| vec![0.0; p]);
            for (j, sum) in sum.iter_mut().enumerate() {
                *sum += sensitivity[(j, i)] * derivative[i];
            }
        }
        moves.extend(of_group.into_values());
    } else {
        moves.push(mul_vec(sensitivity, derivative));
    }
    let mut out = Mat::zeros(p, p);
    for change in moves {
        for i in 0..p {
            for j in 0..p {
                out[(i, j)] += (standard * change[i]) * (standard * change[j]);
            }
        }
    }
    Ok(out)
}

/// Effective degrees of freedom of a sum of variances (Welch–Satterthwaite,
/// GUM G.4.1): `(Σ u²)² / Σ (u⁴/ν)`.
///
/// Each entry is `(variance, dof)`; `dof` is infinite for an input known from
/// a certificate. Infinite when no entry with finite `dof` contributes.
///
/// # Example
///
/// The gauge block of GUM H.1.6, in nm: 25 (18), 9.7 (25.6), 2.9 (50) and
/// 16.6 (2). With the rounded sum 32 nm the GUM prints 16.7; unrounded it is 16.76:
///
/// ```
/// use froude_fit::propagate::effective_dof;
/// let entries = [(25.0, 18.0), (9.7, 25.6), (2.9, 50.0), (16.6, 2.0)];
/// let dof = effective_dof(&entries.map(|(u, dof): (f64, f64)| (u * u, dof)));
/// assert!((dof - 16.76).abs() < 0.01);
/// ```
#[must_use]
pub fn effective_dof(entries: &[(f64, f64)]) -> f64 {
    let total: f64 = entries.iter().map(|e| e.0).sum();
    let sum: f64 = entries.iter().filter(|e| e.0 > 0.0).map(|(variance, dof)| variance * variance / dof).sum();
    if sum > 0.0 { total * total / sum } else { f64::INFINITY }
}

/// Expanded uncertainty of a sum of variances.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Expanded {
    /// Combined standard uncertainty.
    pub standard: f64,
    /// Effective degrees of freedom.
    pub dof: f64,
    /// Coverage factor of Student's t.
    pub coverage: f64,
    /// `coverage · standard`.
    pub expanded: f64,
}

/// Combines variances with their degrees of freedom into an expanded uncertainty.
#[must_use]
pub fn expanded(entries: &[(f64, f64)], confidence: f64) -> Expanded {
    let standard = entries.iter().map(|e| e.0).sum::<f64>().sqrt();
    let dof = effective_dof(entries);
    let coverage = coverage_factor(confidence, dof);
    Expanded { standard, dof, coverage, expanded: coverage * standard }
}
