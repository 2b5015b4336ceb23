//! Observations with the prediction of a law.

use std::sync::Arc;

use froude_records::page::{Observed, Point};
use froude_records::units::Dimension;
use indexmap::IndexMap;

use crate::IdentifyError;
use crate::dataset::{Dataset, unit_text};
use crate::law::Kind;
use crate::regression::ModelFit;

/// The channel that a response is drawn against: speed where there is motion, else the first channel of its law.
pub(super) fn abscissa(model: &ModelFit, data: &Dataset) -> Option<String> {
    if data.values("speed").is_some_and(|u| u.iter().any(|x| *x != 0.0))
        && !matches!(model.law.kind, Kind::Thruster { .. })
        && (0..model.law.responses.len()).any(|r| model.law.moves(r))
    {
        return None;
    }
    model.law.channels().into_iter().find(|c| *c != "density").map(str::to_owned)
}

/// A point for each row of each response.
pub(super) fn of(model: &ModelFit, data: &Dataset) -> Result<Vec<Point>, IdentifyError> {
    let fitted = model.law.predict(data, model.law_coefficients())?;
    let other = abscissa(model, data).filter(|quantity| data.values(quantity).is_some());
    let n = data.rows;
    let mut out = Vec::new();
    for (r, response) in model.law.responses.iter().enumerate() {
        let Some(measured) = data.values(response) else { continue };
        let standard = data.values(&format!("std_{response}"));
        let mut of: IndexMap<&str, Arc<Observed>> = IndexMap::new();
        for i in (0..n).filter(|&i| data.observes(response, i)) {
            let of = of.entry(&data.configuration[i]).or_insert_with_key(|configuration| {
                let unit = |quantity: &str| data.dimension(quantity).unwrap_or(Dimension::ONE).to_string();
                Arc::new(Observed {
                    configuration: (*configuration).to_owned(),
                    component: response.clone(),
                    unit: unit_text(data, response),
                    other: other.as_ref().map(|quantity| [quantity.clone(), unit(quantity)]),
                })
            });
            let at = |name: &str| data.values(name).map_or(0.0, |values| values[i]);
            out.push(Point {
                of: of.clone(),
                speed_m_s: at("speed"),
                angle_rad: at("angle"),
                other: other.as_deref().map_or(0.0, at),
                measured: measured[i],
                standard: standard.map(|s| s[i]),
                fitted: fitted[r * n + i],
            });
        }
    }
    Ok(out)
}
