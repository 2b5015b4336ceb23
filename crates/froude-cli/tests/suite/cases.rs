//! Small inputs as people write them, with known answers, at the verbs that their owners would run.

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use serde_json::Value;

use crate::bench::{froude, text};

/// A copy of some inputs in a folder of their own.
fn copied(names: &[&str]) -> (tempfile::TempDir, Vec<PathBuf>) {
    let folder = tempfile::tempdir().unwrap();
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures/cases");
    let copy = |name: &&str| {
        let to = folder.path().join(name);
        std::fs::copy(from.join(name), &to).unwrap();
        to
    };
    let paths = names.iter().map(copy).collect();
    (folder, paths)
}

fn done(arguments: &[&str]) -> String {
    let output = froude(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// That the intervals of the recommended, or only, estimate hold the truth, and are at most `widest` of it on each side.
fn holds(record: &Value, model: &str, truth: &[(&str, f64)], widest: f64) {
    let estimates = record["estimates"].as_array().unwrap();
    let estimate = estimates.iter().find(|e| e["id"].as_str().unwrap().ends_with(&format!("/{model}"))).unwrap();
    for (name, truth) in truth {
        let c = &estimate["coefficients"][*name];
        let [low, high] = [0, 1].map(|k| c["interval_95"][k].as_f64().unwrap_or_else(|| panic!("{name}: {c}")));
        assert!(low <= *truth && *truth <= high, "{name}: [{low}, {high}] without {truth}");
        assert!(high - low < 2.0 * widest * truth.abs().max(1.0), "{name}: [{low}, {high}]");
    }
}

/// Four exports of one workbook: what stops each is named at once, the proposed sidecar reads it, and the derivatives are right.
#[test]
fn drift_tests_out_of_a_workbook_become_derivatives_in_three_commands() {
    let truth = [("D_x_II", 4.2), ("D_y_I", 6.0), ("Y_uv", -28.0), ("D_y_II", 115.0), ("N_v", -1.5), ("N_uv", -14.0)];
    for (name, understood) in [
        ("drift-utf8-bom.csv", "cells separated by semicolons, decimal comma, units in line 2"),
        (
            "drift-cp1252.csv",
            "text in windows-1252 (by its letters), cells separated by semicolons, decimal comma, units in line 2",
        ),
        ("drift-utf16.csv", "text in UTF-16LE, cells separated by semicolons, decimal comma, units in line 2"),
        ("drift.xlsx", "units in row 2"),
    ] {
        let (_folder, paths) = copied(&[name]);
        let table = text(&paths[0]);
        let refused = froude(&["inspect", table]);
        assert_eq!(refused.status.code(), Some(2));
        let told = String::from_utf8(refused.stderr).unwrap();
        for part in ["is it speed?", "is it angle?", "is it f_x?", "is it f_y?", "is it m_z?", "--write-sidecar"] {
            assert!(told.contains(part), "{part}: {told}");
        }
        done(&["inspect", table, "--write-sidecar"]);
        let record: Value = serde_json::from_str(&done(&["identify", table, "--json"])).unwrap();
        let said = record["findings"].as_array().unwrap().iter().find(|f| f["code"] == "foreign-table").unwrap();
        assert!(said["message"].as_str().unwrap().ends_with(&format!("was read as: {understood}")), "{said}");
        holds(&record, "linear_quadratic", &truth, 0.2);
    }
}

#[test]
fn drift_tests_with_lift_are_recovered_with_and_without_repeats() {
    let (_folder, paths) = copied(&["lift.csv", "lift-no-repeats.csv"]);
    for table in &paths {
        let record: Value = serde_json::from_str(&done(&["identify", text(table), "--json"])).unwrap();
        let truth = [("D_x_II", 4.2), ("D_y_I", 6.0), ("Y_uv", -28.0), ("D_y_II", 115.0)];
        holds(&record, "linear_quadratic", &truth, 0.4);
    }
}

#[test]
fn letters_of_sname_head_columns_and_stand_in_formulas() {
    let (folder, _) = copied(&["sname.csv"]);
    let campaign = folder.path().join("c.toml");
    std::fs::write(
        &campaign,
        "schema = 1\nname = \"sname\"\n[[source]]\nname = \"t\"\nkind = \"tank\"\ntable = \"sname.csv\"\n[identify]\nmodels = [\"own\"]\n\
         [[identify.model]]\nname = \"own\"\nf_x = \"X_uu*u*abs(u)\"\nf_y = \"Y_uv*u*v + Y_ur*u*r\"\nm_z = \"N_uv*u*v + N_ur*u*r\"\n",
    )
    .unwrap();
    let record: Value = serde_json::from_str(&done(&["identify", text(&campaign), "--json"])).unwrap();
    let truth = [("X_uu", -10.0), ("Y_uv", -60.0), ("Y_ur", 8.0), ("N_uv", -20.0), ("N_ur", -12.0)];
    holds(&record, "own", &truth, 0.2);
}

#[test]
fn laws_by_name_have_the_terms_of_the_table() {
    let (_folder, paths) = copied(&["lift.csv", "lift-no-repeats.csv", "sname.csv"]);
    let lift = [("X_uu", -4.2), ("Y_v", -6.0), ("Y_uv", -28.0), ("Y_vv", -115.0), ("N_v", -1.5), ("N_uv", -14.0)];
    let sname = [("X_uu", -10.0), ("Y_uv", -60.0), ("Y_ur", 8.0), ("N_uv", -20.0), ("N_ur", -12.0)];
    for (table, law, truth) in
        [(&paths[0], "oblique", &lift[..]), (&paths[1], "oblique", &lift[..4]), (&paths[2], "torpedo", &sname[..])]
    {
        let record: Value = serde_json::from_str(&done(&["identify", text(table), "--models", law, "--json"])).unwrap();
        holds(&record, law, truth, 0.5);
        let findings = record["findings"].to_string();
        assert_eq!(findings.contains("N_v, N_uv, N_vv (no column m_z)"), table.ends_with("lift-no-repeats.csv"));
    }
}

/// The thruster law is chosen by the columns alone and gives both directions, both dead bands and the inverse; a thrust that drives the body is no error. A miss: the interval of the dead band
/// ahead begins at 0.611 V for this table, and 0.6 V was put in. `named_laws` in `froude-identify` counts how often such intervals hold the truth.
#[test]
fn a_thruster_over_volts_gives_both_directions_and_the_command_for_a_thrust() {
    let (_folder, paths) = copied(&["thruster.csv"]);
    let told = done(&["identify", text(&paths[0])]);
    for part in ["dead_band_ahead", "Command for a load in still water"] {
        assert!(told.contains(part), "{part}: {told}");
    }
    assert!(!told.contains("ERROR"), "{told}");
    let record: Value = serde_json::from_str(&done(&["identify", text(&paths[0]), "--json"])).unwrap();
    let truth = [("T_ahead", 0.32), ("T_astern", 0.25), ("dead_band_astern", 0.6)];
    holds(&record, "thruster", &truth, 0.2);
    let missed = &record["estimates"][0]["coefficients"]["dead_band_ahead"]["interval_95"];
    let [low, high] = [0, 1].map(|k| missed[k].as_f64().unwrap());
    assert!((low - 0.6111).abs() < 5e-5 && (high - 0.7588).abs() < 5e-5, "{missed}");
}

#[test]
fn a_servo_log_of_rounded_stamps_says_how_they_were_read() {
    let (folder, paths) = copied(&["axis-60hz-ms.csv"]);
    std::fs::write(
        folder.path().join("axis-60hz-ms.toml"),
        "schema = 1\n[constants]\ndrive_gain = \"35 N/V\"\n[columns]\n\"time [s]\" = { name = \"time\" }\n\"position [m]\" = { name = \"position\" }\n\
         \"command [V]\" = { name = \"command\" }\n",
    )
    .unwrap();
    let record: Value = serde_json::from_str(&done(&["identify", text(&paths[0]), "--json"])).unwrap();
    holds(&record, "servo_symmetric", &[("M", 12.0), ("F_v", 30.0), ("F_c", 4.0)], 0.3);
    let findings = record["findings"].to_string();
    assert!(findings.contains("the stamps are rounded to 1 ms"), "{findings}");
}

/// `script` of Debian's bsdutils gives the program a terminal.
#[test]
fn a_number_that_can_be_two_is_asked_at_a_terminal_and_the_answer_kept() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("t.csv"), "speed [m/s];f_x [N]\n1,250;-2\n1,500;-3\n").unwrap();
    let at_terminal = |typed: &str| {
        let command = format!("'{}' inspect t.csv", env!("CARGO_BIN_EXE_froude"));
        let mut child = Command::new("script")
            .args(["-qec", &command, "/dev/null"])
            .current_dir(folder.path())
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(typed.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        (output.status.code(), String::from_utf8(output.stdout).unwrap())
    };
    let sidecar = folder.path().join("t.toml");
    let (code, told) = at_terminal("\n");
    assert!(code == Some(2) && told.contains("1) 1.250") && told.contains("2) 1250") && !sidecar.exists(), "{told}");
    let (code, told) = at_terminal("1\n");
    assert_eq!(code, Some(0), "{told}");
    assert_eq!(std::fs::read_to_string(&sidecar).unwrap(), "schema = 1\n[file]\ndecimal = \",\"\n");
    let read = done(&["inspect", text(&folder.path().join("t.csv")), "--csv"]);
    assert!(read.contains("speed,m/s,1.25,1.5"), "{read}");
    // Nobody is asked where nobody is there.
    std::fs::remove_file(&sidecar).unwrap();
    let refused = froude(&["inspect", text(&folder.path().join("t.csv"))]);
    assert_eq!(refused.status.code(), Some(2));
}

/// The record that `identify` prints of a table, and the message of one of its findings.
fn identified(table: &Path) -> Value {
    serde_json::from_str(&done(&["identify", text(table), "--json"])).unwrap()
}

fn finding<'r>(record: &'r Value, code: &str) -> &'r str {
    let all = record["findings"].as_array().unwrap();
    let found = all.iter().find(|finding| finding["code"] == code);
    found.and_then(|finding| finding["message"].as_str()).unwrap_or_else(|| panic!("{code} is not in {all:?}"))
}

