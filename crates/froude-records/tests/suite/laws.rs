//! What holds for any input: no parser panics, and what is written reads back the same.

use std::path::Path;

use froude_records::campaign_file::parse_campaign;
use froude_records::csv_table::parse_csv;
use froude_records::json::parse_estimates;
use froude_records::keep::parse_keep;
use froude_records::scale::Scale;
use froude_records::sidecar::parse_sidecar;
use froude_records::table::{Column, ColumnData, Table};
use froude_records::table_file::read_table;
use froude_records::units::{Dimension, parse_quantity, parse_unit};
use proptest::prelude::*;

const SYMBOLS: [&str; 24] = [
    "m", "mm", "km", "ft", "kn", "s", "ms", "min", "kg", "g", "t", "N", "kN", "Pa", "deg", "rad", "rpm", "K", "Hz",
    "A", "V", "W", "J", "L",
];

/// A unit in the written form: products, powers and one divisor.
fn any_unit() -> impl Strategy<Value = String> {
    let factor = (proptest::sample::select(&SYMBOLS[..]), -3_i8..=3).prop_map(|(symbol, power)| match power {
        0 | 1 => symbol.to_owned(),
        power => format!("{symbol}^{power}"),
    });
    let product = proptest::collection::vec(factor, 1..4).prop_flat_map(|f| {
        (Just(f), proptest::sample::select(&[" ", "*", "·"][..])).prop_map(|(f, join)| f.join(join))
    });
    (product.clone(), proptest::option::of(product)).prop_map(|(above, below)| match below {
        Some(below) => format!("{above}/({below})"),
        None => above,
    })
}

/// Text that looks like the grammar often enough to get past its first checks.
fn any_text() -> impl Strategy<Value = String> {
    let alphabet = prop_oneof![
        any::<char>(),
        proptest::sample::select(
            " \t\n\r\"'[](){}<>=!#,;:.+-*/^%°·²⁻0123456789eEmskgNradegCK_".chars().collect::<Vec<_>>()
        ),
    ];
    proptest::collection::vec(alphabet, 0..60).prop_map(|c| c.into_iter().collect())
}

fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        -1e3..1e3_f64,
        (-1e3..1e3_f64, -12..12_i32).prop_map(|(x, e)| x * 10_f64.powi(e)),
        (-10_000..10_000_i32).prop_map(|n| f64::from(n) / 100.0),
        Just(0.0),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2_000, ..ProptestConfig::default() })]

    #[test]
    fn no_parser_panics_on_text(text in any_text()) {
        let path = Path::new("x.csv");
        let _ = parse_unit(&text);
        let _ = parse_quantity(&text);
        let _ = parse_keep(&text);
        let _ = Scale::parse(&text);
        let _ = parse_csv(path, &text, None);
        let _ = parse_campaign(path, &text);
        let _ = parse_sidecar(path, &text);
        let _ = parse_estimates(path, &text);
    }

    #[test]
    fn a_unit_reads_back_from_its_text(text in any_unit()) {
        let unit = parse_unit(&text).unwrap();
        prop_assert_eq!(&parse_unit(&unit.to_string()).unwrap(), &unit);
    }

    #[test]
    fn a_dimension_reads_back_from_its_si_unit(text in any_unit()) {
        let dimension = parse_unit(&text).unwrap().dimension;
        let si = parse_unit(&dimension.to_string()).unwrap();
        prop_assert_eq!((si.dimension, si.factor, si.offset), (dimension, 1.0, 0.0));
    }

    #[test]
    fn a_quantity_reads_back_from_its_text(value in proptest::num::f64::NORMAL, text in any_unit()) {
        if let Ok(quantity) = parse_quantity(&format!("{value} {text}")) {
            let again = parse_quantity(&quantity.to_string()).unwrap();
            prop_assert_eq!(again.value.to_bits(), value.to_bits());
            prop_assert_eq!(again, quantity);
        }
    }

    /// (a·b)/b = a, whatever the units: the dimensions are a group.
    #[test]
    fn dimensions_multiply_and_divide(a in any_unit(), b in any_unit()) {
        let (a, b) = (parse_unit(&a).unwrap().dimension, parse_unit(&b).unwrap().dimension);
        prop_assert_eq!(a.checked_mul(b).unwrap().checked_div(b), Some(a));
        prop_assert_eq!(a.checked_powi(2), a.checked_mul(a));
    }

    /// The splitting of rows, compared with the `csv` crate.
    #[test]
    fn cells_are_split_as_the_csv_crate_splits_them(
        rows in proptest::collection::vec(proptest::collection::vec("[a-z ,\"\n#é]{0,6}", 3), 1..6)
    ) {
        let mut writer = csv::WriterBuilder::new().quote_style(csv::QuoteStyle::Always).from_writer(Vec::new());
        writer.write_record(["a", "b", "c"]).unwrap();
        for row in &rows {
            writer.write_record(row).unwrap();
        }
        let text = String::from_utf8(writer.into_inner().unwrap()).unwrap();
        let table = parse_csv(Path::new("x.csv"), &text, None).unwrap();
        for (j, column) in table.columns.iter().enumerate() {
            let ColumnData::Text(cells) = &column.data else { panic!() };
            let written: Vec<&String> = rows.iter().map(|row| &row[j]).collect();
            prop_assert_eq!(cells.iter().collect::<Vec<_>>(), written);
        }
    }
}

