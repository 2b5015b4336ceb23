//! OpenFOAM as it is installed: where it is, which it is, and running its programs.

use std::ffi::OsStr;
use std::fs::File;
use std::os::unix::process::{CommandExt as _, ExitStatusExt as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use rustix::process::{Pid, Signal, kill_process_group};

/// The version that cases were tried with.
const TRIED: &str = "1912";
/// How often a program is looked after.
const LOOK: Duration = Duration::from_millis(20);
/// How long programs that were asked to end have for it.
const GRACE: Duration = Duration::from_secs(5);

/// OpenFOAM as it was found.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct OpenFoam {
    /// Folder of its programs.
    programs: PathBuf,
    /// Folder that holds its `etc/controlDict`, which it cannot do without.
    project: PathBuf,
    /// As its programs print it: `1912`, `v2312`.
    pub version: String,
}

/// How a program ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// By itself.
    Whole,
    /// By its trap of floating-point errors.
    FloatingPoint,
    /// With another code, or by a signal, which is then negative.
    Code(i32),
}

/// Why OpenFOAM does not run.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum OpenFoamError {
    /// It is missing, is an unsupported version, or does not start.
    #[error("{0}")]
    Unusable(String),
    /// It was ended as asked.
    #[error("{program} was ended as asked")]
    Cancelled {
        /// The program.
        program: String,
    },
}

impl OpenFoamError {
    fn run(program: &str, problem: &std::io::Error) -> Self {
        Self::Unusable(format!("{program}: {problem}"))
    }
}

impl OpenFoam {
    /// Finds it on the environment's `PATH`.
    ///
    /// # Errors
    ///
    /// [`OpenFoamError`] but for its last two.
    pub fn find() -> Result<Self, OpenFoamError> {
        let path = std::env::var_os("PATH").unwrap_or_default();
        Self::find_on(&path, std::env::var_os("WM_PROJECT_DIR").as_deref())
    }

    /// Finds it on a search path; `project` goes before what lies beside the programs.
    ///
    /// # Errors
    ///
    /// As [`OpenFoam::find`].
    pub fn find_on(path: &OsStr, project: Option<&OsStr>) -> Result<Self, OpenFoamError> {
        let name = "simpleFoam";
        let program = std::env::split_paths(path)
            .map(|folder| folder.join(name))
            .find(|program| program.is_file())
            .ok_or_else(|| {
                OpenFoamError::Unusable(format!(
                    "OpenFOAM is not installed: no program {name} on PATH; install the package openfoam of Debian or Ubuntu"
                ))
            })?;
        let said = program.display().to_string();
        let project = project
            .map(PathBuf::from)
            .filter(|folder| folder.join("etc/controlDict").is_file())
            .or_else(|| settings_of(&program))
            .ok_or_else(|| {
                OpenFoamError::Unusable(format!(
                    "{said}: OpenFOAM's file etc/controlDict is not found from there; set WM_PROJECT_DIR to the folder that holds etc"
                ))
            })?;
        let output = Command::new(&program)
            .arg("-help")
            .env("WM_PROJECT_DIR", &project)
            .output()
            .map_err(|e| OpenFoamError::run(&said, &e))?;
        let version = version_in(&String::from_utf8_lossy(&output.stdout), &said)?;
        let program = std::path::absolute(&program).map_err(|e| OpenFoamError::run(&said, &e))?;
        let programs = program.parent().map(PathBuf::from).unwrap_or_default();
        Ok(Self { programs, project, version })
    }

    /// What to say of a version that cases were not tried with.
    #[must_use]
    pub fn advice(&self) -> Option<String> {
        (self.version.trim_start_matches('v') != TRIED)
            .then(|| format!("OpenFOAM is {}; cases were tried with {TRIED}", self.version))
    }

