//! Why a text is no unit, and what was probably meant.

use super::foreign::advice;
use super::{Dimension, number_length};

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
    /// A character that does not belong into a unit, a number that no quantity has, a unit of another kind: in words.
    #[error("{0}")]
    Other(String),
}

impl UnitError {
    /// A text that is not a unit.
    pub(super) fn syntax(unit: &str, problem: &str) -> Self {
        Self::Other(format!("`{unit}` is not a unit: {problem}"))
    }

    /// Exponents or a factor beyond what numbers can hold.
    pub(super) fn range(unit: &str) -> Self {
        Self::Other(format!("`{unit}` is out of range: exponents must lie between -127 and 127"))
    }

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
