//! What is doubtful about a forced oscillation, with the numbers that support it.

use std::f64::consts::TAU;

use froude_fit::budget::Uncertain;
use froude_hydro::sloshing::rectangular_tank_modes_rad_s;
use froude_hydro::swing::Medium;
use froude_records::campaign::Campaign;
use froude_records::finding::{Finding, Severity};
use froude_records::text::counted;

use super::fit::{ADDED, BUOYANCY, DELAY, MASS, OscillationFit};
use super::setup::{OscillationRun, Setup};
use crate::findings::{note, warning};
use crate::joint::Run;
use crate::joint::findings::{are_whole, contradicted, few_runs, misfit, of_motion, undetermined};
use crate::motion::Motion;

/// A harmonic this near to a natural frequency of the tank makes waves grow, as part of that frequency.
const NEAR: f64 = 0.1;
/// Gravity in the tank, m/s².
const G_M_S2: f64 = 9.80665;

/// What the runs show, whichever law.
#[must_use]
pub fn of_runs(runs: &[OscillationRun<'_>], motions: &[Motion], setup: &Setup, campaign: &Campaign) -> Vec<Finding> {
    let each = runs.iter().zip(motions);
    let mut out: Vec<Finding> =
        each.flat_map(|(run, motion)| of_motion(run.id, motion, setup.cycles, setup.harmonics)).collect();
    out.extend(sloshing(runs, motions, campaign));
    let wet = runs.iter().zip(motions).filter(|(run, _)| run.medium == Medium::Water);
    if are_whole(wet.map(|(run, motion)| motion.periods(run.time_s))) {
        out.push(note("whole-periods",
            "all runs are used over whole periods: drag is then orthogonal to acceleration whatever its law, so that drag laws agreeing on C_A is no evidence for any of \
             them"
            .to_owned(),
        ));
    }
    out
}

/// Motions near a natural frequency of the water across the tank.
fn sloshing(runs: &[OscillationRun<'_>], motions: &[Motion], campaign: &Campaign) -> Option<Finding> {
    let tank = campaign.tank.as_ref()?;
    let (width, depth) = (tank.width_m?, tank.depth_m?);
    let [mode, _] = rectangular_tank_modes_rad_s(width, width, depth, G_M_S2).ok()?;
    let near = |m: &Motion| (1..=3).any(|k| (f64::from(k) * m.angle.omega_rad_s / mode - 1.0).abs() < NEAR);
    let found: Vec<&str> = runs.iter().zip(motions).filter(|(_, m)| near(m)).map(|(run, _)| run.id).collect();
    (!found.is_empty()).then(|| {
        warning(
            "near-sloshing",
            format!(
                "{} ({}) within 10 % of the water's own {:.2} s across the tank, in its first three harmonics: waves grow and press on the body; drive at another period",
                counted(found.len(), "run swings", "runs swing"),
                found.join(", "),
                TAU / mode
            ),
        )
    })
}

/// What the fit shows.
#[must_use]
pub fn of_fit(fit: &OscillationFit, runs: &[OscillationRun<'_>], motions: &[Motion], setup: &Setup) -> Vec<Finding> {
    let views: Vec<Run<'_>> =
        runs.iter().zip(motions).map(|(run, motion)| Run { id: run.id, load: run.force_n, motion }).collect();
    let mut out: Vec<Finding> =
        misfit(fit, &views, "N", "force that the law lacks, a wrong sign, or the other pivot").into_iter().collect();
    if let Some((value, combined)) = fit.unknown(ADDED).and_then(|u| u.value.zip(u.combined))
        && combined.interval(value)[1] < 0.0
    {
        out.push(Finding::new(
            Severity::Error,
            "negative-added-mass",
            format!(
                "{}: C_A is {value:.3}, below zero beyond its interval; no body has that: check the signs of angle and force, the mass below the load cell, and the pivot",
                fit.law
            ),
        ));
    }
    out.extend(undetermined(
        fit,
        "At one frequency added mass and buoyancy are both in phase with the angle: drive at another frequency, or declare the buoyancy. On one configuration the terms of head and \
         tail are parallel to those of the links",
    ));
    let of_body = |what: &str, name: &str| if name.is_empty() { what.to_owned() } else { format!("{what}_{name}") };
    let buoyancy = setup.bodies.iter().filter_map(|body| Some((of_body(BUOYANCY, &body.name), body.buoyancy_n?)));
    let mass = setup.bodies.iter().map(|body| (of_body(MASS, &body.name), body.mass_kg));
    let mut declared: Vec<(String, Uncertain)> = buoyancy.chain(mass).collect();
    declared.extend(setup.delay_s.map(|delay| (DELAY.to_owned(), delay)));
    out.extend(contradicted(fit, &declared, "signs and clocks of angle and force"));
    out.extend(few_runs(fit));
    out
}
