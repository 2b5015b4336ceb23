//! The drag law of a forced oscillation: the force of the water across the body, as known motions times coefficients.

use froude_fit::faer::Mat;
use froude_hydro::Axis;
use froude_identify::dataset::Dataset;
use froude_identify::law::{ForceLaw, Kind};
use froude_identify::method::MethodError;
use froude_identify::source::laws;
use froude_records::campaign::{Campaign, Source};
use froude_records::texts::Texts;
use froude_records::units::Dimension;

use crate::error::TankError;

/// The load that the cell shows.
pub(super) const LOAD: &str = "f_y";
/// The drag law where none is asked for.
const DEFAULT_LAW: &str = "linear_quadratic";

/// A drag law as the force across the body.
#[derive(Debug, Clone)]
pub struct Drag {
    /// The law.
    pub law: ForceLaw,
    /// Which of its responses is [`LOAD`].
    response: usize,
    /// Its coefficients that move that response, as indices into the law's.
    pub columns: Vec<usize>,
}

impl Drag {
    /// A law that is linear in its coefficients and states the force across the body.
    ///
    /// # Errors
    ///
    /// Any other.
    pub fn new(law: ForceLaw) -> Result<Self, TankError> {
        let refuse = |why: &str| Err(TankError::new(format!("model {} {why}", law.name)));
        let Some(response) = law.responses.iter().position(|r| r == LOAD) else {
            return refuse("states no f_y, the force across the body; write one, or leave the model out");
        };
        let columns = match &law.kind {
            Kind::Drag { model, .. } => {
                model.coefficients().iter().enumerate().filter(|(_, c)| c.axis == Axis::Y).map(|(j, _)| j).collect()
            }
            Kind::Formulas(formulas) => {
                formulas[response].coefficients.iter().filter_map(|(name, _)| law.position(name)).collect()
            }
            Kind::PowerLaw { .. } | Kind::Thruster { .. } => {
                return refuse(
                    "is not linear in its coefficients, and this method fits such laws only; use linear_quadratic",
                );
            }
        };
        Ok(Self { law, response, columns })
    }

    /// −X at velocities through the water, N per coefficient.
    pub(super) fn columns_at(
        &self,
        velocity_m_s: [Vec<f64>; 2],
        density_kg_m3: f64,
        n_links: Option<f64>,
    ) -> Result<Vec<Vec<f64>>, TankError> {
        let n = velocity_m_s[0].len();
        let x: Mat<f64> = self.law.regressors(&channels(velocity_m_s, density_kg_m3, n_links), &[])?;
        let first = self.response * n;
        Ok(self.columns.iter().map(|&j| (first..first + n).map(|i| -x[(i, j)]).collect()).collect())
    }

    /// Names and units of its coefficients.
    pub fn coefficients(&self) -> impl Iterator<Item = (&str, &str)> {
        self.columns.iter().map(|&j| (self.law.coefficients[j].name.as_str(), self.law.coefficients[j].unit.as_str()))
    }
}

/// The drag laws that the source asks for, as the force across the body; `are_links` is whether every configuration is a chain of links.
///
/// # Errors
///
/// An unknown law, or one that cannot be used here.
pub(super) fn drags(
    campaign: &Campaign,
    source: &Source,
    density_kg_m3: f64,
    are_links: bool,
) -> Result<Vec<Drag>, MethodError> {
    let mut data = channels([vec![0.1], vec![0.1]], density_kg_m3, are_links.then_some(1.0));
    data.configuration = Texts::repeated("", 1);
    (data.setup, data.run, data.line) = (data.configuration.clone(), data.configuration.clone(), vec![1]);
    data.put(LOAD, vec![0.0], Dimension::FORCE);
    let mut asking = source.clone();
    let nobody =
        source.models.is_empty() && campaign.identify.models.is_empty() && campaign.identify.user_models.is_empty();
    if nobody {
        asking.models = vec![DEFAULT_LAW.to_owned()];
    }
    let laws = laws(campaign, &asking, &data)?;
    laws.into_iter().map(|law| Drag::new(law).map_err(MethodError::refused)).collect()
}

/// What a drag law is evaluated with.
fn channels([v_x, v_y]: [Vec<f64>; 2], density_kg_m3: f64, n_links: Option<f64>) -> Dataset {
    let n = v_x.len();
    let mut data = Dataset { rows: n, ..Dataset::default() };
    data.put("v_x", v_x, Dimension::SPEED);
    data.put("v_y", v_y, Dimension::SPEED);
    data.speed_and_angle_from_velocity();
    data.put("density", vec![density_kg_m3; n], Dimension::DENSITY);
    if let Some(links) = n_links {
        data.put("n_links", vec![links; n], Dimension::ONE);
    }
    data
}
