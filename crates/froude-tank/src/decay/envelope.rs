//! Added mass from the period, damping from the decrement of each half cycle.
//!
//! From one turning point to the next the springs lose ½ C (a_k² − a_{k+1}²), which the damping has taken: with the motion between them
//! a sine of the mean amplitude a, ∫(D_I q̇² + D_II |q̇|³) dt = (π/2) D_I ω a² + (4/3) D_II ω² a³. As a force amplitude,
//!
//! F = (2/π) C (a_k − a_{k+1}) = D_I u + (8/3π) D_II u², u = ω_n a,
//!
//! which is the equivalent linear damping b_eq = D_I + (8/3π) D_II u times u: Froude's curve of extinction. Rows (u, F) of all
//! half cycles go into one least squares with one weight, as the noise of a turning point does not depend on the amplitude.
//! A = C/ω_n² − M, where for linear damping ω_n² = ω_d² + (D_I/2(M+A))².
//!
//! Taken as it stands this is right to first order of the damping and wrong in the second: by (½ − π²/12) γ² of b_eq for linear damping, γ = D_I ω_n/2C,
//! −(4/15)(εa)² for quadratic with ε = D_II/(M+A), and b_eq in the place of D_I shifts the period by half of what quadratic damping does. These orders are known
//! and taken off (formulas in `pool.rs`), so that F stands for what a small damping of the same coefficients would take.
//!
//! **Source.** W. Froude (1874), Naval Science 3 (extinction); Himeno (1981), Univ. of Michigan report 239, ch. 4 (equivalent damping);
//! ITTC 7.5-02-07-04.5 (analysis of roll decay). Second order: ours.

use froude_fit::budget::jackknife;
use froude_fit::faer::Mat;
use froude_records::text::counted;

use super::error::DecayError;
use super::findings;
use super::fit::{DecayFit, HalfCycle, Method, Range, RunSummary, Scatter};
use super::pool::{Estimate, Sums};
use super::run::{DecayRun, DecaySetup};
use super::swings::Swings;

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
    fn scatter(&self, setup: &DecaySetup) -> Option<Scatter> {
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

/// Added mass and damping from turning points and passages.
///
/// Releases of any length; those without three half cycles are left out with a finding.
///
/// # Errors
///
/// [`DecayError`]: a damaged log, a declared number that cannot be, or no release that swings.
pub fn envelope(runs: &[DecayRun<'_>], setup: &DecaySetup) -> Result<DecayFit, DecayError> {
    let reduced = Reduced::of(runs, setup)?;
    let values = reduced.pooled.values;
    let [by_inertia, by_stiffness] = DecayFit::by_declared(setup, values);
    let rows = reduced.rows(setup);
    let summary = |(run, swings): &(DecayRun<'_>, Swings)| {
        let [first, end] = swings.samples;
        let own: Vec<f64> = rows.iter().filter(|r| r.run == run.id).map(|r| r.residual).collect();
        RunSummary {
            id: run.id.to_owned(),
            samples: end - first,
            half_cycles: swings.half_cycles(),
            from_s: run.time_s[first],
            start: [swings.passages[0].position, swings.passages[0].slope],
            rest: reduced.pooled.rest(swings, setup.stiffness.value),
            noise: swings.noise,
            residual_rms: (own.iter().map(|r| r * r).sum::<f64>() / own.len() as f64).sqrt(),
            fitted: Vec::new(),
        }
    };
    let mut fit = DecayFit {
        method: Method::Envelope,
        axis: setup.axis,
        names: setup.axis.decay_names(),
        values,
        type_a: reduced.scatter(setup),
        inertia: setup.inertia,
        stiffness: setup.stiffness,
        by_inertia,
        by_stiffness,
        range: reduced.range(),
        runs: reduced.runs.iter().map(summary).collect(),
        rows,
        findings: Vec::new(),
    };
    fit.findings = findings::common(&reduced, &fit, setup);
    Ok(fit)
}
