//! Observations with the prediction of a law.

use froude_records::page::{Abscissa, Point};
use froude_records::units::Dimension;

use crate::IdentifyError;
use crate::dataset::{Dataset, unit_text};
use crate::law::Kind;
use crate::regression::ModelFit;

/// The channel that a response is drawn against: speed where there is motion, else the first channel of its law.
pub(super) fn abscissa(model: &ModelFit, data: &Dataset) -> Option<String> {
    if data.values("speed").is_some_and(|u| u.iter().any(|x| *x != 0.0))
        && (0..model.law.responses.len()).any(|r| model.law.moves(r))
    {
        return None;
    }
    let used: Vec<String> = match &model.law.kind {
        Kind::Formulas(f) => f.iter().flat_map(|f| f.channels.clone()).collect(),
        _ => Vec::new(),
    };
    used.into_iter().find(|c| c != "density")
}

/// A point for each row of each response.
pub(super) fn of(model: &ModelFit, data: &Dataset) -> Result<Vec<Point>, IdentifyError> {
    let fitted = model.law.predict(data, model.law_coefficients())?;
    let other = abscissa(model, data);
    let n = data.rows;
    let mut out = Vec::new();
    for (r, response) in model.law.responses.iter().enumerate() {
        let Some(measured) = data.values(response) else { continue };
        let standard = data.values(&format!("std_{response}"));
        for i in (0..n).filter(|&i| data.observes(response, i)) {
            out.push(Point {
                configuration: data.configuration[i].clone(),
                component: response.clone(),
                unit: unit_text(data, response),
                speed_m_s: data.values("speed").map_or(0.0, |v| v[i]),
                angle_rad: data.values("angle").map_or(0.0, |v| v[i]),
                other: other.as_ref().and_then(|q| {
                    data.values(q).map(|v| Abscissa {
                        quantity: q.clone(),
                        unit: data.dimension(q).unwrap_or(Dimension::ONE).to_string(),
                        value: v[i],
                    })
                }),
                measured: measured[i],
                standard: standard.map(|s| s[i]),
                fitted: fitted[r * n + i],
            });
        }
    }
    Ok(out)
}
