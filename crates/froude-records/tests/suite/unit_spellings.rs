//! Unit spellings of instruments, programs and people: read, asked or refused, and none read wrongly.
//!
//! Learned from LabVIEW, DIAdem, catman, MATLAB, Excel, Simulink, OrcaFlex, OpenFAST, servo data sheets, and from German, French, Spanish,
//! Norwegian and Japanese headers.

use std::f64::consts::PI;

use froude_records::units::{Dimension, foreign_part, parse_unit, parse_unit_for, question};

const POUND_N: f64 = 4.4482216152605;

/// Text, SI units in one, and the SI unit of its dimension.
#[rustfmt::skip]
fn read() -> Vec<(&'static str, f64, &'static str)> {
    vec![
        // Pure numbers, counts, strains.
        ("-", 1.0, "1"), ("[-]", 1.0, "1"), ("--", 1.0, "1"), ("(-)", 1.0, "1"), ("–", 1.0, "1"), ("unitless", 1.0, "1"),
        ("dimensionless", 1.0, "1"), ("[1]", 1.0, "1"), ("cts", 1.0, "1"), ("counts", 1.0, "1"), ("count", 1.0, "1"), ("ticks", 1.0, "1"),
        ("V/V", 1.0, "1"), ("mV/V", 1e-3, "1"), ("µm/m", 1e-6, "1"), ("µε", 1e-6, "1"), ("με", 1e-6, "1"), ("microstrain", 1e-6, "1"),
        ("percent", 0.01, "1"), ("‰", 1e-3, "1"),
        // Time.
        ("sec", 1.0, "s"), ("[s]", 1.0, "s"), ("seconds", 1.0, "s"), ("Sekunden", 1.0, "s"), ("秒", 1.0, "s"), ("msec", 1e-3, "s"),
        ("usec", 1e-6, "s"), ("µs", 1e-6, "s"), ("hr", 3600.0, "s"), ("heures", 3600.0, "s"), ("minutes", 60.0, "s"),
        // Lengths and volumes.
        ("inch", 0.0254, "m"), ("inches", 0.0254, "m"), ("in", 0.0254, "m"), ("Zoll", 0.0254, "m"), ("feet", 0.3048, "m"),
        ("metres", 1.0, "m"), ("Meter", 1.0, "m"), ("㎜", 1e-3, "m"), ("mi", 1609.344, "m"), ("cc", 1e-6, "m^3"), ("mL", 1e-6, "m^3"),
        ("m3", 1.0, "m^3"), ("m**3", 1.0, "m^3"), ("gal_US", 3.785411784e-3, "m^3"),
        // Speeds and flows.
        ("knots", 1852.0 / 3600.0, "m/s"), ("kts", 1852.0 / 3600.0, "m/s"), ("kn", 1852.0 / 3600.0, "m/s"), ("Knoten", 1852.0 / 3600.0, "m/s"),
        ("nœuds", 1852.0 / 3600.0, "m/s"), ("mph", 0.44704, "m/s"), ("ft/s", 0.3048, "m/s"), ("ft/sec", 0.3048, "m/s"), ("kph", 1.0 / 3.6, "m/s"),
        ("km/h", 1.0 / 3.6, "m/s"), ("km/hr", 1.0 / 3.6, "m/s"), ("m.s-1", 1.0, "m/s"), ("m s-1", 1.0, "m/s"), ("m·s⁻¹", 1.0, "m/s"),
        ("m·s−1", 1.0, "m/s"), ("m.s^-1", 1.0, "m/s"), ("m*s^-1", 1.0, "m/s"), ("㎧", 1.0, "m/s"), ("mm/sec", 1e-3, "m/s"),
        ("ml/s", 1e-6, "m^3/s"), ("L/min", 1.0 / 60_000.0, "m^3/s"), ("lpm", 1.0 / 60_000.0, "m^3/s"),
        ("gal_US/min", 3.785411784e-3 / 60.0, "m^3/s"),
        // Accelerations.
        ("g0", 9.80665, "m/s^2"), ("m/s²", 1.0, "m/s^2"), ("m/s^2", 1.0, "m/s^2"), ("m/s2", 1.0, "m/s^2"), ("m/s/s", 1.0, "m/s^2"),
        ("m/sec^2", 1.0, "m/s^2"), ("m.s-2", 1.0, "m/s^2"), ("m s⁻²", 1.0, "m/s^2"), ("m/s**2", 1.0, "m/s^2"), ("㎨", 1.0, "m/s^2"),
        // Angles and rates of turning.
        ("degrees", PI / 180.0, "1"), ("°", PI / 180.0, "1"), ("º", PI / 180.0, "1"), ("DEG", PI / 180.0, "1"), ("度", PI / 180.0, "1"),
        ("radians", 1.0, "1"), ("revs", 2.0 * PI, "1"), ("deg/s", PI / 180.0, "1/s"), ("°/s", PI / 180.0, "1/s"), ("deg/sec", PI / 180.0, "1/s"),
        ("dps", PI / 180.0, "1/s"), ("deg.s-1", PI / 180.0, "1/s"), ("rad/s", 1.0, "1/s"), ("rad/sec", 1.0, "1/s"), ("rad s-1", 1.0, "1/s"),
        ("rad.s-1", 1.0, "1/s"), ("rps", 2.0 * PI, "1/s"), ("RPM", PI / 30.0, "1/s"), ("r/min", PI / 30.0, "1/s"), ("rev/min", PI / 30.0, "1/s"),
        ("U/min", PI / 30.0, "1/s"), ("Umdrehungen/min", PI / 30.0, "1/s"), ("tr/min", PI / 30.0, "1/s"), ("rev/s", 2.0 * PI, "1/s"),
        ("deg/s^2", PI / 180.0, "1/s^2"), ("1/min", 1.0 / 60.0, "1/s"), ("min⁻¹", 1.0 / 60.0, "1/s"), ("min-1", 1.0 / 60.0, "1/s"),
        ("kHz", 1000.0, "1/s"),
        // Masses and forces.
        ("lbs", 0.45359237, "kg"), ("lbm", 0.45359237, "kg"), ("Kg", 1.0, "kg"), ("kgs", 1.0, "kg"), ("te", 1000.0, "kg"), ("tonnes", 1000.0, "kg"),
        ("oz", 0.028349523125, "kg"), ("ton_short", 907.18474, "kg"), ("newtons", 1.0, "N"), ("kN", 1000.0, "N"), ("kp", 9.80665, "N"),
        ("kgf", 9.80665, "N"), ("KGF", 9.80665, "N"), ("lbf", POUND_N, "N"), ("ozf", POUND_N / 16.0, "N"), ("kip", 1000.0 * POUND_N, "N"), ("kips", 1000.0 * POUND_N, "N"), ("daN", 10.0, "N"), ("dyn", 1e-5, "N"),
        ("tf", 9806.65, "N"),
        // Moments.
        ("N-m", 1.0, "N m"), ("N.m", 1.0, "N m"), ("Nm", 1.0, "N m"), ("N*m", 1.0, "N m"), ("N·m", 1.0, "N m"), ("N•m", 1.0, "N m"),
        ("kN-m", 1000.0, "N m"), ("kN.m", 1000.0, "N m"), ("mN·m", 1e-3, "N m"), ("N-mm", 1e-3, "N m"), ("Ncm", 0.01, "N m"),
        ("Newton-meters", 1.0, "N m"), ("kgf.cm", 0.0980665, "N m"), ("kgf-m", 9.80665, "N m"), ("kgf·cm", 0.0980665, "N m"),
        ("ft-lbf", 0.3048 * POUND_N, "N m"), ("lbf.ft", 0.3048 * POUND_N, "N m"), ("lbf-in", 0.0254 * POUND_N, "N m"),
        ("gf m", 9.80665e-3, "N m"),
        // Pressures, power, electricity, temperature.
        ("psi", POUND_N / 0.00064516, "Pa"), ("psig", POUND_N / 0.00064516, "Pa"), ("mbar", 100.0, "Pa"), ("hPa", 100.0, "Pa"),
        ("dbar", 1e4, "Pa"), ("kgf/cm2", 98066.5, "Pa"), ("mmH2O", 9.80665, "Pa"), ("mmHg", 133.322387415, "Pa"), ("PS", 735.49875, "W"),
        ("hp_imp", 550.0 * 0.3048 * POUND_N, "W"), ("ohm", 1.0, "ohm"), ("Ohms", 1.0, "ohm"), ("Ω", 1.0, "ohm"), ("\u{2126}", 1.0, "ohm"),
        ("kΩ", 1000.0, "ohm"), ("V/A", 1.0, "ohm"), ("mA", 1e-3, "A"), ("amps", 1.0, "A"), ("Volt", 1.0, "V"), ("degK", 1.0, "K"),
        ("℃", 1.0, "K"), ("deg C", 1.0, "K"), ("°F", 5.0 / 9.0, "K"), ("cSt", 1e-6, "m^2/s"), ("cP", 1e-3, "Pa s"), ("kg.m-3", 1.0, "kg/m^3"),
    ]
}

