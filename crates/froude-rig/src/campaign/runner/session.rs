//! One order at a time, on the rig's thread: begun, watched, ended.

use crate::carriage::plan::{Drive, PlannedRun};
use froude_control::fault::{Fault, StopCategory};
use froude_control::request::{Excitation, Move, Request};
use froude_control::status::{Phase, Refusal};
use froude_records::run::EventKind;

use super::super::hand_over::Engine;
use super::super::stop::{Asked, StopSwitch};
use super::error::RunnerError;
use crate::campaign::order::{Ended, Entry, Order};
use crate::campaign::runner::setting::{SHOWN_EVERY, SLOWEST_APPROACH_M_S, Setting, load_of, said_of};
use crate::drive::{Rig, Sample, Stranger};

/// Longest that a stop may take, s.
const STOP_S: f64 = 20.0;
/// Ticks within which a request is carried out or refused; a line that loses frames repeats it in the meantime.
const PATIENCE: usize = 4_000;
/// Further from its target than this no move has ended there, m: telemetry rounds to 0.1 µm.
const ARRIVED_M: f64 = 1e-5;
/// An excitation may seem this much shorter than it was, s: ticks before it was seen, and frames that were lost at its ends.
const UNSEEN_S: f64 = 0.05;
/// Part of a jog's way that must have been gone.
const JOGGED_PART: f64 = 0.9;

/// An order being carried out, on the rig's thread.
pub(in crate::campaign) struct Session<'a, 'o> {
    setting: &'a Setting,
    rig: &'a mut dyn Rig,
    switch: &'a StopSwitch,
    engine: &'a mut Engine<Order<'o>, Entry>,
    run: &'a PlannedRun,
    is_recorded: bool,
    /// Board's tick at which the order began.
    tick: Option<u64>,
    last: Sample,
}

impl<'a, 'o> Session<'a, 'o> {
    pub(in crate::campaign) fn new(
        setting: &'a Setting,
        rig: &'a mut dyn Rig,
        switch: &'a StopSwitch,
        engine: &'a mut Engine<Order<'o>, Entry>,
        run: &'a PlannedRun,
        is_recorded: bool,
    ) -> Self {
        Self { setting, rig, switch, engine, run, is_recorded, tick: None, last: Sample::default() }
    }

    /// Carries the order out and says how it ended.
    pub(in crate::campaign) fn ordered(
        mut self,
        order: impl FnOnce(&mut Self) -> Result<Option<String>, RunnerError>,
    ) -> Ended {
        let result = order(&mut self);
        let clock = self.tick.and_then(|tick| self.rig.host_clock(tick));
        Ended { result, last: self.last, clock }
    }

    fn axis(&self) -> usize {
        self.run.axis as usize
    }

    /// Goes to where the run starts and waits for the water; the last sample says what the rig has to be recorded.
    pub(in crate::campaign) fn begin(&mut self, number: u64, is_first: bool) -> Result<(), RunnerError> {
        self.rig.begin_run(&load_of(self.run, &self.setting.load), number);
        if is_first {
            self.prepare()?;
        }
        self.approach()?;
        self.wait(self.run.settle_s)?;
        self.tick(None).map(drop)
    }

    /// Enables and homes both axes.
    fn prepare(&mut self) -> Result<(), RunnerError> {
        for axis in [0, 1] {
            self.ask("enable the axis", Request::Enable { axis })?;
            self.ask("home the axis", Request::Home { axis })?;
            self.until("homing", self.setting.homing_s[axis], |s| {
                s.axes[axis].is_homed && s.axes[axis].phase == Phase::Holding
            })?;
        }
        Ok(())
    }

