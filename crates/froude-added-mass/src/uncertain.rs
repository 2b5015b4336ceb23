//! A number with its uncertainty, as tables show it.

use froude_records::number;

/// A value with its expanded uncertainty.
#[must_use]
pub fn with_uncertainty(value: f64, expanded: f64) -> String {
    if expanded.is_finite() { number::plus_minus(value, expanded) } else { number::plain(value, 6) }
}
