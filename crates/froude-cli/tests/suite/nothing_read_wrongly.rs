//! What a table may be taken for that it is not, at the verbs that a user runs.

use std::fmt::Write as _;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn froude(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_froude")).args(args).current_dir(folder).output().unwrap()
}

fn folder_of(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    folder
}

/// The one message of a refusal: exit code 2, and nothing made.
fn refusal(files: &[(&str, &str)], args: &[&str]) -> String {
    let folder = folder_of(files);
    let output = froude(folder.path(), args);
    let said = String::from_utf8_lossy(&output.stderr).trim_end().to_owned();
    assert_eq!(output.status.code(), Some(2), "{args:?}: {said}");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), files.len(), "nothing is written");
    said
}

/// What `--json` prints.
fn json(files: &[(&str, &str)], args: &[&str]) -> Value {
    json_in(folder_of(files).path(), args)
}

fn json_in(folder: &Path, args: &[&str]) -> Value {
    let args: Vec<&str> = ["--json"].into_iter().chain(args.iter().copied()).collect();
    let output = froude(folder, &args);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// Severity and message of every finding of one code.
fn findings<'a>(out: &'a Value, code: &str) -> Vec<(&'a str, &'a str)> {
    out["findings"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|f| f["code"] == code)
        .map(|f| (f["severity"].as_str().unwrap(), f["message"].as_str().unwrap()))
        .collect()
}

fn estimate<'a>(out: &'a Value, model: &str) -> &'a Value {
    out["estimates"].as_array().unwrap().iter().find(|e| e["law"]["name"] == model).unwrap()
}

fn value(estimate: &Value, coefficient: &str) -> f64 {
    estimate["coefficients"][coefficient]["value"].as_f64().unwrap()
}

fn recommended(out: &Value) -> &Value {
    out["estimates"].as_array().unwrap().iter().find(|e| e["recommended"] == true).unwrap()
}