fn number_column(name: &str, unit: &str, si: Vec<f64>) -> Column {
    let unit = parse_unit(unit).unwrap();
    Column { name: name.to_owned(), data: ColumnData::Number { dimension: unit.dimension, unit, si } }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// What was read from a file is written and read again bit for bit, in any unit; texts too.
    #[test]
    fn a_written_table_reads_back_equal(
        rows in proptest::collection::vec((any_number(), any_number(), any_number(), "[ -~é\n]{0,8}"), 1..20)
    ) {
        let columns = vec![
            number_column("speed", "mm/s", rows.iter().map(|r| parse_unit("mm/s").unwrap().to_si(r.0)).collect()),
            number_column("flap", "deg", rows.iter().map(|r| parse_unit("deg").unwrap().to_si(r.1)).collect()),
            number_column("f_x", "N", rows.iter().map(|r| r.2).collect()),
            Column { name: "note".to_owned(), data: ColumnData::Text(rows.iter().map(|r| format!("x{}", r.3)).collect()) },
        ];
        let folder = tempfile::tempdir().unwrap();
        for name in ["t.csv", "t.parquet"] {
            let path = folder.path().join(name);
            let table = Table::of(path.clone(), columns.clone(), (2..2 + rows.len()).collect());
            froude_records::table_file::prepare_table(&table, &path).unwrap().take_place().unwrap();
            let read = read_table(&path, None).unwrap();
            prop_assert_eq!(&read.columns, &columns);
        }
    }
}

/// NIST SP 811 (2008), appendix B.8, and the definitions of the units: exact factors.
#[test]
fn units_have_the_factors_that_their_definitions_give() {
    let table: [(&str, f64, Dimension); 26] = [
        ("kn", 1852.0 / 3600.0, Dimension::SPEED),
        ("kt", 1852.0 / 3600.0, Dimension::SPEED),
        ("ft", 0.3048, Dimension::LENGTH),
        ("in", 0.0254, Dimension::LENGTH),
        ("lb", 0.45359237, Dimension::MASS),
        ("lbf", 4.4482216152605, Dimension::FORCE),
        ("t", 1000.0, Dimension::MASS),
        ("g", 0.001, Dimension::MASS),
        ("mN", 0.001, Dimension::FORCE),
        ("kN", 1000.0, Dimension::FORCE),
        ("rpm", std::f64::consts::PI / 30.0, Dimension::ANGULAR_SPEED),
        ("rev/min", std::f64::consts::PI / 30.0, Dimension::ANGULAR_SPEED),
        ("deg/s", std::f64::consts::PI / 180.0, Dimension::ANGULAR_SPEED),
        ("Nm", 1.0, Dimension::MOMENT),
        ("N m", 1.0, Dimension::MOMENT),
        ("N·m", 1.0, Dimension::MOMENT),
        ("N*m", 1.0, Dimension::MOMENT),
        ("N mm", 0.001, Dimension::MOMENT),
        ("L", 0.001, Dimension::VOLUME),
        ("l", 0.001, Dimension::VOLUME),
        ("%", 0.01, Dimension::ONE),
        ("g/kg", 0.001, Dimension::ONE),
        ("m s^-2", 1.0, Dimension::ACCELERATION),
        ("m/s²", 1.0, Dimension::ACCELERATION),
        ("N s^2/m^2", 1.0, Dimension::new(-1, 1, 0)),
        ("kg/(m s)", 1.0, Dimension::DYNAMIC_VISCOSITY),
    ];
    for (text, factor, dimension) in table {
        let unit = parse_unit(text).unwrap();
        assert!((unit.factor - factor).abs() <= f64::EPSILON * factor, "{text}: {} {factor}", unit.factor);
        assert_eq!(unit.dimension, dimension, "{text}");
    }
    assert_eq!(parse_quantity("14.9 degC").unwrap().value_si, 288.04999999999995);
}

