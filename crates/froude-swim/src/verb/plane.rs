//! A swim in the plane.

use std::path::Path;

use froude_records::outcome::Outcome;

use super::answer::{Figures, Repeats};
use super::moves::{self, Asked, Moves, Periodically, Wave};
use super::uncertain::uncertain;
use super::{Job, MOMENTS, VerbError, animation, columns, drives, figures};
use crate::course::Ramped;
use crate::gait::Course;
use crate::joints::Drives;
use crate::means::{Effort, Means};
use crate::robot::Robot;
use crate::robot_file::RobotFile;
use crate::trajectory::{Begin, Cut, Moment};

pub(super) fn swim(file: &RobotFile, job: &Job, tell: &(dyn Fn(usize, usize) + Sync)) -> Result<Outcome, VerbError> {
    let data = job.reads(file)?.data()?;
    let drawn = uncertain(file, job, tell)?;
    let robot = Robot::of(file)?;
    let drives = drives(file, job.motor.as_deref())?;
    let way = Way { file, robot: &robot, drives: &drives, job };
    let (asked, found) = match &job.moves {
        Moves::Track(path) => (Asked::of(&job.moves, None), way.track(path)?),
        moves => {
            let gait = moves.periodically(robot.chain.joints(), false, "is a recording")?;
            (Asked::of(moves, Some(&gait)), way.gait(&gait)?)
        }
    };
    let f = Figures {
        name: &file.name,
        robot: &robot,
        data: &data,
        asked: &asked,
        means: found.means,
        motor_share: (!drives.motor.curve.is_empty()).then_some(found.effort.needs.share),
        effort: found.effort,
        fastest_rad_s: found.fastest_rad_s,
        repeats: found.repeats,
        track: found.track,
        space: None,
    };
    let sentences = [found.warning.into_iter().collect(), f.sentences(file, &drives)];
    let (mut details, mut trajectory, mut animated) = (Vec::new(), None, None);
    if let (Some(moments), Some(out)) = (&found.moments, &job.out) {
        details = vec![
            ("The way", vec![figures::path(moments), figures::motion(moments)]),
            ("Joints", vec![figures::joints(moments), figures::powers(moments)]),
            ("Where the power goes", figures::losses(&robot, moments)),
        ];
        let path = out.join("trajectory.parquet");
        trajectory = Some(columns::table(moments, !drives.following.is_empty(), &path));
        animated = Some(animation::html(file, &robot, moments));
    }
    Ok(job.outcome(&f, sentences, drawn, details, (trajectory, animated)))
}

/// What the joints' motion comes to.
struct Found {
    means: Means,
    effort: Effort,
    fastest_rad_s: Option<f64>,
    repeats: Option<Repeats>,
    track: Option<[f64; 2]>,
    warning: Option<String>,
    moments: Option<Vec<Moment>>,
}

/// A robot on its way.
struct Way<'a> {
    file: &'a RobotFile,
    robot: &'a Robot,
    drives: &'a Drives,
    job: &'a Job,
}

impl Way<'_> {
    /// The motion that repeats.
    fn gait(&self, of: &Periodically) -> Result<Found, VerbError> {
        let course = of.course();
        let swim = self.robot.swim(course, self.drives, self.job.step_s)?;
        let period_s = course.period_s();
        let moments = match &self.job.out {
            None => None,
            Some(_) => {
                let (cut, current) = (self.job.cut(period_s, swim.effort.steps), self.file.current_m_s);
                let periodic = &swim.periodic;
                Some(if self.file.start.is_none() && of.ramp_s.is_none() {
                    let begin = (&Begin::with(periodic), &periodic.joints[..]);
                    self.robot.trajectory(course, self.drives, begin, cut, current)?
                } else {
                    let ramped = of.ramp_s.map(|ramp_s| Ramped { course, ramp_s });
                    let course = ramped.as_ref().map_or(course, |ramped| ramped as &dyn Course);
                    self.robot.trajectory(course, self.drives, (&self.begin(), &[]), cut, current)?
                })
            }
        };
        let fastest_rad_s = match &of.wave {
            Wave::Gait(gait) => self.robot.fastest(gait, self.drives),
            Wave::Table(_) => None,
        };
        let repeats = Repeats::of(&swim);
        Ok(Found {
            means: swim.periodic.means,
            effort: swim.effort,
            fastest_rad_s,
            warning: repeats.warning(1.0, true, period_s),
            repeats: Some(repeats),
            track: None,
            moments,
        })
    }

    /// A recording, from where the robot file begins.
    fn track(&self, path: &Path) -> Result<Found, VerbError> {
        let track = moves::recorded(path, self.robot.chain.joints(), false)?;
        let begin = self.begin();
        let tracked = self.robot.follow(&track, self.drives, &begin, self.job.step_s)?;
        let moments = match &self.job.out {
            None => None,
            Some(_) => {
                let moments = track.rows().max(MOMENTS);
                let apart_s = tracked.length_s / moments as f64;
                let cut = Cut { moments, apart_s, steps: tracked.effort.steps.div_ceil(moments) };
                Some(self.robot.trajectory(&track, self.drives, (&begin, &[]), cut, self.file.current_m_s)?)
            }
        };
        Ok(Found {
            means: tracked.means,
            effort: tracked.effort,
            fastest_rad_s: None,
            repeats: None,
            track: Some([tracked.length_s, tracked.gained_j]),
            warning: None,
            moments,
        })
    }

    fn begin(&self) -> Begin {
        let start = self.file.start.unwrap_or_default();
        Begin { place_m: start.place_m, heading: start.heading_rad, head: start.motion }
    }
}
