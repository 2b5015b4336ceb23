//! Gait files: any text gives a gait whose frequency is above zero, or an error that names the file.
#![no_main]

use std::path::Path;

use froude_swim::gait_file::parse_gait;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    // A file that exists, so that what follows it is read too.
    match parse_gait(Path::new("/proc/self/gait.toml"), text) {
        Ok(gait) => assert!(gait.frequency_rad_s.is_none_or(|f| f > 0.0 && f.is_finite())),
        Err(error) => assert!(error.to_string().starts_with("/proc/self/gait.toml"), "{error}"),
    }
});
