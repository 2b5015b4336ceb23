//! Joint angles over time.
//!
//! φ_i = α g_i sin(ωt − (i−1)δ) + γ, joints counted from the head: the lateral undulation has g = 1, the eel's grows to the tail. A joint that pitches has φ_i = α_p g_i sin(ωt − (i−1)δ + β) + γ_p; i counts all joints,
//! so that both waves travel along the body at one speed. β by which the pitch is ahead makes the body a helix at 90°, and keeps the wave in one slanted plane at 0.
//!
//! **Units.** rad, rad/s, s. **Source.** The common lateral undulation and eel-like motion of snake robots; the USR paper prints no gait.

use crate::spatial::vector::Axis;

/// What the joints do over time.
pub trait Course: std::fmt::Debug + Sync {
    /// Puts the angles of all joints at a time, s, with their derivatives into `shape`.
    fn at(&self, time_s: f64, shape: &mut Shape);

    /// After how long it repeats itself, s; of a recording, how long it is.
    fn period_s(&self) -> f64;

    /// Largest angle, rad, and rate, rad/s, of a joint, counted from 0 at the head, of so many.
    fn extremes(&self, joint: usize, joints: usize) -> [f64; 2];
}

/// How the amplitude goes along the body.
#[derive(Debug, Clone, PartialEq)]
pub enum Envelope {
    /// Alike at all joints.
    Lateral,
    /// i/(n+1) at joint i of n links.
    Eel,
    /// A factor for each joint.
    Factors(Vec<f64>),
}

/// The wave of joints that pitch.
#[derive(Debug, Clone, PartialEq)]
pub struct Pitching {
    /// α_p, rad.
    pub amplitude: f64,
    /// β, rad.
    pub ahead: f64,
    /// γ_p, rad.
    pub turn: f64,
    /// What the joints turn about, from the head.
    pub axes: Vec<Axis>,
}

/// A periodic gait.
#[derive(Debug, Clone, PartialEq)]
pub struct Gait {
    /// α, rad.
    pub amplitude: f64,
    /// ω, rad/s.
    pub frequency: f64,
    /// δ, rad from joint to joint.
    pub phase: f64,
    /// γ, rad.
    pub turn: f64,
    /// g.
    pub envelope: Envelope,
    /// Of joints that pitch; `None` where all yaw.
    pub pitching: Option<Pitching>,
}

/// Angles of all joints with two derivatives.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Shape {
    /// φ, rad.
    pub angle: Vec<f64>,
    /// φ̇, rad/s.
    pub rate: Vec<f64>,
    /// φ̈, rad/s².
    pub acceleration: Vec<f64>,
}

impl Shape {
    /// All zero.
    #[must_use]
    pub fn straight(joints: usize) -> Self {
        Self { angle: vec![0.0; joints], rate: vec![0.0; joints], acceleration: vec![0.0; joints] }
    }
}

impl Gait {
    /// A wave about straight joints.
    #[must_use]
    pub fn wave(amplitude: f64, frequency: f64, phase: f64, envelope: Envelope) -> Self {
        Self { amplitude, frequency, phase, turn: 0.0, envelope, pitching: None }
    }

    /// The wave of a joint where it pitches.
    fn pitching(&self, joint: usize) -> Option<&Pitching> {
        self.pitching.as_ref().filter(|pitching| pitching.axes.get(joint) == Some(&Axis::Pitch))
    }

    /// Amplitude α g and mean of a joint, counted from 0 at the head, of so many, rad.
    fn size(&self, joint: usize, joints: usize) -> [f64; 2] {
        let factor = match &self.envelope {
            Envelope::Lateral => 1.0,
            // Joint i of 1 … n − 1, n links.
            Envelope::Eel => (joint + 1) as f64 / (joints + 2) as f64,
            Envelope::Factors(each) => each.get(joint).copied().unwrap_or(0.0),
        };
        let [amplitude, mean] = self.pitching(joint).map_or([self.amplitude, self.turn], |p| [p.amplitude, p.turn]);
        [amplitude * factor, mean]
    }
}

impl Course for Gait {
    fn at(&self, time_s: f64, shape: &mut Shape) {
        let joints = shape.angle.len();
        // The phase turns from joint to joint: one sine and cosine for all.
        let ((mut sin, mut cos), (s, c)) = ((self.frequency * time_s).sin_cos(), self.phase.sin_cos());
        for i in 0..joints {
            let ([size, mean], mut wave) = (self.size(i, joints), (sin, cos));
            if let Some(pitching) = self.pitching(i) {
                let (s, c) = pitching.ahead.sin_cos();
                wave = (sin * c + cos * s, cos * c - sin * s);
            }
            shape.angle[i] = size * wave.0 + mean;
            shape.rate[i] = size * self.frequency * wave.1;
            shape.acceleration[i] = -size * self.frequency * self.frequency * wave.0;
            (sin, cos) = (sin * c - cos * s, cos * c + sin * s);
        }
    }

    fn period_s(&self) -> f64 {
        std::f64::consts::TAU / self.frequency
    }

    fn extremes(&self, joint: usize, joints: usize) -> [f64; 2] {
        let [size, mean] = self.size(joint, joints);
        [size.abs() + mean.abs(), size.abs() * self.frequency.abs()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joints that yaw do what they do without those that pitch, and these have a wave of their own; a sine and cosine that are turned from joint to joint round a little.
    #[test]
    fn joints_that_pitch_have_a_wave_of_their_own_beside_those_that_yaw() {
        let yaw = Gait { turn: 0.1, ..Gait::wave(0.5, 1.4, 0.7, Envelope::Eel) };
        let axes = vec![Axis::Yaw, Axis::Pitch, Axis::Yaw, Axis::Pitch];
        let pitching = Some(Pitching { amplitude: 0.2, ahead: 1.5, turn: -0.05, axes });
        let gait = Gait { pitching, ..yaw.clone() };
        let (mut plane, mut found) = (Shape::straight(4), Shape::straight(4));
        yaw.at(0.6, &mut plane);
        gait.at(0.6, &mut found);
        for i in [0, 2] {
            assert_eq!((plane.angle[i], plane.rate[i]), (found.angle[i], found.rate[i]));
        }
        let size = 0.2 * 4.0 / 6.0;
        assert!((found.angle[3] - size * (0.84_f64 - 2.1 + 1.5).sin() + 0.05).abs() < 1e-15);
        assert!((gait.extremes(3, 4)[0] - size - 0.05).abs() < 1e-15);
    }
}
