//! A swim in three dimensions: its answer for people and programs, and its trajectory.

use std::f64::consts::FRAC_PI_2;
use std::path::Path;

use froude_records::block::{Block, Section};
use froude_records::estimate::DataFile;
use froude_records::number::{percent, significant};
use froude_records::outcome::Outcome;
use froude_records::table::{Column, ColumnData, Table};
use froude_records::units::{Dimension, Unit, parse_unit};

use super::answer::{Figures, Repeats, Space};
use super::leaves::Repeating;
use super::moves::{self, Asked, Moves, Wave};
use super::{Job, MOMENTS, Pitching, VerbError, space_figures as figures};
use crate::course::Ramped;
use crate::gait::Course;
use crate::robot_file::RobotFile;
use crate::spatial::attitude::of_angles;
use crate::spatial::gait::SpatialGait;
use crate::spatial::path::State;
use crate::spatial::period::ONE;
use crate::spatial::robot::{RIGHTS_ITSELF_M, SpatialRobot};
use crate::spatial::swim::{SpatialMoment, SpatialSwim};
use crate::spatial::vector::Axis;
use crate::trajectory::Cut;

/// A trim is none below this, m.
const TRIMMED_M: f64 = 1e-4;

/// What came of a swim in three dimensions.
struct SpatialSwum {
    name: String,
    swim: SpatialSwim,
    robot: SpatialRobot,
    /// Its period, s.
    period_s: f64,
}

pub(super) fn swim(file: &RobotFile, job: &Job) -> Result<Outcome, VerbError> {
    let (data, pitching) = (job.reads(file)?.data()?, &job.pitching);
    let robot = SpatialRobot::of(file)?;
    let joints = robot.chain.joints.len();
    let wrong = VerbError::input;
    let drives = super::drives(file, job.motor.as_deref())?;
    if !drives.following.is_empty() {
        let problem =
            "has servos (kp and kd), and joints of three dimensions follow their gait exactly: leave them out";
        return Err(wrong(&job.robot, problem));
    }
    let gait = match &job.moves {
        Moves::Wave(gait) => moves::Periodically { wave: Wave::Gait(gait.clone()), ramp_s: None, pitch: None },
        Moves::File { path, typed } => moves::gait_of(path, typed, joints)?,
        Moves::Track(path) => {
            let problem = "is a recording, which a robot swims in the plane: give a gait, or write space = \"planar\" in the robot file";
            return Err(wrong(path, problem));
        }
    };
    let asked = Asked::of(&job.moves, Some(&gait));
    let course: Box<dyn Course> = match gait.wave {
        Wave::Gait(yaw) => {
            let axes = robot.chain.joints.clone();
            let own = gait.pitch.unwrap_or_default();
            if !axes.contains(&Axis::Pitch) && (*pitching != Pitching::default() || gait.pitch.is_some()) {
                let problem = "has no joint that pitches, and the gait has a wave of such: write axis = \"pitch\" in a [[joint]], or leave pitch out";
                return Err(wrong(&job.robot, problem));
            }
            Box::new(SpatialGait {
                yaw,
                pitch_amplitude: pitching.amplitude_rad.or(own.amplitude_rad).unwrap_or(0.0),
                pitch_ahead: pitching.ahead_rad.or(own.ahead_rad).unwrap_or(FRAC_PI_2),
                pitch_turn: pitching.turn_rad.or(own.turn_rad).unwrap_or(0.0),
                joints: axes,
            })
        }
        Wave::Table(_) if *pitching != Pitching::default() => {
            let problem = "is of three dimensions and swims by a table, which has the angles of all joints: leave the pitch options out";
            return Err(wrong(&job.robot, problem));
        }
        Wave::Table(cycle) => Box::new(cycle),
    };
    let swim = robot.swim(&*course, &drives, job.step_s)?;
    let period_s = course.period_s();
    let moments = match job.out {
        None => None,
        Some(_) => {
            let cut = Cut {
                moments: job.periods.saturating_mul(MOMENTS),
                apart_s: period_s / MOMENTS as f64,
                steps: swim.steps.div_ceil(MOMENTS),
            };
            let [x, y] = file.current_m_s;
            let current = [x, y, 0.0];
            Some(match gait.ramp_s {
                Some(ramp_s) => robot.trajectory(&Ramped { course: &*course, ramp_s }, &start(file), cut, current)?,
                None if file.start.is_some() => robot.trajectory(&*course, &start(file), cut, current)?,
                None => robot.trajectory(&*course, &swim.periodic.begin(), cut, current)?,
            })
        }
    };
    let swum = SpatialSwum { name: file.name.clone(), swim, robot, period_s };
    let f = swum.figures(&data, &asked);
    let mut blocks = vec![Block::text("remarks", swum.warnings())];
    blocks.extend(f.blocks());
    blocks.push(Block::text("remarks", swum.sentences(&f)));
    let detail =
        |title: &str, blocks| Section { title: title.to_owned(), blocks, is_detail: true, ..Section::default() };
    let moments = moments.as_deref();
    if let Some(m) = moments {
        blocks.push(detail("The way", vec![figures::path(m), figures::attitude(m), figures::motion(m)]).into());
        blocks.push(detail("Joints", vec![figures::joints(m), figures::powers(m)]).into());
    }
    let files = moments.zip(job.out.as_ref()).map(|(m, out)| (table(m, &out.join("trajectory.parquet")), None));
    Ok(job.outcome(&swum.name, f.subtitle(), blocks, files))
}

