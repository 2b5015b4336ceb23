//! What a fit, a prediction and a comparison say of tables whose truth is known, end to end.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn froude(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_froude")).args(args).current_dir(folder).output().unwrap()
}

fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

fn json(output: &Output) -> Value {
    assert_eq!(output.status.code(), Some(0), "{}", said(output));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn written(folder: &Path, files: &[(&str, &str)]) {
    for (name, text) in files {
        std::fs::write(folder.join(name), text).unwrap();
    }
}

fn coefficient(estimate: &Value, name: &str) -> f64 {
    estimate["coefficients"][name]["value"].as_f64().unwrap_or_else(|| panic!("no {name} in {estimate}"))
}

/// Texts of the findings with a code.
fn findings(out: &Value, code: &str) -> Vec<String> {
    let all = out["findings"].as_array().unwrap().iter();
    all.filter(|f| f["code"] == code).map(|f| f["message"].as_str().unwrap().to_owned()).collect()
}

/// A piston: f_x = A p with A = 0.0100 m², beside a roll rate that has nothing to do with it.
const PISTON: &str = "\
v_x [m/s],w_x [rad/s],p [Pa],f_x [N]
0.5,0.2563,100,0.9858
0.6,0.2122,200,1.9879
0.7,0.1910,300,2.9579
0.8,0.5301,400,4.0171
0.9,0.5288,500,4.9690
1.0,0.1518,600,5.9739
";

fn with_law(law: &str, more: &str) -> String {
    format!(
        "schema = 1\nname = \"c\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"s\"\nkind = \"towing\"\ntable = \"t.csv\"\n{more}\
         models = [\"own\"]\n[[identify.model]]\nname = \"own\"\n{law}\n"
    )
}

#[test]
fn a_column_of_the_table_is_not_hidden_by_an_alias() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    written(at, &[("t.csv", PISTON), ("c.toml", &with_law("f_x = \"A*p\"", ""))]);
    let out = json(&froude(at, &["--json", "identify", "c.toml"]));
    let estimate = &out["estimates"][0];
    let a = coefficient(estimate, "A");
    // The numbers scatter by 0.02 N about 0.0100 m² times 100 to 600 Pa.
    assert!((a - 0.0100).abs() < 5e-5, "{a}");
    assert_eq!(estimate["coefficients"]["A"]["unit"], "m^2");
    assert_eq!(estimate["law"]["inputs"], serde_json::json!({"p": "Pa"}), "{}", estimate["law"]);
    let notes = findings(&out, "column-like-alias");
    assert!(notes.len() == 1 && notes[0].contains("`p [Pa]`") && notes[0].contains("w_x"), "{notes:?}");

    // The record is evaluated on what it names.
    written(at, &[("new.csv", "v_x [m/s],w_x [rad/s],p [Pa],f_x [N]\n0.5,9,1000,10\n0.7,8,2000,20\n")]);
    let rows = json(&froude(at, &["--json", "predict", "c-results/estimate.json", "new.csv"]));
    let predicted = rows["estimates"][0]["rows"][0]["predicted"].as_f64().unwrap();
    assert!((predicted - 1000.0 * a).abs() < 1e-9, "{predicted}");
    for (table, why) in [
        ("v_x [m/s],w_x [rad/s],f_x [N]\n0.5,9,10\n0.7,8,20\n", "needs the column p"),
        ("v_x [m/s],p [rad/s],f_x [N]\n0.5,9,10\n0.7,8,20\n", "needs the column p"),
    ] {
        written(at, &[("new.csv", table)]);
        let refused = froude(at, &["predict", "c-results/estimate.json", "new.csv"]);
        assert_eq!(refused.status.code(), Some(2), "{}", said(&refused));
        assert!(said(&refused).contains(why), "{}", said(&refused));
    }
}

#[test]
fn a_record_that_reads_the_alias_is_not_evaluated_on_a_column_of_that_letter() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let turns = "v_x [m/s],w_x [rad/s],m_x [N m]\n0.5,1,2.01\n0.5,2,4.02\n0.5,3,5.99\n0.5,4,8.01\n";
    written(at, &[("t.csv", turns), ("c.toml", &with_law("K = \"K_p*p\"", ""))]);
    let out = json(&froude(at, &["--json", "identify", "c.toml"]));
    assert_eq!(out["estimates"][0]["law"]["inputs"], serde_json::json!({"w_x": "1/s"}));
    assert!(findings(&out, "column-like-alias").is_empty());
    let new = "v_x [m/s],w_x [rad/s],p [Pa],m_x [N m]\n0.5,1,700,2\n0.5,2,800,4\n";
    written(at, &[("new.csv", new)]);
    let rows = json(&froude(at, &["--json", "predict", "c-results/estimate.json", "new.csv"]));
    let predicted = rows["estimates"][0]["rows"][0]["predicted"].as_f64().unwrap();
    assert!((predicted - 2.0).abs() < 0.02, "{predicted}");
}

