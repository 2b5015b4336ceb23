//! A chain from a robot file and the records that it names.
//!
//! **Drag.** A record's law f1 to f6 with the geometry that its coefficients refer to, in the robot's water: forces go with ρ. It is shared out among the robot's modules ([`crate::shares`]).
//! **Added mass.** Of each module (`added`): declared, a matrix of potential flow, or μ = ρ V C_A with the volume of a link that the record's C_A refers to and λ₁ = μ l²/3 (strips). C_A alone says nothing: 1.2674 of the
//! paper belongs to 1.2723e-3 m³ and 1.653 kg, and not to πa²·2l, which would give 2.54 kg.
//!
//! **Source.** USR eq. 4 and 8 to 15.

use std::fmt::Display;
use std::path::Path;

use froude_hydro::{Body, CrossTerm, DragModel, Link as Section, Setting};
use froude_records::RecordError;
use froude_records::estimate::{Estimate, EstimateFile};
use froude_records::json::read_estimates;

use crate::chain::Chain;
use crate::robot_file::{FromRecord, RobotFile};

/// Why a robot file and its records do not define a robot.
#[derive(Debug, thiserror::Error)]
pub enum RobotError {
    /// A record cannot be read.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// It says something else than a robot needs; with the file.
    #[error("{0}")]
    Unfit(String),
}

impl RobotError {
    /// Of a record.
    pub(crate) fn of(record: &Path, problem: impl Display) -> Self {
        Self::Unfit(format!("{}: {problem}", record.display()))
    }

    /// An estimate without a coefficient.
    pub(crate) fn undetermined(from: &FromRecord, e: &Estimate, name: &str) -> Self {
        let id = &e.id;
        let problem = format!(
            "{id} does not determine {name}: a robot cannot swim without it; choose an estimate that does, or hold it in the campaign"
        );
        Self::of(&from.path, problem)
    }
}

/// A robot that can swim.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot<C = Chain> {
    /// Its links.
    pub chain: C,
    /// Ids of the estimates of drag and, where it comes from one, of added mass.
    pub estimates: (String, Option<String>),
    /// Whether its added mass is that of a link by C_A.
    pub is_by_link: bool,
    /// The link that its coefficients of drag refer to.
    pub refers_to: Section,
    /// Speeds at which the drag was fitted, m/s, as far as the record says.
    pub speed_m_s: Option<[f64; 2]>,
    /// Angles to the flow at which it was fitted, rad, as far as the record says.
    pub angle_rad: Option<[f64; 2]>,
    /// kg.
    pub mass_kg: f64,
    /// Mass less that of the water displaced, kg; `None` where a module does not say its volume.
    pub heavy_kg: Option<f64>,
}

/// The record that is named, and which of its estimates.
pub(crate) fn selected(from: &FromRecord) -> Result<(EstimateFile, usize), RobotError> {
    let file = read_estimates(&from.path)?;
    let at = match &from.select {
        Some(id) => file.estimates.iter().position(|e| e.id == *id),
        None if file.estimates.len() == 1 => Some(0),
        None => {
            let recommended: Vec<usize> =
                (0..file.estimates.len()).filter(|i| file.estimates[*i].recommended).collect();
            if let [one] = recommended[..] { Some(one) } else { None }
        }
    };
    let Some(at) = at else {
        let asked = from.select.as_ref().map_or_else(
            || "it has no single recommended estimate: name one with select = \"…\"".to_owned(),
            |id| format!("no estimate is {id:?}"),
        );
        let known: Vec<&str> = file.estimates.iter().map(|e| e.id.as_str()).collect();
        return Err(RobotError::of(&from.path, format!("{asked}; it has {}", known.join(", "))));
    };
    Ok((file, at))
}

pub(crate) fn measure(from: &FromRecord, e: &Estimate, key: &str, of: &'static str) -> Result<f64, RobotError> {
    let missing = || {
        let (id, what) = (&e.id, key.replace('_', " "));
        let problem = format!("{id} does not say the {what} that its {of}; without it the numbers mean nothing");
        RobotError::of(&from.path, problem)
    };
    e.refers_to.get(key).map(|m| m.value).ok_or_else(missing)
}

/// What the coefficients of drag refer to, in the robot's water.
pub(crate) fn setting(file: &RobotFile, e: &Estimate) -> Result<Setting, RobotError> {
    let get = |key| measure(&file.drag, e, key, "coefficients of drag refer to");
    let link = Section {
        major_semi_axis_m: get("major_semi_axis")?,
        minor_semi_axis_m: get("minor_semi_axis")?,
        half_length_m: get("half_length")?,
    };
    let body = Body { link, head_side_area_m2: get("head_side_area")?, tail_side_area_m2: get("tail_side_area")? };
    let n_links = file.modules.len() as f64 - 2.0;
    Ok(Setting {
        v_ref_m_s: e.law.constants.get("v_ref").map_or(1.0, |m| m.value),
        cross_term: CrossTerm::Smooth { epsilon_m_s: file.model.smooth_m_s },
        ..Setting::as_published(body, n_links, file.density_kg_m3)
    })
}

pub(crate) fn law(from: &FromRecord, e: &Estimate) -> Result<(DragModel, Vec<f64>), RobotError> {
    let Some(model) = DragModel::from_name(&e.law.name) else {
        let problem = format!(
            "{} is the law {}; the drag of a robot is one of f1 to f6, which say what lies along and across a link: choose such an estimate with select",
            e.id, e.law.name
        );
        return Err(RobotError::of(&from.path, problem));
    };
    let value = |name: &str| {
        let found = e.coefficients.get(name).and_then(|c| c.value);
        found.ok_or_else(|| RobotError::undetermined(from, e, name))
    };
    Ok((model, model.coefficients().iter().map(|c| value(c.name)).collect::<Result<_, _>>()?))
}
