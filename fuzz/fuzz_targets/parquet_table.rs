//! Parquet: no panic reaches the caller, and what is accepted is a full table.
//!
//! The decoder itself may panic on damaged pages; the reader turns that into an error.
//! libFuzzer aborts on any panic, so its hook is taken out once.
#![no_main]

use std::path::Path;

use froude_records::parquet_table::parse_parquet;
use froude_records::table::ColumnData;
use libfuzzer_sys::fuzz_target;

fuzz_target!(init: std::panic::set_hook(Box::new(|_| {})), |bytes: &[u8]| {
    if let Ok(table) = parse_parquet(Path::new("tank.parquet"), bytes::Bytes::copy_from_slice(bytes), None) {
        assert!(table.n_rows > 0);
        for column in &table.columns {
            match &column.data {
                ColumnData::Number { si, .. } => assert_eq!(si.len(), table.n_rows),
                ColumnData::Text(cells) => assert_eq!(cells.len(), table.n_rows),
            }
        }
    }
});
