//! One axis: what it is doing, its reference, its loop.
//!
//! ```text
//! Disabled ─enable─► Holding ─home─► Homing ─► Holding
//!     ▲                │  ▲ ─move─► Moving ──────┘│
//!     │                │  └─excite► Exciting ► Stopping
//!     └── Coasting ◄───┴── any: category 0, or the end of category 1
//! ```

use crate::config::AxisConfig;
use crate::config::SPEED_NOISE_M_S;
use crate::encoder::Unwrap;
use crate::excite::{Asked, Exciter};
use crate::fault::{Fault, StopCategory};
use crate::feedback::{Cut, Ends, Feedback};
use crate::homing::{Homing, Next, Seen};
use crate::law::{Law, settled};
use crate::monitor::{Applied, Monitor};
use crate::profile::{Profile, State};
use crate::ramp::SpeedRamp;
use crate::request::{Excitation, Move};
use crate::shaper::ShapedProfile;
use crate::status::{AxisStatus, Phase, Refusal};
use crate::tick::{AxisCommand, AxisInput};
use crate::travel;

/// The reference as a function of the time since it began.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Plan {
    Still(f64),
    Move(ShapedProfile),
    Ramp(SpeedRamp),
}

impl Plan {
    fn sample(&self, time_s: f64) -> State {
        match self {
            Self::Still(position_m) => State::at_rest(*position_m),
            Self::Move(profile) => profile.sample(time_s),
            Self::Ramp(ramp) => ramp.sample(time_s),
        }
    }

    fn duration_s(&self) -> f64 {
        match self {
            Self::Still(_) => 0.0,
            Self::Move(profile) => profile.duration_s(),
            Self::Ramp(ramp) => ramp.duration_s(),
        }
    }
}

/// One axis of the carriage.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Axis {
    law: Law,
    encoder: Unwrap,
    /// Position of count 0, m.
    zero_m: f64,
    position_m: f64,
    speed_m_s: f64,
    is_homed: bool,
    was_low_end: bool,
    was_high_end: bool,
    phase: Phase,
    plan: Plan,
    elapsed_ticks: u32,
    reference: State,
    /// A stop ends with the torque off.
    is_final_stop: bool,
    homing: Homing,
    exciter: Option<Exciter>,
    /// Of the move under way, for an operator's stop: acceleration and jerk.
    smooth: (f64, f64),
    feedback: Feedback,
    monitor: Monitor,
    command: AxisCommand,
    is_saturated: bool,
    saturated_ticks: u32,
    /// The torque stays off at least this long: an encoder that failed cannot say that the axis is at rest.
    coast_ticks: u32,
    /// Found while acting, reported at the next tick.
    pending: Option<Fault>,
}

impl Axis {
    pub(crate) fn new(config: &AxisConfig, tick_us: u32, late_us: u32) -> Self {
        Self {
            law: Law::new(config, tick_us, late_us),
            encoder: Unwrap::default(),
            zero_m: 0.0,
            position_m: 0.0,
            speed_m_s: 0.0,
            is_homed: false,
            was_low_end: false,
            was_high_end: false,
            phase: Phase::Disabled,
            plan: Plan::Still(0.0),
            elapsed_ticks: 0,
            reference: State::at_rest(0.0),
            is_final_stop: false,
            homing: Homing::default(),
            exciter: None,
            smooth: (config.limits.acceleration_m_s2, 0.0),
            feedback: Feedback::default(),
            monitor: Monitor::default(),
            command: AxisCommand::default(),
            is_saturated: false,
            saturated_ticks: 0,
            coast_ticks: 0,
            pending: None,
        }
    }