#[test]
fn spellings_with_one_meaning_are_read() {
    let read = read();
    assert!(read.len() > 120, "{}", read.len());
    for (text, factor, si) in read {
        let unit = parse_unit(text).unwrap_or_else(|error| panic!("{text}: {error}"));
        assert!((unit.factor / factor - 1.0).abs() < 4.0 * f64::EPSILON, "{text}: {} and not {factor}", unit.factor);
        assert_eq!(unit.dimension.to_string(), si, "{text}");
        assert_eq!(parse_unit(&unit.text).as_ref(), Ok(&unit), "{text}");
    }
    let fahrenheit = parse_unit("degF").unwrap();
    assert!((fahrenheit.to_si(32.0) - 273.15).abs() < 1e-12 && (fahrenheit.to_si(212.0) - 373.15).abs() < 1e-12);
}

/// Text and what is said: each unit that may be meant, with its quantity.
#[test]
fn spellings_with_several_meanings_are_asked_about() {
    let asked = [
        (
            "hp",
            "; did you mean `hp_imp` (mechanical horsepower, 745.69987 W) or `PS` (metric horsepower, 735.49875 W)?",
        ),
        ("CV", "; did you mean `PS` (metric horsepower, 735.49875 W)?"),
        ("S", "; did you mean `s` (second, a time) or `A/V` (siemens, a conductance)?"),
        ("gr", "; did you mean `g` (gram, a mass; a grain is 0.0648 of it)?"),
        ("KN", "; did you mean `kN` (kilonewton, a force) or `kn` (knot, a speed)?"),
        ("U", "; did you mean `rev` (a turn, an angle)?"),
        (
            "ton",
            "; did you mean `t` (tonne, 1000 kg) or `ton_short` (short ton (US), 907.18474 kg) or `ton_long` (long ton (UK), 1016.0469 kg) \
             or `tf` (tonne-force, 9806.65 N) or `kip` (1000 lbf; a short ton-force is 2 kip)?",
        ),
        ("gpm", "; did you mean `gal_US/min` (3.785411784 l/min) or `gal_imp/min` (4.54609 l/min)?"),
        ("mile", "; did you mean `mi` (statute mile, 1609.344 m) or `nmi` (nautical mile, 1852 m)?"),
        ("ftlb", "; did you mean `ft lbf` (a moment, 1.3558179 N m) or `ft lb` (a mass times a length)?"),
        ("fps", "; did you mean `ft/s` (feet a second, a speed) or `Hz` (frames a second, a frequency)?"),
        ("C", "; did you mean `degC` (degree Celsius, a temperature) or `A s` (coulomb, a charge)?"),
        ("G", "; did you mean `g0` (9.80665 m/s^2, an acceleration) or `g` (gram, a mass)?"),
        ("psu", "; did you mean `g/kg` (parts in a thousand, a salinity)?"),
        ("bits", "; did you mean `count` (a number of counts, without size)?"),
        ("dB", " is the logarithm of a ratio; convert the numbers to a linear unit before they are read here"),
    ];
    for (text, said) in asked {
        assert_eq!(parse_unit(text).unwrap_err().to_string(), format!("unknown unit `{text}`{said}"));
    }
}

