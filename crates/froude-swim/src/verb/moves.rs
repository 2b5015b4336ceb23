//! What the joints of a swimmer do: a gait from its file and what was typed, or a recording.

use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

use froude_records::RecordError;
use froude_records::block::{ResultColumn, facts};
use froude_records::table::Table;
use froude_records::table_file::read_table;
use froude_records::units::Dimension;

use super::VerbError;
use crate::course::Recorded;
use crate::drive::Motor;
use crate::gait::{Course, Envelope, Gait, Pitching};
use crate::gait_file::{GaitForm, PitchFile, read_gait};
use crate::joints::Drives;
use crate::motor_file::read_motor;
use crate::robot_file::RobotFile;
use crate::spatial::vector::Axis;

/// What is asked of the joints.
#[derive(Debug, Clone, PartialEq)]
pub enum Moves {
    /// A wave, in numbers.
    Wave(Gait),
    /// A gait file, with numbers that stand before its own.
    File {
        /// The file.
        path: PathBuf,
        /// What was typed.
        typed: Typed,
    },
    /// Recorded joint angles: a table with `time` and `phi_1`, `phi_2`, ….
    Track(PathBuf),
}

/// Numbers of a gait, as far as they were typed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Typed {
    /// rad.
    pub amplitude_rad: Option<f64>,
    /// rad/s.
    pub frequency_rad_s: Option<f64>,
    /// rad.
    pub phase_rad: Option<f64>,
    /// rad.
    pub turn_rad: Option<f64>,
}

/// A periodic course, with the time in which a trajectory reaches it.
#[derive(Debug, Clone)]
pub(super) struct Periodically {
    pub(super) wave: Wave,
    pub(super) ramp_s: Option<f64>,
}

/// A gait or one period of a recording.
#[derive(Debug, Clone)]
pub(super) enum Wave {
    Gait(Gait),
    Table(Recorded),
}

impl Periodically {
    pub(super) fn course(&self) -> &dyn Course {
        match &self.wave {
            Wave::Gait(gait) => gait,
            Wave::Table(cycle) => cycle,
        }
    }
}

impl Moves {
    /// The wave or the period of a gait for a robot, its joints that pitch as typed; `no_recording` says why a recording will not do.
    pub(super) fn periodically(
        &self,
        (robot, file): (&Path, &RobotFile),
        pitching: &PitchFile,
        no_recording: &str,
    ) -> Result<Periodically, VerbError> {
        let wrong = |path, problem: &str| Err(VerbError::input(path, problem));
        let (is_typed, is_3d) = (*pitching != PitchFile::default(), file.model.is_3d);
        if is_typed && !is_3d {
            return wrong(robot, "is a planar model; the pitch options need space = \"3d\" in [model]");
        }
        let (mut found, own) = match self {
            Self::Wave(gait) => (Periodically { wave: Wave::Gait(gait.clone()), ramp_s: None }, None),
            Self::File { path, typed } => {
                let (found, own) = gait_of(path, typed, file.axes.len())?;
                if own.is_some() && !is_3d {
                    return wrong(
                        path,
                        "has pitch, and joints of a plane yaw: leave it out, or write space = \"3d\" in the robot file",
                    );
                }
                (found, own)
            }
            Self::Track(path) => return wrong(path, no_recording),
        };
        match &mut found.wave {
            Wave::Gait(gait) if file.axes.contains(&Axis::Pitch) => {
                let own = own.unwrap_or_default();
                gait.pitching = Some(Pitching {
                    amplitude: pitching.amplitude_rad.or(own.amplitude_rad).unwrap_or(0.0),
                    ahead: pitching.ahead_rad.or(own.ahead_rad).unwrap_or(FRAC_PI_2),
                    turn: pitching.turn_rad.or(own.turn_rad).unwrap_or(0.0),
                    axes: file.axes.clone(),
                });
            }
            Wave::Gait(_) if is_typed || own.is_some() => {
                return wrong(
                    robot,
                    "has no joint that pitches, but the gait has a pitch wave: write axis = \"pitch\" in a [[joint]], or leave pitch out",
                );
            }
            Wave::Table(_) if is_typed => {
                return wrong(
                    robot,
                    "is three-dimensional and follows a table, which already has the angles of all joints: leave the pitch options out",
                );
            }
            _ => {}
        }
        Ok(found)
    }
}

/// The gait of a file for so many joints, with what it says of those that pitch.
fn gait_of(path: &Path, typed: &Typed, joints: usize) -> Result<(Periodically, Option<PitchFile>), VerbError> {
    let file = read_gait(path)?;
    let wrong = |problem: String| VerbError::input(path, problem);
    let envelope = match file.form {
        GaitForm::Lateral => Envelope::Lateral,
        GaitForm::Eel => Envelope::Eel,
        GaitForm::Factors(factors) if factors.len() != joints => {
            let problem =
                format!("envelope has {} factors, and the robot has {joints} joints: write one of each", factors.len());
            return Err(wrong(problem));
        }
        GaitForm::Factors(factors) => Envelope::Factors(factors),
        GaitForm::Table { path: table, .. } => {
            if *typed != Typed::default() {
                let problem = "takes its angles from a table; --amplitude, --frequency, --phase and --turn mean nothing beside it: leave them out";
                return Err(wrong(problem.to_owned()));
            }
            let cycle = recorded(&table, joints, true)?;
            return Ok((Periodically { wave: Wave::Table(cycle), ramp_s: file.ramp_s }, file.pitch));
        }
    };
    let need = |typed: Option<f64>, own: Option<f64>, key: &str, example: &str| {
        typed
            .or(own)
            .ok_or_else(|| wrong(format!("has no {key}: write {key} = \"{example}\", or type --{key} '{example}'")))
    };
    let gait = Gait {
        amplitude: need(typed.amplitude_rad, file.amplitude_rad, "amplitude", "30 deg")?,
        frequency: need(typed.frequency_rad_s, file.frequency_rad_s, "frequency", "80 deg/s")?,
        phase: need(typed.phase_rad, file.phase_rad, "phase", "40 deg")?,
        turn: typed.turn_rad.or(file.turn_rad).unwrap_or(0.0),
        envelope,
        pitching: None,
    };
    Ok((Periodically { wave: Wave::Gait(gait), ramp_s: file.ramp_s }, file.pitch))
}

