//! URDFs: any text gives a chain of two links at least, with positive masses, or an error that names the file.
#![no_main]

use std::path::Path;

use froude_swim::robot_file::parse_urdf;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| match parse_urdf(Path::new("robot.urdf"), text) {
    Ok(chain) => {
        assert!((2..=1_000).contains(&chain.len()));
        assert!(chain.iter().all(|link| link.mass_kg > 0.0 && link.inertia_kg_m2.iter().all(|i| *i > 0.0)));
        assert!(chain.iter().rev().skip(1).all(|link| link.next_m.is_some()));
    }
    Err(error) => assert!(error.to_string().starts_with("robot.urdf"), "{error}"),
});
