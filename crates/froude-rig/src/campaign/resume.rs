//! What lies of a run in its folder, and where it goes when it is driven again.
//!
//! A run is two files, `ID.mcap` and `ID.toml`. The program may die between any two steps of making them, ending them and putting
//! them aside, so every state that this leaves is one that a campaign goes on from:
//!
//! | there is | how it comes about | what is done |
//! | --- | --- | --- |
//! | neither | nothing was recorded yet | driven |
//! | both, `complete` | the run was done | left alone |
//! | both, any other status | interrupted, faulted, cut, or the program died in it | set aside, driven |
//! | the log alone | the program died before the sidecar was written | set aside, driven |
//! | the sidecar alone, not `complete` | the program died between the two renames of putting aside | put beside its log, driven |
//! | the sidecar alone, `complete` | somebody moved the log away, or the program died while it set a damaged one aside | set aside by itself, driven |
//! | a sidecar without a word in it | the power failed before it reached the disk | set aside, driven |
//!
//! Nothing is deleted and nothing replaced: what is set aside is `ID.interrupted-N`, N counting up from 1.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use froude_records::read::{OWN_BYTES, if_there};
use froude_records::run::{CampaignMark, RunStatus, read_run_meta};

use super::pair::{Pair, check_pair};
use super::runner::error::RunnerError;

/// What a folder holds of a run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Found {
    /// It is complete.
    Complete {
        /// Whether its log was compared with the hash in its sidecar; an earlier version wrote none.
        is_compared: bool,
    },
    /// Nothing, now: it is to be driven.
    Nothing {
        /// What was set aside, in a sentence.
        aside: Option<String>,
    },
}

/// Whether a run lies there complete, its log as it was recorded. What lies there otherwise is set aside.
///
/// # Errors
///
/// What a person has to decide: a sidecar that cannot be read although something is written in it, files of another run or another
/// campaign. A folder that cannot be written.
pub(super) fn look(folder: &Path, id: &str, campaign: CampaignMark<'_>) -> Result<Found, RunnerError> {
    let [log, sidecar] = files(folder, id);
    let (reason, is_log_lost) = if is_blank(&sidecar)? {
        (format!("{id} was interrupted: nothing is written in its sidecar"), false)
    } else {
        match check_pair(folder, id, campaign).map_err(RunnerError::Files)? {
            Pair::Absent => return Ok(Found::Nothing { aside: None }),
            Pair::Complete { is_compared, .. } => return Ok(Found::Complete { is_compared }),
            Pair::Again { reason } => {
                let was_complete = || read_run_meta(&sidecar).is_ok_and(|meta| meta.status == RunStatus::Complete);
                (reason, !log.exists() && was_complete())
            }
        }
    };
    let name = put_aside(folder, id, is_log_lost)?;
    Ok(Found::Nothing { aside: Some(format!("{reason}: kept as {name}, driven again")) })
}

/// A sidecar is there, and not a word in it.
fn is_blank(sidecar: &Path) -> Result<bool, RunnerError> {
    let bytes = if_there(sidecar, OWN_BYTES, "a sidecar")?;
    Ok(bytes.is_some_and(|bytes| bytes.iter().all(|b| b.is_ascii_whitespace() || *b == 0)))
}

/// More interruptions of one run than anybody has the patience for.
const MOST_ASIDE: usize = 100_000;

/// Log and sidecar of a name.
fn files(folder: &Path, name: &str) -> [PathBuf; 2] {
    ["mcap", "toml"].map(|extension| folder.join(format!("{name}.{extension}")))
}

/// Renames what lies there of a run to the next free name; gives that name. A sidecar whose log went before it (the program died in
/// between) follows it, unless the log was lost in another way.
fn put_aside(folder: &Path, id: &str, is_log_lost: bool) -> Result<String, RunnerError> {
    let here = files(folder, id);
    let is_here = here.each_ref().map(|path| path.exists());
    let name = |n: usize| format!("{id}.interrupted-{n}");
    let there = |n: usize| files(folder, &name(n)).map(|path| path.exists());
    let last = (1..MOST_ASIDE).take_while(|&n| there(n).contains(&true)).last().unwrap_or(0);
    let follows = is_here == [false, true] && !is_log_lost && last > 0 && there(last) == [true, false];
    let name = name(if follows { last } else { last + 1 });
    for (from, to) in here.iter().zip(files(folder, &name)) {
        match std::fs::rename(from, to) {
            Err(e) if e.kind() != ErrorKind::NotFound => return Err(failed(from, &e)),
            _ => {}
        }
    }
    Ok(name)
}