/// Standard normal numbers (Box and Muller) of a linear congruential generator (Knuth's MMIX).
fn noise(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut uniform = move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((state >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    };
    move || (-2.0 * uniform().ln()).sqrt() * (std::f64::consts::TAU * uniform()).cos()
}

/// A drift test: speed in m/s, angle in degrees, and the loads of a body with a side force and a moment, N and N m.
struct Row {
    speed: f64,
    angle_deg: f64,
    f_x: f64,
    f_y: f64,
    m_z: f64,
}

const Y_UV: f64 = 120.0;
const Y_VV: f64 = 60.0;
const N_UV: f64 = -25.0;
const N_VV: f64 = 8.0;

fn drift_test(seed: u64) -> Vec<Row> {
    let mut noise = noise(seed);
    let mut out = Vec::new();
    for speed in [0.4, 0.6, 0.8, 1.0] {
        for angle_deg in [-20.0, -15.0, -10.0, -5.0, 0.0, 5.0, 10.0, 15.0, 20.0] {
            for _ in 0..2 {
                let (sin, cos) = f64::to_radians(angle_deg).sin_cos();
                let (u, v): (f64, f64) = (speed * cos, -speed * sin);
                out.push(Row {
                    speed,
                    angle_deg,
                    f_x: -10.0 * u * u + 0.02 * noise(),
                    f_y: -Y_UV * u * v - Y_VV * v * v.abs() + 0.02 * noise(),
                    m_z: N_UV * u * v + N_VV * v * v.abs() + 0.005 * noise(),
                });
            }
        }
    }
    out
}

fn table(head: &str, rows: &[Row], line: impl Fn(&Row) -> String) -> String {
    let mut out = format!("{head}\n");
    for row in rows {
        writeln!(out, "{}", line(row)).unwrap();
    }
    out
}

#[test]
fn grad_is_no_milliard_of_radians() {
    let said = |unit: &str| {
        let text = format!("speed [m/s],angle [{unit}],f_x [N]\n0.5,10,-1.0\n0.6,10,-1.5\n0.7,10,-2.0\n");
        refusal(&[("t.csv", &text)], &["identify", "t.csv"])
    };
    for unit in ["Grad", "grad"] {
        assert_eq!(
            said(unit),
            format!(
                "froude: t.csv:1: column `angle [{unit}]`: unknown unit `{unit}`; did you mean `deg` (360 to the turn) or `gon` \
                 (400 to the turn)?"
            )
        );
    }
    assert_eq!(
        said("mrad"),
        "froude: t.csv:1: column `angle [mrad]`: unknown unit `mrad`; `rad` takes no prefix: write `rad`, and the numbers times 0.001"
    );
    let said = refusal(
        &[("c.toml", "schema = 1\nname = \"x\"\n[fluid]\ntemperature = \"20 m°C\"\n")],
        &["identify", "c.toml"],
    );
    assert!(
        said.ends_with("unknown unit `m°C`; `°C` takes no prefix: write `°C`, and the numbers times 0.001"),
        "{said}"
    );
}

#[test]
fn an_angle_of_several_turns_is_refused_with_its_cause() {
    let of = |unit: &str, angle: f64| {
        let text = format!("speed [m/s],angle [{unit}],f_x [N]\n0.5,0,-1.0\n0.6,{angle},-1.5\n0.7,0,-2.0\n");
        refusal(&[("t.csv", &text)], &["identify", "t.csv"])
    };
    assert_eq!(
        of("rad", 20.0),
        "froude: t.csv:3: `angle [rad]` is 20, which is more than a whole turn: degrees under a header in radians, probably: write the \
         unit deg; of an angle counted on over several turns take the whole ones off (1.15044 rad)"
    );
    assert_eq!(
        of("deg", 725.0),
        "froude: t.csv:3: `angle [deg]` is 725, which is more than a whole turn: an angle counted on over several turns, probably: take \
         the whole ones off (5 deg); or one that was made degrees twice (12.6536 deg)"
    );
    // Through a sidecar, and in a plan.
    let said = refusal(
        &[
            ("t.csv", "u,a,f\n0.5,30,-1\n"),
            (
                "t.toml",
                "schema = 1\n[columns]\nu = { name = \"speed\", unit = \"m/s\" }\na = { name = \"angle\", unit = \"rad\", sign = -1 }\n\
                 f = { name = \"f_x\", unit = \"N\" }\n",
            ),
        ],
        &["inspect", "t.csv"],
    );
    assert!(
        said.starts_with("froude: t.csv:2: `angle [rad]` is -30, which is more than a whole turn: degrees"),
        "{said}"
    );
    let plan = "schema = 1\nname = \"x\"\n[[source]]\nname = \"s\"\nkind = \"tank\"\ntable = \"s.csv\"\n[[source.plan]]\n\
                speed = \"1 m/s\"\nangle = [\"0 rad\", \"15 rad\"]\n";
    let said = refusal(&[("c.toml", plan)], &["simulate", "c.toml"]);
    assert!(
        said.starts_with("froude: c.toml:9:19: `angle` is \"15 rad\", which is more than a whole turn: degrees"),
        "{said}"
    );
}

#[test]
fn water_as_thin_as_air_is_refused_wherever_it_is_stated() {
    const NO_WATER: &str =
        "not a density of water (500 to 2000 kg/m^3 are accepted); write 1.025 g/cm^3 or 1025 kg/m^3";
    const OR_AIR: &str = "; if the test was in air, state its kinematic viscosity too, some 1.5e-5 m^2/s: kinematic_viscosity beside density, in \
                          [fluid] of the campaign or as columns";
    let campaign = |density: &str| format!("schema = 1\nname = \"x\"\n[fluid]\ndensity = {density}\n");
    let said = |density: &str| refusal(&[("c.toml", &campaign(density))], &["identify", "c.toml"]);
    assert_eq!(
        said("\"1.025 kg/m^3\""),
        format!("froude: c.toml:4:11: `density` is \"1.025 kg/m^3\", which is {NO_WATER}{OR_AIR}")
    );
    // The message that met a bare number once proposed just that.
    assert!(said("1.025").ends_with("such as \"1.025 g/cm^3\""), "{}", said("1.025"));
    assert!(said("\"1.025\"").ends_with("write for example `1.025 g/cm^3`"), "{}", said("\"1.025\""));
    assert!(said("1025").ends_with("such as \"1025 kg/m^3\""), "{}", said("1025"));
    let rows = "speed [m/s],f_x [N],density [kg/m^3]\n0.1,-0.5,1025\n0.2,-2.0,1.025\n";
    let said = refusal(&[("t.csv", rows)], &["identify", "t.csv"]);
    assert_eq!(said, format!("froude: t.csv:3: `density [kg/m^3]` is 1.025, which is {NO_WATER}{OR_AIR}"));
    // Of added mass nobody asks a viscosity.
    let body = "schema = 1\nname = \"b\"\n[fluid]\ndensity = \"1.025 kg/m^3\"\n[body]\nshape = \"ellipsoid\"\n\
                semi_axes = [\"1 m\", \"0.2 m\", \"0.2 m\"]\n";
    let over_rho = "; in air, ask for \"1 kg/m^3\" and multiply the result by the density of the air";
    let said = refusal(&[], &["added-mass", "x.stl", "--density", "1.025 kg/m^3"]);
    assert_eq!(said, format!("froude: --density \"1.025 kg/m^3\": it is {NO_WATER}{over_rho}"));
    let said = refusal(&[("b.toml", body)], &["added-mass", "b.toml"]);
    assert_eq!(said, format!("froude: b.toml:4:11: `density` is \"1.025 kg/m^3\", which is {NO_WATER}{over_rho}"));
}

/// A test in a wind tunnel: 45 °C at the end of the day, 60 m/s. The density of air is the number of sea water in g/cm³; the viscosity beside it
/// tells which it is.
#[test]
fn air_is_taken_where_its_viscosity_is_stated_and_water_in_other_units_is_not() {
    let rows = |density: &str, viscosity: &str| {
        let mut out = format!(
            "speed [m/s],f_x [N],temperature [degC]{}{}\n",
            heading("density [kg/m^3]", density),
            heading("kinematic_viscosity [m^2/s]", viscosity)
        );
        for i in 1..=12 {
            let speed = 5.0 * f64::from(i);
            let f = -0.02 * speed * speed * (1.0 + 0.001 * f64::from(i % 3));
            let column = |value: &str| if value.is_empty() { String::new() } else { format!(",{value}") };
            writeln!(out, "{speed},{f},45{}{}", column(density), column(viscosity)).unwrap();
        }
        out
    };
    let campaign = |fluid: &str| {
        format!(
            "schema = 1\nname = \"x\"\n{fluid}[body]\nreference_length = \"1 m\"\n[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\n"
        )
    };
    let air = "[fluid]\ndensity = \"1.11 kg/m^3\"\nkinematic_viscosity = \"1.75e-5 m^2/s\"\n";
    let viscosity_of_air = "[fluid]\nkinematic_viscosity = \"1.75e-5 m^2/s\"\n";
    for (table, fluid) in [(rows("", ""), air), (rows("1.11", "1.75e-5"), ""), (rows("1.11", ""), viscosity_of_air)] {
        let out = json(&[("t.csv", &table), ("c.toml", &campaign(fluid))], &["identify", "c.toml"]);
        let quadratic = estimate(&out, "quadratic");
        assert!((value(quadratic, "D_x_II") - 0.02).abs() < 1e-4, "{}", quadratic["coefficients"]);
        assert!((quadratic["refers_to"]["density"]["value"].as_f64().unwrap() - 1.11).abs() < 1e-12);
        let highest = quadratic["validity"]["Re"]["high"].as_f64().unwrap();
        assert!((highest / (60.0 / 1.75e-5) - 1.0).abs() < 1e-9, "Re {highest}");
        assert!(findings(&out, "implausible-speed").is_empty() && findings(&out, "implausible-drag-area").is_empty());
    }
    json(&[("t.csv", &rows("1.11", "1.75e-5"))], &["inspect", "t.csv"]);

    let said =
        |table: &str, fluid: &str| refusal(&[("t.csv", table), ("c.toml", &campaign(fluid))], &["identify", "c.toml"]);
    let no_air = "write 1.025 g/cm^3 or 1025 kg/m^3, or, if the test was in air, the kinematic viscosity beside it: 1.05e-6 m^2/s is not \
                  that of air, some 1.5e-5 m^2/s";
    let water = "[fluid]\ndensity = \"1.025 kg/m^3\"\nkinematic_viscosity = \"1.05e-6 m^2/s\"\n";
    assert!(said(&rows("", ""), water).ends_with(no_air), "{}", said(&rows("", ""), water));
    assert!(
        said(&rows("1.025", "1.05e-6"), "")
            .starts_with("froude: t.csv:2: `density [kg/m^3]` is 1.025, which is not a density of water")
    );
    assert!(said(&rows("1.025", "1.05e-6"), "").ends_with(no_air));
    let viscosity_of_water = "[fluid]\nkinematic_viscosity = \"1.05e-6 m^2/s\"\n";
    assert!(said(&rows("1.025", ""), viscosity_of_water).ends_with(no_air));
    assert!(said(&rows("1.025", ""), "").ends_with("in [fluid] of the campaign or as columns"));

    // A limit is in the unit of what it is compared with.
    let keep = |table: &str, limit: &str| {
        let campaign = format!("{}keep = \"density <= {limit}\"\n", campaign(viscosity_of_air));
        froude(folder_of(&[("t.csv", table), ("c.toml", &campaign)]).path(), &["identify", "c.toml"])
    };
    assert_eq!(keep(&rows("1.11", ""), "1.2 kg/m^3").status.code(), Some(0));
    let sea = rows("1025", "").replace(",45,", ",15,");
    assert_eq!(keep(&sea, "1030 kg/m^3").status.code(), Some(0));
    let refused = keep(&sea, "1.03 kg/m^3");
    let said = String::from_utf8_lossy(&refused.stderr);
    assert!(said.contains("keep: density is compared with 1.03 kg/m^3, which is not a density of water"), "{said}");
}

/// The head of a column, where there is one.
fn heading(head: &str, value: &str) -> String {
    if value.is_empty() { String::new() } else { format!(",{head}") }
}

/// Every second run of a table comes from an export in gram-force, or all runs from some speed on.
#[test]
fn rows_in_gram_force_are_refused_with_their_lines() {
    const GF: f64 = 1.0 / 9.806_65e-3;
    let mut noise = noise(3);
    let mut of = |factor: &dyn Fn(usize) -> f64| {
        let mut out = "speed [m/s],repeat [1],f_x [N]\n".to_owned();
        for i in 0..16 {
            let (speed, repeat) = (0.1 * (i / 2 + 2) as f64, i % 2 + 1);
            let f = factor(i) * (-20.0 * speed * speed + 0.02 * noise());
            writeln!(out, "{speed:.1},{repeat},{f:.3}").unwrap();
        }
        out
    };
    let mixed = of(&|i| if i % 2 == 1 { GF } else { 1.0 });
    let said = refusal(&[("t.csv", &mixed)], &["identify", "t.csv"]);
    assert!(said.starts_with("froude: t.csv:") && said.contains(": `f_x [N]` is -"), "{said}");
    assert!(
        said.contains(", at one setting; there are two groups of rows a factor of 10")
            && said.ends_with(
                "as loads of one body are not: some rows are in gram-force under a header in newtons (1 N is 102 gf), probably. Convert \
                 them; if they are correct, give the two groups different names in a column `configuration`: rows of different configurations are not compared"
            ),
        "{said}"
    );
    let fast = of(&|i| if i >= 8 { GF } else { 1.0 });
    assert!(refusal(&[("t.csv", &fast)], &["inspect", "t.csv"]).contains("gram-force"));
    let clean = of(&|_| 1.0);
    assert!(
        (value(estimate(&json(&[("t.csv", &clean)], &["identify", "t.csv"]), "quadratic"), "D_x_II") - 20.0).abs()
            < 0.2
    );
}

/// Half of the side forces are in gram-force. Whoever fits the drag alone is not kept from it by them.
#[test]
fn a_load_that_nothing_fits_may_stand_in_two_units() {
    let rows = drift_test(16);
    let mut i = 0;
    let mut mixed = "speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned();
    for r in &rows {
        i += 1;
        let factor = if i % 2 == 0 { 101.97 } else { 1.0 };
        writeln!(mixed, "{},{},{},{}", r.speed, r.angle_deg, r.f_x, factor * r.f_y).unwrap();
    }
    let campaign = |law: &str| {
        format!(
            "schema = 1\nname = \"x\"\n[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\n[identify]\n[[identify.model]]\n\
             name = \"own\"\nf_x = \"X_uu*u*abs(u)\"\n{law}"
        )
    };
    let files = |law: &str| [("t.csv".to_owned(), mixed.clone()), ("c.toml".to_owned(), campaign(law))];
    let [table, alone] = files("");
    let out = json(&[("t.csv", &table.1), ("c.toml", &alone.1)], &["identify", "c.toml"]);
    assert!((value(estimate(&out, "own"), "X_uu") + 10.0).abs() < 0.1);
    let [table, both] = files("f_y = \"Y_uv*u*v + Y_vv*v*abs(v)\"\n");
    for verb in ["identify", "inspect"] {
        let said = refusal(&[("t.csv", &table.1), ("c.toml", &both.1)], &[verb, "c.toml"]);
        assert!(said.contains("`f_y [N]` is") && said.contains("gram-force"), "{said}");
    }
    json(&[("t.csv", &table.1), ("c.toml", &alone.1)], &["inspect", "c.toml"]);
}

#[test]
fn an_angle_under_another_name_is_proposed_with_its_sign() {
    let rows = drift_test(1);
    for (name, sign) in
        [("beta", 1.0), ("drift", -1.0), ("alpha", 1.0), ("heading", -1.0), ("yaw", 1.0), ("drift angle", 1.0)]
    {
        let head = format!("speed [m/s],{name} [deg],f_x [N],f_y [N]");
        let text = table(&head, &rows, |r| format!("{},{},{},{}", r.speed, sign * r.angle_deg, r.f_x, r.f_y));
        for verb in ["identify", "inspect"] {
            let out = json(&[("t.csv", &text)], &[verb, "t.csv"]);
            let told = findings(&out, "column-not-used");
            let how = if sign > 0.0 {
                "head it `angle [deg]`".to_owned()
            } else {
                format!("map it in a sidecar, \"{name} [deg]\" = {{ name = \"angle\", unit = \"deg\", sign = -1 }}")
            };
            let wanted = format!(
                "`{name} [deg]` goes from -20.00 to 20.00 deg and is not used: every row is read as straight ahead; if it is the angle of \
                 the test, {how}: with that sign the side force f_y opposes the motion sideways in "
            );
            assert!(
                told.iter().any(|(severity, message)| *severity == "warning" && message.starts_with(&wanted)),
                "{verb} {name}: {told:?}"
            );
        }
    }
    // What is proposed is taken, and then nothing is left to say.
    let text = table("speed [m/s],drift [deg],f_x [N],f_y [N]", &rows, |r| {
        format!("{},{},{},{}", r.speed, -r.angle_deg, r.f_x, r.f_y)
    });
    let sidecar = "schema = 1\n[columns]\n\"speed [m/s]\" = { name = \"speed\", unit = \"m/s\" }\n\
                   \"drift [deg]\" = { name = \"angle\", unit = \"deg\", sign = -1 }\n\
                   \"f_x [N]\" = { name = \"f_x\", unit = \"N\" }\n\"f_y [N]\" = { name = \"f_y\", unit = \"N\" }\n";
    let out = json(&[("t.csv", &text), ("t.toml", sidecar)], &["identify", "t.csv"]);
    assert!(findings(&out, "column-not-used").is_empty() && findings(&out, "force-along-motion").is_empty());
    assert!(value(estimate(&out, "quadratic"), "D_y_II") > 0.0);
    // A sidecar that passes the angle over.
    let without: String = sidecar.lines().filter(|l| !l.contains("drift")).flat_map(|l| [l, "\n"]).collect();
    let out = json(&[("t.csv", &text), ("t.toml", &without)], &["identify", "t.csv"]);
    let told = findings(&out, "column-not-used");
    assert!(
        told[0].0 == "warning"
            && told[0].1.starts_with(
                "the sidecar does not name the column `drift [deg]`, and every row is read as straight ahead; if it is"
            ),
        "{told:?}"
    );
}

#[test]
fn no_column_is_dropped_in_silence() {
    let rows = drift_test(2);
    let head = "speed [m/s],angle [deg],f_x [N],Mz [N m],r [rad/s],std_speed [m/s],current [A],remark,w_z [rad/s]";
    let text = table(head, &rows, |r| {
        format!("{},{},{},{},0.1,0.001,{},ok,0.2", r.speed, r.angle_deg, r.f_x, r.m_z, 0.5 + r.speed)
    });
    let out = json(&[("t.csv", &text)], &["identify", "t.csv"]);
    let told = findings(&out, "column-not-used");
    let warned: Vec<&str> = told.iter().filter(|f| f.0 == "warning").map(|f| f.1).collect();
    assert_eq!(warned.len(), 2, "{told:?}");
    assert!(warned[0].starts_with("`Mz [N m]` (") && warned[0].ends_with("if it is m_z, name it so"), "{warned:?}");
    assert_eq!(
        warned[1],
        "w_z goes from 0.2000 to 0.2000 1/s and appears in no law: the fit of f_x treats it as zero; write a law with it \
         ([[identify.model]]), name one that has it (fossen_3dof, abkowitz, mmg, torpedo), or keep the rows where it is zero"
    );
    let noted: Vec<&str> = told.iter().filter(|f| f.0 == "note").map(|f| f.1).collect();
    assert_eq!(
        noted,
        [
            "columns that no law uses, nor anything else that was asked for: `r [rad/s]` (if the motion: w_x, w_y or w_z), `std_speed [m/s]` (weights are \
          standard deviations of fitted loads; of another channel, declare it in [[source.uncertainty]]), `current [A]`, `remark` (text)"
        ]
    );
    // v_x beside an angle: v_y is missing, and the angle is not what the rows say.
    let askew = table("v_x [m/s],angle [deg],f_x [N]", &rows, |r| format!("{},{},{}", r.speed, r.angle_deg, r.f_x));
    let out = json(&[("t.csv", &askew)], &["identify", "t.csv"]);
    assert_eq!(
        findings(&out, "angle-contradicts-velocity"),
        [(
            "warning",
            "the angle column differs from atan2(-v_y, v_x) by up to 20.00 deg (line 2); v_x and v_y are used (v_y is missing and read as \
             0): if v_x is the speed of the carriage, name it speed"
        )]
    );
}

/// The findings about the observations concern those that are fitted: the wild row is dropped, and a figure of the others has their lines.
#[test]
fn a_contradiction_in_rows_that_are_left_out_is_none() {
    let mut noise = noise(15);
    let mut text =
        "speed [m/s],angle [deg],v_x [m/s],v_y [m/s],zero_before_f_x [N],zero_after_f_x [N],f_x [N]\n".to_owned();
    for i in 0..24 {
        let speed = 0.1 * f64::from(1 + i % 12);
        // Lines 2 to 5 say something else; line 20 a little.
        let (angle, stated, drift) = if i < 4 { (60.0, 2.0 * speed, 3.0) } else { (0.0, speed, 0.0) };
        let angle = if i == 18 { 2.0 } else { angle };
        writeln!(text, "{stated},{angle},{speed},0,0,{drift},{}", -10.0 * speed * speed + drift / 2.0 + 0.01 * noise())
            .unwrap();
    }
    let campaign = |keep: &str| {
        format!("schema = 1\nname = \"x\"\n[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\n{keep}")
    };
    let of = |keep: &str| json(&[("t.csv", &text), ("c.toml", &campaign(keep))], &["identify", "c.toml"]);
    let (all, kept) = (of(""), of("keep = \"zero_after_f_x == 0 N\"\n"));
    let angle =
        |out: &Value| findings(out, "angle-contradicts-velocity").iter().map(|f| f.1.to_owned()).collect::<String>();
    assert!(angle(&all).contains("by up to 60.00 deg (line 2);"), "{}", angle(&all));
    assert!(angle(&kept).contains("by up to 2.00 deg (line 20);"), "{}", angle(&kept));
    let speed =
        |out: &Value| findings(out, "speed-contradicts-velocity").iter().map(|f| f.1.to_owned()).collect::<String>();
    assert!(speed(&all).contains("by up to 4.000e-1 m/s (line 5);"), "{}", speed(&all));
    assert_eq!(speed(&kept), "");
    let zero = |out: &Value| findings(out, "zero-drift")[0].1.to_owned();
    assert!(zero(&all).contains("by up to 3.000e0"), "{}", zero(&all));
    assert!(zero(&kept).contains("by up to 0.000e0"), "{}", zero(&kept));
}

/// v_x goes before an angle: who is told to head `beta` as the angle is told what to do with a v_x that stands alone.
#[test]
fn an_angle_beside_a_lone_velocity_is_proposed_with_what_it_needs() {
    let rows = drift_test(3);
    for sign in [1.0, -1.0] {
        let text = table("v_x [m/s],beta [deg],f_x [N],f_y [N]", &rows, |r| {
            format!("{},{},{},{}", r.speed, sign * r.angle_deg, r.f_x, r.f_y)
        });
        let out = json(&[("t.csv", &text)], &["identify", "t.csv"]);
        let told = findings(&out, "column-not-used");
        let beside = ", and v_x `speed` if that is the carriage's (a velocity takes precedence over an angle; beside one along the body give v_y): \
                      with that sign the side force";
        assert!(told[0].0 == "warning" && told[0].1.contains(beside), "{told:?}");
    }
    // Taken, the proposal makes the loads a drift test's.
    let text = table("speed [m/s],angle [deg],f_x [N],f_y [N]", &rows, |r| {
        format!("{},{},{},{}", r.speed, r.angle_deg, r.f_x, r.f_y)
    });
    let out = json(&[("t.csv", &text)], &["identify", "t.csv"]);
    assert!(findings(&out, "column-not-used").is_empty() && value(estimate(&out, "quadratic"), "D_y_II") > 0.0);
    let text = table("speed [m/s],v_x [m/s],beta [deg],f_x [N],f_y [N]", &rows, |r| {
        format!("{},{},{},{},{}", r.speed, r.speed, r.angle_deg, r.f_x, r.f_y)
    });
    let out = json(&[("t.csv", &text)], &["identify", "t.csv"]);
    let told = findings(&out, "column-not-used");
    assert!(
        told[0].1.contains("head it `angle [deg]`, and leave v_x out, which takes precedence over speed and angle: "),
        "{told:?}"
    );
}

#[test]
fn the_moment_of_a_bare_table_is_fitted_beside_its_forces() {
    let rows = drift_test(4);
    let text = table("speed [m/s],angle [deg],f_x [N],f_y [N],m_z [N m]", &rows, |r| {
        format!("{},{},{},{},{}", r.speed, r.angle_deg, r.f_x, r.f_y, r.m_z)
    });
    let out = json(&[("t.csv", &text)], &["identify", "t.csv"]);
    let quadratic = estimate(&out, "quadratic");
    assert_eq!(quadratic["law"]["outputs"]["m_z"]["formula"], "N_uv*v_x*v_y + N_vv*v_y*abs(v_y)");
    for (name, truth) in [("N_uv", N_UV), ("N_vv", N_VV)] {
        let c = &quadratic["coefficients"][name];
        assert_eq!(c["unit"], "kg");
        let standard = c["standard_uncertainty"].as_f64().unwrap();
        assert!((value(quadratic, name) - truth).abs() < 4.0 * standard, "{name}: {c}");
        assert!(standard < 0.02 * truth.abs(), "{name}: {c}");
    }
    assert_eq!(
        estimate(&out, "linear_quadratic")["law"]["outputs"]["m_z"]["formula"],
        "N_v*v_y + N_uv*v_x*v_y + N_vv*v_y*abs(v_y)"
    );
    assert!(
        findings(&out, "column-not-used").is_empty()
            && findings(&out, "negative-drag").iter().all(|f| !f.1.contains("N_"))
    );
    // A table with the moment alone; and one that goes straight ahead, where nothing tells of it.
    let alone = table("speed [m/s],angle [deg],m_z [N m]", &rows, |r| format!("{},{},{}", r.speed, r.angle_deg, r.m_z));
    let out = json(&[("t.csv", &alone)], &["identify", "t.csv"]);
    assert!((value(estimate(&out, "quadratic"), "N_uv") / N_UV - 1.0).abs() < 0.02);
    let ahead = table("speed [m/s],f_x [N],m_z [N m]", &rows, |r| {
        format!("{},{},{}", r.speed, -10.0 * r.speed * r.speed + 0.1 * r.m_z, 0.001 * r.m_z)
    });
    let out = json(&[("t.csv", &ahead)], &["identify", "t.csv"]);
    let told = findings(&out, "column-not-used");
    assert!(
        told.len() == 1 && told[0].0 == "note" && told[0].1.contains("`m_z [N m]` (measured, and no law gives it"),
        "{told:?}"
    );
}

/// Three laws of f_x and one of three loads: what the one states about the other two counts.
#[test]
fn laws_of_different_loads_are_compared_load_by_load() {
    let text = table("speed [m/s],angle [deg],f_x [N],f_y [N],m_z [N m]", &drift_test(5), |r| {
        format!("{},{},{},{},{}", r.speed, r.angle_deg, r.f_x, r.f_y, r.m_z)
    });
    let campaign = "schema = 1\nname = \"x\"\n[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\n[identify]\n\
        [[identify.model]]\nname = \"along\"\nf_x = \"X_uu*u*abs(u)\"\n\
        [[identify.model]]\nname = \"along_linear\"\nf_x = \"X_u*u + X_uu*u*abs(u)\"\n\
        [[identify.model]]\nname = \"whole\"\nf_x = \"X_uu*u*abs(u)\"\nf_y = \"Y_uv*u*v + Y_vv*v*abs(v)\"\nm_z = \"N_uv*u*v + N_vv*v*abs(v)\"\n";
    let out = json(&[("t.csv", &text), ("c.toml", campaign)], &["identify", "c.toml"]);
    let best = recommended(&out);
    assert_eq!(best["law"]["name"], "whole", "{}", best["reason"]);
    let reason = best["reason"].as_str().unwrap();
    assert!(reason.contains("not contradicted in the loads that they give: along, along_linear"), "{reason}");
    // Loads that are noise about zero are no reason for the larger law.
    let mut noise = noise(6);
    let mut ahead = "speed [m/s],f_x [N],f_y [N]\n".to_owned();
    for i in 1..=20 {
        let speed = 0.05 * f64::from(i);
        writeln!(ahead, "{speed},{},{}", -10.0 * speed * speed + 0.01 * noise(), 0.01 * noise()).unwrap();
    }
    let campaign = "schema = 1\nname = \"x\"\n[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\n[identify]\n\
        [[identify.model]]\nname = \"along\"\nf_x = \"X_uu*u*abs(u)\"\n\
        [[identify.model]]\nname = \"both\"\nf_x = \"X_uu*u*abs(u)\"\nf_y = \"Y_0 + Y_u*u + Y_uu*u*u\"\n";
    let out = json(&[("t.csv", &ahead), ("c.toml", campaign)], &["identify", "c.toml"]);
    assert_eq!(recommended(&out)["law"]["name"], "along", "{}", recommended(&out)["reason"]);
}

/// Drag of a round strut, N s²/m²: along the flow at every angle, so that 6 % of the body's Y_uv is the strut's.
const STRUT: f64 = 0.06 * Y_UV;

#[test]
fn a_tare_taken_straight_ahead_is_a_warning_at_drift_and_a_strut_law_mends_it() {
    let rows = drift_test(7);
    let gross = table("speed [m/s],angle [deg],f_x [N],f_y [N]", &rows, |r| {
        let (sin, cos) = r.angle_deg.to_radians().sin_cos();
        let drag = STRUT * r.speed * r.speed;
        format!("{},{},{},{}", r.speed, r.angle_deg, r.f_x - drag * cos, r.f_y + drag * sin)
    });
    let mut noise = noise(8);
    let mut tare = "speed [m/s],f_x [N]\n".to_owned();
    let mut strut = "speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned();
    for i in 1..=10 {
        let speed = 0.1 * f64::from(i);
        let drag = STRUT * speed * speed;
        writeln!(tare, "{speed},{}", -drag + 0.01 * noise()).unwrap();
        for angle in [-20.0, -10.0, 0.0, 10.0, 20.0] {
            let (sin, cos) = f64::to_radians(angle).sin_cos();
            writeln!(strut, "{speed},{angle},{},{}", -drag * cos + 0.01 * noise(), drag * sin + 0.01 * noise())
                .unwrap();
        }
    }
    let campaign = |record: &str| {
        format!(
            "schema = 1\nname = \"x\"\n[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"gross.csv\"\ntare = {{ record = \"{record}\" }}\n\
             [identify]\n[[identify.model]]\nname = \"whole\"\nf_x = \"X_uu*u*abs(u)\"\nf_y = \"Y_uv*u*v + Y_vv*v*abs(v)\"\n"
        )
    };
    let folder = folder_of(&[
        ("gross.csv", &gross),
        ("tare.csv", &tare),
        ("strut.csv", &strut),
        ("with-tare.toml", &campaign("tare-results/estimate.json")),
        ("with-strut.toml", &campaign("strut-results/estimate.json")),
    ]);
    let folder = folder.path();
    json_in(folder, &["identify", "tare.csv", "--models", "quadratic"]);
    let fitted = json_in(folder, &["identify", "strut.csv", "--models", "strut"]);
    for name in ["D_xU", "D_yU"] {
        assert!((value(estimate(&fitted, "strut"), name) / STRUT - 1.0).abs() < 0.01, "{name}");
    }

    // Results in the folder of the tare's record would take its place.
    let out = froude(folder, &["identify", "with-tare.toml", "--out", "tare-results"]);
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.code() == Some(2) && said.contains("which is read: results there would replace it"), "{said}");
    let wrong = json_in(folder, &["identify", "with-tare.toml"]);
    let told = findings(&wrong, "tare-straight-ahead");
    assert_eq!(told.len(), 1, "{:?}", wrong["findings"]);
    assert!(
        told[0].0 == "warning"
            && told[0].1.starts_with(
                "the tare tare.csv/quadratic was taken straight ahead and is used at angles up to 20.0 deg, in 64 of 72 rows; its side \
                 force stays in f_y, mostly in a coefficient of u v: up to 2.4"
            )
            && told[0].1.ends_with(
                "tow the strut alone at the angles of the test, fit these runs with models = [\"strut\"] (f_x and f_y) and subtract that record"
            ),
        "{told:?}"
    );
    // The stated size is what the coefficients are off by.
    let stated: f64 = told[0].1.split(" N (").nth(1).unwrap().split(" %").next().unwrap().parse().unwrap();
    let off = 100.0 * (value(estimate(&wrong, "whole"), "Y_uv") / -Y_UV - 1.0);
    assert!((off - 6.0).abs() < 0.5 && (stated - off).abs() < 1.5, "stated {stated} %, found {off} %");

    let right = json_in(folder, &["identify", "with-strut.toml"]);
    assert!(findings(&right, "tare-straight-ahead").is_empty());
    let y_uv = &estimate(&right, "whole")["coefficients"]["Y_uv"];
    let standard = y_uv["standard_uncertainty"].as_f64().unwrap();
    assert!((y_uv["value"].as_f64().unwrap() + Y_UV).abs() < 4.0 * standard.min(0.002 * Y_UV), "{y_uv}");
}

