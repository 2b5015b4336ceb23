//! The folder of a campaign: its cases, the attempts at each, and the one result of each that counts.
//!
//! ```text
//! CAMPAIGN/campaign.json                      cases in their order, with the hashes of their inputs
//! CAMPAIGN/meshes/<hash>/                     meshes
//! CAMPAIGN/cases/<id>/case.json               a case
//! CAMPAIGN/cases/<id>/attempt-001/            what the solver wrote
//! CAMPAIGN/cases/<id>/attempt-001/result.json what that came to
//! CAMPAIGN/cases/<id>/result.json             the one that counts
//! CAMPAIGN/aside/001/<id>/                    cases that a new plan does not want
//! ```
//!
//! All that is known of a case is in these files, so that a campaign goes on after any kill, on any host that sees the folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use froude_records::output::stays;
use serde::{Deserialize, Serialize};

use crate::case::{CASE_FILE, Case};
use crate::input;
use crate::lock::{Holder, Lock};
use crate::outcome::Status;
use crate::result::{self, Attempted};
use crate::store_error::StoreError;

/// Name of a campaign's file.
pub const CAMPAIGN_FILE: &str = "campaign.json";
/// Name of the folder of cases.
pub const CASES: &str = "cases";

/// A campaign's folder.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Store {
    root: PathBuf,
    index: Index,
}

/// What a campaign's file holds.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Index {
    /// SHA-256 of what the cases were planned from; an older file has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inputs_sha256: Option<String>,
    /// Its cases, each behind the one that it starts from.
    pub cases: Vec<Planned>,
}

/// A case that a plan wants.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Planned {
    /// Name of its folder.
    pub id: String,
    /// Hash of its inputs.
    pub hash: String,
}

/// How far a case is, by its files alone.
#[derive(Debug, Clone, PartialEq)]
pub enum State {
    /// Nobody has begun it.
    Planned,
    /// Somebody is at it.
    Running(Holder),
    /// It has been tried, and the attempt ended without a result.
    Interrupted,
    /// It has a result.
    Done(Box<Attempted>),
    /// A file of it is not what was written, and why.
    Edited(String),
}

impl State {
    /// How its result ended, if it has one.
    #[must_use]
    pub fn status(&self) -> Option<Status> {
        match self {
            Self::Done(attempted) => Some(attempted.outcome.status),
            _ => None,
        }
    }

    /// Whether a run has it to do.
    #[must_use]
    pub fn is_open(&self) -> bool {
        matches!(self, Self::Planned | Self::Running(_) | Self::Interrupted)
    }
}

impl Store {
    /// Opens a campaign that was planned.
    ///
    /// # Errors
    ///
    /// [`StoreError::Refused`]: the folder holds no campaign, or its campaign file is invalid.
    pub fn open(root: &Path) -> Result<Self, StoreError> {
        let path = root.join(CAMPAIGN_FILE);
        let wrong = |problem: String| {
            let next = "the file of a CFD campaign is written by froude cfd plan; move this one away, or name another folder in `cases`";
            StoreError::file(&path, format!("{problem}: {next}"))
        };
        let text = input::text(&path).map_err(|e| match e.kind() {
            std::io::ErrorKind::NotFound => {
                StoreError::file(&path, "is not there: nothing is planned yet; froude cfd plan plans it".to_owned())
            }
            _ => wrong(e.to_string()),
        })?;
        let index: Index = serde_json::from_str(&text).map_err(|e| wrong(e.to_string()))?;
        match index.cases.iter().find(|c| !is_name(&c.id)) {
            Some(case) => Err(wrong(format!("{:?} is no name of a case", case.id))),
            None => Ok(Self { root: root.to_owned(), index }),
        }
    }

    /// Opens the campaign that the folder of a case belongs to, with the case's name.
    ///
    /// # Errors
    ///
    /// As [`open`](Self::open); [`StoreError::Refused`] where the campaign does not have it.
    pub fn of_case(folder: &Path) -> Result<(Self, String), StoreError> {
        let whole = folder.canonicalize().map_err(|e| StoreError::file(folder, e))?;
        let root = whole.parent().and_then(Path::parent).unwrap_or(Path::new("/"));
        let id = whole.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let store = Self::open(root)?;
        store.planned(&id)?;
        Ok((store, id))
    }

