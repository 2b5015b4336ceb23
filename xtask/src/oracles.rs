//! Programs of others in a Python of their own, `target/oracles`: tests compare readers with them.

use std::path::Path;
use std::process::Command;

use crate::run;

/// Installs the pinned packages of `xtask/oracles.txt` into `target/oracles`, unless that list is there already.
///
/// # Errors
///
/// The command line that failed.
pub fn need_python(root: &Path) -> Result<(), String> {
    let (list, folder) = (root.join("xtask/oracles.txt"), root.join("target/oracles"));
    let stamp = folder.join("installed.txt");
    let wanted = std::fs::read_to_string(&list).map_err(|e| format!("{}: {e}", list.display()))?;
    if std::fs::read_to_string(&stamp).is_ok_and(|installed| installed == wanted) {
        return Ok(());
    }
    let has_venv = Command::new("python3").args(["-c", "import venv, ensurepip"]).output();
    if !has_venv.is_ok_and(|output| output.status.success()) {
        run(root, "apt-get", &["update", "-qq"])?;
        run(root, "apt-get", &["install", "-y", "-qq", "--no-install-recommends", "python3-venv"])?;
    }
    run(root, "python3", &["-m", "venv", "--clear", &folder.to_string_lossy()])?;
    let pip = folder.join("bin/pip");
    run(root, &pip.to_string_lossy(), &["install", "--quiet", "--requirement", &list.to_string_lossy()])?;
    std::fs::write(&stamp, wanted).map_err(|e| format!("{}: {e}", stamp.display()))
}
