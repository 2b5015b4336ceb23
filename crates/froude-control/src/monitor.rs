//! Detection of what can go wrong at one axis, from the inputs alone.
//!
//! | fault | evidence |
//! | --- | --- |
//! | encoder jump | counts a tick change more than ten times what peak current can do, plus four counts |
//! | encoder stuck | that change, to no count at all; or no count for the set time although the torque must have moved the axis |
//! | encoder illegal | more illegal transitions within a second than allowed |
//! | polarity | from rest, the motor has taken in work over 4/5 of the set way, and in closed loop the axis is not where it was asked to be |
//! | polarity | under way, the axis runs from its reference against torque above breakaway for 5 ms, a fifth of the following error away |
//! | over-current | above the peak for 1 ms, or off the command by a quarter of the peak for 10 ms |
//! | overload | (I/I_c)² through a first-order lag of the winding's time constant passes 1 |
//!
//! A motor cannot stop within a tick; its encoder can. That is why a count that stands still at speed is a fault at once.
//! Torque must move an axis that stands (no count for 10 ms) when it changes by more than what may hold a load: friction's band 2C, and
//! (1/η − η_b) T of the gear for the torque T that it holds, which is (1 − η η_b)(h − C) where h is the largest torque; with the loop
//! open, when it is above breakaway. An axis that has just moved with its reference must go on when
//! the feedback adds more than stiction: it is stuck as soon as that addition would have carried it twenty counts. That finds a dead
//! encoder at 5 mm/s within 50 ms, before the loop has run away from it.

use crate::fault::Fault;
use crate::law::{Law, held_within, settled};
use crate::tick::AxisInput;

/// Quantisation of two differences, and one count for the latch's jitter, counts.
const COUNT_MARGIN: f64 = 4.0;
/// An error that a loop at rest may leave, counts.
const STUCK_ERROR_COUNTS: f64 = 8.0;
/// Breakaway is up to this much above C_eff (position, stiction).
const BREAKAWAY_FACTOR: f64 = 1.5;
/// Part of the configured way at which polarity is judged, so that the axis is at rest or cut within the whole.
const POLARITY_PART: f64 = 0.8;
/// What feedback may have to add before an axis that stopped goes on in its direction: stiction above C_eff, and the derivative's answer
/// to the last count, as a factor of C_eff.
const STICTION_FACTOR: f64 = 1.25;
/// Way that such an addition must have carried the axis, counts.
const STUCK_COUNTS: f64 = 20.0;
/// Below this speed of the reference its friction feed-forward is not whole, m/s.
const STEADY_M_S: f64 = 2e-3;
/// Running away: part of the following error, and speed, m/s.
const ASTRAY_PART: f64 = 0.2;
const ASTRAY_M_S: f64 = 0.03;
const MISMATCH_PART: f64 = 0.25;
/// Above this part of its limit the winding is too warm to clear an overload.
const COOL: f64 = 0.9;

/// What the monitor sees of the last tick's command.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Applied {
    pub volts: f64,
    pub is_enabled: bool,
    /// Reference less position, m; `None` with the loop open.
    pub error_m: Option<f64>,
    pub reference_m_s: f64,
    /// Estimate of the speed, m/s.
    pub speed_m_s: f64,
    /// Feedback's part of the command, V.
    pub feedback_v: f64,
}

/// Detectors of one axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Monitor {
    last_moved: f64,
    /// Feedback's part of the command at the last count under way; the speed and way that more of it would have given since.
    carried_v: Option<f64>,
    unseen_m_s: f64,
    unseen_m: f64,
    astray_ticks: u32,
    last_gap_us: f64,
    last_errors: Option<u32>,
    errors: u32,
    errors_ticks: u32,
    stuck_ticks: u32,
    /// Ticks since the last count; least and largest command once the axis must be standing.
    quiet_ticks: u32,
    volts_since_count: (f64, f64),
    /// Work of the command since rest, V counts; `None` once judged.
    work_v_counts: Option<f64>,
    way_counts: i64,
    over_current_ticks: u32,
    mismatch_ticks: u32,
    heat: f64,
    rest_count: i64,
    rest_ticks: u32,
}

impl Monitor {
    /// Looks at one tick: `moved` counts in `gap_us`, the tick's inputs, the command that was on since the last tick.
    pub(crate) fn step(
        &mut self,
        law: &Law,
        moved: i32,
        gap_us: f64,
        input: &AxisInput,
        applied: Applied,
    ) -> Option<Fault> {
        let encoder = self.encoder(law, f64::from(moved), gap_us, input, applied);
        self.rest(law, moved);
        let polarity = self.polarity(law, moved, applied);
        let current = self.current(law, input.current_a, applied);
        let is_carried_on = self.has_unseen_way(law, moved, applied);
        let astray = self.runs_away(law, applied);
        encoder.or(is_carried_on.then_some(Fault::EncoderStuck)).or(polarity).or(astray).or(current)
    }