    /// Goes to where the run starts: as fast as allowed, with a hung weight no faster than the run itself; more slowly where the coast
    /// beyond the start would not fit into the travel.
    fn approach(&mut self) -> Result<(), RunnerError> {
        let mut speed_m_s = self.setting.return_speed_m_s;
        if let Drive::Profile { speed_m_s: own_m_s, .. } = self.run.drive
            && self.run.hung_weight_n != 0.0
        {
            speed_m_s = own_m_s;
        }
        let target_m = self.run.drive.from_m();
        loop {
            match self.go(target_m, speed_m_s) {
                Err(RunnerError::Refused { refusal: Refusal::BeyondTravel, .. })
                    if speed_m_s > SLOWEST_APPROACH_M_S =>
                {
                    speed_m_s *= 0.5;
                }
                other => return other,
            }
        }
    }

    fn go(&mut self, target_m: f64, speed_m_s: f64) -> Result<(), RunnerError> {
        let axis = self.axis();
        let s = &self.setting.asked;
        let profile = Move {
            target_m,
            speed_m_s,
            acceleration_m_s2: s.acceleration_m_s2,
            jerk_m_s3: s.jerk_m_s3.unwrap_or(0.0),
            is_shaped: self.setting.is_shaped,
        };
        self.ask("move", Request::Move { axis, profile })?;
        // The longest way at this speed, and time for ramps and shaping.
        let limit_s = 10.0 / speed_m_s.max(1e-3) + 30.0;
        let at_m = self.until("the move", limit_s, |s| s.axes[axis].phase == Phase::Holding)?.axes[axis].reference_m;
        if (at_m - target_m).abs() > ARRIVED_M {
            return Err(RunnerError::Elsewhere { run: self.run.id.clone(), target_m, at_m });
        }
        Ok(())
    }

    /// Still, motion, still. Gives why the planned motion was not done, where it was not.
    pub(in crate::campaign) fn motion(&mut self) -> Result<Option<String>, RunnerError> {
        self.rig.begin_recording();
        let still_s = self.setting.asked.still_s;
        self.wait(still_s)?;
        self.event(EventKind::Phase, "the motion begins");
        let cut = match self.run.drive {
            Drive::Profile { to_m, speed_m_s, .. } => {
                self.go(to_m, speed_m_s)?;
                None
            }
            Drive::Excitation { excitation, .. } => self.excite(excitation)?,
        };
        if let Some(why) = &cut {
            self.event(EventKind::Warning, why);
        }
        self.event(EventKind::Phase, "the motion has ended");
        self.wait(still_s)?;
        Ok(cut)
    }

    /// Excites the axis; gives why that was not all that was planned, where it was not.
    fn excite(&mut self, excitation: Excitation) -> Result<Option<String>, RunnerError> {
        let axis = self.axis();
        let (what, duration_s) = match excitation {
            Excitation::Pulses { duration_s, .. } => ("pulses", duration_s),
            Excitation::Relay { duration_s, .. } => ("relay", duration_s),
            Excitation::Sweep { duration_s, .. } => ("sweep", duration_s),
            Excitation::Jog { duration_s, .. } => ("jog", duration_s),
        };
        let begun = self.ask("excite", Request::Excite { axis, excitation })?;
        let mut last = None;
        let ended = self.until(what, duration_s + 30.0, |s| {
            if s.axes[axis].phase == Phase::Exciting {
                last = Some(s.tick);
            }
            s.axes[axis].phase == Phase::Holding
        })?;
        let rate_hz = self.rig.rate_hz() * self.rig.ticks_per_sample() as f64;
        let lasted_s = last.map_or(0.0, |tick| tick.saturating_sub(begun.tick) as f64 / rate_hz);
        let at_m = ended.axes[axis].position_m;
        if let Excitation::Jog { volts, distance_m, .. } = excitation {
            let gone_m = (at_m - begun.axes[axis].position_m).abs();
            return Ok((gone_m < JOGGED_PART * distance_m).then(|| {
                format!(
                    "the jog of {volts} V went {:.1} mm of {:.1} mm: a soft limit or its {duration_s} s ended it; polarity and encoder are not checked",
                    1e3 * gone_m,
                    1e3 * distance_m
                )
            }));
        }
        Ok((lasted_s + UNSEEN_S < duration_s).then(|| {
            format!(
                "the {what} ended after {lasted_s:.2} s of {duration_s} s, at {at_m:.3} m: the controller ends what would leave the soft limits"
            )
        }))
    }