/// A name of three letters is near to every other one, so that nothing is proposed without the quantity.
#[test]
fn nothing_is_proposed_by_letters_alone() {
    for text in ["ox", "mu", "kq", "xyz", "Fz", "lbx", "Nn", "abc", "barn", "Knx"] {
        assert_eq!(parse_unit(text).unwrap_err().to_string(), format!("unknown unit `{text}`"));
    }
    let said = |text, dimension| parse_unit_for(text, dimension).unwrap_err().to_string();
    assert_eq!(said("kntos", Dimension::SPEED), "unknown unit `kntos`; did you mean `knots`?");
    assert_eq!(said("degc", Dimension::TEMPERATURE), "unknown unit `degc`; did you mean `degC`?");
    assert_eq!(said("S", Dimension::TIME), "unknown unit `S`; did you mean `s` (second, a time)?");
    assert_eq!(said("S", Dimension::FORCE), "unknown unit `S`; write for example `N`");
    let day = "unknown unit `day`; did you mean `h` (hour, a time: a day is 24 of it)?";
    assert_eq!(said("day", Dimension::TIME), day);
    assert_eq!(said("ox", Dimension::MASS), "unknown unit `ox`; write for example `kg`");
}

#[test]
fn what_is_no_unit_is_refused() {
    let refused = [
        ("n/a", "`n/a` is not a unit; write `1` where the numbers are pure, and else their unit"),
        (
            "N/A",
            "`N/A` is not a unit; write `1` where the numbers are pure, `N A^-1` for newtons per ampere, and else their unit",
        ),
        ("m0", "`m0` is not a unit: `0` is not a whole exponent"),
        ("m/s-1", "`m/s-1` can be read in two ways; divide, as in `m/s`, or write a negative exponent, as in `m s^-1`"),
        ("m/s⁻¹", "`m/s⁻¹` can be read in two ways; divide, as in `m/s`, or write a negative exponent, as in `m s^-1`"),
        ("N/m-s", "`N/m-s` can be read in two ways; put the divisor in parentheses, as in `kg/(m s)`"),
        ("N - m", "`N - m` is not a unit: unexpected `-`"),
        ("m s -1", "`m s -1` is not a unit: unexpected `-`"),
        ("N.", "`N.` is not a unit: unexpected `.`"),
        ("degF/s", "`degF/s`: degF has an offset and can only stand alone; write K for differences"),
    ];
    for (text, said) in refused {
        assert_eq!(parse_unit(text).unwrap_err().to_string(), said);
    }
    for text in ["[]", "[", "]", "0-10", "1-5", "m.5", "-m", "m--s", "[[m]", "m/s-", "°-", "+"] {
        assert!(parse_unit(text).is_err(), "{text}");
    }
}

