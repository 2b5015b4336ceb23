//! The verbs as a user runs them, end to end.

use std::path::Path;
use std::process::{Command, Output};

fn froude(folder: &Path, args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_froude")).args(args).current_dir(folder).output().unwrap()
}

fn json(output: &Output) -> serde_json::Value {
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

fn example(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples").join(name)
}

#[test]
fn the_demo_writes_both_campaigns_and_says_where_the_reports_lie() {
    let folder = tempfile::tempdir().unwrap();
    let output = froude(folder.path(), &["demo", "here"]);
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    for part in ["mounting frame", "circulation tank twin", "D_x_II", "C_d_II", "report.html"] {
        assert!(said.contains(part), "{part} is not in\n{said}");
    }
    for report in [
        "here/unh-rm2/tare-results/report.html",
        "here/unh-rm2/rotor-results/report.html",
        "here/mamba/campaign-results/report.html",
    ] {
        let html = std::fs::read_to_string(folder.path().join(report)).unwrap();
        assert!(html.starts_with("<!DOCTYPE html>"));
        assert!(html.contains("<svg"));
    }
    // A second demo does not write over the first.
    let again = froude(folder.path(), &["demo", "here"]);
    assert_eq!(again.status.code(), Some(2));
    assert_eq!(
        String::from_utf8_lossy(&again.stderr).trim_end(),
        "froude: here exists and is not empty; name another folder: froude demo DIR"
    );
}

#[test]
fn a_bare_table_gets_polynomials_and_the_power_law() {
    let folder = tempfile::tempdir().unwrap();
    for name in ["Tare-drag.csv", "Tare-drag.toml"] {
        std::fs::copy(example("unh-rm2").join(name), folder.path().join(name)).unwrap();
    }
    let out = json(&froude(folder.path(), &["--json", "identify", "Tare-drag.csv"]));
    let models: Vec<&str> =
        out["estimates"].as_array().unwrap().iter().map(|e| e["law"]["name"].as_str().unwrap()).collect();
    assert_eq!(models, ["quadratic", "linear_quadratic", "power_law"]);
    let k = out["estimates"][0]["coefficients"]["D_x_II"]["value"].as_f64().unwrap();
    // The preparer's figure, printed with four digits.
    assert!((k - 47.83).abs() < 0.005, "{k}");
    assert!(folder.path().join("Tare-drag-results/report.html").exists());
    assert!(folder.path().join("Tare-drag-results/estimate.json").exists());
}

#[test]
fn the_record_obeys_the_published_schema() {
    let folder = tempfile::tempdir().unwrap();
    let out = json(&froude(
        folder.path(),
        &["--json", "identify", example("unh-rm2/tare.toml").to_str().unwrap(), "--out", "results"],
    ));
    let schema: serde_json::Value = serde_json::from_slice(&froude(folder.path(), &["schema"]).stdout).unwrap();
    let validator = jsonschema::validator_for(&schema).unwrap();
    let errors: Vec<String> = validator.iter_errors(&out).map(|e| e.to_string()).collect();
    assert!(errors.is_empty(), "{errors:?}");
    let file: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("results/estimate.json")).unwrap()).unwrap();
    assert_eq!(file, out, "--json prints what estimate.json holds");
}

#[test]
fn the_twin_is_the_same_for_the_same_seed() {
    let folder = tempfile::tempdir().unwrap();
    let mamba = example("mamba");
    std::fs::create_dir_all(folder.path().join("published")).unwrap();
    for name in [
        "campaign.toml",
        "published/circulation_tank_restricted.json",
        "published/cfd.json",
        "published/towing_rig.json",
    ] {
        std::fs::copy(mamba.join(name), folder.path().join(name)).unwrap();
    }
    assert_eq!(froude(folder.path(), &["simulate", "campaign.toml"]).status.code(), Some(0));
    let first = std::fs::read(folder.path().join("tank.csv")).unwrap();
    let refused = froude(folder.path(), &["simulate", "campaign.toml"]);
    assert_eq!(refused.status.code(), Some(2), "an existing table is not replaced unasked");
    assert_eq!(froude(folder.path(), &["simulate", "campaign.toml", "--replace"]).status.code(), Some(0));
    assert_eq!(std::fs::read(folder.path().join("tank.csv")).unwrap(), first);
    // Table 3: 536 runs.
    assert_eq!(String::from_utf8(first).unwrap().lines().count(), 537);
}

