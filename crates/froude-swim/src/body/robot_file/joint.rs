//! `[joint]`: what the joints of a robot allow, and what drives them.

use froude_records::RecordError;
use froude_records::section::Section;
use froude_records::units::Dimension;

use super::spatial::{DAMPING, not_negative};
use crate::drive::Following;
use crate::joints::Limits;

/// Limits where they are declared, and drives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct JointFile {
    /// What it allows.
    pub limits: Limits,
    /// How it follows its gait, but for its limits; `None`: exactly.
    pub servo: Option<Following>,
    /// From the battery to the joint.
    pub efficiency: Option<f64>,
    /// The part of what braking gives that goes back to the battery.
    pub regeneration: f64,
}

/// Keys that all joints may have together, …
const SHARED: [&str; 2] = ["efficiency", "regeneration"];
/// … and each its own.
const OWN: [&str; 6] = ["limit", "rate", "torque", "kp", "kd", "friction"];

/// What stands in a table, and else what all joints have; with the keys of the table that say which joints it is of.
pub(super) fn joint(
    s: &Section<'_>,
    which: &[&'static str],
    all: Option<&JointFile>,
) -> Result<JointFile, RecordError> {
    let shared = if all.is_none() { &SHARED[..] } else { &[] };
    let known: Vec<&'static str> = OWN.iter().chain(shared).chain(which).copied().collect();
    s.only(&known)?;
    let all = all.copied().unwrap_or_default();
    let efficiency = part(s, "efficiency")?;
    if let (Some(value), Some(0.0)) = (s.get("efficiency"), efficiency) {
        return Err(s.wrong("efficiency", value, "is 0; an efficiency is above zero and at most 1"));
    }
    let limits = Limits {
        angle_rad: s.positive("limit", Dimension::ANGLE)?,
        rate_rad_s: s.positive("rate", Dimension::ANGULAR_SPEED)?,
        torque_n_m: s.positive("torque", Dimension::MOMENT)?,
    };
    Ok(JointFile {
        limits: limits.or(all.limits),
        servo: servo(s)?.or(all.servo),
        efficiency: efficiency.or(all.efficiency),
        regeneration: part(s, "regeneration")?.unwrap_or(all.regeneration),
    })
}

fn servo(s: &Section<'_>) -> Result<Option<Following>, RecordError> {
    let (stiffness, damping) = (s.positive("kp", Dimension::MOMENT)?, s.positive("kd", DAMPING)?);
    let (stiffness_n_m, damping_n_m_s) = match (stiffness, damping, s.get("friction")) {
        (Some(stiffness), Some(damping), _) => (stiffness, damping),
        (Some(_), None, _) => return Err(s.missing("kd", "a servo has both: write kd = \"1 N m s/rad\"")),
        (None, Some(_), _) => return Err(s.missing("kp", "a servo has both: write kp = \"40 N m/rad\"")),
        (None, None, None) => return Ok(None),
        (None, None, Some(value)) => {
            let problem = "is of joints with servos, and here they follow the gait exactly: write kp and kd as well, or leave it out";
            return Err(s.wrong("friction", value, problem));
        }
    };
    let mut servo = Following { stiffness_n_m, damping_n_m_s, ..Following::default() };
    if let Some(friction) = s.section("friction")? {
        friction.only(&["viscous", "coulomb"])?;
        servo.viscous_n_m_s = not_negative(&friction, "viscous", DAMPING, "friction")?.unwrap_or(0.0);
        servo.dry_n_m = not_negative(&friction, "coulomb", Dimension::MOMENT, "friction")?.unwrap_or(0.0);
    }
    Ok(Some(servo))
}

/// From 0 to 1.
pub(crate) fn part(s: &Section<'_>, key: &'static str) -> Result<Option<f64>, RecordError> {
    let number = s.number(key)?;
    match (s.get(key), number) {
        (Some(value), Some(number)) if !(0.0..=1.0).contains(&number) => {
            let least = if key == "efficiency" { "above zero and" } else { "zero or more and" };
            Err(s.wrong(key, value, format!("is {number}; expected a part of one, {least} at most 1")))
        }
        _ => Ok(number),
    }
}
