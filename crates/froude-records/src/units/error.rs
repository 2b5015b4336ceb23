//! Why a text is no unit, and what was probably meant.

use super::symbols::{NEVER_PREFIXED, PLAIN, PREFIXED, PREFIXES};
use super::{Dimension, LARGEST_SI, number_length, parse_unit};

/// Why a text is not a unit or not the quantity asked for.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UnitError {
    /// Nothing was written.
    #[error("no unit is given; write for example {example}")]
    Empty {
        /// A unit, in backquotes.
        example: String,
    },
    /// A symbol that is no unit.
    #[error("unknown unit `{symbol}`{advice}")]
    Unknown {
        /// The symbol.
        symbol: String,
        /// `; did you mean …?`, or nothing.
        advice: String,
    },
    /// A character that does not belong into a unit.
    #[error("`{unit}` is not a unit: {problem}")]
    Syntax {
        /// The unit as written.
        unit: String,
        /// What is wrong.
        problem: String,
    },
    /// A product after a division.
    #[error("`{unit}` can be read in two ways; put the divisor in parentheses, as in `kg/(m s)`")]
    Ambiguous {
        /// The unit as written.
        unit: String,
    },
    /// `degC` inside a product.
    #[error("`{unit}`: degC has an offset and can only stand alone; write K for differences")]
    Offset {
        /// The unit as written.
        unit: String,
    },
    /// Exponents or factor beyond what numbers can hold.
    #[error("`{unit}` is out of range: exponents must lie between -127 and 127")]
    Range {
        /// The unit as written.
        unit: String,
    },
    /// A quantity without a number.
    #[error("`{text}` does not begin with a number; write a quantity as `0.4 {unit}`")]
    NoNumber {
        /// As written.
        text: String,
        /// A unit for the example.
        unit: String,
    },
    /// A quantity without a unit.
    #[error("`{text}` has no unit; write for example {example}")]
    NoUnit {
        /// As written.
        text: String,
        /// The same with a unit, in backquotes.
        example: String,
    },
    /// A decimal comma.
    #[error("`{text}` has a decimal comma; write a decimal point, `{point}`")]
    DecimalComma {
        /// As written.
        text: String,
        /// The same with a point.
        point: String,
    },
    /// A number beyond [`LARGEST_SI`].
    #[error("`{text}` is not a finite number, or beyond {LARGEST_SI:e} in SI, as no quantity of a test is")]
    NotFinite {
        /// As written.
        text: String,
    },
    /// A unit of another kind.
    #[error("expected {expected}, found {found}")]
    Dimension {
        /// In words, with the SI unit.
        expected: String,
        /// In words, with the SI unit.
        found: String,
    },
}

impl UnitError {
    /// The same error where the kind of quantity is known: what it suggests is of that kind.
    ///
    /// `text` is the quantity or unit as written, `usual` the unit that people write for it.
    #[must_use]
    pub fn expecting(self, text: &str, dimension: Dimension, usual: &str) -> Self {
        match self {
            Self::Empty { .. } => Self::Empty { example: format!("`{usual}`") },
            Self::NoNumber { text, .. } => Self::NoNumber { text, unit: usual.to_owned() },
            Self::NoUnit { text, .. } => {
                let unit = text.parse().map_or(usual, |number| crate::plausible::unit_for(number, dimension, usual));
                Self::NoUnit { example: format!("`{text} {unit}`"), text }
            }
            Self::Unknown { symbol, advice: found } => {
                let text = text.trim();
                let stands_alone = text[number_length(text)..].trim() == symbol;
                // A part of `kg/m^3` need not be a density.
                let advice = if stands_alone { advice(&symbol, Some(dimension)) } else { found };
                let advice = if advice.is_empty() { format!("; write for example `{usual}`") } else { advice };
                Self::Unknown { symbol, advice }
            }
            other => other,
        }
    }
}

/// What to write for a prefix before a unit that takes none, with the unit's kind.
fn no_prefix(symbol: &str) -> Option<(Dimension, String)> {
    PREFIXES.iter().find_map(|(prefix, above, below)| {
        let unit = NEVER_PREFIXED.iter().find(|unit| symbol.strip_prefix(prefix) == Some(**unit))?;
        let dimension = parse_unit(unit).ok()?.dimension;
        Some((
            dimension,
            format!("; `{unit}` takes no prefix: write `{unit}`, and the numbers times {}", above / below),
        ))
    })
}

/// What was probably meant, among the units of one kind where that is known.
pub(super) fn advice(symbol: &str, dimension: Option<Dimension>) -> String {
    let is_wanted = |found: Dimension| dimension.is_none_or(|wanted| wanted == found);
    if is_wanted(Dimension::ANGLE)
        && matches!(symbol.to_lowercase().as_str(), "grad" | "grads" | "grade" | "gradian" | "gradians")
    {
        return "; did you mean `deg` (360 to the turn) or `gon` (400 to the turn)?".to_owned();
    }
    if let Some(told) = no_prefix(symbol).filter(|(dimension, _)| is_wanted(*dimension)) {
        return told.1;
    }
    let meant = match symbol {
        "mps" => "m/s",
        "mps2" => "m/s^2",
        "sec" | "second" | "seconds" => "s",
        "hr" | "hour" | "hours" => "h",
        "degree" | "degrees" => "deg",
        "radian" | "radians" => "rad",
        "kph" => "km/h",
        "knot" | "knots" | "kts" => "kn",
        "C" | "Celsius" | "celsius" => "degC",
        "newton" | "newtons" | "Newton" => "N",
        "meter" | "meters" | "metre" | "metres" => "m",
        "litre" | "litres" | "liter" | "liters" => "l",
        "kelvin" | "Kelvin" => "K",
        _ => "",
    };
    if parse_unit(meant).is_ok_and(|unit| is_wanted(unit.dimension)) {
        return format!("; did you mean `{meant}`?");
    }
    let plain = PLAIN.iter().map(|u| (u.0, u.3)).chain(PREFIXED.iter().map(|u| (u.0, u.2)));
    let known = plain.chain([("degC", Dimension::TEMPERATURE)]).filter(|(_, found)| is_wanted(*found));
    match crate::nearest::nearest(symbol, known.map(|(name, _)| name)) {
        Some(near) => format!("; did you mean `{near}`?"),
        None => String::new(),
    }
}