#[test]
fn published_sets_are_compared_without_inventing_uncertainty() {
    let published = example("mamba/published");
    let path = |n: &str| published.join(n).to_str().unwrap().to_owned();
    let out = json(&froude(
        &published,
        &[
            "--json",
            "compare",
            &path("cfd.json"),
            &path("circulation_tank_restricted.json"),
            &path("table11_as_printed.json"),
        ],
    ));
    for row in out["comparison"]["coefficients"].as_array().unwrap() {
        assert!(row["e_n"].is_null(), "{row}");
        assert!(row["note"].as_str().unwrap().starts_with("no uncertainty stated by "), "{row}");
        let model = |id: &serde_json::Value| {
            id["source"].as_str().unwrap().split(' ').next().unwrap().rsplit('/').next().unwrap().to_owned()
        };
        assert_eq!(model(&row["first"]), model(&row["second"]), "only equal models are compared");
    }
    let contradictions: Vec<&str> = out["findings"]
        .as_array()
        .unwrap()
        .iter()
        .filter(|f| f["code"] == "contradiction")
        .map(|f| f["message"].as_str().unwrap())
        .collect();
    assert_eq!(contradictions.len(), 1, "{contradictions:?}");
    assert!(contradictions[0].contains("C_d: 0.3268 and 0.3628 differ by two exchanged digits"), "{contradictions:?}");
}

/// Identifies the tare drag in `folder`, its forces times `factor`, and gives the record.
fn tare_record(folder: &Path, name: &str, factor: f64) -> String {
    let table = std::fs::read_to_string(example("unh-rm2/Tare-drag.csv")).unwrap();
    let mut lines = table.lines();
    let header = lines.next().unwrap();
    let place = header.split(',').position(|h| h.trim() == "tare_drag").unwrap();
    let mut out = header.to_owned() + "\n";
    for line in lines {
        let cells: Vec<String> =
            line.split(',')
                .enumerate()
                .map(|(i, cell)| {
                    if i == place {
                        (factor * cell.trim().parse::<f64>().unwrap()).to_string()
                    } else {
                        cell.to_owned()
                    }
                })
                .collect();
        out += &(cells.join(",") + "\n");
    }
    std::fs::write(folder.join(format!("{name}.csv")), out).unwrap();
    std::fs::copy(example("unh-rm2/Tare-drag.toml"), folder.join(format!("{name}.toml"))).unwrap();
    assert_eq!(froude(folder, &["identify", &format!("{name}.csv")]).status.code(), Some(0));
    format!("{name}-results/estimate.json")
}

