//! What several errors come to together (GUM, linear).
//!
//! **Source.** JCGM 100:2008 (GUM), 5.1 and G.4.

pub use crate::distribution::coverage_factor;

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