fn failed(path: &Path, error: &std::io::Error) -> RunnerError {
    RunnerError::Folder { path: path.to_owned(), reason: error.to_string() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use froude_records::hash::{Fingerprint, sha256_of_bytes};
    use froude_records::run::{RunMeta, write_run_meta};

    const ID: &str = "084-wet";
    const SMALL: CampaignMark<'_> = CampaignMark { name: "small", sha256: "" };

    fn write(folder: &Path, log: Option<&str>, sidecar: Option<RunStatus>) {
        let [log_path, sidecar_path] = files(folder, ID);
        if let Some(text) = log {
            std::fs::write(log_path, text).unwrap();
        }
        if let Some(status) = sidecar {
            let (id, campaign) = (ID.to_owned(), SMALL.name.to_owned());
            let log =
                log.map(|text| Fingerprint { bytes: text.len() as u64, sha256: sha256_of_bytes(text.as_bytes()) });
            let meta = RunMeta { id, campaign, status, log, log_rate_hz: 1e3, ..RunMeta::default() };
            write_run_meta(&sidecar_path, &meta).unwrap();
        }
    }

    /// Every file of a folder with its content, by name.
    fn content(folder: &Path) -> Vec<(String, Vec<u8>)> {
        let mut out: Vec<_> = std::fs::read_dir(folder)
            .unwrap()
            .map(|e| e.unwrap().path())
            .map(|p| (p.file_name().unwrap().to_string_lossy().into_owned(), std::fs::read(&p).unwrap()))
            .collect();
        out.sort();
        out
    }

    fn texts(folder: &Path) -> Vec<Vec<u8>> {
        let mut out: Vec<_> = content(folder).into_iter().map(|f| f.1).collect();
        out.sort();
        out
    }

    fn names(folder: &Path) -> Vec<String> {
        content(folder).into_iter().map(|f| f.0).collect()
    }

    /// Every state of the two files, after none, one or two earlier interruptions, and the program dying after none, one or both of the
    /// renames: what is looked at again is gone from its place, nothing is lost, and a log and its sidecar stay together.
    #[test]
    fn whatever_lies_there_is_put_aside_whole_and_once_wherever_the_program_dies() {
        let statuses = [RunStatus::Running, RunStatus::Interrupted, RunStatus::Faulted, RunStatus::Cut];
        let mut sidecars: Vec<Option<RunStatus>> = statuses.into_iter().map(Some).collect();
        sidecars.push(None);
        for earlier in 0..3 {
            for &sidecar in &sidecars {
                for renamed in 0..3 {
                    let folder = tempfile::tempdir().unwrap();
                    let folder = folder.path();
                    for n in 0..earlier {
                        write(folder, Some(&format!("earlier {n}")), Some(RunStatus::Running));
                        look(folder, ID, SMALL).unwrap();
                    }
                    write(folder, Some("log"), sidecar);
                    let before = texts(folder);
                    // As far as the program came before it died.
                    let aside = files(folder, &format!("{ID}.interrupted-{}", earlier + 1));
                    for (from, to) in files(folder, ID).iter().zip(aside).take(renamed) {
                        let _ = std::fs::rename(from, to);
                    }
                    let found = look(folder, ID, SMALL).unwrap();
                    assert!(matches!(found, Found::Nothing { .. }), "{found:?}");
                    assert!(files(folder, ID).iter().all(|p| !p.exists()));
                    assert_eq!(texts(folder), before, "nothing is lost");
                    let mut expected: Vec<String> = (1..=earlier)
                        .flat_map(|n| ["mcap", "toml"].map(|e| format!("{ID}.interrupted-{n}.{e}")))
                        .collect();
                    expected.push(format!("{ID}.interrupted-{}.mcap", earlier + 1));
                    if sidecar.is_some() {
                        expected.push(format!("{ID}.interrupted-{}.toml", earlier + 1));
                    }
                    assert_eq!(names(folder), expected, "{sidecar:?}, {renamed} renamed");
                    assert_eq!(look(folder, ID, SMALL).unwrap(), Found::Nothing { aside: None }, "once");
                }
            }
        }
    }

    #[test]
    fn a_complete_run_is_left_alone_and_one_whose_log_is_gone_is_driven_again() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        write(folder, Some("log"), Some(RunStatus::Complete));
        let before = content(folder);
        assert_eq!(look(folder, ID, SMALL).unwrap(), Found::Complete { is_compared: true });
        assert_eq!(content(folder), before);
        // A log that was set aside alone earlier is not taken for the one that is gone.
        std::fs::rename(folder.join("084-wet.mcap"), folder.join("084-wet.interrupted-1.mcap")).unwrap();
        let Found::Nothing { aside: Some(told) } = look(folder, ID, SMALL).unwrap() else {
            panic!("it was left alone")
        };
        assert_eq!(
            told,
            "the log 084-wet.mcap is gone; 084-wet.toml says complete: kept as 084-wet.interrupted-2, driven again"
        );
        assert_eq!(names(folder), ["084-wet.interrupted-1.mcap", "084-wet.interrupted-2.toml"]);
    }

    #[test]
    fn an_empty_sidecar_is_put_aside_and_one_that_a_person_broke_is_reported_with_its_line() {
        for empty in ["", "\0\0\0\0", "\n"] {
            let folder = tempfile::tempdir().unwrap();
            write(folder.path(), Some("log"), None);
            std::fs::write(folder.path().join("084-wet.toml"), empty).unwrap();
            assert!(matches!(look(folder.path(), ID, SMALL).unwrap(), Found::Nothing { aside: Some(_) }));
            assert_eq!(names(folder.path()), ["084-wet.interrupted-1.mcap", "084-wet.interrupted-1.toml"]);
        }
        let folder = tempfile::tempdir().unwrap();
        write(folder.path(), Some("log"), Some(RunStatus::Complete));
        let path = folder.path().join("084-wet.toml");
        let text = std::fs::read_to_string(&path).unwrap().replace("\"complete\"", "complete");
        std::fs::write(&path, text).unwrap();
        let error = look(folder.path(), ID, SMALL).unwrap_err().to_string();
        assert!(error.contains("084-wet.toml:"), "{error}");
        assert_eq!(names(folder.path()).len(), 2, "nothing was moved");
    }
}
