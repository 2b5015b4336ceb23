//! Sections of a campaign that belong to methods: they are read with it, whichever verb reads it.

use std::path::Path;

use froude::Error;
use froude::carriage::drive::{DriveJob, prepare};
use froude::inspect::inspect;
use froude::pipeline::{Job, identify, read_campaign};
use froude::plan::plan;
use froude::twin::simulate;

fn examples() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples")
}

#[test]
fn the_examples_are_read_whole() {
    for folder in std::fs::read_dir(examples()).unwrap() {
        let path = folder.unwrap().path().join("campaign.toml");
        if path.exists() {
            read_campaign(&path).unwrap();
        }
    }
}

/// What is wrong in a section is said word for word, and by every verb, also where the verb has no use for the section.
#[test]
fn a_mistake_in_the_section_of_a_method_is_passed_over_by_no_verb() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::create_dir(folder.path().join("runs")).unwrap();
    let path = folder.path().join("c.toml");
    let driven = std::fs::read_to_string(examples().join("towing-carriage/campaign.toml")).unwrap();
    let line = driven.lines().count();
    for (method, section, (below, column), problem) in [
        (
            "decay_envelope",
            "[source.decay]\naxis = \"heave\"\ninertai = \"12 kg\"\nstiffness = \"180 N/m\"",
            (8, 1),
            "unknown key `inertai` in [source.decay]; did you mean `inertia`?",
        ),
        (
            "rotation",
            "[source.rotation]\naxis = \"upright\"\ninertia = \"1 m\"",
            (8, 11),
            "`inertia` is \"1 m\": expected a quantity in kg m^2, found a length (m)",
        ),
        (
            "steady",
            "[source.steady]\ntow = { still = \"5 s\", stedy = \"10 s\" }",
            (7, 24),
            "unknown key `stedy` in [source.steady.tow]; did you mean `steady`?",
        ),
        (
            "weight_tow",
            "[[source.plan]]\nwieght = \"1 N\"",
            (7, 1),
            "unknown key `wieght` in [[source.plan]]; did you mean `weight`?",
        ),
        (
            "accelerated_tow",
            "[[source.plan]]\nspeed = \"0.3 m/s\"\nacceleration = [\"0 m/s^2\"]",
            (8, 17),
            "`acceleration` is \"0 m/s^2\"; it must be larger than zero",
        ),
    ] {
        let source =
            format!("[[source]]\nname = \"a\"\nkind = \"tank\"\nmethod = \"{method}\"\nruns = \"runs\"\n{section}\n");
        std::fs::write(&path, format!("{driven}{source}")).unwrap();
        let job = DriveJob { campaign: path.clone(), out: None, start_unix_ns: 0, date: "2026-01-01".to_owned() };
        let said = |result: Result<(), Error>| result.unwrap_err().to_string();
        for found in [
            said(identify(&Job::new(&path), &|_| {}).map(drop)),
            said(plan(&path).map(drop)),
            said(simulate(&path, false).map(drop)),
            said(inspect(&path, None).map(drop)),
            said(prepare(&job).map(drop)),
        ] {
            assert_eq!(found, format!("{}:{}:{column}: {problem}", path.display(), line + below));
        }
    }
}
