//! Other spellings of units that have one meaning, whoever writes them.
//!
//! A word is replaced wherever a symbol may stand, a phrase only where it is the whole unit. What is written keeps its text; a spelling that
//! two trades read in two ways is in [`super::foreign`] instead.

/// The symbol, and how else it is written.
pub(super) const WORDS: &[(&str, &[&str])] = &[
    (
        "s",
        &[
            "sec", "secs", "second", "seconds", "Sek", "Sekunde", "Sekunden", "segundo", "segundos", "sekund",
            "sekunder", "秒",
        ],
    ),
    ("ms", &["msec", "msecs", "millisecond", "milliseconds"]),
    ("us", &["usec", "µsec", "μsec", "microsecond", "microseconds"]),
    ("min", &["mins", "minute", "minutes", "Minute", "Minuten", "minuto", "minutos", "分"]),
    ("h", &["hr", "hrs", "hour", "hours", "Stunde", "Stunden", "heure", "heures", "hora", "horas"]),
    ("m", &["meter", "meters", "metre", "metres", "Meter", "mètre", "mètres", "metro", "metros"]),
    ("mm", &["millimeter", "millimeters", "millimetre", "millimetres", "Millimeter"]),
    ("cm", &["centimeter", "centimeters", "centimetre", "centimetres", "Zentimeter"]),
    ("km", &["kilometer", "kilometers", "kilometre", "kilometres", "Kilometer"]),
    ("ft", &["foot", "feet"]),
    ("in", &["inch", "inches", "Zoll"]),
    ("yd", &["yard", "yards"]),
    (
        "kn",
        &[
            "kts", "knot", "knots", "KTS", "Knot", "Knots", "KNOTS", "Knoten", "nœud", "nœuds", "noeud", "noeuds",
            "nudo", "nudos",
        ],
    ),
    ("mph", &["MPH"]),
    ("kg", &["kgs", "Kg", "KG", "kilogram", "kilograms", "Kilogramm"]),
    ("g", &["gram", "grams", "gramme", "grammes", "Gramm"]),
    ("t", &["te", "tonne", "tonnes"]),
    ("lb", &["lbs", "lbm", "LBS", "pound", "pounds"]),
    ("oz", &["ounce", "ounces"]),
    ("N", &["newton", "newtons", "Newton", "Newtons"]),
    ("Nm", &["Newtonmeter"]),
    ("lbf", &["LBF"]),
    ("kip", &["kips", "klbf"]),
    ("kgf", &["kp", "Kgf", "KGF", "kilopond"]),
    ("psi", &["PSI", "psig", "PSIG", "psid", "psia", "PSIA"]),
    ("bar", &["barg", "bara"]),
    ("Pa", &["pascal", "pascals", "Pascal"]),
    ("Hz", &["hz", "HZ", "hertz", "Hertz"]),
    ("A", &["amp", "amps", "Amp", "Amps", "ampere", "amperes", "Ampere"]),
    ("V", &["volt", "volts", "Volt", "Volts"]),
    ("ohm", &["Ohm", "ohms", "Ohms"]),
    ("W", &["watt", "watts", "Watt", "Watts"]),
    ("J", &["joule", "joules", "Joule", "Joules"]),
    ("K", &["kelvin", "kelvins", "Kelvin", "degK", "°K"]),
    ("l", &["litre", "litres", "liter", "liters", "Liter", "litro", "litros"]),
    ("deg", &["degree", "degrees", "Degree", "Degrees", "Deg", "DEG", "degs", "º", "度"]),
    ("rad", &["radian", "radians", "rads", "Rad", "RAD"]),
    ("rev", &["revs", "revolution", "revolutions", "turn", "turns", "Umdrehung", "Umdrehungen"]),
    ("rpm", &["RPM", "Rpm", "UPM", "Upm"]),
    ("rps", &["RPS"]),
    ("count", &["cts", "cnt", "cnts", "counts", "Counts", "tick", "ticks", "pulse", "pulses"]),
    ("%", &["percent", "pct", "Prozent"]),
    ("microstrain", &["µε", "με", "ustrain", "uStrain", "µStrain", "µstrain"]),
    ("strain", &["Strain"]),
];

/// The unit, and how else the whole of it is written.
pub(super) const PHRASES: &[(&str, &[&str])] = &[
    ("1", &["-", "--", "---", "–", "—", "−", "(-)", "unitless", "dimensionless", "adim"]),
    ("rev/min", &["r/min", "U/min", "tr/min", "trs/min", "tours/min", "omdr/min", "回転/分"]),
    ("rev/s", &["r/s", "U/s", "tr/s", "tours/s"]),
    ("deg/s", &["dps", "DPS"]),
    ("km/h", &["kph", "KPH", "kmh", "kmph", "Km/h", "KM/H"]),
    ("l/min", &["lpm", "LPM"]),
    ("cm^3", &["cc", "ccm"]),
    ("kgf cm", &["kgfcm"]),
    ("kgf m", &["kgfm", "kpm"]),
    ("ft lbf", &["ftlbf"]),
    ("lbf ft", &["lbfft"]),
    ("lbf in", &["lbfin"]),
    ("m/s", &["㎧"]),
    ("m/s^2", &["㎨"]),
    ("mm", &["㎜"]),
    ("cm", &["㎝"]),
    ("km", &["㎞"]),
    ("kg", &["㎏"]),
    ("m^2", &["㎡"]),
    ("m^3", &["㎥"]),
    ("Hz", &["㎐"]),
    ("Pa", &["㎩"]),
];

/// The symbol that a word stands for; itself where it is no such word.
pub(super) fn one_spelling(symbol: &str) -> &str {
    of(WORDS, symbol).unwrap_or(symbol)
}

/// The unit that a phrase stands for; itself where it is no such phrase.
pub(super) fn whole(text: &str) -> &str {
    of(PHRASES, text).unwrap_or(text)
}

fn of(table: &'static [(&'static str, &'static [&'static str])], text: &str) -> Option<&'static str> {
    table.iter().find(|(_, others)| others.contains(&text)).map(|(symbol, _)| *symbol)
}