    /// Takes the inputs of this tick and says what is wrong with them.
    pub(crate) fn sense(&mut self, input: &AxisInput, gap_us: f64) -> Option<Fault> {
        let law = &self.law;
        let moved = self.encoder.step(input.encoder_count);
        self.position_m = self.zero_m + self.encoder.count() as f64 * law.m_per_count;
        let raw_m_s = f64::from(moved) * law.m_per_count * 1e6 / gap_us;
        self.speed_m_s = settled(self.speed_m_s + law.speed_share * (raw_m_s - self.speed_m_s));

        let is_low_edge = input.is_low_end && !self.was_low_end;
        let is_high_edge = input.is_high_end && !self.was_high_end;
        (self.was_low_end, self.was_high_end) = (input.is_low_end, input.is_high_end);
        let is_enabled = self.command.is_enabled;
        let current_a = if input.current_a.is_finite() { input.current_a } else { 0.0 };
        let applied = Applied {
            volts: self.command.volts,
            is_enabled,
            error_m: self.error_m(),
            reference_m_s: self.reference.speed_m_s,
            speed_m_s: self.speed_m_s,
            feedback_v: self.feedback.last_v(),
        };
        let measured = self.monitor.step(&self.law, moved, gap_us, &AxisInput { current_a, ..*input }, applied);
        let is_low_allowed = self.phase == Phase::Homing;

        if !input.current_a.is_finite() {
            Some(Fault::NotFinite)
        } else if is_enabled && ((is_low_edge && !is_low_allowed) || is_high_edge) {
            Some(Fault::EndSwitch)
        } else if is_enabled && !input.is_amplifier_ready {
            Some(Fault::AmplifierNotReady)
        } else {
            measured.or(self.pending.take()).or_else(|| self.limits_kept())
        }
    }

    /// Speed and travel.
    fn limits_kept(&self) -> Option<Fault> {
        if !self.command.is_enabled {
            return None;
        }
        let is_outward = libm::fabs(self.speed_m_s) > SPEED_NOISE_M_S;
        if self.is_homed && self.phase != Phase::Homing && is_outward {
            let guard_m = 0.25 * self.law.limits.following_error_m;
            if !travel::is_stoppable(&self.law, self.position_m, self.speed_m_s, guard_m) {
                return Some(Fault::SoftLimit);
            }
        }
        let is_free = self.is_homed && self.phase != Phase::Homing;
        if libm::fabs(self.speed_m_s) <= self.law.limits.over_speed_m_s(is_free) {
            return None;
        }
        self.monitor.polarity_so_far(&self.law, self.error_m()).or(Some(Fault::OverSpeed))
    }

    /// Reference less position; `None` with the loop open.
    fn error_m(&self) -> Option<f64> {
        (!self.is_open_loop()).then_some(self.reference.position_m - self.position_m)
    }

    fn is_open_loop(&self) -> bool {
        self.phase == Phase::Exciting && self.exciter.is_some_and(|e| e.is_open_loop())
    }

    // --- Requests -----------------------------------------------------------------------------------------------------

    pub(crate) fn enable(&mut self, input: &AxisInput) -> Result<(), Refusal> {
        match self.phase {
            Phase::Disabled if !input.is_amplifier_ready => Err(Refusal::NotReady),
            Phase::Disabled => {
                self.hold(self.position_m);
                self.reference = State::at_rest(self.position_m);
                self.pending = None;
                self.restart_loop();
                self.monitor.watch_polarity();
                Ok(())
            }
            Phase::Holding => Ok(()),
            _ => Err(Refusal::Busy),
        }
    }

    pub(crate) fn disable(&mut self) -> Result<(), Refusal> {
        match self.phase {
            Phase::Disabled => Ok(()),
            Phase::Holding => {
                self.torque_off();
                Ok(())
            }
            _ => Err(Refusal::Busy),
        }
    }

    pub(crate) fn home(&mut self, input: &AxisInput) -> Result<(), Refusal> {
        self.standing()?;
        self.is_homed = false;
        let (homing, speed_m_s) = Homing::start(&self.law, self.reference.position_m, input.is_low_end);
        self.homing = homing;
        self.begin_from_rest(Phase::Homing);
        self.change_gently(speed_m_s);
        Ok(())
    }

    pub(crate) fn start_move(&mut self, asked: &Move, input: &AxisInput) -> Result<(), Refusal> {
        self.standing()?;
        self.free_to_move(input)?;
        let profile = travel::checked_move(&self.law, self.reference.position_m, asked)?;
        self.begin_from_rest(Phase::Moving);
        self.smooth = (asked.acceleration_m_s2, asked.jerk_m_s3);
        self.plan = Plan::Move(profile);
        Ok(())
    }

