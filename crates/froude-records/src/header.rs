//! Headers as laboratories write them, `U (m/s)`, and what to write for them: `speed [m/s]`.
//!
//! Nothing is read by this: a header in round parentheses is refused, because `drag (tare)` is none with a unit. But the refusal says what to
//! write, letter by letter.

use std::path::Path;

use crate::known_columns::{is_text_column, known_dimension};
use crate::toml_text::key_word;
use crate::units::{Dimension, parse_unit};

/// A header with its unit in round parentheses.
#[derive(Debug, Clone, PartialEq, Eq)]
struct Round<'h> {
    header: &'h str,
    /// What Froude calls it, where that is known; else its own name.
    name: String,
    unit: String,
    /// A resistance: written positive where the load of the water, `f_x`, is negative.
    is_resistance: bool,
}

impl Round<'_> {
    fn head(&self) -> String {
        format!("{} [{}]", self.name, self.unit)
    }
}

/// Names that laboratories give to what is known under another, by what they measure; without spaces, lines and capitals.
const KNOWN: [(Dimension, &[&str], &str); 21] = [
    (
        Dimension::SPEED,
        &["u", "v", "speed", "velocity", "vel", "carriagespeed", "towingspeed", "towspeed", "flowspeed"],
        "speed",
    ),
    (Dimension::SPEED, &["vx"], "v_x"),
    (Dimension::SPEED, &["vy"], "v_y"),
    (Dimension::SPEED, &["vz", "w"], "v_z"),
    (Dimension::FORCE, &["fx", "x", "drag", "resistance", "dragforce", "d", "r", "rt"], "f_x"),
    (Dimension::FORCE, &["fy", "y", "sway", "sideforce", "lateralforce"], "f_y"),
    (Dimension::FORCE, &["fz", "z", "heave"], "f_z"),
    (Dimension::MOMENT, &["mx", "k", "rollmoment"], "m_x"),
    (Dimension::MOMENT, &["my", "m", "pitchmoment"], "m_y"),
    (Dimension::MOMENT, &["mz", "n", "yawmoment"], "m_z"),
    (Dimension::ANGULAR_SPEED, &["wx", "p"], "w_x"),
    (Dimension::ANGULAR_SPEED, &["wy", "q"], "w_y"),
    (Dimension::ANGULAR_SPEED, &["wz", "r", "yawrate"], "w_z"),
    (Dimension::ANGLE, &["angle"], "angle"),
    // Their sign is somebody's own: they keep their names, and what reads them says which sign the angle has.
    (Dimension::ANGLE, &["beta", "β"], "beta"),
    (Dimension::ANGLE, &["drift", "driftangle"], "drift"),
    (Dimension::TEMPERATURE, &["t", "tw", "temp", "temperature", "watertemperature"], "temperature"),
    (Dimension::DENSITY, &["rho", "ρ", "density"], "density"),
    (Dimension::KINEMATIC_VISCOSITY, &["nu", "ν", "viscosity"], "kinematic_viscosity"),
    (Dimension::VOLUME, &["volume"], "volume"),
    (Dimension::TIME, &["t", "time"], "time"),
];
/// Those of them that are written positive against the motion.
const RESISTANCES: [&str; 6] = ["drag", "resistance", "dragforce", "d", "r", "rt"];

/// Reads a header of round parentheses; `None` for any other, and where no unit stands in them.
fn round(header: &str) -> Option<Round<'_>> {
    let inner = header.trim().strip_suffix(')')?;
    let at = inner.match_indices('(').map(|(at, _)| at);
    let (name, unit) = at.map(|at| (inner[..at].trim(), inner[at + 1..].trim())).find(|(name, unit)| {
        // A pure number has no unit to stand there: `drag (1)` is the first of two.
        !name.is_empty() && unit.parse::<f64>().is_err() && parse_unit(unit).is_ok()
    })?;
    let dimension = parse_unit(unit).ok()?.dimension;
    let plain: String = name.to_lowercase().chars().filter(|c| !matches!(c, ' ' | '_' | '-')).collect();
    let known = KNOWN.iter().find(|(of, names, _)| *of == dimension && names.contains(&plain.as_str()));
    let known = known.map(|(.., known)| *known).filter(|_| dimension != Dimension::ANGLE || is_angle(unit));
    Some(Round {
        header,
        name: known.unwrap_or(name).to_owned(),
        unit: unit.to_owned(),
        is_resistance: known == Some("f_x") && RESISTANCES.contains(&plain.as_str()),
    })
}

fn is_angle(unit: &str) -> bool {
    matches!(unit, "deg" | "°" | "rad")
}