const SUBTRACTED: &str = "schema = 1\nname = \"x\"\n[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"gross.csv\"\n\
    tare = { record = \"tare-results/estimate.json\" }\n\
    [identify]\n[[identify.model]]\nname = \"whole\"\nf_x = \"X_uu*u*abs(u)\"\nf_y = \"Y_uv*u*v + Y_vv*v*abs(v)\"\n";

/// A tare that was towed ahead and astern, or at drift without f_y, knows no side force.
#[test]
fn a_tare_without_side_force_is_a_warning_at_drift_whichever_way_it_was_towed() {
    let gross = table("speed [m/s],angle [deg],f_x [N],f_y [N]", &drift_test(10), |r| {
        let (sin, cos) = r.angle_deg.to_radians().sin_cos();
        let drag = STRUT * r.speed * r.speed;
        format!("{},{},{},{}", r.speed, r.angle_deg, r.f_x - drag * cos, r.f_y + drag * sin)
    });
    let mut noise = noise(11);
    let mut tare_at = |angles: &[f64]| {
        let mut out = "speed [m/s],angle [deg],f_x [N]\n".to_owned();
        for i in 1..=10 {
            for angle in angles {
                let (speed, cos) = (0.1 * f64::from(i), angle.to_radians().cos());
                writeln!(out, "{speed},{angle},{}", -STRUT * speed * speed * cos + 0.01 * noise()).unwrap();
            }
        }
        out
    };
    for (tare, model, taken, is_f_x_named) in [
        (tare_at(&[0.0, 180.0]), "quadratic", "straight ahead", true),
        (tare_at(&[0.0, -180.0]), "quadratic", "straight ahead", true),
        (tare_at(&[-20.0, -10.0, 0.0, 10.0, 20.0]), "strut", "up to 20.0 deg without f_y", false),
    ] {
        let folder = folder_of(&[("gross.csv", &gross), ("tare.csv", &tare), ("c.toml", SUBTRACTED)]);
        json_in(folder.path(), &["identify", "tare.csv", "--models", model]);
        let out = json_in(folder.path(), &["identify", "c.toml"]);
        let told = findings(&out, "tare-straight-ahead");
        let wanted = format!(
            "the tare tare.csv/{model} was taken {taken} and is used at angles up to 20.0 deg, in 64 of 72 rows; its side force \
             stays in f_y, mostly in a coefficient of u v: "
        );
        assert!(told.len() == 1 && told[0].1.starts_with(&wanted), "{told:?}");
        assert_eq!(told[0].1.contains("of the measured f_x"), is_f_x_named, "{told:?}");
    }
}

