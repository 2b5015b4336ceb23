//! Robot files: any text gives a chain of two modules at least, with positive masses, or an error that names the file.
#![no_main]

use std::path::Path;

use froude_swim::robot_file::parse_robot;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    // A record that exists, so that what follows it is read too.
    match parse_robot(Path::new("/proc/self/robot.toml"), text) {
        Ok(robot) => {
            assert!((2..=1_000).contains(&robot.modules.len()));
            assert!(robot.modules.iter().all(|m| m.mass_kg > 0.0 && m.centre_of_mass_m[0].is_finite()));
            assert_eq!([robot.joints.len(), robot.axes.len()], [robot.modules.len() - 1; 2]);
            for module in &robot.modules {
                let [roll, pitch, yaw] = module.inertia_kg_m2;
                assert!(roll > 0.0 && pitch > 0.0 && yaw > 0.0);
                assert!(!robot.model.is_3d || module.volume_m3.is_some());
            }
        }
        Err(error) => assert!(error.to_string().starts_with("/proc/self/robot.toml"), "{error}"),
    }
});
