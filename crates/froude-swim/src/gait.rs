//! Joint angles over time.
//!
//! φ_i = α g_i sin(ωt − (i−1)δ) + γ, joints counted from the head: the lateral undulation has g = 1, the eel's grows to the tail.
//!
//! **Units.** rad, rad/s, s. **Source.** USR eq. 25; Kelasidi et al. (2014) (the eel's envelope, i/(n+1) from the head).

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
    /// T, s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        std::f64::consts::TAU / self.frequency
    }

    /// The shape at a time, s.
    pub fn at(&self, time_s: f64, shape: &mut Shape) {
        let joints = shape.angle.len();
        for i in 0..joints {
            let size = self.amplitude
                * match &self.envelope {
                    Envelope::Lateral => 1.0,
                    // Joint i of 1 … n − 1, n links.
                    Envelope::Eel => (i + 1) as f64 / (joints + 2) as f64,
                    Envelope::Factors(each) => each.get(i).copied().unwrap_or(0.0),
                };
            let (sin, cos) = (self.frequency * time_s - i as f64 * self.phase).sin_cos();
            shape.angle[i] = size * sin + self.turn;
            shape.rate[i] = size * self.frequency * cos;
            shape.acceleration[i] = -size * self.frequency * self.frequency * sin;
        }
    }
}
