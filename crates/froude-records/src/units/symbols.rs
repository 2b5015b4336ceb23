//! The symbols of units and their prefixes.

use std::f64::consts::PI;

use super::Dimension;

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
pub(super) const PLAIN: &[(&str, f64, f64, Dimension)] = &[
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
    ("ppm", 1.0, 1e6, Dimension::ONE),
];

/// Those of [`PLAIN`], and degC, before which people write a prefix where a person elsewhere reads another word.
pub(super) const NEVER_PREFIXED: &[&str] = &["rad", "deg", "°", "gon", "rev", "rpm", "min", "h", "degC", "°C"];

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
