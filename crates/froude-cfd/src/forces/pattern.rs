//! What the name of a case's folder states: `U{speed [m/s]}_b{angle [deg]}`.

use froude_records::nearest::suggestion;
use froude_records::units::{Dimension, Unit, parse_unit};

/// A pattern of folder names.
#[derive(Debug, Clone)]
pub(super) struct Pattern {
    parts: Vec<Part>,
}

#[derive(Debug, Clone)]
enum Part {
    Text(String),
    Number(Quantity, Unit),
    Configuration,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Quantity {
    Speed,
    Angle,
}

/// What a name states; `None` where the pattern has no place for it.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Stated {
    pub(super) speed_m_s: Option<f64>,
    pub(super) angle_rad: Option<f64>,
    pub(super) configuration: Option<String>,
}

const NAMES: [&str; 3] = ["speed", "angle", "configuration"];
const EXAMPLE: &str = "write pattern = \"U{speed [m/s]}_b{angle [deg]}\", for example";

impl Pattern {
    /// From its text.
    ///
    /// # Errors
    ///
    /// A place that is not closed, of an unknown name, without its unit or of a wrong one, twice, or beside another with nothing between them; no speed.
    pub(super) fn parse(text: &str) -> Result<Self, String> {
        let mut parts = Vec::new();
        let mut rest = text;
        while let Some((before, behind)) = rest.split_once('{') {
            let Some((inside, after)) = behind.split_once('}') else {
                return Err(format!("is {text:?}, whose {{ is not closed; {EXAMPLE}"));
            };
            if !before.is_empty() {
                parts.push(Part::Text(before.to_owned()));
            } else if !parts.is_empty() {
                return Err(format!(
                    "is {text:?}, where {{{inside}}} follows another place with nothing between them: where one ends cannot be told"
                ));
            }
            parts.push(place(inside).map_err(|problem| format!("is {text:?}: {problem}; {EXAMPLE}"))?);
            rest = after;
        }
        if !rest.is_empty() {
            parts.push(Part::Text(rest.to_owned()));
        }
        for (name, places) in NAMES.iter().zip([
            parts.iter().filter(|p| matches!(p, Part::Number(Quantity::Speed, _))).count(),
            parts.iter().filter(|p| matches!(p, Part::Number(Quantity::Angle, _))).count(),
            parts.iter().filter(|p| matches!(p, Part::Configuration)).count(),
        ]) {
            if places > 1 || (places == 0 && *name == "speed") {
                let found = if places == 0 { "no".to_owned() } else { format!("{places} times") };
                return Err(format!("is {text:?}, which names {found} {name}; {EXAMPLE}"));
            }
        }
        Ok(Self { parts })
    }

    /// What a name states; `None` if it does not match.
    pub(super) fn read(&self, name: &str) -> Option<Stated> {
        matched(&self.parts, name)
    }
}

fn place(inside: &str) -> Result<Part, String> {
    let (name, unit) = match inside.split_once('[') {
        Some((name, unit)) => (name.trim(), unit.trim().strip_suffix(']').map(str::trim)),
        None => (inside.trim(), None),
    };
    let (quantity, dimension, usual) = match name {
        "configuration" => return Ok(Part::Configuration),
        "speed" => (Quantity::Speed, Dimension::SPEED, "m/s"),
        "angle" => (Quantity::Angle, Dimension::ANGLE, "deg"),
        other => return Err(format!("{{{inside}}} names {other:?}; {}", suggestion(other, NAMES))),
    };
    let Some(unit) = unit else { return Err(format!("{{{inside}}} has no unit: write {{{name} [{usual}]}}")) };
    let unit = parse_unit(unit).map_err(|e| format!("{{{inside}}}: {e}"))?;
    if unit.dimension != dimension {
        return Err(format!("{{{inside}}} is {}; expected {}", unit.dimension.describe(), dimension.describe()));
    }
    Ok(Part::Number(quantity, unit))
}

/// The rest of a name by the rest of a pattern; of a number the longest text that lets the others match.
fn matched(parts: &[Part], rest: &str) -> Option<Stated> {
    let Some((first, others)) = parts.split_first() else { return rest.is_empty().then(Stated::default) };
    if let Part::Text(text) = first {
        return matched(others, rest.strip_prefix(text.as_str())?);
    }
    let ends = rest.char_indices().map(|(at, c)| at + c.len_utf8()).rev();
    ends.into_iter().find_map(|end| {
        let (own, behind) = rest.split_at_checked(end)?;
        let value = match first {
            Part::Number(..) => Some(number(own)?),
            _ => None,
        };
        let stated = matched(others, behind)?;
        Some(match (first, value) {
            (Part::Number(Quantity::Speed, unit), Some(value)) => {
                Stated { speed_m_s: Some(unit.to_si(value)), ..stated }
            }
            (Part::Number(Quantity::Angle, unit), Some(value)) => {
                Stated { angle_rad: Some(unit.to_si(value)), ..stated }
            }
            _ => Stated { configuration: Some(own.to_owned()), ..stated },
        })
    })
}

/// A decimal number as people write it in names, `1.5` or `1p5`; no exponent, whose letter may belong to the name.
fn number(text: &str) -> Option<f64> {
    let text = match text.split_once('p') {
        Some((whole, part)) if part.starts_with(|c: char| c.is_ascii_digit()) => format!("{whole}.{part}"),
        _ => text.to_owned(),
    };
    let is_part = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | '+');
    text.chars().all(is_part).then(|| text.parse().ok()).flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(pattern: &str, name: &str) -> Option<Stated> {
        Pattern::parse(pattern).unwrap().read(name)
    }

    #[test]
    fn a_name_states_speed_and_angle_in_their_units() {
        let found = read("U{speed [m/s]}_b{angle [deg]}", "U1.5_b-12").unwrap();
        assert_eq!(found.speed_m_s, Some(1.5));
        assert!((found.angle_rad.unwrap() + 12_f64.to_radians()).abs() < 1e-12);
        let found = read("{configuration}-{speed [kn]}kn", "H1LT-2-10kn").unwrap();
        assert_eq!(found.configuration.as_deref(), Some("H1LT-2"));
        assert!((found.speed_m_s.unwrap() - 5.1444).abs() < 1e-3);
        let found = read("case_U{speed [m/s]}_beta{angle [deg]}", "case_U1p5_beta-8").unwrap();
        assert_eq!(found.speed_m_s, Some(1.5));
        for name in ["U1.5", "U1.5_b12x", "U_b12", "U1p_b12", "U1p5p1_b12", "u1.5_b12", "org", "Uinf_b1"] {
            assert_eq!(read("U{speed [m/s]}_b{angle [deg]}", name), None, "{name}");
        }
    }

    #[test]
    fn a_pattern_that_is_not_clear_is_rejected() {
        for (pattern, said) in [
            ("U{speed}", "has no unit: write {speed [m/s]}"),
            ("U{speed [deg]}", "expected a speed"),
            ("U{sped [m/s]}", "speed"),
            ("U{speed [m/s]", "is not closed"),
            ("b{angle [deg]}", "no speed"),
            ("{speed [m/s]}_{speed [m/s]}", "2 times speed"),
            ("{speed [m/s]}{angle [deg]}", "nothing between them"),
        ] {
            let found = Pattern::parse(pattern).unwrap_err();
            assert!(found.contains(said), "{pattern}: {found}");
        }
    }
}
