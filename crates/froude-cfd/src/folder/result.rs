//! Results: each attempt writes its own, and exactly one of a case counts.
//!
//! The result of an attempt appears whole in its folder, with the hash of the case's inputs and a checksum of what it says. It is accepted by a hard link in the folder of the case, which never replaces one: whoever comes second, an attempt of a worker that was taken for dead or a job that ran twice, finds the place taken. A retry renames the link to `retired-NNN.json`, which says that the attempts up to NNN are not to be accepted again.

use std::collections::BTreeMap;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use froude_records::hash::sha256_of_bytes;
use froude_records::write::{Prepared, write_atomically};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

use crate::case::Case;
use crate::evidence;
use crate::input;
use crate::outcome::Outcome;
use crate::store_error::StoreError;
use crate::wall;

/// Name of a result's file.
pub const RESULT_FILE: &str = "result.json";
/// Room on the disk that is kept for the result while the solver runs.
const RESERVE_FILE: &str = "reserve";
const RESERVE_BYTES: usize = 32 * 1024;

/// What an attempt at a case came to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Attempted {
    /// Hash of the case's inputs.
    pub case: String,
    /// Number of the attempt, from 1.
    pub attempt: u32,
    /// What it came to.
    pub outcome: Outcome,
    /// Checksums of the files that it stands on, by their paths from the attempt's folder.
    pub files: BTreeMap<String, String>,
}

/// What a result's file holds: the text of an [`Attempted`] with its checksum.
#[derive(Serialize, Deserialize)]
struct Sealed {
    sha256: String,
    content: Box<RawValue>,
}

/// Begins an attempt: a new folder, which only this caller has.
///
/// # Errors
///
/// [`StoreError::Refused`]: the folder cannot be made, or the disk is full.
pub fn begin(case_folder: &Path) -> Result<(u32, PathBuf), StoreError> {
    loop {
        let number = attempts(case_folder)?.into_iter().max().unwrap_or(0) + 1;
        let folder = attempt_folder(case_folder, number);
        match std::fs::create_dir(&folder) {
            Err(e) if e.kind() == ErrorKind::AlreadyExists => {}
            Err(e) => return Err(StoreError::file(&folder, e)),
            Ok(()) => {
                let reserved = write_atomically(&folder.join(RESERVE_FILE), &vec![b'\n'; RESERVE_BYTES]);
                if reserved.is_err() {
                    // An attempt that never began.
                    let _ = std::fs::remove_dir(&folder);
                }
                reserved?;
                return Ok((number, folder));
            }
        }
    }
}

/// Writes the result of an attempt.
///
/// # Errors
///
/// [`StoreError::Refused`] where it cannot be written; a result with a number that is not finite is refused so.
pub fn write(case_folder: &Path, attempted: &Attempted) -> Result<(), StoreError> {
    let folder = attempt_folder(case_folder, attempted.attempt);
    let path = folder.join(RESULT_FILE);
    let text = seal(attempted).map_err(|problem| StoreError::file(&path, problem))?;
    let_go(&folder);
    Ok(write_atomically(&path, text.as_bytes())?)
}

/// Gives the room that was kept for a result back.
pub(crate) fn let_go(attempt_folder: &Path) {
    // What is not there need not be taken away.
    let _ = std::fs::remove_file(attempt_folder.join(RESERVE_FILE));
}

/// Accepts the result of an attempt, unless the case has one: true where it is this one that counts now.
///
/// # Errors
///
/// [`StoreError::Refused`] where the folder cannot be written.
pub fn accept(case_folder: &Path, attempt: u32) -> Result<bool, StoreError> {
    let its = attempt_folder(case_folder, attempt).join(RESULT_FILE);
    let place = case_folder.join(RESULT_FILE);
    match std::fs::hard_link(&its, &place) {
        Ok(()) => Ok(true),
        Err(e) if e.kind() == ErrorKind::AlreadyExists => Ok(false),
        Err(e) if matches!(e.kind(), ErrorKind::Unsupported | ErrorKind::PermissionDenied) => {
            let text = input::bytes(&its).map_err(|e| StoreError::file(&its, e))?;
            let taken = Prepared::new(&place, |out| out.write_all(&text))?.take_free_place();
            if taken.is_err() && place.exists() { Ok(false) } else { Ok(taken.map(|()| true)?) }
        }
        Err(e) => Err(StoreError::file(&place, e)),
    }
}

/// Takes the accepted result away, for another attempt; the attempts that there are keep theirs, and are not accepted again.
///
/// # Errors
///
/// [`StoreError::Refused`] where the folder cannot be written.
pub fn retire(case_folder: &Path) -> Result<(), StoreError> {
    let place = case_folder.join(RESULT_FILE);
    let newest = attempts(case_folder)?.into_iter().max().unwrap_or(0);
    std::fs::rename(&place, case_folder.join(format!("retired-{newest:03}.json")))
        .map_err(|e| StoreError::file(&place, e))
}

/// The result of a case that counts, once it has one.
///
/// # Errors
///
/// [`StoreError::Refused`]: it is not what was written, or a file that it stands on is not, or it belongs to other inputs.
pub fn accepted(case_folder: &Path, case: &Case) -> Result<Option<Attempted>, StoreError> {
    let found = read(&case_folder.join(RESULT_FILE), case)?;
    if let Some(attempted) = &found {
        evidence::verify(&attempt_folder(case_folder, attempted.attempt), &attempted.files)?;
    }
    Ok(found)
}