    /// Feedback has added what must have carried on an axis that was under way, and no count came.
    fn has_unseen_way(&mut self, law: &Law, moved: i32, applied: Applied) -> bool {
        let direction = libm::copysign(1.0, applied.reference_m_s);
        let is_steady =
            applied.is_enabled && applied.error_m.is_some() && applied.reference_m_s * direction > STEADY_M_S;
        let is_with_it = f64::from(moved) * law.m_per_count * direction > 0.0;
        if !is_steady || moved != 0 {
            self.carried_v = (is_steady && is_with_it).then_some(applied.feedback_v);
            (self.unseen_m_s, self.unseen_m) = (0.0, 0.0);
            return false;
        }
        let Some(carried_v) = self.carried_v else { return false };
        let added_v = (applied.feedback_v - carried_v) * direction - STICTION_FACTOR * law.volts_coulomb;
        self.unseen_m_s = settled(libm::fmax(0.0, self.unseen_m_s + added_v * law.m_s_per_v_tick));
        self.unseen_m = settled(self.unseen_m + self.unseen_m_s * law.tick_s);
        self.unseen_m * law.counts_per_m > STUCK_COUNTS
    }

    /// The axis goes away from its reference although the torque is against it.
    fn runs_away(&mut self, law: &Law, applied: Applied) -> Option<Fault> {
        let error_m = applied.error_m.unwrap_or(0.0);
        let is_astray = applied.is_enabled
            && libm::fabs(error_m) > ASTRAY_PART * law.limits.following_error_m
            && libm::fabs(applied.speed_m_s) > ASTRAY_M_S
            && error_m * applied.speed_m_s < 0.0
            && error_m * applied.volts > 0.0
            && libm::fabs(applied.volts) > BREAKAWAY_FACTOR * law.volts_coulomb;
        self.astray_ticks = if is_astray { self.astray_ticks.saturating_add(1) } else { 0 };
        (self.astray_ticks >= law.ticks.astray).then_some(Fault::Polarity)
    }

    fn encoder(&mut self, law: &Law, moved: f64, gap_us: f64, input: &AxisInput, applied: Applied) -> Option<Fault> {
        let errors = input.encoder_errors.wrapping_sub(self.last_errors.unwrap_or(input.encoder_errors));
        self.last_errors = Some(input.encoder_errors);
        self.errors = self.errors.saturating_add(errors);
        self.errors_ticks = self.errors_ticks.saturating_add(1);
        let is_illegal = self.errors > law.limits.encoder_errors_per_s;
        if self.errors_ticks >= law.ticks.second {
            (self.errors, self.errors_ticks) = (0, 0);
        }

        // Counts that the last tick's speed would give in this tick's time.
        let expected = if gap_us == self.last_gap_us {
            self.last_moved
        } else if self.last_gap_us > 0.0 {
            self.last_moved * gap_us / self.last_gap_us
        } else {
            moved
        };
        (self.last_moved, self.last_gap_us) = (moved, gap_us);
        let is_jump = if gap_us <= law.late_us {
            libm::fabs(moved - expected) > law.jump_counts_us2 * gap_us * gap_us + COUNT_MARGIN
        } else {
            // Too late to say at what speed it was: only what the axis cannot go at all.
            libm::fabs(moved) > law.top_counts_us * gap_us + COUNT_MARGIN
        };

        self.quiet_ticks = if moved == 0.0 { self.quiet_ticks.saturating_add(1) } else { 0 };
        if self.quiet_ticks <= law.ticks.quiet || !applied.is_enabled {
            self.volts_since_count = (applied.volts, applied.volts);
        }
        let (low_v, high_v) = self.volts_since_count;
        let (low_v, high_v) = (libm::fmin(low_v, applied.volts), libm::fmax(high_v, applied.volts));
        self.volts_since_count = (low_v, high_v);
        let breakaway_v = BREAKAWAY_FACTOR * law.volts_coulomb;
        let is_driven = match applied.error_m {
            None => libm::fabs(applied.volts) > breakaway_v,
            Some(error_m) => {
                let largest_v = if high_v > -low_v { high_v } else { -low_v };
                let gear_v = law.held_band * libm::fmax(largest_v - law.volts_coulomb, 0.0);
                high_v - low_v > 2.0 * breakaway_v + gear_v
                    && libm::fabs(error_m) * law.counts_per_m > STUCK_ERROR_COUNTS
            }
        };
        let is_driven = applied.is_enabled && is_driven && moved == 0.0;
        self.stuck_ticks = if is_driven { self.stuck_ticks.saturating_add(1) } else { 0 };
        let is_stuck = self.stuck_ticks > law.ticks.stuck;

        if is_stuck || (is_jump && moved == 0.0) {
            Some(Fault::EncoderStuck)
        } else if is_jump {
            Some(Fault::EncoderJump)
        } else if is_illegal {
            Some(Fault::EncoderIllegal)
        } else {
            None
        }
    }