    /// Runs a program in a case's folder, its output behind what stands in `log`, until it ends or is cancelled.
    ///
    /// With more than one rank it runs by `mpirun`, which OpenFOAM's programs need `-parallel` for. `look` is called some 50 times a second.
    ///
    /// # Errors
    ///
    /// [`OpenFoamError::Unusable`], [`OpenFoamError::Cancelled`].
    pub fn run(
        &self,
        program: &str,
        arguments: &[&str],
        ranks: usize,
        folder: &Path,
        log: &str,
        cancel: &AtomicBool,
        look: &mut dyn FnMut(),
    ) -> Result<End, OpenFoamError> {
        let failed = |e: std::io::Error| OpenFoamError::run(program, &e);
        let path = self.programs.join(program);
        let mut command = if ranks > 1 {
            let mut mpi = Command::new("mpirun");
            mpi.arg("-np").arg(ranks.to_string()).arg(path).arg("-parallel");
            // Root is what containers run as; cases side by side must not be bound to the same cores.
            for name in
                ["OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM", "OMPI_MCA_rmaps_base_oversubscribe"]
            {
                mpi.env(name, "1");
            }
            mpi.env("OMPI_MCA_hwloc_base_binding_policy", "none");
            mpi
        } else {
            Command::new(path)
        };
        let output = File::options().create(true).append(true).open(folder.join(log)).map_err(failed)?;
        let errors = output.try_clone().map_err(failed)?;
        command
            .args(arguments)
            .current_dir(folder)
            .env("WM_PROJECT_DIR", &self.project)
            .env(crate::orphans::ATTEMPT, crate::orphans::mark(folder))
            .stdin(std::process::Stdio::null())
            .stdout(output)
            .stderr(errors)
            .process_group(0);
        let mut child = command.spawn().map_err(failed)?;
        loop {
            if let Some(status) = child.try_wait().map_err(failed)? {
                return Ok(End::of(status));
            }
            if cancel.load(Ordering::Relaxed) {
                end_group(&mut child).map_err(failed)?;
                return Err(OpenFoamError::Cancelled { program: program.to_owned() });
            }
            look();
            std::thread::sleep(LOOK);
        }
    }
}

impl End {
    fn of(status: ExitStatus) -> Self {
        // 136 is how a shell, and mpirun, pass the signal on.
        const TRAP: i32 = Signal::FPE.as_raw();
        match (status.code(), status.signal()) {
            (Some(0), _) => Self::Whole,
            (_, Some(TRAP)) => Self::FloatingPoint,
            (Some(code), _) if code == 128 + TRAP => Self::FloatingPoint,
            (code, signal) => Self::Code(code.or(signal.map(|s| -s)).unwrap_or(-1)),
        }
    }
}

/// Ends a program and all it started: `mpirun` hands a request on to its ranks, which have groups of their own.
fn end_group(child: &mut Child) -> std::io::Result<()> {
    let group = Pid::from_child(child);
    let started = Instant::now();
    // What has ended meanwhile cannot be signalled, and need not be.
    let _ = kill_process_group(group, Signal::TERM);
    while child.try_wait()?.is_none() && started.elapsed() < GRACE {
        std::thread::sleep(LOOK);
    }
    // Whatever is left of the group did not listen.
    let _ = kill_process_group(group, Signal::KILL);
    child.wait()?;
    Ok(())
}

/// The folder above a program, or `share/openfoam` in it, that holds OpenFOAM's settings.
fn settings_of(program: &Path) -> Option<PathBuf> {
    let program = program.canonicalize().ok()?;
    program
        .ancestors()
        .flat_map(|folder| [folder.to_owned(), folder.join("share/openfoam")])
        .find(|folder| folder.join("etc/controlDict").is_file())
}

