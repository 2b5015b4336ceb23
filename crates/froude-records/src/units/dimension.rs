//! Dimensions: exponents of the SI base units.

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
    /// Electric resistance, ohm.
    pub const RESISTANCE: Self = Self { m: 2, kg: 1, s: -3, k: 0, a: -2 };

    /// A mechanical dimension from its exponents of metre, kilogram and second.
    #[must_use]
    pub const fn new(m: i8, kg: i8, s: i8) -> Self {
        Self { m, kg, s, k: 0, a: 0 }
    }

    /// Product; `None` when an exponent leaves −127..=127.
    #[must_use]
    pub fn checked_mul(self, other: Self) -> Option<Self> {
        self.combined(other, i8::checked_add)
    }

    /// Quotient; `None` when an exponent leaves −127..=127.
    #[must_use]
    pub fn checked_div(self, other: Self) -> Option<Self> {
        self.combined(other, i8::checked_sub)
    }

    /// Whole power; `None` when an exponent leaves −127..=127.
    #[must_use]
    pub fn checked_powi(self, exponent: i8) -> Option<Self> {
        self.combined(self, |own, _| own.checked_mul(exponent))
    }

    fn combined(self, other: Self, exponent: impl Fn(i8, i8) -> Option<i8>) -> Option<Self> {
        // −128 has no opposite, so that `1/s^128` could not be written.
        let of = |a: i8, b: i8| exponent(a, b).filter(|e| *e != i8::MIN);
        Some(Self {
            m: of(self.m, other.m)?,
            kg: of(self.kg, other.kg)?,
            s: of(self.s, other.s)?,
            k: of(self.k, other.k)?,
            a: of(self.a, other.a)?,
        })
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
            Self::RESISTANCE => "an electrical resistance",
            _ => return format!("a quantity in {self}"),
        };
        format!("{words} ({self})")
    }
}

impl Dimension {
    /// The SI unit, written with volts or amperes where only one of them is among `beside`, the dimensions of the columns that it belongs to.
    ///
    /// `N/V^2` of a thrust over a voltage, rather than the base units `s^4 A^2/(kg m^3)`. Without electricity it is the same as by `Display`.
    #[must_use]
    pub fn written_beside(self, beside: &[Self]) -> String {
        let has = |dimension| beside.contains(&dimension);
        match (has(Self::VOLTAGE), has(Self::CURRENT)) {
            (true, false) => self.over(Self::VOLTAGE, "V").unwrap_or_else(|| self.to_string()),
            (false, true) => self.over(Self::CURRENT, "A").unwrap_or_else(|| self.to_string()),
            _ => self.to_string(),
        }
    }

    /// As a mechanical unit times a power of an electrical one; `None` where there is no such power.
    fn over(self, electrical: Self, symbol: &'static str) -> Option<String> {
        let power = self.a.checked_mul(electrical.a)?;
        let rest = self.checked_div(electrical.checked_powi(power)?)?;
        let mut parts = rest.parts();
        parts.insert(0, (symbol, power));
        (power != 0).then(|| joined(&parts))
    }

    /// Symbols of a mechanical dimension or of base units, with their exponents.
    fn parts(self) -> Vec<(&'static str, i8)> {
        let named: &[(&'static str, i8)] = match self {
            Self::ONE => return Vec::new(),
            Self::FORCE => &[("N", 1)],
            Self::MOMENT => &[("N", 1), ("m", 1)],
            Self::PRESSURE => &[("Pa", 1)],
            Self::DYNAMIC_VISCOSITY => &[("Pa", 1), ("s", 1)],
            Self::POWER => &[("W", 1)],
            Self::VOLTAGE => &[("V", 1)],
            Self::RESISTANCE => &[("ohm", 1)],
            _ => &[],
        };
        if !named.is_empty() {
            return named.to_vec();
        }
        let bases = [("kg", self.kg), ("m", self.m), ("s", self.s), ("K", self.k), ("A", self.a)];
        bases.into_iter().filter(|(_, exponent)| *exponent != 0).collect()
    }
}

/// `kg/m^3`, `N m`, `1/(s^2 A)`, `1`.
fn joined(parts: &[(&str, i8)]) -> String {
    let product = |positive: bool| {
        let chosen = parts.iter().filter(|(_, e)| (*e > 0) == positive);
        let words = chosen.map(|(symbol, e)| match e.unsigned_abs() {
            1 => (*symbol).to_owned(),
            power => format!("{symbol}^{power}"),
        });
        words.collect::<Vec<_>>()
    };
    let (above, below) = (product(true), product(false));
    let above = if above.is_empty() { "1".to_owned() } else { above.join(" ") };
    match below.iter().map(String::as_str).collect::<Vec<_>>().as_slice() {
        [] => above,
        // `N/A` is what people write where there is no value.
        ["A"] if above == "N" => "N A^-1".to_owned(),
        [one] => format!("{above}/{one}"),
        several => format!("{above}/({})", several.join(" ")),
    }
}

impl fmt::Display for Dimension {
    /// The SI unit as text that [`parse_unit`](super::parse_unit) reads back: `kg/m^3`, `N m`, `1`, `N/V^2`.
    ///
    /// One with electricity is written with amperes, with volts or in base units: the first of these with the fewest symbols.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let own = joined(&self.parts());
        if self.a == 0 || self.parts().len() == 1 {
            return f.write_str(&own);
        }
        // A newton metre is one unit, as the joule is.
        let length = |text: &String| {
            text.replace("N m", "J").split(|c: char| !c.is_ascii_alphabetic()).filter(|word| !word.is_empty()).count()
        };
        let electrical = [self.over(Self::CURRENT, "A"), self.over(Self::VOLTAGE, "V")];
        let all = electrical.into_iter().flatten().chain([own]);
        f.write_str(&all.min_by_key(length).unwrap_or_default())
    }
}
