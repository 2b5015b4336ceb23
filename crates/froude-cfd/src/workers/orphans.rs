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
        // A file says that the program which the shell starts is there too.
        let sleeper = |of: &str| {
            let started = folder.path().join(format!("{of} started"));
            let child = std::process::Command::new("sh")
                .args(["-c", "sleep 30 & : > \"$0\"; wait"])
                .arg(&started)
                .env(ATTEMPT, mark(&folder.path().join(of)))
                .spawn()
                .unwrap();
            let start = std::time::Instant::now();
            while !started.exists() && start.elapsed().as_secs() < 60 {
                std::thread::sleep(std::time::Duration::from_millis(5));
            }
            child
        };
        let (mut its, mut another) = (sleeper("attempt-001"), sleeper("attempt-0010"));
        assert_eq!(end(&folder.path().join("attempt-001")), 2);
        assert!(!its.wait().unwrap().success());
        assert_eq!(another.try_wait().unwrap(), None);
        end(&folder.path().join("attempt-0010"));
        another.wait().unwrap();
    }
}
