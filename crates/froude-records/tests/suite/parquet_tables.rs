//! Parquet tables: the same as CSV, and what is stated about a file that is not whole.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use froude_records::csv_table::parse_csv;
use froude_records::sidecar::parse_sidecar;
use froude_records::table::{ColumnData, Table};
use froude_records::table_file::read_table;
use froude_records::units::Dimension;
use parquet::data_type::{ByteArrayType, FloatType, Int32Type, Int64Type};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::parser::parse_message_type;
use parquet::schema::types::Type;

const TEXT: &str = "configuration,speed [mm/s],angle [deg],temperature [degC]\nH1LT,100,3,14.9\nH2LT,250.5,-39,15\n";

fn sample() -> Table {
    parse_csv(Path::new("tank.csv"), TEXT, None).unwrap()
}

fn written(folder: &Path) -> PathBuf {
    let path = folder.join("tank.parquet");
    froude_records::table_file::prepare_table(&sample(), &path).unwrap().take_place().unwrap();
    path
}

#[test]
fn a_parquet_table_reads_as_the_csv_that_it_was_made_from() {
    let folder = tempfile::tempdir().unwrap();
    let read = read_table(&written(folder.path()), None).unwrap();
    assert_eq!(read.columns, sample().columns);
    assert_eq!(read.place_of_row(1).to_string(), format!("{}, row 2", read.path.display()));
}

#[test]
fn a_truncated_file_is_called_truncated_wherever_it_is_cut() {
    let folder = tempfile::tempdir().unwrap();
    let whole = std::fs::read(written(folder.path())).unwrap();
    let cut = folder.path().join("cut.parquet");
    for length in [0, 1, 7, 8, 9, whole.len() / 2, whole.len() - 9, whole.len() - 1] {
        std::fs::write(&cut, &whole[..length]).unwrap();
        let message = read_table(&cut, None).unwrap_err().to_string();
        assert!(
            message.starts_with(&format!("{}: not a whole Parquet file (", cut.display()))
                && message.ends_with("); it is truncated or damaged: copy or export it again"),
            "{length}: {message}"
        );
    }
    std::fs::write(&cut, &whole[..whole.len() - 1]).unwrap();
    assert_eq!(
        read_table(&cut, None).unwrap_err().to_string(),
        format!(
            "{}: not a whole Parquet file (Invalid Parquet file. Corrupt footer); it is truncated or damaged: copy or export it again",
            cut.display()
        )
    );
}

/// Every byte changed, one at a time: an error or a table, never a panic and never a hang.
#[test]
fn a_damaged_file_is_refused_or_read_but_never_a_panic() {
    let folder = tempfile::tempdir().unwrap();
    let whole = std::fs::read(written(folder.path())).unwrap();
    let bad = folder.path().join("bad.parquet");
    let quiet = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let mut refused = 0;
    for at in 0..whole.len() {
        let mut bytes = whole.clone();
        bytes[at] ^= 0x55;
        std::fs::write(&bad, &bytes).unwrap();
        refused += usize::from(read_table(&bad, None).is_err());
    }
    std::panic::set_hook(quiet);
    assert!(refused > 0);
}

#[test]
fn headers_and_dimensions_are_held_as_in_csv() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tank.parquet");
    let mut table = sample();
    table.columns[1].name = "f_x".to_owned();
    froude_records::table_file::prepare_table(&table, &path).unwrap().take_place().unwrap();
    assert_eq!(
        read_table(&path, None).unwrap_err().to_string(),
        format!("{}: column `f_x [mm/s]`: wrong unit: expected a force (N), found a speed (m/s)", path.display())
    );
    let ColumnData::Number { si, .. } = &mut table.columns[1].data else { panic!() };
    si[1] = f64::NAN;
    table.columns[1].name = "speed".to_owned();
    froude_records::table_file::prepare_table(&table, &path).unwrap().take_place().unwrap();
    assert_eq!(
        read_table(&path, None).unwrap_err().to_string(),
        format!(
            "{}, row 2: column `speed [mm/s]`: `NaN` is not a finite number; correct it or delete the row",
            path.display()
        )
    );
}