/// A strut that stands askew in its clamp pushes sideways when it is towed ahead, and its law gives that f_y; ahead and astern is straight
/// all the same, however the table writes it, and so are zeros at rest with the strut turned.
#[test]
fn a_tare_that_gives_a_side_force_is_a_warning_at_drift_if_it_was_towed_straight() {
    let gross = table("speed [m/s],angle [deg],f_x [N],f_y [N]", &drift_test(17), |r| {
        let (sin, cos) = r.angle_deg.to_radians().sin_cos();
        let drag = STRUT * r.speed * r.speed;
        format!("{},{},{},{}", r.speed, r.angle_deg, r.f_x - drag * cos, r.f_y + drag * sin)
    });
    let mut noise = noise(18);
    let mut of = |u: f64| (-STRUT * u * u.abs() + 0.01 * noise(), 0.03 * STRUT * u * u.abs() + 0.01 * noise());
    let mut tables = [
        "speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned(),
        "speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned(),
        "speed [m/s],f_x [N],f_y [N]\n".to_owned(),
        "v_x [m/s],v_y [m/s],f_x [N],f_y [N]\n".to_owned(),
        "speed [m/s],angle [deg],f_x [N],f_y [N]\n0,20,0.01,0\n0,-20,0,0.01\n0.0001,45,0,0\n".to_owned(),
    ];
    for i in 1..=10 {
        let speed = 0.1 * f64::from(i);
        let ((x, y), (back_x, back_y)) = (of(speed), of(-speed));
        let [forth, turned, signed, velocity, with_zeros] = &mut tables;
        writeln!(forth, "{speed},0,{x},{y}\n{speed},180,{back_x},{back_y}").unwrap();
        writeln!(turned, "{speed},0,{x},{y}\n{speed},-180,{back_x},{back_y}").unwrap();
        writeln!(signed, "{speed},{x},{y}\n{},{back_x},{back_y}", -speed).unwrap();
        writeln!(velocity, "{speed},0,{x},{y}\n{},0,{back_x},{back_y}", -speed).unwrap();
        writeln!(with_zeros, "{speed},0,{x},{y}").unwrap();
    }
    for tare in &tables {
        let law = "schema = 1\nname = \"x\"\n[[source]]\nname = \"t\"\nkind = \"towing\"\ntable = \"tare.csv\"\n[identify]\n\
                   [[identify.model]]\nname = \"askew\"\nf_x = \"X_uu*u*abs(u)\"\nf_y = \"Y_uu*u*abs(u)\"\n";
        let folder =
            folder_of(&[("gross.csv", &gross), ("tare.csv", tare), ("tare.toml", law), ("c.toml", SUBTRACTED)]);
        json_in(folder.path(), &["identify", "tare.toml"]);
        let out = json_in(folder.path(), &["identify", "c.toml"]);
        let told = findings(&out, "tare-straight-ahead");
        let head = tare.lines().next().unwrap();
        assert!(
            told.len() == 1
                && told[0].1.starts_with(
                    "the tare t/askew was taken straight ahead and is used at angles up to 20.0 deg, in 64 of 72 rows; its side force differs \
                     there: for a strut whose drag is the same from all sides, by up to 2.6"
                ),
            "{head}: {told:?}"
        );
    }
    // The strut's own law takes a signed speed as it is.
    let folder = folder_of(&[("tare.csv", &tables[2])]);
    let fitted = json_in(folder.path(), &["identify", "tare.csv", "--models", "strut"]);
    let d = value(estimate(&fitted, "strut"), "D_xU");
    assert!((d / STRUT - 1.0).abs() < 0.01, "D_xU {d}");
}

