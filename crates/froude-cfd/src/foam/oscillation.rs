//! A body that swings along a line, in water at rest or while it goes forward: the computed twin of a forced oscillation.
//!
//! **Setting.** The body's place is A sin ωt along a direction in its axes, from the start on; what the start leaves has gone after a period or two. The whole mesh moves with the body without changing its shape, and its outer boundary, which goes along, is open to the water. Forward speed is a stream from ahead.
//! **Forces.** The pressure is that of an axes system at rest, so that the loads are those of the water on the body, and nothing is to be added. In axes that move with the body, with the inflow −v(t) and no force on the water but its pressure p̃, one would have p̃ = p + ρ a·x, and on the closed surface F = F̃ + ρ V a with the body's acceleration a: the added mass would come out too large by the displaced mass.
//! **Fit.** Over each period F = −μ a − b v by its first harmonics: μ = (2/nAω²) Σ F sin ωt, b = −(2/nAω) Σ F cos ωt. A drag d v|v| is in b as 8/(3π) d Aω.

use std::f64::consts::TAU;
use std::path::Path;

use froude_mesh::vector::{Vec3, dot, norm, scale};

use crate::attempt::{Attempt, How, SolveError};
use crate::case::Case;
use crate::dictionary::{Dictionary, vector};
use crate::foam_case::{self, write_dictionary};
use crate::foam_fields::fields_about_a_moving_wall;
use crate::foam_system::Pace;
use crate::history::{self, Sample};
use crate::openfoam::End;

/// How a body swings.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Swing {
    /// A along each axis of the body, m.
    pub amplitude_m: Vec3,
    /// ω/2π, Hz.
    pub frequency_hz: f64,
    /// Speed forward through the water meanwhile, m/s.
    pub forward_m_s: f64,
    /// Steps of a period.
    pub steps: usize,
    /// Periods.
    pub periods: usize,
}

impl Swing {
    /// Largest speed Aω of the swing, m/s.
    #[must_use]
    pub fn speed_m_s(&self) -> f64 {
        TAU * self.frequency_hz * norm(self.amplitude_m)
    }

    /// Keulegan-Carpenter number 2πA/W of a width \[-\].
    #[must_use]
    pub fn keulegan_carpenter(&self, width_m: f64) -> f64 {
        TAU * norm(self.amplitude_m) / width_m
    }

    /// Stokes number β = f W²/ν of a width \[-\].
    #[must_use]
    pub fn stokes(&self, width_m: f64, viscosity_m2_s: f64) -> f64 {
        self.frequency_hz * width_m * width_m / viscosity_m2_s
    }

    /// Where the body is: `constant/dynamicMeshDict`.
    fn dictionary(&self) -> Dictionary {
        Dictionary::default()
            .with("dynamicFvMesh", "dynamicMotionSolverFvMesh")
            .with("motionSolverLibs", "(fvMotionSolvers)")
            .with("motionSolver", "solidBody")
            .with("solidBodyMotionFunction", "oscillatingLinearMotion")
            .with(
                "oscillatingLinearMotionCoeffs",
                Dictionary::default()
                    .with("amplitude", vector(self.amplitude_m))
                    .with("omega", TAU * self.frequency_hz),
            )
    }
}

/// What the water does to a swinging body over one period.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Period {
    /// μ: added mass along the swing, kg.
    pub added_mass_kg: f64,
    /// b: damping along the swing, equal in work to the drag, N s/m.
    pub damping_n_s_m: f64,
}

/// What a swing came to.
#[derive(Debug, Clone, PartialEq)]
pub struct Swung {
    /// Loads of all steps.
    pub samples: Vec<Sample>,
    /// A row per period; the first has the start in it.
    pub periods: Vec<Period>,
    /// Time of processors, s.
    pub cpu_s: f64,
}

