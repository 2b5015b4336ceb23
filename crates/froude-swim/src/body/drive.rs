//! What drives the joints: a servo that follows a gait, with what its motor can give, its friction and what it takes from the battery.
//!
//! | part | law |
//! | --- | --- |
//! | servo | τ = k_p (φ_ref − φ) + k_d (φ̇_ref − φ̇) |
//! | motor | at most what its curve allows at its speed while it drives, and what it gives at rest while it brakes |
//! | friction of the joint | b φ̇ + τ_C tanh(φ̇/φ̇_s) |
//! | battery | τφ̇/η while it drives, and a part of η \|τφ̇\| back while it brakes |
//!
//! A motor that holds a torque at rest takes power too, by the resistance of its windings; the battery's law has none of it and is a lower bound.
//!
//! **Units.** SI; angles in rad.

use crate::gait::{Course, Shape};

/// φ̇_s, over which dry friction turns about, rad/s.
pub const TURNS_ABOUT_RAD_S: f64 = 0.02;

/// Torques of the motors on φ, N m, at a time, s, from φ and φ̇.
pub trait Drive {
    /// Puts them into `torque`.
    fn torque(&mut self, time_s: f64, angle: &[f64], rate: &[f64], torque: &mut [f64]);

    /// What friction of the joints resists a rate with, N m.
    fn friction_n_m(&self, _joint: usize, _rate: f64) -> f64 {
        0.0
    }
}

/// No torque at all.
#[derive(Debug, Clone, Copy)]
pub struct Limp;

impl Drive for Limp {
    fn torque(&mut self, _: f64, _: &[f64], _: &[f64], torque: &mut [f64]) {
        torque.fill(0.0);
    }
}

/// What a motor gives at a joint.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Motor {
    /// Speed, rad/s, and largest torque, N m, from rest on and falling to where it gives nothing; between them it is linear. Without points there is no limit.
    pub curve: Vec<[f64; 2]>,
    /// η from battery to joint.
    pub efficiency: Option<f64>,
    /// The part of what braking gives that goes back.
    pub regeneration: f64,
}

impl Motor {
    /// Largest torque in the direction of the motion, N m.
    #[must_use]
    pub fn gives_n_m(&self, rate: f64) -> f64 {
        let (rate, Some(first)) = (rate.abs(), self.curve.first()) else { return f64::INFINITY };
        if rate <= first[0] {
            return first[1];
        }
        let pair = self.curve.windows(2).find(|w| rate <= w[1][0]);
        pair.map_or(0.0, |w| w[0][1] + (w[1][1] - w[0][1]) * (rate - w[0][0]) / (w[1][0] - w[0][0]))
    }

    /// The share of what it can give that a torque takes; infinite where it gives nothing at such a speed.
    #[must_use]
    pub fn share(&self, torque_n_m: f64, rate: f64) -> f64 {
        if torque_n_m == 0.0 { 0.0 } else { torque_n_m.abs() / self.most_n_m(torque_n_m, rate) }
    }

    /// Largest torque at a rate, N m, in the direction of the one asked for: braking it holds what it gives at rest.
    #[must_use]
    pub fn most_n_m(&self, asked_n_m: f64, rate: f64) -> f64 {
        self.gives_n_m(if asked_n_m * rate > 0.0 { rate } else { 0.0 })
    }

    /// What motors take from the battery, W, that give and brake so much; `None` where their efficiency is not stated.
    #[must_use]
    pub fn electric_w(&self, positive_w: f64, braked_w: f64) -> Option<f64> {
        self.efficiency.map(|efficiency| positive_w / efficiency - braked_w * efficiency * self.regeneration)
    }
}

/// How a joint follows its angle, and what resists it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Following {
    /// k_p, N m.
    pub stiffness_n_m: f64,
    /// k_d, N m s.
    pub damping_n_m_s: f64,
    /// Largest torque, N m.
    pub torque_n_m: Option<f64>,
    /// b, N m s.
    pub viscous_n_m_s: f64,
    /// τ_C, N m.
    pub dry_n_m: f64,
}

impl Following {
    /// The steepest that torque and friction fall with the rate, N m s.
    #[must_use]
    pub fn steepest_n_m_s(&self) -> f64 {
        self.damping_n_m_s + self.viscous_n_m_s + self.dry_n_m / TURNS_ABOUT_RAD_S
    }
}

/// Servos at all joints.
#[derive(Debug, Clone)]
pub struct Servo<'a> {
    course: &'a dyn Course,
    following: &'a [Following],
    motor: &'a Motor,
    wanted: Shape,
    /// Of what is wanted: two of the four stages of a step are at one time.
    time_s: f64,
}

impl<'a> Servo<'a> {
    /// One of each joint.
    #[must_use]
    pub fn new(course: &'a dyn Course, following: &'a [Following], motor: &'a Motor) -> Self {
        Self { course, following, motor, wanted: Shape::straight(following.len()), time_s: f64::NAN }
    }

    /// What they follow.
    #[must_use]
    pub fn course(&self) -> &'a dyn Course {
        self.course
    }
}

impl Drive for Servo<'_> {
    fn torque(&mut self, time_s: f64, angle: &[f64], rate: &[f64], torque: &mut [f64]) {
        if time_s.to_bits() != self.time_s.to_bits() {
            self.course.at(time_s, &mut self.wanted);
            self.time_s = time_s;
        }
        let wanted = &self.wanted;
        for (i, (torque, how)) in torque.iter_mut().zip(self.following).enumerate() {
            let asked =
                how.stiffness_n_m * (wanted.angle[i] - angle[i]) + how.damping_n_m_s * (wanted.rate[i] - rate[i]);
            let gives = self.motor.most_n_m(asked, rate[i]);
            let most = how.torque_n_m.map_or(gives, |limit| limit.min(gives));
            *torque = asked.clamp(-most, most);
        }
    }

    fn friction_n_m(&self, joint: usize, rate: f64) -> f64 {
        let how = &self.following[joint];
        how.viscous_n_m_s * rate + if how.dry_n_m > 0.0 { how.dry_n_m * (rate / TURNS_ABOUT_RAD_S).tanh() } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A DC motor's line: 3 N m at rest, none at 6 rad/s; braking it holds what it gives at rest.
    #[test]
    fn a_motor_gives_what_its_curve_says() {
        let motor = Motor { curve: vec![[0.0, 3.0], [6.0, 0.0]], efficiency: Some(0.6), regeneration: 0.5 };
        assert_eq!([0.0, 2.0, -2.0, 6.0, 9.0].map(|rate| motor.gives_n_m(rate)), [3.0, 2.0, 2.0, 0.0, 0.0]);
        assert_eq!(motor.share(1.0, 2.0), 0.5);
        assert_eq!(motor.share(-1.5, 2.0), 0.5);
        assert_eq!(motor.share(1.0, 7.0), f64::INFINITY);
        assert_eq!(Motor::default().share(5.0, 7.0), 0.0);
        assert!((motor.electric_w(2.4, 2.0).unwrap() - (4.0 - 0.6)).abs() < 1e-15);
        assert_eq!(Motor::default().electric_w(2.4, 2.0), None);
    }
}
