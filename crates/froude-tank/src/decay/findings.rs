//! What is doubtful about a decay test, with the numbers that support it.

use std::f64::consts::TAU;

use froude_fit::Report;
use froude_fit::budget::jackknife_of_one;
use froude_fit::distribution::coverage_factor;
use froude_fit::faer::{Col, Mat};
use froude_records::finding::Finding;
use froude_records::run::median;
use froude_records::text::counted;

use super::fit::{DecayFit, HalfCycle};
use super::pool::EIGHT_OVER_3_PI;
use super::run::DecaySetup;
use super::swings::Swings;
use crate::decay::reduced::{FEWEST_RUNS, Reduced, all_but};
use crate::findings::{note, warning};
use crate::inverted::inverted;

/// Below this ratio of largest to smallest speed, u and u² are correlated by 0.986 and more.
const APART: f64 = 2.0;
/// A doubt is voiced beyond this many standard deviations of what chance does.
const BEYOND_CHANCE: f64 = 4.0;
/// Friction counts as seen at this confidence.
const SEEN: f64 = 0.99;
/// A first half cycle is doubted where it is off by this part of its force, and beyond chance.
const FIRST_OFF: f64 = 0.03;
/// What takes less than this part of the force is not worth a doubt.
const WORTH: f64 = 0.01;
/// Residuals this many times the sensor's noise have something else in them.
const BEYOND_NOISE: f64 = 1.5;
/// Part of a period that a release is judged by …
const FIRST_PART: f64 = 0.08;
/// … from so many samples on …
const FEWEST_FIRST: usize = 4;
/// … and doubted where what the fit leaves there is so many times that of the whole: of noise alone, four samples have that in one release of
/// 50,000 (χ² with four degrees of freedom beyond 27).
const FIRST_BEYOND: f64 = 2.6;
/// A release that swings so many times as far as the others is in another unit.
const ANOTHER_UNIT: f64 = 50.0;
/// A moving inertia that differs by this part from the median of the others, and by so many of their median distances from it, is of another body.
const MASS_OFF: f64 = 0.05;
const MASS_SPREADS: f64 = 8.0;
/// A second mode has at least this part of the residuals' power in one line.
const LINE: f64 = 0.3;

/// What the half cycles show, whichever method.
pub(super) fn common(reduced: &Reduced<'_>, fit: &DecayFit, setup: &DecaySetup) -> Vec<Finding> {
    let mut out: Vec<Finding> =
        reduced.left_out.iter().map(|why| warning("run-left-out", format!("left out: {why}"))).collect();
    let n = reduced.runs.len();
    if n < FEWEST_RUNS {
        out.push(warning(
            "few-runs",
            format!(
                "{}: what changes from release to release is not included in the intervals; {FEWEST_RUNS} releases show it, five show it well",
                counted(n, "release", "releases")
            ),
        ));
    }
    out.extend(stands_out(fit));
    let [low, high] = fit.range.speed;
    if high < APART * low {
        out.push(warning(
            "damping-not-split",
            format!(
                "speed amplitudes range from {low:.3} to {high:.3} only, a factor of {APART} is needed: {} and {} are not distinguished, \
                 only their sum at these speeds is known; release from further out or let it swing longer",
                fit.names[1], fit.names[2]
            ),
        ));
    }
    out.extend((1..3).filter_map(|j| negative(fit, j)));
    out.extend(coulomb(reduced, fit, setup));
    out.extend(reduced.pooled.and_then(|_| first_half_cycles(fit)));
    for (run, swings) in &reduced.runs {
        out.extend((swings.unread > 0).then(|| {
            warning(
                "swings-unread",
                format!(
                    "run {:?}: {} after half cycle {} not used, there is no turning point near its middle: look for a second mode or a wave",
                    run.id,
                    counted(swings.unread, "passage is", "passages are"),
                    swings.half_cycles()
                ),
            )
        }));
        out.extend(growing(reduced, swings, run.id, setup));
        out.extend(drifting(swings, run.id, setup));
    }
    out
}

