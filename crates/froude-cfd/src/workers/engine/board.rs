//! What a run still has to do, and which of it can begin.

use std::collections::BTreeMap;

use crate::case::Case;
use crate::cost::Cost;
use crate::engine::{Progress, Ran};
use crate::outcome::{Outcome, Status};
use crate::store::{State, Store};

/// The cases of a run and how each stands.
pub(crate) struct Board {
    cases: Vec<Entry>,
    place: BTreeMap<String, usize>,
    pub cost: Cost,
}

pub(crate) struct Entry {
    pub id: String,
    /// `None` of a case that cannot be read.
    pub case: Option<Case>,
    pub standing: Standing,
}

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Standing {
    Waiting,
    Running,
    Done(Status),
    /// Without a result in this run, and why.
    Left(String),
}

impl Board {
    /// All cases of a campaign by their files.
    pub fn of(store: &Store) -> Self {
        let mut cost = Cost::default();
        let entries = store.ids().map(|id| {
            let case = store.case(id).ok();
            let standing = match store.state(id) {
                State::Done(attempted) => {
                    if let Some(case) = &case {
                        cost.learn(case, &attempted.outcome);
                    }
                    Standing::Done(attempted.outcome.status)
                }
                State::Edited(why) => Standing::Left(why),
                State::Planned | State::Running(_) | State::Interrupted => {
                    if let Some(case) = &case {
                        cost.knows_mesh_of(store, case);
                    }
                    Standing::Waiting
                }
            };
            Entry { id: id.to_owned(), case, standing }
        });
        let cases: Vec<Entry> = entries.collect();
        let place = cases.iter().enumerate().map(|(k, c)| (c.id.clone(), k)).collect();
        Self { cases, place, cost }
    }

    /// The next case that can begin: one that waits, and for no other; it is running from now on.
    pub fn next(&mut self) -> Option<String> {
        let can_begin = |entry: &&Entry| entry.standing == Standing::Waiting && !self.waits_for_another(entry);
        let id = self.cases.iter().find(can_begin)?.id.clone();
        self.stands(&id, Standing::Running);
        Some(id)
    }

    /// Whether the case that a case starts from may still come to a result.
    fn waits_for_another(&self, entry: &Entry) -> bool {
        let from = entry.case.as_ref().and_then(|c| c.start_from.as_ref());
        let standing = from.and_then(|from| self.place.get(from)).and_then(|k| self.cases.get(*k)).map(|e| &e.standing);
        matches!(standing, Some(Standing::Waiting | Standing::Running))
    }

    /// The cases that wait and start from this one.
    pub fn waiting_on(&self, id: &str) -> Vec<String> {
        let starts_from = |e: &&Entry| e.case.as_ref().and_then(|c| c.start_from.as_deref()) == Some(id);
        let waiting = self.cases.iter().filter(|e| e.standing == Standing::Waiting);
        waiting.filter(starts_from).map(|e| e.id.clone()).collect()
    }

    /// Time of a processor that a case is expected to take, s.
    pub fn expected_s(&self, id: &str) -> f64 {
        let case = self.place.get(id).and_then(|k| self.cases.get(*k)).and_then(|e| e.case.as_ref());
        case.map_or(0.0, |case| self.cost.expected_s(case))
    }

    /// Sets how a case stands.
    pub fn stands(&mut self, id: &str, standing: Standing) {
        if let Some(entry) = self.place.get(id).and_then(|k| self.cases.get_mut(*k)) {
            entry.standing = standing;
        }
    }

    /// Takes a case's result.
    pub fn done(&mut self, id: &str, outcome: &Outcome) {
        if let Some(case) = self.place.get(id).and_then(|k| self.cases.get(*k)).and_then(|e| e.case.clone()) {
            self.cost.learn(&case, outcome);
        }
        self.stands(id, Standing::Done(outcome.status));
    }

    /// Names of the cases that stand so.
    pub fn standing(&self, wanted: impl Fn(&Standing) -> bool) -> Vec<String> {
        self.cases.iter().filter(|e| wanted(&e.standing)).map(|e| e.id.clone()).collect()
    }

    /// How far the run is.
    pub fn progress(&self) -> Progress {
        let mut progress = Progress::default();
        for entry in &self.cases {
            match &entry.standing {
                Standing::Done(status) => *progress.done.entry(*status).or_default() += 1,
                Standing::Running => progress.running += 1,
                Standing::Waiting => progress.waiting += 1,
                Standing::Left(_) => progress.left += 1,
            }
            if matches!(entry.standing, Standing::Waiting | Standing::Running) {
                progress.left_cpu_s += entry.case.as_ref().map_or(0.0, |case| self.cost.expected_s(case));
            }
        }
        progress
    }

    /// What the run came to.
    pub fn ran(self, was_cancelled: bool) -> Ran {
        let progress = self.progress();
        let left = self.cases.into_iter().filter_map(|entry| match entry.standing {
            Standing::Left(why) => Some((entry.id, why)),
            _ => None,
        });
        Ran { progress, left: left.collect(), was_cancelled }
    }
}
