//! The rig's own thread: it ticks, whatever else is waiting.
//!
//! It carries out the orders of the campaign. Between them a real rig goes on being ticked, so that the board hears from its host and the
//! telemetry is read while a person is asked, a disk is slow or logs are read; what goes wrong meanwhile is reported at once. A twin
//! stands still between orders: its time passes only when it is ticked, which keeps a campaign on it fast and bit-equal.
//!
//! Nothing here writes to a disk or a terminal, and on a real rig no lock is waited for.

use froude_control::fault::{Fault, StopCategory};
use froude_control::request::Request;
use froude_records::run::EventKind;

use super::hand_over::{Engine, Next, Pace};
use super::runner::{RunnerError, Session, Setting, said_of};
use super::stop::{Asked, StopSwitch};
use crate::drive::{HostClock, Rig, Sample, Stranger};
use froude_records::carriage::plan::PlannedRun;

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

/// How much of a real rig's telemetry may wait for a disk before the carriage is stopped, s.
pub(super) const PATIENCE_S: f64 = 10.0;
/// Entries of a twin that may wait: an eighth of a second, so that it never runs far ahead of who watches.
const TWIN_ENTRIES: usize = 512;

/// How a rig's thread waits, and how many entries may wait for the campaign.
pub(super) fn pace(rig: &dyn Rig) -> (Pace, usize) {
    if rig.is_real_time() {
        (Pace::RealTime, (PATIENCE_S * rig.rate_hz()).ceil() as usize)
    } else {
        (Pace::OnDemand, TWIN_ENTRIES)
    }
}

/// Ticks the rig until the campaign is over.
pub(super) fn attend<'a>(
    rig: &mut dyn Rig,
    mut engine: Engine<Order<'a>, Entry>,
    setting: &Setting,
    switch: &StopSwitch,
) {
    let mut idle = Idle::default();
    loop {
        match engine.next() {
            Next::Over => return,
            Next::Nothing => idle.tick(rig, &mut engine, switch),
            Next::Order(order) => {
                let trouble = idle.trouble.take();
                let ended = match (trouble, order) {
                    (Some(error), _) => Ended { result: Err(error), last: Sample::default(), clock: None },
                    (None, Order::Report) => Ended { result: Ok(None), last: Sample::default(), clock: None },
                    (None, Order::Begin { run, number, is_first }) => {
                        Session::new(setting, rig, switch, &mut engine, run, false)
                            .ordered(|session| session.begin(number, is_first).map(|()| None))
                    }
                    (None, Order::Drive(run)) => {
                        Session::new(setting, rig, switch, &mut engine, run, true).ordered(Session::motion)
                    }
                };
                if matches!(ended.result, Err(RunnerError::Rig(_))) {
                    engine.wait_from_now_on();
                }
                engine.put(Entry::Ended(ended));
            }
        }
    }
}

/// Between orders.
#[derive(Default)]
struct Idle {
    is_cut: bool,
    /// What the next order is answered with.
    trouble: Option<RunnerError>,
}

impl Idle {
    fn tick(&mut self, rig: &mut dyn Rig, engine: &mut Engine<Order<'_>, Entry>, switch: &StopSwitch) {
        let request = (!self.is_cut && switch.asked() == Asked::Cut).then(|| {
            self.is_cut = true;
            Request::Stop(StopCategory::Zero)
        });
        let trouble = match rig.tick(request) {
            Ok(sample) => {
                if let Some(stranger) = sample.stranger {
                    engine.put(Entry::Event(0, EventKind::Link, said_of(stranger)));
                }
                let fault =
                    |(fault, _): (Fault, u8)| RunnerError::FaultAtRest { fault, category: fault.category() as u8 };
                match (sample.fault, sample.stranger) {
                    (Some(latched), _) => Some(fault(latched)),
                    (None, Some(Stranger::Stopped(session))) => Some(RunnerError::StoppedAtRest { session }),
                    (None, _) => None,
                }
            }
            Err(error) => {
                engine.wait_from_now_on();
                Some(error.into())
            }
        };
        // A rig that another program has taken or stopped for good is the graver trouble.
        let is_graver = matches!(self.trouble, Some(RunnerError::StoppedAtRest { .. }))
            && !matches!(trouble, Some(RunnerError::StoppedAtRest { .. }));
        if (self.trouble.is_none() || is_graver) && trouble.is_some() {
            self.trouble = trouble;
            engine.call();
        }
    }
}
