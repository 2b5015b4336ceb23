//! Priors and known coefficients that are taken from a record: an added mass of potential flow, for a method that cannot see added mass itself.
//!
//! ```toml
//! [identify]
//! prior = [
//!   { coefficient = "lambda_1", record = "added-mass/estimate.json", entry = "A66", model_form = "5 %" },
//!   { coefficient = "C_A", record = "added-mass/estimate.json", entry = "A22", volume = "1.27e-3 m^3", model_form = "5 %" },
//! ]
//! ```
//!
//! The value is that of the entry, in the water of the test where both densities are stated; with `volume`, C_A = A/(ρV) by the density that the record refers to. Its standard uncertainty is that of the record (of the
//! mesh, that is) and `model_form` of the value, added in the mean square: an ideal fluid is no real one, and the record does not know by how much. Priors, and known coefficients, from one
//! estimate have its covariance between them; their model forms are independent.

use std::path::PathBuf;

use crate::campaign::{Campaign, PriorRecord, PriorSpec, StatedUnit};
use crate::error::RecordError;
use crate::estimate::Estimate;
use crate::json::read_estimates;
use crate::units::{Dimension, Unit, parse_unit};

/// Reads every record that a prior or a known coefficient is taken from.
///
/// # Errors
///
/// A record that cannot be read; no such estimate or entry; a mass for λ₁, or for C_A without its volume; no uncertainty.
pub(crate) fn resolve(campaign: &mut Campaign) -> Result<(), RecordError> {
    let density = campaign.fluid.density_kg_m3;
    let mut of_priors = Vec::new();
    for prior in &mut campaign.identify.prior {
        let found = prior.record.clone().map(|from| value(prior, &from, density)).transpose()?;
        if let (Some(found), Some(from)) = (&found, &prior.record) {
            (prior.value, prior.standard_uncertainty) = (found.value, found.standard);
            campaign.identify.stated_units.extend(found.stated_unit(prior, from));
        }
        of_priors.push(found);
    }
    campaign.identify.prior_covariance = covariance(&campaign.identify.prior, &of_priors);
    let mut of_records = Vec::new();
    for known in &mut campaign.identify.known {
        let found = known.record.clone().map(|from| value(known, &from, density)).transpose()?;
        if let (Some(found), Some(from)) = (&found, &known.record) {
            campaign.identify.stated_units.extend(found.stated_unit(known, from));
            (known.value, known.standard_uncertainty, known.dof) = (found.value, found.standard, found.dof);
        }
        of_records.push(found);
    }
    campaign.identify.known_covariance = covariance(&campaign.identify.known, &of_records);
    Ok(())
}

/// Covariance of values, of which some are entries of records.
fn covariance(specs: &[PriorSpec], of_records: &[Option<Found>]) -> Vec<Vec<f64>> {
    let between = |i: usize, j: usize| match (&of_records[i], &of_records[j]) {
        _ if i == j => specs[i].standard_uncertainty.powi(2),
        (Some(a), Some(b)) => a.covariance_with(b),
        _ => 0.0,
    };
    (0..specs.len()).map(|i| (0..specs.len()).map(|j| between(i, j)).collect()).collect()
}

/// An entry of a record.
struct Found {
    value: f64,
    standard: f64,
    dof: Option<f64>,
    /// What the entry was divided by.
    per: f64,
    path: PathBuf,
    entry: String,
    estimate: Estimate,
}

impl Found {
    /// The unit of the value, to be compared with that of the coefficient in each law.
    fn stated_unit(&self, of: &PriorSpec, from: &PriorRecord) -> Option<StatedUnit> {
        let unit = match from.volume_m3 {
            Some(_) => Unit::one(),
            None => parse_unit(&self.estimate.coefficients.get(&self.entry)?.unit).ok()?,
        };
        let (coefficient, model) = (of.coefficient.clone(), of.model.clone());
        Some(StatedUnit { coefficient, model, unit, place: from.place.clone() })
    }

    /// Covariance with another entry; none of another estimate.
    fn covariance_with(&self, other: &Self) -> f64 {
        let is_one = self.path == other.path && self.estimate.id == other.estimate.id;
        let Some(all) = self.estimate.covariance().filter(|_| is_one) else { return 0.0 };
        let place = |of: &Self| all.names.iter().position(|name| *name == of.entry);
        place(self).zip(place(other)).map_or(0.0, |(i, j)| all.matrix[i][j] / (self.per * other.per))
    }
}

