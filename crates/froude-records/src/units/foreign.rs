//! Spellings that are no unit here: what they may mean, each with its quantity.
//!
//! What is proposed never changes the meaning: a spelling that is known elsewhere is answered from a table, and a slip of the finger only by
//! a unit of the quantity that is asked for.

use super::spellings::WORDS;
use super::symbols::{NEVER_PREFIXED, PLAIN, PREFIXED, PREFIXES};
use super::{Dimension, parse_unit};

/// What a spelling may mean: a unit to write, and what it is, where the unit alone does not say so.
type Meanings = &'static [(&'static str, &'static str)];

/// Spellings that are read in two ways, or that people elsewhere write.
const FOREIGN: &[(&[&str], Meanings)] = &[
    (
        &["grad", "grads", "grade", "gradian", "gradians", "Grad", "Grads", "GRAD", "Grade", "Gradian"],
        &[("deg", "360 to the turn"), ("gon", "400 to the turn")],
    ),
    (&["mps"], &[("m/s", "")]),
    (&["mps2"], &[("m/s^2", "")]),
    (&["C"], &[("degC", "degree Celsius, a temperature"), ("A s", "coulomb, a charge")]),
    (&["F"], &[("degF", "degree Fahrenheit, a temperature"), ("A s/V", "farad, a capacitance")]),
    (&["H"], &[("h", "hour, a time"), ("V s/A", "henry, an inductance")]),
    (&["S"], &[("s", "second, a time"), ("A/V", "siemens, a conductance")]),
    (&["T"], &[("t", "tonne, a mass"), ("V s/m^2", "tesla, a flux density")]),
    (&["Wb"], &[("V s", "weber, a flux")]),
    (&["M"], &[("m", "metre, a length"), ("nmi", "nautical mile, a length")]),
    (&["G", "Gs"], &[("g0", "9.80665 m/s^2, an acceleration"), ("g", "gram, a mass")]),
    (&["gr", "Gr", "gm", "gms"], &[("g", "gram, a mass; a grain is 0.0648 of it")]),
    (&["gmf", "grf", "gramf", "p", "pond"], &[("gf", "gram-force, 9.80665e-3 N")]),
    (&["gpl"], &[("g/l", "")]),
    (&["KN", "Kn"], &[("kN", "kilonewton, a force"), ("kn", "knot, a speed")]),
    (&["KT", "Kt"], &[("kn", "knot, a speed"), ("t", "tonne, a mass: a kilotonne is 1000 of it")]),
    (
        &["hp", "HP", "Hp", "bhp", "BHP", "shp", "SHP"],
        &[("hp_imp", "mechanical horsepower, 745.69987 W"), ("PS", "metric horsepower, 735.49875 W")],
    ),
    (&["cv", "CV", "ch", "hk", "pk"], &[("PS", "metric horsepower, 735.49875 W")]),
    (&["kgm"], &[("kg m", "a mass times a length"), ("kgf m", "a moment, 9.80665 N m")]),
    (&["kgcm"], &[("kg cm", "a mass times a length"), ("kgf cm", "a moment, 0.0980665 N m")]),
    (&["gcm"], &[("g cm", "a mass times a length"), ("gf cm", "a moment, 9.80665e-5 N m")]),
    (&["ftlb", "ftlbs", "lbft"], &[("ft lbf", "a moment, 1.3558179 N m"), ("ft lb", "a mass times a length")]),
    (&["inlb", "inlbs", "lbin"], &[("in lbf", "a moment, 0.11298483 N m"), ("in lb", "a mass times a length")]),
    (&["ozin", "inoz"], &[("ozf in", "a moment, 7.0615518e-3 N m"), ("oz in", "a mass times a length")]),
    (&["floz"], &[("ml", "a US fluid ounce is 29.57353 of it, an imperial one 28.41306")]),
    (
        &["ton", "tons", "Ton", "Tons", "TON"],
        &[
            ("t", "tonne, 1000 kg"),
            ("ton_short", "short ton (US), 907.18474 kg"),
            ("ton_long", "long ton (UK), 1016.0469 kg"),
            ("tf", "tonne-force, 9806.65 N"),
            ("kip", "1000 lbf; a short ton-force is 2 kip"),
        ],
    ),
    (&["tonf"], &[("tf", "tonne-force, 9806.65 N"), ("kip", "1000 lbf; a short ton-force is 2 kip, a long one 2.24")]),
    (
        &["gal", "gallon", "gallons", "Gal"],
        &[
            ("gal_US", "3.785411784 l, a volume"),
            ("gal_imp", "4.54609 l, a volume"),
            ("cm/s^2", "galileo, an acceleration"),
        ],
    ),
    (&["gpm", "GPM"], &[("gal_US/min", "3.785411784 l/min"), ("gal_imp/min", "4.54609 l/min")]),
    (&["gph", "GPH"], &[("gal_US/h", "3.785411784 l/h"), ("gal_imp/h", "4.54609 l/h")]),
    (&["mile", "miles"], &[("mi", "statute mile, 1609.344 m"), ("nmi", "nautical mile, 1852 m")]),
    (&["NM", "sm"], &[("nmi", "nautical mile, 1852 m"), ("N m", "newton metre, a moment")]),
    (&["fps", "FPS"], &[("ft/s", "feet a second, a speed"), ("Hz", "frames a second, a frequency")]),
    (&["cps"], &[("Hz", "cycles a second, a frequency"), ("cP", "centipoise, a viscosity")]),
    (&["cycle", "cycles"], &[("rev", "a whole turn, an angle"), ("1", "a number of cycles, without size")]),
    (&["U", "omdr", "tr", "trs", "tours"], &[("rev", "a turn, an angle")]),
    (&["o"], &[("rev", "a turn, an angle"), ("deg", "degree, an angle")]),
    (&["mmWS", "mmWC", "mmWs"], &[("mmH2O", "9.80665 Pa, a pressure")]),
    (&["torr", "Torr"], &[("mmHg", "133.322 Pa, a pressure")]),
    (&["inHg", "inchHg"], &[("mmHg", "a pressure; an inch of mercury is 25.4 of it")]),
    (&["at"], &[("kgf/cm^2", "technical atmosphere, 98066.5 Pa"), ("atm", "standard atmosphere, 101325 Pa")]),
    (&["ksi", "KSI"], &[("kip/in^2", "a pressure")]),
    (&["lb_f", "lbforce"], &[("lbf", "")]),
    (
        &["st", "St"],
        &[("cSt", "centistokes, a viscosity: a stokes is 100 of it"), ("lb", "a stone is 14 of it, a mass")],
    ),
    (&["P"], &[("cP", "centipoise, a viscosity: a poise is 100 of it"), ("Pa", "pascal, a pressure")]),
    (&["slug", "slugs"], &[("lbf s^2/ft", "14.593903 kg, a mass")]),
    (&["pdl"], &[("lb ft/s^2", "poundal, 0.138255 N, a force")]),
    (&["psf", "PSF"], &[("lbf/ft^2", "a pressure")]),
    (&["ppt", "psu", "PSU", "PPT"], &[("g/kg", "parts in a thousand, a salinity")]),
    (&["ppb"], &[("ppm", "parts per million; 1 ppb is 0.001 ppm")]),
    (&["Std"], &[("h", "Stunde: hour, a time")]),
    (&["d", "day", "days", "Tag", "Tage", "jour", "jours"], &[("h", "hour, a time: a day is 24 of it")]),
    (&["qm", "sqm"], &[("m^2", "an area")]),
    (&["cbm", "cum"], &[("m^3", "a volume")]),
    (&["ε", "eps"], &[("strain", "a strain of 1"), ("microstrain", "a strain of 1e-6")]),
    (&["ue", "uE", "µE"], &[("microstrain", "a strain of 1e-6")]),
    (
        &["bit", "bits", "LSB", "lsb", "digit", "digits", "imp", "Imp", "Impulse", "raw"],
        &[("count", "a number of counts, without size")],
    ),
    (&["step", "steps", "Schritt", "Schritte"], &[("count", "a number of counts, without size")]),
    (&["'", "′"], &[("ft", "foot, a length"), ("deg", "degree, an angle: a minute of arc is a 60th of it")]),
    (&["\"", "″", "''"], &[("in", "inch, a length"), ("deg", "degree, an angle: a second of arc is a 3600th of it")]),
];

