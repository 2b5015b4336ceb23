//! The symbols of units and their prefixes.

use std::f64::consts::PI;

use super::Dimension;
use super::spellings::one_spelling;

/// Symbols that take prefixes.
pub(super) const PREFIXED: &[(&str, f64, Dimension)] = &[
    ("m", 1.0, Dimension::LENGTH),
    ("s", 1.0, Dimension::TIME),
    ("g", 1e-3, Dimension::MASS),
    ("N", 1.0, Dimension::FORCE),
    ("Nm", 1.0, Dimension::MOMENT),
    ("Pa", 1.0, Dimension::PRESSURE),
    ("Hz", 1.0, Dimension::ANGULAR_SPEED),
    ("A", 1.0, Dimension::CURRENT),
    ("V", 1.0, Dimension::VOLTAGE),
    ("ohm", 1.0, Dimension::RESISTANCE),
    ("Ω", 1.0, Dimension::RESISTANCE),
    // U+2126, the sign of the unit that is no letter of an alphabet.
    ("\u{2126}", 1.0, Dimension::RESISTANCE),
    ("W", 1.0, Dimension::POWER),
    ("J", 1.0, Dimension::MOMENT),
    ("l", 1e-3, Dimension::VOLUME),
    ("L", 1e-3, Dimension::VOLUME),
    ("K", 1.0, Dimension::TEMPERATURE),
];

/// Symbols without prefixes: factor above, factor below.
///
/// # Sources
///
/// NIST SP 811 (2008), appendix B.8. Foot, inch, yard, mile, pound, ounce: 1959 agreement (exact). Knot: 1852 m an hour (exact). Forces
/// of a mass: under 9.80665 m/s² (exact). Columns of water and mercury: conventional. Metric horsepower: 75 kgf m/s; mechanical: 550 ft
/// lbf/s. Gallons: 231 in³ (US), 4.54609 L (imperial).
pub(super) const PLAIN: &[(&str, f64, f64, Dimension)] = &[
    ("ft", 0.3048, 1.0, Dimension::LENGTH),
    ("in", 0.0254, 1.0, Dimension::LENGTH),
    ("yd", 0.9144, 1.0, Dimension::LENGTH),
    ("mi", 1609.344, 1.0, Dimension::LENGTH),
    ("nmi", 1852.0, 1.0, Dimension::LENGTH),
    ("gal_US", 3.785411784, 1000.0, Dimension::VOLUME),
    ("gal_imp", 4.54609, 1000.0, Dimension::VOLUME),
    ("kn", 1852.0, 3600.0, Dimension::SPEED),
    ("kt", 1852.0, 3600.0, Dimension::SPEED),
    ("mph", 1609.344, 3600.0, Dimension::SPEED),
    ("g0", 9.80665, 1.0, Dimension::ACCELERATION),
    ("kg", 1.0, 1.0, Dimension::MASS),
    ("t", 1000.0, 1.0, Dimension::MASS),
    ("lb", 0.45359237, 1.0, Dimension::MASS),
    ("oz", 0.028349523125, 1.0, Dimension::MASS),
    ("ton_short", 907.18474, 1.0, Dimension::MASS),
    ("ton_long", 1016.0469088, 1.0, Dimension::MASS),
    ("daN", 10.0, 1.0, Dimension::FORCE),
    ("dyn", 1.0, 1e5, Dimension::FORCE),
    ("lbf", 4.4482216152605, 1.0, Dimension::FORCE),
    ("kip", 4448.2216152605, 1.0, Dimension::FORCE),
    ("ozf", 4.4482216152605, 16.0, Dimension::FORCE),
    ("gf", 9.80665e-3, 1.0, Dimension::FORCE),
    ("kgf", 9.80665, 1.0, Dimension::FORCE),
    ("tf", 9806.65, 1.0, Dimension::FORCE),
    ("bar", 1e5, 1.0, Dimension::PRESSURE),
    ("mbar", 100.0, 1.0, Dimension::PRESSURE),
    ("dbar", 1e4, 1.0, Dimension::PRESSURE),
    ("atm", 101_325.0, 1.0, Dimension::PRESSURE),
    ("psi", 4.4482216152605, 0.00064516, Dimension::PRESSURE),
    ("mmHg", 133.322387415, 1.0, Dimension::PRESSURE),
    ("mmH2O", 9.80665, 1.0, Dimension::PRESSURE),
    ("cmH2O", 98.0665, 1.0, Dimension::PRESSURE),
    ("mH2O", 9806.65, 1.0, Dimension::PRESSURE),
    ("PS", 735.49875, 1.0, Dimension::POWER),
    ("hp_imp", 745.699_871_582_270_2, 1.0, Dimension::POWER),
    ("Nmm", 1.0, 1000.0, Dimension::MOMENT),
    ("Ncm", 1.0, 100.0, Dimension::MOMENT),
    ("cSt", 1.0, 1e6, Dimension::KINEMATIC_VISCOSITY),
    ("cP", 1.0, 1000.0, Dimension::DYNAMIC_VISCOSITY),
    ("min", 60.0, 1.0, Dimension::TIME),
    ("h", 3600.0, 1.0, Dimension::TIME),
    ("rad", 1.0, 1.0, Dimension::ONE),
    ("deg", PI / 180.0, 1.0, Dimension::ONE),
    ("°", PI / 180.0, 1.0, Dimension::ONE),
    ("gon", PI / 200.0, 1.0, Dimension::ONE),
    ("rev", 2.0 * PI, 1.0, Dimension::ONE),
    ("rpm", 2.0 * PI / 60.0, 1.0, Dimension::ANGULAR_SPEED),
    ("rps", 2.0 * PI, 1.0, Dimension::ANGULAR_SPEED),
    ("%", 1.0, 100.0, Dimension::ONE),
    ("‰", 1.0, 1000.0, Dimension::ONE),
    ("ppm", 1.0, 1e6, Dimension::ONE),
    ("strain", 1.0, 1.0, Dimension::ONE),
    ("microstrain", 1.0, 1e6, Dimension::ONE),
    ("count", 1.0, 1.0, Dimension::ONE),
];

/// Those of [`PLAIN`], and degC, before which people write a prefix where a person elsewhere reads another word.
pub(super) const NEVER_PREFIXED: &[&str] = &["rad", "deg", "°", "gon", "rev", "rpm", "min", "h", "degC", "°C"];

/// Those of [`PLAIN`] in which a digit is part of the name, and no exponent.
pub(super) const WITH_DIGITS: &[&str] = &["g0", "mmH2O", "cmH2O", "mH2O"];

/// Temperatures with an offset, which stand alone: spellings, kelvins in one, kelvins at zero.
pub(super) const TEMPERATURES: &[(&[&str], f64, f64)] = &[
    (&["degC", "°C", "ºC", "℃", "deg C", "° C", "deg_C", "Celsius", "celsius"], 1.0, 273.15),
    (&["degF", "°F", "ºF", "℉", "deg F", "° F", "deg_F", "Fahrenheit"], 5.0 / 9.0, 459.67 * 5.0 / 9.0),
];

/// Prefixes as factor above and below: a thousandth is a division by 1000.
pub(super) const PREFIXES: &[(&str, f64, f64)] = &[
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

pub(super) fn look_up(symbol: &str) -> Option<(f64, f64, Dimension)> {
    let symbol = one_spelling(symbol);
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
