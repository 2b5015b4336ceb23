//! A campaign of the carriage on the twin, shortened, driven once for all tests of a program, and copied for each to be spoilt.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::OnceLock;

use serde_json::Value;

pub const SIX_SPEEDS: &str = r#"speeds = ["0.05 m/s", "0.15 m/s", "0.25 m/s", "0.35 m/s", "0.45 m/s", "0.55 m/s"]"#;
pub const SIX_FRICTION_SPEEDS: &str =
    r#"speeds = ["0.02 m/s", "0.05 m/s", "0.1 m/s", "0.2 m/s", "0.35 m/s", "0.55 m/s"]"#;
/// Seconds instead of minutes: waits before the runs, and still parts.
pub const SHORT_WAITS: [(&str, &str); 2] = [
    (r#"settling = { dry = "5 s", wet = "120 s" }"#, r#"settling = { dry = "1 s", wet = "1 s" }"#),
    (r#"still = "5 s""#, r#"still = "2 s""#),
];

/// A body file: a smooth robot of links.
pub const SMOOTH_BODY: &str = "schema = 1\nname = \"smooth\"\n[body]\nshape = \"robot\"\n\
     link = { major_semi_axis = \"58.8 mm\", minor_semi_axis = \"39.4 mm\", half_length = \"90 mm\" }\nends = { length = \"31 mm\" }\n";

/// The example, shortened to two pairs at one speed, jogs and pulses.
pub const SHORT: [(&str, &str); 8] = [
    (SIX_SPEEDS, r#"speeds = ["0.5 m/s"]"#),
    ("repeats = 5  ", "repeats = 2  "),
    ("[carriage.warm_up]\nduration = \"1 min\"\nspeed = \"0.3 m/s\"\n", ""),
    (
        "[carriage.friction_sweep]\nspeeds = [\"0.02 m/s\", \"0.05 m/s\", \"0.1 m/s\", \"0.2 m/s\", \"0.35 m/s\", \"0.55 m/s\"]\nrepeats = 2\n",
        "",
    ),
    ("weights = [\"1.5 N\", \"10 N\"]", "weights = [\"1.5 N\"]"),
    ("repeats = 6\n", "repeats = 1\n"),
    ("duration = \"20 s\"", "duration = \"2 s\""),
    (r#"log_rate = "1 kHz""#, r#"log_rate = "250 Hz""#),
];

/// The example's campaign in `folder`, with short waits and these changes.
pub fn campaign(folder: &Path, changes: &[(&str, &str)]) -> PathBuf {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/towing-carriage/campaign.toml");
    let mut text = std::fs::read_to_string(example).unwrap();
    for (from, to) in SHORT_WAITS.iter().chain(changes) {
        assert!(text.contains(from), "the example has no {from}");
        text = text.replace(from, to);
    }
    let path = folder.join("campaign.toml");
    std::fs::write(&path, text).unwrap();
    path
}

pub fn froude(args: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_froude")).args(args).output().unwrap()
}

/// Whether a file's own name has a word in it.
pub fn is_called(path: &Path, word: &str) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().contains(word))
}

pub fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// Whether OpenFOAM is installed; tests that need it are skipped elsewhere, but fail under CI.
pub fn has_openfoam() -> bool {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    let is_installed = std::env::split_paths(&paths).any(|folder| folder.join("simpleFoam").is_file());
    assert!(
        is_installed || std::env::var_os("CI").is_none(),
        "OpenFOAM is not installed; cargo xtask test installs it"
    );
    if !is_installed {
        println!("skipped: OpenFOAM is not installed");
    }
    is_installed
}

/// What a command that must not go on says, and that it is the input's fault.
pub fn refusal(args: &[&str]) -> String {
    let out = froude(args);
    let error = String::from_utf8_lossy(&out.stderr).into_owned();
    assert_eq!(out.status.code(), Some(2), "{args:?}: {error}");
    error
}

/// What a command that goes on prints.
pub fn printed(args: &[&str]) -> String {
    let out = froude(args);
    assert!(out.status.success(), "{args:?}: {}", String::from_utf8_lossy(&out.stderr));
    String::from_utf8(out.stdout).unwrap()
}

pub fn json(args: &[&str]) -> Value {
    serde_json::from_str(&printed(args)).unwrap()
}

/// The findings of a code, as their grade and sentence.
pub fn findings_of(value: &Value, code: &str) -> Vec<(String, String)> {
    let text = |value: &Value| value.as_str().unwrap().to_owned();
    let all = value["findings"].as_array().unwrap().iter();
    all.filter(|f| f["code"] == code).map(|f| (text(&f["severity"]), text(&f["message"]))).collect()
}

/// A folder with the short campaign and its runs, driven once: two of them, which differ by their seed.
pub fn driven(seed: usize) -> &'static Path {
    static DRIVEN: [OnceLock<tempfile::TempDir>; 2] = [const { OnceLock::new() }; 2];
    let folder = DRIVEN[seed - 1].get_or_init(|| {
        let folder = tempfile::tempdir().unwrap();
        let seed = format!("seed = {seed}\n");
        let mut changes = SHORT.to_vec();
        changes.push(("seed = 1\n", &seed));
        let campaign = campaign(folder.path(), &changes);
        json(&["run", text(&campaign), "--yes", "--json"]);
        folder
    });
    folder.path()
}

pub fn copy(from: &Path, to: &Path) {
    std::fs::create_dir_all(to).unwrap();
    for entry in std::fs::read_dir(from).unwrap() {
        let entry = entry.unwrap();
        if entry.file_type().unwrap().is_dir() {
            copy(&entry.path(), &to.join(entry.file_name()));
        } else {
            std::fs::copy(entry.path(), to.join(entry.file_name())).unwrap();
        }
    }
}

/// A campaign with its runs, to be spoilt.
pub struct Bench {
    pub folder: tempfile::TempDir,
    pub campaign: PathBuf,
    pub runs: PathBuf,
}

impl Bench {
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        copy(driven(1), folder.path());
        let (campaign, runs) = (folder.path().join("campaign.toml"), folder.path().join("campaign-runs"));
        Self { folder, campaign, runs }
    }

    /// Logs of the kind, in order.
    /// Logs whose name has a word in it; a temporary folder may have it too, by chance.
    pub fn logs(&self, kind: &str) -> Vec<PathBuf> {
        let all = std::fs::read_dir(&self.runs).unwrap().map(|e| e.unwrap().path());
        let mut logs: Vec<PathBuf> =
            all.filter(|p| p.extension().is_some_and(|e| e == "mcap") && is_called(p, kind)).collect();
        logs.sort();
        logs
    }

    pub fn inspect(&self) -> Value {
        json(&["inspect", text(&self.runs), "--json"])
    }

    pub fn drag(&self) -> Value {
        json(&["carriage", "drag", text(&self.runs), "--json"])
    }

    /// Drives on: how many runs were driven, and what was said.
    pub fn run(&self) -> (u64, String) {
        let out = froude(&["run", text(&self.campaign), "--yes", "--json"]);
        let said = String::from_utf8_lossy(&out.stderr).into_owned();
        assert!(out.status.success(), "{said}");
        let outcome: Value = serde_json::from_slice(&out.stdout).unwrap();
        (outcome["driven"].as_u64().unwrap(), said)
    }
}

pub fn id(log: &Path) -> &str {
    log.file_stem().unwrap().to_str().unwrap()
}