    fn wait(&mut self, seconds: f64) -> Result<(), RunnerError> {
        for _ in 0..(seconds * self.rig.rate_hz()).round() as u64 {
            self.tick(None)?;
        }
        Ok(())
    }

    /// Hands over a request and waits until it has taken effect; gives the first sample that shows it.
    fn ask(&mut self, what: &'static str, request: Request) -> Result<Sample, RunnerError> {
        let mut sample = self.tick(Some(request))?;
        for _ in 0..PATIENCE {
            if let Some(refusal) = sample.refusal {
                return Err(RunnerError::Refused { run: self.run.id.clone(), what, refusal });
            }
            if has_begun(&sample, &request) {
                return Ok(sample);
            }
            sample = self.tick(None)?;
        }
        self.come_to_rest(Request::Stop(StopCategory::One), None)?;
        Err(RunnerError::Unanswered { run: self.run.id.clone(), what })
    }

    /// Goes on until it is done; gives the sample that shows it.
    fn until(
        &mut self,
        what: &'static str,
        limit_s: f64,
        mut done: impl FnMut(&Sample) -> bool,
    ) -> Result<Sample, RunnerError> {
        for _ in 0..(limit_s * self.rig.rate_hz()) as u64 {
            let sample = self.tick(None)?;
            if done(&sample) {
                return Ok(sample);
            }
        }
        self.come_to_rest(Request::Stop(StopCategory::One), None)?;
        Err(RunnerError::TooLong { run: self.run.id.clone(), what, limit_s })
    }

    /// One tick: driven, handed over, watched. Who asked for a stop gets it before anything else is asked of the rig.
    fn tick(&mut self, request: Option<Request>) -> Result<Sample, RunnerError> {
        match self.switch.asked() {
            Asked::Nothing => {}
            Asked::Stop => return Err(self.stopped(StopCategory::Two, "the operator asked for a stop (category 2)")),
            Asked::Cut => return Err(self.stopped(StopCategory::Zero, "the operator cut the torque (category 0)")),
        }
        if self.engine.is_unrecorded() {
            self.come_to_rest(Request::RecorderFailed, None)?;
            return Err(RunnerError::Behind { run: self.run.id.clone() });
        }
        let sample = self.rig_tick(request)?;
        if let Some(Stranger::Stopped(session)) = sample.stranger {
            self.rest_without_fault()?;
            return Err(RunnerError::StoppedByAnother { run: self.run.id.clone(), session });
        }
        if let Some((fault, _)) = sample.fault {
            let sentence = format!("{fault:?}: category {} stop", fault.category() as u8);
            self.event(EventKind::Fault, &sentence);
            self.until_rest()?;
            return Err(self.faulted(fault));
        }
        Ok(sample)
    }

    fn faulted(&self, fault: Fault) -> RunnerError {
        let run = self.run.id.clone();
        if self.is_recorded { RunnerError::Fault { run, fault } } else { RunnerError::FaultBefore { run, fault } }
    }

    /// Stops because the operator asked for it.
    fn stopped(&mut self, category: StopCategory, sentence: &str) -> RunnerError {
        match self.come_to_rest(Request::Stop(category), Some(sentence)) {
            Ok(()) => RunnerError::Stopped { run: self.run.id.clone() },
            Err(error) => error,
        }
    }

    /// Asks for a stop, then says so, and goes on ticking and recording until both axes are at rest; a second press of the switch cuts.
    fn come_to_rest(&mut self, request: Request, sentence: Option<&str>) -> Result<(), RunnerError> {
        self.rig_tick(Some(request))?;
        if let Some(sentence) = sentence {
            self.event(EventKind::Operator, sentence);
        }
        self.rest_without_fault()
    }