#[test]
fn a_mass_where_a_force_belongs_is_its_weight_and_said_so() {
    let weights = [
        ("kg", Dimension::FORCE, "kgf", 9.80665),
        ("g", Dimension::FORCE, "gf", 9.80665e-3),
        ("lbs", Dimension::FORCE, "lbf", POUND_N),
        ("oz", Dimension::FORCE, "ozf", POUND_N / 16.0),
        ("te", Dimension::FORCE, "tf", 9806.65),
        ("kg.cm", Dimension::MOMENT, "kgf.cm", 0.0980665),
        ("ft-lb", Dimension::MOMENT, "ft-lbf", 0.3048 * POUND_N),
        ("lb.in", Dimension::MOMENT, "lbf.in", 0.0254 * POUND_N),
        ("kg/cm²", Dimension::PRESSURE, "kgf/cm²", 98066.5),
    ];
    for (text, dimension, as_read, factor) in weights {
        let (unit, note) = parse_unit_for(text, dimension).unwrap();
        assert_eq!((unit.text.as_str(), unit.dimension), (as_read, dimension));
        assert!((unit.factor / factor - 1.0).abs() < 1e-14, "{text}: {}", unit.factor);
        assert_eq!(note.unwrap(), format!("`{text}` is read as `{as_read}`, under standard gravity, 9.80665 m/s^2"));
    }
    assert_eq!(parse_unit_for("N", Dimension::FORCE).unwrap().1, None);
    let note = parse_unit_for("psig", Dimension::PRESSURE).unwrap().1;
    assert_eq!(note.unwrap(), "`psig` is read as a difference of pressure: to the surroundings, or between two places");
    let said = |text, dimension| parse_unit_for(text, dimension).unwrap_err().to_string();
    assert_eq!(
        said("kn", Dimension::FORCE),
        "`kn` is a speed (m/s), and a force (N) is expected; write `kN` (kilonewton), or another name where it is a speed in knots"
    );
    assert_eq!(
        said("g", Dimension::ACCELERATION),
        "`g` is a mass (kg), and an acceleration (m/s^2) is expected; write `g0` (9.80665 m/s^2), or another name where it is a mass in grams"
    );
    assert_eq!(said("m", Dimension::FORCE), "`m` is a length (m); expected a force (N)");
}

