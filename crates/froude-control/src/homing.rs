//! Homing: find the low end switch, set the coordinate there, leave it.
//!
//! 1. *Leave*: if the switch is open, go up until it is closed and a little further.
//! 2. *Approach*: go down at the capped speed until it opens. There the coordinate is set, good to the way of one tick.
//! 3. *Brake*, then *retreat* to just inside the soft limit.
//!
//! The switch blocks the drive towards its end only. A switch that does not open or close on the way on which it had to
//! is a fault.

use crate::law::Law;
use crate::profile::Bounds;

/// How far beyond the closing of the switch the approach begins, m: room to turn around, and beyond its bounce.
const LEAVE_M: f64 = 5e-3;
/// How far inside the soft limit homing ends, m.
const INSIDE_M: f64 = 1e-3;
/// What mounting may add to the ways in the configuration, m.
const WAY_MARGIN_M: f64 = 20e-3;

#[derive(Debug, Clone, Copy, PartialEq, Default)]
enum Stage {
    #[default]
    Leave,
    Clear,
    Approach,
    Brake,
    Retreat,
}

/// Where homing stands.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Homing {
    stage: Stage,
    since_m: f64,
}

/// What the axis is to do.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Next {
    Carry,
    Speed(f64),
    /// The mark is here: set the coordinate and brake.
    Mark,
    Retreat(f64),
    Homed,
    Failed,
}

impl Homing {
    /// Begins; also gives the first speed, m/s.
    pub(crate) fn start(law: &Law, reference_m: f64, is_low_end: bool) -> (Self, f64) {
        let speed = law.limits.unhomed_speed_m_s;
        if is_low_end {
            (Self { stage: Stage::Leave, since_m: reference_m }, speed)
        } else {
            (Self { stage: Stage::Approach, since_m: reference_m }, -speed)
        }
    }

    /// Bounds of the retreat.
    pub(crate) fn bounds(law: &Law) -> Bounds {
        Bounds {
            speed_m_s: law.limits.unhomed_speed_m_s,
            acceleration_m_s2: law.limits.acceleration_m_s2,
            jerk_m_s3: 0.0,
        }
    }

    /// The next step. `is_over`: the change of speed, or the retreat, is complete.
    pub(crate) fn step(&mut self, law: &Law, reference_m: f64, is_low_end: bool, is_over: bool) -> Next {
        let limits = &law.limits;
        let way_m = libm::fabs(reference_m - self.since_m);
        match self.stage {
            Stage::Leave if !is_low_end => {
                *self = Self { stage: Stage::Clear, since_m: reference_m };
                Next::Carry
            }
            Stage::Leave if way_m > limits.low_switch_m - limits.hard_low_m + WAY_MARGIN_M => Next::Failed,
            Stage::Clear if way_m >= LEAVE_M => {
                *self = Self { stage: Stage::Approach, since_m: reference_m };
                Next::Speed(-limits.unhomed_speed_m_s)
            }
            Stage::Approach if is_low_end && !is_over => {
                // So near that the speed is not reached: go back and come again.
                *self = Self { stage: Stage::Leave, since_m: reference_m };
                Next::Speed(limits.unhomed_speed_m_s)
            }
            Stage::Approach if is_low_end => {
                self.stage = Stage::Brake;
                Next::Mark
            }
            Stage::Approach if way_m > limits.hard_high_m - limits.hard_low_m + WAY_MARGIN_M => Next::Failed,
            Stage::Brake if is_over => {
                self.stage = Stage::Retreat;
                Next::Retreat(law.soft_low_m + INSIDE_M)
            }
            Stage::Retreat if is_over && is_low_end => Next::Failed,
            Stage::Retreat if is_over => Next::Homed,
            _ => Next::Carry,
        }
    }
}
