//! What is seen of a swimmer on its way: what its links lose and where, and what its joints need.
//!
//! **Units.** SI.

use crate::gait::{Course, Shape};
use crate::joints::Drives;
use crate::losses::{Loss, Losses};
use crate::means::{Effort, Means};
use crate::moving::Instant;
use crate::planar::dot;
use crate::robot::Robot;
use crate::stability::Stiffness;

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
    pub(crate) fn see(&mut self, drives: &Drives, joint: usize, torque_n_m: f64, rate: f64) {
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
pub(crate) struct Seen<'a> {
    robot: &'a Robot,
    drives: &'a Drives,
    course: &'a dyn Course,
    losses: Losses,
    needs: Needs,
    moments: usize,
    wanted: Shape,
}

impl<'a> Seen<'a> {
    pub(crate) fn new(robot: &'a Robot, drives: &'a Drives, course: &'a dyn Course) -> Self {
        let wanted = Shape::straight(robot.chain.joints());
        Self { robot, drives, course, losses: Losses::default(), needs: Needs::default(), moments: 0, wanted }
    }

    pub(crate) fn see(&mut self, now: &Instant<'_>) {
        for (link, motion) in self.robot.chain.links.iter().zip(now.motions) {
            let [_, u, v] = *motion;
            let load = link.drag.load(link.half_length_m, *motion);
            self.losses.0.push(Loss {
                speed_m_s: u.hypot(v),
                // Fore and aft, and port and starboard, are alike.
                angle_rad: v.abs().atan2(u.abs()),
                // A link that gains is told apart.
                power_w: (-dot(load, *motion)).max(0.0),
                along_w: -load[1] * u,
            });
        }
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

    /// What was needed, in so many steps.
    pub(crate) fn effort(&self, means: &Means, steps: usize, stiffness: Option<Stiffness>, least_w: f64) -> Effort {
        let (losses, all) = (&self.losses, (self.moments * self.robot.chain.joints()) as f64);
        Effort {
            electric_w: self.drives.motor.electric_w(means.positive_w, means.absolute_w - means.positive_w),
            needs: Needs { at_limit: self.needs.at_limit / all.max(1.0), ..self.needs },
            steps,
            stiffness,
            extrapolated: losses.extrapolated(self.robot.speed_m_s, self.robot.angle_rad),
            along: losses.along(),
            median_angle_rad: losses.median_angle_rad(),
            gain_w: self.robot.gain(losses.fastest_m_s(), least_w),
        }
    }
}
