//! A swim in three dimensions: its answer for people and programs, and its trajectory.

use std::f64::consts::FRAC_PI_2;
use std::path::{Path, PathBuf};

use froude_records::estimate::DataFile;
use froude_records::number::{count, fixed, percent, significant};
use froude_records::page::{DocumentSection, TextTable};
use froude_records::parquet_table::write_parquet;
use froude_records::robot::RobotFile;
use froude_records::table::{Column, ColumnData, Table};
use froude_records::units::{Dimension, Unit, parse_unit};
use froude_records::write::write_atomically;
use froude_swim::course::Ramped;
use froude_swim::gait::Course;
use froude_swim::spatial::attitude::of_angles;
use froude_swim::spatial::gait::SpatialGait;
use froude_swim::spatial::path::State;
use froude_swim::spatial::period::ONE;
use froude_swim::spatial::robot::{RIGHTS_ITSELF_M, SpatialRobot};
use froude_swim::spatial::swim::{SpatialMoment, SpatialSwim};
use froude_swim::spatial::vector::Axis;
use froude_swim::trajectory::Cut;
use serde_json::{Value, json};

use super::leaves::Repeating;
use super::moves::{self, Moves, Wave};
use super::told;
use super::{Job, MOMENTS, Pitching, SwimInput};
use crate::{Error, results};

/// A trim is none below this, m.
const TRIMMED_M: f64 = 1e-4;

/// What came of a swim in three dimensions.
#[derive(Debug, Clone, PartialEq)]
pub struct SpatialSwum {
    /// The robot's name.
    pub name: String,
    /// What the gait comes to.
    pub swim: SpatialSwim,
    /// The robot.
    pub robot: SpatialRobot,
    /// Its period, s.
    pub period_s: f64,
    /// The files that were read.
    pub data: Vec<DataFile>,
    /// What was written, where it was asked for.
    pub written: Option<SpatialWritten>,
}

/// Files of a swim in three dimensions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct SpatialWritten {
    /// Moment by moment.
    pub trajectory: PathBuf,
    /// What a person reads.
    pub report: PathBuf,
    /// The same for a program.
    pub record: PathBuf,
}

