//! Quantities of a gait as a person types them: `30 deg`, `0.22 Hz`, `amplitude=10..50 deg:9`.

use froude_records::units::{Dimension, parse_quantity};

use super::Ranges;
use crate::front::Objective;
use crate::gait_file::angular_frequency;
use crate::sweep::Axis;

const EXAMPLE: &str = "ranges with their unit and how many values: 'amplitude=10..50 deg:9, phase=10..80 deg:8'";
/// Most values of a range.
const MOST: usize = 1_000_000;

/// An option that is no such quantity.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{option} {text:?} {problem}; write {example}")]
pub struct NotUnderstood {
    /// The option.
    pub option: &'static str,
    /// What was written.
    pub text: String,
    /// What is wrong with it.
    pub problem: String,
    /// How to write it.
    pub example: &'static str,
}

/// An angle, rad.
///
/// # Errors
///
/// [`NotUnderstood`].
pub fn angle(option: &'static str, text: &str) -> Result<f64, NotUnderstood> {
    quantity(option, text, Dimension::ANGLE, "an angle with its unit: '30 deg'")
}

/// A step, s, above zero.
///
/// # Errors
///
/// [`NotUnderstood`].
pub fn step(text: &str) -> Result<f64, NotUnderstood> {
    let (option, example) = ("--step", "a time with its unit: '2 ms'");
    let found = quantity(option, text, Dimension::TIME, example)?;
    if found > 0.0 && found.is_finite() {
        return Ok(found);
    }
    Err(NotUnderstood { option, text: text.to_owned(), problem: "is not above zero".to_owned(), example })
}

/// A frequency, rad/s, from an angular speed or from cycles a second.
///
/// # Errors
///
/// [`NotUnderstood`].
pub fn frequency(text: &str) -> Result<f64, NotUnderstood> {
    let (option, example) = ("--frequency", "an angular speed or a frequency with its unit: '80 deg/s' or '0.22 Hz'");
    quantity(option, text, Dimension::ANGULAR_SPEED, example)?;
    let wrong = |problem| NotUnderstood { option, text: text.to_owned(), problem, example };
    let quantity = parse_quantity(text).map_err(|e| wrong(format!("cannot be read: {e}")))?;
    angular_frequency(&quantity).map_err(wrong)
}

fn quantity(
    option: &'static str,
    text: &str,
    dimension: Dimension,
    example: &'static str,
) -> Result<f64, NotUnderstood> {
    let wrong = |problem: String| NotUnderstood { option, text: text.to_owned(), problem, example };
    if text.trim().parse::<f64>().is_ok() {
        return Err(wrong("has no unit".to_owned()));
    }
    let found = parse_quantity(text).map_err(|e| wrong(format!("cannot be read: {e}")))?;
    // A pure number is an angle by its dimension, and hardly ever by what was meant.
    if found.unit.dimension != dimension || found.unit.text == "1" {
        return Err(wrong(format!("is {}", found.unit.dimension.describe())));
    }
    Ok(found.value_si)
}

/// Two objectives that differ; `None` where a sweep is asked for.
///
/// # Errors
///
/// [`NotUnderstood`].
pub fn objectives(names: &[String]) -> Result<Option<[Objective; 2]>, NotUnderstood> {
    let of =
        |name: &String| [Objective::Speed, Objective::Power, Objective::Cost].into_iter().find(|o| o.name() == name);
    let found: Vec<Objective> = names.iter().filter_map(of).collect();
    match found[..] {
        [] => Ok(None),
        [a, b] if a != b => Ok(Some([a, b])),
        _ => Err(NotUnderstood {
            option: "--optimise",
            text: names.join(","),
            problem: "is not two different objectives".to_owned(),
            example: "two of speed, power, cost: --optimise speed,power",
        }),
    }
}