/// A thin strut under a bluff body: what it leaves in f_y is said from half a per cent on.
#[test]
fn a_side_force_that_does_not_matter_is_no_warning() {
    for (share, is_told) in [(0.003, false), (0.02, true)] {
        let drag_n_s2_m2 = share * Y_UV;
        let gross = table("speed [m/s],angle [deg],f_x [N],f_y [N]", &drift_test(19), |r| {
            let (sin, cos) = r.angle_deg.to_radians().sin_cos();
            let drag = drag_n_s2_m2 * r.speed * r.speed;
            format!("{},{},{},{}", r.speed, r.angle_deg, r.f_x - drag * cos, r.f_y + drag * sin)
        });
        let mut tare = "speed [m/s],f_x [N]\n".to_owned();
        let mut noise = noise(20);
        for i in 1..=20 {
            let speed = 0.05 * f64::from(i);
            writeln!(tare, "{speed},{}", -drag_n_s2_m2 * speed * speed + 1e-4 * noise()).unwrap();
        }
        let folder = folder_of(&[("gross.csv", &gross), ("tare.csv", &tare), ("c.toml", SUBTRACTED)]);
        json_in(folder.path(), &["identify", "tare.csv", "--models", "quadratic"]);
        let out = json_in(folder.path(), &["identify", "c.toml"]);
        let told = findings(&out, "tare-straight-ahead");
        assert_eq!(told.iter().any(|f| f.1.contains("its side force stays in f_y")), is_told, "{share}: {told:?}");
        if is_told {
            let stated: f64 = told[0].1.split(" N (").nth(1).unwrap().split(" %").next().unwrap().parse().unwrap();
            // Y_vv carries a part of the side force, so that its share is a little less than that of Y_uv.
            assert!((stated - 100.0 * share).abs() < 0.5, "{told:?}");
        }
    }
}

/// Side force of the strut per sine of its angle, N s²/m².
const LIFT: f64 = 10.0 * STRUT;

/// The lift of a faired strut stands across the flow: a part of it points forward.
#[test]
fn a_faired_strut_as_tare_leaves_nothing_in_the_forces() {
    let of = |speed: f64, angle_deg: f64| {
        let (sin, cos) = angle_deg.to_radians().sin_cos();
        let (drag, lift) = (STRUT * speed * speed, LIFT * speed * speed * sin);
        (-drag * cos + lift * sin, drag * sin + lift * cos)
    };
    let gross = table("speed [m/s],angle [deg],f_x [N],f_y [N]", &drift_test(12), |r| {
        let (f_x, f_y) = of(r.speed, r.angle_deg);
        format!("{},{},{},{}", r.speed, r.angle_deg, r.f_x + f_x, r.f_y + f_y)
    });
    let mut noise = noise(13);
    let mut tare = "speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned();
    for i in 1..=10 {
        for angle in [-20.0, -10.0, 0.0, 10.0, 20.0] {
            let speed = 0.1 * f64::from(i);
            let (f_x, f_y) = of(speed, angle);
            writeln!(tare, "{speed},{angle},{},{}", f_x + 0.01 * noise(), f_y + 0.01 * noise()).unwrap();
        }
    }
    let folder = folder_of(&[("gross.csv", &gross), ("tare.csv", &tare), ("c.toml", SUBTRACTED)]);
    let fitted = json_in(folder.path(), &["identify", "tare.csv", "--models", "strut"]);
    let strut = estimate(&fitted, "strut");
    assert!((value(strut, "X_vv") / LIFT - 1.0).abs() < 0.01, "{}", strut["coefficients"]);
    assert!((value(strut, "D_xU") / STRUT - 1.0).abs() < 0.01, "{}", strut["coefficients"]);
    let out = json_in(folder.path(), &["identify", "c.toml"]);
    assert!(findings(&out, "tare-straight-ahead").is_empty());
    let whole = estimate(&out, "whole");
    for (name, truth) in [("X_uu", -10.0), ("Y_uv", -Y_UV), ("Y_vv", -Y_VV)] {
        let u = whole["coefficients"][name]["standard_uncertainty"].as_f64().unwrap();
        let off = value(whole, name) - truth;
        assert!(off.abs() < 3.0 * u && u < 0.01 * truth.abs(), "{name} {off} ± {u}");
    }
}

/// Laws of one's own beside a source that names its models without them.
#[test]
fn a_law_that_no_source_asks_for_is_reported() {
    let rows = drift_test(24);
    let text = table("speed [m/s],angle [deg],f_x [N],f_y [N]", &rows, |r| {
        format!("{},{},{},{}", r.speed, r.angle_deg, r.f_x, r.f_y)
    });
    let campaign = |models: &str| {
        format!(
            "schema = 1\nname = \"x\"\n[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\n{models}[identify]\n[[identify.model]]\n\
             name = \"own\"\nf_y = \"Y_uv*u*v + Y_vv*v*abs(v)\"\n"
        )
    };
    let of = |models: &str| json(&[("t.csv", &text), ("c.toml", &campaign(models))], &["identify", "c.toml"]);
    assert!(findings(&of(""), "law-not-asked").is_empty());
    assert!(findings(&of("models = [\"quadratic\", \"own\"]\n"), "law-not-asked").is_empty());
    let out = of("models = [\"quadratic\"]\n");
    let told = findings(&out, "law-not-asked");
    assert!(told.len() == 1 && told[0].1.starts_with("[[identify.model]] own: fitted to no source"), "{told:?}");
}

