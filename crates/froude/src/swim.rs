//! `froude swim`: a robot file and a gait become speed, powers and cost of transport, and a trajectory.

mod animation;
mod columns;
pub mod look;
mod moves;
pub mod optimise;
mod report;
mod space;
mod space_report;
pub mod sweep;
mod told;
pub mod uncertain;
mod water;

use std::path::{Path, PathBuf};

use froude_records::parquet_table::write_parquet;
use froude_records::robot::{AddedFile, ModuleFile, RobotFile, read_robot};
use froude_records::write::write_atomically;
use froude_swim::joints::Drives;
use froude_swim::robot::Robot;
use froude_swim::swim::Swim;
use froude_swim::track::Tracked;
use froude_swim::trajectory::{Begin, Cut, Moment};

use crate::{Error, results};
pub use froude_records::gait_file::PitchFile as Pitching;
pub use moves::{Asked, Moves, Typed};
use moves::{FromRest, Periodically, Wave};
pub use space::{SpatialSwum, SpatialWritten};
use uncertain::Uncertain;

/// What is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// The robot file.
    pub robot: PathBuf,
    /// What its joints do.
    pub moves: Moves,
    /// The motor of its joints.
    pub motor: Option<PathBuf>,
    /// The longest step, s.
    pub step_s: Option<f64>,
    /// Folder of trajectory, report, animation and record, which is replaced as a whole; without it nothing is written.
    pub out: Option<PathBuf>,
    /// Periods of the trajectory.
    pub periods: usize,
    /// Date of the report.
    pub date: Option<String>,
    /// What the coefficients' uncertainty makes of it, where it was asked for.
    pub uncertain: Option<Uncertain>,
}

/// What the joints' motion comes to.
#[derive(Debug, Clone, PartialEq)]
pub enum Came {
    /// Of a gait: the motion that repeats.
    Gait(Swim),
    /// Of a recording: means over its time.
    Track(Tracked),
}

/// What came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Swum {
    /// The robot's name.
    pub name: String,
    /// What was asked of the joints.
    pub asked: Asked,
    /// What the motion comes to.
    pub came: Came,
    /// The robot.
    pub robot: Robot,
    /// What its joints allow, and what drives them.
    pub drives: Drives,
    /// Half height, half width and half length of its modules, m.
    pub sections: Vec<[f64; 3]>,
    /// What its URDF was taken as.
    pub remarks: Vec<String>,
    /// The highest frequency at which the motors give what the gait needs, rad/s.
    pub fastest_rad_s: Option<f64>,
    /// What the coefficients' uncertainty makes of it.
    pub uncertain: Option<Uncertain>,
    /// What was written, where it was asked for.
    pub written: Option<Written>,
}

/// Files of a swim.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// Moment by moment.
    pub trajectory: PathBuf,
    /// What a person reads.
    pub report: PathBuf,
    /// The robot as it swims, with the forces on its links.
    pub animation: PathBuf,
    /// The same for a program.
    pub record: PathBuf,
}

/// A file of the joints' motion that does not fit the robot.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}: {problem}", .path.display())]
pub struct SwimInput {
    /// The file.
    pub path: PathBuf,
    /// What is wrong, and what to do.
    pub problem: String,
}

/// Moments of a period in a trajectory.
const MOMENTS: usize = 100;

/// Swims.
///
/// # Errors
///
/// A robot file or record that cannot be used, joints beyond their limits, a gait without a motion that repeats, a folder that cannot be written.
pub fn swim(job: &Job) -> Result<Swum, Error> {
    in_plane(planar(&job.robot)?, job)
}

/// What came of it in the plane or in three dimensions.
#[derive(Debug, Clone, PartialEq)]
pub enum Answer {
    /// In the plane.
    Plane(Box<Swum>),
    /// In three dimensions.
    Space(Box<SpatialSwum>),
}

/// Swims in the plane or in three dimensions, as the robot file has it.
///
/// # Errors
///
/// As [`swim`]; a wave of joints that pitch where there are none.
pub fn swim_anywhere(job: &Job, pitching: &Pitching) -> Result<Answer, Error> {
    let file = read_robot(&job.robot)?;
    if file.spatial.is_3d {
        return Ok(Answer::Space(Box::new(space::swim(&file, job, pitching)?)));
    }
    if *pitching != Pitching::default() {
        let problem = "is of the plane, and the pitch options are of joints that pitch: write space = \"3d\" in [model], or leave them out".to_owned();
        return Err(SwimInput { path: job.robot.clone(), problem }.into());
    }
    Ok(Answer::Plane(Box::new(in_plane(file, job)?)))
}

/// Refuses results in the folder of a file that the robot is made of, or that it moves by.
fn spares_inputs(file: &RobotFile, job: &Job) -> Result<(), Error> {
    let Some(out) = &job.out else { return Ok(()) };
    let added = file.modules.iter().map(|module| module.spatial.added.as_ref().unwrap_or(&file.added_mass));
    let records = added.filter_map(|added| match added {
        AddedFile::Record(from) => Some(from.path.as_path()),
        AddedFile::Declared(_) => None,
    });
    let moves = match &job.moves {
        Moves::File { path, .. } | Moves::Track(path) => Some(path.as_path()),
        Moves::Wave(_) => None,
    };
    let others = [job.robot.as_path(), file.drag.path.as_path()].into_iter().chain(moves).chain(job.motor.as_deref());
    results::spares(out, records.chain(others))
}