#[test]
fn a_sidecar_maps_parquet_columns_too() {
    let folder = tempfile::tempdir().unwrap();
    let path = written(folder.path());
    let sidecar = folder.path().join("other.toml");
    let text = "schema = 1\n[columns]\n\"speed [mm/s]\" = { name = \"v_x\", sign = -1 }\nconfiguration = { name = \"configuration\" }\n";
    std::fs::write(&sidecar, text).unwrap();
    assert!(parse_sidecar(&sidecar, text).is_ok());
    let table = read_table(&path, Some(&sidecar)).unwrap();
    assert_eq!(table.number("v_x", Dimension::SPEED).unwrap(), [-0.1, -0.2505]);
    assert_eq!(table.columns.len(), 2);
}

#[test]
fn no_rows_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tank.parquet");
    let mut table = sample();
    table.n_rows = 0;
    for column in &mut table.columns {
        match &mut column.data {
            ColumnData::Number { si, .. } => si.clear(),
            ColumnData::Text(cells) => *cells = cells.subset(&[]),
        }
    }
    froude_records::table_file::prepare_table(&table, &path).unwrap().take_place().unwrap();
    assert_eq!(
        read_table(&path, None).unwrap_err().to_string(),
        format!("{}: the table has no rows; at least one observation is needed", path.display())
    );
}

/// Found by fuzzing: a dictionary page of a few bytes that claims thousands of millions of entries.
#[test]
fn a_page_that_claims_more_than_it_holds_takes_no_memory() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/damaged/dictionary_of_billions.parquet");
    let message = read_table(&path, None).unwrap_err().to_string();
    assert!(message.contains("not a whole Parquet file ("), "{message}");
}

/// A file as other programs write it: narrow and unsigned integers, floats, nulls, two row groups.
fn foreign(path: &Path, with_null: bool) {
    let schema = Arc::new(
        parse_message_type(
            "message schema {
                required int32 run (INTEGER(8, true));
                optional int64 n_links;
                required float speed;
                required int32 count (INTEGER(32, false));
                optional binary note (STRING);
            }",
        )
        .unwrap(),
    );
    // The text form of a schema has no spaces and brackets in its names.
    let with_unit = |name: &str| match name {
        "n_links" | "count" => format!("{name} [1]"),
        "speed" => "speed [m/s]".to_owned(),
        other => other.to_owned(),
    };
    let fields = schema.get_fields().iter().map(|f| {
        let info = f.get_basic_info();
        Arc::new(
            Type::primitive_type_builder(&with_unit(f.name()), f.get_physical_type())
                .with_repetition(info.repetition())
                .with_logical_type(info.logical_type_ref().cloned())
                .build()
                .unwrap(),
        )
    });
    let schema = Arc::new(Type::group_type_builder("schema").with_fields(fields.collect()).build().unwrap());
    let file = std::fs::File::create(path).unwrap();
    let mut writer = SerializedFileWriter::new(file, schema, Arc::default()).unwrap();
    for first in [1, 3] {
        let mut group = writer.next_row_group().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<Int32Type>().write_batch(&[first, first + 1], None, None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        let (values, levels): (&[i64], &[i16]) = if with_null { (&[3], &[1, 0]) } else { (&[3, 4], &[1, 1]) };
        column.typed::<Int64Type>().write_batch(values, Some(levels), None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<FloatType>().write_batch(&[0.5, 0.25], None, None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<Int32Type>().write_batch(&[-1, 7], None, None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<ByteArrayType>().write_batch(&["wavy".into()], Some(&[0, 1]), None).unwrap();
        column.close().unwrap();
        group.close().unwrap();
    }
    writer.close().unwrap();
}

#[test]
fn files_of_other_programs_are_read_in_all_their_types() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("other.parquet");
    foreign(&path, false);
    let table = read_table(&path, None).unwrap();
    assert_eq!(table.n_rows, 4);
    assert_eq!(table.text("run").unwrap(), ["1", "2", "3", "4"]);
    assert_eq!(table.number("n_links", Dimension::ONE).unwrap(), [3.0, 4.0, 3.0, 4.0]);
    assert_eq!(table.number("speed", Dimension::SPEED).unwrap(), [0.5, 0.25, 0.5, 0.25]);
    assert_eq!(table.number("count", Dimension::ONE).unwrap(), [4294967295.0, 7.0, 4294967295.0, 7.0]);
    assert_eq!(table.text("note").unwrap(), ["", "wavy", "", "wavy"]);
    foreign(&path, true);
    assert_eq!(
        read_table(&path, None).unwrap_err().to_string(),
        format!("{}, row 2: column `n_links [1]`: the cell is empty; fill it in or delete the row", path.display())
    );
}