/// Computes a swing on one processor, in an empty folder.
///
/// The case's own speed sets the turbulence of the water, and nothing else; give it the largest one through the water, √(U² + A²ω²).
///
/// # Errors
///
/// [`SolveError`]; also where the solver did not reach the end, or its forces are not those of all steps.
pub fn swing(case: &Case, swing: &Swing, mesh: &Path, folder: &Path, how: &How) -> Result<Swung, SolveError> {
    let steps = swing.steps.max(1) * swing.periods.max(1);
    let step_s = 1.0 / (swing.frequency_hz * swing.steps.max(1) as f64);
    let pace = Pace::Transient { step_s };
    let one = How { openfoam: how.openfoam, ranks: 1, cancel: how.cancel, tell: how.tell };
    let attempt = Attempt::begin(case, mesh, None, folder, &one, pace, steps)?;
    foam_case::write_fields(&fields_about_a_moving_wall(case, swing.forward_m_s), &attempt.mesh, folder)?;
    write_dictionary(folder, "constant/dynamicMeshDict", &swing.dictionary())?;
    let log = attempt.run_until(step_s * steps as f64)?;
    let samples = history::read(folder, case.is_half)?;
    let is_whole = samples.len() == steps && samples.iter().all(|s| s.total().iter().all(|load| load.is_finite()));
    if !is_whole {
        let said = format!("forces of {} of {steps} steps that are all numbers; is the disk full?", samples.len());
        return Err(attempt.failed(End::Whole, said));
    }
    Ok(Swung { periods: periods(&samples, swing), samples, cpu_s: log.cpu_s })
}

/// The first harmonics of whole periods; none of a body that does not swing.
fn periods(samples: &[Sample], swing: &Swing) -> Vec<Period> {
    let amplitude_m = norm(swing.amplitude_m);
    if amplitude_m <= 0.0 || swing.frequency_hz <= 0.0 {
        return Vec::new();
    }
    let along = scale(swing.amplitude_m, 1.0 / amplitude_m);
    let omega = TAU * swing.frequency_hz;
    samples
        .chunks_exact(swing.steps.max(1))
        .map(|period| {
            let mean = |phase: fn(f64) -> f64| {
                let of = |sample: &Sample| {
                    let [x, y, z, ..] = sample.total();
                    dot([x, y, z], along) * phase(omega * sample.time)
                };
                2.0 * period.iter().map(of).sum::<f64>() / period.len() as f64
            };
            Period {
                added_mass_kg: mean(f64::sin) / (amplitude_m * omega * omega),
                damping_n_s_m: -mean(f64::cos) / (amplitude_m * omega),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// μ = 3 kg, b = 2 N s/m, d = 5 N s²/m², along (0.6, −0.8, 0).
    #[test]
    fn mass_and_damping_are_those_that_made_the_force() {
        let swing =
            Swing { amplitude_m: [0.06, -0.08, 0.0], frequency_hz: 0.7, forward_m_s: 0.0, steps: 200, periods: 2 };
        let omega = TAU * 0.7;
        let sample = |i: usize| {
            let time = i as f64 / (200.0 * 0.7);
            let (v, a) = (0.1 * omega * (omega * time).cos(), -0.1 * omega * omega * (omega * time).sin());
            let force = -3.0 * a - 2.0 * v - 5.0 * v * v.abs();
            Sample {
                time,
                pressure: [0.6 * force, 0.0, 0.0, 0.0, 0.0, 0.0],
                viscous: [0.0, -0.8 * force, 0.0, 0.0, 0.0, 0.0],
            }
        };
        let samples: Vec<Sample> = (1..=400).map(sample).collect();
        assert_eq!(periods(&samples, &Swing { amplitude_m: [0.0; 3], ..swing }), []);
        let found = periods(&samples, &swing);
        assert_eq!(found.len(), 2);
        for period in found {
            assert!((period.added_mass_kg - 3.0).abs() < 1e-9, "{period:?}");
            // d of a drag d v|v| that takes the same work.
            let quadratic_n_s2_m2 = (period.damping_n_s_m - 2.0) * 3.0 * PI / (8.0 * swing.speed_m_s());
            assert!((quadratic_n_s2_m2 - 5.0).abs() < 1e-3, "{period:?}");
        }
    }
}
