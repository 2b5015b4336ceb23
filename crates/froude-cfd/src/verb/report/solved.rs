//! A case that has a result, and where it was solved.

use std::path::PathBuf;

use crate::again::Again;
use crate::case::Case;
use crate::outcome::Outcome as Ended;
use crate::result::attempt_folder;
use crate::store::{State, Store};
use crate::verb::error::VerbError;

/// A case that has a result.
#[derive(Debug, Clone)]
pub(super) struct Solved {
    pub(super) case: Case,
    pub(super) outcome: Ended,
    /// Where it was solved.
    pub(super) folder: PathBuf,
    pub(super) mesh: PathBuf,
}

impl Solved {
    pub(super) fn of(store: &Store, id: &str) -> Result<Option<Self>, VerbError> {
        let State::Done(attempted) = store.state(id) else { return Ok(None) };
        let case = store.case(id)?;
        Ok(Some(Self {
            folder: attempt_folder(&store.case_folder(id), attempted.attempt),
            mesh: store.mesh_folder(&case),
            outcome: attempted.outcome,
            case,
        }))
    }

    /// Whether it computes another again, and enters no fit.
    pub(super) fn is_repeat(&self) -> bool {
        Again::of(&self.case.id).is_some()
    }
}