#[test]
fn keep_and_the_budget_name_the_column_of_the_table_too() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let more =
        "keep = \"p <= 400 Pa\"\n[[source.uncertainty]]\nquantity = \"p\"\nstandard = \"2 %\"\nshared = \"campaign\"\n";
    let (head, tail) = more.split_once('\n').unwrap();
    let campaign = with_law("f_x = \"A*p\"", &format!("{head}\n"));
    let campaign = campaign.replace("[[identify.model]]", &format!("{tail}[[identify.model]]"));
    written(at, &[("t.csv", PISTON), ("c.toml", &campaign)]);
    let out = json(&froude(at, &["--json", "identify", "c.toml"]));
    let estimate = &out["estimates"][0];
    assert!(findings(&out, "kept").iter().any(|t| t.starts_with("4 of 6")), "{}", out["findings"]);
    // 2 % of the pressure is 2 % of the area.
    let type_b = estimate["coefficients"]["A"]["type_b"].as_f64().unwrap();
    assert!((type_b / coefficient(estimate, "A") - 0.02).abs() < 1e-4, "{type_b}");
}

#[test]
fn every_letter_may_be_a_column() {
    for letter in ["u", "v", "w", "p", "q", "r", "X", "Y", "Z", "K", "M", "N"] {
        let folder = tempfile::tempdir().unwrap();
        let at = folder.path();
        let table = format!(
            "v_x [m/s],v_y [m/s],v_z [m/s],w_x [rad/s],w_y [rad/s],w_z [rad/s],f_x [N],f_y [N],f_z [N],m_x [N m],m_y [N m],m_z [N m],{letter} [Pa]\n\
             1,.1,.2,.3,.1,.5,1.01,2,1,2,4,3,100\n1,.2,.1,.2,.5,.1,1.98,5,2,1,6,5,200\n1,.3,.3,.4,.1,.3,3.02,1,7,3,5,2,300\n1,.2,.1,.1,.3,.2,3.99,3,1,2,1,1,400\n"
        );
        let load = if letter == "X" { "f_y" } else { "f_x" };
        let table =
            if letter == "X" { table.replace("f_x", "f_0").replace("f_y", "f_x").replace("f_0", "f_y") } else { table };
        written(at, &[("t.csv", &table), ("c.toml", &with_law(&format!("{load} = \"A*{letter}\""), ""))]);
        let out = json(&froude(at, &["--json", "identify", "c.toml"]));
        let a = coefficient(&out["estimates"][0], "A");
        assert!((a - 0.01).abs() < 1e-4, "{letter}: {a}");
        assert_eq!(findings(&out, "column-like-alias").len(), 1, "{letter}: {}", out["findings"]);
    }
}

/// Drift tests with a yaw moment: f_x of `scale` times -4.2 U|U|, noise without a pattern.
fn drift(scale: f64, seed: f64) -> String {
    let mut out = "speed [m/s],angle [deg],f_x [N],f_y [N],m_z [N m]\n".to_owned();
    let mut i = seed;
    let mut noise = |size: f64| {
        i += 1.0;
        size * ((i * 12.9898).sin() * 43_758.545_3).fract()
    };
    for speed in [0.6, 0.9, 1.2] {
        for angle in [-12.0_f64, -6.0, 0.0, 6.0, 12.0] {
            for _ in 0..2 {
                let (u, v) = (speed * angle.to_radians().cos(), -speed * angle.to_radians().sin());
                let f_x = -4.2 * scale * u * u.abs() + noise(0.03);
                let f_y = -116.0 * v * v.abs() + noise(0.08);
                let m_z = 0.1 * u * v - 8.0 * v * v.abs() + noise(0.03);
                out += &format!("{speed:.4},{angle:.4},{f_x:.4},{f_y:.4},{m_z:.4}\n");
            }
        }
    }
    out
}

#[test]
fn forces_of_laws_with_a_moment_are_compared_load_by_load() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    written(at, &[("a.csv", &drift(1.0, 0.0)), ("b.csv", &drift(1.15, 500.0))]);
    for table in ["a.csv", "b.csv"] {
        json(&froude(at, &["--json", "identify", table]));
    }
    let records = ["a-results/estimate.json", "b-results/estimate.json"];
    let out = json(&froude(at, &["--json", "compare", records[0], records[1]]));
    let loads = out["comparison"]["loads"].as_array().unwrap();
    for (load, unit) in [("f_x", "N"), ("f_y", "N"), ("m_z", "N m")] {
        let rows: Vec<&Value> = loads.iter().filter(|r| r["component"] == load).collect();
        assert_eq!(rows.len(), 25, "{load}");
        assert!(rows.iter().all(|r| r["unit"] == unit), "{}", rows[0]);
    }
    let of = |load: &str| loads.iter().filter(|r| r["component"] == load).collect::<Vec<_>>();
    for row in of("f_x") {
        let ratio = row["second"]["value"].as_f64().unwrap() / row["first"]["value"].as_f64().unwrap();
        // Scatter of 0.03 N of 1.5 N at least, in 30 rows.
        assert!((ratio - 1.15).abs() < 0.02, "{ratio}");
        assert!(row["e_n"].as_f64().unwrap().abs() > 1.0);
    }
    for row in of("f_y").iter().chain(&of("m_z")) {
        assert!(row["e_n"].as_f64().is_none_or(|e| e.abs() < 1.5), "{row}");
    }
    let said = said(&froude(at, &["compare", records[0], records[1]]));
    assert!(said.contains("forces and moments over the common range") && said.contains("m_z [N m]"), "{said}");
}

