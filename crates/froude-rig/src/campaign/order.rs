//! What the thread of the rig is ordered to do, and what it answers.

use crate::carriage::plan::PlannedRun;
use froude_records::run::EventKind;

use crate::campaign::runner::error::RunnerError;
use crate::drive::{HostClock, Sample};

/// What the campaign orders.
pub(super) enum Order<'a> {
    /// Go to where a run begins: home both axes first, where they are not, and wait for the water.
    Begin {
        /// The run.
        run: &'a PlannedRun,
        /// Its number in the plan, from 1.
        number: u64,
        /// Home both axes first.
        is_first: bool,
    },
    /// Still, motion, still; recorded.
    Drive(&'a PlannedRun),
    /// Nothing: say what the trouble is.
    Report,
}

/// What comes back.
pub(super) enum Entry {
    /// A sample that is due to be recorded or shown, and its tick since the order began.
    Sample(u64, Sample),
    /// Something for the record, and its tick since the order began.
    Event(u64, EventKind, String),
    /// The order has ended; the last entry of it.
    Ended(Ended),
}

/// How an order ended.
pub(super) struct Ended {
    /// Done, with why the planned motion was not done where it was not; or what ended it.
    pub result: Result<Option<String>, RunnerError>,
    /// The last sample.
    pub last: Sample,
    /// Where the order's first tick lies on the host's clock.
    pub clock: Option<HostClock>,
}
