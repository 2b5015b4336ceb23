//! A swim in the plane.

use std::path::Path;

use froude_records::block::{Block, Section};
use froude_records::outcome::Outcome;

use super::answer::{Figures, Repeats};
use super::leaves::Repeating;
use super::moves::{self, Asked, FromRest, Moves, Periodically, Wave};
use super::uncertain::uncertain;
use super::{Job, MOMENTS, VerbError, animation, columns, drives, figures};
use crate::joints::Drives;
use crate::robot::Robot;
use crate::robot_file::{ModuleFile, RobotFile};
use crate::swim::Swim;
use crate::track::Tracked;
use crate::trajectory::{Begin, Cut, Moment};

/// What the joints' motion comes to.
#[derive(Debug)]
pub(super) enum Came {
    /// Of a gait: the motion that repeats.
    Gait(Box<Swim>),
    /// Of a recording: means over its time.
    Track(Box<Tracked>),
}

/// What came of it.
#[derive(Debug)]
pub(super) struct Swum {
    pub name: String,
    pub asked: Asked,
    pub came: Came,
    pub robot: Robot,
    pub drives: Drives,
    /// Half height, half width and half length of its modules, m.
    pub sections: Vec<[f64; 3]>,
    /// The gait's period, or the length of a recording, s.
    pub period_s: f64,
    /// What its URDF was taken as.
    pub remarks: Vec<String>,
    /// The highest frequency at which the motors give what the gait needs, rad/s.
    pub fastest_rad_s: Option<f64>,
}

pub(super) fn swim(file: RobotFile, job: &Job, tell: &(dyn Fn(usize, usize) + Sync)) -> Result<Outcome, VerbError> {
    let data = job.reads(&file)?.data()?;
    let drawn = uncertain(&file, job, tell)?;
    let robot = Robot::of(&file)?;
    let joints = robot.chain.joints();
    let drives = drives(&file, job.motor.as_deref())?;
    let way = Way { file: &file, robot: &robot, drives: &drives, job };
    let periodic = |gait: &Periodically| Ok::<_, VerbError>((Asked::of(&job.moves, Some(gait)), way.gait(gait)?));
    let (asked, (came, moments, fastest_rad_s, period_s)) = match &job.moves {
        Moves::Wave(gait) => periodic(&Periodically { wave: Wave::Gait(gait.clone()), ramp_s: None, pitch: None })?,
        Moves::File { path, typed } => periodic(&moves::flat_gait_of(path, typed, joints)?)?,
        Moves::Track(path) => (Asked::of(&job.moves, None), way.track(path)?),
    };
    let section = |m: &ModuleFile| [m.link.major_semi_axis_m, m.link.minor_semi_axis_m, m.link.half_length_m];
    let sections = file.modules.iter().map(section).collect();
    let (name, remarks) = (file.name, file.remarks);
    let swum = Swum { name, asked, came, robot, drives, sections, period_s, remarks, fastest_rad_s };
    let f = Figures { data: &data, ..swum.figures() };
    let mut blocks = vec![Block::text("remarks", swum.warnings())];
    blocks.extend(f.blocks());
    blocks.push(Block::text("remarks", swum.sentences(&f)));
    blocks.extend(drawn);
    let detail =
        |title: &str, blocks| Section { title: title.to_owned(), blocks, is_detail: true, ..Section::default() };
    let moments = moments.as_deref();
    if let Some(moments) = moments {
        blocks.push(detail("The way", vec![figures::path(moments), figures::motion(moments)]).into());
        blocks.push(detail("Joints", vec![figures::joints(moments), figures::powers(moments)]).into());
        blocks.push(detail("Where the power goes", figures::losses(&swum.robot, moments)).into());
    }
    let files = moments.zip(job.out.as_ref()).map(|(moments, out)| {
        let trajectory = out.join("trajectory.parquet");
        let table = columns::table(moments, !swum.drives.following.is_empty(), &trajectory);
        (table, Some(animation::html(&swum, moments, file.current_m_s)))
    });
    Ok(job.outcome(&swum.name, f.subtitle(), blocks, files))
}

