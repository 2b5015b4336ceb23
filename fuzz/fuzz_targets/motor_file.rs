//! Motor files: any text gives a curve of two points at least that falls, or an error that names the file.
#![no_main]

use std::path::Path;

use froude_swim::motor_file::parse_motor;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    // A file that exists, so that what follows it is read too.
    match parse_motor(Path::new("/proc/self/motor.toml"), text) {
        Ok(motor) => assert!(motor.curve.len() >= 2 && motor.curve.windows(2).all(|w| w[1][0] > w[0][0] && w[1][1] <= w[0][1])),
        Err(error) => assert!(error.to_string().starts_with("/proc/self/motor.toml"), "{error}"),
    }
});