/// 1/min beside rpm is 6.28 times too small.
#[test]
fn a_rate_of_turning_says_what_it_counts() {
    let asked = |name, text| question(name, &parse_unit(text).unwrap());
    let two = |text: &str, turns: &str, radians: &str| {
        Some(format!(
            "`{text}` is ambiguous for a rate of rotation; write `{turns}` where turns are counted, or `{radians}`"
        ))
    };
    for name in
        ["w_x", "w_z", "p", "q", "r", "n", "rpm", "Drehzahl", "rotation", "yaw rate", "omega", "std_w_z", "Gierrate"]
    {
        for text in ["1/min", "min-1", "min⁻¹", "min^-1"] {
            assert_eq!(asked(name, text), two(text, "rpm", "rad/min"), "{name}");
        }
        for text in ["1/s", "Hz", "s-1"] {
            assert_eq!(asked(name, text), two(text, "rev/s", "rad/s"), "{name}");
        }
        for text in ["rpm", "rad/s", "deg/s", "°/s", "r/min", "U/min", "rps", "dps", "rad/min"] {
            assert_eq!(asked(name, text), None, "{name} {text}");
        }
    }
    assert_eq!(asked("frequency", "Hz"), None);
    assert_eq!(
        asked("time", "Ms").as_deref(),
        Some("`Ms` has the prefix mega (10^6); write `ms` if milli (10^-3) is meant")
    );
    assert_eq!(asked("shear", "1/s"), None);
    let without_size = "`cts` is not a unit of angle; convert the numbers and write `deg` or `rad`";
    assert_eq!(asked("angle", "cts").as_deref(), Some(without_size));
    assert!(asked("angle", "1").is_some() && asked("angle", "-").is_some());
    assert_eq!((asked("angle", "deg"), asked("angle", "rad"), asked("n_links", "-")), (None, None, None));
}

#[test]
fn a_slope_is_no_load_and_a_mass_no_force() {
    for text in ["N/deg", "N/°", "N/count", "N/%", "% N", "N/(mV/V)", "N/rev", "N rad"] {
        assert!(foreign_part(text, Dimension::FORCE).is_some(), "{text}");
    }
    for (text, expected) in [
        ("N", Dimension::FORCE),
        ("kg m/s^2", Dimension::FORCE),
        ("kgf", Dimension::FORCE),
        ("N m", Dimension::MOMENT),
        ("m/s", Dimension::SPEED),
        ("deg/s", Dimension::ANGULAR_SPEED),
        ("%", Dimension::ONE),
    ] {
        assert_eq!(foreign_part(text, expected), None, "{text}");
    }
    let asked = |name, text| question(name, &parse_unit(text).unwrap());
    for (name, text, part) in [
        ("acc_x", "g", "`g0`"),
        ("imu.acc.z", "mg", "`g0`"),
        ("Kraft", "kg", "`kgf`"),
        ("thrust", "g", "`gf`"),
        ("speed", "nm/h", "`kn`"),
    ] {
        assert!(asked(name, text).is_some_and(|said| said.contains(part)), "{name} [{text}]");
    }
    assert_eq!((asked("mass", "kg"), asked("payload", "g"), asked("fx", "kg")), (None, None, None));
}

/// Units of results: volts or amperes as in the columns, and mechanical ones as they were.
#[test]
fn a_remark_in_parentheses_is_no_factor() {
    for text in ["bar(g)", "psi (g)", "kPa(a)", "l(h)", "mm (W)"] {
        let said = parse_unit(text).unwrap_err().to_string();
        assert!(said.contains("parentheses follow on a unit"), "{said}");
    }
    assert!(parse_unit("kg*(m/s)").is_ok() && parse_unit("kg/(m s)").is_ok());
}

#[test]
fn units_of_results_are_reduced() {
    let of = |text: &str| parse_unit(text).unwrap().dimension;
    let shown = [
        ("N/V^2", "N/V^2"),
        ("N/V", "N/V"),
        ("N m/A", "N m/A"),
        ("V s", "N m/A"),
        ("V/A", "ohm"),
        ("V s/A", "N m/A^2"),
        ("N A^-1", "N A^-1"),
        ("kg m s^-2 A^-1", "N A^-1"),
        ("A s", "A s"),
        ("A/V", "W/V^2"),
        ("A", "A"),
        ("1/V", "1/V"),
        ("kg/m", "kg/m"),
        ("N s^2/m^2", "kg/m"),
        ("kg m^2", "kg m^2"),
        ("N/m", "kg/s^2"),
        ("K/s", "K/s"),
    ];
    for (text, written) in shown {
        assert_eq!(of(text).to_string(), written, "{text}");
        assert_eq!(of(written), of(text));
    }
    let [force, speed, voltage, current] = ["N", "m/s", "V", "A"].map(of);
    assert_eq!(of("N m/A").written_beside(&[force, voltage]), "V s");
    assert_eq!(of("V s").written_beside(&[force, current]), "N m/A");
    assert_eq!(of("N/V^2").written_beside(&[force, voltage]), "N/V^2");
    assert_eq!(of("N/V^2").written_beside(&[force, voltage, current]), "N/V^2");
    assert_eq!(of("kg/m").written_beside(&[speed, voltage]), "kg/m");
}