#[test]
fn a_cell_that_was_not_zeroed_is_reported_with_its_offset() {
    let (_folder, paths) = copied(&["zero-norest.csv", "zero-rest.csv"]);
    for (table, rest) in paths.iter().zip(["", "at rest it reads −0.843 N (1 row)"]) {
        let record = identified(table);
        let said = finding(&record, "load-at-rest");
        assert!(said.contains("a constant of −0.84 N is significant (p < 0.001)") && said.contains(rest), "{said}");
    }
}

#[test]
fn axes_that_were_towed_one_at_a_time_are_each_fitted_by_their_own_rows() {
    let (_folder, paths) = copied(&["idle-zeros.csv", "idle-blank.csv"]);
    let records: Vec<Value> = paths.iter().map(|table| identified(table)).collect();
    for record in &records {
        holds(record, "quadratic", &[("D_x_II", 55.0), ("D_y_II", 98.0), ("D_z_II", 120.0)], 0.05);
    }
    assert_eq!(records[0]["estimates"][0]["coefficients"], records[1]["estimates"][0]["coefficients"]);
}

#[test]
fn a_row_that_decides_the_fit_is_named_and_the_true_law_is_accepted() {
    let (folder, paths) = copied(&["weights-fit.csv", "weights-new.csv"]);
    let out = folder.path().join("out");
    done(&["identify", text(&paths[0]), "--out", text(&out)]);
    let record: Value = serde_json::from_slice(&std::fs::read(out.join("estimate.json")).unwrap()).unwrap();
    holds(&record, "quadratic", &[("D_x_II", 3.0)], 0.02);
    let said = finding(&record, "one-row-dominates");
    assert!(said.contains("line 2") && said.contains("leverage 98 %"), "{said}");
    let predicted = done(&["predict", text(&out.join("estimate.json")), text(&paths[1])]);
    assert!(predicted.contains("no more than its errors and its scatter together explain"), "{predicted}");
}

