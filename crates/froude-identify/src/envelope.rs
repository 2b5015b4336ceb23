//! The band of a load over all laws that the data do not contradict.

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::regression::ModelFit;
use crate::result::SourceResult;

/// A load by the recommended law, and its 95 % band, N or N m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// The load.
    pub load: f64,
    /// Lower end.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Band {
    /// Widened to hold another one.
    #[must_use]
    pub fn around(self, other: &Self) -> Self {
        Self { low: self.low.min(other.low), high: self.high.max(other.high), ..self }
    }
}

/// Loads of one law at all rows, response by response, with the band that holds if that law is true.
///
/// # Errors
///
/// A channel that the law reads and the data lack.
pub fn of_law(model: &ModelFit, data: &Dataset) -> Result<Vec<Band>, IdentifyError> {
    let at = model.law_coefficients();
    let (loads, slopes) = (model.law.predict(data, at)?, model.law.regressors(data, at)?);
    let n = data.rows;
    let dof: Vec<f64> =
        (0..model.law.responses.len()).map(|r| model.scatter_dof(&slopes, r * n..(r + 1) * n)).collect();
    let band = |(row, &load): (usize, &f64)| {
        let line: Vec<f64> = (0..slopes.ncols()).map(|j| slopes[(row, j)]).collect();
        let [below, above] = model.arms(&line, dof[row / n]);
        Band { load, low: load - below, high: load + above }
    };
    Ok(loads.iter().enumerate().map(band).collect())
}

/// Loads of the recommended law at all rows, response by response, with the envelope of the bands of all laws that the data do not contradict; none where no law is recommended.
///
/// # Errors
///
/// A channel that one of the laws reads and the data lack.
pub fn of_source(source: &SourceResult, data: &Dataset) -> Result<Vec<Band>, IdentifyError> {
    let Some(chosen) = &source.recommendation else { return Ok(Vec::new()) };
    let model = &source.models[chosen.index];
    let mut out = of_law(model, data)?;
    for other in chosen.not_contradicted.iter().filter(|i| **i != chosen.index).map(|i| &source.models[*i]) {
        let bands = of_law(other, data)?;
        for (r, load) in model.law.responses.iter().enumerate() {
            let Some(of_other) = other.law.responses.iter().position(|own| own == load) else { continue };
            for i in 0..data.rows {
                let row = r * data.rows + i;
                out[row] = out[row].around(&bands[of_other * data.rows + i]);
            }
        }
    }
    Ok(out)
}
