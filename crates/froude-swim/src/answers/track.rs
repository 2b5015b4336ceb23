//! What a recording of joint angles comes to: means over its time, which no motion has to repeat.
//!
//! Speed is the way of the centre of mass through the water over the time. What the joints gave, less what drag and friction took, is kinetic and potential energy at the end less that at the beginning.
//!
//! **Units.** SI.

use crate::course::Recorded;
use crate::dynamics::{Dynamics, StateOf};
use crate::gait::Course;
use crate::joints::Drives;
use crate::means::{Effort, Means};
use crate::moving::{Passage, go};
use crate::robot::Robot;
use crate::seen::Seen;
use crate::swim::{NO_GAIN, STEPS, Status, SwimError, within};
use crate::trajectory::under_way;

/// Means over a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Tracked {
    /// How long it is, s.
    pub length_s: f64,
    /// Its means.
    pub means: Means,
    /// Its way, how the head lay, and what kinetic and potential energy it gained.
    pub passage: Passage,
    /// What it needs and loses.
    pub effort: Effort,
}

/// Steps between two rows of a recording, at least: a cubic between them is well followed by one.
const STEPS_PER_ROW: usize = 2;

impl<C: Dynamics> Robot<C> {
    /// Follows a recording from a beginning, in steps of `step_s` at most where it is given.
    ///
    /// # Errors
    ///
    /// [`SwimError`]: joints beyond their limits, an inertia that is not positive, a step that is not stable, a motion that diverges.
    pub fn follow(
        &self,
        track: &Recorded,
        drives: &Drives,
        begin: &StateOf<C>,
        step_s: Option<f64>,
    ) -> Result<Tracked, SwimError> {
        within(track, drives)?;
        let length_s = track.period_s();
        let (mut steps, stiffness) = self.steps(track, drives, step_s)?;
        if step_s.is_none() {
            steps = steps.max(STEPS_PER_ROW * track.rows()).max(STEPS);
        }
        let mut seen = Seen::new(&self.chain, drives, track);
        let mut moving = under_way(&self.chain, track, drives, [0.0; 3], begin, &[]);
        let passage = go(moving.as_mut(), length_s / steps as f64, steps, &mut |now| seen.see(now))
            .ok_or_else(SwimError::inertia)?;
        let means = passage.means(length_s);
        if !means.net_w.is_finite() {
            let step_s = length_s / steps as f64;
            let words = format!(
                "the motion diverges in steps of {step_s:e} s: take a shorter --step, and check lengths, masses and added masses for a slip of a unit"
            );
            return Err(SwimError::of(Status::NotPeriodic, words));
        }
        let effort = self.effort(&seen, drives, &means, (steps, stiffness), NO_GAIN * means.net_w.abs());
        Ok(Tracked { length_s, means, passage, effort })
    }
}