#[test]
fn a_column_of_the_table_wins_over_an_alias_of_its_letter() {
    let (folder, _) = copied(&["own-column.csv"]);
    let campaign = folder.path().join("c.toml");
    std::fs::write(
        &campaign,
        "schema = 1\nname = \"pressure\"\n[[source]]\nname = \"t\"\nkind = \"tank\"\ntable = \"own-column.csv\"\n[identify]\nmodels = [\"own\"]\n\
         [[identify.model]]\nname = \"own\"\nf_x = \"A*p\"\n",
    )
    .unwrap();
    let record = identified(&campaign);
    holds(&record, "own", &[("A", 0.01)], 0.01);
    assert!(record["findings"].to_string().contains("alias"), "{}", record["findings"]);
}

#[test]
fn a_slow_row_that_does_not_belong_is_named() {
    let (_folder, paths) = copied(&["outlier.csv"]);
    let record = identified(&paths[0]);
    holds(&record, "quadratic", &[("D_x_II", 12.0)], 0.02);
    assert!(finding(&record, "outlying-row").contains("line 4 (0.4 m/s)"));
}

#[test]
fn two_tables_are_compared_load_by_load() {
    let (folder, paths) = copied(&["compare-a.csv", "compare-b.csv"]);
    let records = paths.iter().enumerate().map(|(k, table)| {
        let out = folder.path().join(k.to_string());
        done(&["identify", text(table), "--out", text(&out)]);
        out.join("estimate.json")
    });
    let records: Vec<PathBuf> = records.collect();
    let compared = done(&["compare", text(&records[0]), text(&records[1])]);
    // E_n of rows of a load, by its last cell.
    let e_n = |load: &str| -> Vec<f64> {
        let rows = compared.lines().filter(|line| line.trim_start().starts_with(load));
        rows.filter_map(|row| row.split_whitespace().next_back()?.replace('−', "-").parse().ok()).collect()
    };
    assert!(e_n("f_x [N]").iter().all(|e_n| *e_n > 3.0), "{compared}");
    assert!(e_n("f_y [N]").iter().chain(&e_n("m_z [N m]")).all(|e_n| e_n.abs() < 1.0), "{compared}");
    assert!(!e_n("f_y [N]").is_empty() && !e_n("m_z [N m]").is_empty(), "{compared}");
}
