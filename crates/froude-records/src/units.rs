//! Units and quantities as people write them: `kg/m^3`, `0.4 m/s`, `10 degC`.
//!
//! Every number in a file carries its unit. This module turns the text of a unit
//! into a factor to SI and a [`Dimension`], so that a length where a speed
//! belongs is found before any number is used.
//!
//! **Grammar.** A unit is a product of symbols, joined by a space, `*`, `·`, or a
//! point or hyphen that touches both (`N.m`, `N-m`), with whole exponents (`m^2`,
//! `m2`, `m²`, `s^-1`, `s-1`), divided by one symbol or by a product in parentheses:
//! `kg/(m s)`. `kg/m s` and `m/s^-1` are refused because they are read in two ways;
//! `m/s/s` is not. Brackets about a unit are left out. A quantity is a number and a unit.
//!
//! **Angles** are pure numbers (rad = 1), as in the SI: `rad/s`, `Hz` and `1/s`
//! have one dimension, and `1 rpm` is 2π/60 of it while `1 Hz` is 1. Of a column that
//! is a rate of turning only units that name an angle are read ([`question`]).
//!
//! **Temperatures.** `degC` and `degF` have an offset and therefore stand alone; a
//! difference or a standard uncertainty in `degC` is the same number of kelvin.
//!
//! | symbols | prefixes |
//! | --- | --- |
//! | `m s g N Pa Hz A V ohm W J l L K Nm` | `n u µ m c d h k M G` |
//! | `rad deg ° gon rev rpm rps min h degC degF ft in yd mi nmi kn kt mph g0` | none |
//! | `lb oz t ton_short ton_long lbf ozf gf kgf tf kip bar mbar dbar atm psi mmHg mmH2O cmH2O mH2O` | none |
//! | `Nmm Ncm PS hp_imp gal_US gal_imp cSt cP % ‰ ppm strain microstrain count 1` | none |
//!
//! Angles, minutes, hours and degC take no prefix: `Grad` is German for degree and French for a 400th of a turn, never a
//! milliard of radians.
//!
//! Other spellings with one meaning (`sec`, `knots`, `lbs`, `U/min`, `-`) are read as these; those with several are refused, and the message
//! lists the units to choose from, each with its quantity.

mod dimension;
mod error;
mod expected;
mod foreign;
mod parser;
mod spellings;
mod symbols;

use std::fmt;

pub use dimension::Dimension;
pub use error::UnitError;
pub use expected::{foreign_part, parse_unit_for, question};
use parser::Parser;
pub(crate) use parser::SUPERSCRIPTS;
use symbols::TEMPERATURES;

/// A unit as written, with its way to SI: `si = factor · value + offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// As written, without surrounding spaces and brackets.
    pub text: String,
    /// SI units in one of this unit.
    pub factor: f64,
    /// SI value of zero; 0 for all units but `degC` and `degF`.
    pub offset: f64,
    /// What it measures.
    pub dimension: Dimension,
}

impl Unit {
    /// The SI unit of a dimension.
    #[must_use]
    pub fn si(dimension: Dimension) -> Self {
        Self { text: dimension.to_string(), factor: 1.0, offset: 0.0, dimension }
    }

    /// The unit of a pure number.
    #[must_use]
    pub fn one() -> Self {
        Self::si(Dimension::ONE)
    }

    /// SI value of a number in this unit.
    #[must_use]
    pub fn to_si(&self, value: f64) -> f64 {
        value * self.factor + self.offset
    }

    /// Number in this unit of an SI value.
    ///
    /// Where several neighbouring numbers come close, the one that [`Unit::to_si`]
    /// brings back to exactly `si` is taken, so that a table survives being
    /// written and read again.
    #[must_use]
    pub fn from_si(&self, si: f64) -> f64 {
        let value = (si - self.offset) / self.factor;
        if self.to_si(value) == si || !value.is_finite() {
            return value;
        }
        let (mut up, mut down) = (value, value);
        for _ in 0..4 {
            up = up.next_up();
            down = down.next_down();
            for candidate in [up, down] {
                if self.to_si(candidate) == si {
                    return candidate;
                }
            }
        }
        value
    }

    /// SI value of a difference in this unit: the offset of `degC` does not enter.
    #[must_use]
    pub fn difference_to_si(&self, value: f64) -> f64 {
        value * self.factor
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text)
    }
}

/// A number with its unit.
#[derive(Debug, Clone, PartialEq)]
pub struct Quantity {
    /// The number as written, in `unit`.
    pub value: f64,
    /// The number in SI.
    pub value_si: f64,
    /// The unit as written.
    pub unit: Unit,
}

impl Quantity {
    /// SI value, when the quantity is of the dimension asked for.
    ///
    /// # Errors
    ///
    /// [`UnitError`] when it measures something else.
    pub fn expect(&self, dimension: Dimension) -> Result<f64, UnitError> {
        if self.unit.dimension == dimension {
            Ok(self.value_si)
        } else {
            let (expected, found) = (dimension.describe(), self.unit.dimension.describe());
            Err(UnitError::Other(format!("expected {expected}, found {found}")))
        }
    }
}

impl fmt::Display for Quantity {
    /// Text that [`parse_quantity`] reads back to the same number.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.value, self.unit)
    }
}

/// Longest text that is looked at; no unit and no quantity is longer.
const LONGEST: usize = 200;

