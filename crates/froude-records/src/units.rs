//! Units and quantities as people write them: `kg/m^3`, `0.4 m/s`, `10 degC`.
//!
//! Every number in a file carries its unit. This module turns the text of a unit
//! into a factor to SI and a [`Dimension`], so that a length where a speed
//! belongs is found before any number is used.
//!
//! **Grammar.** A unit is a product of symbols, joined by a space, `*` or `·`,
//! with whole exponents (`m^2`, `m2`, `m²`, `s^-1`), divided by one symbol or by
//! a product in parentheses: `kg/(m s)`. `kg/m s` is refused because it is read
//! in two ways; `m/s/s` is not. A quantity is a number and a unit.
//!
//! **Angles** are pure numbers (rad = 1), as in the SI: `rad/s`, `Hz` and `1/s`
//! have one dimension, and `1 rpm` is 2π/60 of it while `1 Hz` is 1.
//!
//! **Temperatures.** `degC` has an offset and therefore stands alone; a
//! difference or a standard uncertainty in `degC` is the same number of kelvin.
//!
//! | symbols | prefixes |
//! | --- | --- |
//! | `m s g N Pa Hz A V W J l L K Nm` | `n u µ m c d h k M G` |
//! | `rad deg ° gon rev rpm min h degC °C ft in kn kt nmi lb lbf gf kgf t bar Nmm % 1` | none |
//!
//! Angles, minutes, hours and degC take no prefix: `Grad` is German for degree and French for a 400th of a turn, never a
//! milliard of radians.

use std::f64::consts::PI;
use std::fmt;

/// Exponents of the SI base units; the radian counts as 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub struct Dimension {
    /// Exponent of the metre.
    pub m: i8,
    /// Exponent of the kilogram.
    pub kg: i8,
    /// Exponent of the second.
    pub s: i8,
    /// Exponent of the kelvin.
    pub k: i8,
    /// Exponent of the ampere.
    pub a: i8,
}

impl Dimension {
    /// Pure number, angle.
    pub const ONE: Self = Self::new(0, 0, 0);
    /// Angle: the same as a pure number.
    pub const ANGLE: Self = Self::ONE;
    /// Length, m.
    pub const LENGTH: Self = Self::new(1, 0, 0);
    /// Area, m^2.
    pub const AREA: Self = Self::new(2, 0, 0);
    /// Volume, m^3.
    pub const VOLUME: Self = Self::new(3, 0, 0);
    /// Mass, kg.
    pub const MASS: Self = Self::new(0, 1, 0);
    /// Time, s.
    pub const TIME: Self = Self::new(0, 0, 1);
    /// Speed, m/s.
    pub const SPEED: Self = Self::new(1, 0, -1);
    /// Acceleration, m/s^2.
    pub const ACCELERATION: Self = Self::new(1, 0, -2);
    /// Angular speed or frequency, 1/s.
    pub const ANGULAR_SPEED: Self = Self::new(0, 0, -1);
    /// Angular acceleration, 1/s^2.
    pub const ANGULAR_ACCELERATION: Self = Self::new(0, 0, -2);
    /// Force, N.
    pub const FORCE: Self = Self::new(1, 1, -2);
    /// Moment of a force, N m.
    pub const MOMENT: Self = Self::new(2, 1, -2);
    /// Pressure, Pa.
    pub const PRESSURE: Self = Self::new(-1, 1, -2);
    /// Power, W.
    pub const POWER: Self = Self::new(2, 1, -3);
    /// Density, kg/m^3.
    pub const DENSITY: Self = Self::new(-3, 1, 0);
    /// Kinematic viscosity, m^2/s.
    pub const KINEMATIC_VISCOSITY: Self = Self::new(2, 0, -1);
    /// Dynamic viscosity, Pa s.
    pub const DYNAMIC_VISCOSITY: Self = Self::new(-1, 1, -1);
    /// Temperature, K.
    pub const TEMPERATURE: Self = Self { k: 1, ..Self::ONE };
    /// Electric current, A.
    pub const CURRENT: Self = Self { a: 1, ..Self::ONE };
    /// Voltage, V.
    pub const VOLTAGE: Self = Self { m: 2, kg: 1, s: -3, k: 0, a: -1 };

