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
            _ => return format!("a quantity in {self}"),
        };
        format!("{words} ({self})")
    }
}

impl fmt::Display for Dimension {
    /// The SI unit as text that [`parse_unit`](super::parse_unit) reads back: `kg/m^3`, `N m`, `1`.
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
