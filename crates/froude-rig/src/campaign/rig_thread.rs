//! The rig's own thread: it ticks, whatever else is waiting.
//!
//! It carries out the orders of the campaign. Between them a real rig goes on being ticked, so that the board hears from its host and the
//! telemetry is read while a person is asked, a disk is slow or logs are read; what goes wrong meanwhile is reported at once. A twin
//! stands still between orders: its time passes only when it is ticked, which keeps a campaign on it fast and bit-equal.
//!
//! Nothing here writes to a disk or a terminal, and on a real rig no lock is waited for.

use froude_control::fault::StopCategory;
use froude_control::request::Request;
use froude_records::run::EventKind;

use super::hand_over::{Engine, Next, Pace};
use super::runner::error::RunnerError;
use super::runner::session::Session;
use super::stop::{Asked, StopSwitch};
use crate::campaign::order::{Ended, Entry, Order};
use crate::campaign::runner::error::PATIENCE_S;
use crate::campaign::runner::setting::{Setting, said_of};
use crate::drive::{Rig, Sample, Stranger};

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
                match (sample.fault, sample.stranger) {
                    (Some((fault, _)), _) => Some(RunnerError::FaultAtRest { fault }),
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