#[test]
fn compared_columns_carry_the_name_of_their_source_and_fit_on_a_page() {
    let folder = tempfile::tempdir().unwrap();
    let (monday, friday) =
        (tare_record(folder.path(), "monday", 1.0), tare_record(folder.path(), "friday_with_a_much_longer_name", 1.02));
    let output = froude(folder.path(), &["compare", &monday, &friday]);
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let head = said.lines().find(|l| l.contains("coefficient") && l.contains("unit")).unwrap();
    assert!(head.contains("monday.csv/quadratic") && head.contains("friday_with_") && head.contains("E_n"), "{head}");
    assert!(!head.contains("value"), "{head}");
    for line in said.lines().filter(|l| !l.contains("  [")) {
        assert!(line.chars().count() <= 120, "{} columns: {line}", line.chars().count());
    }
    let forces = said.split("Predicted force").nth(1).unwrap();
    let head = forces.lines().skip_while(|l| !l.contains("load")).take_while(|l| !l.contains("══"));
    let head = head.collect::<Vec<_>>().join(" ");
    assert!(!head.contains("links") && ["speed", "[m/s]", "[N]"].iter().all(|word| head.contains(word)), "{head}");
    assert!(forces.contains("± U: expanded uncertainty, 95 %, U = k·u"), "{forces}");
    assert!(forces.contains("Student's t, effective degrees of freedom"), "{forces}");
    // The demo's published sets belong to a body with links, and there are many of them.
    let published = example("mamba/published");
    let sets = ["cfd.json", "circulation_tank_restricted.json", "towing_rig.json", "table10_as_printed.json"];
    let args: Vec<&str> = ["compare", "--all"].into_iter().chain(sets).collect();
    let said = String::from_utf8_lossy(&froude(&published, &args).stdout).into_owned();
    let heads: Vec<&str> = said.lines().filter(|l| l.contains("load") && l.contains("links")).collect();
    assert!(heads.len() > 1, "wrapped by block:\n{said}");
    let widest = said.lines().filter(|l| l.contains("f_x  ") || l.contains("──")).map(|l| l.chars().count()).max();
    assert!(widest.unwrap() <= 120, "{widest:?}");
}

#[test]
fn a_record_compared_with_itself_is_no_evidence() {
    let folder = tempfile::tempdir().unwrap();
    let record = tare_record(folder.path(), "monday", 1.0);
    std::fs::copy(folder.path().join(&record), folder.path().join("copy.json")).unwrap();
    let said = String::from_utf8_lossy(&froude(folder.path(), &["compare", &record, "copy.json"]).stdout).into_owned();
    assert!(said.contains("same data: not independent, E_n not meaningful"), "{said}");
    assert!(said.contains("[same-data]"), "{said}");
    let out = json(&froude(folder.path(), &["--json", "compare", &record, "copy.json"]));
    for row in out["comparison"]["coefficients"].as_array().unwrap() {
        assert!(row["e_n"].is_null(), "{row}");
        assert_eq!(row["note"], "same data: not independent, E_n not meaningful");
    }
    for row in out["comparison"]["joint"].as_array().unwrap() {
        assert!(row["chi_squared"].is_null() && row["note"].as_str().unwrap().starts_with("same data"), "{row}");
    }
    for row in out["comparison"]["loads"].as_array().unwrap() {
        assert!(row["n_links"].is_null() && row["e_n"].is_null(), "{row}");
        assert!(row["first"]["coverage_factor"].as_f64().unwrap() > 1.96, "{row}");
    }
    // A repeat of the test on another day is independent.
    let other = tare_record(folder.path(), "tuesday", 1.02);
    let out = json(&froude(folder.path(), &["--json", "compare", &record, &other]));
    let c = &out["comparison"];
    assert!(c["coefficients"][0]["e_n"].is_number() && c["joint"][0]["chi_squared"].is_number(), "{out}");
}

/// A model that the other record lacks is not passed over: `compare` says that it stands alone.
#[test]
fn what_compare_sets_beside_nothing_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let monday = tare_record(folder.path(), "monday", 1.0);
    tare_record(folder.path(), "tuesday", 1.02);
    let args = ["--json", "identify", "tuesday.csv", "--models", "quadratic", "--out", "short"];
    assert_eq!(froude(folder.path(), &args).status.code(), Some(0));
    let out = json(&froude(folder.path(), &["--json", "compare", &monday, "short/estimate.json"]));
    let said = |f: &&serde_json::Value| f["code"] == "beside-no-other";
    let finding =
        out["findings"].as_array().unwrap().iter().find(said).unwrap()["message"].as_str().unwrap().to_owned();
    assert!(finding.contains("/power_law (power_law): no other source has its model"), "{finding}");
    let both = json(&froude(folder.path(), &["--json", "compare", &monday, "tuesday-results/estimate.json"]));
    assert!(both["findings"].as_array().unwrap().iter().all(|f| f["code"] != "beside-no-other"), "{both}");
}