    /// Where it lies.
    #[must_use]
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Whether its cases were planned from inputs with this hash; true if its file predates the hash.
    #[must_use]
    pub fn was_planned_from(&self, inputs_sha256: &str) -> bool {
        self.index.inputs_sha256.as_deref().is_none_or(|own| own == inputs_sha256)
    }

    /// Names of its cases, in the order of the plan.
    pub fn ids(&self) -> impl Iterator<Item = &str> {
        self.index.cases.iter().map(|c| c.id.as_str())
    }

    /// Folder of a case.
    #[must_use]
    pub fn case_folder(&self, id: &str) -> PathBuf {
        self.root.join(CASES).join(id)
    }

    /// Folder of a case's mesh.
    #[must_use]
    pub fn mesh_folder(&self, case: &Case) -> PathBuf {
        self.root.join("meshes").join(&case.mesh)
    }

    /// A case as it was planned.
    ///
    /// # Errors
    ///
    /// [`StoreError::Refused`] if the case is not planned, cannot be read, or its inputs differ from the plan.
    pub fn case(&self, id: &str) -> Result<Case, StoreError> {
        let planned = self.planned(id)?;
        let path = self.case_folder(id);
        let case = Case::read(&path).map_err(|e| StoreError::file(&path, e))?;
        let found = case.hash();
        if found != planned.hash || case.id != id {
            let next = "plan the campaign again: it moves the changed case aside and makes it anew";
            return Err(StoreError::edited(&path.join(CASE_FILE), [&found, &planned.hash], next));
        }
        Ok(case)
    }

    /// How far a case is.
    #[must_use]
    pub fn state(&self, id: &str) -> State {
        match self.look(id) {
            Ok(state) => state,
            Err(error) => State::Edited(error.to_string()),
        }
    }

    /// States of all cases by name.
    #[must_use]
    pub fn states(&self) -> BTreeMap<String, State> {
        self.ids().map(|id| (id.to_owned(), self.state(id))).collect()
    }

    /// The folder of the attempt whose result counts, of a case that another may start from.
    #[must_use]
    pub fn fields_of(&self, id: &str) -> Option<PathBuf> {
        match self.state(id) {
            State::Done(a) if a.outcome.status.is_usable() => {
                Some(result::attempt_folder(&self.case_folder(id), a.attempt))
            }
            _ => None,
        }
    }

    fn look(&self, id: &str) -> Result<State, StoreError> {
        let case = self.case(id)?;
        let folder = self.case_folder(id);
        if let Some(attempted) = result::accepted(&folder, &case)? {
            return Ok(State::Done(Box::new(attempted)));
        }
        if let Some(holder) = Lock::holder(&folder)? {
            return Ok(State::Running(holder));
        }
        // A worker may have ended in between.
        if let Some(attempted) = result::accepted(&folder, &case)? {
            return Ok(State::Done(Box::new(attempted)));
        }
        Ok(if result::open_attempts(&folder)?.is_empty() { State::Planned } else { State::Interrupted })
    }

    pub(crate) fn planned(&self, id: &str) -> Result<&Planned, StoreError> {
        let missing = || {
            let problem = format!("it has no case {id:?}; froude cfd status names those that it has");
            StoreError::file(&self.root, problem)
        };
        self.index.cases.iter().find(|c| c.id == id).ok_or_else(missing)
    }
}

/// Whether a text can be the name of a case's folder and stand in a shell's line.
pub(crate) fn is_name(id: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_.+".contains(c);
    !id.is_empty() && id.len() <= 200 && id.chars().all(is_plain) && !id.starts_with(['.', '-'])
}

/// Checks that nothing below a campaign's folder leads out of it by a link.
///
/// # Errors
///
/// [`StoreError::Refused`]: the link.
pub fn check_links(root: &Path) -> Result<(), StoreError> {
    for folder in [root.to_owned(), root.join(CASES)] {
        for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
            if entry.file_type().is_ok_and(|kind| kind.is_symlink()) && !stays(root, &entry.path()) {
                let problem =
                    "is a link that leads out of the campaign's folder, which alone is written into; remove it";
                return Err(StoreError::file(&entry.path(), problem));
            }
        }
    }
    Ok(())
}
