//! Programs of others as oracles: scripts run by the Python of `target/oracles`.
#![allow(dead_code, reason = "each test file uses what it needs")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "part of a test")]

use std::path::{Path, PathBuf};
use std::process::Command;

/// What the script prints, run in `folder`.
///
/// # Panics
///
/// If the Python or one of its packages is not there, with the command that installs it, or if the script fails.
pub fn python(folder: &Path, script: &str) -> String {
    let output = Command::new(interpreter()).args(["-W", "ignore", "-c", script]).current_dir(folder).output().unwrap();
    let reported = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.success(),
        "the script failed; if a package is missing, run `cargo xtask oracles`\n{script}\n{reported}"
    );
    String::from_utf8(output.stdout).unwrap()
}

/// The Python with the packages of `xtask/oracles.txt`.
fn interpreter() -> PathBuf {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let found = here.ancestors().map(|folder| folder.join("target/oracles/bin/python")).find(|path| path.exists());
    found.expect("no Python with the packages of xtask/oracles.txt: run `cargo xtask oracles`, which installs it")
}