/// The newest attempt with a whole result that could be accepted: one that was killed before it was.
///
/// # Errors
///
/// [`StoreError::Refused`] where the folder cannot be read.
pub fn left_over(case_folder: &Path, case: &Case) -> Result<Option<Attempted>, StoreError> {
    let mut numbers = open_attempts(case_folder)?;
    numbers.sort_unstable_by(|a, b| b.cmp(a));
    let result_of = |n| read(&attempt_folder(case_folder, n).join(RESULT_FILE), case).ok().flatten();
    Ok(numbers.into_iter().find_map(|n| result_of(n).filter(|a| a.attempt == n)))
}

/// Numbers of all attempts at a case, in no order.
///
/// # Errors
///
/// [`StoreError::Refused`] where the folder cannot be read.
pub fn attempts(case_folder: &Path) -> Result<Vec<u32>, StoreError> {
    input::numbers(case_folder, ["attempt-", ""], u32::MAX)
}

/// Those of them that no retry has set aside.
///
/// # Errors
///
/// [`StoreError::Refused`] where the folder cannot be read.
pub fn open_attempts(case_folder: &Path) -> Result<Vec<u32>, StoreError> {
    let retired = input::numbers(case_folder, ["retired-", ".json"], u32::MAX)?.into_iter().max().unwrap_or(0);
    Ok(attempts(case_folder)?.into_iter().filter(|n| *n > retired).collect())
}

/// Folder of an attempt.
#[must_use]
pub fn attempt_folder(case_folder: &Path, attempt: u32) -> PathBuf {
    case_folder.join(format!("attempt-{attempt:03}"))
}

fn seal(attempted: &Attempted) -> Result<String, String> {
    let sealed = || -> serde_json::Result<String> {
        let text = serde_json::to_string_pretty(attempted)?;
        // A number that is not finite has no JSON, and would come back as none.
        serde_json::from_str::<Attempted>(&text)?;
        let sha256 = sha256_of_bytes(text.as_bytes());
        serde_json::to_string(&Sealed { sha256, content: RawValue::from_string(text)? })
    };
    sealed().map(|text| text + "\n").map_err(|e| format!("the result has no JSON ({e}); its numbers must be finite"))
}

const NEXT: &str = "froude cfd retry with its name computes the case again";

fn read(path: &Path, case: &Case) -> Result<Option<Attempted>, StoreError> {
    let text = match input::text(path) {
        Err(e) if e.kind() == ErrorKind::NotFound => return Ok(None),
        Err(e) => return Err(StoreError::file(path, format!("{e}; {NEXT}"))),
        Ok(text) => text,
    };
    let (attempted, sha256, found) =
        unseal(&text).map_err(|problem| StoreError::file(path, format!("{problem}; {NEXT}")))?;
    if found != sha256 {
        return Err(StoreError::edited(path, [&found, &sha256], NEXT));
    }
    let hash = case.hash();
    if attempted.case != hash {
        let problem = format!(
            "it is the result of other inputs: theirs have the hash {}, the case's {hash}; {NEXT}",
            attempted.case
        );
        return Err(StoreError::file(path, problem));
    }
    if attempted.outcome.status.is_usable() && attempted.outcome.loads.is_none() {
        return Err(StoreError::file(path, format!("it has no loads; {NEXT}")));
    }
    Ok(Some(Attempted { outcome: wall::judged(case, attempted.outcome), ..attempted }))
}

/// What a result says, the checksum that it states, and the one that it has.
fn unseal(text: &str) -> Result<(Attempted, String, String), String> {
    let sealed: Sealed = serde_json::from_str(text).map_err(|e| format!("it is no result: {e}"))?;
    let found = sha256_of_bytes(sealed.content.get().as_bytes());
    let attempted = serde_json::from_str(sealed.content.get()).map_err(|e| format!("it is no result: {e}"))?;
    Ok((attempted, sealed.sha256, found))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::outcome::Status;
    use proptest::prelude::*;

    fn attempted(fx_n: f64) -> Attempted {
        let outcome = Outcome {
            status: Status::Converged,
            reason: "the forces stand still".to_owned(),
            loads: Some([fx_n, 0.0, 0.0, 0.0, 0.0, 1e-300]),
            pressure: None,
            std_iterative: Some([0.1; 6]),
            iterations: 12,
            cpu_s: 0.1 + 0.2,
            y_plus: Some([0.1, 1.0, 2.0]),
            mesh: None,
            start_from: None,
            cells: 22_400,
            solver_version: "v1912".to_owned(),
        };
        Attempted { case: "hash".to_owned(), attempt: 1, outcome, files: BTreeMap::new() }
    }

    proptest! {
        #[test]
        fn what_was_sealed_comes_back_bit_by_bit(fx_n in any::<f64>()) {
            match seal(&attempted(fx_n)) {
                Ok(text) => {
                    let (back, stated, found) = unseal(&text).unwrap();
                    prop_assert_eq!(stated, found);
                    prop_assert_eq!(back, attempted(fx_n));
                }
                Err(problem) => {
                    prop_assert!(!fx_n.is_finite());
                    prop_assert!(problem.contains("must be finite"), "{}", problem);
                }
            }
        }

        #[test]
        fn one_changed_byte_never_gives_another_result(at in 0usize..600, byte in any::<u8>()) {
            let text = seal(&attempted(-1.25)).unwrap();
            let mut bytes = text.clone().into_bytes();
            let at = at % bytes.len();
            bytes[at] = byte;
            let Ok(changed) = String::from_utf8(bytes) else { return Ok(()) };
            if let Ok((back, stated, found)) = unseal(&changed) {
                prop_assert!(stated != found || back == attempted(-1.25));
            }
        }

        #[test]
        fn any_text_is_a_result_or_a_sentence(text in "\\PC*") {
            if let Err(problem) = unseal(&text) {
                prop_assert!(problem.starts_with("it is no result"));
            }
        }
    }
}