    /// A mechanical dimension from its exponents of metre, kilogram and second.
    #[must_use]
    pub const fn new(m: i8, kg: i8, s: i8) -> Self {
        Self { m, kg, s, k: 0, a: 0 }
    }

    /// Product; `None` when an exponent leaves −127..=127.
    #[must_use]
    pub fn checked_mul(self, other: Self) -> Option<Self> {
        Self {
            m: self.m.checked_add(other.m)?,
            kg: self.kg.checked_add(other.kg)?,
            s: self.s.checked_add(other.s)?,
            k: self.k.checked_add(other.k)?,
            a: self.a.checked_add(other.a)?,
        }
        .bounded()
    }

    /// Quotient; `None` when an exponent leaves −127..=127.
    #[must_use]
    pub fn checked_div(self, other: Self) -> Option<Self> {
        Self {
            m: self.m.checked_sub(other.m)?,
            kg: self.kg.checked_sub(other.kg)?,
            s: self.s.checked_sub(other.s)?,
            k: self.k.checked_sub(other.k)?,
            a: self.a.checked_sub(other.a)?,
        }
        .bounded()
    }

    /// Whole power; `None` when an exponent leaves −127..=127.
    #[must_use]
    pub fn checked_powi(self, exponent: i8) -> Option<Self> {
        Self {
            m: self.m.checked_mul(exponent)?,
            kg: self.kg.checked_mul(exponent)?,
            s: self.s.checked_mul(exponent)?,
            k: self.k.checked_mul(exponent)?,
            a: self.a.checked_mul(exponent)?,
        }
        .bounded()
    }

    /// −128 has no opposite, so that `1/s^128` could not be written.
    fn bounded(self) -> Option<Self> {
        let is_written = [self.m, self.kg, self.s, self.k, self.a].iter().all(|e| *e != i8::MIN);
        is_written.then_some(self)
    }

    /// Square root; `None` when an exponent is odd.
    #[must_use]
    pub fn checked_sqrt(self) -> Option<Self> {
        let even = [self.m, self.kg, self.s, self.k, self.a].iter().all(|e| e % 2 == 0);
        even.then_some(Self { m: self.m / 2, kg: self.kg / 2, s: self.s / 2, k: self.k / 2, a: self.a / 2 })
    }

    /// In words with the SI unit, for messages: `a speed (m/s)`.
    #[must_use]
    pub fn describe(self) -> String {
        let words = match self {
            Self::ONE => "a pure number or angle",
            Self::LENGTH => "a length",
            Self::AREA => "an area",
            Self::VOLUME => "a volume",
            Self::MASS => "a mass",
            Self::TIME => "a time",
            Self::SPEED => "a speed",
            Self::ACCELERATION => "an acceleration",
            Self::ANGULAR_SPEED => "an angular speed or frequency",
            Self::ANGULAR_ACCELERATION => "an angular acceleration",
            Self::FORCE => "a force",
            Self::MOMENT => "a moment or energy",
            Self::PRESSURE => "a pressure",
            Self::POWER => "a power",
            Self::DENSITY => "a density",
            Self::KINEMATIC_VISCOSITY => "a kinematic viscosity",
            Self::DYNAMIC_VISCOSITY => "a dynamic viscosity",
            Self::TEMPERATURE => return "a temperature (degC or K)".to_owned(),
            Self::CURRENT => "a current",
            Self::VOLTAGE => "a voltage",
            _ => return format!("a quantity in {self}"),
        };
        format!("{words} ({self})")
    }
}

