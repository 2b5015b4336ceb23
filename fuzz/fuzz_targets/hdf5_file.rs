//! HDF5 files: any bytes give tables with columns of one length, or an error in words. A panic of the reader inside is an error, too.
#![no_main]

use froude_foreign::hdf5;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    match hdf5::read(bytes.to_vec()) {
        Ok(contents) => {
            for part in contents.parts {
                assert!(part.columns.windows(2).all(|pair| pair[0].cells.len() == pair[1].cells.len()));
            }
        }
        Err(error) => assert!(error.0.len() > 20, "{error}"),
    }
});
