//! Releases reduced to decrements.

use std::f64::consts::PI;

use froude_fit::budget::jackknife;
use froude_fit::faer::Mat;
use froude_records::text::counted;

use crate::decay::error::DecayError;
use crate::decay::fit::{HalfCycle, Method, Range, Scatter};
use crate::decay::pool::{EIGHT_OVER_3_PI, Estimate, Sums};
use crate::decay::run::{DecayRun, DecaySetup};
use crate::decay::swings::Swings;
use crate::error::TankError;

/// Runs from which leaving one out says how far they scatter.
pub const FEWEST_RUNS: usize = 3;

/// Turning points of all releases, with what was left out: the first stage of both methods.
#[derive(Debug, Clone)]
pub(super) struct Reduced<'a> {
    pub runs: Vec<(DecayRun<'a>, Swings)>,
    /// Of the releases with enough peaks for an envelope, where a spring drives the body back.
    pub sums: Vec<Sums>,
    /// The envelope of those; `None` where they do not determine it.
    pub pooled: Option<Estimate>,
    pub left_out: Vec<DecayError>,
}

impl<'a> Reduced<'a> {
    /// As far as `method` needs them.
    pub fn of(runs: &[DecayRun<'a>], setup: &DecaySetup, method: Method) -> Result<Self, DecayError> {
        setup.check()?;
        if runs.is_empty() {
            return Err(TankError::new("no release was given; a decay test needs at least one").into());
        }
        let (mut used, mut left_out) = (Vec::new(), Vec::new());
        for run in runs {
            match Swings::of(run, setup, method) {
                Ok(swings) => used.push((*run, swings)),
                // A release that shows nothing is left out aloud; a damaged log is an error.
                Err(why @ DecayError::Release { .. }) => left_out.push(why),
                Err(why) => return Err(why),
            }
        }
        if used.is_empty() {
            return Err(left_out.swap_remove(0));
        }
        let is_spring = !setup.restoring.is_pendulum();
        let is_long = |s: &Swings| is_spring && s.turns.len() >= Method::Envelope.fewest_peaks();
        let c = setup.restoring.stiffness();
        let sums: Vec<Sums> = used.iter().filter(|(_, s)| is_long(s)).map(|(_, s)| Sums::of(s, c)).collect();
        let pooled = all_but(&sums, None).and_then(|all| all.estimate(setup));
        Ok(Self { runs: used, sums, pooled, left_out })
    }

    /// Half cycles as rows. Where the envelope is determined, their regression gives its damping again; else they are the energy that each half cycle
    /// loses, 2/(π a) of it, beside the law of `values`.
    pub fn rows(&self, setup: &DecaySetup, values: [f64; 3]) -> Vec<HalfCycle> {
        let c = setup.restoring.stiffness();
        let omega_n = self.pooled.map_or_else(|| (c / (setup.inertia.value + values[0])).sqrt(), |p| p.omega_n);
        let [_, linear, quadratic] = self.pooled.map_or(values, |p| p.values);
        let of_run = |(run, swings): &(DecayRun<'_>, Swings)| -> Vec<HalfCycle> {
            let rest = self.rest(swings, c);
            (0..swings.half_cycles())
                .map(|k| {
                    let amplitude = swings.amplitude(k);
                    let speed_amplitude = omega_n * amplitude;
                    let force_amplitude = match self.pooled {
                        Some(pooled) => pooled.reduced_force(swings, k, rest, c),
                        None => force_of_energy(setup, swings, k),
                    };
                    let law = speed_amplitude * (linear + EIGHT_OVER_3_PI * quadratic * speed_amplitude);
                    let run = run.id.to_owned();
                    let residual = force_amplitude - law;
                    HalfCycle { run, half_cycle: k, amplitude, speed_amplitude, force_amplitude, residual }
                })
                .collect()
        };
        self.runs.iter().flat_map(of_run).collect()
    }

    /// Position of rest of a run, as well as its peaks show it.
    pub fn rest(&self, swings: &Swings, stiffness: f64) -> f64 {
        let is_long = swings.turns.len() >= Method::Envelope.fewest_peaks();
        self.pooled.filter(|_| is_long).map_or(swings.rest, |pooled| pooled.rest(swings, stiffness))
    }

    /// Where a search for the coefficients starts: the envelope, else the period of the first release and its first decrement, half of it by each
    /// damping.
    pub fn start(&self, setup: &DecaySetup) -> [f64; 3] {
        if let Some(pooled) = self.pooled {
            return pooled.values;
        }
        let swings = &self.runs[0].1;
        let a = swings.amplitude(0);
        // A pendulum is slower by a²/16.
        let slower = if setup.restoring.is_pendulum() { 1.0 + a * a / 16.0 } else { 1.0 };
        let omega_n = slower * PI / (swings.passages[1].time_s - swings.passages[0].time_s);
        let half = 0.5 * force_of_energy(setup, swings, 0).max(0.0);
        let u = omega_n * a;
        let moving = setup.restoring.stiffness() / (omega_n * omega_n);
        [moving - setup.inertia.value, half / u, half / (EIGHT_OVER_3_PI * u * u)]
    }

    /// Where coefficients of an undamped frequency are supported by data.
    pub fn range(&self, omega_n: f64) -> Range {
        let amplitudes = self.runs.iter().flat_map(|(_, s)| (0..s.half_cycles()).map(|k| s.amplitude(k)));
        let amplitude = amplitudes.fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], a| [low.min(a), high.max(a)]);
        Range { speed: amplitude.map(|a| a * omega_n), amplitude, period_s: std::f64::consts::TAU / omega_n }
    }

    /// Type A of the envelope.
    pub(crate) fn scatter(&self, setup: &DecaySetup) -> Option<Scatter> {
        let n = self.sums.len();
        if n >= FEWEST_RUNS {
            let without = |g: usize| all_but(&self.sums, Some(g))?.estimate(setup).map(|e| e.values.to_vec());
            let (covariance, dof) = jackknife(n, without)?;
            return Some(Scatter {
                covariance,
                dof: [dof; 3],
                kind: format!("jackknife over {n} runs"),
                shared: "run",
            });
        }
        let pooled = self.pooled?;
        let [a, linear, quadratic] = pooled.variances;
        let both = pooled.damping_covariance;
        let matrix = [[a, 0.0, 0.0], [0.0, linear, both], [0.0, both, quadratic]];
        let kind = format!("half cycles about the law, in {}", counted(n, "run", "runs"));
        matrix.iter().flatten().all(|x| x.is_finite()).then(|| Scatter {
            covariance: Mat::from_fn(3, 3, |i, j| matrix[i][j]),
            dof: pooled.dof,
            kind,
            shared: "sample",
        })
    }
}

/// 2/(π a) of the energy that is lost from one peak to the next, N or N m: of a spring (2/π) C (a_k − a_{k+1}).
fn force_of_energy(setup: &DecaySetup, swings: &Swings, k: usize) -> f64 {
    let at = |k: usize| setup.restoring.energy_j(swings.turns[k].position - swings.rest);
    2.0 / (PI * swings.amplitude(k)) * (at(k) - at(k + 1))
}

/// Sums of all runs, or of all but one; `None` of none.
pub(super) fn all_but(sums: &[Sums], without: Option<usize>) -> Option<Sums> {
    let others = sums.iter().enumerate().filter(|(i, _)| Some(*i) != without).map(|(_, sums)| sums.clone());
    others.reduce(|all, sums| all.and(&sums))
}