impl fmt::Display for Dimension {
    /// The SI unit as text that [`parse_unit`] reads back: `kg/m^3`, `N m`, `1`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = match *self {
            Self::ONE => "1",
            Self::FORCE => "N",
            Self::MOMENT => "N m",
            Self::PRESSURE => "Pa",
            Self::DYNAMIC_VISCOSITY => "Pa s",
            Self::POWER => "W",
            Self::VOLTAGE => "V",
            _ => "",
        };
        if !named.is_empty() {
            return f.write_str(named);
        }
        let bases = [("kg", self.kg), ("m", self.m), ("s", self.s), ("K", self.k), ("A", self.a)];
        let product = |positive: bool| {
            bases
                .iter()
                .filter(|(_, e)| *e != 0 && (*e > 0) == positive)
                .map(|(symbol, e)| match e.unsigned_abs() {
                    1 => (*symbol).to_owned(),
                    power => format!("{symbol}^{power}"),
                })
                .collect::<Vec<_>>()
        };
        let (above, below) = (product(true), product(false));
        f.write_str(&if above.is_empty() { "1".to_owned() } else { above.join(" ") })?;
        match below.len() {
            0 => Ok(()),
            1 => write!(f, "/{}", below[0]),
            _ => write!(f, "/({})", below.join(" ")),
        }
    }
}

/// A unit as written, with its way to SI: `si = factor · value + offset`.
#[derive(Debug, Clone, PartialEq)]
pub struct Unit {
    /// As written, without surrounding spaces.
    pub text: String,
    /// SI units in one of this unit.
    pub factor: f64,
    /// SI value of zero; 0 for all units but `degC`.
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
    /// [`UnitError::Dimension`] when it measures something else.
    pub fn expect(&self, dimension: Dimension) -> Result<f64, UnitError> {
        self.check(dimension).map(|()| self.value_si)
    }

    /// SI value as a difference (a step, a standard uncertainty): `0.1 degC` is 0.1 K.
    ///
    /// # Errors
    ///
    /// [`UnitError::Dimension`] when it measures something else.
    pub fn expect_difference(&self, dimension: Dimension) -> Result<f64, UnitError> {
        self.check(dimension).map(|()| self.unit.difference_to_si(self.value))
    }

    fn check(&self, dimension: Dimension) -> Result<(), UnitError> {
        if self.unit.dimension == dimension {
            Ok(())
        } else {
            Err(UnitError::Dimension { expected: dimension.describe(), found: self.unit.dimension.describe() })
        }
    }
}

impl fmt::Display for Quantity {
    /// Text that [`parse_quantity`] reads back to the same number.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {}", self.value, self.unit)
    }
}

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
    /// A number beyond the range of a double.
    #[error("`{text}` is not a finite number")]
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
        return Err(UnitError::Syntax { unit: shorten(text), problem: format!("it is longer than {LONGEST} bytes") });
    }
    if matches!(text, "degC" | "°C") {
        return Ok(Unit { text: text.to_owned(), factor: 1.0, offset: 273.15, dimension: Dimension::TEMPERATURE });
    }
    let mut parser = Parser { text, rest: text, depth: 0 };
    let scale = parser.quotient()?;
    if let Some(c) = parser.rest.chars().next() {
        return Err(parser.syntax(format!("unexpected `{c}`")));
    }
    let factor = scale.above / scale.below;
    if !(factor.is_finite() && factor > 0.0) {
        return Err(UnitError::Range { unit: text.to_owned() });
    }
    Ok(Unit { text: text.to_owned(), factor, offset: 0.0, dimension: scale.dimension })
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
        return Err(UnitError::DecimalComma { point: text.replacen(',', ".", 1), text });
    }
    let value: f64 = number.parse().map_err(|_| no_number())?;
    if !value.is_finite() {
        return Err(UnitError::NotFinite { text: shorten(text) });
    }
    if unit.trim().is_empty() {
        let text = shorten(text);
        let example = format!("`{text} m/s`, or `{text} 1` for a pure number");
        return Err(UnitError::NoUnit { text, example });
    }
    let unit = parse_unit(unit)?;
    let value_si = unit.to_si(value);
    if !value_si.is_finite() {
        return Err(UnitError::NotFinite { text: shorten(text) });
    }
    Ok(Quantity { value, value_si, unit })
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

