//! What is doubtful about a forced oscillation, with the numbers that support it.

use std::f64::consts::TAU;

use froude_fit::Status;
use froude_hydro::sloshing::rectangular_tank_modes_rad_s;
use froude_hydro::swing::Medium;
use froude_records::campaign::Campaign;
use froude_records::finding::{Finding, Severity};
use froude_records::text::counted;

use super::fit::{ADDED, Fitted, OscillationFit};
use super::motion::Motion;
use super::setup::{OscillationRun, Setup};

/// Amplitudes of the cycles used differ by no more than this part of their mean.
const STEADY: f64 = 0.02;
/// A harmonic this near to a natural frequency of the tank makes waves grow, as part of that frequency.
const NEAR: f64 = 0.1;
/// A period within this part of a whole number is whole.
const WHOLE: f64 = 0.02;
/// Declared and found differ by more than chance beyond this many standard deviations of their difference.
const CONTRADICTS: f64 = 3.0;
/// Of five independent cycles a fifth of the variance repeats; more than this is a misfit.
const REPEATED: f64 = 0.6;
/// Gravity in the tank, m/s².
const G_M_S2: f64 = 9.80665;

fn warning(code: &str, message: String) -> Finding {
    Finding::new(Severity::Warning, code, message)
}

/// What the runs show, whichever law.
#[must_use]
pub fn of_runs(runs: &[OscillationRun<'_>], motions: &[Motion], setup: &Setup, campaign: &Campaign) -> Vec<Finding> {
    let mut out = Vec::new();
    for (run, motion) in runs.iter().zip(motions) {
        out.extend((motion.dropped > 0).then(|| {
            warning(
                "cycles-dropped",
                format!(
                    "run {:?}: {} that a mark touches {} not used, {} are",
                    run.id,
                    counted(motion.dropped, "cycle", "cycles"),
                    if motion.dropped == 1 { "is" } else { "are" },
                    motion.whole
                ),
            )
        }));
        let mean = motion.amplitudes_rad.iter().sum::<f64>() / motion.amplitudes_rad.len() as f64;
        let off = |a: &f64| (a / mean - 1.0).abs();
        let worst = (0..motion.amplitudes_rad.len())
            .max_by(|&a, &b| off(&motion.amplitudes_rad[a]).total_cmp(&off(&motion.amplitudes_rad[b])));
        if let Some(cycle) = worst.filter(|&c| off(&motion.amplitudes_rad[c]) > STEADY) {
            out.push(warning(
                "cycles-not-alike",
                format!(
                    "run {:?}: cycle {} swings {:.2} deg where the mean is {:.2} deg; leave out more cycles of start-up (cycles.skip), or look at the servo",
                    run.id,
                    motion.numbers[cycle] + 1 + setup.cycles.skip,
                    motion.amplitudes_rad[cycle].to_degrees(),
                    mean.to_degrees()
                ),
            ));
        }
        let highest = (1..=setup.harmonics).map(|k| motion.angle.amplitude(k)).fold(0.0, f64::max);
        if motion.angle.residual_std > 0.02 * highest {
            out.push(warning(
                "angle-not-periodic",
                format!(
                    "run {:?}: {} harmonics leave {:.3} deg of the angle, {:.1} % of its amplitude; velocity and acceleration are those of the harmonics alone: take more of \
                     them, or a steadier part",
                    run.id,
                    setup.harmonics,
                    motion.angle.residual_std.to_degrees(),
                    1e2 * motion.angle.residual_std / highest
                ),
            ));
        }
    }
    out.extend(sloshing(runs, motions, campaign));
    let wet: Vec<f64> = (runs.iter().zip(motions).filter(|(run, _)| run.medium == Medium::Water))
        .map(|(run, motion)| motion.periods(run.time_s))
        .collect();
    if wet.iter().all(|p| (p - p.round()).abs() < WHOLE) {
        out.push(Finding::new(
            Severity::Note,
            "whole-periods",
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

/// Part of the residuals' variance that repeats from cycle to cycle; `None` for fewer than two whole cycles. Of independent cycles it is one over
/// their number.
fn repeated(run: &OscillationRun<'_>, motion: &Motion, fitted: &Fitted) -> Option<f64> {
    let (first, n) = (motion.samples().start, motion.cycles.len());
    let length = motion.cycles.iter().map(ExactSizeIterator::len).min().filter(|_| n >= 2)?;
    let left = |cycle: usize, i: usize| {
        let row = motion.cycles[cycle].start + i;
        run.force_n[row] - fitted.force_n[row - first]
    };
    let (mut common, mut all) = (0.0, 0.0);
    for i in 0..length {
        let mean = (0..n).map(|c| left(c, i)).sum::<f64>() / n as f64;
        common += mean * mean;
        all += (0..n).map(|c| left(c, i).powi(2)).sum::<f64>() / n as f64;
    }
    (all > 0.0).then(|| common / all)
}

/// What the fit shows.
#[must_use]
pub fn of_fit(fit: &OscillationFit, runs: &[OscillationRun<'_>], motions: &[Motion], setup: &Setup) -> Vec<Finding> {
    let mut out = Vec::new();
    let parts: Vec<f64> = (runs.iter().zip(motions).zip(&fit.fitted))
        .filter_map(|((run, motion), fitted)| repeated(run, motion, fitted))
        .collect();
    let part = parts.iter().sum::<f64>() / parts.len() as f64;
    if part > REPEATED {
        out.push(warning(
            "misfit-repeats",
            format!(
                "{}: {:.0} % of the residuals' variance ({:.3} N rms) repeats from cycle to cycle: it is no noise, but force that the law lacks, a wrong sign, or the other pivot; the intervals \
                 count it as far as runs differ in it",
                fit.law,
                1e2 * part,
                fit.sigma_n
            ),
        ));
    }
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
    let lost: Vec<&str> =
        fit.unknowns.iter().filter(|u| u.status == Status::Undetermined).map(|u| u.name.as_str()).collect();
    if !lost.is_empty() {
        out.push(Finding::new(
            Severity::Error,
            "undetermined",
            format!(
                "{}: {} cannot be told apart by these runs. At one frequency added mass and buoyancy are both in phase with the angle: drive at another frequency, or declare the \
                 buoyancy. On one configuration the terms of head and tail are parallel to those of the links",
                fit.law,
                lost.join(", ")
            ),
        ));
    }
    let mut declared: Vec<(String, f64, f64)> = Vec::new();
    for body in &setup.bodies {
        if let Some(known) = body.buoyancy_n {
            let name = if body.name.is_empty() {
                super::fit::BUOYANCY.to_owned()
            } else {
                format!("{}_{}", super::fit::BUOYANCY, body.name)
            };
            declared.push((name, known.value, known.standard));
        }
    }
    declared.extend(setup.delay_s.map(|d| (super::fit::DELAY.to_owned(), d.value, d.standard)));
    for (name, value, standard) in declared {
        let Some(unknown) = fit.unknown(&name) else { continue };
        let Some((found, combined)) = unknown.value.zip(unknown.combined) else { continue };
        // The posterior lies between the two: its variance is smaller than that of the declared one by that of its shift.
        let shift = (standard * standard - combined.standard * combined.standard).max(0.0).sqrt();
        if shift > 0.0 && (found - value).abs() > CONTRADICTS * shift {
            out.push(warning(
                "declared-contradicted",
                format!(
                    "{}: {name} is declared as {value:.4} ± {standard:.2} {unit} (standard uncertainty) and the runs move it to {found:.4} {unit}; check the declaration, and signs and \
                     clocks of angle and force",
                    fit.law,
                    unit = unknown.unit
                ),
            ));
        }
    }
    if fit.by == "cycle" {
        out.push(warning(
            "few-runs",
            format!(
                "{}: what changes from run to run is not included in the intervals, which are from {}; five runs show it",
                fit.law,
                counted(fit.clusters, "cycle", "cycles")
            ),
        ));
    }
    out
}
