//! A swim: what its joints do, what that comes to, and its way moment by moment.

use std::path::Path;

use froude_records::outcome::Outcome;

use super::answer::{Figures, Repeats, Space};
use super::moves::{self, Asked, Moves, Periodically, Wave};
use super::uncertain::uncertain;
use super::{Job, MOMENTS, VerbError, animation, balance, columns, drives, figures};
use crate::course::Ramped;
use crate::dynamics::{Dynamics, StateOf};
use crate::gait::Course;
use crate::joints::Drives;
use crate::means::{Effort, Means};
use crate::robot::Robot;
use crate::robot_file::RobotFile;
use crate::state::State;
use crate::trajectory::{Cut, Moment};

pub(super) fn swim<C: Dynamics>(
    file: &RobotFile,
    job: &Job,
    tell: &(dyn Fn(usize, usize) + Sync),
) -> Result<Outcome, VerbError> {
    let data = job.reads(file)?.data()?;
    let drawn = uncertain::<C>(file, job, tell)?;
    let robot = Robot::<C>::of(file)?;
    let drives = drives(file, job.motor.as_deref())?;
    let way = Way { file, robot: &robot, drives: &drives, job };
    let (asked, found) = match &job.moves {
        Moves::Track(path) => (Asked::of(&job.moves, None), way.track(path)?),
        moves => {
            let gait = moves.periodically((&job.robot, file), &job.pitching, "is a recording")?;
            (Asked::of(moves, Some(&gait)), way.gait(&gait)?)
        }
    };
    let space = robot.chain.balance().map(|balance| Space {
        balance,
        tilt: found.tilt,
        way_m: found.way_m,
        time_s: found.time_s,
    });
    let followed = found.repeats.as_ref().and_then(|r| r.warning(robot.chain.is_righted(), found.time_s));
    let warnings = followed.into_iter().chain(space.as_ref().and_then(balance::equilibrium)).collect();
    let f = Figures {
        name: &file.name,
        robot: &robot,
        data: &data,
        asked: &asked,
        means: found.means,
        motor_share: (!drives.motor.curve.is_empty()).then_some(found.effort.needs.share),
        effort: found.effort,
        fastest_rad_s: found.fastest_rad_s,
        track: found.repeats.is_none().then_some([found.time_s, found.gained_j]),
        repeats: found.repeats,
        space,
    };
    let sentences = [warnings, f.sentences(file, &drives)];
    let (mut details, mut trajectory, mut animated) = (Vec::new(), None, None);
    if let (Some(moments), Some(out)) = (&found.moments, &job.out) {
        details = vec![
            ("Path and motion", figures::way(moments)),
            ("Joints", vec![figures::joints(moments), figures::powers(moments)]),
            ("Where the power goes", figures::losses(&robot, moments)),
        ];
        let path = out.join("trajectory.parquet");
        trajectory = Some(columns::table(moments, !drives.following.is_empty(), &path));
        // It is seen from above.
        animated = (!C::TILTS).then(|| animation::html(file, &robot, moments));
    }
    Ok(job.outcome(&f, sentences, drawn, details, (trajectory, animated)))
}

/// What the joints' motion comes to.
struct Found<C: Dynamics> {
    means: Means,
    effort: Effort,
    tilt: [[f64; 2]; 2],
    /// Over a period or a recording, s, with what it gains of kinetic energy, J.
    way_m: [f64; 3],
    time_s: f64,
    gained_j: f64,
    fastest_rad_s: Option<f64>,
    /// Of a gait.
    repeats: Option<Repeats>,
    moments: Option<Vec<Moment<C>>>,
}

/// A robot on its way.
struct Way<'a, C> {
    file: &'a RobotFile,
    robot: &'a Robot<C>,
    drives: &'a Drives,
    job: &'a Job,
}

impl<C: Dynamics> Way<'_, C> {
    /// The motion that repeats.
    fn gait(&self, of: &Periodically) -> Result<Found<C>, VerbError> {
        let course = of.course();
        let swim = self.robot.swim(course, self.drives, self.job.step_s)?;
        let period_s = course.period_s();
        let periodic = &swim.periodic;
        let moments = match &self.job.out {
            None => None,
            Some(_) => {
                let (cut, current) = (self.job.cut(period_s, swim.effort.steps), self.file.current_m_s);
                Some(if self.file.start.is_none() && of.ramp_s.is_none() {
                    let begin = (&periodic.begin(), &periodic.joints[..]);
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
        Ok(Found {
            means: periodic.means,
            tilt: periodic.tilt,
            way_m: periodic.way_m,
            time_s: period_s,
            gained_j: 0.0,
            fastest_rad_s,
            repeats: Some(Repeats::of(&swim)),
            effort: swim.effort,
            moments,
        })
    }

    /// A recording, from where the robot file begins.
    fn track(&self, path: &Path) -> Result<Found<C>, VerbError> {
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
            tilt: tracked.passage.tilt,
            way_m: tracked.passage.way_m,
            time_s: tracked.length_s,
            gained_j: tracked.passage.gained_j[0],
            fastest_rad_s: None,
            repeats: None,
            moments,
        })
    }

    /// Level, and in three dimensions at the depth of nought.
    fn begin(&self) -> StateOf<C> {
        let start = self.file.start.unwrap_or_default();
        let [x, y] = start.place_m;
        State::new(C::pose([x, y, 0.0], [0.0, 0.0, start.heading_rad]), C::level(start.motion))
    }
}