/// What to write for `header`, one of `headers`, whose unit stands in round parentheses; `None` where none does.
pub(crate) fn advice(path: &Path, header: &str, headers: &[String]) -> Option<String> {
    let mut all: Vec<Option<Round<'_>>> = headers.iter().map(|header| round(header)).collect();
    let names: Vec<String> =
        headers.iter().zip(&all).map(|(h, r)| r.as_ref().map_or(h.as_str(), |r| &r.name).to_owned()).collect();
    // Of two columns that seem the same neither is renamed: somebody has to say which is which.
    for (i, round) in all.iter_mut().enumerate() {
        if let Some(round) = round
            && names.iter().enumerate().any(|(j, name)| j != i && name == &round.name)
        {
            round.name = round.header.split('(').next().unwrap_or_default().trim().to_owned();
            round.is_resistance = false;
        }
    }
    // Beside a side force or a yaw moment v is the velocity that makes them.
    if all.iter().flatten().any(|round| matches!(round.name.as_str(), "f_y" | "m_z")) {
        let is_v = |round: &Round<'_>| round.header.split('(').next().is_some_and(|name| name.trim() == "v");
        for round in all.iter_mut().flatten().filter(|round| is_v(round) && round.name == "speed") {
            "v_y".clone_into(&mut round.name);
        }
    }
    let own = all.iter().flatten().find(|round| round.header.trim() == header.trim())?;
    let mut text = format!("units stand in square brackets; write `{}`", own.head());
    if all.iter().flatten().any(|round| round.is_resistance) {
        // Renaming would turn a drag into a thrust.
        text = format!(
            "units stand in square brackets, and a drag that is written positive is -f_x; leave the table as it is, and write a sidecar \
             {}:\n  schema = 1\n  [columns]\n{}",
            sidecar(path),
            headers.iter().zip(&all).filter_map(|(h, r)| line(h, r.as_ref())).collect::<Vec<_>>().join("\n")
        );
    } else if all.iter().flatten().count() > 1 {
        let heads: Vec<String> =
            headers.iter().zip(&all).map(|(h, r)| r.as_ref().map_or_else(|| h.clone(), Round::head)).collect();
        text += &format!("; all headers: `{}`", heads.join(","));
    }
    Some(text)
}

/// What a sidecar of this table may be called.
fn sidecar(path: &Path) -> String {
    let name = |extension: &str| {
        path.with_extension(extension).file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
    };
    // A campaign may have the table's name.
    let is_taken = path.with_extension("toml").exists();
    if is_taken { format!("{}, to be named with --sidecar", name("columns.toml")) } else { name("toml") }
}

/// The line of a column in a sidecar; `None` for one that Froude has no use for.
fn line(header: &str, round: Option<&Round<'_>>) -> Option<String> {
    let key = key_word(header);
    match round {
        Some(Round { name, unit, is_resistance, .. }) => {
            let sign = if *is_resistance { ", sign = -1" } else { "" };
            Some(format!("  {key} = {{ name = \"{name}\", unit = \"{unit}\"{sign} }}"))
        }
        None if is_text_column(header) => Some(format!("  {key} = {{ name = \"{header}\" }}")),
        None => {
            let (name, unit) = header.split_once('[')?;
            let (name, unit) = (name.trim(), unit.trim_end().strip_suffix(']')?);
            known_dimension(name)?;
            Some(format!("  {key} = {{ name = \"{name}\", unit = \"{unit}\" }}"))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(headers: &[&str], of: &str) -> Option<String> {
        let headers: Vec<String> = headers.iter().map(|header| (*header).to_owned()).collect();
        advice(Path::new("tank/t.csv"), of, &headers)
    }

    #[test]
    fn the_header_to_write_is_said_letter_by_letter() {
        let one = |header: &str| said(&[header], header);
        let write = |head: &str| Some(format!("units stand in square brackets; write `{head}`"));
        assert_eq!(one("U (m/s)"), write("speed [m/s]"));
        assert_eq!(one("Carriage speed(mm/s)"), write("speed [mm/s]"));
        assert_eq!(one("F_x (N)"), write("f_x [N]"));
        assert_eq!(one("Mz (N m)"), write("m_z [N m]"));
        assert_eq!(one("Beta (°)"), write("beta [°]"));
        assert_eq!(one("angle (deg)"), write("angle [deg]"));
        assert_eq!(one("T (degC)"), write("temperature [degC]"));
        assert_eq!(one("t (s)"), write("time [s]"));
        assert_eq!(one("strain (N) (N)"), write("strain (N) [N]"));
        assert_eq!(one("mu (kg/(m s))"), write("mu [kg/(m s)]"));
        for other in ["U [m/s]", "U", "drag (tare)", "run (1)", "(m/s)", "U (m/s) raw"] {
            assert_eq!(one(other), None, "{other}");
        }
    }

    #[test]
    fn v_is_sway_beside_a_side_force_and_a_speed_beside_a_drag() {
        let all = |headers: &[&str]| said(headers, headers[0]).unwrap();
        assert!(all(&["v (m/s)", "Y (N)"]).ends_with("`v_y [m/s],f_y [N]`"));
        assert!(all(&["v (m/s)", "Fx (N)"]).ends_with("`speed [m/s],f_x [N]`"));
        assert!(all(&["velocity (m/s)", "Y (N)"]).ends_with("`speed [m/s],f_y [N]`"));
    }

    #[test]
    fn two_columns_that_seem_the_same_keep_their_names() {
        assert_eq!(
            said(&["run", "U (m/s)", "V (m/s)", "Fx (N)"], "U (m/s)").unwrap(),
            "units stand in square brackets; write `U [m/s]`; all headers: `run,U [m/s],V [m/s],f_x [N]`"
        );
    }
}
