//! Workbooks: any bytes give sheets whose rows have one length, or an error in words. A panic of the readers inside is an error, too.
#![no_main]

use froude_foreign::sheet::Workbook;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut book = match Workbook::open(bytes) {
        Ok(book) => book,
        Err(error) => return assert!(error.0.len() > 20, "{error}"),
    };
    for name in book.sheets().to_vec() {
        if let Ok(sheet) = book.sheet(&name.name, None) {
            let width = sheet.rows.first().map_or(0, Vec::len);
            assert!(sheet.rows.iter().all(|row| row.len() == width));
            assert!(sheet.first_row > 0 && sheet.first_column > 0);
        }
    }
});
