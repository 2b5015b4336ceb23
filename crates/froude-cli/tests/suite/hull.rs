//! Oblique tows of a hull with fins, as another program's table, to manoeuvring derivatives and their primes in four commands.

use std::fmt::Write as _;
use std::path::Path;

use serde_json::Value;

use crate::tank::froude;

const LENGTH_M: f64 = 1.8;
const DENSITY_KG_M3: f64 = 998.0;
/// Of the hull, SI: the fins carry lift at the stern, so Y_uv is large and they take off most of the Munk moment.
const TRUTH: [(&str, f64); 7] =
    [("X_uu", -5.6), ("Y_v", -4.0), ("Y_uv", -64.0), ("Y_vv", -140.0), ("N_v", -1.2), ("N_uv", -11.0), ("N_vv", 18.0)];

/// Semicolons, a decimal comma, units in brackets, a resistance that is written positive; two runs at each setting.
fn table() -> String {
    let mut state = 46_u32;
    let mut even = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state) / f64::from(u32::MAX) - 0.5
    };
    // Twelve even numbers add up to a nearly normal one of variance 1.
    let mut noise = |standard: f64| standard * (0..12).map(|_| even()).sum::<f64>();
    let of = |name: &str| TRUTH.iter().find(|(own, _)| *own == name).unwrap().1;
    let mut out = "Run;Speed (m/s);Drift angle (deg);Resistance (N);Side force (N);Yaw moment (Nm)\n".to_owned();
    let mut run = 0;
    for speed in [0.6, 0.9, 1.2, 1.5] {
        for degrees in [-15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0_f64] {
            for _ in 0..2 {
                run += 1;
                let (sin, cos) = degrees.to_radians().sin_cos();
                let (u, v) = (speed * cos, -speed * sin);
                let x = of("X_uu") * u * u + noise(0.03);
                let y = of("Y_v") * v + of("Y_uv") * u * v + of("Y_vv") * v * v.abs() + noise(0.10);
                let n = of("N_v") * v + of("N_uv") * u * v + of("N_vv") * v * v.abs() + noise(0.03);
                let line = format!("{run};{speed:.2};{degrees:.1};{:.3};{y:.3};{n:.4}", -x);
                writeln!(out, "{}", line.replace('.', ",")).unwrap();
            }
        }
    }
    out
}

/// Replaces a value that a file proposes by one that is the user's.
fn set(path: &Path, changes: &[(&str, &str)]) {
    let mut text = std::fs::read_to_string(path).unwrap();
    for (from, to) in changes {
        assert!(text.contains(from), "{from}: {text}");
        text = text.replace(from, to);
    }
    std::fs::write(path, text).unwrap();
}

#[test]
fn oblique_tows_of_a_hull_with_fins_become_primes_in_four_commands() {
    let folder = tempfile::tempdir().unwrap();
    let lab = folder.path();
    std::fs::write(lab.join("drift.csv"), table()).unwrap();
    let run = |arguments: &[&str], code: i32| {
        let output = froude(lab, arguments);
        let (told, error) = (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
        assert_eq!(output.status.code(), Some(code), "{arguments:?}: {told}{error}");
        told + &error
    };
    run(&["new", "drift", "--out", "."], 0);
    let asked = run(&["inspect", "drift.csv"], 2);
    assert!(asked.contains("--write-sidecar") && asked.contains("is it f_y?"), "{asked}");
    run(&["inspect", "drift.csv", "--write-sidecar"], 0);
    let own = [
        ("reference_length = \"2.0 m\"", "reference_length = \"1.8 m\""),
        ("table = \"drift.csv\"", "models = [\"oblique\", \"linear_quadratic\"]\ntable = \"drift.csv\""),
    ];
    set(&lab.join("campaign.toml"), &own);
    let told = run(&["identify", "campaign.toml"], 0);
    for part in ["recommended: oblique is the simplest law", "Y_uv_prime", "0.5*density*length^2"] {
        assert!(told.contains(part), "{part}: {told}");
    }
    let record = std::fs::read_to_string(lab.join("campaign-results/estimate.json")).unwrap();
    let record: Value = serde_json::from_str(&record).unwrap();
    let estimates = record["estimates"].as_array().unwrap();
    let oblique = estimates.iter().find(|e| e["law"]["name"] == "oblique").unwrap();
    let holds = |of: &Value, truth: f64| {
        let [low, high] = [0, 1].map(|k| of["interval_95"][k].as_f64().unwrap());
        low <= truth && truth <= high
    };
    for (name, truth) in TRUTH {
        assert!(holds(&oblique["coefficients"][name], truth), "{name}: {}", oblique["coefficients"][name]);
    }
    let force = 0.5 * DENSITY_KG_M3 * LENGTH_M * LENGTH_M;
    for (name, truth) in [("X_uu", -5.6 / force), ("Y_vv", -140.0 / force), ("N_uv", -11.0 / (force * LENGTH_M))] {
        let prime = &oblique["derived"][format!("{name}_prime")];
        assert!(holds(prime, truth), "{name}: {prime}, {truth}");
    }
    // Four speeds: there is no one U for the terms that are linear in the velocity.
    assert!(oblique["derived"]["Y_v_prime"].is_null());
    let page = std::fs::read_to_string(lab.join("campaign-results/report.html")).unwrap();
    assert!(page.contains("nondimensional coefficients"));
}
