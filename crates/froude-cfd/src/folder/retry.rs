//! Cases that are to be computed again.

use crate::lock::Lock;
use crate::result::retire;
use crate::store::{State, Store};
use crate::store_error::StoreError;

/// Sets the results of cases aside that failed or diverged, so that the next run computes them in a new attempt: all of these, or those that are named. A named case may also be one whose result was edited, or a file that it stands on.
///
/// Their old attempts stay. Returns the names.
///
/// # Errors
///
/// [`StoreError::Refused`] if a named case is unknown, has no result, has one that counts, or its inputs changed. [`StoreError::Held`] if the campaign is running. On error nothing is set aside.
pub fn retry(store: &Store, named: &[String]) -> Result<Vec<String>, StoreError> {
    let _lock = Lock::take(store.root())?;
    for id in named {
        store.case(id)?;
        let problem = match store.state(id) {
            State::Done(a) if a.outcome.status.is_usable() => "its result counts",
            State::Planned | State::Interrupted | State::Running(_) => {
                "it has no result yet; froude cfd run computes it"
            }
            State::Done(_) | State::Edited(_) => continue,
        };
        return Err(StoreError::case(id, problem));
    }
    let is_unusable = |id: &&str| store.state(id).status().is_some_and(|s| !s.is_usable());
    let chosen: Vec<String> = match named {
        [] => store.ids().filter(is_unusable).map(str::to_owned).collect(),
        _ => named.to_vec(),
    };
    for id in &chosen {
        let folder = store.case_folder(id);
        let _worker = Lock::take(&folder)?;
        retire(&folder)?;
    }
    Ok(chosen)
}