/// Joint angles of a table.
pub(super) fn recorded(path: &Path, joints: usize, is_cycle: bool) -> Result<Recorded, VerbError> {
    let table = read_table(path, None)?;
    let wrong = |problem: String| VerbError::input(path, problem);
    let time = table.number("time", Dimension::TIME)?;
    let angles: Vec<Vec<f64>> = (1..=joints).map(|i| angle(&table, i)).collect::<Result<_, _>>()?;
    let next = format!("phi_{}", joints + 1);
    if table.columns.iter().any(|c| c.name == next) {
        return Err(wrong(format!("has {next}, and the robot has {joints} joints: one angle less than modules")));
    }
    if is_cycle {
        for (i, angle) in angles.iter().enumerate() {
            let (Some(first), Some(last)) = (angle.first(), angle.last()) else { continue };
            let size = angle.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
            if (last - first).abs() > CLOSES * size {
                return Err(wrong(format!(
                    "phi_{} begins a period at {:.4} deg and ends it at {:.4} deg: its last row must be the first one again; of angles that do not repeat give --track",
                    i + 1,
                    first.to_degrees(),
                    last.to_degrees()
                )));
            }
        }
    }
    let found = if is_cycle { Recorded::cycle(time, &angles) } else { Recorded::track(time, &angles) };
    found.map_err(|e| wrong(e.to_string()))
}

/// A period closes when its ends differ by less than this part of its largest angle.
const CLOSES: f64 = 1e-3;

fn angle(table: &Table, joint: usize) -> Result<Vec<f64>, RecordError> {
    table.number(&format!("phi_{joint}"), Dimension::ANGLE).map(<[f64]>::to_vec)
}

/// Joints with the motor of a file.
pub(super) fn with_motor(drives: Drives, path: &Path) -> Result<Drives, RecordError> {
    let file = read_motor(path)?;
    let own = &drives.motor;
    let motor = Motor {
        curve: file.curve,
        efficiency: file.efficiency.or(own.efficiency),
        regeneration: file.regeneration.unwrap_or(own.regeneration),
    };
    Ok(Drives { motor, ..drives })
}

/// What was asked of the joints.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Asked {
    /// A gait file or a recording, with what it is.
    pub file: Option<(&'static str, PathBuf)>,
    /// The gait in numbers, where it has them.
    pub gait: Option<Gait>,
    /// In which a trajectory reaches it, s.
    pub ramp_s: Option<f64>,
}

impl Asked {
    pub(super) fn of(moves: &Moves, periodically: Option<&Periodically>) -> Self {
        let gait = periodically.and_then(|p| match &p.wave {
            Wave::Gait(gait) => Some(gait.clone()),
            Wave::Table(_) => None,
        });
        let file = match moves {
            Moves::Wave(_) => None,
            Moves::File { path, .. } => Some(("gait file", path.clone())),
            Moves::Track(path) => Some(("recording", path.clone())),
        };
        Self { file, gait, ramp_s: periodically.and_then(|p| p.ramp_s) }
    }

    fn form(gait: &Gait) -> &'static str {
        match gait.envelope {
            Envelope::Lateral => "lateral",
            Envelope::Eel => "eel",
            Envelope::Factors(_) => "envelope",
        }
    }

    /// Facts of it.
    pub(super) fn columns(&self) -> Vec<ResultColumn> {
        let f = facts("", "", self);
        let file = self.file.as_ref().map_or("gait file", |(name, _)| name);
        let gait = |of: fn(&Gait) -> f64| move |asked: &Self| asked.gait.as_ref().map(of);
        vec![
            f.text("asked/file", file, |a| a.file.as_ref().map(|(_, path)| path.display().to_string())),
            f.text("asked/gait", "gait", |a| a.gait.as_ref().map(|gait| Self::form(gait).to_owned())),
            f.number("asked/amplitude_rad", "amplitude [deg]", gait(|g| g.amplitude)).plain(5),
            f.number("asked/frequency_rad_s", "frequency [deg/s]", gait(|g| g.frequency)).plain(5),
            f.number("asked/phase_rad", "phase [deg]", gait(|g| g.phase)).plain(5),
            f.number("asked/turn_rad", "turn [deg]", gait(|g| g.turn)).plain(5),
            f.number("asked/ramp_s", "ramp of the trajectory [s]", |a| a.ramp_s),
        ]
    }
}