/// A prefix is read before the symbols that take one and before no other: `Grad` is no milliard of radians.
#[test]
fn angles_hours_minutes_and_degrees_celsius_take_no_prefix() {
    let prefixes = ["n", "u", "µ", "m", "c", "d", "h", "k", "M", "G"];
    let plain = ["rad", "deg", "°", "gon", "rev", "rpm", "min", "h", "degC", "°C"];
    for unit in plain {
        assert!(parse_unit(unit).is_ok(), "{unit}");
        for prefix in prefixes {
            let text = format!("{prefix}{unit}");
            let said = parse_unit(&text).map(|u| u.factor).unwrap_err().to_string();
            assert!(said.starts_with(&format!("unknown unit `{text}`; ")), "{said}");
        }
    }
    for unit in ["m", "s", "g", "N", "Nm", "Pa", "Hz", "A", "V", "W", "J", "l", "L", "K"] {
        let one = parse_unit(unit).unwrap().factor;
        for prefix in ["n", "u", "µ", "m", "k", "M", "G"] {
            let ratio = parse_unit(&format!("{prefix}{unit}")).unwrap().factor / one;
            assert!(
                ratio.log10().rem_euclid(3.0) < 1e-9 || ratio.log10().rem_euclid(3.0) > 3.0 - 1e-9,
                "{prefix}{unit}"
            );
        }
    }
    let gon = parse_unit("gon").unwrap();
    assert!((gon.to_si(400.0) - std::f64::consts::TAU).abs() < 1e-15 * 400.0);
}

/// Found by fuzzing: −128 fits the exponent's type, but its opposite does not.
#[test]
fn the_smallest_exponent_is_the_opposite_of_the_largest() {
    assert_eq!(parse_unit("s^-127").unwrap().dimension.to_string(), "1/s^127");
    assert!(parse_unit("s^-128").is_err() && parse_unit("s^-100 s^-28").is_err() && parse_unit("1/(s^127 s)").is_err());
}

#[test]
fn units_say_what_is_wrong_with_them() {
    let cases = [
        ("", "no unit is given; write for example `m/s`, or `1` for a pure number"),
        ("mps", "unknown unit `mps`; did you mean `m/s`?"),
        ("m/mps", "unknown unit `mps`; did you mean `m/s`?"),
        ("kg/m s", "`kg/m s` can be read in two ways; put the divisor in parentheses, as in `kg/(m s)`"),
        ("degC/s", "`degC/s`: degC has an offset and can only stand alone; write K for differences"),
        ("m^x", "`m^x` is not a unit: `x` is not a whole exponent"),
        ("m^1.5", "`m^1.5` is not a unit: `1.5` is not a whole exponent"),
        ("m/", "`m/` is not a unit: it ends where a unit should follow"),
        ("Grad", "unknown unit `Grad`; did you mean `deg` (360 to the turn) or `gon` (400 to the turn)?"),
        ("grad", "unknown unit `grad`; did you mean `deg` (360 to the turn) or `gon` (400 to the turn)?"),
        ("mrad", "unknown unit `mrad`; `rad` takes no prefix: write `rad`, and the numbers times 0.001"),
        ("mrad/s", "unknown unit `mrad`; `rad` takes no prefix: write `rad`, and the numbers times 0.001"),
        ("kdeg", "unknown unit `kdeg`; `deg` takes no prefix: write `deg`, and the numbers times 1000"),
        ("m°C", "unknown unit `m°C`; `°C` takes no prefix: write `°C`, and the numbers times 0.001"),
        ("(m", "`(m` is not a unit: a parenthesis is not closed"),
        ("m)", "`m)` is not a unit: unexpected `)`"),
        ("2 m", "`2 m` is not a unit: unexpected `2`"),
        ("m^100 m^100", "`m^100 m^100` is out of range: exponents must lie between -127 and 127"),
    ];
    for (text, message) in cases {
        assert_eq!(parse_unit(text).unwrap_err().to_string(), message, "{text}");
    }
    let cases = [
        ("fast", "`fast` does not begin with a number; write a quantity as `0.4 m/s`"),
        ("0.4", "`0.4` has no unit; write for example `0.4 m/s`, or `0.4 1` for a pure number"),
        ("1e999 m", "`1e999 m` is not a finite number, or exceeds the limit of 1e50 (SI)"),
        ("nan m", "`nan m` does not begin with a number; write a quantity as `0.4 m/s`"),
    ];
    for (text, message) in cases {
        assert_eq!(parse_quantity(text).unwrap_err().to_string(), message, "{text}");
    }
    let found = parse_quantity("3 m").unwrap().expect(Dimension::SPEED).unwrap_err().to_string();
    assert_eq!(found, "expected a speed (m/s), found a length (m)");
}
