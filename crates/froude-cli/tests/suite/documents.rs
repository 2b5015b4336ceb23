//! What the README and the book show is what the program does: quoted files are the files, examples run.

use std::path::{Path, PathBuf};
use std::process::Command;

use froude::identify::declare::key_table;

pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn read(path: &str) -> String {
    std::fs::read_to_string(root().join(path)).unwrap()
}

/// The fenced blocks of a page in one language, as a reader copies them.
pub fn blocks(page: &str, language: &str) -> Vec<String> {
    let fence = format!("```{language}");
    let mut lines = page.lines();
    let mut out = Vec::new();
    while let Some(line) = lines.next() {
        if line == fence {
            let block: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
            out.push(block.join("\n") + "\n");
        }
    }
    out
}

#[test]
fn the_files_that_the_start_page_quotes_are_those_of_the_examples() {
    let quoted = blocks(&read("book/src/start.md"), "toml");
    for name in ["Tare-drag.toml", "Perf-tsr_0.toml", "rotor.toml"] {
        let file = read(&format!("examples/unh-rm2/{name}"));
        assert!(quoted.contains(&file), "start.md does not quote {name} as it is now:\n{file}");
    }
}

#[test]
fn the_key_tables_of_the_book_are_those_that_the_methods_declare() {
    use froude::methods::tank::{
        accelerated_tow, decay, excited_response, oscillation, rotation, steady, sway, weight_tow,
    };
    for (page, keys) in [
        ("forced-oscillation", oscillation::KEYS),
        ("forced-oscillation", oscillation::PLAN),
        ("rotation", rotation::KEYS),
        ("rotation", rotation::PLAN),
        ("sway", sway::KEYS),
        ("sway", sway::PLAN),
        ("steady", steady::section::KEYS),
        ("steady", steady::section::PLAN),
        ("weight-tow", weight_tow::KEYS),
        ("weight-tow", weight_tow::PLAN),
        ("accelerated-tow", accelerated_tow::section::KEYS),
        ("accelerated-tow", accelerated_tow::section::PLAN),
        ("free-decay", decay::section::KEYS),
        ("free-decay", decay::section::PLAN),
        ("excited-response", excited_response::section::KEYS),
        ("excited-response", excited_response::section::PLAN),
        ("joint", froude::methods::carriage::axis::declared::KEYS),
        ("cfd", froude::cfd::forces::keys::KEYS),
    ] {
        let table = key_table(keys);
        assert!(
            read(&format!("book/src/{page}.md")).contains(&format!("{table}\n")),
            "{page}.md has no such table:\n{table}"
        );
    }
}

#[test]
fn no_page_needs_the_book_to_be_built_to_show_its_examples() {
    for page in std::fs::read_dir(root().join("book/src")).unwrap() {
        let path = page.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(!text.contains("{{#"), "{} includes a file: quote it", path.display());
    }
}

#[test]
fn the_bare_table_of_the_start_page_is_fitted() {
    let page = read("book/src/start.md");
    let table = blocks(&page, "text").into_iter().find(|b| b.starts_with("speed [m/s],f_x [N]")).unwrap();
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("drag.csv"), table).unwrap();
    let json = run(folder.path(), "froude identify drag.csv");
    assert_eq!(json["estimates"].as_array().unwrap().len(), 3);
}

/// Runs a line that a reader would type, with --json.
fn run(folder: &Path, line: &str) -> serde_json::Value {
    let args = line.strip_prefix("froude ").unwrap().split_whitespace();
    let output =
        Command::new(env!("CARGO_BIN_EXE_froude")).arg("--json").args(args).current_dir(folder).output().unwrap();
    assert_eq!(output.status.code(), Some(0), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

#[test]
fn your_own_data_of_the_readme_runs_as_printed() {
    let readme = read("README.md");
    let part = readme.split("## Your own data").nth(1).unwrap().split("\n## ").next().unwrap();
    let folder = tempfile::tempdir().unwrap();
    let (csv, toml) = (blocks(part, "csv"), blocks(part, "toml"));
    assert_eq!((csv.len(), toml.len()), (1, 2), "one table, its sidecar, its campaign");
    assert_eq!(toml[1].lines().count(), 10, "a campaign of ten lines");
    for (name, text) in [("drag.csv", &csv[0]), ("drag.toml", &toml[0]), ("campaign.toml", &toml[1])] {
        std::fs::write(folder.path().join(name), text).unwrap();
    }
    let lines = blocks(part, "sh").remove(0);
    let mut results = lines.lines().map(|line| run(folder.path(), line.split(" #").next().unwrap().trim_end()));
    let inspected = results.next().unwrap();
    assert_eq!(inspected["sources"][0]["budget"][0]["standard"], "2 %");
    assert_eq!(inspected["sources"][0]["rows"], 8);
    let identified = results.next().unwrap();
    let recommended = identified["estimates"].as_array().unwrap().iter().find(|e| e["recommended"] == true).unwrap();
    let drag = &recommended["coefficients"]["D_x_II"];
    let (value, type_b) = (drag["value"].as_f64().unwrap(), drag["type_b"].as_f64().unwrap());
    assert!((type_b / value - 0.02).abs() < 1e-9, "the calibration does not average down: {type_b} of {value}");
    let grave = |f: &&serde_json::Value| f["severity"] != "note";
    let doubts: Vec<_> = identified["findings"].as_array().unwrap().iter().filter(grave).collect();
    assert!(doubts.is_empty(), "an example to start from raises no doubt: {doubts:?}");
    assert!(folder.path().join("campaign-results/report.html").exists());
}