impl Swum {
    fn figures(&self) -> Figures<'_> {
        let motor_share = |share| (!self.drives.motor.curve.is_empty()).then_some(share);
        let friction_w = |watts: f64| (watts > 0.0).then_some(watts);
        let of = |speed_m_s, power_w, turn, repeats, track| Figures {
            name: &self.name,
            robot: &self.robot,
            data: &[],
            asked: &self.asked,
            speed_m_s,
            power_w,
            friction_w: None,
            electric_w: None,
            needs: crate::seen::Needs::default(),
            motor_share: None,
            fastest_rad_s: self.fastest_rad_s,
            steps: 0,
            stiffness: None,
            extrapolated: [None; 2],
            along: 0.0,
            median_angle_rad: 0.0,
            gain_w: None,
            turn,
            repeats,
            track,
            space: None,
        };
        match &self.came {
            Came::Gait(s) => {
                let p = &s.periodic;
                let unstable = s.unstable.as_deref().map(Repeating::from);
                let repeats =
                    Repeats { cost: s.cost, multipliers: p.multipliers.to_vec(), residual: p.residual, unstable };
                Figures {
                    friction_w: friction_w(p.friction_w),
                    electric_w: s.electric_w,
                    needs: s.needs,
                    motor_share: motor_share(s.needs.share),
                    steps: s.steps,
                    stiffness: s.stiffness,
                    extrapolated: s.extrapolated,
                    along: s.along,
                    median_angle_rad: s.median_angle_rad,
                    gain_w: s.gain_w,
                    ..of(p.speed_m_s, [p.net_w, p.positive_w, p.absolute_w, p.loss_w], p.turn, Some(repeats), None)
                }
            }
            Came::Track(t) => Figures {
                friction_w: friction_w(t.friction_w),
                electric_w: t.electric_w,
                needs: t.needs,
                motor_share: motor_share(t.needs.share),
                steps: t.steps,
                stiffness: t.stiffness,
                extrapolated: t.extrapolated,
                along: t.along,
                median_angle_rad: t.median_angle_rad,
                gain_w: t.gain_w,
                ..of(
                    t.speed_m_s,
                    [t.net_w, t.positive_w, t.absolute_w, t.loss_w],
                    t.turn,
                    None,
                    Some([t.length_s, t.gained_j]),
                )
            },
        }
    }

    /// What is to be read before the figures: a motion that the swimmer leaves.
    fn warnings(&self) -> Vec<String> {
        let Came::Gait(s) = &self.came else { return Vec::new() };
        let settled = Repeating::from(&s.periodic);
        let told = match &s.unstable {
            Some(unstable) => Some(Repeating::from(&**unstable).leaves(&settled, self.period_s)),
            None if s.periodic.multipliers[0] > 1.0 => Some(settled.stays(true)),
            None => None,
        };
        told.into_iter().collect()
    }
}

/// A robot on its way.
struct Way<'a> {
    file: &'a RobotFile,
    robot: &'a Robot,
    drives: &'a Drives,
    job: &'a Job,
}

type Found = (Came, Option<Vec<Moment>>, Option<f64>, f64);

impl Way<'_> {
    fn gait(&self, of: &Periodically) -> Result<Found, VerbError> {
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
        Ok((Came::Gait(Box::new(swim)), moments, fastest, course.period_s()))
    }

    fn track(&self, path: &Path) -> Result<Found, VerbError> {
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
        let length_s = tracked.length_s;
        Ok((Came::Track(Box::new(tracked)), moments, None, length_s))
    }

    /// As the robot file has it, or at rest at the origin along x.
    fn begin(&self) -> Begin {
        let start = self.file.start.unwrap_or_default();
        Begin { place_m: start.place_m, heading: start.heading_rad, head: start.motion }
    }
}