/// Read a unit.
///
/// # Errors
///
/// [`UnitError`] when a symbol is unknown, the text is not a unit, or `degC`
/// stands in a product.
///
/// # Example
///
/// ```
/// use froude_records::units::{Dimension, parse_unit};
/// let unit = parse_unit("km/h")?;
/// assert_eq!(unit.dimension, Dimension::SPEED);
/// assert!((unit.to_si(36.0) - 10.0).abs() < 1e-12);
/// # Ok::<(), froude_records::units::UnitError>(())
/// ```
pub fn parse_unit(text: &str) -> Result<Unit, UnitError> {
    let text = text.trim();
    if text.is_empty() {
        return Err(UnitError::Empty { example: "`m/s`, or `1` for a pure number".to_owned() });
    }
    if text.len() > LONGEST {
        return Err(UnitError::syntax(&shorten(text), &format!("it is longer than {LONGEST} bytes")));
    }
    let text = bare(text);
    if NO_UNIT.contains(&text) {
        let newtons = if text == "N/A" { ", `N A^-1` for newtons per ampere," } else { "," };
        let advice = format!("write `1` where the numbers are pure{newtons} and else their unit");
        return Err(UnitError::Other(format!("`{text}` is not a unit; {advice}")));
    }
    if let Some((_, factor, offset)) = TEMPERATURES.iter().find(|(spellings, ..)| spellings.contains(&text)) {
        return Ok(Unit { text: text.to_owned(), factor: *factor, offset: *offset, dimension: Dimension::TEMPERATURE });
    }
    let inner = spellings::whole(text);
    let mut parser = Parser { text: inner, rest: inner, depth: 0, is_inverse: false };
    let scale = parser.quotient()?;
    if let Some(c) = parser.rest.chars().next() {
        return Err(parser.syntax(format!("unexpected `{c}`")));
    }
    let factor = scale.above / scale.below;
    if !(factor.is_finite() && factor > 0.0) {
        return Err(UnitError::range(text));
    }
    Ok(Unit { text: text.to_owned(), factor, offset: 0.0, dimension: scale.dimension })
}

/// What people write where there is no unit to write, and where they do not know it.
const NO_UNIT: &[&str] = &["n/a", "N/A", "na", "NA", "none", "None", "nil", "a.u.", "arb", "?", "??", "???"];

/// A unit without the brackets about it: `[m/s]`.
fn bare(text: &str) -> &str {
    let text = text.trim();
    text.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')).map_or(text, str::trim)
}

/// Read a number and its unit, such as `0.4 m/s`, `25 %` or `1e-6 m^2/s`.
///
/// # Errors
///
/// [`UnitError`] when the number or the unit is missing or cannot be read.
pub fn parse_quantity(text: &str) -> Result<Quantity, UnitError> {
    let text = text.trim();
    let no_number = || UnitError::NoNumber { text: shorten(text), unit: "m/s".to_owned() };
    let end = number_length(text);
    if end == 0 {
        return Err(no_number());
    }
    let (number, unit) = text.split_at(end);
    if unit.strip_prefix(',').is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_digit())) {
        let text = shorten(text);
        let point = text.replacen(',', ".", 1);
        return Err(UnitError::Other(format!("`{text}` has a decimal comma; write a decimal point, `{point}`")));
    }
    let value: f64 = number.parse().map_err(|_| no_number())?;
    let not_finite = || {
        let problem = format!("is not a finite number, or exceeds the limit of {LARGEST_SI:e} (SI)");
        UnitError::Other(format!("`{}` {problem}", shorten(text)))
    };
    if !value.is_finite() {
        return Err(not_finite());
    }
    if unit.trim().is_empty() {
        let text = shorten(text);
        let example = format!("`{text} m/s`, or `{text} 1` for a pure number");
        return Err(UnitError::NoUnit { text, example });
    }
    let unit = parse_unit(unit)?;
    let value_si = unit.to_si(value);
    if !is_plausible(value_si) {
        return Err(not_finite());
    }
    Ok(Quantity { value, value_si, unit })
}

/// Largest number that is taken for a measurement or a declaration, in SI. No test has a quantity near it, and its fourth power, which
/// sums of squares of products reach, is a number still.
pub const LARGEST_SI: f64 = 1e50;

/// Whether a number can be one of a test: finite, and not beyond [`LARGEST_SI`].
#[must_use]
pub fn is_plausible(value_si: f64) -> bool {
    value_si.abs() <= LARGEST_SI
}

/// Bytes of `text` that make up a decimal number at its beginning; 0 for none.
pub(crate) fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let mut at = usize::from(matches!(bytes.first(), Some(b'+' | b'-')));
    let whole = digits(at);
    at += whole;
    let mut fraction = 0;
    if bytes.get(at) == Some(&b'.') {
        fraction = digits(at + 1);
        at += 1 + fraction;
    }
    if whole + fraction == 0 {
        return 0;
    }
    if matches!(bytes.get(at), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(bytes.get(at + 1), Some(b'+' | b'-')));
        let power = if at + 1 + sign <= bytes.len() { digits(at + 1 + sign) } else { 0 };
        if power > 0 {
            at += 1 + sign + power;
        }
    }
    at
}

/// Half a unit in the last digit of the number at the beginning of `text`, as a part of the number; 0 of none and of zero.
pub(crate) fn half_digit(text: &str) -> f64 {
    let number = &text[..number_length(text)];
    let mantissa = number.split(['e', 'E']).next().unwrap_or_default();
    let decimals = mantissa.split_once('.').map_or(0, |(_, decimals)| decimals.len());
    let size = mantissa.parse::<f64>().map_or(0.0, f64::abs);
    if size > 0.0 { 0.5 * 0.1_f64.powi(decimals as i32) / size } else { 0.0 }
}

/// The beginning of a long text, for messages.
pub(crate) fn shorten(text: &str) -> String {
    const KEPT: usize = 60;
    if text.chars().count() <= KEPT {
        return text.to_owned();
    }
    let mut short: String = text.chars().take(KEPT).collect();
    short.push('…');
    short
}
