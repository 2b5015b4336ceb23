//! Releases reduced to decrements.

use froude_fit::budget::jackknife;
use froude_fit::faer::Mat;
use froude_records::text::counted;

use crate::decay::error::DecayError;
use crate::decay::fit::{HalfCycle, Range, Scatter};
use crate::decay::pool::{Estimate, Sums};
use crate::decay::run::{DecayRun, DecaySetup};
use crate::decay::swings::Swings;

/// Runs from which leaving one out says how far they scatter.
pub const FEWEST_RUNS: usize = 3;

/// Turning points of all releases, with what was left out: the first stage of both methods.
#[derive(Debug, Clone)]
pub(super) struct Reduced<'a> {
    pub runs: Vec<(DecayRun<'a>, Swings)>,
    pub sums: Vec<Sums>,
    pub pooled: Estimate,
    pub left_out: Vec<DecayError>,
}

impl<'a> Reduced<'a> {
    pub fn of(runs: &[DecayRun<'a>], setup: &DecaySetup) -> Result<Self, DecayError> {
        setup.check()?;
        if runs.is_empty() {
            return Err(DecayError::NoRuns);
        }
        let (mut used, mut left_out) = (Vec::new(), Vec::new());
        for run in runs {
            match Swings::of(run, setup.window) {
                Ok(swings) => used.push((*run, swings)),
                // A release that shows nothing is left out aloud; a damaged log is an error.
                Err(
                    why @ (DecayError::NoMotion { .. }
                    | DecayError::OverDamped { .. }
                    | DecayError::Irregular { .. }
                    | DecayError::TooFewHalfCycles { .. }),
                ) => left_out.push(why),
                Err(why) => return Err(why),
            }
        }
        if used.is_empty() {
            return Err(left_out.swap_remove(0));
        }
        let sums: Vec<Sums> = used.iter().map(|(_, s)| Sums::of(s, setup.stiffness.value)).collect();
        let undetermined = || DecayError::Undetermined { what: "linear and quadratic damping".to_owned() };
        let pooled = all_but(&sums, None).estimate(setup).ok_or_else(undetermined)?;
        Ok(Self { runs: used, sums, pooled, left_out })
    }

    /// Half cycles as rows; their regression gives the damping of the envelope again.
    pub fn rows(&self, setup: &DecaySetup) -> Vec<HalfCycle> {
        let c = setup.stiffness.value;
        let of_run = |(run, swings): &(DecayRun<'_>, Swings)| -> Vec<HalfCycle> {
            let rest = self.pooled.rest(swings, c);
            (0..swings.half_cycles())
                .map(|k| {
                    let amplitude = swings.amplitude(k);
                    let force_amplitude = self.pooled.reduced_force(swings, k, rest, c);
                    HalfCycle {
                        run: run.id.to_owned(),
                        half_cycle: k,
                        amplitude,
                        speed_amplitude: self.pooled.omega_n * amplitude,
                        force_amplitude,
                        residual: force_amplitude - self.pooled.force_amplitude(amplitude),
                    }
                })
                .collect()
        };
        self.runs.iter().flat_map(of_run).collect()
    }

    pub fn range(&self) -> Range {
        let amplitudes = self.runs.iter().flat_map(|(_, s)| (0..s.half_cycles()).map(|k| s.amplitude(k)));
        let amplitude = amplitudes.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], a| [low.min(a), high.max(a)]);
        Range {
            speed: amplitude.map(|a| a * self.pooled.omega_n),
            amplitude,
            period_s: std::f64::consts::TAU / self.pooled.omega_n,
        }
    }

    /// Type A of the envelope.
    pub(crate) fn scatter(&self, setup: &DecaySetup) -> Option<Scatter> {
        let n = self.sums.len();
        if n >= FEWEST_RUNS {
            let without = |g: usize| all_but(&self.sums, Some(g)).estimate(setup).map(|e| e.values.to_vec());
            let (covariance, dof) = jackknife(n, without)?;
            return Some(Scatter {
                covariance,
                dof: [dof; 3],
                kind: format!("jackknife over {n} runs"),
                shared: "run",
            });
        }
        let [a, linear, quadratic] = self.pooled.variances;
        let both = self.pooled.damping_covariance;
        let matrix = [[a, 0.0, 0.0], [0.0, linear, both], [0.0, both, quadratic]];
        let kind = format!("half cycles about the law, in {}", counted(n, "run", "runs"));
        matrix.iter().flatten().all(|x| x.is_finite()).then(|| Scatter {
            covariance: Mat::from_fn(3, 3, |i, j| matrix[i][j]),
            dof: self.pooled.dof,
            kind,
            shared: "sample",
        })
    }
}

/// Sums of all runs, or of all but one.
pub(super) fn all_but(sums: &[Sums], without: Option<usize>) -> Sums {
    sums.iter().enumerate().filter(|(i, _)| Some(*i) != without).fold(Sums::default(), |all, (_, s)| all.and(s))
}
