//! Every type of number and time in Parquet, as pyarrow, pandas, polars and fastparquet write them (golden/parquet_types.py).

use std::path::{Path, PathBuf};
use std::sync::Arc;

use froude_records::sidecar::parse_sidecar;
use froude_records::table::{ColumnData, Table};
use froude_records::table_file::{read_table, read_table_with_blanks};
use parquet::data_type::Int64Type;
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::Type;

fn golden(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("tests/golden/parquet/{name}.parquet"))
}

fn read(name: &str) -> Table {
    read_table(&golden(name), None).unwrap_or_else(|e| panic!("{name}: {e}"))
}

/// A column's numbers, SI.
fn numbers<'a>(table: &'a Table, name: &str) -> &'a [f64] {
    let column = table.columns.iter().find(|column| column.name == name).unwrap();
    let ColumnData::Number { si, .. } = &column.data else { panic!("{name} is text") };
    si
}

fn texts(table: &Table, name: &str) -> Vec<String> {
    let column = table.columns.iter().find(|column| column.name == name).unwrap();
    let ColumnData::Text(cells) = &column.data else { panic!("{name} is numbers") };
    cells.iter().map(ToString::to_string).collect()
}

/// Without the folder.
fn refusal(name: &str) -> String {
    let path = golden(name);
    let message = read_table(&path, None).unwrap_err().to_string();
    message.replace(&path.display().to_string(), &format!("{name}.parquet"))
}

#[test]
fn numbers_of_every_type_are_read() {
    // Its largest numbers were measured.
    let folder = tempfile::tempdir().unwrap();
    let sidecar = folder.path().join("numbers.toml");
    std::fs::write(&sidecar, "schema = 1\n[file]\nnot_measured = []\n").unwrap();
    let table = read_table(&golden("numbers"), Some(&sidecar)).unwrap();
    for (name, expected) in [
        ("half", [0.5, -2.0, 65504.0]),
        ("float", [0.5, -2.0, 3.0]),
        ("int8", [-128.0, 0.0, 127.0]),
        ("uint8", [0.0, 128.0, 255.0]),
        ("uint16", [0.0, 1.0, 65535.0]),
        ("uint32", [0.0, 1.0, 4_294_967_295.0]),
        ("int64", [-9_007_199_254_740_992.0, 0.0, 9_007_199_254_740_992.0]),
        ("uint64", [0.0, 1.0, 9_223_372_036_854_775_808.0]),
        ("decimal", [-1.23, 0.07, 99.99]),
        ("long_decimal", [-0.1, 0.3, 12_345_678_901_234_567_890.5]),
        ("wide_decimal", [-0.1, 0.3, 7.0]),
        ("is_wet", [1.0, 0.0, 1.0]),
    ] {
        assert_eq!(numbers(&table, name), expected, "{name}");
    }
    assert_eq!(texts(&table, "category"), ["a", "b", "a"]);
    assert_eq!(texts(&table, "day"), ["2026-03-31", "1969-12-31", "2000-02-29"]);
    assert_eq!(numbers(&read("decimals_as_integers"), "decimal"), [-1.23, 0.07, 99.99]);
}

/// Stamps of 23:59:59.5 and a quarter of a second and 1.000123 s later.
#[test]
fn timestamps_count_from_the_first_row_in_the_unit_of_their_type() {
    for unit in ["ms", "us", "ns"] {
        let last = if unit == "ms" { 1.0 } else { 1.000_123 };
        assert_eq!(numbers(&read(&format!("timestamp_{unit}")), "time"), [0.0, 0.25, last], "{unit}");
        let zoned = read(&format!("zoned_{unit}"));
        for (found, expected) in numbers(&zoned, "time").iter().zip([0.0, 0.25, last]) {
            assert!((found - expected).abs() < 1e-12, "{unit}: {found}");
        }
    }
    assert_eq!(numbers(&read("int96"), "time"), [0.0, 0.25, 1.000_123]);
    assert_eq!(numbers(&read("two_groups"), "time"), [0.0, 0.25, 1.000_123]);
    assert_eq!(numbers(&read("fastparquet_stamps"), "time"), [0.0, 0.04]);
}

#[test]
fn two_columns_of_timestamps_count_from_one_moment() {
    let table = read("two_clocks");
    assert_eq!(numbers(&table, "a"), [0.0, 0.0]);
    assert_eq!(numbers(&table, "b"), [0.25, 1.000_123]);
}