#[test]
fn a_comparison_is_a_record_and_a_report_where_a_folder_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let records = [tare_record(folder.path(), "monday", 1.0), tare_record(folder.path(), "tuesday", 1.02)];
    let out = json(&froude(folder.path(), &["--json", "compare", &records[0], &records[1], "--out", "both"]));
    let read = |name: &str| std::fs::read_to_string(folder.path().join("both").join(name)).unwrap();
    assert_eq!(serde_json::from_str::<serde_json::Value>(&read("estimate.json")).unwrap(), out);
    assert!(out["estimates"].as_array().unwrap().is_empty() && out["data"]["d2"]["role"] == "record", "{out}");
    let e_n = out["comparison"]["coefficients"][0]["e_n"].as_f64().unwrap();
    let page = read("report.html");
    assert!(
        page.contains("Normalised differences") && page.contains(" estimates side by side"),
        "{}",
        &page[page.find("<h1").unwrap()..][..300]
    );
    assert!(page.contains(&froude::records::number::fixed(e_n, 2)), "{e_n}");
    // Whether they agree is the first thing that is said.
    assert!(page.contains(" agree within their uncertainties: largest E_n of the forces "), "{e_n}");
    assert_eq!(out["comparison"]["verdicts"][0]["agree"], true);
    let far = tare_record(folder.path(), "wednesday", 1.5);
    let said = String::from_utf8_lossy(&froude(folder.path(), &["compare", &records[0], &far]).stdout).into_owned();
    let first = said.split_whitespace().collect::<Vec<_>>().join(" ");
    let verdict = " differ by more than their uncertainties: largest E_n of the forces ";
    assert!(first.starts_with("monday.csv/") && first.contains(verdict), "{said}");
    assert!(inspect(folder.path(), "both/estimate.json").0.starts_with("estimate"));
    // The folder of what is compared is not taken.
    let out = froude(folder.path(), &["compare", &records[0], &records[1], "--out", "monday-results"]);
    let said = String::from_utf8_lossy(&out.stderr).into_owned();
    assert!(out.status.code() == Some(2) && said.contains("which is read: results there would replace it"), "{said}");
    // An error of a record goes with it.
    let text = std::fs::read_to_string(folder.path().join(&records[1])).unwrap();
    let mut record: serde_json::Value = serde_json::from_str(&text).unwrap();
    record.as_object_mut().unwrap().remove("checksum");
    record["findings"] =
        serde_json::json!([{"severity": "error", "code": "calibration-impossible", "message": "the gear"}]);
    std::fs::write(folder.path().join("faulty.json"), record.to_string()).unwrap();
    let out = json(&froude(folder.path(), &["--json", "compare", &records[0], "faulty.json"]));
    let is_said =
        |f: &serde_json::Value| f["code"] == "record-with-errors" && f["message"].to_string().contains("the gear");
    assert!(out["findings"].as_array().unwrap().iter().any(is_said), "{}", out["findings"]);
    // Without a folder nothing is written.
    let before = std::fs::read_dir(folder.path()).unwrap().count();
    froude(folder.path(), &["compare", &records[0], &records[1]]);
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), before);
}

/// What `inspect` prints, and the same as JSON.
fn inspect(folder: &Path, file: &str) -> (String, serde_json::Value) {
    let said = String::from_utf8(froude(folder, &["inspect", file]).stdout).unwrap();
    for line in said.lines().take_while(|line| *line != "Findings") {
        assert!(line.chars().count() <= 120, "wider than 120 columns: {line}");
    }
    (said, json(&froude(folder, &["--json", "inspect", file])))
}

