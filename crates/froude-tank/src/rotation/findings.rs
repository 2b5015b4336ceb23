//! What is doubtful about a rotation, with the numbers that support it.

use froude_fit::budget::Uncertain;
use froude_records::finding::{Finding, Severity};
use froude_records::number;
use froude_rig::rotation::Mounted;

use super::derive::{Derived, Law, law_behind};
use super::fit::{INERTIA, LAMBDAS, RESTORING, RotationFit};
use super::setup::{RotationRun, Setup};
use crate::findings::warning;
use crate::joint::findings::{contradicted, few_runs, misfit, of_motion, undetermined};
use crate::joint::forecast::total;
use crate::joint::{DELAY, Run};
use crate::motion::Motion;

/// Fastest rate over slowest below which λ₂ and λ₃ are told apart by the third harmonic alone.
const APART: f64 = 1.2;

/// Speed amplitudes α ω of all runs with the body in water: the smallest and the largest, rad/s.
#[must_use]
pub fn rates<'a>(motions: impl Iterator<Item = &'a Motion>) -> [f64; 2] {
    motions
        .map(|m| m.angle.amplitude(1) * m.angle.omega_rad_s)
        .fold([f64::INFINITY, 0.0], |[low, high], rate| [low.min(rate), high.max(rate)])
}

/// Why one speed amplitude says little, if there is only one; `correlation` is that of λ₂ and λ₃.
#[must_use]
pub fn one_rate([low, high]: [f64; 2], correlation: Option<f64>) -> Option<String> {
    (high < APART * low).then(|| {
        let with = correlation.map_or_else(String::new, |r| format!(" (correlation {r:.2})"));
        format!(
            "lambda_2 and lambda_3 are hardly told apart{with}: all runs have one amplitude of the rate, {} to {} rad/s, and only its third harmonic, a fifth of λ₃'s first, separates θ̇ \
             from θ̇|θ̇|: add runs at half of it, by amplitude or frequency",
            number::significant(low, 3),
            number::significant(high, 3)
        )
    })
}

/// What the runs show.
#[must_use]
pub fn of_runs(runs: &[RotationRun<'_>], motions: &[Motion], setup: &Setup) -> Vec<Finding> {
    let each = runs.iter().zip(motions);
    each.flat_map(|(run, motion)| of_motion(run.id, motion, setup.cycles, setup.harmonics)).collect()
}

/// Correlation of λ₂ and λ₃ from all errors together.
#[must_use]
pub fn correlation(fit: &RotationFit) -> Option<f64> {
    let covariance = total(&fit.parts, fit.unknowns.len());
    let (i, j) = (fit.position(LAMBDAS[1])?, fit.position(LAMBDAS[2])?);
    let norm = (covariance[(i, i)] * covariance[(j, j)]).sqrt();
    (norm > 0.0).then(|| covariance[(i, j)] / norm)
}

/// What the fit shows.
#[must_use]
pub fn of_fit(
    fit: &RotationFit,
    derived: &[Derived],
    runs: &[RotationRun<'_>],
    motions: &[Motion],
    setup: &Setup,
) -> Vec<Finding> {
    let views: Vec<Run<'_>> =
        runs.iter().zip(motions).map(|(run, motion)| Run { id: run.id, load: run.torque_n_m, motion }).collect();
    let means = "torque that λ₁, λ₂ and λ₃ do not hold, a wrong sign, or a body whose centre is off the axis";
    let mut out: Vec<Finding> = misfit(fit, &views, "N m", means).into_iter().collect();
    if let Some((value, combined)) = fit.unknown(LAMBDAS[0]).and_then(|u| u.value.zip(u.combined))
        && combined.interval(value)[1] < 0.0
    {
        let text = format!(
            "lambda_1 is {} kg m², below zero beyond its interval; no body has that: check the signs of angle and torque, and the inertia below the torque cell",
            number::significant(value, 3)
        );
        out.push(Finding::new(Severity::Error, "negative-added-inertia", text));
    }
    out.extend(undetermined(
        fit,
        "Inertia and added inertia need runs in air or a declared inertia; a restoring moment is in phase with the angle as they are, and needs a second frequency; \
         λ₂ and λ₃ need a second amplitude",
    ));
    let in_water = runs.iter().zip(motions).filter(|(run, _)| run.mounted == Mounted::Body);
    out.extend(one_rate(rates(in_water.map(|(_, m)| m)), correlation(fit)).map(|text| warning("not-told-apart", text)));
    let all = [(INERTIA, setup.inertia_kg_m2), (RESTORING, setup.restoring_n_m), (DELAY, setup.delay_s)];
    let declared: Vec<(String, Uncertain)> =
        all.into_iter().filter_map(|(name, known)| Some((name.to_owned(), known?))).collect();
    out.extend(contradicted(fit, &declared, "signs and clocks of angle and torque"));
    if fit.unknown(INERTIA).is_none() && setup.inertia_kg_m2.is_some_and(|j| j.standard == 0.0) {
        let text = "the inertia is declared without a standard uncertainty and counts as exact, and all of its error is lambda_1's: write inertia = { value = …, standard = … }, or turn the body in air";
        out.push(warning("declared-as-exact", text.to_owned()));
    }
    if let Some(found) = law_behind(derived) {
        let severity = if found.law == Law::FrictionOrCrossFlow { Severity::Note } else { Severity::Warning };
        out.push(Finding::new(severity, "law-behind-lambda-3", found.words()));
    }
    out.extend(few_runs(fit));
    out
}