    /// Goes on until both axes are at rest; a fault on the way is an error.
    fn rest_without_fault(&mut self) -> Result<(), RunnerError> {
        self.until_rest()?;
        // That nobody records any more is a fault by intent; any other one came while the carriage was being stopped.
        match self.last.fault {
            Some((fault, _)) if fault != Fault::RecorderFailed => {
                self.event(EventKind::Fault, &format!("{fault:?}: category {} stop", fault.category() as u8));
                Err(self.faulted(fault))
            }
            _ => Ok(()),
        }
    }

    /// Goes on until both axes are at rest. A stop that takes too long is made as hard as the drive can.
    fn until_rest(&mut self) -> Result<(), RunnerError> {
        if self.is_soon_at_rest()? {
            return Ok(());
        }
        self.rig_tick(Some(Request::Stop(StopCategory::One)))?;
        if self.is_soon_at_rest()? { Ok(()) } else { Err(RunnerError::NotAtRest { run: self.run.id.clone() }) }
    }

    /// Waits until both axes are at rest, and a tenth of a second more, so that the record shows it; `false` when that takes too long.
    fn is_soon_at_rest(&mut self) -> Result<bool, RunnerError> {
        let mut is_cut = false;
        let mut rest_ticks = 0.0;
        for _ in 0..(STOP_S * self.rig.rate_hz()) as u64 {
            let request = (!is_cut && self.switch.asked() == Asked::Cut).then(|| {
                is_cut = true;
                Request::Stop(StopCategory::Zero)
            });
            let sample = self.rig_tick(request)?;
            let is_at_rest = sample.axes.iter().all(|a| matches!(a.phase, Phase::Disabled | Phase::Holding));
            rest_ticks = if is_at_rest { rest_ticks + 1.0 } else { 0.0 };
            if rest_ticks >= 0.1 * self.rig.rate_hz() {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// One tick of the rig; its sample is handed over where it is due to be recorded or shown.
    fn rig_tick(&mut self, request: Option<Request>) -> Result<Sample, RunnerError> {
        let sample = self.rig.tick(request)?;
        self.last = sample;
        self.tick.get_or_insert(sample.tick);
        let number = self.number();
        if let Some(stranger) = sample.stranger {
            self.event(EventKind::Link, &said_of(stranger));
        }
        let is_due = self.is_recorded && number.is_multiple_of(self.setting.decimation);
        if is_due || number.is_multiple_of(SHOWN_EVERY) {
            self.engine.offer(Entry::Sample(number, sample));
        }
        Ok(sample)
    }

    fn event(&mut self, kind: EventKind, sentence: &str) {
        let number = self.number();
        self.engine.put(Entry::Event(number, kind, sentence.to_owned()));
    }

    /// Ticks from the first sample of the order to the last one.
    fn number(&self) -> u64 {
        self.tick.map_or(0, |first| self.last.tick.saturating_sub(first))
    }
}

/// Whether a sample shows that a request is being carried out, or has been.
fn has_begun(sample: &Sample, request: &Request) -> bool {
    let phase = |axis: usize| sample.axes.get(axis).map_or(Phase::Disabled, |a| a.phase);
    match *request {
        Request::Enable { axis } => phase(axis) != Phase::Disabled,
        Request::Home { axis } => phase(axis) == Phase::Homing,
        Request::Move { axis, profile } => {
            phase(axis) == Phase::Moving
                || sample.axes.get(axis).is_some_and(|a| (a.reference_m - profile.target_m).abs() < ARRIVED_M)
        }
        // One that is ended at once is on its way to a stop already.
        Request::Excite { axis, .. } => matches!(phase(axis), Phase::Exciting | Phase::Stopping),
        _ => true,
    }
}