#[test]
fn inspect_shows_the_sources_of_a_campaign() {
    let folder = tempfile::tempdir().unwrap();
    let table = "speed [m/s],f_x [mN],setup\n0.1,-100,a\n0.2,-410,a\n0.3,-890,b\n0.3,900,b\n";
    std::fs::write(folder.path().join("t.csv"), table).unwrap();
    let campaign = "schema = 1\nname = \"hull\"\n\
        [[source]]\nname = \"tow\"\nkind = \"towing\"\ntable = \"t.csv\"\nkeep = \"speed < 0.35 m/s and setup != c\"\n\
        [[source.uncertainty]]\nname = \"weights\"\nquantity = \"f_x\"\nstandard = \"2 mN\"\nshared = \"setup\"\ndof = 9\n\
        [[source.uncertainty]]\nquantity = \"speed\"\nstandard = \"0.5 %\"\nshared = \"campaign\"\n\
        [[source]]\nname = \"twin\"\nkind = \"tank\"\ntable = \"later.csv\"\nmodels = [\"power_law\"]\n\
        [[source.plan]]\nconfigurations = [\"H1LT\", \"H2LT\"]\nspeed = [\"0.1 m/s\", \"0.2 m/s\"]\nrepeats = 3\n";
    std::fs::write(folder.path().join("c.toml"), campaign).unwrap();
    let (said, json) = inspect(folder.path(), "c.toml");
    for part in [
        "source tow (towing)",
        "models: quadratic, linear_quadratic, power_law\n",
        "t.csv, 4 observations",
        "0.002 N",
        "weights",
        "plan: 12 runs",
        "later.csv, not there yet: froude simulate makes it",
        "[force-along-motion] tow: f_x points along v_x in 1 of 4 rows, first on line 5",
    ] {
        assert!(said.contains(part), "{part:?} is not in\n{said}");
    }
    let tow = &json["sources"][0];
    assert_eq!(
        tow["columns"][1],
        serde_json::json!({"name": "f_x", "unit": "mN", "low": -890.0, "high": 900.0, "distinct": 4})
    );
    assert_eq!(
        tow["budget"],
        serde_json::json!([
            {"quantity": "f_x", "standard": "0.002 N", "shared": "setup", "dof": 9.0, "name": "weights"},
            {"quantity": "speed", "standard": "0.5 %", "shared": "campaign", "dof": null, "name": null},
        ])
    );
    assert_eq!((&tow["rows"], &tow["kept"], &tow["planned_runs"]), (&4.into(), &4.into(), &serde_json::Value::Null));
    assert_eq!(json["sources"][1]["planned_runs"], 12);
    assert_eq!(json["sources"][1]["models"], serde_json::json!(["power_law"]));
    // What a fit would refuse is refused here too.
    for (from, to, message) in [
        ("power_law", "powr_law", "did you mean `power_law`?"),
        ("table = \"t.csv\"", "table = \"t.csv\"\nmodels = [\"f4\"]", "model f4: needs the body's geometry"),
        ("quantity = \"f_x\"", "quantity = \"f_z\"", "`quantity` is \"f_z\", which t.csv does not have"),
    ] {
        std::fs::write(folder.path().join("c.toml"), campaign.replace(from, to)).unwrap();
        let refused = froude(folder.path(), &["inspect", "c.toml"]);
        assert_eq!(refused.status.code(), Some(2));
        let said = String::from_utf8_lossy(&refused.stderr);
        assert!(said.contains(message), "{said}");
    }
}

#[test]
fn inspect_shows_published_sets_and_a_planned_table() {
    let (said, json) = inspect(&example("mamba"), "campaign.toml");
    assert!(said.contains("plan: 536 runs"), "Table 3 of the paper: {said}");
    assert!(said.contains("estimates: cfd/f1, cfd/f2"), "{said}");
    assert_eq!(json["sources"][0]["planned_runs"], 536);
    assert_eq!(json["sources"][1]["kind"], "published");
}

#[test]
fn inspect_shows_the_estimates_of_a_record() {
    let folder = tempfile::tempdir().unwrap();
    let tare = example("unh-rm2/tare.toml");
    json(&froude(folder.path(), &["--json", "identify", tare.to_str().unwrap(), "--out", "results"]));
    let (said, json) = inspect(folder.path(), "results/estimate.json");
    for part in [
        "mounting frame/quadratic",
        "(recommended)",
        "D_x_II",
        "kg/m",
        "standard uncertainty",
        "free",
        "valid for",
        "speed",
        "relative residual: f_x",
        "Durbin–Watson: f_x",
        "condition number",
    ] {
        assert!(said.contains(part), "{part:?} is not in\n{said}");
    }
    let file: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("results/estimate.json")).unwrap()).unwrap();
    assert_eq!(json["estimates"], file["estimates"], "every number of the record");
    assert_eq!(json["findings"], file["findings"]);
}

