//! Units of parts of a formula, whose powers may be fractions on the way.

/// Exponents in twelfths, so that halves, thirds and quarters are exact.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Unit([i32; 5]);

const TWELVE: i32 = 12;
/// No exponent grows beyond this many twelfths; further ones stay there and are refused.
const LARGEST: i32 = 1 << 20;

impl Unit {
    pub(super) const ONE: Self = Self([0; 5]);

    pub(super) fn of(dim: Dim) -> Self {
        Self(dim.map(|x| i32::from(x) * TWELVE))
    }

    fn with(self, other: Self, f: fn(i32, i32) -> i32) -> Self {
        let mut out = [0; 5];
        for (i, x) in out.iter_mut().enumerate() {
            *x = f(self.0[i], other.0[i]).clamp(-LARGEST, LARGEST);
        }
        Self(out)
    }

    pub(super) fn times(self, other: Self) -> Self {
        self.with(other, |a, b| a + b)
    }

    pub(super) fn over(self, other: Self) -> Self {
        self.with(other, |a, b| a - b)
    }

    /// `None` where a twelfth is not enough, or the exponent is huge.
    pub(super) fn power(self, exponent: f64) -> Option<Self> {
        let mut out = [0; 5];
        for (x, &from) in out.iter_mut().zip(&self.0) {
            let exact = f64::from(from) * exponent;
            let rounded = exact.round();
            if (exact - rounded).abs() > 1e-9 || rounded.abs() > f64::from(LARGEST) {
                return None;
            }
            *x = rounded as i32;
        }
        Some(Self(out))
    }

    pub(super) fn whole(self) -> Option<Dim> {
        let mut out = [0; 5];
        for (x, twelfths) in out.iter_mut().zip(self.0) {
            if twelfths % TWELVE != 0 {
                return None;
            }
            *x = i8::try_from(twelfths / TWELVE).ok().filter(|x| *x != i8::MIN)?;
        }
        Some(out)
    }
}

/// `kg/m`, `m^2/s^2`, `N`, `N m`, `1/s`; `1` for a pure number.
impl std::fmt::Display for Unit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        const NEWTON: Unit = Unit([TWELVE, TWELVE, -2 * TWELVE, 0, 0]);
        const NEWTON_METRE: Unit = Unit([2 * TWELVE, TWELVE, -2 * TWELVE, 0, 0]);
        if *self == NEWTON {
            return f.write_str("N");
        }
        if *self == NEWTON_METRE {
            return f.write_str("N m");
        }
        // Mass first, as in kg m/s^2.
        let named = [("kg", self.0[1]), ("m", self.0[0]), ("s", self.0[2]), ("K", self.0[3]), ("A", self.0[4])];
        let power = |name: &str, twelfths: i32| match twelfths {
            TWELVE => name.to_owned(),
            _ if twelfths % TWELVE == 0 => format!("{name}^{}", twelfths / TWELVE),
            _ if twelfths % 6 == 0 => format!("{name}^({}/2)", twelfths / 6),
            _ => format!("{name}^({twelfths}/12)"),
        };
        let above: Vec<String> = named.iter().filter(|(_, x)| *x > 0).map(|(name, x)| power(name, *x)).collect();
        let below: Vec<String> = named.iter().filter(|(_, x)| *x < 0).map(|(name, x)| power(name, -*x)).collect();
        f.write_str(if above.is_empty() { "1" } else { "" })?;
        f.write_str(&above.join(" "))?;
        match below.as_slice() {
            [] => Ok(()),
            [one] => write!(f, "/{one}"),
            many => write!(f, "/({})", many.join(" ")),
        }
    }
}

/// Exponents of m, kg, s, K and A.
pub type Dim = [i8; 5];
