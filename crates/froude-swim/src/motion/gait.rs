//! Joint angles over time.
//!
//! φ_i = α g_i sin(ωt − (i−1)δ) + γ, joints counted from the head: the lateral undulation has g = 1, the eel's grows to the tail.
//!
//! **Units.** rad, rad/s, s. **Source.** The common lateral undulation and eel-like motion of snake robots; the USR paper prints no gait.

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
        Self { amplitude, frequency, phase, turn: 0.0, envelope }
    }

    /// Amplitude α g of a joint, counted from 0 at the head, of so many, rad.
    #[must_use]
    pub fn size(&self, joint: usize, joints: usize) -> f64 {
        let factor = match &self.envelope {
            Envelope::Lateral => 1.0,
            // Joint i of 1 … n − 1, n links.
            Envelope::Eel => (joint + 1) as f64 / (joints + 2) as f64,
            Envelope::Factors(each) => each.get(joint).copied().unwrap_or(0.0),
        };
        self.amplitude * factor
    }
}

impl Course for Gait {
    fn at(&self, time_s: f64, shape: &mut Shape) {
        let joints = shape.angle.len();
        // The phase turns from joint to joint: one sine and cosine for all.
        let ((mut sin, mut cos), (s, c)) = ((self.frequency * time_s).sin_cos(), self.phase.sin_cos());
        for i in 0..joints {
            let size = self.size(i, joints);
            shape.angle[i] = size * sin + self.turn;
            shape.rate[i] = size * self.frequency * cos;
            shape.acceleration[i] = -size * self.frequency * self.frequency * sin;
            (sin, cos) = (sin * c - cos * s, cos * c + sin * s);
        }
    }

    fn period_s(&self) -> f64 {
        std::f64::consts::TAU / self.frequency
    }

    fn extremes(&self, joint: usize, joints: usize) -> [f64; 2] {
        let size = self.size(joint, joints).abs();
        [size + self.turn.abs(), size * self.frequency.abs()]
    }
}