    pub(crate) fn excite(&mut self, asked: &Excitation, input: &AxisInput) -> Result<(), Refusal> {
        self.standing()?;
        if self.is_homed || !matches!(asked, Excitation::Jog { .. }) {
            self.free_to_move(input)?;
        }
        let is_towards_switch = |v: f64| (input.is_low_end && v <= 0.0) || (input.is_high_end && v >= 0.0);
        let speed_m_s = travel::checked_excitation(&self.law, self.reference.position_m, self.is_homed, asked)?;
        if let Excitation::Jog { volts, .. } = asked
            && is_towards_switch(*volts)
        {
            return Err(Refusal::BeyondTravel);
        }
        self.begin_from_rest(Phase::Exciting);
        self.exciter = Some(Exciter::new(asked, &self.law, self.position_m));
        self.ramp_to(speed_m_s, self.law.limits.acceleration_m_s2, 0.0);
        Ok(())
    }

    /// Homed, and both end switches closed.
    fn free_to_move(&self, input: &AxisInput) -> Result<(), Refusal> {
        if !self.is_homed {
            Err(Refusal::NotHomed)
        } else if input.is_low_end || input.is_high_end {
            Err(Refusal::EndSwitchOpen)
        } else {
            Ok(())
        }
    }

    fn standing(&self) -> Result<(), Refusal> {
        match self.phase {
            Phase::Holding => Ok(()),
            Phase::Disabled => Err(Refusal::Disabled),
            _ => Err(Refusal::Busy),
        }
    }

    // --- Stops --------------------------------------------------------------------------------------------------------

    /// Brings the axis to rest. With `is_astray` the reference no longer says where the axis is: the stop begins from what is measured.
    pub(crate) fn stop(&mut self, category: StopCategory, is_astray: bool) {
        match (self.phase, category) {
            (Phase::Disabled | Phase::Coasting, _) => {}
            (_, StopCategory::Zero) => self.torque_off(),
            (Phase::Stopping, StopCategory::One) if self.is_final_stop => {}
            (Phase::Stopping | Phase::Holding, StopCategory::Two) => {}
            _ => {
                let is_hard = category == StopCategory::One;
                let (acceleration_m_s2, jerk_m_s3) = if is_hard { self.hardest() } else { self.smooth };
                if is_astray || self.is_open_loop() {
                    self.restart_from_measured();
                }
                self.begin(Phase::Stopping);
                self.is_final_stop = category == StopCategory::One;
                self.ramp_to(0.0, acceleration_m_s2, jerk_m_s3);
            }
        }
    }

    /// What a fault takes away beyond torque: after an encoder fault the coordinate is unknown, and so is whether the axis still moves.
    pub(crate) fn distrust(&mut self, fault: Fault) {
        if matches!(fault, Fault::EncoderStuck | Fault::EncoderJump | Fault::EncoderIllegal | Fault::Polarity) {
            self.is_homed = false;
            let top_m_s = self.law.limits.over_speed_m_s(true);
            let slowest_m_s2 = libm::fmax(self.law.coast.coulomb_m_s2, 1e-3);
            self.coast_ticks = self.law.ticks(top_m_s / slowest_m_s2);
        }
    }

    fn torque_off(&mut self) {
        self.begin(Phase::Coasting);
        self.pending = None;
        self.command = AxisCommand::default();
    }

    fn restart_from_measured(&mut self) {
        self.reference = State { position_m: self.position_m, speed_m_s: self.speed_m_s, acceleration_m_s2: 0.0 };
        self.restart_loop();
    }

    fn restart_loop(&mut self) {
        self.feedback = Feedback::default();
        self.saturated_ticks = 0;
        self.is_saturated = false;
    }

    fn begin(&mut self, phase: Phase) {
        self.phase = phase;
        self.elapsed_ticks = 0;
        self.exciter = None;
        self.is_final_stop = false;
        self.smooth = self.hardest();
    }

    /// Acceleration and jerk (none) of a controlled stop.
    fn hardest(&self) -> (f64, f64) {
        (self.law.limits.acceleration_m_s2, 0.0)
    }

