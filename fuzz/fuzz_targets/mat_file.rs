//! MAT files of level 5: any bytes give tables with columns of one length, or an error in words.
#![no_main]

use froude_foreign::mat5;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    match mat5::read(bytes) {
        Ok(contents) => {
            for part in contents.parts {
                assert!(part.columns.windows(2).all(|pair| pair[0].cells.len() == pair[1].cells.len()));
            }
        }
        Err(error) => assert!(error.0.len() > 20, "{error}"),
    }
});