/// A strut that is the same fore and aft, towed ahead and astern at these angles.
fn strut_both_ways(angles_deg: &[f64]) -> String {
    let mut noise = noise(17);
    let mut out = "speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned();
    for i in 1..=10 {
        for angle in angles_deg {
            for way in [1.0, -1.0] {
                let speed = 0.1 * f64::from(i);
                let (sin, cos) = angle.to_radians().sin_cos();
                let (drag, lift) = (STRUT * speed * speed, LIFT * speed * speed * sin);
                let (f_x, f_y) = (way * (-drag * cos + lift * sin), way * (drag * sin + lift * cos));
                writeln!(out, "{},{angle},{},{}", way * speed, f_x + 0.01 * noise(), f_y + 0.01 * noise()).unwrap();
            }
        }
    }
    out
}

/// A strut alone and under a body, in two tanks: what a tare in another fluid, beyond its speeds, of the other way or with an ERROR of its own
/// leaves in the loads.
#[test]
fn a_tare_that_does_not_fit_is_reported_with_its_size() {
    let of = |speeds: &[f64], newtons_s2_m2: f64, seed: u64| {
        let mut noise = noise(seed);
        let row = |u: &f64| format!("{u},{}\n", -newtons_s2_m2 * u * u.abs() + 1e-4 * noise());
        "speed [m/s],f_x [N]\n".to_owned() + &speeds.iter().map(row).collect::<String>()
    };
    let speeds = |from: i32, to: i32| (from..=to).map(|i| 0.05 * f64::from(i)).collect::<Vec<f64>>();
    let codes = [
        "tare-in-another-fluid",
        "tare-beyond-its-speeds",
        "tare-of-the-other-way",
        "tare-with-errors",
        "tare-pushes",
        "tare-beyond-its-angles",
    ];
    let told = |tare: &str, density: [&str; 2], body: &str, spoil: bool| -> Vec<(usize, String)> {
        let of = |name: &str, table: &str, density: &str, rest: &str| {
            format!(
                "schema = 1\nname = \"{name}\"\n[fluid]\ndensity = \"{density}\"\n[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \
                 \"{table}\"\n{rest}[identify]\nmodels = [\"quadratic\"]\n"
            )
        };
        let folder = folder_of(&[
            ("tare.csv", tare),
            ("tare.toml", &of("tare", "tare.csv", density[0], "")),
            ("gross.csv", body),
            ("c.toml", &of("c", "gross.csv", density[1], "tare = { record = \"tare-results/estimate.json\" }\n")),
        ]);
        json_in(folder.path(), &["identify", "tare.toml"]);
        if spoil {
            let path = folder.path().join("tare-results/estimate.json");
            let mut record: Value = serde_json::from_str(&std::fs::read_to_string(&path).unwrap()).unwrap();
            record.as_object_mut().unwrap().remove("checksum");
            record["findings"] = serde_json::json!([{"severity": "error", "code": "not-dissipative", "message": "it drives the body", "source": "s"}]);
            std::fs::write(&path, record.to_string()).unwrap();
        }
        let out = json_in(folder.path(), &["identify", "c.toml"]);
        codes
            .iter()
            .enumerate()
            .flat_map(|(k, code)| findings(&out, code).into_iter().map(move |f| (k, f.1.to_owned())))
            .collect()
    };
    let (sea, fresh) = ("1025 kg/m^3", "998 kg/m^3");
    // The strut is half of the drag.
    let strut = of(&speeds(4, 20), 10.0, 1);
    let body = of(&speeds(4, 20), 20.0, 2);
    assert_eq!(told(&strut, [fresh, fresh], &body, false), []);
    assert_eq!(told(&strut, [fresh, fresh], &of(&speeds(4, 21), 20.0, 2), false), [], "5 % beyond is no extrapolation");

    let fluid = told(&strut, [fresh, sea], &body, false);
    // 10 · 27/998 of 20 N s²/m², at 1 m/s.
    assert!(
        fluid.len() == 1
            && fluid[0].0 == 0
            && fluid[0].1.contains("was taken at 998.00 kg/m^3 and is used at 1025.00 kg/m^3")
            && fluid[0].1.contains("up to 0.271 N, over all rows 1.4 % of the measured f_x"),
        "{fluid:?}"
    );
    let beyond = told(&strut, [sea, sea], &of(&speeds(4, 30), 20.0, 2), false);
    assert!(
        beyond.len() == 1
            && beyond[0].0 == 1
            && beyond[0].1.contains("was taken at 0.200 to 1.000 m/s and is used beyond that in 9 of 27 rows")
            && beyond[0].1.contains("up to 22.50"),
        "{beyond:?}"
    );
    let turned: Vec<f64> = speeds(4, 20).iter().map(|u| -u).collect();
    let both: Vec<f64> = turned.iter().copied().chain(speeds(4, 20)).collect();
    for (tare, body, own) in
        [(&speeds(4, 20), &turned, "ahead"), (&turned, &speeds(4, 20), "astern"), (&speeds(4, 20), &both, "ahead")]
    {
        let way = told(&of(tare, 10.0, 1), [sea, sea], &of(body, 20.0, 2), false);
        let said = format!("was towed {own} only and is used");
        assert!(way.len() == 1 && way[0].0 == 2 && way[0].1.contains(&said), "{way:?}");
    }
    assert_eq!(told(&of(&both, 10.0, 1), [sea, sea], &of(&both, 20.0, 2), false), []);

    let ill = told(&strut, [sea, sea], &body, true);
    assert!(
        ill.len() == 1
            && ill[0].0 == 3
            && ill[0].1.contains("has 1 ERROR of its own, [not-dissipative] first: it drives the body"),
        "{ill:?}"
    );
}

/// A section that is the same fore and aft: towed astern its forward part turns round with the flow. A law of an earlier version in bare
/// `speed` would push the body along there, and says so.
#[test]
fn a_strut_towed_both_ways_is_one_strut() {
    let tare = strut_both_ways(&[-20.0, -10.0, 0.0, 10.0, 20.0]);
    let folder = folder_of(&[("tare.csv", &tare)]);
    let fitted = json_in(folder.path(), &["identify", "tare.csv", "--models", "strut"]);
    let strut = estimate(&fitted, "strut");
    for (name, truth) in [("X_vv", LIFT), ("D_xU", STRUT), ("D_yU", STRUT)] {
        assert!((value(strut, name) / truth - 1.0).abs() < 0.01, "{name}: {}", strut["coefficients"]);
    }
    assert!(findings(&fitted, "lack-of-fit").is_empty());

    let body = "speed [m/s],f_x [N],f_y [N]\n".to_owned()
        + &[-0.4_f64, -0.3, -0.2, 0.2, 0.3, 0.4, 0.5, 0.6].map(|u| format!("{u},{},0\n", -7.0 * u * u.abs())).concat();
    let campaign = "schema = 1\nname = \"x\"\n[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"body.csv\"\ntare = { record = \
                    \"tare/estimate.json\", select = \"tare.csv/strut\" }\n[identify]\nmodels = [\"quadratic\"]\n";
    let record = std::fs::read_to_string(folder.path().join("tare-results/estimate.json")).unwrap();
    let older = record.replace("abs(speed)", "speed");
    assert_ne!(older, record);
    // Written by nobody's program: without the line of its checksum.
    let older: String = older.lines().filter(|l| !l.contains("\"checksum\"")).map(|l| format!("{l}\n")).collect();
    for (record, is_warned) in [(record, false), (older, true)] {
        let folder = folder_of(&[("body.csv", &body), ("c.toml", campaign)]);
        std::fs::create_dir(folder.path().join("tare")).unwrap();
        std::fs::write(folder.path().join("tare/estimate.json"), &record).unwrap();
        let out = json_in(folder.path(), &["identify", "c.toml"]);
        assert_eq!(findings(&out, "tare-pushes").len(), usize::from(is_warned), "{}", out["findings"]);
    }
}