    /// Begins what only begins at rest: from here on polarity is judged.
    fn begin_from_rest(&mut self, phase: Phase) {
        self.begin(phase);
        self.monitor.watch_polarity();
    }

    fn hold(&mut self, position_m: f64) {
        self.begin(Phase::Holding);
        self.plan = Plan::Still(position_m);
    }

    fn ramp_to(&mut self, speed_m_s: f64, acceleration_m_s2: f64, jerk_m_s3: f64) {
        self.elapsed_ticks = 0;
        self.plan = Plan::Ramp(SpeedRamp::plan(self.reference, speed_m_s, acceleration_m_s2, jerk_m_s3));
    }

    /// A change of speed in homing that leaves the load hanging still.
    fn change_gently(&mut self, speed_m_s: f64) {
        let bounds = Homing::bounds(&self.law);
        self.ramp_to(speed_m_s, bounds.acceleration_m_s2, bounds.jerk_m_s3);
    }

    // --- Each tick ----------------------------------------------------------------------------------------------------

    /// The command of this tick.
    pub(crate) fn act(&mut self, input: &AxisInput) -> AxisCommand {
        match self.phase {
            Phase::Disabled => self.rest_without_torque(),
            Phase::Coasting => {
                self.coast_ticks = self.coast_ticks.saturating_sub(1);
                if self.coast_ticks == 0 && self.monitor.is_at_rest(&self.law) {
                    self.phase = Phase::Disabled;
                }
                self.rest_without_torque();
            }
            _ => self.drive(input),
        }
        self.command
    }

    fn rest_without_torque(&mut self) {
        self.reference = State::at_rest(self.position_m);
        self.plan = Plan::Still(self.position_m);
        self.command = AxisCommand::default();
        self.is_saturated = false;
    }

    fn drive(&mut self, input: &AxisInput) {
        let mut asked = Asked::Added(0.0);
        if self.phase == Phase::Homing {
            self.find_home(input);
        } else if self.phase == Phase::Exciting {
            asked = self.excitation();
        }
        self.elapsed_ticks = self.elapsed_ticks.saturating_add(1);
        let time_s = f64::from(self.elapsed_ticks) * self.law.tick_s;
        let is_over = time_s >= self.plan.duration_s();
        if let Asked::Open(volts) = asked {
            self.reference = State { position_m: self.position_m, speed_m_s: self.speed_m_s, acceleration_m_s2: 0.0 };
            self.give(Cut { volts, is_saturated: false, is_blocked: false });
            return;
        }
        self.reference = self.plan.sample(time_s);
        match self.phase {
            Phase::Moving if is_over => self.hold(self.reference.position_m),
            Phase::Stopping if is_over && self.is_final_stop => {
                self.torque_off();
                self.rest_without_torque();
                return;
            }
            Phase::Stopping if is_over => self.hold(self.reference.position_m),
            _ => {}
        }
        if libm::fabs(self.reference.position_m - self.position_m) > self.law.limits.following_error_m {
            self.pending = Some(Fault::FollowingError);
        }
        let added_v = if let Asked::Added(volts) = asked { volts } else { 0.0 };
        let ends = Ends { is_low: input.is_low_end, is_high: input.is_high_end };
        let cut = self.feedback.step(&self.law, self.reference, self.position_m, added_v, ends);
        if cut.is_blocked && self.phase == Phase::Homing && self.homing.is_settling() {
            self.stand_here();
        }
        self.give(cut);
    }

    /// Puts out a command that is finite and within the range, whatever it was.
    fn give(&mut self, cut: Cut) {
        self.is_saturated = cut.is_saturated;
        self.saturated_ticks = if cut.is_saturated { self.saturated_ticks.saturating_add(1) } else { 0 };
        if self.saturated_ticks > self.law.ticks.saturation {
            self.pending = self.pending.or(Some(Fault::Saturated));
        }
        let is_valid = libm::fabs(cut.volts) <= self.law.limit_v; // false for NaN
        if !is_valid {
            self.pending = Some(Fault::NotFinite);
        }
        self.command = AxisCommand { volts: if is_valid { cut.volts } else { 0.0 }, is_enabled: true };
    }

