//! How well a law predicts what it was not fitted to: a configuration left out, a range left out.

use froude_fit as fit;
use froude_records::campaign::RangeBlock;

use crate::dataset::{Dataset, labels};
use crate::regression::ModelFit;

/// Prediction of left-out observations by one model, by component.
#[derive(Debug, Clone, PartialEq)]
pub struct Score {
    /// RMSE by load component, in the load's unit.
    pub rmse: Vec<(String, f64)>,
    /// Why there is no score.
    pub note: Option<String>,
}

/// A range block: fitted inside, predicted outside.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockScore {
    /// The block in words.
    pub block: String,
    /// Model.
    pub model: String,
    /// RMSE outside by component, and the same relative to the outside loads' RMS.
    pub rmse: Vec<(String, f64, f64)>,
    /// Largest |predicted/measured − 1| among the outside rows whose load is at least half the largest.
    pub worst_ratio: Vec<(String, f64)>,
    /// Coefficients refitted inside, beside those of all rows: (name, all, inside).
    pub moved: Vec<(String, f64, f64)>,
}

/// Leave-one-configuration-out score of a model.
///
/// The root mean square of measured less predicted, per load, in N or N m: each configuration is predicted by a fit to the others. The note says why there is no score.
#[must_use]
pub fn leave_one_out(model: &ModelFit, data: &Dataset) -> Score {
    if model.law.is_nonlinear() {
        return Score {
            rmse: Vec::new(),
            note: Some("not possible: the law is not linear in its coefficients".to_owned()),
        };
    }
    if let Some(all) = &data.sample {
        let note = match all.configurations.len() {
            few @ ..3 => {
                format!(
                    "not possible: leaving one configuration out needs at least three configurations; the table has {few}"
                )
            }
            _ => "not scored: no configuration is left out of a table that is read in chunks".to_owned(),
        };
        return Score { rmse: Vec::new(), note: Some(note) };
    }
    let groups = labels(&data.configuration);
    let n = data.rows;
    let stacked: Vec<usize> = (0..model.problem.response.len()).map(|row| groups[row % n]).collect();
    let names = data.configurations();
    match fit::select::leave_one_group_out(&model.problem, &model.options, &stacked) {
        Ok(scores) => {
            let mut out = Score { rmse: Vec::new(), note: None };
            for score in scores {
                match score.score {
                    Ok(rmse) => out.rmse.push((score.component, rmse)),
                    Err(reason) => {
                        out.note = Some(if names.len() < 3 {
                            format!(
                                "not possible: leaving one configuration out needs at least three configurations; the table has {}",
                                names.len()
                            )
                        } else {
                            format!("{}: not possible: {reason}", score.component)
                        });
                    }
                }
            }
            out
        }
        Err(reason) => Score { rmse: Vec::new(), note: Some(format!("not possible: {reason}")) },
    }
}

/// Fits inside a declared range, predicts outside.
///
/// Per load the root mean square error outside the range in N or N m, the same over the root mean square of the load, and the largest relative error among loads above half of the
/// largest. `None` for a law that is not linear, for an unknown column, or where nothing lies inside or outside.
#[must_use]
pub fn range_block(model: &ModelFit, data: &Dataset, block: &RangeBlock) -> Option<BlockScore> {
    // The problem of a non-linear law holds its last linear step, not the loads.
    if model.law.is_nonlinear() {
        return None;
    }
    let values = data.values(data.meant(&block.column))?;
    let inside = |i: usize| values[i] >= block.low - 1e-12 && values[i] <= block.high + 1e-12;
    let n = data.rows;
    let train: Vec<bool> = (0..model.problem.response.len()).map(|row| inside(row % n)).collect();
    let result = fit::select::range_block(&model.problem, &model.options, &train).ok()?;
    let mut rmse = Vec::new();
    let mut worst = Vec::new();
    for (r, name) in model.law.responses.iter().enumerate() {
        let is_outside = |i: &usize| !inside(*i) && data.observes(name, *i);
        let outside: Vec<usize> = (0..n).filter(is_outside).map(|i| r * n + i).collect();
        if outside.is_empty() {
            return None;
        }
        let measured: Vec<f64> = outside.iter().map(|&row| model.problem.response[row]).collect();
        let predicted: Option<Vec<f64>> = outside.iter().map(|&row| result.predicted[row]).collect();
        let predicted = predicted?;
        let count = measured.len() as f64;
        let error = (measured.iter().zip(&predicted).map(|(m, p)| (m - p).powi(2)).sum::<f64>() / count).sqrt();
        let size = (measured.iter().map(|m| m * m).sum::<f64>() / count).sqrt();
        rmse.push((name.clone(), error, error / size));
        let largest = measured.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let ratio = measured
            .iter()
            .zip(&predicted)
            .filter(|(m, _)| m.abs() >= 0.5 * largest)
            .map(|(m, p)| p / m - 1.0)
            .fold(0.0, |worst: f64, x| if x.abs() > worst.abs() { x } else { worst });
        worst.push((name.clone(), ratio));
    }
    Some(BlockScore {
        block: format!("fitted to {} in [{:.4}, {:.4}]", block.column, block.low, block.high),
        model: model.law.name.clone(),
        rmse,
        worst_ratio: worst,
        moved: model
            .specs
            .iter()
            .zip(&model.coefficients)
            .zip(&result.refit.coefficients)
            .filter_map(|((s, all), inside)| inside.value.map(|x| (s.name.clone(), *all, x)))
            .collect(),
    })
}
