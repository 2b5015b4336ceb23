//! The program as a person of a tank runs it, on an example campaign that may be changed.

use std::path::Path;
use std::process::{Command, Output};

/// The program with these arguments in a folder.
pub fn froude(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_froude")).args(arguments).current_dir(folder).output().unwrap()
}

/// What it says beside its results.
pub fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// What it printed as JSON, and that it succeeded.
pub fn json(output: &Output) -> serde_json::Value {
    assert_eq!(output.status.code(), Some(0), "{}", said(output));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The campaign of an example in a folder of its own, with some text replaced.
pub fn example(name: &str, replaced: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut text = std::fs::read_to_string(root.join("examples").join(name).join("campaign.toml")).unwrap();
    for (from, to) in replaced {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    std::fs::write(folder.path().join("campaign.toml"), text).unwrap();
    folder
}

/// The same with the runs of its twin.
pub fn simulated(name: &str, replaced: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = example(name, replaced);
    let output = froude(folder.path(), &["simulate", "campaign.toml"]);
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    folder
}

/// What is said of arguments that are refused.
pub fn refused(folder: &Path, arguments: &[&str]) -> String {
    let output = froude(folder, arguments);
    assert_eq!(output.status.code(), Some(2), "{}", said(&output));
    said(&output)
}

/// Replaces some text of a file, which must be there.
pub fn replace_in(path: &Path, from: &str, to: &str) {
    let text = std::fs::read_to_string(path).unwrap();
    assert!(text.contains(from), "{text}");
    std::fs::write(path, text.replace(from, to)).unwrap();
}

/// That each interval of an estimate is near the truth of its plan, and as wide as the plan says within `ratios`.
pub fn is_as_planned(plan: &serde_json::Value, estimate: &serde_json::Value, ratios: std::ops::Range<f64>) {
    for expected in plan["sources"][0]["expected"].as_array().unwrap() {
        let name = expected["coefficient"].as_str().unwrap();
        let interval = &estimate["coefficients"][name]["interval_95"];
        let (low, high) = (interval[0].as_f64().unwrap(), interval[1].as_f64().unwrap());
        let truth = expected["value"].as_f64().unwrap();
        // One campaign: an interval of 95 % may miss by a little.
        let half = 0.5 * (high - low);
        assert!((truth - 0.5 * (low + high)).abs() < 1.5 * half, "{name}: {truth} not near [{low}, {high}]");
        let ratio = half / expected["half_width_95"].as_f64().unwrap();
        assert!(ratios.contains(&ratio), "{name}: {ratio}");
    }
}
