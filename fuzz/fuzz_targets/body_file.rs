//! Body files: any text gives a body or an error that names the file, and a body has lengths that a mesh can be made of.
#![no_main]

use std::path::Path;

use froude::methods::added_mass::body_file::{Shape, parse_body};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    match parse_body(Path::new("body.toml"), text) {
        Ok(body) => {
            let lengths_m: Vec<f64> = match body.shape {
                Shape::Robot(robot) => {
                    let neck = robot.neck.map_or(vec![], |neck| vec![neck.length_m, neck.ramp_m]);
                    let link = robot.link;
                    let own = vec![link.major_semi_axis_m, link.minor_semi_axis_m, link.half_length_m, robot.end_m];
                    [own, neck].concat()
                }
                Shape::Ellipsoid { semi_axes_m } => semi_axes_m.to_vec(),
                Shape::Capsule { length_m, section, end_m } => vec![length_m, section.major_m, section.minor_m, end_m],
                Shape::Cylinder { length_m, section } => vec![length_m, section.major_m, section.minor_m],
            };
            assert!(lengths_m.iter().all(|m| (1e-5..=1e3).contains(m)), "{lengths_m:?}");
        }
        Err(error) => assert!(error.to_string().starts_with("body.toml"), "{error}"),
    }
});