/// A factor kept as a quotient, so that km/h is 1000/3600 and no rounding is added.
#[derive(Clone, Copy)]
struct Scale {
    above: f64,
    below: f64,
    dimension: Dimension,
}

struct Parser<'a> {
    text: &'a str,
    rest: &'a str,
    depth: usize,
}

impl Parser<'_> {
    fn syntax(&self, problem: String) -> UnitError {
        UnitError::Syntax { unit: self.text.to_owned(), problem }
    }

    fn range(&self) -> UnitError {
        UnitError::Range { unit: self.text.to_owned() }
    }

    fn skip_spaces(&mut self) {
        self.rest = self.rest.trim_start();
    }

    /// quotient = power { (" " | "*" | "·") power } { "/" power }
    fn quotient(&mut self) -> Result<Scale, UnitError> {
        let mut total = self.power()?;
        let mut was_divided = false;
        loop {
            self.skip_spaces();
            let Some(c) = self.rest.chars().next() else { return Ok(total) };
            let divide = match c {
                ')' => return Ok(total),
                '/' => true,
                '*' | '·' | '⋅' | '×' => false,
                _ => {
                    // A space stood here, or two factors touch: `m(s)`.
                    if was_divided {
                        return Err(UnitError::Ambiguous { unit: self.text.to_owned() });
                    }
                    let factor = self.power()?;
                    total = self.combine(total, factor, false)?;
                    continue;
                }
            };
            if was_divided && !divide {
                return Err(UnitError::Ambiguous { unit: self.text.to_owned() });
            }
            self.rest = &self.rest[c.len_utf8()..];
            let factor = self.power()?;
            total = self.combine(total, factor, divide)?;
            was_divided |= divide;
        }
    }

    fn combine(&self, a: Scale, b: Scale, divide: bool) -> Result<Scale, UnitError> {
        let dimension =
            if divide { a.dimension.checked_div(b.dimension) } else { a.dimension.checked_mul(b.dimension) };
        let dimension = dimension.ok_or_else(|| self.range())?;
        let (above, below) = if divide { (b.below, b.above) } else { (b.above, b.below) };
        Ok(Scale { above: a.above * above, below: a.below * below, dimension })
    }

    /// power = ("(" quotient ")" | symbol) [ exponent ]
    fn power(&mut self) -> Result<Scale, UnitError> {
        self.skip_spaces();
        let base = if let Some(inner) = self.rest.strip_prefix('(') {
            self.depth += 1;
            if self.depth > 8 {
                return Err(self.syntax("too many parentheses".to_owned()));
            }
            self.rest = inner;
            let scale = self.quotient()?;
            self.rest =
                self.rest.strip_prefix(')').ok_or_else(|| self.syntax("a parenthesis is not closed".to_owned()))?;
            self.depth -= 1;
            scale
        } else {
            self.symbol()?
        };
        let exponent = self.exponent()?;
        let dimension = base.dimension.checked_powi(exponent).ok_or_else(|| self.range())?;
        let power = i32::from(exponent.unsigned_abs());
        let (above, below) = (base.above.powi(power), base.below.powi(power));
        Ok(if exponent < 0 {
            Scale { above: below, below: above, dimension }
        } else {
            Scale { above, below, dimension }
        })
    }

    fn symbol(&mut self) -> Result<Scale, UnitError> {
        let is_letter = |c: char| c.is_alphabetic() || matches!(c, '°' | '%' | '_' | '\'' | '"');
        let end = self.rest.char_indices().find(|(_, c)| !is_letter(*c)).map_or(self.rest.len(), |(i, _)| i);
        let (symbol, rest) = self.rest.split_at(end);
        if symbol.is_empty() {
            // The only number that is a unit is 1, and no digit may follow it.
            if let Some(rest) = self.rest.strip_prefix('1')
                && !rest.starts_with(|c: char| c.is_ascii_digit() || c == '.' || is_letter(c))
            {
                self.rest = rest;
                return Ok(Scale { above: 1.0, below: 1.0, dimension: Dimension::ONE });
            }
            return Err(match self.rest.chars().next() {
                None => self.syntax("it ends where a unit should follow".to_owned()),
                Some(c) => self.syntax(format!("unexpected `{c}`")),
            });
        }
        self.rest = rest;
        if matches!(symbol, "degC" | "°C") {
            return Err(UnitError::Offset { unit: self.text.to_owned() });
        }
        let (above, below, dimension) = look_up(symbol)
            .ok_or_else(|| UnitError::Unknown { symbol: symbol.to_owned(), advice: advice(symbol, None) })?;
        Ok(Scale { above, below, dimension })
    }

    /// `^-2`, `^(-2)`, `2`, `⁻²`, or nothing.
    fn exponent(&mut self) -> Result<i8, UnitError> {
        let bad = |found: &str| self.syntax(format!("`{}` is not a whole exponent", shorten(found)));
        let plain: String = self.rest.chars().map_while(superscript).collect();
        if !plain.is_empty() {
            let length: usize = self.rest.chars().take(plain.chars().count()).map(char::len_utf8).sum();
            let value = plain.parse().map_err(|_| bad(&self.rest[..length]))?;
            self.rest = &self.rest[length..];
            return Ok(value);
        }
        let (after, is_marked) = match self.rest.trim_start().strip_prefix('^') {
            Some(after) => (after.trim_start(), true),
            None => (self.rest, false),
        };
        let (body, is_closed) = match after.strip_prefix('(') {
            Some(inner) if is_marked => (inner.trim_start(), true),
            _ => (after, false),
        };
        let sign = usize::from(is_marked && body.starts_with(['-', '+']));
        let digits = body[sign..].bytes().take_while(u8::is_ascii_digit).count();
        if digits == 0 {
            return if is_marked { Err(bad(after)) } else { Ok(1) };
        }
        let end = sign + digits;
        let value: i8 = body[..end].parse().map_err(|_| bad(&body[..end]))?;
        let mut rest = &body[end..];
        if rest.starts_with('.') {
            return Err(bad(body));
        }
        if is_closed {
            rest = rest.trim_start().strip_prefix(')').ok_or_else(|| bad(after))?;
        }
        self.rest = rest;
        Ok(value)
    }
}