#[test]
fn a_law_that_predicts_no_load_says_why() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    written(
        at,
        &[
            ("t.csv", PISTON),
            ("c.toml", &with_law("f_x = \"A*p\"", "")),
            ("a.csv", &drift(1.0, 0.0)),
            ("b.csv", &drift(1.0, 9.0)),
        ],
    );
    for input in ["c.toml", "a.csv", "b.csv"] {
        json(&froude(at, &["--json", "identify", input]));
    }
    let of = |name: &str| format!("{name}-results/estimate.json");
    let said = said(&froude(at, &["compare", &of("a"), &of("b"), &of("c")]));
    assert!(
        said.split_whitespace()
            .collect::<Vec<_>>()
            .join(" ")
            .contains("its law needs p, which does not follow from speed and angle"),
        "{said}"
    );
}

#[test]
fn rows_of_the_fit_are_no_validation_and_copies_count_once() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let (a, b) = (drift(1.0, 0.0), drift(1.0, 500.0));
    let twice = format!("{b}{}", b.split_once('\n').unwrap().1);
    let resaved = a.replace("0.6000,", "0.6,").replace(".0000,", ",");
    written(at, &[("a.csv", &a), ("b.csv", &b), ("twice.csv", &twice), ("resaved.csv", &resaved)]);
    json(&froude(at, &["--json", "identify", "a.csv"]));
    let predict = |table: &str| json(&froude(at, &["--json", "predict", "a-results/estimate.json", table]));
    for table in ["a.csv", "resaved.csv"] {
        let why = &predict(table)["estimates"][0]["fitted_to_these_rows"];
        assert!(why.as_str().is_some_and(|why| why.contains("a.csv")), "{table}: {why}");
        let said = said(&froude(at, &["predict", "a-results/estimate.json", table]));
        let said = said.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(said.contains("so this does not validate it"), "{table}: {said}");
    }
    let (once, doubled) = (predict("b.csv"), predict("twice.csv"));
    assert_eq!(once["estimates"][0]["fitted_to_these_rows"], Value::Null);
    assert_eq!(once["estimates"][0]["joint"], doubled["estimates"][0]["joint"]);
    assert_eq!(findings(&doubled, "identical-copies").len(), 1);

    let source = |name: &str, table: &str, role: &str| {
        format!("[[source]]\nname = \"{name}\"\nkind = \"towing\"\ntable = \"{table}\"\n{role}")
    };
    let held = "role = \"validation\"\n";
    let text = format!(
        "schema = 1\nname = \"v\"\n{}{}{}{}",
        source("a", "a.csv", ""),
        source("same", "a.csv", held),
        source("again", "resaved.csv", held),
        source("new", "b.csv", held)
    );
    written(at, &[("v.toml", &text)]);
    let out = json(&froude(at, &["--json", "identify", "v.toml"]));
    let told = findings(&out, "validation-on-fitted-rows");
    assert!(told.len() == 2 && told.iter().all(|t| t.contains("does not validate")), "{told:?}");
    let others = out["findings"].as_array().unwrap().iter().filter(|f| f["source"] == "new").count();
    assert!(others > 0 && !told.iter().any(|t| t.contains("not fitted to")), "{told:?}");
}

/// A position X beside the load: on the left of a formula the letter is the load.
#[test]
fn a_letter_on_the_left_is_the_load_beside_a_column_of_that_name() {
    let folder = tempfile::tempdir().unwrap();
    let at = folder.path();
    let table =
        "v_x [m/s],X [m],f_x [N]\n0.2,1.0,-0.401\n0.4,2.0,-1.598\n0.6,3.0,-3.603\n0.8,4.0,-6.397\n1.0,5.0,-10.002\n";
    written(at, &[("t.csv", table), ("c.toml", &with_law("X = \"-D*v_x*abs(v_x)\"", ""))]);
    let out = json(&froude(at, &["identify", "c.toml", "--json"]));
    let estimate = &out["estimates"][0];
    assert!((coefficient(estimate, "D") - 10.0).abs() < 0.02, "{estimate}");
    assert_eq!(estimate["coefficients"]["D"]["unit"], "kg/m");
    assert_eq!(estimate["law"]["outputs"]["f_x"]["unit"], "N");
    assert_eq!(findings(&out, "column-like-alias"), Vec::<String>::new());
}
