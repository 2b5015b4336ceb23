//! What is doubtful about a joint fit, whichever the equation, with the numbers that support it.

use froude_fit::Status;
use froude_fit::budget::Uncertain;
use froude_fit::distribution::t_two_sided;
use froude_records::finding::{Finding, Severity};
use froude_records::number;
use froude_records::text::counted;
use froude_records::units::parse_unit;

use super::{Fitted, JointFit, Run};
use crate::channel::Channel;
use crate::findings::warning;
use crate::motion::{Cycles, Motion};

/// Amplitudes of the cycles used differ by no more than this part of their mean.
const STEADY: f64 = 0.02;
/// A period within this part of a whole number is whole.
const WHOLE: f64 = 0.02;
/// False-alarm probability, over all declarations.
const ALARM: f64 = 0.004;
/// Of five independent cycles a fifth of the variance repeats; more than this is a misfit.
const REPEATED: f64 = 0.6;

/// A motion that is not the same from cycle to cycle, or not of the harmonics that it was fitted by.
pub(crate) fn of_motion(id: &str, motion: &Motion, of: &Channel, cycles: Cycles, harmonics: usize) -> Vec<Finding> {
    let Channel { name, shown: unit, .. } = of;
    let shown = |si: f64| parse_unit(unit).map_or(si, |unit| unit.from_si(si));
    let mut out = Vec::new();
    out.extend((motion.dropped > 0).then(|| {
        warning(
            "cycles-dropped",
            format!(
                "run {id:?}: {} that a mark touches {} not used, {} are",
                counted(motion.dropped, "cycle", "cycles"),
                if motion.dropped == 1 { "is" } else { "are" },
                motion.whole
            ),
        )
    }));
    let mean = motion.amplitudes.iter().sum::<f64>() / motion.amplitudes.len() as f64;
    let off = |a: &f64| (a / mean - 1.0).abs();
    let worst =
        (0..motion.amplitudes.len()).max_by(|&a, &b| off(&motion.amplitudes[a]).total_cmp(&off(&motion.amplitudes[b])));
    if let Some(cycle) = worst.filter(|&c| off(&motion.amplitudes[c]) > STEADY) {
        out.push(warning(
            "cycles-not-alike",
            format!(
                "run {:?}: cycle {} has an amplitude of {:.2} {unit} where the mean is {:.2} {unit}; leave out more cycles of start-up (cycles.skip), or check the servo",
                id,
                motion.numbers[cycle] + 1 + cycles.skip,
                shown(motion.amplitudes[cycle]),
                shown(mean)
            ),
        ));
    }
    let highest = (1..=harmonics).map(|k| motion.angle.amplitude(k)).fold(0.0, f64::max);
    if motion.angle.residual_std > 0.02 * highest {
        out.push(warning(
            &format!("{name}-not-periodic"),
            format!(
                "run {:?}: {} harmonics leave {:.3} {unit} of the {name}, {:.1} % of its amplitude; velocity and acceleration come from the harmonics alone: raise \
                 `harmonics`, or use a steadier part",
                id,
                harmonics,
                shown(motion.angle.residual_std),
                1e2 * motion.angle.residual_std / highest
            ),
        ));
    }
    out
}

/// Whether all of these runs are used over whole periods.
pub(crate) fn are_whole(mut periods: impl Iterator<Item = f64>) -> bool {
    periods.all(|p| (p - p.round()).abs() < WHOLE)
}

/// Part of the residuals' variance that repeats from cycle to cycle; `None` for fewer than two whole cycles. Of independent cycles it is one over
/// their number.
fn repeated(motion: &Motion, load: &[f64], fitted: &Fitted) -> Option<f64> {
    let (first, n) = (motion.samples().start, motion.cycles.len());
    let length = motion.cycles.iter().map(ExactSizeIterator::len).min().filter(|_| n >= 2)?;
    let left = |cycle: usize, i: usize| {
        let row = motion.cycles[cycle].start + i;
        load[row] - fitted.load[row - first]
    };
    let (mut common, mut all) = (0.0, 0.0);
    for i in 0..length {
        let mean = (0..n).map(|c| left(c, i)).sum::<f64>() / n as f64;
        common += mean * mean;
        all += (0..n).map(|c| left(c, i).powi(2)).sum::<f64>() / n as f64;
    }
    (all > 0.0).then(|| common / all)
}