fn superscript(c: char) -> Option<char> {
    const SUPERSCRIPTS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    if c == '⁻' {
        return Some('-');
    }
    let digit = SUPERSCRIPTS.iter().position(|s| *s == c)?;
    char::from_digit(u32::try_from(digit).ok()?, 10)
}

/// Symbols that take prefixes.
const PREFIXED: &[(&str, f64, Dimension)] = &[
    ("m", 1.0, Dimension::LENGTH),
    ("s", 1.0, Dimension::TIME),
    ("g", 1e-3, Dimension::MASS),
    ("N", 1.0, Dimension::FORCE),
    ("Nm", 1.0, Dimension::MOMENT),
    ("Pa", 1.0, Dimension::PRESSURE),
    ("Hz", 1.0, Dimension::ANGULAR_SPEED),
    ("A", 1.0, Dimension::CURRENT),
    ("V", 1.0, Dimension::VOLTAGE),
    ("W", 1.0, Dimension::POWER),
    ("J", 1.0, Dimension::MOMENT),
    ("l", 1e-3, Dimension::VOLUME),
    ("L", 1e-3, Dimension::VOLUME),
    ("K", 1.0, Dimension::TEMPERATURE),
];

/// Symbols without prefixes: factor above, factor below.
///
/// Foot, inch, pound: 1959 agreement (exact). Knot: 1852 m an hour (exact).
/// Pound-force: 0.45359237 kg under 9.80665 m/s² (exact).
const PLAIN: &[(&str, f64, f64, Dimension)] = &[
    ("ft", 0.3048, 1.0, Dimension::LENGTH),
    ("in", 0.0254, 1.0, Dimension::LENGTH),
    ("nmi", 1852.0, 1.0, Dimension::LENGTH),
    ("kn", 1852.0, 3600.0, Dimension::SPEED),
    ("kt", 1852.0, 3600.0, Dimension::SPEED),
    ("kg", 1.0, 1.0, Dimension::MASS),
    ("t", 1000.0, 1.0, Dimension::MASS),
    ("lb", 0.45359237, 1.0, Dimension::MASS),
    ("lbf", 4.4482216152605, 1.0, Dimension::FORCE),
    ("gf", 9.80665e-3, 1.0, Dimension::FORCE),
    ("kgf", 9.80665, 1.0, Dimension::FORCE),
    ("bar", 1e5, 1.0, Dimension::PRESSURE),
    ("Nmm", 1.0, 1000.0, Dimension::MOMENT),
    ("min", 60.0, 1.0, Dimension::TIME),
    ("h", 3600.0, 1.0, Dimension::TIME),
    ("rad", 1.0, 1.0, Dimension::ONE),
    ("deg", PI / 180.0, 1.0, Dimension::ONE),
    ("°", PI / 180.0, 1.0, Dimension::ONE),
    ("gon", PI / 200.0, 1.0, Dimension::ONE),
    ("rev", 2.0 * PI, 1.0, Dimension::ONE),
    ("rpm", 2.0 * PI / 60.0, 1.0, Dimension::ANGULAR_SPEED),
    ("%", 1.0, 100.0, Dimension::ONE),
];

