//! `froude carriage calibrate`: newtons a volt from known weights over a pulley, and polarity from the jogs.

use std::path::PathBuf;

use froude_identify::carriage::DragRun;
use froude_identify::carriage::calibration::Calibration;
use froude_records::finding::{Finding, Severity};
use froude_records::run::{RunKind, RunLog};
use froude_records::units::Dimension;

use super::drag::{calibration_of, setup_of};
use super::runs::{for_drag, read};
use crate::Error;

/// What a jog showed.
#[derive(Debug, Clone, PartialEq)]
pub struct Jog {
    /// The run.
    pub id: String,
    /// Mean command while it moved, V.
    pub command_v: f64,
    /// How far it went, m.
    pub way_m: f64,
    /// Whether it went where the command pushed.
    pub is_right: bool,
}

/// What came out.
#[derive(Debug, Clone)]
pub struct CalibrationOutcome {
    /// Newtons a volt, where weights were hung.
    pub calibration: Option<Calibration>,
    /// Ideal newtons a volt of the declared constants.
    pub ideal_force_per_volt_n: f64,
    /// Jogs.
    pub jogs: Vec<Jog>,
    /// What is doubtful.
    pub findings: Vec<Finding>,
}

/// Reads calibration runs and jogs. A known distance (`measured_m` for the way that the counts call `counted_m`) gives the
/// encoder's scale; see [`encoder_scale`].
///
/// # Errors
///
/// See [`Error`].
pub fn calibrate(paths: &[PathBuf], campaign: Option<PathBuf>) -> Result<CalibrationOutcome, Error> {
    let runs = read(paths, &[RunKind::Calibration, RunKind::Jog], campaign.as_deref())?;
    let constants = runs.logs.iter().find_map(|log| log.meta.moving_axis());
    let setup = setup_of(runs.campaign.as_ref(), constants, None);
    let hung: Vec<DragRun<'_>> =
        runs.logs.iter().map(for_drag).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
    let (calibration, why_not) = calibration_of(&hung, runs.campaign.as_ref(), &setup);
    let jogs: Vec<Jog> =
        runs.logs.iter().filter(|l| l.meta.kind == RunKind::Jog).map(jog).collect::<Result<_, _>>()?;
    let mut findings = runs.findings;
    findings.extend(why_not);
    for jog in jogs.iter().filter(|j| !j.is_right) {
        findings.push(Finding::new(
            Severity::Error,
            "polarity",
            format!(
                "{}: {:.2} V moved the axis {:.2} mm the other way: motor or encoder is wired in reverse; swap the encoder's channels \
                 or make counts_per_revolution negative",
                jog.id,
                jog.command_v,
                1e3 * jog.way_m
            ),
        ));
    }
    if calibration.is_none() {
        findings.push(Finding::new(
            Severity::Warning,
            "not-calibrated",
            "no D_d from motor currents is stated better than the declared gear efficiency and K_T allow; hang known weights over a \
             pulley and drive both ways ([carriage.calibration])"
                .to_owned(),
        ));
    }
    Ok(CalibrationOutcome { calibration, ideal_force_per_volt_n: setup.ideal_force_per_volt_n, jogs, findings })
}

fn jog(log: &RunLog) -> Result<Jog, Error> {
    let axis = log.meta.axis.name();
    let position = log.channel(&format!("{axis}/position"), Dimension::LENGTH)?;
    let command = log.channel(&format!("{axis}/command"), Dimension::VOLTAGE)?;
    // The jog is where the command is largest; holding before and after is not.
    let peak = command.iter().fold(0.0, |m: f64, u| if u.abs() > m.abs() { *u } else { m });
    let on: Vec<usize> = (0..command.len()).filter(|&i| command[i] * peak > 0.25 * peak * peak).collect();
    let way_m = match (on.first(), on.last()) {
        (Some(&first), Some(&last)) => position[last] - position[first],
        _ => 0.0,
    };
    let command_v = on.iter().map(|&i| command[i]).sum::<f64>() / on.len().max(1) as f64;
    Ok(Jog { id: log.meta.id.clone(), command_v, way_m, is_right: way_m * command_v > 0.0 })
}

/// Encoder scale from a known distance: sprocket radius that makes the counted way the measured one, with its standard
/// uncertainty, m.
///
/// R′ = R · measured/counted; the distance's standard uncertainty and one count each at its ends go with it.
#[must_use]
pub fn encoder_scale(radius_m: f64, measured_m: f64, measured_std_m: f64, counted_m: f64, count_m: f64) -> (f64, f64) {
    let radius = radius_m * measured_m / counted_m;
    // Two ends, each rounded to a count: uniform of width one count.
    let rounding = count_m / 6f64.sqrt();
    let relative = (measured_std_m / measured_m).hypot(rounding / counted_m);
    (radius, radius.abs() * relative)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_way_that_measures_two_per_mille_longer_makes_the_sprocket_two_per_mille_larger() {
        let (radius, std) = encoder_scale(0.055, 2.004, 0.001, 2.0, 2.47e-6);
        assert!((radius - 0.055 * 1.002).abs() < 1e-12);
        assert!((std / radius - 0.001 / 2.004).abs() < 1e-6);
    }
}
