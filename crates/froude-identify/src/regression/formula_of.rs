//! A law within a larger one, as a formula of it.
//!
//! Which of two laws has the smaller criterion is told by the same scatter as the coefficients: an interval of the law that was chosen holds only as if nothing had been
//! chosen. So the numbers are those of the largest law, and a smaller one is a formula that gives nearly the same loads. Its record is widened by one factor κ, so that at
//! every observation its band holds that of the larger law:
//!
//! κ = max_i (h_i + |Δ_i|)/(1.96 u_i),
//!
//! h_i half the larger law's 95 % band at observation i, Δ_i the difference of both laws there and u_i the standard uncertainty of the smaller one.
//!
//! # Source
//!
//! Berk, Brown, Buja, Zhang & Zhao (2013), Valid post-selection inference, Ann. Stat. 41, 802: why intervals after selection do not hold; intervals of the largest model,
//! which nothing has chosen, do.

use froude_fit::budget::{Kind, OUTSIDE_95, Part, combine};
use froude_fit::faer::Mat;

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::regression::ModelFit;
use crate::uncertainty::coverage_factor;

/// What a formula is of its larger law.
#[derive(Debug, Clone, PartialEq)]
pub struct FormulaOf {
    /// The larger law.
    pub law: String,
    /// Largest difference of each load that both give, over the observations, N or N m.
    pub largest_difference: Vec<(String, f64)>,
    /// κ, 1 or more \[-\].
    pub widened: f64,
}

/// Makes `model` a formula of `full`: its uncertainty is widened. `None` where no finite factor does that. `looks` are those that its intervals pay for.
///
/// # Errors
///
/// A channel that one of the laws needs and the data lack.
pub(crate) fn as_formula(
    model: &mut ModelFit,
    full: &ModelFit,
    data: &Dataset,
    looks: usize,
) -> Result<Option<FormulaOf>, IdentifyError> {
    let n = data.rows;
    let (own, larger) = (Loads::of(model, data)?, Loads::of(full, data)?);
    let normal = coverage_factor(f64::INFINITY);
    let mut widened = 1.0_f64;
    let mut largest_difference = Vec::new();
    for (r, load) in model.law.responses.iter().enumerate() {
        let Some(of_full) = full.law.responses.iter().position(|l| l == load) else { continue };
        let dof = [own.scatter_dof(model, r, n), larger.scatter_dof(full, of_full, n)];
        let mut largest = 0.0_f64;
        for i in 0..n {
            let (row, of_full) = (r * n + i, of_full * n + i);
            let difference = (own.force[row] - larger.force[of_full]).abs();
            largest = largest.max(difference);
            let [below, above] = full.arms(&larger.slopes(of_full), dof[1]);
            let standard = model.prediction_std(&own.slopes(row));
            if standard > 0.0 {
                widened = widened.max((below.max(above) + difference) / (normal * standard));
            }
        }
        largest_difference.push((load.clone(), largest));
    }
    // One that knows a load to nothing where the larger law does not is no formula of it.
    let is_apart = largest_difference.iter().all(|(_, difference)| difference.is_finite());
    if !is_apart || !(widened * widened * model.covariance.norm_max()).is_finite() {
        return Ok(None);
    }
    let p = model.specs.len();
    let more = widened * widened - 1.0;
    let name = format!("terms of {} that it leaves out", full.law.name);
    model.budget.push(Part {
        covariance: Mat::from_fn(p, p, |a, b| more * model.covariance[(a, b)]),
        dof: vec![f64::INFINITY; p],
        ..Part::of_one(name, "campaign", Kind::ModelForm, 0.0, f64::INFINITY)
    });
    let outside = OUTSIDE_95 / looks.max(1) as f64;
    for (j, combined) in model.combined.iter_mut().enumerate() {
        *combined = combined.map(|_| combine(&model.budget, j, outside));
    }
    model.covariance = Mat::from_fn(p, p, |a, b| (1.0 + more) * model.covariance[(a, b)]);
    Ok(Some(FormulaOf { law: full.law.name.clone(), largest_difference, widened }))
}

/// Loads of a law at all observations, with their slopes in its coefficients.
struct Loads {
    force: Vec<f64>,
    slopes: Mat<f64>,
}

impl Loads {
    fn of(model: &ModelFit, data: &Dataset) -> Result<Self, IdentifyError> {
        let coefficients = model.law_coefficients();
        Ok(Self { force: model.law.predict(data, coefficients)?, slopes: model.law.regressors(data, coefficients)? })
    }

    fn slopes(&self, row: usize) -> Vec<f64> {
        (0..self.slopes.ncols()).map(|j| self.slopes[(row, j)]).collect()
    }

    fn scatter_dof(&self, model: &ModelFit, r: usize, n: usize) -> f64 {
        model.scatter_dof(&self.slopes, r * n..(r + 1) * n)
    }
}
