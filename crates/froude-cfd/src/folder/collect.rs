//! The results of a campaign that count.

use crate::case::Case;
use crate::outcome::{Loads, Outcome};
use crate::store::{State, Store};

/// A case whose forces may reach a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Collected {
    /// The case.
    pub case: Case,
    /// What it came to.
    pub outcome: Outcome,
    /// Loads of the water on the body, body axes: N, and N m about the reference point.
    pub loads: Loads,
}

/// What a campaign came to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Collection {
    /// The cases whose forces may reach a fit, in the order of the plan.
    pub rows: Vec<Collected>,
    /// The others, and why not.
    pub without: Vec<(String, String)>,
}

/// Collects the results of a campaign that count; what failed, diverged, was edited or has no result is said apart.
///
/// The files that a result stands on are compared with their checksums.
#[must_use]
pub fn collect(store: &Store) -> Collection {
    let mut collection = Collection::default();
    for id in store.ids() {
        match collected(store, id) {
            Ok(row) => collection.rows.push(row),
            Err(why) => collection.without.push((id.to_owned(), why)),
        }
    }
    collection
}

fn collected(store: &Store, id: &str) -> Result<Collected, String> {
    let case = store.case(id).map_err(|e| e.to_string())?;
    let outcome = match store.state(id) {
        State::Done(attempted) => attempted.outcome,
        State::Edited(why) => return Err(why),
        State::Running(holder) => return Err(format!("it is running: {holder}")),
        State::Planned => return Err("nobody has begun it; froude cfd run computes it".to_owned()),
        State::Interrupted => {
            return Err("its last attempt ended without a result; froude cfd run tries again".to_owned());
        }
    };
    if !outcome.status.is_usable() {
        return Err(format!("{}: {}", outcome.status.word(), outcome.reason));
    }
    let Some(loads) = outcome.loads else { return Err("its result has no loads".to_owned()) };
    Ok(Collected { case, outcome, loads })
}