pub(super) fn swim(file: &RobotFile, job: &Job, pitching: &Pitching) -> Result<SpatialSwum, Error> {
    let data = job.reads(file)?;
    let robot = SpatialRobot::of(file)?;
    let joints = robot.chain.joints.len();
    let wrong = |path: &Path, problem: &str| SwimInput { path: path.to_owned(), problem: problem.to_owned() };
    let drives = super::drives(file, job.motor.as_deref())?;
    if !drives.following.is_empty() {
        let problem =
            "has servos (kp and kd), and joints of three dimensions follow their gait exactly: leave them out";
        return Err(wrong(&job.robot, problem).into());
    }
    let gait = match &job.moves {
        Moves::Wave(gait) => moves::Periodically { wave: Wave::Gait(gait.clone()), ramp_s: None, pitch: None },
        Moves::File { path, typed } => moves::gait_of(path, typed, joints)?,
        Moves::Track(path) => {
            let problem = "is a recording, which a robot swims in the plane: give a gait, or write space = \"planar\" in the robot file";
            return Err(wrong(path, problem).into());
        }
    };
    let course: Box<dyn Course> = match gait.wave {
        Wave::Gait(yaw) => {
            let axes = robot.chain.joints.clone();
            let own = gait.pitch.unwrap_or_default();
            if !axes.contains(&Axis::Pitch) && (*pitching != Pitching::default() || gait.pitch.is_some()) {
                let problem = "has no joint that pitches, and the gait has a wave of such: write axis = \"pitch\" in a [[joint]], or leave pitch out";
                return Err(wrong(&job.robot, problem).into());
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
            return Err(wrong(&job.robot, problem).into());
        }
        Wave::Table(cycle) => Box::new(cycle),
    };
    let swim = robot.swim(&*course, &drives, job.step_s)?;
    let period_s = course.period_s();
    let mut swum = SpatialSwum { name: file.name.clone(), swim, robot, period_s, data, written: None };
    if let Some(out) = &job.out {
        let (swim, robot) = (&swum.swim, &swum.robot);
        let cut = Cut {
            moments: job.periods.saturating_mul(MOMENTS),
            apart_s: period_s / MOMENTS as f64,
            steps: swim.steps.div_ceil(MOMENTS),
        };
        let [x, y] = file.current_m_s;
        let current = [x, y, 0.0];
        let moments = match gait.ramp_s {
            Some(ramp_s) => robot.trajectory(&Ramped { course: &*course, ramp_s }, &start(file), cut, current)?,
            None if file.start.is_some() => robot.trajectory(&*course, &start(file), cut, current)?,
            None => robot.trajectory(&*course, &swim.periodic.begin(), cut, current)?,
        };
        swum.written = Some(SpatialWritten {
            trajectory: out.join("trajectory.parquet"),
            report: out.join("report.html"),
            record: out.join("result.json"),
        });
        results::replace(out, |folder| write(&swum, &moments, job, folder))?;
    }
    Ok(swum)
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

fn write(swum: &SpatialSwum, moments: &[SpatialMoment], job: &Job, folder: &Path) -> Result<(), Error> {
    let path = folder.join("trajectory.parquet");
    write_parquet(&table(moments, &path), &path)?;
    write_atomically(&folder.join("report.html"), swum.page(moments, job.date.clone())?.as_bytes())?;
    Ok(write_atomically(&folder.join("result.json"), format!("{:#}\n", swum.as_json()).as_bytes())?)
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
    /// What a person reads.
    #[must_use]
    pub fn section(&self) -> DocumentSection {
        let (s, p) = (&self.swim, &self.swim.periodic);
        let row = |name: &str, value: String, unit: &str| vec![name.to_owned(), value, unit.to_owned()];
        let range =
            |[low, high]: [f64; 2]| format!("{} to {}", fixed(low.to_degrees(), 2), fixed(high.to_degrees(), 2));
        let mut rows = vec![
            row("speed, level", significant(p.speed_m_s, 4), "m/s"),
            row("cost of transport", significant(s.cost_j_m, 4), "J/m"),
            row("the same by positive power", significant(s.cost_positive_j_m, 4), "J/m"),
            row("cost of transport over m g U", significant(s.cost, 3), "1"),
            row("net power: what the water takes", significant(p.net_w, 4), "W"),
            row("positive power: drives without recovery", significant(p.positive_w, 4), "W"),
            row("power in both directions", significant(p.absolute_w, 4), "W"),
        ];
        if let Some(electric) = s.electric_w {
            rows.push(row("power from the battery", significant(electric, 4), "W"));
            rows.push(row("cost of transport from the battery", significant(electric / p.speed_m_s, 4), "J/m"));
        }
        rows.extend([
            row("largest torque of a motor", significant(s.needs.torque_n_m, 3), "N m"),
            row("largest rate of a joint", significant(s.needs.rate_rad_s.to_degrees(), 4), "deg/s"),
            row("roll of the head", range(p.roll), "deg"),
            row("pitch of the head", range(p.pitch), "deg"),
            row("turn per period", fixed(p.turn.to_degrees(), 2), "deg"),
            row("sinks per period", fixed(1e3 * p.way_m[2], 2), "mm"),
            row("largest Floquet multiplier", significant(p.multipliers[0], 3), "1"),
        ]);
        rows.extend(s.unstable.iter().flat_map(|unstable| Repeating::from(&**unstable).rows()));
        DocumentSection {
            title: self.name.clone(),
            paragraphs: self.sentences(),
            tables: vec![TextTable {
                caption: format!(
                    "{}: {} modules in three dimensions, drag of {}",
                    self.name,
                    count(self.robot.chain.links.len()),
                    self.robot.plane.estimates.0
                ),
                head: vec!["quantity".to_owned(), "value".to_owned(), "unit".to_owned()],
                rows,
            }],
            charts: Vec::new(),
        }
    }

    /// What is to be read before the figures: a motion that the swimmer leaves, a body that does not stay upright.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut out = Vec::new();
        self.stability(&mut out);
        out
    }

    fn sentences(&self) -> Vec<String> {
        let mut out = self.warnings();
        self.trim(&mut out);
        self.water(&mut out);
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
        told::losses(s.extrapolated, s.median_angle_rad, s.along, out);
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

    /// The same for a program, each number in SI with its unit in the name.
    #[must_use]
    pub fn as_json(&self) -> Value {
        let (s, p) = (&self.swim, &self.swim.periodic);
        json!({
            "robot": self.name,
            "data": self.data,
            "space": "3d",
            "modules": self.robot.chain.links.len(),
            "drag": self.robot.plane.estimates.0,
            "added_mass": self.robot.plane.estimates.1,
            "speed_m_s": p.speed_m_s,
            "sinking_m_s": p.way_m[2] / self.period_s,
            "cost_of_transport_j_m": s.cost_j_m,
            "cost_of_transport_positive_j_m": s.cost_positive_j_m,
            "cost_of_transport": s.cost,
            "power_net_w": p.net_w,
            "power_positive_w": p.positive_w,
            "power_absolute_w": p.absolute_w,
            "power_loss_w": p.loss_w,
            "power_lifting_w": p.lifting_w,
            "power_electric_w": s.electric_w,
            "torque_peak_n_m": s.needs.torque_n_m,
            "rate_peak_rad_s": s.needs.rate_rad_s,
            "steps": s.steps,
            "roll_rad": p.roll,
            "pitch_rad": p.pitch,
            "turn_per_period_rad": p.turn,
            "way_per_period_m": p.way_m,
            "righting_m": self.robot.righting_m,
            "trim_m": self.robot.trim_m,
            "mass_less_displaced_kg": self.robot.plane.heavy_kg,
            "floquet_multipliers": p.multipliers,
            "periodic_residual": p.residual,
            "unstable_motion": s.unstable.as_ref().map(|u| Repeating::from(&**u).as_json()),
            "extrapolated_loss_by_speed": s.extrapolated[0],
            "extrapolated_loss_by_angle": s.extrapolated[1],
            "loss_along_links": s.along,
            "median_angle_of_loss_rad": s.median_angle_rad,
            "trajectory": self.written.as_ref().map(|w| &w.trajectory),
            "remarks": self.sentences(),
        })
    }
}
