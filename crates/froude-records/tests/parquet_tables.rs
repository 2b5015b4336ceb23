//! Parquet tables: the same as CSV, and what is said of a file that is not whole.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::{Path, PathBuf};

use froude_records::csv_table::parse_csv;
use froude_records::parquet_table::write_parquet;
use froude_records::sidecar::parse_sidecar;
use froude_records::table::{ColumnData, Table, read_table};
use froude_records::units::Dimension;

const TEXT: &str = "configuration,speed [mm/s],angle [deg],temperature [degC]\nH1LT,100,3,14.9\nH2LT,250.5,-39,15\n";

fn sample() -> Table {
    parse_csv(Path::new("tank.csv"), TEXT, None).unwrap()
}

fn written(folder: &Path) -> PathBuf {
    let path = folder.join("tank.parquet");
    write_parquet(&sample(), &path).unwrap();
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
    write_parquet(&table, &path).unwrap();
    assert_eq!(
        read_table(&path, None).unwrap_err().to_string(),
        format!("{}: column `f_x [mm/s]`: wrong unit: expected a force (N), found a speed (m/s)", path.display())
    );
    let ColumnData::Number { si, .. } = &mut table.columns[1].data else { panic!() };
    si[1] = f64::NAN;
    table.columns[1].name = "speed".to_owned();
    write_parquet(&table, &path).unwrap();
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
    let text = "schema = 1\n[columns]\n\"speed [mm/s]\" = { name = \"v_x\", unit = \"m/s\" }\nconfiguration = { name = \"configuration\" }\n";
    std::fs::write(&sidecar, text).unwrap();
    assert!(parse_sidecar(&sidecar, text).is_ok());
    let table = read_table(&path, Some(&sidecar)).unwrap();
    assert_eq!(table.number("v_x", Dimension::SPEED).unwrap(), [100.0, 250.5]);
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
            ColumnData::Text(cells) => cells.clear(),
        }
    }
    write_parquet(&table, &path).unwrap();
    assert_eq!(
        read_table(&path, None).unwrap_err().to_string(),
        format!("{}: the table has no rows; at least one observation is needed", path.display())
    );
}