    fn excitation(&mut self) -> Asked {
        let is_at_speed = f64::from(self.elapsed_ticks) * self.law.tick_s >= self.plan.duration_s();
        let is_inside = !self.is_homed || travel::is_inside_soft(&self.law, self.position_m, self.speed_ahead_m_s());
        let asked = match &mut self.exciter {
            Some(exciter) if is_inside => exciter.step(self.position_m, is_at_speed),
            _ => Asked::Done,
        };
        let cap_m_s = if self.is_homed { self.law.limits.speed_m_s } else { self.law.limits.unhomed_speed_m_s };
        match asked {
            Asked::Open(volts) if libm::copysign(1.0, volts) * self.speed_m_s >= cap_m_s => Asked::Open(0.0),
            Asked::Done => {
                if self.exciter.is_some_and(|e| e.is_jog()) {
                    self.pending = self.pending.or(self.monitor.polarity_so_far(&self.law, None));
                }
                self.stop(StopCategory::Two, false);
                Asked::Added(0.0)
            }
            other => other,
        }
    }

    /// The speed, and what the estimate may lag behind under the command.
    fn speed_ahead_m_s(&self) -> f64 {
        let push_v = libm::fmax(0.0, libm::fabs(self.command.volts) - self.law.volts_coulomb_lower);
        self.speed_m_s + libm::copysign(push_v * self.law.lag_m_s_v, self.command.volts)
    }

    /// The load has lifted the axis from where it was to stand and nothing may pull it back: it stands where it is.
    fn stand_here(&mut self) {
        self.reference = State::at_rest(self.position_m);
        self.plan = Plan::Still(self.position_m);
        self.feedback = Feedback::default();
    }

    fn find_home(&mut self, input: &AxisInput) {
        let limits = self.law.limits;
        let elapsed_s = f64::from(self.elapsed_ticks) * self.law.tick_s;
        let seen = Seen {
            reference_m: self.reference.position_m,
            is_low_end: input.is_low_end,
            is_over: elapsed_s >= self.plan.duration_s(),
            is_at_rest: self.monitor.is_at_rest(&self.law),
            elapsed_s,
        };
        match self.homing.step(&self.law, seen) {
            Next::Carry => {}
            Next::Speed(speed_m_s) => self.change_gently(speed_m_s),
            Next::Brake { is_mark } => {
                if is_mark {
                    let shift_m = limits.low_switch_m - self.position_m;
                    self.zero_m += shift_m;
                    self.position_m += shift_m;
                    self.reference.position_m += shift_m;
                }
                self.ramp_to(0.0, limits.acceleration_m_s2, 0.0);
            }
            Next::Settle => {
                self.elapsed_ticks = 0;
                self.plan = Plan::Still(self.reference.position_m);
            }
            Next::Retreat(target_m) => {
                self.elapsed_ticks = 0;
                let profile = Profile::plan(self.reference.position_m, target_m, Homing::bounds(&self.law));
                self.plan = Plan::Move(ShapedProfile::new(profile, crate::shaper::Shaper::NONE));
            }
            Next::Homed => {
                self.is_homed = true;
                self.hold(self.reference.position_m);
            }
            Next::Failed => self.pending = Some(Fault::HomingFailed),
        }
    }

    // --- What it says -------------------------------------------------------------------------------------------------

    pub(crate) fn status(&self) -> AxisStatus {
        AxisStatus {
            phase: self.phase,
            is_homed: self.is_homed,
            count: self.encoder.count(),
            position_m: self.position_m,
            reference_m: self.reference.position_m,
            reference_m_s: self.reference.speed_m_s,
            reference_m_s2: self.reference.acceleration_m_s2,
            is_saturated: self.is_saturated,
        }
    }

    /// Whether this axis no longer shows the cause of `fault`.
    pub(crate) fn is_cured(&self, fault: Fault, input: &AxisInput) -> bool {
        match fault {
            Fault::NotFinite => input.current_a.is_finite(),
            Fault::OverCurrent => libm::fabs(input.current_a) <= self.law.limits.current_a,
            Fault::Overload => self.monitor.is_cool(),
            _ => true,
        }
    }

    pub(crate) fn phase(&self) -> Phase {
        self.phase
    }
}