/// The published record of the conventions page, word for word.
#[test]
fn the_record_that_the_book_shows_can_be_compared() {
    let folder = tempfile::tempdir().unwrap();
    let page =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../book/src/conventions.md")).unwrap();
    let record = page.split("```json\n").nth(1).and_then(|rest| rest.split("```").next()).unwrap();
    std::fs::write(folder.path().join("handbook.json"), record).unwrap();
    let mut table = "speed [m/s],f_x [gf]\n".to_owned();
    for (v, f) in [(0.2, -1.8), (0.4, -7.1), (0.6, -15.7), (0.8, -28.4), (0.7, -21.3)] {
        table += &format!("{v},{f}\n");
    }
    std::fs::write(folder.path().join("t.csv"), table).unwrap();
    assert_eq!(froude(folder.path(), &["identify", "t.csv"]).status.code(), Some(0));
    let out = json(&froude(folder.path(), &["--json", "compare", "t-results/estimate.json", "handbook.json"]));
    assert!(out["comparison"]["coefficients"][0]["e_n"].is_number(), "{out}");
    assert!(!out["comparison"]["loads"].as_array().unwrap().is_empty(), "{out}");
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_panic() {
    use std::process::{Command, Stdio};
    let record = example("mamba/published/cfd.json");
    let mut child = Command::new(env!("CARGO_BIN_EXE_froude"))
        .args(["inspect", record.to_str().unwrap()])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    assert_eq!(output.status.code(), Some(0));
}

#[test]
fn a_body_without_links_is_simulated_too() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(
        folder.path().join("c.toml"),
        "schema = 1\nname = \"torpedo\"\n[fluid]\ntemperature = \"19 degC\"\n[[source]]\nname = \"tow\"\nkind = \"towing\"\ntable = \"t.csv\"\n\
         [[source.plan]]\nspeed = { start = \"0.1 m/s\", stop = \"0.8 m/s\", step = \"0.1 m/s\" }\nrepeats = 3\n\
         [simulate]\nseed = 1\nmodel = \"quadratic\"\n[simulate.coefficients]\nD_x_II = \"0.4 kg/m\"\n\
         [[simulate.sensor]]\nquantity = \"f_x\"\nnoise = \"0.002 N\"\n",
    )
    .unwrap();
    let made = froude(folder.path(), &["simulate", "c.toml"]);
    assert_eq!(made.status.code(), Some(0), "{}", String::from_utf8_lossy(&made.stderr));
    let out = json(&froude(folder.path(), &["--json", "identify", "c.toml", "--models", "quadratic"]));
    let c = &out["estimates"][0]["coefficients"]["D_x_II"];
    let (value, u) = (c["value"].as_f64().unwrap(), c["standard_uncertainty"].as_f64().unwrap());
    assert!((value - 0.4).abs() < 4.0 * u && u < 0.01, "{c}");
}

