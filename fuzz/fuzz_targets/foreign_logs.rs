//! Logs of other programs (MCAP, TDMS, ULog): no panic, and every column of a part has one length.
#![no_main]

use froude_foreign::{Cells, Contents, ForeignError, mcap, tdms, ulog};
use libfuzzer_sys::fuzz_target;

fn check(read: Result<Contents, ForeignError>) {
    let Ok(contents) = read else { return };
    assert!(!contents.parts.is_empty());
    for part in &contents.parts {
        let lengths = part.columns.iter().map(|column| match &column.cells {
            Cells::Numbers(numbers) => numbers.len(),
            Cells::Texts(texts) => texts.len(),
        });
        let lengths: Vec<usize> = lengths.collect();
        assert!(lengths.first().is_some_and(|first| *first > 0 && lengths.iter().all(|length| length == first)));
    }
}

fuzz_target!(|bytes: &[u8]| {
    check(mcap::read(&mut &bytes[..], bytes.len() as u64));
    check(tdms::read(bytes));
    check(ulog::read(bytes));
});
