//! Homing: find the low end switch, set the coordinate there, leave it.
//!
//! 1. *Leave*: if the switch is open, go up until it is closed and a little further.
//! 2. *Approach*: go down at the capped speed until it opens. There the coordinate is set, good to the way of one tick.
//! 3. *Brake*, *settle* until what swings on the chain has come to rest, then *retreat* to just inside the soft limit.
//!
//! The switch blocks the drive towards its end only: beyond it nothing can hold the axis against a load that swings back upwards. So
//! the axis gets there with a load that hangs still, whatever it weighs: every change of speed but the brake is spread over
//! [`ramp_s`], and the retreat waits until the swing of the brake is over. A load that lifts the axis meanwhile is let go.
//!
//! A switch that does not open or close on the way on which it had to is a fault, and so is an axis that does not come to rest.

use crate::law::Law;
use crate::profile::Bounds;

/// How far beyond the closing of the switch the approach begins, m: room to turn around, and beyond its bounce.
const LEAVE_M: f64 = 5e-3;
/// How far inside the soft limit homing ends, m.
const INSIDE_M: f64 = 1e-3;
/// What mounting may add to the ways in the configuration, m.
const WAY_MARGIN_M: f64 = 20e-3;
/// A change of speed takes at least this long, s: one and a half periods of a 3 Hz load. Its triangle of acceleration leaves of the
/// swing that a sudden change would give a part of at most (πfT/2)⁻² at the mode f, nothing where fT/2 is a whole number.
const GENTLE_S: f64 = 0.5;
/// And at most this long, s.
const GENTLEST_S: f64 = 2.0;
/// An axis that has not come to rest after this time never will, s.
const UNREST_S: f64 = 5.0;

#[derive(Debug, Clone, Copy, PartialEq, Default)]
enum Stage {
    #[default]
    Leave,
    Clear,
    Approach,
    Brake,
    Settle,
    Retreat,
}

/// Where homing stands.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Homing {
    stage: Stage,
    since_m: f64,
    /// The coordinate is set.
    is_marked: bool,
}

/// What a stage goes by.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Seen {
    /// Reference, m.
    pub reference_m: f64,
    /// The switch is open.
    pub is_low_end: bool,
    /// The change of speed, or the retreat, is complete.
    pub is_over: bool,
    /// The axis stays within a count.
    pub is_at_rest: bool,
    /// Time since the stage's motion began, s.
    pub elapsed_s: f64,
}

/// What the axis is to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Next {
    Carry,
    /// Change to this speed gently, m/s.
    Speed(f64),
    /// Stop as hard as allowed; with the mark, set the coordinate first.
    Brake {
        is_mark: bool,
    },
    /// Stand.
    Settle,
    Retreat(f64),
    Homed,
    Failed,
}

/// Time of a change of speed, s: two periods of the configured mode, or [`GENTLE_S`] where that is longer.
fn ramp_s(law: &Law) -> f64 {
    if law.mode_hz > 0.0 { libm::fmin(libm::fmax(2.0 / law.mode_hz, GENTLE_S), GENTLEST_S) } else { GENTLE_S }
}

impl Homing {
    /// Begins; also gives the first speed, m/s.
    pub(crate) fn start(law: &Law, reference_m: f64, is_low_end: bool) -> (Self, f64) {
        let speed = law.limits.unhomed_speed_m_s;
        if is_low_end {
            (Self::at(Stage::Leave, reference_m), speed)
        } else {
            (Self::at(Stage::Approach, reference_m), -speed)
        }
    }

    fn at(stage: Stage, since_m: f64) -> Self {
        Self { stage, since_m, is_marked: false }
    }

    /// Bounds of every change of speed but the brake, and of the retreat.
    pub(crate) fn bounds(law: &Law) -> Bounds {
        let speed_m_s = law.limits.unhomed_speed_m_s;
        let half_s = 0.5 * ramp_s(law);
        let acceleration_m_s2 = libm::fmin(speed_m_s / half_s, law.limits.acceleration_m_s2);
        Bounds { speed_m_s, acceleration_m_s2, jerk_m_s3: acceleration_m_s2 / half_s }
    }

    /// Whether the axis stands on its switch and waits: a load that swings may lift it.
    pub(crate) fn is_settling(&self) -> bool {
        self.stage == Stage::Settle
    }

    /// The next step.
    pub(crate) fn step(&mut self, law: &Law, seen: Seen) -> Next {
        let limits = &law.limits;
        let Seen { reference_m, is_low_end, is_over, .. } = seen;
        let way_m = libm::fabs(reference_m - self.since_m);
        match self.stage {
            Stage::Leave if !is_low_end => {
                *self = Self::at(Stage::Clear, reference_m);
                Next::Carry
            }
            Stage::Leave if way_m > limits.low_switch_m - limits.hard_low_m + WAY_MARGIN_M => Next::Failed,
            Stage::Clear if way_m >= LEAVE_M => {
                *self = Self::at(Stage::Approach, reference_m);
                Next::Speed(-limits.unhomed_speed_m_s)
            }
            Stage::Approach if is_low_end => {
                // So near that the speed is not reached, it is no mark: go back and come again.
                self.stage = Stage::Brake;
                self.is_marked = is_over;
                Next::Brake { is_mark: is_over }
            }
            Stage::Approach if way_m > limits.hard_high_m - limits.hard_low_m + WAY_MARGIN_M => Next::Failed,
            Stage::Brake if is_over => {
                self.stage = Stage::Settle;
                Next::Settle
            }
            Stage::Settle if seen.is_at_rest && seen.elapsed_s >= ramp_s(law) => {
                if self.is_marked {
                    self.stage = Stage::Retreat;
                    Next::Retreat(law.soft_low_m + INSIDE_M)
                } else {
                    *self = Self::at(Stage::Leave, reference_m);
                    Next::Speed(limits.unhomed_speed_m_s)
                }
            }
            Stage::Settle if seen.elapsed_s > UNREST_S => Next::Failed,
            Stage::Retreat if is_over && is_low_end => Next::Failed,
            Stage::Retreat if is_over => Next::Homed,
            _ => Next::Carry,
        }
    }
}
