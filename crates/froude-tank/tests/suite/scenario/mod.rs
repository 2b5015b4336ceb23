//! Releases as a rig would log them: the motion of the fit, with friction, a second mode, noise and steps.

use froude_tank::decay::motion::Motion;
use froude_tank::decay::releases::Logged;
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// What is released, and how it is logged.
#[derive(Debug, Clone, PartialEq)]
pub struct Scenario {
    /// M + A, kg or kg m².
    pub moving: f64,
    /// D_I.
    pub linear: f64,
    /// D_II.
    pub quadratic: f64,
    /// C.
    pub stiffness: f64,
    /// Coulomb friction, N or N m.
    pub coulomb: f64,
    /// Displacements from rest at release; each drawn within ± [`Scenario::displacement_spread`] of itself.
    pub displacements: Vec<f64>,
    /// Spread of the displacements, as a part.
    pub displacement_spread: f64,
    /// Rest position.
    pub rest: f64,
    /// Time held before the release, s.
    pub held_s: f64,
    /// Time after it, s.
    pub free_s: f64,
    /// Samples a second.
    pub rate_hz: f64,
    /// Standard deviation of a sample's noise.
    pub noise: f64,
    /// Step of the sensor; 0 is none.
    pub step: f64,
    /// Drift of the zero, a second.
    pub drift_per_s: f64,
    /// Amplitude of a second mode at release as part of the displacement, and its frequency, Hz.
    pub second_mode: (f64, f64),
}

impl Scenario {
    /// A heaving body of 12 kg dry on springs of 180 N/m: A33 = 8 kg, 4 N s/m, 40 N s²/m²; period 2.1 s, released five times
    /// from about 0.1 m, logged at 50 Hz to 0.2 mm.
    #[must_use]
    pub fn heave() -> Self {
        Self {
            moving: 20.0,
            linear: 4.0,
            quadratic: 40.0,
            stiffness: 180.0,
            coulomb: 0.0,
            displacements: vec![0.1; 5],
            displacement_spread: 0.1,
            rest: 0.3,
            held_s: 1.0,
            free_s: 18.0,
            rate_hz: 50.0,
            noise: 2e-4,
            step: 1e-4,
            drift_per_s: 0.0,
            second_mode: (0.0, 0.0),
        }
    }

    /// All releases; the same seed gives the same.
    #[must_use]
    pub fn releases(&self, seed: u64) -> Vec<Logged> {
        let mut rng = Pcg64::seed_from_u64(seed);
        (0..self.displacements.len()).map(|i| self.release(i, &mut rng)).collect()
    }

    fn release(&self, which: usize, rng: &mut Pcg64) -> Logged {
        let displacement =
            self.displacements[which] * (1.0 + self.displacement_spread * (2.0 * rng.random::<f64>() - 1.0));
        let motion = Motion {
            omega2: self.stiffness / self.moving,
            linear: self.linear / self.moving,
            quadratic: self.quadratic / self.moving,
            coulomb: self.coulomb / self.moving,
            rest: self.rest,
            is_pendulum: false,
        };
        let step_s = 1.0 / self.rate_hz;
        // The release lies anywhere between two samples.
        let early_s = step_s * rng.random::<f64>();
        let at_release = [self.rest + displacement, 0.0];
        let first = motion.path(at_release, &[0.0, early_s]).map_or(at_release, |p| p[1]);
        let free = (self.free_s * self.rate_hz).round() as usize;
        let after_s: Vec<f64> = (0..free).map(|i| step_s * i as f64).collect();
        let path = motion.path(first, &after_s).unwrap_or_default();
        let held = (self.held_s * self.rate_hz).round() as usize;
        let (part, second_hz) = self.second_mode;
        let positions = std::iter::repeat_n(at_release, held).chain(path);
        let (mut time_s, mut position) = (Vec::new(), Vec::new());
        for (i, [q, _]) in positions.enumerate() {
            let t = i as f64 * step_s;
            let z: f64 = StandardNormal.sample(rng);
            let other = part * displacement * (std::f64::consts::TAU * second_hz * t).cos();
            let sensed = q + other + self.drift_per_s * t + self.noise * z;
            time_s.push(t);
            position.push(if self.step > 0.0 { (sensed / self.step).round() * self.step } else { sensed });
        }
        Logged { id: format!("release {}", which + 1), time_s, position }
    }
}