/// As the robot file has it, level at the depth of nought.
fn start(file: &RobotFile) -> State {
    let start = file.start.unwrap_or_default();
    let ([x, y], [r, u, v]) = (start.place_m, start.motion);
    State {
        place_m: [x, y, 0.0],
        attitude: of_angles([0.0, 0.0, start.heading_rad]),
        head: [0.0, 0.0, r, u, v, 0.0],
        ..State::default()
    }
}

/// Columns with their units, a row per moment.
fn table(moments: &[SpatialMoment], path: &Path) -> Table {
    let mut columns = Vec::new();
    // The units are written below.
    let mut put = |name: &str, unit: &str, of: &dyn Fn(&SpatialMoment) -> f64| {
        let unit = parse_unit(unit).unwrap_or_else(|_| Unit::si(Dimension::ONE));
        let dimension = unit.dimension;
        let si = moments.iter().map(of).collect();
        columns.push(Column { name: name.to_owned(), data: ColumnData::Number { unit, dimension, si } });
    };
    put("time", "s", &|m| m.time_s);
    for (k, name) in ["x", "y", "z"].into_iter().enumerate() {
        put(name, "m", &|m| m.centre_m[k]);
    }
    for (k, name) in ["roll", "pitch", "heading"].into_iter().enumerate() {
        put(name, "rad", &|m| m.angles[k]);
    }
    for (k, name) in ["q_w", "q_x", "q_y", "q_z"].into_iter().enumerate() {
        put(name, "1", &|m| m.state.attitude[k]);
    }
    for (k, name) in ["v_x", "v_y", "v_z"].into_iter().enumerate() {
        put(name, "m/s", &|m| m.state.head[3 + k]);
    }
    for (k, name) in ["w_x", "w_y", "w_z"].into_iter().enumerate() {
        put(name, "rad/s", &|m| m.state.head[k]);
    }
    for i in 0..moments.first().map_or(0, |m| m.torque_n_m.len()) {
        put(&format!("phi_{}", i + 1), "rad", &|m| m.shape.angle[i]);
        put(&format!("phi_dot_{}", i + 1), "rad/s", &|m| m.shape.rate[i]);
        put(&format!("tau_{}", i + 1), "N m", &|m| m.torque_n_m[i]);
    }
    for (k, name) in ["power_net", "power_pos", "power_loss"].into_iter().enumerate() {
        put(name, "W", &|m| m.power_w[k]);
    }
    let all = |m: &SpatialMoment| m.energy_j[0] + m.energy_j[1];
    let (first, lowest) = moments.first().map_or((0.0, 0.0), |m| (all(m), m.energy_j[1]));
    put("energy_kinetic", "J", &|m| m.energy_j[0]);
    put("energy_potential", "J", &|m| m.energy_j[1] - lowest);
    put("energy_residual", "J", &|m| m.state.work_j - m.state.loss_j - (all(m) - first));
    Table::of(path.to_owned(), columns, (1..=moments.len()).collect())
}