/// A release whose period says that it is of another body, or whose size that it is in another unit.
fn stands_out(fit: &DecayFit) -> Vec<Finding> {
    if fit.runs.len() < FEWEST_RUNS {
        return Vec::new();
    }
    let middle = |values: &mut [f64]| median(values).unwrap_or(f64::NAN);
    let others =
        |i: usize, of: &dyn Fn(usize) -> f64| -> Vec<f64> { (0..fit.runs.len()).filter(|j| *j != i).map(of).collect() };
    let reach = |i: usize| {
        let of_run = fit.rows.iter().filter(|row| row.run == fit.runs[i].id);
        of_run.map(|row| row.amplitude).fold(0.0_f64, f64::max)
    };
    let moving = |i: usize| fit.inertia.value + fit.runs[i].added;
    let (unit, of_mass) = (fit.axis.position_unit(), fit.axis.decay_units()[0]);
    let usual_s = |i: usize| middle(&mut others(i, &|j| fit.runs[j].period_s));
    let of = |i: usize| {
        let (mut sizes, mut masses) = (others(i, &reach), others(i, &moving));
        let (usual, usual_mass) = (middle(&mut sizes), middle(&mut masses));
        let ratio = reach(i) / usual;
        if ratio.is_finite() && !(1.0 / ANOTHER_UNIT..=ANOTHER_UNIT).contains(&ratio) {
            let text = format!(
                "run {:?} swings by {:.3e} {unit} where the others swing by {usual:.3e} {unit}, {ratio:.3} times as far: check the unit of its position (mm under [m] is a factor of 1000)",
                fit.runs[i].id,
                reach(i)
            );
            return Some(warning("release-stands-out", text));
        }
        let mut off: Vec<f64> = masses.iter().map(|m| (m - usual_mass).abs()).collect();
        let allowed = (MASS_OFF * usual_mass).max(MASS_SPREADS * middle(&mut off));
        let found = moving(i);
        ((found - usual_mass).abs() > allowed).then(|| {
            if fit.restoring.is_per_inertia() {
                let text = format!(
                    "run {:?} has a period of {:.4} s where the others have {:.4} s: check the body, the springs and the unit of time",
                    fit.runs[i].id,
                    fit.runs[i].period_s,
                    usual_s(i)
                );
                return warning("release-stands-out", text);
            }
            let text = format!(
                "run {:?} has a period of {:.4} s, which gives a moving inertia of {found:.4} {of_mass}; the other runs give {usual_mass:.4} {of_mass} ({:+.1} %): check the body, the springs \
                 and the unit of time; the table of releases lists {} from each release alone",
                fit.runs[i].id,
                fit.runs[i].period_s,
                100.0 * (found / usual_mass - 1.0),
                fit.names[0]
            );
            warning("release-stands-out", text)
        })
    };
    (0..fit.runs.len()).filter_map(of).collect()
}

fn negative(fit: &DecayFit, j: usize) -> Option<Finding> {
    let (name, value) = (&fit.names[j], fit.values[j]);
    let mean = |of: &dyn Fn(&HalfCycle) -> f64| fit.rows.iter().map(of).sum::<f64>() / fit.rows.len() as f64;
    let u = mean(&|r| r.speed_amplitude);
    let force = if j == 1 { value * u } else { EIGHT_OVER_3_PI * value * u * u };
    if force > -WORTH * mean(&|r| r.force_amplitude.abs()) {
        return None;
    }
    Some(match fit.interval_95(j) {
        Some([_, high]) if high >= 0.0 => note(
            "negative-damping",
            format!("{name} is {value:.4}, and its interval reaches to {high:.4}: these releases do not show it"),
        ),
        _ => warning(
            "negative-damping",
            format!(
                "{name} is {value:.4}, below zero: water dissipates energy; look for friction, drift, or too narrow a range"
            ),
        ),
    })
}

/// A part of the decrement that does not depend on the amplitude.
fn coulomb(reduced: &Reduced<'_>, fit: &DecayFit, setup: &DecaySetup) -> Option<Finding> {
    let pooled = reduced.pooled?;
    let [force, classical, classical_dof] = all_but(&reduced.sums, None)?.coulomb(&pooled)?;
    let n = reduced.sums.len();
    let (standard, dof) = if n >= FEWEST_RUNS {
        jackknife_of_one(n, |g| all_but(&reduced.sums, Some(g))?.coulomb(&pooled).map(|c| c[0]))?
    } else {
        (classical, classical_dof)
    };
    let unit = setup.force_unit();
    let per = if setup.restoring.is_per_inertia() { " per moving inertia" } else { "" };
    let mean = fit.rows.iter().map(|r| r.force_amplitude).sum::<f64>() / fit.rows.len() as f64;
    (force > WORTH * mean && standard > 0.0 && force > coverage_factor(SEEN, dof) * standard).then(|| {
        warning(
            "coulomb-friction",
            format!(
                "each half cycle loses the same whatever its amplitude, as {force:.3e} ± {standard:.1e} {unit} of Coulomb \
                 friction{per} would: the damping includes friction of the rig; free the guides or hang the body"
            ),
        )
    })
}