/// At one magnitude of the angle, ahead and astern, f_x has one shape: its two terms would not be told apart.
#[test]
fn a_strut_at_one_angle_has_one_term_along_the_body() {
    let tare = strut_both_ways(&[-20.0, 20.0]);
    let out = json(&[("tare.csv", &tare)], &["identify", "tare.csv", "--models", "strut"]);
    let strut = estimate(&out, "strut");
    assert_eq!(strut["law"]["outputs"]["f_x"]["formula"], "-D_xU*v_x*abs(speed)");
    let sin = f64::to_radians(20.0).sin();
    // f_x = −(STRUT − LIFT tan 20° sin 20°) cos 20° U|U| is what both make of it.
    let both = STRUT - LIFT * sin * f64::to_radians(20.0).tan();
    // 0.01 N in 40 rows: 0.01/√(Σ U⁴ cos²) = 0.0033; four of them.
    assert!((value(strut, "D_xU") - both).abs() < 0.0133, "{}", strut["coefficients"]);
    assert!(
        findings(&out, "lack-of-fit").is_empty() && findings(&out, "undetermined").is_empty(),
        "{}",
        out["findings"]
    );

    // That one term holds at its angle alone: as a tare nearer to straight ahead it is a guess, and here even pushes.
    let gross = table("speed [m/s],angle [deg],f_x [N],f_y [N]", &drift_test(21), |r| {
        format!("{},{},{},{}", r.speed, r.angle_deg, r.f_x, r.f_y)
    });
    let folder = folder_of(&[("gross.csv", &gross), ("tare.csv", &tare), ("c.toml", SUBTRACTED)]);
    json_in(folder.path(), &["identify", "tare.csv", "--models", "strut"]);
    let out = json_in(folder.path(), &["identify", "c.toml"]);
    for (code, said) in [
        (
            "tare-beyond-its-angles",
            "was taken at 20.0 deg from straight ahead and more, and is used nearer to it in 56 of 72 rows",
        ),
        ("tare-pushes", "propels the body in "),
    ] {
        let told = findings(&out, code);
        assert!(told.len() == 1 && told[0].1.contains(said), "{code}: {told:?}");
    }
}

/// A law that pushes its body is told, and held back by `dissipative = true`, whichever way all rows went.
#[test]
fn power_is_asked_for_astern_too() {
    let campaign = |hold: &str| {
        format!(
            "schema = 1\nname = \"x\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[body]\nlink = {{ major_semi_axis = \"58.8 mm\", minor_semi_axis = \
             \"39.4 mm\", half_length = \"90 mm\" }}\nhead_side_area = \"0.011 m^2\"\ntail_side_area = \"0.008 m^2\"\n[[source]]\nname = \
             \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\n[identify]\nmodels = [\"f1\"]\n{hold}"
        )
    };
    for way in [1.0, -1.0] {
        let mut noise = noise(23);
        let mut text = "configuration,n_links [1],speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned();
        for i in 1..=8 {
            for angle in [-20.0_f64, -10.0, 10.0, 20.0] {
                let speed = 0.1 * f64::from(i);
                let (sin, cos) = angle.to_radians().sin_cos();
                let (u, v) = (way * speed * cos, -way * speed * sin);
                let (f_x, f_y) = (3.0 * u * u.abs() + 0.01 * noise(), -20.0 * v * v.abs() + 0.01 * noise());
                writeln!(text, "H3LT,3,{},{angle},{f_x},{f_y}", way * speed).unwrap();
            }
        }
        let free = json(&[("t.csv", &text), ("c.toml", &campaign(""))], &["identify", "c.toml"]);
        assert_eq!(findings(&free, "not-dissipative").len(), 1, "{}", free["findings"]);
        let held = json(&[("t.csv", &text), ("c.toml", &campaign("dissipative = true\n"))], &["identify", "c.toml"]);
        assert!(findings(&held, "not-dissipative").is_empty(), "{}", held["findings"]);
        assert!(value(estimate(&held, "f1"), "C_f").abs() < 1e-6, "{}", estimate(&held, "f1")["coefficients"]);
    }
}

/// Straight ahead and straight across: the forward part of the lift is zero in all rows, and left out.
#[test]
fn a_strut_ahead_and_across_can_be_a_tare() {
    let tare = strut_both_ways(&[0.0, 90.0]);
    let out = json(&[("tare.csv", &tare)], &["identify", "tare.csv", "--models", "strut"]);
    let strut = estimate(&out, "strut");
    assert_eq!(strut["law"]["outputs"]["f_x"]["formula"], "-D_xU*v_x*abs(speed)");
    assert!(strut["undetermined"].as_array().unwrap().is_empty(), "{}", strut["undetermined"]);
}

/// Bearings of a rotor: their torque goes neither with the density nor with the speed of the carriage.
#[test]
fn a_tare_that_does_not_go_with_fluid_or_speed_is_not_judged_by_them() {
    let mut tare = "speed [m/s],w_x [rad/s],m_x [N m]\n".to_owned();
    let mut body = tare.clone();
    for i in 1..=12 {
        let w = f64::from(i);
        writeln!(tare, "0,{w},{}", -0.5 - 0.1 * w).unwrap();
        writeln!(body, "{},{w},{}", 0.1 * w, -0.7 - 0.3 * w).unwrap();
    }
    let of = |name: &str, table: &str, density: &str, rest: &str| {
        format!(
            "schema = 1\nname = \"{name}\"\n[fluid]\ndensity = \"{density}\"\n[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \
             \"{table}\"\n{rest}[identify]\n[[identify.model]]\nname = \"bearing\"\nm_x = \"K_0 + K_p*p\"\n"
        )
    };
    let with_tare = "tare = { record = \"tare-results/estimate.json\" }\n";
    let folder = folder_of(&[
        ("tare.csv", &tare),
        ("tare.toml", &of("tare", "tare.csv", "1000 kg/m^3", "")),
        ("body.csv", &body),
        ("c.toml", &of("c", "body.csv", "1025 kg/m^3", with_tare)),
    ]);
    json_in(folder.path(), &["identify", "tare.toml"]);
    let out = json_in(folder.path(), &["identify", "c.toml"]);
    let codes: Vec<&str> =
        out["findings"].as_array().unwrap().iter().filter_map(|f| f["code"].as_str()?.strip_prefix("tare-")).collect();
    assert_eq!(codes, ["subtracted"], "{}", out["findings"]);
}

/// A table and its mirror image, towed the other way with every load turned round, are told the same.
#[test]
fn a_run_astern_is_judged_as_a_run_ahead() {
    let mut noise = noise(18);
    let mut table = |factor: &dyn Fn(usize) -> f64, stretch: f64| -> Vec<[f64; 4]> {
        (0..16)
            .map(|i| {
                let speed = stretch * 0.1 * (i / 2 + 2) as f64;
                [speed, speed, (i % 2 + 1) as f64, -factor(i) * (20.0 * speed * speed + 0.02 * noise())]
            })
            .collect()
    };
    let written = |rows: &[[f64; 4]], way: f64| {
        let mut out = "speed [m/s],v_x [m/s],repeat [1],f_x [N]\n".to_owned();
        for [speed, v_x, repeat, f_x] in rows {
            writeln!(out, "{},{},{repeat},{:.4}", way * speed, way * v_x, way * f_x).unwrap();
        }
        out
    };
    let codes = |text: &str| -> Vec<String> {
        let campaign = "schema = 1\nname = \"x\"\n[fluid]\ntemperature = \"15 degC\"\n[body]\nreference_area = \
                        \"0.02 m^2\"\n[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\n";
        let out = json(&[("t.csv", text), ("c.toml", campaign)], &["identify", "c.toml"]);
        out["findings"].as_array().unwrap().iter().map(|f| f["code"].as_str().unwrap().to_owned()).collect()
    };
    let clean = table(&|_| 1.0, 1.0);
    let fast = table(&|_| 1.0, 80.0);
    let small = table(&|_| 1e-3, 1.0);
    let mut contradicting = clean.clone();
    contradicting[7][1] *= 0.9;
    let pushing = table(&|_| -1.0, 1.0);
    let mut uneven = clean.clone();
    uneven
        .iter_mut()
        .enumerate()
        .for_each(|(i, row)| row[3] *= 1.0 + 0.1 * (1.0 - 2.0 * (i / 2 % 2) as f64) * (i % 2) as f64);
    for (rows, expected) in [
        (&clean, None),
        (&fast, Some("implausible-speed")),
        (&small, Some("unphysical-drag-coefficient")),
        (&contradicting, Some("speed-contradicts-velocity")),
        (&uneven, Some("uneven-scatter")),
        (&pushing, Some("negative-drag")),
    ] {
        let ahead = codes(&written(rows, 1.0));
        assert!(expected.is_none_or(|code| ahead.iter().any(|c| c == code)), "{expected:?}: {ahead:?}");
        assert_eq!(codes(&written(rows, -1.0)), ahead);
    }
    let mixed = table(&|i| if i % 2 == 1 { 101.97 } else { 1.0 }, 1.0);
    for way in [1.0, -1.0] {
        let said = refusal(&[("t.csv", &written(&mixed, way))], &["identify", "t.csv"]);
        assert!(said.contains("gram-force"), "{said}");
    }
}

/// At one magnitude of drift v_x v_y and v_y |v_y| have one shape.
#[test]
fn one_magnitude_of_drift_leaves_the_quadratic_law_a_candidate() {
    let rows: Vec<Row> =
        drift_test(14).into_iter().filter(|r| r.angle_deg == 0.0 || r.angle_deg.abs() == 10.0).collect();
    let text = table("speed [m/s],angle [deg],f_x [N],f_y [N],m_z [N m]", &rows, |r| {
        format!("{},{},{},{},{}", r.speed, r.angle_deg, r.f_x, r.f_y, r.m_z)
    });
    let out = json(&[("t.csv", &text)], &["identify", "t.csv"]);
    let quadratic = estimate(&out, "quadratic");
    assert_eq!(quadratic["law"]["outputs"]["m_z"]["formula"], "N_uv*v_x*v_y");
    // N_uv stands for the moment at that angle: m_z = N_uv u v + N_vv v|v| with |v| = u tan 10°.
    let whole = N_UV + N_VV * f64::to_radians(10.0).tan();
    assert!((value(quadratic, "N_uv") / whole - 1.0).abs() < 0.02, "{}", quadratic["coefficients"]);
    assert_eq!(recommended(&out)["law"]["name"], "quadratic", "{}", recommended(&out)["reason"]);
}

