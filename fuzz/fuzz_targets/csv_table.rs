//! CSV: no panic, and what is accepted is a table: full columns of finite numbers.
#![no_main]

use std::path::Path;

use froude_records::csv_table::parse_csv;
use froude_records::table::ColumnData;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Ok(table) = parse_csv(Path::new("tank.csv"), text, None) {
        assert!(table.n_rows > 0);
        assert_eq!(table.line_of_row.len(), table.n_rows);
        for column in &table.columns {
            match &column.data {
                ColumnData::Number { si, .. } => {
                    assert_eq!(si.len(), table.n_rows);
                    assert!(si.iter().all(|x| x.is_finite()));
                }
                ColumnData::Text(cells) => assert_eq!(cells.len(), table.n_rows),
            }
        }
    }
});