/// The first half cycle of each release beside what the law of the others makes of it.
fn first_half_cycles(fit: &DecayFit) -> Option<Finding> {
    let x = |r: &HalfCycle| [r.speed_amplitude, EIGHT_OVER_3_PI * r.speed_amplitude * r.speed_amplitude];
    let (first, others): (Vec<&HalfCycle>, Vec<&HalfCycle>) = fit.rows.iter().partition(|r| r.half_cycle == 0);
    let design = Mat::from_fn(others.len(), 2, |i, j| x(others[i])[j]);
    let forces = Col::from_fn(others.len(), |i| others[i].force_amplitude);
    let inverse = inverted(&(design.transpose() * &design))?;
    let law = &inverse * (design.transpose() * &forces);
    // Each release has a rest position of its own.
    let dof = others.len() as f64 - 2.0 - first.len() as f64;
    let n = first.len() as f64;
    let mean = |of: &dyn Fn(&HalfCycle) -> f64| first.iter().map(|r| of(r)).sum::<f64>() / n;
    let at = Col::from_fn(2, |j| mean(&|r| x(r)[j]));
    let force = at.transpose() * &law;
    let off = mean(&|r| r.force_amplitude) - force;
    let reach = at.transpose() * (&inverse * &at);
    let variance = (forces - design * law).squared_norm_l2() / dof;
    let chance = (variance * (1.0 / n + reach)).sqrt();
    (dof > 0.0 && off.abs() > BEYOND_CHANCE * chance && off.abs() > FIRST_OFF * force.abs()).then(|| {
        warning(
            "start-not-free",
            format!(
                "the first half cycles lose {:+.1} % against the law of the others ({:.1} times what chance does): they include the release \
                 or the start-up of the flow; skip half cycles",
                100.0 * off / force,
                off.abs() / chance
            ),
        )
    })
}

/// A swing that is larger than the one before.
fn growing(reduced: &Reduced<'_>, swings: &Swings, id: &str, setup: &DecaySetup) -> Option<Finding> {
    let rest = reduced.rest(swings, setup.restoring.stiffness());
    let amplitude = |k: usize| swings.side_of(k) * (swings.turns[k].position - rest);
    let chance = |k: usize| swings.noise * (swings.turns[k].variance + swings.turns[k + 1].variance).sqrt();
    let grown = (0..swings.half_cycles())
        .find(|&k| amplitude(k + 1) - amplitude(k) > BEYOND_CHANCE * chance(k).max(1e-9 * amplitude(k).abs()))?;
    Some(warning(
        "swing-grows",
        format!(
            "run {id:?}: turn {} is {:.3e} from rest, the one before {:.3e}: another mode or a wave adds energy; let the water \
             calm down, or use the runs up to there",
            grown + 1,
            amplitude(grown + 1),
            amplitude(grown)
        ),
    ))
}

/// A rest position that moves while the body swings.
fn drifting(swings: &Swings, id: &str, setup: &DecaySetup) -> Option<Finding> {
    let t = &swings.turns;
    let rests: Vec<[f64; 2]> = (1..t.len() - 1)
        .map(|k| [t[k].time_s, 0.25 * (t[k - 1].position + 2.0 * t[k].position + t[k + 1].position)])
        .collect();
    let n = rests.len() as f64;
    if rests.len() < 4 {
        return None;
    }
    let mean = |of: usize| rests.iter().map(|r| r[of]).sum::<f64>() / n;
    let (time, rest) = (mean(0), mean(1));
    let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
    for [x, y] in &rests {
        xx += (x - time).powi(2);
        xy += (x - time) * (y - rest);
        yy += (y - rest).powi(2);
    }
    let slope = xy / xx;
    let left = ((yy - slope * xy).max(0.0) / (n - 2.0)).sqrt();
    let noise = swings.noise * t[0].variance.sqrt();
    let chance = left.max(noise) / xx.sqrt();
    let over = slope * (t[t.len() - 1].time_s - t[0].time_s);
    (slope.abs() > BEYOND_CHANCE * chance && over.abs() > swings.noise).then(|| {
        warning(
            "rest-drifts",
            format!(
                "run {id:?}: the rest position moves by {over:+.3e} {} while the body swings; both methods assume it fixed",
                setup.axis.position_unit()
            ),
        )
    })
}