/// Ranges of a gait's numbers, for a sweep.
///
/// # Errors
///
/// [`NotUnderstood`].
pub fn ranges(text: &str) -> Result<Ranges, NotUnderstood> {
    let mut found = Ranges::default();
    for part in text.split(',') {
        let wrong = |problem: String| not_understood(part.trim(), problem);
        let (name, rest) = part.split_once('=').ok_or_else(|| wrong("has no '='".to_owned()))?;
        let (place, of): (_, fn(&str) -> Result<f64, String>) = match name.trim() {
            "amplitude" => (&mut found.amplitude, swept_angle),
            "frequency" => (&mut found.frequency, swept_frequency),
            "phase" => (&mut found.phase, swept_angle),
            "turn" => (&mut found.turn, swept_angle),
            other => {
                return Err(wrong(format!(
                    "begins with {other:?}; only amplitude, frequency, phase and turn can be swept"
                )));
            }
        };
        if place.is_some() {
            return Err(wrong("is there twice".to_owned()));
        }
        *place = Some(axis(rest, of).map_err(wrong)?);
    }
    Ok(found)
}

/// `10..50 deg:9`; the first number may have a unit of its own.
fn axis(text: &str, of: fn(&str) -> Result<f64, String>) -> Result<Axis, String> {
    let (ends, n) = text.rsplit_once(':').ok_or("does not say how many values (':9')")?;
    let n: usize = n.trim().parse().map_err(|_| format!("has {:?} where a number of values stands", n.trim()))?;
    if !(2..=MOST).contains(&n) {
        return Err(format!("has {n} values; a range has two at least and {MOST} at most"));
    }
    let (low, high) = ends.split_once("..").ok_or("has no '..' between its ends")?;
    let unit = parse_quantity(high).map_err(|e| format!("cannot be read: {e}"))?.unit.text;
    let low = if low.trim().parse::<f64>().is_ok() { format!("{} {unit}", low.trim()) } else { low.to_owned() };
    let (low, high) = (of(&low)?, of(high)?);
    if low >= high {
        return Err("does not go up: its first number is not below its last".to_owned());
    }
    Ok(Axis { low, high, n })
}

fn swept_angle(text: &str) -> Result<f64, String> {
    let found = parse_quantity(text).map_err(|e| format!("cannot be read: {e}"))?;
    if found.unit.dimension != Dimension::ANGLE || found.unit.text == "1" {
        return Err(format!("is {}, and an angle is asked for", found.unit.dimension.describe()));
    }
    Ok(found.value_si)
}

fn swept_frequency(text: &str) -> Result<f64, String> {
    let found = parse_quantity(text).map_err(|e| format!("cannot be read: {e}"))?;
    angular_frequency(&found)
}

fn not_understood(text: &str, problem: String) -> NotUnderstood {
    NotUnderstood { option: "--sweep", text: text.to_owned(), problem, example: EXAMPLE }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_read_in_their_unit() {
        let found = ranges("amplitude=10..50 deg:9, frequency=0.1..0.3 Hz:3,turn=-0.1 rad..10 deg:2").unwrap();
        let amplitude = found.amplitude.unwrap();
        assert_eq!((amplitude.low, amplitude.high, amplitude.n), (10_f64.to_radians(), 50_f64.to_radians(), 9));
        assert!((found.frequency.unwrap().at(1) - std::f64::consts::TAU * 0.2).abs() < 1e-15);
        assert_eq!((found.turn.unwrap().low, found.phase), (-0.1, None));
    }

    #[test]
    fn what_is_no_range_is_said() {
        for (text, problem) in [
            ("amplitude", "has no '='"),
            ("size=1..2 deg:3", "begins with \"size\""),
            ("phase=1..2 deg:3, phase=1..2 deg:3", "is there twice"),
            ("phase=1..2 deg", "how many values"),
            ("phase=1..2 deg:1", "two at least"),
            ("phase=1..2 deg:x", "\"x\""),
            ("phase=1 deg:3", "'..'"),
            ("phase=2..1 deg:3", "does not go up"),
            ("phase=1..2:3", "cannot be read"),
            ("phase=1..2 m:3", "an angle is asked for"),
            ("frequency=0..2 Hz:3", "not above zero"),
            ("frequency=1..2 1/s:3", "radians or cycles"),
        ] {
            let told = ranges(text).unwrap_err().to_string();
            assert!(told.starts_with("--sweep") && told.contains(problem), "{text}: {told}");
        }
    }
}
