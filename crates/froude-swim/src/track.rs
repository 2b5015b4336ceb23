//! What a recording of joint angles comes to: means over its time, which no motion has to repeat.
//!
//! Speed is the way of the centre of mass through the water over the time. What the joints gave, less what drag and friction took, is kinetic energy at the end less that at the beginning.
//!
//! **Units.** SI.

use crate::course::Recorded;
use crate::gait::Course;
use crate::joints::Drives;
use crate::moving::go;
use crate::robot::Robot;
use crate::seen::{Needs, Seen};
use crate::stability::Stiffness;
use crate::swim::{STEPS, SwimError, within};
use crate::trajectory::{Begin, under_way};

/// Means over a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Tracked {
    /// How long it is, s.
    pub length_s: f64,
    /// Speed of the centre of mass through the water, m/s.
    pub speed_m_s: f64,
    /// By how much the head has turned, rad.
    pub turn: f64,
    /// Mean of Σ τφ̇, W.
    pub net_w: f64,
    /// Mean of Σ max(τφ̇, 0), W.
    pub positive_w: f64,
    /// Mean of Σ |τφ̇|, W.
    pub absolute_w: f64,
    /// Mean of what drag takes, W.
    pub loss_w: f64,
    /// Mean of what friction of the joints takes, W.
    pub friction_w: f64,
    /// What motors take from the battery, W; `None` where their efficiency is not stated.
    pub electric_w: Option<f64>,
    /// Kinetic energy at the end less that at the beginning, J.
    pub gained_j: f64,
    /// What the joints need.
    pub needs: Needs,
    /// Steps of the time.
    pub steps: usize,
    /// What servos ask of a step.
    pub stiffness: Option<Stiffness>,
    /// As [`crate::swim::Swim`].
    pub extrapolated: [Option<f64>; 2],
    /// Share of the loss by the forces along the links.
    pub along: f64,
    /// Half of the loss is at smaller angles to the flow, rad.
    pub median_angle_rad: f64,
    /// As [`crate::swim::Swim`], of the mean net power.
    pub gain_w: Option<(usize, f64)>,
}

/// Steps between two rows of a recording, at least: a cubic between them is well followed by one.
const STEPS_PER_ROW: usize = 2;

impl Robot {
    /// Follows a recording from a beginning, in steps of `step_s` at most where it is given.
    ///
    /// # Errors
    ///
    /// [`SwimError`]: joints beyond their limits, an inertia that is not positive, a step that is not stable, a motion that diverges.
    pub fn follow(
        &self,
        track: &Recorded,
        drives: &Drives,
        begin: &Begin,
        step_s: Option<f64>,
    ) -> Result<Tracked, SwimError> {
        within(track, drives)?;
        let length_s = track.period_s();
        let (mut steps, stiffness) = self.steps(track, drives, step_s)?;
        if step_s.is_none() {
            steps = steps.max(STEPS_PER_ROW * track.rows()).max(STEPS);
        }
        let mut seen = Seen::new(self, drives, track);
        let mut moving = under_way(self, track, drives, [0.0; 2], begin, &[]);
        let passage =
            go(moving.as_mut(), length_s / steps as f64, steps, &mut |now| seen.see(now)).ok_or(SwimError::Inertia)?;
        let (end, [x, y]) = (&passage.end, passage.way_m);
        let net_w = end.work_j / length_s;
        if !net_w.is_finite() {
            return Err(SwimError::Diverged { step_s: length_s / steps as f64 });
        }
        let (positive_w, absolute_w) = (end.positive_j / length_s, end.absolute_j / length_s);
        Ok(Tracked {
            length_s,
            speed_m_s: x.hypot(y) / length_s,
            turn: end.heading - begin.heading,
            net_w,
            positive_w,
            absolute_w,
            loss_w: end.loss_j / length_s,
            friction_w: passage.friction_j / length_s,
            electric_w: drives.motor.electric_w(positive_w, absolute_w - positive_w),
            gained_j: passage.gained_j,
            needs: seen.needs(),
            steps,
            stiffness,
            extrapolated: seen.extrapolated(),
            along: seen.losses().along(),
            median_angle_rad: seen.losses().median_angle_rad(),
            gain_w: self.gain(seen.losses().fastest_m_s(), 1e-3 * net_w.abs()),
        })
    }
}
