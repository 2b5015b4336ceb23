//! A number with its unit, as records hold it.

use serde::{Deserialize, Serialize};

/// A number with its unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Measured {
    /// The number, in `unit`.
    pub value: f64,
    /// SI unit text, `1` for a pure number.
    pub unit: String,
}

impl Measured {
    /// A value in `unit`.
    pub fn of(value: f64, unit: impl Into<String>) -> Self {
        Self { value, unit: unit.into() }
    }
}
