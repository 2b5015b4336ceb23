//! What is seen of a swimmer on its way: what its links lose and where, and what its joints need.
//!
//! **Units.** SI.

use crate::dynamics::Dynamics;
use crate::gait::{Course, Shape};
use crate::joints::Drives;
use crate::losses::{Loss, Losses};
use crate::moving::Instant;

/// A torque within this part of what a motor gives is at its limit.
const AT_LIMIT: f64 = 1e-9;

/// What joints need.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Needs {
    /// Largest torque of a motor, N m.
    pub torque_n_m: f64,
    /// Largest rate of a joint, rad/s.
    pub rate_rad_s: f64,
    /// Largest part of what the motor's curve gives at its speed; beyond 1 it does not give it.
    pub share: f64,
    /// The joint, from 1, whose torque is furthest beyond its limit, with both, N m; `None` where none is.
    pub beyond: Option<(usize, f64, f64)>,
    /// Largest angle by which a joint is away from its gait, rad.
    pub away_rad: f64,
    /// The part of the time, over all joints, at which a servo gives all that it can.
    pub at_limit: f64,
    /// Largest angle of a joint, rad.
    pub angle_rad: f64,
    /// Whether a joint needs more than its drive gives or, with servos, goes beyond its limits of angle or rate.
    pub is_beyond: bool,
}

impl Needs {
    /// A moment of a joint, counted from 0.
    fn see(&mut self, drives: &Drives, joint: usize, torque_n_m: f64, rate: f64) {
        self.torque_n_m = self.torque_n_m.max(torque_n_m.abs());
        self.rate_rad_s = self.rate_rad_s.max(rate.abs());
        self.share = self.share.max(drives.motor.share(torque_n_m, rate));
        if let Some(limit) = drives.limits.get(joint).and_then(|l| l.torque_n_m)
            && torque_n_m.abs() > limit
            && self.beyond.is_none_or(|(_, most, of)| torque_n_m.abs() * of > most * limit)
        {
            self.beyond = Some((joint + 1, torque_n_m.abs(), limit));
        }
        // Servos get no more than there is.
        self.is_beyond |= drives.following.is_empty() && (self.beyond.is_some() || self.share > 1.0);
    }
}

/// All of it.
#[derive(Debug)]
pub(crate) struct Seen<'a, C> {
    chain: &'a C,
    drives: &'a Drives,
    course: &'a dyn Course,
    pub(crate) losses: Losses,
    needs: Needs,
    moments: usize,
    wanted: Shape,
}

impl<'a, C: Dynamics> Seen<'a, C> {
    pub(crate) fn new(chain: &'a C, drives: &'a Drives, course: &'a dyn Course) -> Self {
        let wanted = Shape::straight(chain.joints());
        Self { chain, drives, course, losses: Losses::default(), needs: Needs::default(), moments: 0, wanted }
    }

    pub(crate) fn see(&mut self, now: &Instant<'_, C::Motion>) {
        let each = now.motions.iter().enumerate();
        self.losses.0.extend(each.map(|(i, motion)| Loss::of(&self.chain.dragged(i, *motion))));
        self.course.at(now.time_s, &mut self.wanted);
        self.moments += 1;
        let motor = &self.drives.motor;
        for (i, (torque, rate)) in now.torque_n_m.iter().zip(&now.shape.rate).enumerate() {
            let needs = &mut self.needs;
            needs.see(self.drives, i, *torque, *rate);
            let angle = now.shape.angle[i].abs();
            needs.angle_rad = needs.angle_rad.max(angle);
            needs.away_rad = needs.away_rad.max((self.wanted.angle[i] - now.shape.angle[i]).abs());
            if let Some(servo) = self.drives.following.get(i) {
                let limits = self.drives.limits.get(i).copied().unwrap_or_default();
                let over = |number: f64, limit: Option<f64>| limit.is_some_and(|limit| number > limit);
                needs.is_beyond |= over(angle, limits.angle_rad) || over(rate.abs(), limits.rate_rad_s);
                // A torque of nothing is one that was asked for in vain where the motor gives none.
                let gives = if *torque == 0.0 { motor.gives_n_m(*rate) } else { motor.most_n_m(*torque, *rate) };
                let most = servo.torque_n_m.unwrap_or(f64::INFINITY).min(gives);
                needs.at_limit += f64::from(u8::from(torque.abs() >= (1.0 - AT_LIMIT) * most));
            }
        }
    }

    /// What was needed.
    pub(crate) fn needs(&self) -> Needs {
        let all = (self.moments * self.chain.joints()) as f64;
        Needs { at_limit: self.needs.at_limit / all.max(1.0), ..self.needs }
    }
}
