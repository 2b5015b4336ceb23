//! `froude carriage calibrate`: newtons a volt from known weights over a pulley, and polarity from the jogs.

use std::path::PathBuf;

use froude_carriage::drag::DragRun;
use froude_carriage::drag::calibration::{Calibration, Jog as Verdict, jog as judged};
use froude_records::finding::{Finding, Severity};
use froude_records::run::{Role, RunLog};
use froude_records::text::counted;
use froude_records::units::Dimension;

use crate::Error;
use froude_carriage::reduction::{calibration_of, setup_of};
use froude_carriage::runs::{for_drag, read};

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
    pub verdict: Verdict,
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

/// State code of an exciting axis in a log (`froude_control::status::Phase`).
const EXCITING: f64 = 4.0;

/// Reads calibration runs and jogs.
///
/// # Errors
///
/// See [`Error`].
pub fn calibrate(paths: &[PathBuf], campaign: Option<PathBuf>) -> Result<CalibrationOutcome, Error> {
    let runs = read(paths, &[Role::Calibration, Role::Jog], campaign.as_deref())?;
    let constants = runs.logs.iter().find_map(|log| log.meta.moving_axis());
    let setup = setup_of(runs.campaign.as_ref(), constants);
    let hung: Vec<DragRun<'_>> =
        runs.logs.iter().map(for_drag).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
    let (calibration, why_not) = calibration_of(&hung, runs.campaign.as_ref(), &setup);
    let jogs: Vec<Jog> = runs.logs.iter().filter(|l| l.meta.role == Role::Jog).map(jog).collect::<Result<_, _>>()?;
    let mut findings = runs.findings;
    findings.extend(why_not);
    for jog in jogs.iter().filter(|j| j.verdict != Verdict::Right) {
        let text = match jog.verdict {
            Verdict::NoMotion { largest_v } => {
                format!("{}: up to {largest_v:.2} V did not move the axis; raise the jog above breakaway", jog.id)
            }
            _ => format!(
                "{}: {:.2} V moved the axis {:.2} mm the other way: motor or encoder is wired in reverse; swap the encoder's channels \
                 or make counts_per_revolution negative",
                jog.id,
                jog.command_v,
                1e3 * jog.way_m
            ),
        };
        findings.push(Finding::new(Severity::Error, "polarity", text));
    }
    if calibration.is_none() && paths.iter().all(|p| p.is_file()) {
        let text = format!(
            "{} named and read; the folder {} may hold others",
            counted(paths.len(), "run was", "runs were"),
            runs.folder.display()
        );
        findings.push(Finding::new(Severity::Note, "single-runs", text));
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
    let axis = log.meta.carriage.axis.name();
    let position = log.channel(&format!("{axis}/position"), Dimension::LENGTH)?;
    let command = log.channel(&format!("{axis}/command"), Dimension::VOLTAGE)?;
    let state = log.channel(&format!("{axis}/state"), Dimension::ONE)?;
    // Only while the loop is open: what holds before and brakes after pushes the other way.
    let first = state.iter().position(|s| *s == EXCITING).unwrap_or(0);
    let end = state.iter().rposition(|s| *s == EXCITING).map_or(first, |i| i + 1);
    let (position, command) = (&position[first..end], &command[first..end]);
    let way_m = position.last().zip(position.first()).map_or(0.0, |(last, first)| last - first);
    Ok(Jog {
        id: log.meta.id.clone(),
        command_v: command.iter().sum::<f64>() / command.len().max(1) as f64,
        way_m,
        verdict: judged(position, command),
    })
}
