//! A constant as it is declared: a quantity, alone or with its standard uncertainty.

use crate::error::RecordError;
use crate::section::{Section, Value};
use crate::units::Dimension;

/// A declared constant with its standard uncertainty, both in SI.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Declared {
    /// The value.
    pub value: f64,
    /// Its standard uncertainty; 0 for what is exact by construction (teeth, lines).
    pub standard_uncertainty: f64,
}

impl Declared {
    /// A value and its standard uncertainty, SI.
    #[must_use]
    pub const fn new(value: f64, standard_uncertainty: f64) -> Self {
        Self { value, standard_uncertainty }
    }

    /// A value without uncertainty.
    #[must_use]
    pub const fn exact(value: f64) -> Self {
        Self::new(value, 0.0)
    }
}

/// A constant: `"0.35 A/V"`, taken as exact, or `{ value = "0.35 A/V", standard = "1 %" }`; per cent are of the value.
///
/// # Errors
///
/// [`RecordError::Value`] with its place where it is something else.
pub fn declared(s: &Section<'_>, key: &'static str, dimension: Dimension) -> Result<Option<Declared>, RecordError> {
    s.get(key).map(|value| declared_value(s, key, value, dimension)).transpose()
}

/// The same as [`declared`] of a key that a person chose.
///
/// # Errors
///
/// [`RecordError::Value`] with its place where it is something else.
pub fn declared_value<'a>(
    s: &Section<'a>,
    key: &str,
    value: &'a Value<'a>,
    dimension: Dimension,
) -> Result<Declared, RecordError> {
    if value.get_ref().as_table().is_none() {
        return Ok(Declared::exact(s.as_quantity_of(key, value, dimension)?));
    }
    let table = s.as_section(key, value)?;
    table.only(&["value", "standard"])?;
    let written = table.need("value", "a constant is a quantity, or { value = \"…\", standard = \"…\" }")?;
    let si = table.as_written("value", written, key, dimension)?.value_si;
    let Some(standard) = table.get("standard") else { return Ok(Declared::exact(si)) };
    let quantity = table.quantity_like("standard", standard, Some((key, dimension)))?;
    let standard_uncertainty = if quantity.unit.text == "%" {
        quantity.value_si * si.abs()
    } else {
        table.as_written("standard", standard, key, dimension)?.value_si
    };
    table.refuse("standard", standard_uncertainty < 0.0, "is negative; a standard uncertainty is not")?;
    Ok(Declared { value: si, standard_uncertainty })
}