/// Units of a logarithm, from which no number follows by a factor.
const LOGARITHMIC: &[&str] = &["dB", "dBm", "dBV", "dBA", "Np", "pH"];

/// Longest spelling that a slip of the finger is looked for in.
const LONGEST: usize = 32;
/// Shortest one: of three letters every other one is a unit too.
const SHORTEST: usize = 4;

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

/// What was probably meant, among the units of one kind where that is known; empty where nothing is.
pub(super) fn advice(symbol: &str, dimension: Option<Dimension>) -> String {
    let of = |unit: &str| parse_unit(unit).ok().map(|unit| unit.dimension);
    let is_wanted = |found: Dimension| dimension.is_none_or(|wanted| wanted == found);
    if LOGARITHMIC.contains(&symbol) {
        return " is the logarithm of a ratio; convert the numbers to a linear unit before they are read here"
            .to_owned();
    }
    if let Some((_, meanings)) = FOREIGN.iter().find(|(spellings, _)| spellings.contains(&symbol)) {
        // Of another kind than is asked for, none of them is meant.
        let shown: Vec<_> = meanings.iter().filter(|(unit, _)| of(unit).is_some_and(is_wanted)).collect();
        return match shown.as_slice() {
            [] => String::new(),
            [(unit, "")] => format!("; did you mean `{unit}`?"),
            all => {
                let all: Vec<String> = all.iter().map(|(unit, what)| format!("`{unit}` ({what})")).collect();
                format!("; did you mean {}?", all.join(" or "))
            }
        };
    }
    if let Some(told) = no_prefix(symbol).filter(|(dimension, _)| is_wanted(*dimension)) {
        return told.1;
    }
    let Some(wanted) = dimension else { return String::new() };
    match slip(symbol, wanted) {
        Some(unit) => format!("; did you mean `{unit}`?"),
        None => String::new(),
    }
}

