//! The same command gives the same bytes: what is printed and what is written, on one thread, two and three.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use froude::mesh::files::write_obj;
use froude::mesh::sections::{Resolution, SectionBody};

use crate::bench::{SIX_FRICTION_SPEEDS, SIX_SPEEDS, campaign};

/// Path below the folder, and content.
type Files = BTreeMap<String, Vec<u8>>;

fn files(folder: &Path, below: &str, into: &mut Files) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        let name = format!("{below}/{}", path.file_name().unwrap().to_str().unwrap());
        if path.is_dir() {
            files(&path, &name, into);
        } else {
            into.insert(name, std::fs::read(&path).unwrap());
        }
    }
}

/// Standard output of each command, and everything in the folder after the last.
fn done(threads: usize, prepare: &dyn Fn(&Path), commands: &[&[&str]]) -> Files {
    let folder = tempfile::tempdir().unwrap();
    prepare(folder.path());
    let mut out = Files::new();
    for command in commands {
        let output = Command::new(env!("CARGO_BIN_EXE_froude"))
            .args(*command)
            .current_dir(folder.path())
            .env("RAYON_NUM_THREADS", threads.to_string())
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{command:?} on {threads} threads: {said}");
        out.insert(format!("standard output of {command:?}"), output.stdout);
    }
    files(folder.path(), "", &mut out);
    out
}

fn assert_same_bytes(prepare: &dyn Fn(&Path), commands: &[&[&str]]) {
    let one = done(1, prepare, commands);
    for threads in [2, 3] {
        let more = done(threads, prepare, commands);
        assert!(one.keys().eq(more.keys()), "{:?} and {:?}", one.keys(), more.keys());
        for (name, content) in &one {
            let other = &more[name];
            let at = content.iter().zip(other).position(|(a, b)| a != b).unwrap_or(content.len().min(other.len()));
            let around = |bytes: &[u8]| {
                String::from_utf8_lossy(&bytes[at.saturating_sub(60)..bytes.len().min(at + 60)]).into_owned()
            };
            assert!(
                content == other,
                "{name} differs on {threads} threads from byte {at} on: {:?} and {:?}",
                around(content),
                around(other)
            );
        }
    }
}

fn example(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name)
}

/// Meshes of 256, 1,024 and 4,096 panels: the last one goes to the fast solver, whose sums run over boxes.
#[test]
fn added_mass_of_a_mesh_and_of_a_robot() {
    let prepare = |folder: &Path| {
        let mesh = SectionBody::ellipsoid([0.6, 0.2, 0.3], 4).mesh(Resolution { along: 2, around: 16 }).unwrap().mesh;
        let hull = mesh.mapped(|[x, y, z]| [x + 0.2, y - 0.1 + 0.3 * x, z + 0.05]);
        std::fs::write(folder.join("hull.obj"), write_obj(&hull)).unwrap();
        std::fs::copy(example("mamba-necked/body.toml"), folder.join("body.toml")).unwrap();
    };
    let mesh: &[&str] = &[
        "added-mass",
        "hull.obj",
        "--density",
        "1000 kg/m^3",
        "--most-panels",
        "4096",
        "--tolerance",
        "0.001 %",
        "--axes",
        "ned",
        "--at",
        "cb",
        "--export",
        "wamit,capytaine,csv",
    ];
    let robot: &[&str] = &["added-mass", "body.toml", "--links", "1,2", "--tolerance", "50 %", "--out", "links"];
    let chain: &[&str] =
        &["added-mass", "body.toml", "--links", "1", "--chain", "--most-panels", "1500", "--out", "chain", "--json"];
    assert_same_bytes(&prepare, &[mesh, robot, chain]);
}

#[test]
fn a_simulated_campaign_identified_and_compared() {
    let prepare = |folder: &Path| {
        std::fs::create_dir_all(folder.join("published")).unwrap();
        for name in [
            "campaign.toml",
            "published/circulation_tank_restricted.json",
            "published/cfd.json",
            "published/towing_rig.json",
        ] {
            std::fs::copy(example("mamba").join(name), folder.join(name)).unwrap();
        }
    };
    let commands: [&[&str]; 3] = [
        &["simulate", "campaign.toml"],
        &["identify", "campaign.toml"],
        &["compare", "campaign-results/estimate.json", "published/cfd.json"],
    ];
    assert_same_bytes(&prepare, &commands);
}

#[test]
fn a_campaign_of_the_carriage_driven_and_reduced() {
    let prepare = |folder: &Path| {
        let changes = [
            (SIX_SPEEDS, r#"speeds = ["0.55 m/s"]"#),
            ("repeats = 5  ", "repeats = 2  "),
            (SIX_FRICTION_SPEEDS, r#"speeds = ["0.2 m/s", "0.4 m/s"]"#),
            (r#"duration = "1 min""#, r#"duration = "5 s""#),
            (r#"stop_when = "2.5 %""#, ""),
            (r#"log_rate = "1 kHz""#, r#"log_rate = "200 Hz""#),
        ];
        campaign(folder, &changes);
    };
    let commands: [&[&str]; 2] = [&["run", "campaign.toml", "--yes"], &["carriage", "drag", "campaign-runs"]];
    assert_same_bytes(&prepare, &commands);
}
