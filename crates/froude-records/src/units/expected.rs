//! Units where it is known what they must measure: a mass that stands for its weight, a frequency that may be a rate of turning.

use super::spellings::{one_spelling, whole};
use super::{Dimension, Unit, UnitError, bare, parse_unit};

/// Masses, and the unit of the force that each of them is pulled down with, under 9.80665 m/s².
const WEIGHTS: &[(&str, &str)] = &[("kg", "kgf"), ("g", "gf"), ("t", "tf"), ("lb", "lbf"), ("oz", "ozf")];

/// Units of an angle that say what a whole turn is.
const ANGLES: &[&str] = &["rad", "deg", "°", "gon", "rev", "rpm", "rps"];

/// Names under which a rate of turning is written, in small letters.
const RATES: &[&str] = &[
    "w_x",
    "w_y",
    "w_z",
    "wx",
    "wy",
    "wz",
    "p",
    "q",
    "r",
    "n",
    "n_p",
    "n_prop",
    "rpm",
    "rps",
    "omega",
    "ω",
    "rotation",
    "rotation_rate",
    "rotation_speed",
    "rotational_speed",
    "angular_speed",
    "angular_velocity",
    "angular_rate",
    "roll_rate",
    "pitch_rate",
    "yaw_rate",
    "yawrate",
    "turn_rate",
    "gyro",
    "gyro_x",
    "gyro_y",
    "gyro_z",
    "shaft_speed",
    "shaft_rate",
    "motor_speed",
    "motor_rpm",
    "rotor_speed",
    "rotspeed",
    "genspeed",
    "propeller_speed",
    "prop_speed",
    "revs",
    "revolutions",
    "drehzahl",
    "drehrate",
    "gierrate",
    "winkelgeschwindigkeit",
    "régime",
    "tours",
    "vitesse_angulaire",
    "velocidad_angular",
    "vinkelhastighet",
    "角速度",
    "vitesse_de_rotation",
    "turtall",
    "回転数",
];

/// Parts of names of accelerations, in small letters.
const ACCELERATIONS: [&str; 9] =
    ["acc", "accel", "acceleration", "ax", "ay", "az", "beschleunigung", "accélération", "加速度"];

/// Parts of names of forces, in small letters.
const FORCES: [&str; 14] = [
    "force",
    "drag",
    "thrust",
    "lift",
    "load",
    "kraft",
    "widerstand",
    "schub",
    "auftrieb",
    "résistance",
    "resistance",
    "fuerza",
    "抵抗",
    "推力",
];

/// Parts of names of pressures, in small letters.
const PRESSURES: [&str; 5] = ["pressure", "druck", "pression", "presión", "trykk"];

/// Whether a name has one of some words, numbers apart: `imu.acc_x`, `Kraft1`.
fn has_word(name: &str, words: &[&str]) -> bool {
    let mut parts = name.split(|c: char| !c.is_alphabetic());
    parts.any(|part| words.contains(&part))
}

/// What stands in a unit and has no place in one of this kind: the `deg` of `N/deg`, the `mV` and `V` of `N/(mV/V)`; none where all belongs.
///
/// Such a unit has the dimension that is expected, and is that of a slope, a derivative or a calibration.
#[must_use]
pub fn foreign_part(text: &str, expected: Dimension) -> Option<String> {
    let is_turning = expected.m == 0 && expected.kg == 0;
    let is_foreign = |word: &&str| {
        let part = parse_unit(word).map(|unit| unit.dimension);
        part.is_ok_and(|part| part == Dimension::ONE || (part.a != 0 && expected.a == 0))
    };
    let words = words(whole(text));
    if is_turning || words.len() < 2 { None } else { words.into_iter().find(is_foreign).map(str::to_owned) }
}

/// Reads a unit of which it is known what it must measure; the note says what was taken for what, where the text alone does not.
///
/// A mass where a force, a moment or a pressure belongs is that mass's weight, so that `kg` is read as `kgf`; its text becomes `kgf`, too.
///
/// # Errors
///
/// [`UnitError`] where the text is no unit, where it measures something else, and where it is read in two ways: `kn` of a force.
///
/// # Example
///
/// ```
/// use froude_records::units::{Dimension, parse_unit_for};
/// let (unit, note) = parse_unit_for("kg", Dimension::FORCE)?;
/// assert_eq!((unit.text.as_str(), unit.factor), ("kgf", 9.80665));
/// assert!(note.is_some_and(|note| note.contains("read as `kgf`")));
/// # Ok::<(), froude_records::units::UnitError>(())
/// ```
pub fn parse_unit_for(text: &str, expected: Dimension) -> Result<(Unit, Option<String>), UnitError> {
    let usual = expected.to_string();
    let unit = parse_unit(text).map_err(|error| error.expecting(text, expected, &usual))?;
    if unit.dimension == expected {
        let note = note_of(&unit);
        return Ok((unit, note));
    }
    if let Some(weight) = as_weight(&unit, expected) {
        let note = format!("`{}` is read as `{weight}`, under standard gravity, 9.80665 m/s^2", unit.text);
        return Ok((weight, Some(note)));
    }
    let canonical = one_spelling(whole(bare(text)));
    let candidates = match (canonical, expected) {
        ("kn" | "kt", Dimension::FORCE) => "`kN` (kilonewton), or another name where it is a speed in knots",
        ("g", Dimension::ACCELERATION) => "`g0` (9.80665 m/s^2), or another name where it is a mass in grams",
        ("mg", Dimension::ACCELERATION) => {
            "`g0`, and the numbers times 0.001, or another name where it is a mass in milligrams"
        }
        _ => {
            let [found, expected] = [unit.dimension, expected].map(Dimension::describe);
            return Err(UnitError::Other(format!("`{text}` is {found}; expected {expected}")));
        }
    };
    let [found, expected] = [unit.dimension, expected].map(Dimension::describe);
    Err(UnitError::Other(format!("`{text}` is {found}, and {expected} is expected; write {candidates}")))
}