    fn rest(&mut self, law: &Law, moved: i32) {
        self.rest_count = self.rest_count.wrapping_add(i64::from(moved));
        if self.rest_count.unsigned_abs() > 1 {
            (self.rest_count, self.rest_ticks) = (0, 0);
        } else {
            self.rest_ticks = self.rest_ticks.saturating_add(1);
        }
        if self.is_at_rest(law) {
            (self.work_v_counts, self.way_counts) = (Some(0.0), 0);
        }
    }

    /// Within a count for a tenth of a second.
    pub(crate) fn is_at_rest(&self, law: &Law) -> bool {
        self.rest_ticks >= law.ticks.rest
    }

    fn polarity(&mut self, law: &Law, moved: i32, applied: Applied) -> Option<Fault> {
        if !applied.is_enabled {
            self.work_v_counts = None;
            return None;
        }
        let work =
            settled(self.work_v_counts? + applied.volts * f64::from(moved) * libm::copysign(1.0, law.m_per_count));
        self.work_v_counts = Some(work);
        self.way_counts = self.way_counts.wrapping_add(i64::from(moved));
        let way_m = libm::fabs(self.way_counts as f64 * law.m_per_count);
        if way_m < POLARITY_PART * law.limits.polarity_m {
            return None;
        }
        self.work_v_counts = None;
        (self.is_work_negative(law, work) && self.is_astray(law, applied.error_m)).then_some(Fault::Polarity)
    }

    fn is_work_negative(&self, law: &Law, work_v_counts: f64) -> bool {
        work_v_counts < -0.5 * law.volts_coulomb_lower * libm::fabs(self.way_counts as f64)
    }

    /// Judges polarity on the way so far, when something else ends it before the configured way: a jog's end, or over-speed.
    /// A way below twenty counts says nothing.
    pub(crate) fn polarity_so_far(&self, law: &Law, error_m: Option<f64>) -> Option<Fault> {
        let is_negative = self.is_work_negative(law, self.work_v_counts?);
        (self.way_counts.unsigned_abs() > 20 && is_negative && self.is_astray(law, error_m)).then_some(Fault::Polarity)
    }

    /// In closed loop: further from the reference than half its way since rest.
    fn is_astray(&self, law: &Law, error_m: Option<f64>) -> bool {
        let way_m = libm::fabs(self.way_counts as f64 * law.m_per_count);
        error_m.is_none_or(|e| libm::fabs(e) > 0.5 * way_m)
    }

    /// A new excitation or move is judged from here.
    pub(crate) fn watch_polarity(&mut self) {
        (self.work_v_counts, self.way_counts) = (Some(0.0), 0);
    }

    fn current(&mut self, law: &Law, current_a: f64, applied: Applied) -> Option<Fault> {
        let limits = &law.limits;
        let ratio = held_within(current_a * law.per_continuous_a, 1e3);
        self.heat = settled(self.heat + law.heat_share * (ratio * ratio - self.heat));
        let is_over = libm::fabs(current_a) > limits.current_a;
        self.over_current_ticks = if is_over { self.over_current_ticks.saturating_add(1) } else { 0 };
        let wanted_a = law.amplifier_a_v * applied.volts;
        let is_off = applied.is_enabled && libm::fabs(current_a - wanted_a) > MISMATCH_PART * limits.current_a;
        self.mismatch_ticks = if is_off { self.mismatch_ticks.saturating_add(1) } else { 0 };
        if self.over_current_ticks >= law.ticks.over_current || self.mismatch_ticks >= law.ticks.mismatch {
            Some(Fault::OverCurrent)
        } else if self.heat > 1.0 {
            Some(Fault::Overload)
        } else {
            None
        }
    }

    /// Whether the winding has cooled enough to clear an overload.
    pub(crate) fn is_cool(&self) -> bool {
        self.heat < COOL
    }
}
