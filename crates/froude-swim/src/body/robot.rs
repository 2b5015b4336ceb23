//! A chain from a robot file and the records that it names.
//!
//! **Drag.** A record's law f1 to f6 with the geometry that its coefficients refer to, in the robot's water: forces go with ρ. It is shared out among the robot's modules ([`crate::shares`]).
//! **Added mass.** Of each module (`added`): declared, a matrix of potential flow, or μ = ρ V C_A with the volume of a link that the record's C_A refers to and λ₁ = μ l²/3 (strips). C_A alone says nothing: 1.2674 of the
//! paper belongs to 1.2723e-3 m³ and 1.653 kg, and not to πa²·2l, which would give 2.54 kg.
//!
//! **Source.** USR eq. 4 and 8 to 15.

use std::path::PathBuf;

use froude_hydro::{Body, CrossTerm, DragModel, Link as Section, Setting};
use froude_records::RecordError;
use froude_records::estimate::{Estimate, EstimateFile};
use froude_records::json::read_estimates;

use crate::chain::Chain;
use crate::robot_file::{FromRecord, RobotFile};

/// Why a robot does not swim.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RobotError {
    /// A file that cannot be read, or says something impossible.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A record without such an estimate.
    #[error("{}: {asked}; it has {}", .path.display(), .known.join(", "))]
    Select {
        /// The record.
        path: PathBuf,
        /// What was asked for.
        asked: String,
        /// Ids of its estimates.
        known: Vec<String>,
    },
    /// An estimate whose law is none of a robot's drag.
    #[error("{}: {id} is the law {law}; the drag of a robot is one of f1 to f6, which say what lies along and across a link: choose such an estimate with select", .path.display())]
    Law {
        /// The record.
        path: PathBuf,
        /// The estimate.
        id: String,
        /// Its law.
        law: String,
    },
    /// A coefficient that nothing determines.
    #[error("{}: {id} does not determine {name}: a robot cannot swim without it; choose an estimate that does, or hold it in the campaign", .path.display())]
    Undetermined {
        /// The record.
        path: PathBuf,
        /// The estimate.
        id: String,
        /// The coefficient.
        name: String,
    },
    /// Torques of a friction that the law does not tell.
    #[error("{id} is {law}, which has no friction of links: write torque = \"cross_flow\", or drag = \"strip\"")]
    NoFriction {
        /// The estimate.
        id: String,
        /// Its law.
        law: String,
    },
    /// An added mass that is none.
    #[error("{}: C_A of {id} is {value}; an added mass is above zero", .path.display())]
    NotPositive {
        /// The record.
        path: PathBuf,
        /// The estimate.
        id: String,
        /// C_A.
        value: f64,
    },
    /// An estimate without an added mass that a link has.
    #[error(
        "{}: {id} has no C_A. The added mass of a link comes from C_A with the volume of a link that it refers to (forced oscillation, accelerated tow), or is written in numbers: \
         added_mass = {{ sway = \"1.65 kg\", yaw = \"4.5e-3 kg m^2\" }}",
        .path.display()
    )]
    NoAdded {
        /// The record.
        path: PathBuf,
        /// The estimate.
        id: String,
    },
    /// An added mass of sway for three dimensions.
    #[error(
        "{id} has C_A, which is of sway alone, and three dimensions need the added mass of all six motions: write them in numbers, or name the record of froude added-mass of one module"
    )]
    SwayAlone {
        /// The estimate.
        id: String,
    },
    /// A matrix that is none of a module.
    #[error("{}: the added mass of {id} {problem}", .path.display())]
    Matrix {
        /// The record.
        path: PathBuf,
        /// The estimate.
        id: String,
        /// What is wrong, and what to do.
        problem: String,
    },
    /// Coefficients without what they refer to.
    #[error("{}: {id} does not say the {what} that its {of}; without it the numbers mean nothing", .path.display())]
    RefersTo {
        /// The record.
        path: PathBuf,
        /// The estimate.
        id: String,
        /// What is missing.
        what: String,
        /// Whose it is.
        of: &'static str,
    },
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
        let known = file.estimates.iter().map(|e| e.id.clone()).collect();
        return Err(RobotError::Select { path: from.path.clone(), asked, known });
    };
    Ok((file, at))
}

pub(crate) fn measure(from: &FromRecord, e: &Estimate, key: &str, of: &'static str) -> Result<f64, RobotError> {
    let missing =
        || RobotError::RefersTo { path: from.path.clone(), id: e.id.clone(), what: key.replace('_', " "), of };
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
        return Err(RobotError::Law { path: from.path.clone(), id: e.id.clone(), law: e.law.name.clone() });
    };
    let value = |name: &str| {
        e.coefficients.get(name).and_then(|c| c.value).ok_or_else(|| RobotError::Undetermined {
            path: from.path.clone(),
            id: e.id.clone(),
            name: name.to_owned(),
        })
    };
    Ok((model, model.coefficients().iter().map(|c| value(c.name)).collect::<Result<_, _>>()?))
}
