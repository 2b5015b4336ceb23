//! Robot files some of whose bytes were changed: a chain, or an error that names the file; never a panic.

use std::path::Path;

use froude_swim::robot_file::{parse_robot, parse_urdf};
use proptest::prelude::*;
use proptest::sample::Index;

/// The seed of the fuzz target, whose record is a file that lies beside it.
const SEED: &str = include_str!("../../../../fuzz/seeds/robot_file/mamba.toml");

/// Pieces that change what a robot means rather than whether it is TOML.
const PIECES: [&str; 18] = [
    "",
    "-",
    "0",
    "1e400",
    "nan",
    "\"",
    "[",
    "]",
    "{",
    "}",
    "=",
    "\n",
    "[[module]]\n",
    "count = 1000\n",
    "space = \"3d\"\n",
    "torque = \"friction\"\n",
    " kg",
    "é",
];

/// The same for XML.
const TAGS: [&str; 14] = [
    "",
    "-",
    "0",
    "1e400",
    "nan",
    "\"",
    "<",
    ">",
    "/>",
    "<link name=\"head\"/>",
    "<robot>",
    "link",
    "&amp;",
    "<!DOCTYPE a>",
];

const URDF: &str = include_str!("../../../../fuzz/seeds/urdf/three.urdf");

proptest! {
    #![proptest_config(ProptestConfig::with_cases(4_000))]

    #[test]
    fn any_change_gives_a_chain_or_an_error_with_its_file(
        changes in proptest::collection::vec((any::<Index>(), 0_usize..4, proptest::sample::select(&PIECES[..])), 1..6)
    ) {
        let mut text: Vec<char> = SEED.replace("\"status\"", "\"Cargo.toml\"").chars().collect();
        for (at, taken, piece) in changes {
            let at = at.index(text.len());
            let end = (at + taken).min(text.len());
            text.splice(at..end, piece.chars());
        }
        let text: String = text.into_iter().collect();
        match parse_robot(Path::new("robot.toml"), &text) {
            Ok(robot) => {
                prop_assert!((2..=1_000).contains(&robot.modules.len()));
                prop_assert!(robot.modules.iter().all(|m| m.mass_kg > 0.0 && m.inertia_kg_m2[2] > 0.0 && m.centre_of_mass_m[0].is_finite()));
                prop_assert_eq!(robot.joints.len(), robot.modules.len() - 1);
            }
            Err(error) => prop_assert!(error.to_string().starts_with("robot.toml"), "{}", error),
        }
    }

    #[test]
    fn any_change_of_a_urdf_gives_a_chain_or_an_error_with_its_file(
        changes in proptest::collection::vec((any::<Index>(), 0_usize..4, proptest::sample::select(&TAGS[..])), 1..6)
    ) {
        let mut text: Vec<char> = URDF.chars().collect();
        for (at, taken, piece) in changes {
            let at = at.index(text.len());
            let end = (at + taken).min(text.len());
            text.splice(at..end, piece.chars());
        }
        let text: String = text.into_iter().collect();
        match parse_urdf(Path::new("robot.urdf"), &text) {
            Ok(chain) => {
                prop_assert!((2..=1_000).contains(&chain.len()));
                prop_assert!(chain.iter().all(|link| link.mass_kg > 0.0));
            }
            Err(error) => prop_assert!(error.to_string().starts_with("robot.urdf"), "{}", error),
        }
    }
}
