//! Solvers that outlived their coordinator.
//!
//! What a solver starts carries the folder of its attempt in its environment. When the next coordinator on the same machine finds an attempt of a dead one, it ends what still works there: its result would not count, and its time is wanted.

use std::path::Path;

/// The variable of the environment that says which attempt a process belongs to.
pub const ATTEMPT: &str = "FROUDE_ATTEMPT";

/// What [`ATTEMPT`] is for a folder: its whole path.
#[must_use]
pub fn mark(folder: &Path) -> std::ffi::OsString {
    folder.canonicalize().unwrap_or_else(|_| folder.to_owned()).into_os_string()
}

/// Ends all processes of an attempt that are seen from here, and says how many.
pub fn end(folder: &Path) -> usize {
    let mut wanted = std::ffi::OsString::from(ATTEMPT);
    wanted.push("=");
    wanted.push(mark(folder));
    let is_its = |environment: &[u8]| environment.split(|b| *b == 0).any(|v| v == wanted.as_encoded_bytes());
    let mut ended = 0;
    for entry in std::fs::read_dir("/proc").into_iter().flatten().flatten() {
        let pid = entry.file_name().to_str().and_then(|n| n.parse().ok()).and_then(rustix::process::Pid::from_raw);
        let Some(pid) = pid else { continue };
        if std::fs::read(entry.path().join("environ")).is_ok_and(|text| is_its(&text)) {
            ended += usize::from(rustix::process::kill_process(pid, rustix::process::Signal::KILL).is_ok());
        }
    }
    ended
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;

    #[test]
    fn what_belongs_to_an_attempt_is_ended_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let sleeper = |of: &Path| {
            std::process::Command::new("sh").args(["-c", "sleep 30 & wait"]).env(ATTEMPT, mark(of)).spawn().unwrap()
        };
        let other = folder.path().join("attempt-0010");
        let (mut its, mut another) = (sleeper(&folder.path().join("attempt-001")), sleeper(&other));
        let start = std::time::Instant::now();
        let mut ended = 0;
        // The shell and the program that it starts.
        while ended < 2 && start.elapsed().as_secs() < 10 {
            ended += end(&folder.path().join("attempt-001"));
        }
        assert!(ended >= 2 && !its.wait().unwrap().success());
        assert_eq!(another.try_wait().unwrap(), None);
        end(&other);
        another.wait().unwrap();
    }
}