impl SpatialSwum {
    fn figures<'a>(&'a self, data: &'a [DataFile], asked: &'a Asked) -> Figures<'a> {
        let (s, p) = (&self.swim, &self.swim.periodic);
        let unstable = s.unstable.as_deref().map(Repeating::from);
        Figures {
            name: &self.name,
            robot: &self.robot.plane,
            data,
            asked,
            speed_m_s: p.speed_m_s,
            power_w: [p.net_w, p.positive_w, p.absolute_w, p.loss_w],
            friction_w: None,
            electric_w: s.electric_w,
            needs: s.needs,
            motor_share: None,
            fastest_rad_s: None,
            steps: s.steps,
            stiffness: None,
            extrapolated: s.extrapolated,
            along: s.along,
            median_angle_rad: s.median_angle_rad,
            gain_w: None,
            turn: p.turn,
            repeats: Some(Repeats {
                cost: s.cost,
                multipliers: p.multipliers.to_vec(),
                residual: p.residual,
                unstable,
            }),
            track: None,
            space: Some(Space {
                roll: p.roll,
                pitch: p.pitch,
                way_m: p.way_m,
                period_s: self.period_s,
                lifting_w: p.lifting_w,
                righting_m: self.robot.righting_m,
                trim_m: self.robot.trim_m,
            }),
        }
    }

    /// What is to be read before the figures: a motion that the swimmer leaves, a body that does not stay upright.
    fn warnings(&self) -> Vec<String> {
        let mut out = Vec::new();
        self.stability(&mut out);
        out
    }

    fn sentences(&self, f: &Figures<'_>) -> Vec<String> {
        let mut out = Vec::new();
        self.trim(&mut out);
        self.water(&mut out);
        f.losses(&mut out);
        self.drag(&mut out);
        out
    }

    fn stability(&self, out: &mut Vec<String>) {
        let p = &self.swim.periodic;
        match &self.swim.unstable {
            Some(unstable) => out.push(Repeating::from(&**unstable).leaves(&p.into(), self.period_s)),
            None if p.multipliers[0] > 1.0 + ONE => {
                out.push(Repeating::from(p).stays(self.robot.righting_m.abs() > RIGHTS_ITSELF_M));
            }
            None => {}
        }
        let righting_mm = 1e3 * self.robot.righting_m;
        if self.robot.righting_m < -RIGHTS_ITSELF_M {
            let is_turned = 0.5 * (p.roll[0] + p.roll[1]).abs() > FRAC_PI_2;
            let so = if is_turned {
                "it has turned over, and swims bottom up"
            } else {
                "it swims as it lies, and wants to turn over"
            };
            out.push(format!(
                "unstable equilibrium, top-heavy: the centre of mass lies {} mm above the centre of buoyancy; {so}",
                significant(-righting_mm, 3)
            ));
        } else if self.robot.righting_m <= RIGHTS_ITSELF_M {
            out.push("no stable equilibrium, nothing rights it: the centre of mass lies at the height of the centre of buoyancy, and any disturbance of roll and pitch stays; raise center_of_buoyancy or lower center_of_mass where the robot is weighted".to_owned());
        }
    }

    fn trim(&self, out: &mut Vec<String>) {
        if self.robot.righting_m > RIGHTS_ITSELF_M {
            out.push(format!(
                "rights itself: its mass lies {} mm below its buoyancy",
                significant(1e3 * self.robot.righting_m, 3)
            ));
        }
        if self.robot.trim_m.abs() > TRIMMED_M {
            let way = if self.robot.trim_m > 0.0 { "ahead of" } else { "behind" };
            out.push(format!(
                "out of trim: straight and level, its mass lies {} mm {way} its buoyancy",
                significant(1e3 * self.robot.trim_m.abs(), 3)
            ));
        }
    }

    fn water(&self, out: &mut Vec<String>) {
        let p = &self.swim.periodic;
        let heavy = self.robot.heavy_kg;
        if heavy == 0.0 {
            let stated = self.robot.plane.heavy_kg.unwrap_or(0.0);
            // The sum of the modules is rounded.
            if stated.abs() > 1e-12 * self.robot.plane.mass_kg {
                out.push(format!(
                    "neutral within the digits given: mass and displaced water differ by {} kg, and weight and buoyancy are taken as equal",
                    significant(stated.abs(), 2)
                ));
            }
        } else {
            let (way, goes) = if heavy > 0.0 { ("heavier", "sinks") } else { ("lighter", "rises") };
            out.push(format!(
                "not neutral: the robot is {} kg {way} than the water that its modules displace ({} of its mass), and {goes} at {} m/s on its way",
                significant(heavy.abs(), 2),
                percent(heavy.abs() / self.robot.plane.mass_kg),
                significant((p.way_m[2] / self.period_s).abs(), 2)
            ));
        }
        if let Some(ratios) = &self.robot.heave_by_area
            && let Some(first) = ratios.first()
        {
            out.push(format!(
                "drag up and down is no part of the record: it is {} of that across, by the area seen from above; where it was measured, write heave_drag",
                significant(*first, 3)
            ));
        }
        if self.robot.chain.links.iter().all(|link| link.drag.roll == [0.0; 2]) {
            out.push("no roll_drag: what turns a straight body about its own axis is not resisted".to_owned());
        }
    }

    fn drag(&self, out: &mut Vec<String>) {
        let s = &self.swim;
        if let Some((joint, torque, limit)) = s.needs.beyond {
            out.push(format!(
                "beyond the drives: joint {joint} needs {} N m, and it gives {} N m",
                significant(torque, 3),
                significant(limit, 3)
            ));
        }
        if s.needs.share > 1.0 {
            out.push(format!(
                "beyond the motors: a joint needs {} times what its motor gives at its speed",
                significant(s.needs.share, 3)
            ));
        }
    }
}