fn in_plane(file: RobotFile, job: &Job) -> Result<Swum, Error> {
    spares_inputs(&file, job)?;
    let robot = Robot::of(&file)?;
    let joints = robot.chain.joints();
    let drives = drives(&file, job.motor.as_deref())?;
    let way = Way { file: &file, robot: &robot, drives: &drives, job };
    let periodic = |gait: &Periodically| Ok::<_, Error>((Asked::of(&job.moves, Some(gait)), way.gait(gait)?));
    let (asked, (came, moments, fastest_rad_s)) = match &job.moves {
        Moves::Wave(gait) => periodic(&Periodically { wave: Wave::Gait(gait.clone()), ramp_s: None, pitch: None })?,
        Moves::File { path, typed } => periodic(&moves::flat_gait_of(path, typed, joints)?)?,
        Moves::Track(path) => (Asked::of(&job.moves, None), way.track(path)?),
    };
    let section = |m: &ModuleFile| [m.link.major_semi_axis_m, m.link.minor_semi_axis_m, m.link.half_length_m];
    let sections = file.modules.iter().map(section).collect();
    let mut swum = Swum {
        name: file.name,
        asked,
        came,
        robot,
        drives,
        sections,
        remarks: file.remarks,
        fastest_rad_s,
        uncertain: job.uncertain.clone(),
        written: None,
    };
    if let (Some(out), Some(moments)) = (&job.out, moments) {
        swum.written = Some(Written {
            trajectory: out.join("trajectory.parquet"),
            report: out.join("report.html"),
            animation: out.join("animation.html"),
            record: out.join("result.json"),
        });
        results::replace(out, |folder| write(&swum, &moments, (job, file.current_m_s), folder))?;
    }
    Ok(swum)
}

/// The robot file of a swimmer in a plane.
fn planar(path: &Path) -> Result<RobotFile, Error> {
    let file = read_robot(path)?;
    if file.spatial.is_3d {
        let problem =
            "is of three dimensions, and this is of the plane: write space = \"planar\" in [model]".to_owned();
        return Err(SwimInput { path: path.to_owned(), problem }.into());
    }
    Ok(file)
}

/// What its joints allow and what drives them, with the motor of a file.
fn drives(file: &RobotFile, motor: Option<&Path>) -> Result<Drives, Error> {
    let drives = Drives::of(&file.joint, &file.joints);
    Ok(match motor {
        Some(motor) => moves::with_motor(drives, motor)?,
        None => drives,
    })
}

/// A robot on its way.
struct Way<'a> {
    file: &'a RobotFile,
    robot: &'a Robot,
    drives: &'a Drives,
    job: &'a Job,
}

type Found = (Came, Option<Vec<Moment>>, Option<f64>);

impl Way<'_> {
    fn gait(&self, of: &Periodically) -> Result<Found, Error> {
        let course = of.course();
        let swim = self.robot.swim(course, self.drives, self.job.step_s)?;
        let moments = match &self.job.out {
            None => None,
            Some(_) => {
                let period_s = course.period_s();
                let cut = Cut {
                    moments: self.job.periods.saturating_mul(MOMENTS),
                    apart_s: period_s / MOMENTS as f64,
                    steps: swim.steps.div_ceil(MOMENTS),
                };
                let current = self.file.current_m_s;
                let periodic = &swim.periodic;
                Some(if self.file.start.is_none() && of.ramp_s.is_none() {
                    let begin = (&Begin::with(periodic), &periodic.joints[..]);
                    self.robot.trajectory(course, self.drives, begin, cut, current)?
                } else {
                    self.robot.trajectory(&FromRest(of), self.drives, (&self.begin(), &[]), cut, current)?
                })
            }
        };
        let fastest = match &of.wave {
            Wave::Gait(gait) => self.robot.fastest(gait, self.drives),
            Wave::Table(_) => None,
        };
        Ok((Came::Gait(swim), moments, fastest))
    }

    fn track(&self, path: &Path) -> Result<Found, Error> {
        let track = moves::recorded(path, self.robot.chain.joints(), false)?;
        let begin = self.begin();
        let tracked = self.robot.follow(&track, self.drives, &begin, self.job.step_s)?;
        let moments = match &self.job.out {
            None => None,
            Some(_) => {
                let moments = track.rows().max(MOMENTS);
                let apart_s = tracked.length_s / moments as f64;
                let cut = Cut { moments, apart_s, steps: tracked.steps.div_ceil(moments) };
                Some(self.robot.trajectory(&track, self.drives, (&begin, &[]), cut, self.file.current_m_s)?)
            }
        };
        Ok((Came::Track(tracked), moments, None))
    }

    /// As the robot file has it, or at rest at the origin along x.
    fn begin(&self) -> Begin {
        let start = self.file.start.unwrap_or_default();
        Begin { place_m: start.place_m, heading: start.heading_rad, head: start.motion }
    }
}

fn write(swum: &Swum, moments: &[Moment], (job, current_m_s): (&Job, [f64; 2]), folder: &Path) -> Result<(), Error> {
    let path = folder.join("trajectory.parquet");
    write_parquet(&columns::table(moments, !swum.drives.following.is_empty(), &path), &path)?;
    write_atomically(&folder.join("report.html"), swum.page(moments, job.date.clone())?.as_bytes())?;
    write_atomically(&folder.join("animation.html"), swum.animation(moments, current_m_s).as_bytes())?;
    Ok(write_atomically(&folder.join("result.json"), format!("{:#}\n", swum.as_json()).as_bytes())?)
}
