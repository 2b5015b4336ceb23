//! Joint angles over time of a chain whose joints yaw or pitch: one wave of each kind.
//!
//! φ_i = α g_i sin(ωt − (i−1)δ) + γ of a joint that yaws, and φ_i = α_p g_i sin(ωt − (i−1)δ + β) + γ_p of one that pitches; i counts all joints from the head, so that both waves travel along the body at one speed.
//! β by which the pitch is ahead makes the body a helix at 90°, and keeps the wave in one slanted plane at 0.
//!
//! **Units.** rad, rad/s, s.

use super::vector::Axis;
use crate::gait::{Course, Gait, Shape};

/// A gait of joints of both kinds.
#[derive(Debug, Clone, PartialEq)]
pub struct SpatialGait {
    /// Of the joints that yaw; its frequency, phase and envelope are those of all.
    pub yaw: Gait,
    /// α_p, rad.
    pub pitch_amplitude: f64,
    /// β, rad.
    pub pitch_ahead: f64,
    /// γ_p, rad.
    pub pitch_turn: f64,
    /// What the joints turn about, from the head.
    pub joints: Vec<Axis>,
}

impl SpatialGait {
    /// Amplitude, what it is ahead by, and mean of a joint, counted from 0.
    fn of(&self, joint: usize, joints: usize) -> [f64; 3] {
        match self.joints.get(joint) {
            Some(Axis::Pitch) => {
                let wave = Gait { amplitude: self.pitch_amplitude, ..self.yaw.clone() };
                [wave.size(joint, joints), self.pitch_ahead, self.pitch_turn]
            }
            _ => [self.yaw.size(joint, joints), 0.0, self.yaw.turn],
        }
    }
}

impl Course for SpatialGait {
    fn at(&self, time_s: f64, shape: &mut Shape) {
        let (joints, frequency) = (shape.angle.len(), self.yaw.frequency);
        for i in 0..joints {
            let [size, ahead, mean] = self.of(i, joints);
            let (sin, cos) = (frequency * time_s - i as f64 * self.yaw.phase + ahead).sin_cos();
            shape.angle[i] = size * sin + mean;
            shape.rate[i] = size * frequency * cos;
            shape.acceleration[i] = -size * frequency * frequency * sin;
        }
    }

    fn period_s(&self) -> f64 {
        self.yaw.period_s()
    }

    fn extremes(&self, joint: usize, joints: usize) -> [f64; 2] {
        let [size, _, mean] = self.of(joint, joints);
        [size.abs() + mean.abs(), size.abs() * self.yaw.frequency.abs()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::Envelope;

    /// Joints that yaw do what they do in the plane; a sine and cosine that are turned from joint to joint round a little.
    #[test]
    fn joints_that_yaw_follow_the_wave_of_the_plane_and_those_that_pitch_their_own() {
        let yaw = Gait { turn: 0.1, ..Gait::wave(0.5, 1.4, 0.7, Envelope::Eel) };
        let joints = vec![Axis::Yaw, Axis::Pitch, Axis::Yaw, Axis::Pitch];
        let gait = SpatialGait { yaw: yaw.clone(), pitch_amplitude: 0.2, pitch_ahead: 1.5, pitch_turn: -0.05, joints };
        let (mut plane, mut found) = (Shape::straight(4), Shape::straight(4));
        yaw.at(0.6, &mut plane);
        gait.at(0.6, &mut found);
        for i in [0, 2] {
            assert!((plane.angle[i] - found.angle[i]).abs() < 1e-15 && (plane.rate[i] - found.rate[i]).abs() < 1e-15);
        }
        let size = 0.2 * 4.0 / 6.0;
        assert!((found.angle[3] - size * (0.84_f64 - 2.1 + 1.5).sin() + 0.05).abs() < 1e-15);
        assert!((gait.extremes(3, 4)[0] - size - 0.05).abs() < 1e-15);
    }
}