#[test]
fn durations_and_times_of_day_have_the_unit_of_their_type() {
    for unit in ["s", "ms", "us", "ns"] {
        let expected = if unit == "s" { [1.0, 1.0, -2.0] } else { [1.0, 1.5, -2.0] };
        assert_eq!(numbers(&read(&format!("duration_{unit}")), "t"), expected, "{unit}");
    }
    for unit in ["ms", "us", "ns"] {
        assert_eq!(numbers(&read(&format!("clock_{unit}")), "clock"), [1.25, 43_200.0, 86_399.999], "{unit}");
    }
    assert_eq!(numbers(&read("pandas_timedelta"), "time"), [0.0, 0.01, 0.025]);
    assert_eq!(numbers(&read("fastparquet_timedelta"), "time"), [0.0, 0.01, 0.025]);
    let polars = read("polars");
    assert_eq!(numbers(&polars, "time"), [1.5, 1.75, 2.500_123]);
    assert_eq!(numbers(&polars, "clock"), [1.25, 43_200.0, 86_399.999]);
    assert_eq!(numbers(&polars, "n"), [1.0, 2.0, 3.0]);
}

#[test]
fn a_stated_unit_that_is_that_of_the_type_is_taken() {
    for (found, expected) in numbers(&read("stated"), "time").iter().zip([1.5, 1.75, 2.500_123]) {
        assert!((found - expected).abs() < 1e-12, "{found}");
    }
}

#[test]
fn types_that_are_not_what_is_stated_are_refused_with_both() {
    for (name, expected) in [
        (
            "contradiction",
            "contradiction.parquet: column `time [ms]` is of the type duration[us], and the unit ms is stated; head the column \
             `time [us]`, or `time` alone",
        ),
        (
            "stamp_for_force",
            "stamp_for_force.parquet: column `f_x [N]` is of the type timestamp[us], and the unit N is stated; write it as numbers in that \
             unit, or as text",
        ),
        (
            "dates_for_time",
            "dates_for_time.parquet: column `time [s]` is of the type date, which has whole days, and the unit s is stated; write a \
             column of timestamps or of numbers",
        ),
        (
            "list",
            "list.parquet: column `f_x [N]` is of the type list; expected numbers, truth values, times or text: write it as such, a \
             column for each number, or name only the other columns in a sidecar",
        ),
        (
            "struct",
            "struct.parquet: column `wrench` is of the type struct; expected numbers, truth values, times or text: write it as such, \
             a column for each number, or name only the other columns in a sidecar",
        ),
        (
            "map",
            "map.parquet: column `m` is of the type map; expected numbers, truth values, times or text: write it as such, a column \
             for each number, or name only the other columns in a sidecar",
        ),
        (
            "bytes",
            "bytes.parquet: column `id` is of the type FIXED_LEN_BYTE_ARRAY; expected numbers, truth values, times or text: write it \
             as such, a column for each number, or name only the other columns in a sidecar",
        ),
        (
            "gzip",
            "gzip.parquet: column `x [m]` is packed with GZIP; write the table with snappy or zstd (pandas: to_parquet(…, \
             compression=\"zstd\"))",
        ),
        (
            "null_time",
            "null_time.parquet, row 2: column `time [s]`: the cell is empty; fill it in, delete the row, or do without the column: \
             name only the other columns in a sidecar null_time.toml",
        ),
    ] {
        assert_eq!(refusal(name), expected);
    }
}

#[test]
fn a_sidecar_passes_over_what_is_not_read_and_states_the_unit_of_times() {
    let of = |name: &str, columns: &str| {
        let text = format!("schema = 1\n[columns]\n{columns}\n");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("given.toml");
        std::fs::write(&path, &text).unwrap();
        parse_sidecar(&path, &text).unwrap();
        read_table(&golden(name), Some(&path)).map_err(|e| e.to_string())
    };
    let table = of("struct", "\"speed [m/s]\" = { name = \"speed\", unit = \"m/s\" }").unwrap();
    assert_eq!(numbers(&table, "speed"), [1.5], "behind two leaves of a structure");
    let table = of("duration_us", "t = { name = \"time\", unit = \"us\" }").unwrap();
    assert_eq!(numbers(&table, "time"), [1.0, 1.5, -2.0]);
    let message = of("duration_us", "t = { name = \"time\", unit = \"s\" }").unwrap_err();
    assert!(
        message.contains("column `t` is of the type duration[us], and the unit s is stated; write unit = \"us\" in "),
        "{message}"
    );
}

#[test]
fn nulls_of_loads_and_motions_are_blank_cells() {
    let table = read_table_with_blanks(&golden("nulls"), None).unwrap();
    let blank = |name: &str, row| (name.to_owned(), row);
    assert_eq!(table.blank, [blank("f_x", 0), blank("v_x", 1), blank("f_y", 2)]);
    assert_eq!(numbers(&table, "f_y"), [1.0, 2.0, 0.0]);
    assert!(refusal("nulls").starts_with("nulls.parquet, row 2: column `v_x [m/s]`: the cell is empty"));
    assert!(read_table_with_blanks(&golden("null_time"), None).is_err());
}

