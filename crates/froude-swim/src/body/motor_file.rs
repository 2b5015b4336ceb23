//! A motor file: what the drive of a joint gives at its speed.
//!
//! ```toml
//! schema = 1
//! name = "geared servo at 12 V"
//! curve = [["0 rpm", "6 N m"], ["63 rpm", "0 N m"]]   # speed and largest torque at the joint, from rest on; straight between them
//! efficiency = 0.6                   # from the battery to the joint; stands before that of the robot
//! regeneration = 0                   # the part of what braking gives that goes back
//! ```
//!
//! Torques fall with the speed, and beyond the last point there is none.

use std::path::Path;

use froude_records::RecordError;
use froude_records::read;
use froude_records::section::{Section, Source, found, parse};
use froude_records::units::Dimension;

use crate::robot_file::part;

/// Largest motor file.
const LIMIT: u64 = 1 << 20;

/// A motor.
#[derive(Debug, Clone, PartialEq)]
pub struct MotorFile {
    /// What it is called.
    pub name: String,
    /// Speed, rad/s, and largest torque, N m; two points at least.
    pub curve: Vec<[f64; 2]>,
    /// From the battery to the joint.
    pub efficiency: Option<f64>,
    /// The part of what braking gives that goes back.
    pub regeneration: Option<f64>,
}

/// Reads a motor file.
///
/// # Errors
///
/// [`RecordError`] with line and column: not TOML, a key that is missing or unknown, a quantity of another kind, a curve that is none.
pub fn read_motor(path: &Path) -> Result<MotorFile, RecordError> {
    parse_motor(path, &read::text(path, LIMIT, "a motor")?)
}

/// The same from text.
///
/// # Errors
///
/// As [`read_motor`].
pub fn parse_motor(path: &Path, text: &str) -> Result<MotorFile, RecordError> {
    let source = Source { path, text };
    let document = parse(source)?;
    let s = Section::new(source, "", document.get_ref(), 0);
    s.schema("motor")?;
    s.only(&["schema", "name", "curve", "efficiency", "regeneration"])?;
    Ok(MotorFile {
        name: s.text("name")?.unwrap_or("motor").to_owned(),
        curve: curve(&s)?,
        efficiency: part(&s, "efficiency")?,
        regeneration: part(&s, "regeneration")?,
    })
}

fn curve(s: &Section<'_>) -> Result<Vec<[f64; 2]>, RecordError> {
    const EXAMPLE: &str = "[[\"0 rpm\", \"6 N m\"], [\"63 rpm\", \"0 N m\"]]";
    let value = s.get("curve").ok_or_else(|| s.missing("curve", &format!("write curve = {EXAMPLE}")))?;
    let expected =
        |value| s.wrong("curve", value, format!("is {}; expected points of speed and torque: {EXAMPLE}", found(value)));
    let list = value.get_ref().as_array().ok_or_else(|| expected(value))?;
    let mut curve: Vec<[f64; 2]> = Vec::new();
    for point in list {
        let Some([speed, torque]) = point.get_ref().as_array().map(|pair| &pair[..]) else {
            return Err(expected(point));
        };
        let here = [
            s.as_quantity_of("curve", speed, Dimension::ANGULAR_SPEED)?,
            s.as_quantity_of("curve", torque, Dimension::MOMENT)?,
        ];
        if here.iter().any(|x| *x < 0.0) {
            return Err(s.wrong("curve", point, "has a number below zero; a curve is of sizes, alike to both sides"));
        }
        if let Some([before, more]) = curve.last().copied() {
            if here[0] <= before {
                return Err(s.wrong(
                    "curve",
                    speed,
                    format!("is {}, which is not above the speed before it", found(speed)),
                ));
            }
            if here[1] > more {
                return Err(s.wrong(
                    "curve",
                    torque,
                    format!("is {}, which is more than at the lower speed before it", found(torque)),
                ));
            }
        } else if here[0] > 0.0 {
            return Err(s.wrong("curve", speed, format!("is {}; a curve begins at rest, \"0 rpm\"", found(speed))));
        }
        curve.push(here);
    }
    if curve.len() < 2 {
        return Err(s.wrong("curve", value, format!("has {} points; it needs two at least: {EXAMPLE}", curve.len())));
    }
    Ok(curve)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motor_is_read_and_what_is_none_is_reported_with_its_place() {
        let of = |curve: &str| parse_motor(Path::new("motor.toml"), &format!("schema = 1\ncurve = {curve}\n"));
        let motor = of("[[\"0 rpm\", \"6 N m\"], [\"60 rpm\", \"0 N m\"]]\nefficiency = 0.6").unwrap();
        assert_eq!(motor.curve, [[0.0, 6.0], [std::f64::consts::TAU, 0.0]]);
        assert_eq!((motor.efficiency, motor.regeneration), (Some(0.6), None));
        let refused = |curve: &str| of(curve).unwrap_err().to_string();
        assert!(refused("[[\"0 rpm\", \"6 N m\"]]").contains("two at least"));
        let rises = refused("[[\"0 rpm\", \"6 N m\"], [\"60 rpm\", \"7 N m\"]]");
        assert!(rises.starts_with("motor.toml:2:41") && rises.contains("more than"), "{rises}");
        assert!(refused("[[\"5 rpm\", \"6 N m\"], [\"60 rpm\", \"0 N m\"]]").contains("begins at rest"));
        assert!(refused("[\"0 rpm\", \"6 N m\"]").contains("points of speed and torque"));
        assert!(refused("[[\"0 rpm\", \"-6 N m\"], [\"60 rpm\", \"0 N m\"]]").contains("below zero"));
    }
}
