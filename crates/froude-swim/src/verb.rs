//! `froude swim` and `froude robot inspect`: a robot file and a gait become speed, powers and cost of transport, and a trajectory.

mod animation;
mod answer;
mod balance;
mod columns;
mod figures;
mod leaves;
mod look;
mod moves;
mod optimise;
mod reads;
mod sweep;
mod told;
pub mod typed;
mod uncertain;
mod water;
mod way;

use std::fmt::Display;
use std::path::{Path, PathBuf};

use froude_records::RecordError;
use froude_records::block::{Block, Section};
use froude_records::outcome::{Content, Head, Outcome, OutputFile};
use froude_records::table::Table;

use crate::chain::Chain;
use crate::dynamics::Dynamics;
pub use crate::gait_file::PitchFile as Pitching;
use crate::joints::Drives;
use crate::robot::RobotError;
use crate::robot_file::{RobotFile, read_robot};
use crate::spatial;
use crate::swim::SwimError;
use crate::trajectory::Cut;
use answer::Figures;
pub use look::look;
pub use moves::{Moves, Typed};
pub use optimise::optimise;
use reads::Reads;
pub use sweep::{Ranges, SweepJob, sweep};
pub use uncertain::Drawing;

/// What is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// The robot file.
    pub robot: PathBuf,
    /// What its joints do.
    pub moves: Moves,
    /// The wave of joints that pitch.
    pub pitching: Pitching,
    /// The motor of its joints.
    pub motor: Option<PathBuf>,
    /// The longest step, s.
    pub step_s: Option<f64>,
    /// Folder of trajectory, report, animation and record; without it there are none.
    pub out: Option<PathBuf>,
    /// Periods of the trajectory.
    pub periods: usize,
    /// Date of the report.
    pub date: Option<String>,
    /// Draws of the coefficients.
    pub draws: Option<Drawing>,
    /// Whether each coefficient is changed by itself.
    pub is_sensitive: bool,
}

/// Why a robot does not swim.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum VerbError {
    /// A file could not be read or written, or says something impossible.
    #[error(transparent)]
    Record(#[from] RecordError),
    /// A robot file gives no robot.
    #[error(transparent)]
    Robot(#[from] RobotError),
    /// A request that cannot be carried out. The message starts with the file, if one is at fault.
    #[error("{0}")]
    Refused(String),
    /// A gait has no answer.
    #[error(transparent)]
    Swim(#[from] SwimError),
}

impl VerbError {
    fn input(path: &Path, problem: impl Display) -> Self {
        Self::Refused(format!("{}: {problem}", path.display()))
    }
}

/// Moments of a period in a trajectory.
const MOMENTS: usize = 100;

/// Swims, in the plane or in three dimensions, as the robot file has it; `tell` hears how many draws of how many are done.
///
/// # Errors
///
/// A robot file or record that cannot be used, joints beyond their limits, a gait without a motion that repeats, a wave of joints that pitch where there are none,
/// results in the place of what is read, records without a covariance where draws are asked for.
pub fn swim(job: &Job, tell: &(dyn Fn(usize, usize) + Sync)) -> Result<Outcome, VerbError> {
    let file = read_robot(&job.robot)?;
    if file.model.is_3d {
        way::swim::<spatial::chain::Chain>(&file, job, tell)
    } else {
        way::swim::<Chain>(&file, job, tell)
    }
}

/// What its joints allow and what drives them, with the motor of a file.
fn drives(file: &RobotFile, motor: Option<&Path>) -> Result<Drives, VerbError> {
    let drives = Drives::of(&file.joint, &file.joints);
    Ok(match motor {
        Some(motor) => moves::with_motor(drives, motor)?,
        None => drives,
    })
}

impl Job {
    /// The files that are read; refused where results would take the place of one.
    fn reads(&self, file: &RobotFile) -> Result<Reads, VerbError> {
        let reads = Reads::of(file, &self.robot, &self.moves, self.motor.as_deref());
        if let Some(out) = &self.out {
            reads.spared_by(out)?;
        }
        Ok(reads)
    }

    /// Where a trajectory of the periods that are asked for is cut, of a gait that takes so many steps a period.
    fn cut(&self, period_s: f64, steps: usize) -> Cut {
        Cut {
            moments: self.periods.saturating_mul(MOMENTS),
            apart_s: period_s / MOMENTS as f64,
            steps: steps.div_ceil(MOMENTS),
        }
    }

    /// The answer, with its files where a folder is named: warnings, figures, sentences, and what pages show beside them.
    fn outcome<C: Dynamics>(
        &self,
        f: &Figures<'_, C>,
        [warnings, sentences]: [Vec<String>; 2],
        drawn: Vec<Block>,
        details: Vec<(&str, Vec<Block>)>,
        (trajectory, animation): (Option<Table>, Option<String>),
    ) -> Outcome {
        let mut blocks = vec![Block::text("remarks", warnings)];
        blocks.extend(f.blocks());
        blocks.push(Block::text("remarks", sentences));
        blocks.extend(drawn);
        blocks.extend(
            details.into_iter().map(|(title, part)| Section { is_detail: true, ..Section::new(title, part) }.into()),
        );
        let mut out = Outcome { blocks, ..Outcome::default() };
        if let (Some(folder), Some(trajectory)) = (&self.out, trajectory) {
            let head = Head {
                sort: "Swimming robot".to_owned(),
                title: f.name.to_owned(),
                subtitle: f.subtitle(),
                summary: "The answer".to_owned(),
                date: self.date.clone(),
            };
            let mut file = |key, name, content| out.files.push(OutputFile { key, path: folder.join(name), content });
            file("report", "report.html", Content::Page(head));
            if let Some(page) = animation {
                file("animation", "animation.html", Content::Bytes(page.into_bytes()));
            }
            file("trajectory", "trajectory.parquet", Content::Table(trajectory));
            file("record", "result.json", Content::Result);
        }
        out
    }
}