/// What the fitted motion leaves.
pub(super) fn of_residuals(fit: &DecayFit, residuals: &[Vec<f64>], reduced: &Reduced<'_>) -> Vec<Finding> {
    let mut out = Vec::new();
    for ((run, left), (record, swings)) in fit.runs.iter().zip(residuals).zip(&reduced.runs) {
        let noise = run.noise.max(1e-9 * fit.range.amplitude[1]);
        // A hand that still holds is in the first samples, and hardly in the mean over all of them.
        let first = ((FIRST_PART * fit.range.period_s / record.step_s()) as usize).min(left.len());
        let rms = (left[..first].iter().map(|r| r * r).sum::<f64>() / first.max(1) as f64).sqrt();
        if first >= FEWEST_FIRST && rms > FIRST_BEYOND * run.residual_rms.max(noise) {
            out.push(warning(
                "start-not-free",
                format!(
                    "run {:?}: over the first {:.2} s from {:.2} s on the fit leaves {rms:.2e} {}, {:.1} times what it leaves over all: the body was not \
                     free yet; leave free_from out, or let it begin after the release",
                    run.id,
                    FIRST_PART * fit.range.period_s,
                    run.from_s,
                    fit.axis.position_unit(),
                    rms / run.residual_rms
                ),
            ));
        }
        if run.residual_rms <= BEYOND_NOISE * noise {
            continue;
        }
        let rate = 1.0 / (left.len() as f64 * record.step_s());
        let natural = 1.0 / fit.range.period_s;
        match line(left, &record.time_s[swings.samples[0]..swings.samples[1]]) {
            Some((frequency, amplitude, part)) if part > LINE && is_apart(frequency, natural, rate) => {
                out.push(warning(
                    "second-mode",
                    format!(
                        "run {:?}: {:.0} % of what the fit leaves swings at {frequency:.3} Hz with {amplitude:.2e} {}, beside {natural:.3} Hz of the \
                         decay: a second mode; restrain it, or choose the axes of the modes",
                        run.id,
                        100.0 * part,
                        fit.axis.position_unit()
                    ),
                ));
            }
            _ => out.push(warning(
                "residuals-beyond-noise",
                format!(
                    "run {:?}: the fit leaves {:.2e} {} rms where a sample's noise is {:.2e}: the damping law does not explain the whole motion",
                    run.id,
                    run.residual_rms,
                    fit.axis.position_unit(),
                    run.noise
                ),
            )),
        }
    }
    out
}

/// A frequency that neither the decay itself nor its third harmonic leaves.
fn is_apart(frequency: f64, natural: f64, resolution: f64) -> bool {
    [1.0, 3.0].iter().all(|k| (frequency - k * natural).abs() > 1.5 * resolution)
}

/// Strongest line of a series at these times: frequency, amplitude, its part of the power.
fn line(series: &[f64], time_s: &[f64]) -> Option<(f64, f64, f64)> {
    let n = series.len() as f64;
    let start_s = *time_s.first()?;
    let step_s = (time_s.last()? - start_s) / (n - 1.0).max(1.0);
    let power: f64 = series.iter().map(|x| x * x).sum();
    let at = |f: f64| {
        let (mut c, mut s) = (0.0, 0.0);
        for (t, x) in time_s.iter().zip(series) {
            let phase = TAU * f * (t - start_s);
            c += x * phase.cos();
            s += x * phase.sin();
        }
        2.0 / n * c.hypot(s)
    };
    // Twice as fine as the record resolves, up to half the rate; long records up to their 500th line.
    let lines = series.len().min(1000);
    let best =
        (1..lines).map(|k| 0.5 * k as f64 / (n * step_s)).map(|f| (f, at(f))).max_by(|a, b| a.1.total_cmp(&b.1))?;
    (power > 0.0).then(|| (best.0, best.1, 0.5 * n * best.1 * best.1 / power))
}

/// The search ended early.
pub(super) fn not_converged(report: Report) -> Finding {
    warning(
        "not-converged",
        format!(
            "the fit of the motion stopped after {} without meeting its convergence criterion ({:?}); its numbers are the best found",
            counted(report.iterations, "step", "steps"),
            report.end
        ),
    )
}
