//! A chain from a robot file and the records that it names.
//!
//! **Drag.** A record's law f1 to f6 with the geometry that its coefficients refer to, in the robot's water: forces go with ρ. It is shared out among the robot's modules ([`crate::shares`]).
//! **Added mass.** Declared per module, or μ = ρ V C_A with the volume of a link that the record's C_A refers to and λ₁ = μ l²/3 (strips). C_A alone says nothing: 1.2674 of the
//! paper belongs to 1.2723e-3 m³ and 1.653 kg, and not to πa²·2l, which would give 2.54 kg.
//!
//! **Source.** USR eq. 4 and 8 to 15.

use std::path::PathBuf;

use froude_hydro::{Body, CrossTerm, DragModel, Link as Section, Setting};
use froude_records::RecordError;
use froude_records::estimate::{Coefficient, Estimate, EstimateFile, Range};
use froude_records::json::read_estimates;
use froude_records::robot::{AddedForm, AddedFrom, DragForm, FromRecord, RobotFile};

use crate::chain::{AddedMass, Chain, Link};
use crate::planar::Inertia;
use crate::shares::{Distribution, Torque, shares};

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
pub struct Robot {
    /// Its links.
    pub chain: Chain,
    /// Ids of the estimates of drag and, where it comes from one, of added mass.
    pub estimates: (String, Option<String>),
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

impl Robot {
    /// The robot of a file.
    ///
    /// # Errors
    ///
    /// [`RobotError`]: records that cannot be read, estimates that are none of a robot, numbers without what they refer to.
    pub fn of(file: &RobotFile) -> Result<Self, RobotError> {
        let (record, at) = selected(&file.drag)?;
        let drag = &record.estimates[at];
        let setting = setting(file, drag)?;
        let (model, coefficients) = law(&file.drag, drag)?;
        let distribution = if file.model.is_by_origin { Distribution::ByOrigin } else { Distribution::Uniform };
        let torque = match file.model.drag {
            DragForm::Strip => Torque::Strip,
            DragForm::Friction => Torque::Friction,
            DragForm::CrossFlow => Torque::CrossFlow,
            DragForm::Lumped => Torque::None,
        };
        if torque == Torque::Friction && model == DragModel::F6 {
            return Err(RobotError::NoFriction { id: drag.id.clone(), law: drag.law.name.clone() });
        }
        let drags = shares(model, &setting, &coefficients, (distribution, torque));
        let (added, added_id) = added(file)?;
        let links = file.modules.iter().zip(drags).map(|(module, drag)| {
            let l = module.link.half_length_m;
            let [surge, sway, yaw] = added.unwrap_or_else(|per_link| [0.0, per_link, per_link * l * l / 3.0]);
            Link {
                half_length_m: l,
                rigid: Inertia::rigid(module.mass_kg, module.inertia_kg_m2, module.ahead_m),
                added: Inertia { turn: yaw, x: surge, y: sway, ..Inertia::default() },
                drag,
            }
        });
        let added_mass = match file.model.added_mass {
            AddedForm::Full => AddedMass::Full,
            AddedForm::Usr => AddedMass::Usr,
        };
        let mass_kg = file.modules.iter().map(|m| m.mass_kg).sum();
        let displaced: Option<f64> = file.modules.iter().map(|m| Some(m.volume_m3? * file.density_kg_m3)).sum();
        let range = |key: &str| drag.validity.get(key).map(|Range { low, high, .. }| [*low, *high]);
        Ok(Self {
            chain: Chain { links: links.collect(), added_mass },
            estimates: (drag.id.clone(), added_id),
            refers_to: setting.body.link,
            speed_m_s: range("speed"),
            angle_rad: range("angle"),
            mass_kg,
            heavy_kg: displaced.map(|displaced| mass_kg - displaced),
        })
    }
}

/// The record that is named, and which of its estimates.
fn selected(from: &FromRecord) -> Result<(EstimateFile, usize), RobotError> {
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

fn measure(from: &FromRecord, e: &Estimate, key: &str, of: &'static str) -> Result<f64, RobotError> {
    let missing =
        || RobotError::RefersTo { path: from.path.clone(), id: e.id.clone(), what: key.replace('_', " "), of };
    e.refers_to.get(key).map(|m| m.value).ok_or_else(missing)
}

/// What the coefficients of drag refer to, in the robot's water.
fn setting(file: &RobotFile, e: &Estimate) -> Result<Setting, RobotError> {
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

fn law(from: &FromRecord, e: &Estimate) -> Result<(DragModel, Vec<f64>), RobotError> {
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

/// Surge, sway and yaw of a module as declared, or the sway of a link by its record.
fn added(file: &RobotFile) -> Result<(Result<[f64; 3], f64>, Option<String>), RobotError> {
    let from = match &file.added_mass {
        AddedFrom::Declared(all) => return Ok((Ok(*all), None)),
        AddedFrom::Record(from) => from,
    };
    let (record, at) = selected(from)?;
    let e = &record.estimates[at];
    let coefficient = |name: &str| e.coefficients.get(name).and_then(|c: &Coefficient| c.value);
    let Some(c_a) = coefficient("C_A").or_else(|| coefficient("C_Ay")) else {
        return Err(RobotError::NoAdded { path: from.path.clone(), id: e.id.clone() });
    };
    if c_a.is_nan() || c_a <= 0.0 {
        return Err(RobotError::NotPositive { path: from.path.clone(), id: e.id.clone(), value: c_a });
    }
    let volume = measure(from, e, "link_volume", "C_A refers to, of a link")?;
    Ok((Err(file.density_kg_m3 * volume * c_a), Some(e.id.clone())))
}
