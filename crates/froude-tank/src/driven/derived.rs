//! Sums of coefficients, with the uncertainty that the coefficients have together.

use froude_fit::budget::{Combined, Kind, OUTSIDE_95, Part, Uncertain, combine};
use froude_fit::faer::Mat;

use crate::joint::JointFit;
use crate::joint::part;

/// A number that follows linearly from the coefficients.
#[derive(Debug, Clone, PartialEq)]
pub struct Sum {
    /// Its name.
    pub name: &'static str,
    /// How, in the names of the record.
    pub formula: &'static str,
    /// SI unit text.
    pub unit: &'static str,
    /// The factor of each coefficient, by its name.
    pub factors: Vec<(&'static str, f64)>,
    /// What all of it is divided by, by its name.
    pub over: Option<(&'static str, Uncertain)>,
}

/// A sum with its value.
#[derive(Debug, Clone, PartialEq)]
pub struct Derived {
    /// Its name.
    pub name: &'static str,
    /// How, in the names of the record.
    pub formula: &'static str,
    /// SI unit text.
    pub unit: &'static str,
    /// Its value.
    pub value: f64,
    /// Its uncertainty.
    pub combined: Combined,
}

/// The sums that a fit determines: one with a held coefficient is left out, as it only repeats what was declared.
#[must_use]
pub fn derived(fit: &JointFit, sums: &[Sum]) -> Vec<Derived> {
    let one = |sum: &Sum| {
        let Sum { name, formula, unit, .. } = *sum;
        let mut value = 0.0;
        let mut gradient = vec![0.0; fit.unknowns.len()];
        for (coefficient, factor) in &sum.factors {
            let j = fit.position(coefficient)?;
            fit.unknowns[j].combined?;
            value += factor * fit.unknowns[j].value?;
            gradient[j] = *factor;
        }
        let of_over = sum.over.map(|(over, known)| {
            Part::of_one(over.to_owned(), "campaign", Kind::B, (value * known.relative()).abs(), known.dof)
        });
        let parts: Vec<Part> = fit.parts.iter().map(|p| along(p, &gradient)).chain(of_over).collect();
        Some(Derived { name, formula, unit, value, combined: combine(&parts, 0, OUTSIDE_95) })
    };
    sums.iter().filter_map(one).collect()
}

/// A line of the budget for one sum of coefficients.
fn along(of: &Part, gradient: &[f64]) -> Part {
    let n = gradient.len();
    let variance: f64 =
        (0..n).map(|i| (0..n).map(|j| gradient[i] * of.covariance[(i, j)] * gradient[j]).sum::<f64>()).sum();
    let dof = of.dof.first().copied().unwrap_or(f64::INFINITY);
    part(&of.name, of.kind, Mat::from_fn(1, 1, |_, _| variance.max(0.0)), dof)
}

/// What is derived, by name.
#[must_use]
pub fn named<'d>(derived: &'d [Derived], name: &str) -> Option<&'d Derived> {
    derived.iter().find(|d| d.name == name)
}
