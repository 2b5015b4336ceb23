//! A plan over what a campaign's folder holds.
//!
//! Cases whose inputs are the same keep their results; others are new. What the plan does not want, and cases of the same name with other inputs, are moved to `aside/NNN/`, never deleted, and come back with their results when a later plan wants them again. The campaign's file is written last, so that a plan that was killed is ended by planning again.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use crate::case::{CASE_FILE, Case};
use crate::input;
use crate::lock::Lock;
use crate::store::{CAMPAIGN_FILE, CASES, Index, Planned, Store, is_name};
use crate::store_error::StoreError;

const ASIDE: &str = "aside";

/// What a plan changed.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Change {
    /// Cases that stay as they are.
    pub kept: Vec<String>,
    /// Cases that are new.
    pub new: Vec<String>,
    /// Cases that an earlier plan had moved aside, and that are back.
    pub back: Vec<String>,
    /// Cases that the plan does not want, or wants with other inputs, and where they lie now.
    pub aside: Vec<(String, PathBuf)>,
}

/// Plans a campaign in a folder, which is made where it is missing. `inputs_sha256` is that of what the cases were made from ([`Store::was_planned_from`]).
///
/// # Errors
///
/// [`StoreError::Refused`] if a name is invalid or repeated, if a case starts from one that is not listed before it, or if a file cannot be written. [`StoreError::Held`] if the campaign, or a case to be moved, is running.
pub fn plan(root: &Path, cases: &[Case], inputs_sha256: &str) -> Result<(Store, Change), StoreError> {
    check(cases)?;
    only_own(root)?;
    let folder = root.join(CASES);
    std::fs::create_dir_all(&folder).map_err(|e| StoreError::file(&folder, e))?;
    let _lock = Lock::take(root)?;
    let mut change = Change::default();
    let wanted: BTreeMap<&str, &Case> = cases.iter().map(|c| (c.id.as_str(), c)).collect();
    let mut pile = None;
    for (id, path) in folders(&folder)? {
        if wanted.get(id.as_str()).is_some_and(|case| holds(&path, case)) {
            continue;
        }
        let at_work = Lock::take(&path)?;
        let pile = match &pile {
            Some(pile) => pile,
            None => pile.insert(new_pile(root)?),
        };
        let place = pile.join(&id);
        std::fs::rename(&path, &place).map_err(|e| StoreError::file(&path, e))?;
        at_work.release_in(&place);
        change.aside.push((id, place));
    }
    for case in cases {
        let path = folder.join(&case.id);
        if path.exists() {
            change.kept.push(case.id.clone());
        } else if let Some(old) = in_a_pile(root, case)? {
            std::fs::rename(&old, &path).map_err(|e| StoreError::file(&old, e))?;
            change.back.push(case.id.clone());
        } else {
            std::fs::create_dir(&path).map_err(|e| StoreError::file(&path, e))?;
            input::write_json(&path.join(CASE_FILE), case)?;
            change.new.push(case.id.clone());
            continue;
        }
        // Where it starts from is not among its inputs.
        if Case::read(&path).ok().as_ref() != Some(case) {
            input::write_json(&path.join(CASE_FILE), case)?;
        }
    }
    let cases = cases.iter().map(|c| Planned { id: c.id.clone(), hash: c.hash() }).collect();
    input::write_json(&root.join(CAMPAIGN_FILE), &Index { inputs_sha256: Some(inputs_sha256.to_owned()), cases })?;
    Ok((Store::open(root)?, change))
}

/// How names begin that a case's folder holds beside its file.
const OF_A_CASE: [&str; 5] = ["lock-", "attempt-", "retired-", "result.json", ".froude-unfinished-"];

/// Rejects a folder with a `campaign.json`, or with folders among its cases, that no plan wrote.
fn only_own(root: &Path) -> Result<(), StoreError> {
    if root.join(CAMPAIGN_FILE).symlink_metadata().is_ok() {
        Store::open(root)?;
    }
    let cases = root.join(CASES);
    for (_, path) in if cases.is_dir() { folders(&cases)? } else { Vec::new() } {
        // One that a plan was killed in has no case.json yet.
        let is_own = |name: &str| OF_A_CASE.iter().any(|own| name.starts_with(own));
        let mut entries = std::fs::read_dir(&path).into_iter().flatten().flatten();
        if !path.join(CASE_FILE).exists() && entries.any(|e| !is_own(&e.file_name().to_string_lossy())) {
            let problem =
                "was not written by Froude: it holds no case.json; move it away, or name another folder in `cases`";
            return Err(StoreError::file(&path, problem));
        }
    }
    Ok(())
}

fn check(cases: &[Case]) -> Result<(), StoreError> {
    let mut known = std::collections::BTreeSet::new();
    for case in cases {
        let refuse = |problem: String| Err(StoreError::case(&case.id, problem));
        if !is_name(&case.id) {
            return refuse(
                "its name is that of a folder: 1 to 200 letters, digits, and -_.+ behind the first".to_owned(),
            );
        }
        if !is_name(&case.mesh) {
            return refuse(format!("{:?} is no name of a mesh's folder", case.mesh));
        }
        if let Some(from) = case.start_from.as_ref().filter(|from| !known.contains(from.as_str())) {
            return refuse(format!("it starts from {from:?}, which does not stand before it"));
        }
        if !known.insert(case.id.as_str()) {
            return refuse("another case has the same name".to_owned());
        }
    }
    Ok(())
}

/// Whether a folder holds a case with the inputs of this one.
fn holds(folder: &Path, case: &Case) -> bool {
    Case::read(folder).is_ok_and(|found| found.id == case.id && found.hash() == case.hash())
}

/// Folders of cases, with their names, in order.
fn folders(folder: &Path) -> Result<Vec<(String, PathBuf)>, StoreError> {
    let failed = |e: std::io::Error| StoreError::file(folder, e);
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        if is_name(&name) && entry.path().is_dir() {
            found.push((name, entry.path()));
        }
    }
    found.sort();
    Ok(found)
}

fn piles(root: &Path) -> Result<Vec<(String, PathBuf)>, StoreError> {
    let folder = root.join(ASIDE);
    if folder.exists() { folders(&folder) } else { Ok(Vec::new()) }
}

/// A new folder for what this plan moves.
fn new_pile(root: &Path) -> Result<PathBuf, StoreError> {
    let number = piles(root)?.iter().filter_map(|(name, _)| name.parse::<u32>().ok()).max().unwrap_or(0) + 1;
    let pile = root.join(ASIDE).join(format!("{number:03}"));
    std::fs::create_dir_all(&pile).map_err(|e| StoreError::file(&pile, e))?;
    Ok(pile)
}

/// The case in the newest pile that has it with the same inputs.
fn in_a_pile(root: &Path, case: &Case) -> Result<Option<PathBuf>, StoreError> {
    Ok(piles(root)?.into_iter().rev().map(|(_, pile)| pile.join(&case.id)).find(|path| holds(path, case)))
}