/// The tare that a table has removed already is not subtracted again; what is uncertain about it is an error of all its rows, and what the rotor blocks is said.
#[test]
fn a_tare_that_was_removed_before_is_restored_as_an_error_of_all_rows() {
    let folder = tempfile::tempdir().unwrap();
    for file in std::fs::read_dir(example("unh-rm2")).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_file()) {
        std::fs::copy(&file, folder.path().join(file.file_name().unwrap())).unwrap();
    }
    let tare = json(&froude(folder.path(), &["--json", "identify", "tare.toml"]));
    let of_frame = |e: &&serde_json::Value| e["id"] == "mounting frame/quadratic";
    let k = &tare["estimates"].as_array().unwrap().iter().find(of_frame).unwrap()["coefficients"]["D_x_II"];
    let of_k = k["standard_uncertainty"].as_f64().unwrap();
    // Least squares of the twelve rows by a second program: 47.83 ± 1.14 %.
    assert!((of_k / k["value"].as_f64().unwrap() - 0.01141).abs() < 1e-5, "{k}");
    let out = json(&froude(folder.path(), &["--json", "identify", "rotor-drag.toml"]));
    for estimate in out["estimates"].as_array().unwrap() {
        let errors = estimate["errors"].as_object().unwrap();
        let (_, error) = errors.iter().find(|(key, _)| key.starts_with("tare/")).unwrap();
        let by = |j: usize| error["sensitivity"][j][0].as_f64().unwrap();
        assert_eq!(estimate["type_a"]["names"][0], "S_0");
        // k U² is a drag area of k/(ρ/2) at every speed and tip speed ratio: it moves S_0 alone.
        let moved = by(0).abs() * error["covariance"][0][0].as_f64().unwrap().sqrt();
        assert!((moved / (of_k / 500.0) - 1.0).abs() < 1e-6, "{moved}");
        assert!((1..3).all(|j| by(j).abs() < 1e-6 * by(0).abs()), "{error}");
        // Loads stay as they are: C_D at 3.1 is that of the rows there, 0.835 and 0.846, to 2 %.
        let c_d = estimate["coefficients"]["S_0"]["value"].as_f64().unwrap() / 0.8675;
        assert!((c_d - 0.84).abs() < 0.017, "{c_d}");
    }
    let findings: Vec<&str> =
        out["findings"].as_array().unwrap().iter().map(|f| f["message"].as_str().unwrap()).collect();
    let has = |text: &str| findings.iter().any(|f| f.contains(text));
    assert!(
        has(
            "the tare of mounting frame/quadratic (f_x) was removed from the table before and is not subtracted again; its covariance is an error that all observations share"
        ),
        "{findings:?}"
    );
    assert!(has("the body blocks 9.7 % of the tank's cross-section"), "{findings:?}");
}

/// What a spreadsheet reads has the numbers of the record, and what speaks against them is not kept back.
#[test]
fn csv_has_the_coefficients_and_what_speaks_against_them_is_on_standard_error() {
    let folder = tempfile::tempdir().unwrap();
    let rows = "speed [m/s],f_x [N]\n0.2,0.32\n0.4,1.29\n0.6,2.87\n0.8,5.13\n1.0,7.98\n1.2,11.54\n";
    std::fs::write(folder.path().join("tow.csv"), rows).unwrap();
    let output = froude(folder.path(), &["identify", "tow.csv", "--csv"]);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
    let printed = String::from_utf8(output.stdout).unwrap();
    // Behind a line with its name where other tables follow.
    let table = printed[printed.find("estimate,").unwrap()..].split("\n\n").next().unwrap();
    let mut read = csv::Reader::from_reader(table.as_bytes());
    let heads = read.headers().unwrap().clone();
    let all: Vec<csv::StringRecord> = read.records().map(Result::unwrap).collect();
    let record: serde_json::Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("tow-results/estimate.json")).unwrap()).unwrap();
    let first = &record["estimates"][0]["coefficients"]["D_x_II"];
    let cell = |head: &str| {
        let row = all.iter().find(|row| &row[2] == "D_x_II").unwrap();
        row[heads.iter().position(|name| name == head).unwrap()].parse::<f64>().unwrap()
    };
    assert_eq!(Some(cell("value")), first["value"].as_f64());
    assert_eq!(Some(cell("interval_95_high")), first["interval_95"][1].as_f64());
    let said = String::from_utf8(output.stderr).unwrap();
    assert!(said.contains("force-along-motion"), "{said}");
    // A comparison has no coefficients of its own: its tables are printed as people see them.
    let both = froude(folder.path(), &["compare", "tow-results/estimate.json", "tow-results/estimate.json", "--csv"]);
    assert!(String::from_utf8(both.stdout).unwrap().contains("D_x_II"));
}