/// Residuals of the loads that repeat from cycle to cycle; `means` is what it can be.
pub(crate) fn misfit(fit: &JointFit, runs: &[Run<'_>], loads: &[Channel], means: &str) -> Vec<Finding> {
    let one = |(k, load): (usize, &Channel)| {
        let part_of = |(run, fitted): (&Run<'_>, &Vec<Fitted>)| repeated(run.motion, run.loads[k], &fitted[k]);
        let parts: Vec<f64> = runs.iter().zip(&fit.fitted).filter_map(part_of).collect();
        let part = parts.iter().sum::<f64>() / parts.len() as f64;
        let Channel { name, unit, .. } = load;
        let of = if loads.len() == 1 { String::new() } else { format!(" of the {name}") };
        (part > REPEATED).then(|| {
            warning(
                "misfit-repeats",
                format!(
                    "{}: {:.0} % of the residuals' variance{of} ({} {unit} rms) repeats from cycle to cycle, so it is not noise; possible causes: {means}. The intervals include only the part that differs between runs",
                    fit.law,
                    1e2 * part,
                    number::significant(fit.sigma[k], 2)
                ),
            )
        })
    };
    loads.iter().enumerate().filter_map(one).collect()
}

/// Coefficients that the runs do not determine; `why` says what to do.
pub(crate) fn undetermined(fit: &JointFit, why: &str) -> Option<Finding> {
    let lost: Vec<&str> =
        fit.unknowns.iter().filter(|u| u.status == Status::Undetermined).map(|u| u.name.as_str()).collect();
    (!lost.is_empty()).then(|| {
        let text = format!("{}: {} cannot be told apart by these runs. {why}", fit.law, lost.join(", "));
        Finding::new(Severity::Error, "undetermined", text)
    })
}

/// Numbers that are declared and that the runs move by more than chance: name, value and standard uncertainty of each. What is declared as exact and found by
/// runs all the same has no weight in the fit; its own uncertainty there is the measure.
pub(crate) fn contradicted(fit: &JointFit, declared: &[(String, Uncertain)], check: &str) -> Vec<Finding> {
    let one = |(name, known): &(String, Uncertain)| {
        let unknown = fit.unknown(name)?;
        let (found, combined) = unknown.value.zip(unknown.combined)?;
        // The posterior lies between the two: its variance is smaller than that of the declared one by that of its shift.
        let shift = match known.standard {
            0.0 => combined.standard,
            standard => (standard * standard - combined.standard * combined.standard).max(0.0).sqrt(),
        };
        // With few runs the scatter, and hence the shift, is poorly known.
        // The shift is that of data of u_d = u_p c/√(u_p² − c²); ν = ν_c (u_p/u_d)⁴.
        let by_data = if known.standard > 0.0 { (shift / combined.standard).powi(4) } else { 1.0 };
        let p = t_two_sided((found - known.value).abs() / shift, combined.dof * by_data);
        (shift > 0.0 && p * (declared.len() as f64) < ALARM).then(|| {
            warning(
                "declared-contradicted",
                format!(
                    "{}: {name} is declared as {} ± {} {unit} (standard uncertainty) and the runs move it to {} {unit}; check the declaration, and {check}",
                    fit.law,
                    number::plain(known.value, 4),
                    number::significant(known.standard, 2),
                    number::plain(found, 4),
                    unit = unknown.unit
                ),
            )
        })
    };
    declared.iter().filter_map(one).collect()
}

/// Too few runs to see what changes from one to the next.
pub(crate) fn few_runs(fit: &JointFit) -> Option<Finding> {
    (!fit.has_runs).then(|| {
        warning(
            "few-runs",
            format!(
                "{}: what changes from run to run is not included in the intervals, which are from {}; three runs show it",
                fit.law,
                counted(fit.clusters, "cycle", "cycles")
            ),
        )
    })
}
