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

use super::error::DecayError;
use super::findings;
use super::fit::{DecayFit, Method, RunSummary, declared};
use super::run::{DecayRun, DecaySetup};
use super::swings::Swings;
use crate::decay::reduced::Reduced;
use crate::error::TankError;

/// Added mass and damping from turning points and passages.
///
/// Releases of any length; those with fewer than five peaks are left out with a finding.
///
/// # Errors
///
/// [`DecayError`]: a damaged log, a declared number that cannot be, no release with five peaks, or a restoring moment that is no spring's.
pub fn envelope(runs: &[DecayRun<'_>], setup: &DecaySetup) -> Result<DecayFit, DecayError> {
    let reduced = Reduced::of(runs, setup, Method::Envelope)?;
    if let (true, Some((run, swings))) = (setup.restoring.is_pendulum(), reduced.runs.first()) {
        let peak_rad = swings.turns.iter().map(|t| (t.position - swings.rest).abs()).fold(0.0, f64::max);
        let what = format!(
            "a buoyancy at a radius drives back by sin φ, which at {peak_rad:.3} rad is {:.1} % less than φ, and the formulas of {} are those of a \
             spring; use decay_output_error, or release from less and declare stiffness = B r",
            100.0 * (1.0 - peak_rad.sin() / peak_rad),
            Method::Envelope.name()
        );
        return Err(TankError::of_run(run.id, what).into());
    }
    let undetermined = || DecayError::undetermined("linear and quadratic damping");
    let pooled = reduced.pooled.ok_or_else(undetermined)?;
    let values = pooled.values;
    let rows = reduced.rows(setup, values);
    let summary = |(run, swings): &(DecayRun<'_>, Swings)| {
        let [first, end] = swings.samples;
        let own: Vec<f64> = rows.iter().filter(|r| r.run == run.id).map(|r| r.residual).collect();
        let [period_s, added] = swings.period_and_added(setup);
        let rest = pooled.rest(swings, setup.restoring.stiffness());
        RunSummary {
            id: run.id.to_owned(),
            samples: end - first,
            half_cycles: swings.half_cycles(),
            from_s: run.time_s[first],
            start: [swings.passages[0].position, swings.passages[0].slope],
            rest,
            turns: swings.about(rest),
            period_s,
            added,
            noise: swings.noise,
            residual_rms: (own.iter().map(|r| r * r).sum::<f64>() / own.len() as f64).sqrt(),
            fitted: Vec::new(),
        }
    };
    let mut fit = DecayFit {
        method: Method::Envelope,
        axis: setup.axis,
        names: setup.names(),
        values,
        type_a: reduced.scatter(setup),
        inertia: setup.inertia,
        restoring: setup.restoring,
        errors: declared(setup, values),
        range: reduced.range(pooled.omega_n),
        runs: reduced.runs.iter().map(summary).collect(),
        rows,
        findings: Vec::new(),
    };
    fit.findings = findings::common(&reduced, &fit, setup);
    Ok(fit)
}
