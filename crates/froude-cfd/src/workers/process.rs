//! Processes by more than their number, which the system gives away again.

use std::path::Path;

use serde::{Deserialize, Serialize};

/// A process.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Process {
    /// Name of its host, for people.
    pub host: String,
    /// The start of its system and its space of process numbers; empty where the system does not say them.
    pub machine: String,
    /// Its number.
    pub pid: u32,
    /// When it started, in ticks of the system since that was started; 0 where it is not known.
    pub started_ticks: u64,
}

impl Process {
    /// This one.
    #[must_use]
    pub fn this() -> Self {
        let pid = std::process::id();
        let host = text("/proc/sys/kernel/hostname")
            .or_else(|| std::env::var("HOSTNAME").ok())
            .unwrap_or_else(|| "an unnamed host".to_owned());
        let boot = text("/proc/sys/kernel/random/boot_id");
        let numbers = std::fs::read_link("/proc/self/ns/pid").ok().map(|p| p.display().to_string());
        let machine = boot.zip(numbers).map(|(boot, numbers)| format!("{boot} {numbers}")).unwrap_or_default();
        Self { host, machine, pid, started_ticks: started_ticks(pid).unwrap_or(0) }
    }

    /// Whether it lives; `None` for one of another machine, which cannot be seen from here.
    #[must_use]
    pub fn is_alive(&self) -> Option<bool> {
        let is_here = !self.machine.is_empty() && self.machine == Self::this().machine;
        is_here.then(|| started_ticks(self.pid) == Some(self.started_ticks))
    }
}

fn text(path: &str) -> Option<String> {
    std::fs::read_to_string(path).ok().map(|t| t.trim().to_owned()).filter(|t| !t.is_empty())
}

/// Start of a process that lives; one that has ended and is not yet buried does not.
fn started_ticks(pid: u32) -> Option<u64> {
    let stat = std::fs::read_to_string(Path::new("/proc").join(pid.to_string()).join("stat")).ok()?;
    // Its name may hold spaces and brackets; what follows does not.
    let (_, behind) = stat.rsplit_once(')')?;
    let mut fields = behind.split_whitespace();
    let is_dead = matches!(fields.next()?, "Z" | "X");
    (!is_dead).then(|| fields.nth(18)?.parse().ok())?
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_process_lives_until_it_ends_and_another_of_its_number_is_not_it() {
        let this = Process::this();
        if this.machine.is_empty() {
            return;
        }
        assert_eq!(this.is_alive(), Some(true));
        assert_eq!(Process { started_ticks: this.started_ticks + 1, ..this.clone() }.is_alive(), Some(false));
        assert_eq!(Process { machine: "another".to_owned(), ..this.clone() }.is_alive(), None);
        let mut child = std::process::Command::new("sleep").arg("60").spawn().unwrap();
        let its = Process { pid: child.id(), started_ticks: started_ticks(child.id()).unwrap(), ..this };
        assert_eq!(its.is_alive(), Some(true));
        child.kill().unwrap();
        while its.is_alive() == Some(true) {
            std::thread::yield_now();
        }
        assert_eq!(its.is_alive(), Some(false), "killed, and not yet waited for");
        child.wait().unwrap();
        assert_eq!(its.is_alive(), Some(false));
    }
}
