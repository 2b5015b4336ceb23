//! The force on the load cell as a sum of known motions times unknown coefficients.
//!
//! f_m = m a + C_A ρ V v̇_y − X(v) C − B sin φ, with X(v) C the drag law's force of the fluid on the body. Drag laws are those of every other test:
//! the simulator, the towing tank and this fit share one expression.

use std::ops::Range;

use froude_fit::faer::Mat;
use froude_hydro::Axis;
use froude_hydro::swing::{Kinematics, Medium};
use froude_identify::dataset::Dataset;
use froude_identify::law::{ForceLaw, Kind};
use froude_identify::method::MethodError;
use froude_identify::source::laws;
use froude_records::campaign::{Campaign, Source};
use froude_records::texts::Texts;
use froude_records::units::Dimension;

use super::setup::{LOAD, OscillationRun, Setup};
use crate::error::TankError;
use crate::motion::Motion;

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
            Kind::PowerLaw { .. } => {
                return refuse(
                    "is not linear in its coefficients, and this method fits such laws only; use linear_quadratic",
                );
            }
        };
        Ok(Self { law, response, columns })
    }

    /// Names and units of its coefficients.
    pub fn coefficients(&self) -> impl Iterator<Item = (&str, &str)> {
        self.columns.iter().map(|&j| (self.law.coefficients[j].name.as_str(), self.law.coefficients[j].unit.as_str()))
    }
}

/// The drag laws that the source asks for, as the force across the body.
///
/// # Errors
///
/// An unknown law, or one that cannot be used here.
pub fn drags(campaign: &Campaign, source: &Source, setup: &Setup) -> Result<Vec<Drag>, MethodError> {
    let mut data = Dataset { rows: 1, ..Dataset::default() };
    data.configuration = Texts::repeated("", 1);
    (data.setup, data.run, data.line) = (data.configuration.clone(), data.configuration.clone(), vec![1]);
    data.put("v_x", vec![0.1], Dimension::SPEED);
    data.put("v_y", vec![0.1], Dimension::SPEED);
    data.speed_and_angle_from_velocity();
    data.put("density", vec![setup.density_kg_m3.value], Dimension::DENSITY);
    if setup.bodies.iter().all(|body| body.n_links.is_some()) {
        data.put("n_links", vec![1.0], Dimension::ONE);
    }
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

/// What is declared, as the equation takes it; each may be moved to see what its error does.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Values {
    pub radius_m: f64,
    pub mass_kg: Vec<f64>,
    pub density_kg_m3: f64,
    pub flow_factor: f64,
    pub angle_factor: f64,
}

impl Values {
    pub(super) fn of(setup: &Setup) -> Self {
        Self {
            radius_m: setup.radius_m.value,
            mass_kg: setup.bodies.iter().map(|b| b.mass_kg.value).collect(),
            density_kg_m3: setup.density_kg_m3.value,
            flow_factor: 1.0,
            angle_factor: 1.0,
        }
    }
}

/// Factors of mass, added mass, drag coefficients and buoyancy in the force on the cell, a number for each sample.
pub(super) struct Factors {
    /// Per mass, N/kg.
    pub mass: Vec<f64>,
    /// ρ V v̇_y, N.
    pub added: Vec<f64>,
    /// −X, N per coefficient.
    pub drag: Vec<Vec<f64>>,
    /// −sin φ.
    pub buoyancy: Vec<f64>,
}

impl Factors {
    /// At the samples `rows` of a run, the motion taken `delay_s` earlier than they are stamped.
    pub(super) fn of(
        run: &OscillationRun<'_>,
        motion: &Motion,
        rows: Range<usize>,
        delay_s: f64,
        (setup, values, drag): (&Setup, &Values, &Drag),
    ) -> Result<Self, TankError> {
        let body = &setup.bodies[run.body];
        let n = rows.len();
        let flow = run.flow_m_s * values.flow_factor;
        let kinematics: Vec<Kinematics> = (run.time_s[rows].iter())
            .map(|t| {
                let [angle, rate, second, _] = motion.angle.at(t - delay_s);
                let angle = [angle, rate, second].map(|x| values.angle_factor * x);
                Kinematics::of(angle, setup.pivot, values.radius_m, flow)
            })
            .collect();
        let each = |of: &dyn Fn(&Kinematics) -> f64| kinematics.iter().map(of).collect::<Vec<f64>>();
        let mass = each(&|k| k.per_mass(run.medium));
        if run.medium == Medium::Air {
            let zero = vec![0.0; n];
            return Ok(Self {
                mass,
                added: zero.clone(),
                drag: vec![zero.clone(); drag.columns.len()],
                buoyancy: zero,
            });
        }
        let mut data = Dataset { rows: n, ..Dataset::default() };
        data.put("v_x", each(&|k| k.velocity_m_s[0]), Dimension::SPEED);
        data.put("v_y", each(&|k| k.velocity_m_s[1]), Dimension::SPEED);
        data.speed_and_angle_from_velocity();
        data.put("density", vec![values.density_kg_m3; n], Dimension::DENSITY);
        if let Some(links) = body.n_links {
            data.put("n_links", vec![links; n], Dimension::ONE);
        }
        let x: Mat<f64> = drag.law.regressors(&data, &[])?;
        let first = drag.response * n;
        let column = |&j: &usize| (first..first + n).map(|i| -x[(i, j)]).collect();
        let volume = values.density_kg_m3 * body.reference_volume_m3;
        Ok(Self {
            mass,
            added: each(&|k| volume * k.sway_rate_m_s2),
            drag: drag.columns.iter().map(column).collect(),
            buoyancy: each(&|k| -k.upward),
        })
    }
}