/// Of `Using: OpenFOAM-v2312 (2312) - visit www.openfoam.com`.
fn version_in(help: &str, program: &str) -> Result<String, OpenFoamError> {
    let unknown = || {
        let found = help.lines().rev().find(|line| !line.trim().is_empty()).unwrap_or_default();
        OpenFoamError::Unusable(format!("{program} -help says no version of OpenFOAM; it printed {found:?}"))
    };
    let line = help.lines().find(|line| line.trim_start().starts_with("Using: OpenFOAM")).ok_or_else(unknown)?;
    let behind = line.split("OpenFOAM-").nth(1).ok_or_else(unknown)?;
    let version = behind.split_whitespace().next().unwrap_or_default().trim_matches(['(', ')']);
    if line.contains("openfoam.org") || line.contains("OpenFOAM.org") {
        return Err(OpenFoamError::Unusable(format!(
            "{program} is OpenFOAM {version} of openfoam.org, whose files have other names; cases are for that of openfoam.com, as in the package openfoam of Debian or Ubuntu"
        )));
    }
    if version.is_empty() { Err(unknown()) } else { Ok(version.to_owned()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_is_read_from_what_programs_print() {
        let of = |line: &str| version_in(&format!("Usage: …\n\n{line}\nBuild: 1\n"), "simpleFoam");
        assert_eq!(of("Using: OpenFOAM- (1912) - visit www.openfoam.com").unwrap(), "1912");
        assert_eq!(of("Using: OpenFOAM-v2312 (2312) - visit www.openfoam.com").unwrap(), "v2312");
        let other = of("Using: OpenFOAM-10 (see https://openfoam.org)").unwrap_err().to_string();
        assert!(
            other.starts_with("simpleFoam is OpenFOAM 10 of openfoam.org, whose files have other names"),
            "{other}"
        );
        let unknown = |help: &str| version_in(help, "simpleFoam").unwrap_err().to_string();
        assert_eq!(
            unknown("something else"),
            "simpleFoam -help says no version of OpenFOAM; it printed \"something else\""
        );
        assert_eq!(unknown(""), "simpleFoam -help says no version of OpenFOAM; it printed \"\"");
    }

    #[test]
    fn where_it_is_absent_a_sentence_says_what_to_install() {
        let absent = OpenFoam::find_on(OsStr::new(""), None).unwrap_err();
        assert_eq!(
            absent.to_string(),
            "OpenFOAM is not installed: no program simpleFoam on PATH; install the package openfoam of Debian or Ubuntu"
        );
    }

    #[test]
    fn another_version_than_was_tried_is_said() {
        let of =
            |version: &str| OpenFoam { programs: PathBuf::new(), project: PathBuf::new(), version: version.to_owned() };
        assert_eq!(of("1912").advice(), None);
        assert_eq!(of("v1912").advice(), None);
        assert_eq!(of("v2312").advice().unwrap(), "OpenFOAM is v2312; cases were tried with 1912");
    }

    #[test]
    fn a_trap_of_floating_point_is_told_from_other_ends() {
        assert_eq!(End::of(ExitStatus::from_raw(0)), End::Whole);
        assert_eq!(End::of(ExitStatus::from_raw(8)), End::FloatingPoint);
        assert_eq!(End::of(ExitStatus::from_raw(136 << 8)), End::FloatingPoint);
        assert_eq!(End::of(ExitStatus::from_raw(1 << 8)), End::Code(1));
        assert_eq!(End::of(ExitStatus::from_raw(9)), End::Code(-9));
    }

    #[test]
    fn a_program_that_runs_ends_with_all_it_started_when_asked() {
        let folder = tempfile::tempdir().unwrap();
        let shell = OpenFoam { programs: PathBuf::from("/bin"), project: PathBuf::new(), version: String::new() };
        let cancel = AtomicBool::new(false);
        let mut looks = 0;
        let end =
            shell.run("sh", &["-c", "sleep 60 & echo $! > child; wait"], 1, folder.path(), "log", &cancel, &mut || {
                looks += 1;
                cancel.store(folder.path().join("child").metadata().is_ok_and(|m| m.len() > 1), Ordering::Relaxed);
            });
        assert_eq!(end, Err(OpenFoamError::Cancelled { program: "sh".to_owned() }));
        let child = std::fs::read_to_string(folder.path().join("child")).unwrap();
        let lives = || {
            let state = std::fs::read_to_string(format!("/proc/{}/stat", child.trim())).unwrap_or_default();
            !state.is_empty() && !state.contains(") Z ")
        };
        // A signal is sent, and acted on when its process has its turn.
        let asked = Instant::now();
        while lives() {
            assert!(asked.elapsed() < Duration::from_secs(20));
            std::thread::sleep(LOOK);
        }
        assert!(looks > 0);
    }
}
