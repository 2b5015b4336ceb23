//! A swim in three dimensions: its answer for people and programs, and its trajectory.

use std::f64::consts::FRAC_PI_2;
use std::path::Path;

use froude_records::number::{percent, significant};
use froude_records::outcome::Outcome;
use froude_records::table::Table;

use super::answer::{Figures, Repeats, Space};
use super::columns::column;
use super::moves::{Asked, Wave};
use super::{Job, Pitching, VerbError, space_figures as figures};
use crate::course::Ramped;
use crate::gait::Course;
use crate::robot_file::RobotFile;
use crate::spatial::attitude::of_angles;
use crate::spatial::gait::SpatialGait;
use crate::spatial::path::State;
use crate::spatial::period::{ONE, Periodic};
use crate::spatial::robot::{RIGHTS_ITSELF_M, SpatialRobot};
use crate::spatial::swim::SpatialMoment;
use crate::spatial::vector::Axis;

/// A trim is none below this, m.
const TRIMMED_M: f64 = 1e-4;

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
    let no_recording =
        "is a recording, which a robot swims in the plane: give a gait, or write space = \"planar\" in the robot file";
    let gait = job.moves.periodically(joints, true, no_recording)?;
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
    let moments = match &job.out {
        None => None,
        Some(_) => {
            let cut = job.cut(period_s, swim.effort.steps);
            let [x, y] = file.current_m_s;
            let current = [x, y, 0.0];
            Some(match gait.ramp_s {
                Some(ramp_s) => robot.trajectory(&Ramped { course: &*course, ramp_s }, &start(file), cut, current)?,
                None if file.start.is_some() => robot.trajectory(&*course, &start(file), cut, current)?,
                None => robot.trajectory(&*course, &swim.periodic.begin(), cut, current)?,
            })
        }
    };
    let repeats = Repeats::of(&swim);
    let mut warnings: Vec<String> =
        repeats.warning(1.0 + ONE, robot.righting_m.abs() > RIGHTS_ITSELF_M, period_s).into_iter().collect();
    warnings.extend(equilibrium(&robot, &swim.periodic));
    let f = Figures {
        name: &file.name,
        robot: &robot.plane,
        data: &data,
        asked: &asked,
        means: swim.periodic.means,
        effort: swim.effort,
        motor_share: None,
        fastest_rad_s: None,
        repeats: Some(repeats),
        track: None,
        space: Some(Space { robot: &robot, periodic: &swim.periodic, period_s }),
    };
    let mut sentences = Vec::new();
    trim(&robot, &mut sentences);
    water(&robot, swim.periodic.way_m[2] / period_s, &mut sentences);
    f.losses(&mut sentences);
    f.beyond(&mut sentences);
    let (mut details, mut trajectory) = (Vec::new(), None);
    if let (Some(m), Some(out)) = (&moments, &job.out) {
        details = vec![
            ("The way", vec![figures::path(m), figures::attitude(m), figures::motion(m)]),
            ("Joints", vec![figures::joints(m), figures::powers(m)]),
        ];
        trajectory = Some(table(m, &out.join("trajectory.parquet")));
    }
    Ok(job.outcome(&f, [warnings, sentences], Vec::new(), details, (trajectory, None)))
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
    let mut put = |name: &str, unit: &str, of: &dyn Fn(&SpatialMoment) -> f64| {
        columns.push(column(name, unit, moments.iter().map(of).collect()));
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

fn equilibrium(robot: &SpatialRobot, p: &Periodic) -> Option<String> {
    let righting_mm = 1e3 * robot.righting_m;
    if robot.righting_m < -RIGHTS_ITSELF_M {
        let is_turned = 0.5 * (p.roll[0] + p.roll[1]).abs() > FRAC_PI_2;
        let so = if is_turned {
            "it has turned over, and swims bottom up"
        } else {
            "it swims as it lies, and wants to turn over"
        };
        return Some(format!(
            "unstable equilibrium, top-heavy: the centre of mass lies {} mm above the centre of buoyancy; {so}",
            significant(-righting_mm, 3)
        ));
    }
    (robot.righting_m <= RIGHTS_ITSELF_M).then(|| "no stable equilibrium, nothing rights it: the centre of mass lies at the height of the centre of buoyancy, and any disturbance of roll and pitch stays; raise center_of_buoyancy or lower center_of_mass where the robot is weighted".to_owned())
}

fn trim(robot: &SpatialRobot, out: &mut Vec<String>) {
    if robot.righting_m > RIGHTS_ITSELF_M {
        out.push(format!(
            "rights itself: its mass lies {} mm below its buoyancy",
            significant(1e3 * robot.righting_m, 3)
        ));
    }
    if robot.trim_m.abs() > TRIMMED_M {
        let way = if robot.trim_m > 0.0 { "ahead of" } else { "behind" };
        out.push(format!(
            "out of trim: straight and level, its mass lies {} mm {way} its buoyancy",
            significant(1e3 * robot.trim_m.abs(), 3)
        ));
    }
}

fn water(robot: &SpatialRobot, sinking_m_s: f64, out: &mut Vec<String>) {
    let heavy = robot.heavy_kg;
    if heavy == 0.0 {
        let stated = robot.plane.heavy_kg.unwrap_or(0.0);
        // The sum of the modules is rounded.
        if stated.abs() > 1e-12 * robot.plane.mass_kg {
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
            percent(heavy.abs() / robot.plane.mass_kg),
            significant(sinking_m_s.abs(), 2)
        ));
    }
    if let Some(ratios) = &robot.heave_by_area
        && let Some(first) = ratios.first()
    {
        out.push(format!(
            "drag up and down is no part of the record: it is {} of that across, by the area seen from above; where it was measured, write heave_drag",
            significant(*first, 3)
        ));
    }
    if robot.chain.links.iter().all(|link| link.drag.roll == [0.0; 2]) {
        out.push("no roll_drag: what turns a straight body about its own axis is not resisted".to_owned());
    }
}