/// The unit of a kind that differs by capitals alone, or in a word of some length by one letter; `None` of several.
fn slip(symbol: &str, wanted: Dimension) -> Option<&'static str> {
    let length = symbol.chars().count();
    if length > LONGEST {
        return None;
    }
    let symbols = PLAIN.iter().map(|u| (u.0, u.3)).chain(PREFIXED.iter().map(|u| (u.0, u.2)));
    let words = WORDS.iter().filter_map(|(symbol, words)| Some((parse_unit(symbol).ok()?.dimension, words)));
    let words = words.flat_map(|(dimension, words)| words.iter().map(move |word| (*word, dimension)));
    let all = symbols.chain([("degC", Dimension::TEMPERATURE)]).chain(words);
    let all: Vec<&str> = all.filter(|(_, found)| *found == wanted).map(|(name, _)| name).collect();
    let only = |found: Vec<&'static str>| match found.as_slice() {
        [one] => Some(*one),
        _ => None,
    };
    let by_case = all.iter().copied().filter(|name| name.to_lowercase() == symbol.to_lowercase()).collect();
    let by_letter = || {
        let near = |name: &&str| name.chars().count() >= SHORTEST && strsim::osa_distance(name, symbol) == 1;
        all.iter().copied().filter(near).collect()
    };
    only(by_case).or_else(|| if length >= SHORTEST { only(by_letter()) } else { None })
}
