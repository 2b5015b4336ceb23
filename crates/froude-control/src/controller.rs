//! The controller: both axes, one tick at a time.
//!
//! A tick is: take the inputs; latch the first fault and stop for it; carry out the request; move both axes on.

use crate::axis::Axis;
use crate::config::{Config, ConfigError};
use crate::fault::{Fault, StopCategory};
use crate::request::Request;
use crate::status::{Output, Phase, Refusal, Status};
use crate::tick::{AXES, AxisInput, Command, Tick};

/// Motion control of both axes. It is `Copy`: a copy of it at a tick and the ticks from there give the same commands, bit for bit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Controller {
    axes: [Axis; AXES],
    tick_us: u32,
    late_us: u32,
    host_silence_us: u32,
    tick: u64,
    last_us: Option<u32>,
    silent_us: u32,
    /// How long the latch's time has stood still while ticks came.
    stale_us: u32,
    fault: Option<(Fault, u8)>,
}

impl Controller {
    /// A controller with its power just switched on: disabled, not homed, no fault.
    ///
    /// # Errors
    ///
    /// [`ConfigError`] when a number is not plausible, or when the end switch leaves no room to coast.
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        config.check()?;
        let axis = |axis| Axis::new(axis, config.tick_us, config.late_us);
        let [y, x] = &config.axes;
        Ok(Self {
            axes: [axis(y), axis(x)],
            tick_us: config.tick_us,
            late_us: config.late_us,
            host_silence_us: config.host_silence_us,
            tick: 0,
            last_us: None,
            silent_us: 0,
            stale_us: 0,
            fault: None,
        })
    }

    /// The next command, from this tick and the ticks before it.
    ///
    /// Reads no clock, allocates nothing and cannot panic. The command is always finite and within the amplifier's range, and zero for an
    /// axis that is not enabled, whatever bits the tick holds.
    #[must_use]
    pub fn step(&mut self, tick: &Tick) -> Output {
        let gap_us = tick.latched_us.wrapping_sub(self.last_us.unwrap_or(tick.latched_us));
        self.last_us = Some(tick.latched_us);
        self.stale_us = if gap_us == 0 { self.stale_us.saturating_add(self.tick_us) } else { 0 };
        let passed_us = if gap_us == 0 { self.tick_us } else { gap_us };
        self.silent_us = if tick.is_host_heard { 0 } else { self.silent_us.saturating_add(passed_us) };

        self.sense(tick, passed_us);
        let refusal = tick.request.as_ref().and_then(|request| self.carry_out(request, tick).err());

        let mut command = Command::default();
        let mut status = Status { tick: self.tick, fault: self.fault, refusal, ..Status::default() };
        let outputs = command.axes.iter_mut().zip(status.axes.iter_mut());
        for ((axis, input), (command, status)) in self.axes.iter_mut().zip(&tick.axes).zip(outputs) {
            *command = axis.act(input);
            *status = axis.status();
        }
        self.tick = self.tick.wrapping_add(1);
        Output { command, status }
    }

    /// Takes the inputs and stops for what is wrong with them. The first fault is latched; a later one still stops.
    fn sense(&mut self, tick: &Tick, gap_us: u32) {
        let is_enabled = self.axes.iter().any(|a| !matches!(a.phase(), Phase::Disabled | Phase::Coasting));
        let axis_gap_us = f64::from(gap_us);
        let mut found = [None; AXES];
        for ((axis, input), found) in self.axes.iter_mut().zip(&tick.axes).zip(found.iter_mut()) {
            *found = axis.sense(input, axis_gap_us);
        }
        if tick.is_estop_open {
            self.latch(Fault::EmergencyStop, AXES as u8);
        }
        for (found, axis) in found.iter().zip(self.axes.iter_mut()) {
            if let Some(fault) = found {
                axis.distrust(*fault);
            }
        }
        for (number, found) in (0..).zip(found) {
            if let Some(fault) = found {
                self.latch(fault, number);
            }
        }
        if is_enabled && (gap_us > self.late_us || self.stale_us > self.late_us) {
            self.latch(Fault::TickLate, AXES as u8);
        }
        if is_enabled && self.silent_us > self.host_silence_us {
            self.latch(Fault::HostSilent, AXES as u8);
        }
    }

    fn latch(&mut self, fault: Fault, axis: u8) {
        let is_first = self.fault.is_none();
        self.fault = self.fault.or(Some((fault, axis)));
        let is_astray = matches!(fault, Fault::FollowingError | Fault::Saturated | Fault::OverSpeed | Fault::SoftLimit);
        // A controlled stop that cannot be followed is none.
        let has_failed = !is_first && matches!(fault, Fault::FollowingError | Fault::Saturated);
        let category = if has_failed { StopCategory::Zero } else { fault.category() };
        for (number, a) in (0..).zip(self.axes.iter_mut()) {
            a.stop(category, is_astray && number == axis);
        }
    }

    fn carry_out(&mut self, request: &Request, tick: &Tick) -> Result<(), Refusal> {
        match *request {
            Request::Stop(category) => {
                self.axes.iter_mut().for_each(|a| a.stop(category, false));
                Ok(())
            }
            Request::RecorderFailed => {
                self.latch(Fault::RecorderFailed, AXES as u8);
                Ok(())
            }
            Request::Clear(fault) => self.clear(fault, tick),
            Request::Disable { axis } => self.ask(axis, tick, |a, _| a.disable()),
            _ if self.fault.is_some() => Err(Refusal::Faulted),
            Request::Enable { axis } => self.ask(axis, tick, Axis::enable),
            Request::Home { axis } => self.ask(axis, tick, Axis::home),
            Request::Move { axis, profile } => self.ask(axis, tick, |a, input| a.start_move(&profile, input)),
            Request::Excite { axis, excitation } => self.ask(axis, tick, |a, input| a.excite(&excitation, input)),
        }
    }

    fn ask(
        &mut self,
        number: usize,
        tick: &Tick,
        what: impl FnOnce(&mut Axis, &AxisInput) -> Result<(), Refusal>,
    ) -> Result<(), Refusal> {
        match self.axes.iter_mut().zip(&tick.axes).nth(number) {
            Some((axis, input)) => what(axis, input),
            None => Err(Refusal::NoSuchAxis),
        }
    }

    fn clear(&mut self, named: Fault, tick: &Tick) -> Result<(), Refusal> {
        let is_latched = self.fault.is_some_and(|(fault, _)| fault == named);
        let is_cured = self.axes.iter().zip(&tick.axes).all(|(axis, input)| axis.is_cured(named, input));
        let is_still_open = named == Fault::EmergencyStop && tick.is_estop_open;
        if !is_latched || !is_cured || is_still_open {
            return Err(Refusal::NotCleared);
        }
        if !self.axes.iter().all(|a| a.phase() == Phase::Disabled) {
            return Err(Refusal::Busy);
        }
        self.fault = None;
        Ok(())
    }
}