/// Those of [`PLAIN`], and degC, before which people write a prefix where a person elsewhere reads another word.
const NEVER_PREFIXED: &[&str] = &["rad", "deg", "°", "gon", "rev", "rpm", "min", "h", "degC", "°C"];

/// Prefixes as factor above and below: a thousandth is a division by 1000.
const PREFIXES: &[(&str, f64, f64)] = &[
    ("n", 1.0, 1e9),
    ("u", 1.0, 1e6),
    ("µ", 1.0, 1e6),
    ("μ", 1.0, 1e6),
    ("m", 1.0, 1e3),
    ("c", 1.0, 1e2),
    ("d", 1.0, 1e1),
    ("h", 1e2, 1.0),
    ("k", 1e3, 1.0),
    ("M", 1e6, 1.0),
    ("G", 1e9, 1.0),
];

fn look_up(symbol: &str) -> Option<(f64, f64, Dimension)> {
    if let Some(&(_, above, below, dimension)) = PLAIN.iter().find(|u| u.0 == symbol) {
        return Some((above, below, dimension));
    }
    let with_prefix = |tail: &str, above: f64, below: f64| {
        let &(name, factor, dimension) = PREFIXED.iter().find(|u| u.0 == tail)?;
        // One gram is 1/1000 kg, one litre 1/1000 m^3: keep thousandths as divisors.
        Some(if matches!(name, "g" | "l" | "L") {
            (above, below * 1000.0, dimension)
        } else {
            (above * factor, below, dimension)
        })
    };
    with_prefix(symbol, 1.0, 1.0).or_else(|| {
        PREFIXES.iter().find_map(|&(prefix, above, below)| with_prefix(symbol.strip_prefix(prefix)?, above, below))
    })
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
fn advice(symbol: &str, dimension: Option<Dimension>) -> String {
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