fn value(prior: &PriorSpec, from: &PriorRecord, density_kg_m3: Option<f64>) -> Result<Found, RecordError> {
    let wrong = |key: &str, problem: String| RecordError::value(from.place.clone(), key, problem);
    if !from.path.exists() {
        let (place, path) = (from.place.clone(), from.path.clone());
        return Err(RecordError::MissingFile { place, key: "record".to_owned(), path });
    }
    let file = read_estimates(&from.path)?;
    let named = |e: &&Estimate| from.select.as_ref().is_none_or(|id| *id == e.id);
    let has = |e: &&Estimate| e.coefficients.contains_key(&from.entry);
    let with: Vec<&Estimate> = file.estimates.iter().filter(named).filter(has).collect();
    let recommended: Vec<&&Estimate> = with.iter().filter(|e| e.recommended).collect();
    let estimate = match (recommended.as_slice(), with.as_slice()) {
        ([one], _) => Some(**one),
        (_, [one]) => Some(*one),
        (_, []) => None,
        _ => {
            let ids: Vec<&str> = with.iter().map(|e| e.id.as_str()).collect();
            let problem = format!("is in several estimates; name one with select = \"…\": {}", ids.join(", "));
            return Err(wrong("entry", problem));
        }
    };
    let estimate = estimate.ok_or_else(|| {
        let names = |e: &Estimate| e.coefficients.keys().cloned().collect::<Vec<_>>().join(", ");
        let there: Vec<String> = file.estimates.iter().map(|e| format!("{} with {}", e.id, names(e))).collect();
        let (path, there) = (from.path.display(), there.join("; "));
        wrong("entry", format!("is {:?}, which {path} does not contain; it contains {there}", from.entry))
    })?;
    let Some((entry, found)) = estimate.coefficients.get(&from.entry).and_then(|c| Some((c, c.value?))) else {
        return Err(wrong("entry", format!("is {:?}, which {} does not determine", from.entry, estimate.id)));
    };
    let unit = parse_unit(&entry.unit).map(|u| u.dimension).ok();
    let inertia = Dimension::new(2, 1, 0);
    if prior.coefficient == "lambda_1" && unit != Some(inertia) {
        let problem = format!("is {}, in {}; lambda_1 is in kg m^2, as A66 is", from.entry, entry.unit);
        return Err(wrong("entry", problem));
    }
    let of_record = estimate.refers_to.get("density").map(|density| density.value);
    let per = match from.volume_m3 {
        // An added mass is proportional to the density: it is taken in the water of the test.
        None if unit == Some(Dimension::MASS) || unit == Some(inertia) => {
            of_record.zip(density_kg_m3).map_or(1.0, |(there, here)| there / here)
        }
        None => 1.0,
        Some(_) if unit != Some(Dimension::MASS) => {
            let problem = format!("turns a mass into C_A, and {} is in {}; leave it out", from.entry, entry.unit);
            return Err(wrong("volume", problem));
        }
        Some(volume) => {
            let density = of_record.ok_or_else(|| {
                wrong("volume", format!("gives C_A = A/(ρV), and {} states no density that it refers to", estimate.id))
            })?;
            density * volume
        }
    };
    let is_coefficient = prior.coefficient.starts_with("C_");
    if is_coefficient && from.volume_m3.is_none() && unit != Some(Dimension::ONE) {
        let problem = format!(
            "is needed: {} is a pure number and {} is in {}; write volume = \"1.27e-3 m^3\", the volume that {} refers to",
            prior.coefficient, from.entry, entry.unit, prior.coefficient
        );
        return Err(wrong("volume", problem));
    }
    let value = found / per;
    let standard = (entry.standard_uncertainty.unwrap_or(0.0) / per).hypot(from.model_form * value);
    if standard <= 0.0 {
        let problem =
            format!("{} has no uncertainty in {}; write model_form = \"5 %\", for example", from.entry, estimate.id);
        return Err(wrong("model_form", problem));
    }
    let (path, estimate) = (from.path.clone(), estimate.clone());
    Ok(Found { value, standard, dof: entry.effective_dof, per, path, entry: from.entry.clone(), estimate })
}