/// What a spelling leaves unsaid.
fn note_of(unit: &Unit) -> Option<String> {
    let text = unit.text.as_str();
    let note = match text {
        "psig" | "PSIG" | "psid" | "barg" => "a difference of pressure: to the surroundings, or between two places",
        "psia" | "PSIA" | "bara" => "an absolute pressure, that of the air included",
        "rps" | "RPS" => "turns a second, each of 2 pi rad",
        _ => return None,
    };
    Some(format!("`{text}` is read as {note}"))
}

/// The unit with its mass as a weight; `None` where that does not measure what is expected.
fn as_weight(unit: &Unit, expected: Dimension) -> Option<Unit> {
    let text = whole(&unit.text);
    let mut out = String::with_capacity(text.len() + 2);
    let mut rest = text;
    while let Some(first) = rest.chars().next() {
        let end = if first.is_alphabetic() {
            rest.find(|c: char| !c.is_alphabetic()).unwrap_or(rest.len())
        } else {
            first.len_utf8()
        };
        let (word, after) = rest.split_at(end);
        let weight = WEIGHTS.iter().find(|(mass, _)| *mass == one_spelling(word));
        out.push_str(weight.map_or(word, |(_, force)| force));
        rest = after;
    }
    parse_unit(&out).ok().filter(|weight| weight.dimension == expected && out != text)
}

/// What is to be asked of the unit of a column with this name; `None` where it says enough.
///
/// A rate of turning in `1/min` counts turns for one and radians for another, 6.28 times apart; an angle in counts has no size.
#[must_use]
pub fn question(name: &str, unit: &Unit) -> Option<String> {
    let text = unit.text.as_str();
    let plain = name.trim().to_lowercase().replace([' ', '-'], "_");
    let plain = plain.strip_prefix("std_").unwrap_or(&plain);
    let words: Vec<&str> = words(whole(text));
    let says_angle = words.iter().any(|word| ANGLES.contains(word));
    // `rpm_port`, `n1`: a word of the name is enough, and per minute counts turns nearly always.
    let is_rate = RATES.contains(&plain)
        || plain.split('_').any(|word| RATES.contains(&word.trim_end_matches(|c: char| c.is_ascii_digit())));
    match unit.dimension {
        Dimension::ANGULAR_SPEED if !says_angle && (is_rate || words.contains(&"min")) => {
            let (turns, radians) = if words.contains(&"min") { ("rpm", "rad/min") } else { ("rev/s", "rad/s") };
            Some(format!(
                "`{text}` is ambiguous for a rate of rotation; write `{turns}` where turns are counted, or `{radians}`"
            ))
        }
        Dimension::MASS
            if matches!(text, "g" | "mg")
                && (has_word(plain, &ACCELERATIONS) || matches!(plain, "a" | "a_x" | "a_y" | "a_z")) =>
        {
            let milli = if text == "mg" { " and multiply the numbers by 0.001" } else { "" };
            Some(format!(
                "`{text}` is a mass here; if the numbers are multiples of the acceleration of gravity, write `g0` (9.80665 m/s^2){milli}"
            ))
        }
        Dimension::MASS if has_word(plain, &FORCES) => {
            let weight = as_weight(unit, Dimension::FORCE).map_or_else(|| "N".to_owned(), |weight| weight.text);
            Some(format!(
                "`{text}` is a unit of mass, but the name is that of a force; write `{weight}` if it is a weight, or name the column mass or payload"
            ))
        }
        Dimension::TIME | Dimension::LENGTH | Dimension::VOLTAGE | Dimension::CURRENT
            if matches!(text, "Ms" | "Mm" | "MV" | "MA") =>
        {
            let meant = text.replacen('M', "m", 1);
            Some(format!("`{text}` has the prefix mega (10^6); write `{meant}` if milli (10^-3) is meant"))
        }
        of if has_word(plain, &PRESSURES)
            && as_weight(unit, Dimension::PRESSURE).is_some()
            && of != Dimension::PRESSURE =>
        {
            let weight = as_weight(unit, Dimension::PRESSURE).map_or_else(String::new, |weight| weight.text);
            Some(format!("`{text}` is mass per area, but the name is that of a pressure; write `{weight}`"))
        }
        Dimension::SPEED if text == "nm/h" => {
            Some("`nm/h` is nanometres an hour; write `kn` where it is nautical miles an hour".to_owned())
        }
        Dimension::ANGLE if plain == "angle" && !says_angle => {
            Some(format!("`{text}` is not a unit of angle; convert the numbers and write `deg` or `rad`"))
        }
        _ => None,
    }
}

/// The symbols of a unit.
fn words(text: &str) -> Vec<&str> {
    let words = text.split(|c: char| !(c.is_alphabetic() || matches!(c, '°' | '%' | '‰' | '_')));
    words.filter(|word| !word.is_empty()).map(one_spelling).collect()
}