#[test]
fn the_index_of_pandas_is_left_out_and_named() {
    let table = read("pandas_index");
    assert_eq!(table.left_out, ["__index_level_0__"]);
    assert_eq!(numbers(&table, "time"), [0.0, 0.025, 0.01]);
}

/// Writers before version 2.4 of the format had only these annotations.
#[test]
fn the_older_annotations_mean_the_same() {
    use parquet::basic::{ConvertedType as C, Repetition, Type as Physical};
    let folder = tempfile::tempdir().unwrap();
    for (name, converted, cells, expected) in [
        ("time", C::TIMESTAMP_MICROS, [5_000_000, 5_250_000], [0.0, 0.25]),
        ("time", C::TIMESTAMP_MILLIS, [5_000, 5_250], [0.0, 0.25]),
        ("time", C::TIME_MICROS, [5_000_000, 5_250_000], [5.0, 5.25]),
        ("n [1]", C::UINT_64, [-1, 7], [18_446_744_073_709_551_615.0, 7.0]),
        ("n [1]", C::DECIMAL, [-123, 7], [-1.23, 0.07]),
    ] {
        let mut field = Type::primitive_type_builder(name, Physical::INT64)
            .with_repetition(Repetition::REQUIRED)
            .with_converted_type(converted);
        if converted == C::DECIMAL {
            field = field.with_precision(10).with_scale(2);
        }
        let schema = Type::group_type_builder("schema").with_fields(vec![Arc::new(field.build().unwrap())]);
        let path = folder.path().join("old.parquet");
        let file = std::fs::File::create(&path).unwrap();
        let mut writer = SerializedFileWriter::new(file, Arc::new(schema.build().unwrap()), Arc::default()).unwrap();
        let mut group = writer.next_row_group().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<Int64Type>().write_batch(&cells, None, None).unwrap();
        column.close().unwrap();
        group.close().unwrap();
        writer.close().unwrap();
        let table = read_table(&path, None).unwrap();
        assert_eq!(numbers(&table, name.split(' ').next().unwrap()), expected, "{converted}");
    }
}

/// Arrow has durations and Parquet has none: without Arrow's schema nobody knows what an integer of 64 bits is.
#[test]
fn integers_whose_type_cannot_be_read_are_no_times() {
    use parquet::file::metadata::KeyValue;
    use parquet::file::properties::WriterProperties;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("t.parquet");
    for (header, is_read) in [("time [us]", false), ("n [1]", true)] {
        let field = Type::primitive_type_builder(header, parquet::basic::Type::INT64)
            .with_repetition(parquet::basic::Repetition::REQUIRED)
            .build()
            .unwrap();
        let schema = Type::group_type_builder("schema").with_fields(vec![Arc::new(field)]).build().unwrap();
        let entry = KeyValue::new("ARROW:schema".to_owned(), "/////zAA".to_owned());
        let properties = WriterProperties::builder().set_key_value_metadata(Some(vec![entry])).build();
        let file = std::fs::File::create(&path).unwrap();
        let mut writer = SerializedFileWriter::new(file, Arc::new(schema), Arc::new(properties)).unwrap();
        let mut group = writer.next_row_group().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<Int64Type>().write_batch(&[1, 2], None, None).unwrap();
        column.close().unwrap();
        group.close().unwrap();
        writer.close().unwrap();
        match read_table(&path, None) {
            Ok(table) => assert!(is_read && numbers(&table, "n") == [1.0, 2.0]),
            Err(error) => assert_eq!(
                (is_read, error.to_string()),
                (
                    false,
                    format!(
                        "{}: column `time [us]` holds integers that may be durations: the unit of such a type stands in the file's \
                         ARROW:schema, which cannot be read; write the column as double",
                        path.display()
                    )
                )
            ),
        }
    }
}

/// Every byte changed, one at a time: an error or a table, never a panic that gets out.
#[test]
fn damaged_files_of_other_programs_are_refused_or_read() {
    let folder = tempfile::tempdir().unwrap();
    let bad = folder.path().join("bad.parquet");
    let quiet = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    for name in ["numbers", "duration_us", "int96", "polars"] {
        let whole = std::fs::read(golden(name)).unwrap();
        for at in 0..whole.len() {
            let mut bytes = whole.clone();
            bytes[at] ^= 0x55;
            std::fs::write(&bad, &bytes).unwrap();
            drop(read_table(&bad, None));
        }
    }
    std::panic::set_hook(quiet);
}