#[test]
fn a_reference_point_is_printed_where_somebody_named_one() {
    let text = "speed [m/s],f_x [N]\n0.1,-0.5\n0.2,-2.0\n0.3,-4.4\n0.4,-8.1\n0.5,-12.4\n";
    let campaign = |body: &str| {
        format!("schema = 1\nname = \"x\"\n{body}[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\n")
    };
    let of = |body: &str| {
        let folder = folder_of(&[("t.csv", text), ("c.toml", &campaign(body))]);
        let out = json_in(folder.path(), &["identify", "c.toml"]);
        let html = std::fs::read_to_string(folder.path().join("c-results/report.html")).unwrap();
        (recommended(&out)["point"]["words"].as_str().unwrap().to_owned(), html)
    };
    let (point, html) = of("");
    assert!(point.is_empty() && !html.contains("Reference point") && !html.contains("body centre"), "{point}");
    let (point, html) = of("[body]\nreference_point = \"midships, on the keel\"\n");
    assert_eq!(point, "midships, on the keel");
    assert!(html.contains("<dt>Reference point</dt><dd>midships, on the keel</dd>"));
}

/// Six speeds at nine angles, each run twice, and no speed measured twice as the same number; a seventh was run straight ahead only.
#[test]
fn a_drift_figure_draws_every_speed() {
    let mut noise = noise(9);
    let mut text = "speed [m/s],angle [deg],f_x [N],f_y [N]\n".to_owned();
    for speed in [0.3, 0.5, 0.7, 0.9, 1.1, 1.3] {
        for i in -4..=4 {
            for _ in 0..2 {
                let (speed, angle) = (speed * (1.0 + 0.003 * noise()), 5.0 * f64::from(i) + 0.05 * noise());
                let (sin, cos) = f64::to_radians(angle).sin_cos();
                let (u, v) = (speed * cos, -speed * sin);
                writeln!(
                    text,
                    "{speed},{angle},{},{}",
                    -5.0 * u * u + 0.01 * noise(),
                    -90.0 * v * v.abs() + 0.01 * noise()
                )
                .unwrap();
            }
        }
    }
    text += "1.7,0,-14.45,0.0\n1.7,0,-14.46,0.01\n";
    let folder = folder_of(&[("t.csv", &text)]);
    json_in(folder.path(), &["identify", "t.csv", "--models", "quadratic"]);
    let html = std::fs::read_to_string(folder.path().join("t-results/report.html")).unwrap();
    let figure = html.split("<figure").find(|part| part.contains("f_y against angle")).unwrap();
    for speed in ["0.3 m/s", "0.5 m/s", "0.7 m/s", "0.9 m/s", "1.1 m/s", "1.3 m/s", "other speeds"] {
        assert!(figure.contains(speed), "{speed} is not in the legend");
    }
    assert!(!figure.contains("not drawn"), "every point is drawn");
}

/// Codes of what this file is about: none of them may be heard from a clean table.
const ALARMS: [&str; 4] = ["column-not-used", "angle-contradicts-velocity", "tare-straight-ahead", "angle-in-radians"];

#[test]
fn clean_tables_and_the_examples_raise_no_alarm() {
    let heard = |out: &Value| -> Vec<String> {
        ALARMS
            .iter()
            .flat_map(|code| findings(out, code))
            .map(|(severity, message)| format!("{severity}: {message}"))
            .collect()
    };
    for seed in 0..20 {
        let rows = drift_test(100 + seed);
        let drift = table("speed [m/s],angle [deg],f_x [N],f_y [N],m_z [N m],repeat [1],run", &rows, |r| {
            format!("{},{},{},{},{},1,{}", r.speed, r.angle_deg, r.f_x, r.f_y, r.m_z, r.speed)
        });
        let velocity = table("v_x [m/s],v_y [m/s],f_x [N],f_y [N]", &rows, |r| {
            let (sin, cos) = r.angle_deg.to_radians().sin_cos();
            format!("{},{},{},{}", r.speed * cos, -r.speed * sin, r.f_x, r.f_y)
        });
        let ahead = table("speed [m/s],f_x [N],std_f_x [N],temperature [degC]", &rows, |r| {
            format!("{},{},0.02,15", r.speed, -10.0 * r.speed * r.speed + 0.01 * r.angle_deg / 20.0)
        });
        for text in [&drift, &velocity, &ahead] {
            let out = json(&[("t.csv", text)], &["inspect", "t.csv"]);
            assert!(heard(&out).is_empty(), "{seed}: {:?}", heard(&out));
        }
    }
    let examples = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples");
    for (name, notes) in [("unh-rm2/tare.toml", 0), ("unh-rm2/rotor.toml", 2), ("mamba-added-mass/campaign.toml", 0)] {
        let path = examples.join(name);
        let out = json(&[], &["inspect", path.to_str().unwrap()]);
        // The rotor's sidecar takes four columns of a wide table, one of which no law has: both are noted, and that is all.
        assert!(heard(&out).iter().all(|text| text.starts_with("note: ")), "{name}: {:?}", heard(&out));
        assert_eq!(heard(&out).len(), notes, "{name}: {:?}", heard(&out));
    }
}

/// A slip in the name of a coefficient would leave free what is meant to be held, and every interval would look better.
#[test]
fn a_coefficient_of_no_law_is_held_by_none_and_said() {
    let mut table = "speed [m/s],f_x [N]\n".to_owned();
    for i in 1..=12 {
        let u = 0.1 * f64::from(i);
        writeln!(table, "{u},{}", -(3.0 * u + 14.0 * u * u) - 0.01 * (7.0 * u).sin()).unwrap();
    }
    let campaign = |identify: &str| {
        format!(
            "schema = 1\nname = \"x\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"tank\"\nkind = \"towing\"\ntable = \"t.csv\"\n\
             models = [\"linear_quadratic\"]\n[identify]\n{identify}\n"
        )
    };
    for (key, text) in [
        ("known", "known = [{ coefficient = \"D_x_l\", value = \"3 kg/s\", standard_uncertainty = \"0.1 kg/s\" }]"),
        ("prior", "prior = [{ coefficient = \"D_x_l\", value = \"3 kg/s\", standard_uncertainty = \"0.1 kg/s\" }]"),
        ("fixed", "fixed = { D_x_l = \"3 kg/s\" }"),
        ("exclude", "exclude = [\"D_x_l\"]"),
    ] {
        let said = refusal(&[("t.csv", &table), ("c.toml", &campaign(text))], &["identify", "c.toml"]);
        assert!(said.contains(&format!("`{key}` names \"D_x_l\"")) && said.contains("did you mean `D_x_I`"), "{said}");
        assert!(said.contains(if key == "exclude" { "[identify]" } else { "c.toml:11:" }), "{said}");
    }
    // Of other laws than the campaign's it is a warning: its own have the coefficient.
    let files = [("t.csv", table.as_str()), ("c.toml", &campaign("fixed = { D_x_I = \"3 kg/s\" }"))];
    let out = json(&files, &["identify", "c.toml", "--models", "quadratic"]);
    assert_eq!(findings(&out, "held-by-no-law").len(), 1);
    assert_eq!(findings(&json(&files, &["identify", "c.toml"]), "held-by-no-law").len(), 0);
}

#[test]
fn symbols_below_names_are_not_taken_for_units() {
    let table = "Length;Mass;Volume\nL;m;V\n1,5;2,5;3,5\n1,6;2,6;3,6\n";
    let said = refusal(&[("t.csv", table)], &["inspect", "t.csv"]);
    assert!(said.starts_with("froude: t.csv:2: `L` below `Length` can be a symbol or a unit"), "{said}");
    let stated = |line: usize| format!("schema = 1\n[file]\nunits = {line}\n");
    let said = refusal(&[("t.csv", table), ("t.toml", &stated(0))], &["inspect", "t.csv"]);
    assert!(said.contains("column `L` has no unit"), "{said}");
    let read = json(&[("t.csv", table), ("t.toml", &stated(2))], &["inspect", "t.csv"]);
    assert_eq!(read["columns"][1]["unit"], "m");
    for sound in [
        "Time;Heave\ns;m\n",
        "t;x\ns;m\n",
        "Time;Tension\ns;N\n",
        "Volt;Ampere\nV;A\n",
        "Seconds;Newton\ns;N\n",
        "Zeit;Kraft\ns;N\n",
    ] {
        let folder = folder_of(&[("t.csv", &format!("{sound}1,5;2,5\n1,6;2,6\n"))]);
        let said = froude(folder.path(), &["inspect", "t.csv"]);
        assert!(!String::from_utf8_lossy(&said.stderr).contains("symbol"), "{sound}: {said:?}");
    }
}

#[test]
fn a_table_of_a_quantity_per_row_is_named_as_one() {
    let table = "time [s],channel,value\n0,speed,1\n0,force,2\n1,speed,1.2\n1,force,2.4\n";
    let said = refusal(&[("t.csv", table)], &["inspect", "t.csv"]);
    assert!(
        said.contains("each row holds one of several quantities, which column `channel` names (speed, force)"),
        "{said}"
    );
    assert!(said.contains("df.pivot(index=…, columns=\"channel\", values=\"value\")"), "{said}");
}
