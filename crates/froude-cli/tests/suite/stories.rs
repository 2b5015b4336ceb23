//! What people come with, and how they get their answer: each in five commands at most, from nothing.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use crate::tank::froude;

/// Runs a command in a folder, and returns what it printed.
pub fn done(folder: &Path, arguments: &[&str]) -> String {
    let output = froude(folder, arguments);
    let told = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(0), "froude {}: {told}", arguments.join(" "));
    String::from_utf8(output.stdout).unwrap()
}

/// Numbers that look like noise, between −1 and 1.
fn noise() -> impl FnMut() -> f64 {
    let mut state = 1_u32;
    move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state) / f64::from(u32::MAX) * 2.0 - 1.0
    }
}

/// That the recommended estimate of a record holds the truth in its intervals, each at most `widest` of the truth wide on either side.
fn holds(record: &Value, truth: &[(&str, f64)], widest: f64) {
    let estimates = record["estimates"].as_array().unwrap();
    let estimate = estimates.iter().find(|e| e["recommended"] == true).unwrap();
    for (name, truth) in truth {
        let c = &estimate["coefficients"][*name];
        let [low, high] = [0, 1].map(|k| c["interval_95"][k].as_f64().unwrap_or_else(|| panic!("{name}: {c}")));
        assert!(low <= *truth && *truth <= high, "{name}: [{low}, {high}] without {truth}");
        assert!(high - low < 2.0 * widest * truth.abs(), "{name}: [{low}, {high}]");
    }
}

const GRAM_FORCE: f64 = 9.80665e-3;

/// Drift tests as a German Excel exports them: a row of units, decimal commas, gram-force, drag aft.
fn exported(loads: impl Fn(f64, f64) -> [f64; 3]) -> Vec<u8> {
    let mut noise = noise();
    let mut text =
        "Lauf;Geschwindigkeit;Driftwinkel;Widerstand;Querkraft;Giermoment\r\n-;m/s;°;gf;gf;gf m\r\n".to_owned();
    let mut run = 0;
    for speed in [0.5, 0.75, 1.0, 1.25, 1.5] {
        for degrees in [-12.0, -6.0, 0.0, 6.0, 12.0_f64] {
            for _ in 0..2 {
                run += 1;
                let (sin, cos) = degrees.to_radians().sin_cos();
                let [x, y, n] = loads(speed * cos, -speed * sin);
                let [x, y, n] =
                    [-x + 0.03 * noise(), y + 0.06 * noise(), n + 0.02 * noise()].map(|load| load / GRAM_FORCE);
                let line = format!("{run};{speed};{degrees};{x:.1};{y:.1};{n:.2}\r\n").replace('.', ",");
                text += &line;
            }
        }
    }
    // In windows-1252 as in Latin-1, ° is one byte.
    text.chars().map(|c| u8::try_from(u32::from(c)).unwrap()).collect()
}

/// The strut's drag along the flow, 0.3 m ahead of the point that moments are about.
fn strut(u: f64, v: f64) -> [f64; 3] {
    let speed = u.hypot(v);
    [-1.1 * u * speed, -1.1 * v * speed, -0.33 * v * speed]
}

#[test]
fn an_export_of_drift_tests_with_a_strut_becomes_derivatives() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let hull = |u: f64, v: f64| [-4.2 * u * u, -28.0 * u * v - 115.0 * v * v.abs(), -14.0 * u * v];
    let both = |u: f64, v: f64| std::array::from_fn(|k| hull(u, v)[k] + strut(u, v)[k]);
    std::fs::write(at.join("strut.csv"), exported(strut)).unwrap();
    std::fs::write(at.join("drift.csv"), exported(both)).unwrap();

    done(at, &["inspect", "strut.csv", "--write-sidecar"]);
    done(at, &["inspect", "drift.csv", "--write-sidecar"]);
    done(at, &["new", "drift", "--out", "."]);
    done(at, &["identify", "strut.csv", "--out", "strut-results"]);
    let campaign = std::fs::read_to_string(at.join("campaign.toml")).unwrap();
    std::fs::write(at.join("campaign.toml"), campaign.replace("# tare =", "tare =")).unwrap();
    let record: Value = serde_json::from_str(&done(at, &["identify", "campaign.toml", "--json"])).unwrap();
    holds(&record, &[("D_x_II", 4.2), ("Y_uv", -28.0), ("D_y_II", 115.0), ("N_uv", -14.0)], 0.1);
    let codes: Vec<&str> =
        record["findings"].as_array().unwrap().iter().filter_map(|finding| finding["code"].as_str()).collect();
    assert!(codes.contains(&"tare-subtracted") && codes.contains(&"foreign-table"), "{codes:?}");
}

/// Twelve cases of half the body, each settling by an oscillation that decays: X_uu −3.9, Y_uv −24, Y_vv −98 kg/m, N_uv −11 kg of the whole body.
fn cases(lab: &Path) {
    let mut noise = noise();
    for speed in [1.0, 1.5, 2.0] {
        for degrees in [0.0, 4.0, 8.0, 12.0_f64] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let (u, v) = (speed * cos, -speed * sin);
            let place = lab.join(format!("cases/U{speed}_b{degrees}/postProcessing/forces/0"));
            std::fs::create_dir_all(&place).unwrap();
            // Along the axes of the mesh, x with the flow and z up, over the density, of half of the body.
            let force = [3.9 * u * u, -24.0 * u * v - 98.0 * v * v.abs(), 0.0];
            let moment = [0.0, 0.0, 11.0 * u * v];
            // What the mesh and the scheme leave, from case to case.
            let [force, moment] = [force, moment].map(|loads| loads.map(|load| load * (1.0 + 2e-3 * noise())));
            for (file, title, steady) in [("force.dat", "Force", force), ("moment.dat", "Moment", moment)] {
                let mut text = format!(
                    "# {title}\n# CofR : (0 0 0)\n# Time total_x total_y total_z pressure_x pressure_y pressure_z viscous_x viscous_y viscous_z\n"
                );
                for i in 1..=200 {
                    let settles = 1.0 + 0.4 * (-f64::from(i) / 25.0).exp() * (f64::from(i) / 9.0).cos();
                    let [x, y, z] = steady.map(|load| 0.5 * load * settles / 998.0);
                    let pressure = [0.4 * x, 0.4 * y, 0.4 * z].map(|x| x.to_string()).join(" ");
                    let viscous = [0.6 * x, 0.6 * y, 0.6 * z].map(|x| x.to_string()).join(" ");
                    writeln!(text, "{} {x} {y} {z} {pressure} {viscous}", 0.1 * f64::from(i)).unwrap();
                }
                std::fs::write(place.join(file), text).unwrap();
            }
        }
    }
}

#[test]
fn folders_of_openfoam_cases_become_derivatives() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    cases(at);
    assert!(done(at, &["inspect", "cases"]).contains("12 cases of OpenFOAM with force files"));
    done(at, &["new", "openfoam", "--out", "."]);
    let campaign = std::fs::read_to_string(at.join("campaign.toml")).unwrap();
    std::fs::write(at.join("campaign.toml"), campaign.replace("symmetry = \"none\"", "symmetry = \"z = 0\"")).unwrap();
    let record: Value = serde_json::from_str(&done(at, &["identify", "campaign.toml", "--json"])).unwrap();
    holds(&record, &[("Y_uv", -24.0), ("D_y_II", 98.0), ("N_uv", -11.0)], 0.05);
    // The model of turbulence is 10 % of the drag.
    holds(&record, &[("D_x_II", 3.9)], 0.25);
}
