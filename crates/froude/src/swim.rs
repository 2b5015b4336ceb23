//! `froude swim`: a robot file and a gait become speed, powers and cost of transport, and a trajectory.

use std::path::{Path, PathBuf};

use froude_records::number::{count, degrees, fixed, percent, significant};
use froude_records::page::{DocumentSection, TextTable};
use froude_records::parquet_table::write_parquet;
use froude_records::robot::{ModuleFile, RobotFile, read_robot};
use froude_records::table::{Column, ColumnData, Table};
use froude_records::units::{Dimension, Unit, parse_unit};
use froude_swim::gait::Gait;
use froude_swim::robot::Robot;
use froude_swim::swim::{Limits, Moment, Swim};

use crate::Error;

/// What is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Job {
    /// The robot file.
    pub robot: PathBuf,
    /// What its joints do.
    pub gait: Gait,
    /// Folder of the trajectory; without it nothing is written.
    pub out: Option<PathBuf>,
    /// Periods of the trajectory.
    pub periods: usize,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Swum {
    /// The robot's name.
    pub name: String,
    /// What the gait comes to.
    pub swim: Swim,
    /// The robot.
    pub robot: Robot,
    /// Half height, half width and half length of its modules, m.
    pub sections: Vec<[f64; 3]>,
    /// The torque that joints allow, N m.
    pub torque_limit_n_m: Option<f64>,
    /// The trajectory, where it was asked for.
    pub written: Option<PathBuf>,
}

/// Moments of a period in a trajectory.
const MOMENTS: usize = 100;
/// A body is neutral when it weighs less than this part of itself in water.
const NEUTRAL: f64 = 0.005;
/// Lengths that differ by less than this part are the same.
const SAME: f64 = 0.01;

/// Swims.
///
/// # Errors
///
/// A robot file or record that cannot be used, joints beyond their limits, a gait without a motion that repeats, a folder that cannot be written.
pub fn swim(job: &Job) -> Result<Swum, Error> {
    let file = read_robot(&job.robot)?;
    let robot = Robot::of(&file)?;
    let limits = Limits { angle_rad: file.joint.limit_rad, rate_rad_s: file.joint.rate_rad_s };
    let swim = robot.swim(&job.gait, limits)?;
    let written = match &job.out {
        Some(out) => Some(trajectory(&file, &robot, job, &swim, out)?),
        None => None,
    };
    let section = |m: &ModuleFile| [m.link.major_semi_axis_m, m.link.minor_semi_axis_m, m.link.half_length_m];
    let sections = file.modules.iter().map(section).collect();
    Ok(Swum { name: file.name, swim, robot, sections, torque_limit_n_m: file.joint.torque_n_m, written })
}

fn trajectory(file: &RobotFile, robot: &Robot, job: &Job, swim: &Swim, out: &Path) -> Result<PathBuf, Error> {
    let whole = (job.periods, MOMENTS);
    let moments = robot.trajectory(&job.gait, &swim.periodic, whole, file.current_m_s)?;
    std::fs::create_dir_all(out).map_err(|source| Error::Output { path: out.to_owned(), source })?;
    let path = out.join("trajectory.parquet");
    write_parquet(&table(&moments, &path), &path)?;
    Ok(path)
}

/// Columns with their units, a row per moment.
fn table(moments: &[Moment], path: &Path) -> Table {
    let mut columns = Vec::new();
    // The units are written below.
    let mut put = |name: String, unit: &str, si: Vec<f64>| {
        let unit = parse_unit(unit).unwrap_or_else(|_| Unit::si(Dimension::ONE));
        let dimension = unit.dimension;
        columns.push(Column { name, data: ColumnData::Number { unit, dimension, si } });
    };
    let all = |of: &dyn Fn(&Moment) -> f64| moments.iter().map(of).collect::<Vec<f64>>();
    let energy = moments.first().map_or(0.0, |m| m.energy_j);
    put("time".to_owned(), "s", all(&|m| m.time_s));
    put("x".to_owned(), "m", all(&|m| m.centre_m[0]));
    put("y".to_owned(), "m", all(&|m| m.centre_m[1]));
    put("heading".to_owned(), "rad", all(&|m| m.state.heading));
    put("v_x".to_owned(), "m/s", all(&|m| m.state.head[1]));
    put("v_y".to_owned(), "m/s", all(&|m| m.state.head[2]));
    put("w_z".to_owned(), "rad/s", all(&|m| m.state.head[0]));
    for i in 0..moments.first().map_or(0, |m| m.torque_n_m.len()) {
        put(format!("phi_{}", i + 1), "rad", all(&|m| m.shape.angle[i]));
        put(format!("phi_dot_{}", i + 1), "rad/s", all(&|m| m.shape.rate[i]));
        put(format!("tau_{}", i + 1), "N m", all(&|m| m.torque_n_m[i]));
    }
    put("power_net".to_owned(), "W", all(&|m| m.power_w[0]));
    put("power_pos".to_owned(), "W", all(&|m| m.power_w[1]));
    put("power_loss".to_owned(), "W", all(&|m| m.power_w[2]));
    put("energy_kinetic".to_owned(), "J", all(&|m| m.energy_j));
    put("energy_residual".to_owned(), "J", all(&|m| m.state.work_j - m.state.loss_j - (m.energy_j - energy)));
    Table {
        path: path.to_owned(),
        columns,
        n_rows: moments.len(),
        line_of_row: (1..=moments.len()).collect(),
        sidecar: None,
        left_out: Vec::new(),
    }
}

impl Swum {
    /// What a person reads.
    #[must_use]
    pub fn section(&self) -> DocumentSection {
        let (s, p) = (&self.swim, &self.swim.periodic);
        let row = |name: &str, value: String, unit: &str| vec![name.to_owned(), value, unit.to_owned()];
        let rows = vec![
            row("speed", significant(p.speed_m_s, 4), "m/s"),
            row("cost of transport", significant(s.cost_j_m, 4), "J/m"),
            row("the same by positive power", significant(s.cost_positive_j_m, 4), "J/m"),
            row("cost of transport over m g U", significant(s.cost, 3), "1"),
            row("net power: what the water takes", significant(p.net_w, 4), "W"),
            row("positive power: drives without recovery", significant(p.positive_w, 4), "W"),
            row("power in both directions", significant(p.absolute_w, 4), "W"),
            row("largest torque of a joint", significant(p.torque_n_m, 3), "N m"),
            row("largest rate of a joint", significant(s.rate_rad_s.to_degrees(), 4), "deg/s"),
            row("turn per period", fixed(p.turn.to_degrees(), 2), "deg"),
            row("largest Floquet multiplier", significant(p.multipliers[0], 3), "1"),
        ];
        DocumentSection {
            title: self.name.clone(),
            paragraphs: self.sentences(),
            tables: vec![TextTable {
                caption: format!(
                    "{}: {} modules, drag of {}",
                    self.name,
                    count(self.robot.chain.links.len()),
                    self.robot.estimates.0
                ),
                head: vec!["quantity".to_owned(), "value".to_owned(), "unit".to_owned()],
                rows,
            }],
            charts: Vec::new(),
        }
    }

    fn sentences(&self) -> Vec<String> {
        let (s, p) = (&self.swim, &self.swim.periodic);
        let mut out = Vec::new();
        if p.multipliers[0] > 1.0 {
            out.push(format!(
                "unstable: a small deviation grows by a factor of {} from period to period, and the swimmer leaves this motion",
                significant(p.multipliers[0], 3)
            ));
        }
        for (share, what) in s.extrapolated.iter().zip(["speed", "angle to the flow"]) {
            if share.is_none() {
                out.push(format!("the record does not say at what {what} its drag was fitted: how far it is stretched here is not known"));
            }
            if let Some(share) = share.filter(|share| *share > 0.0) {
                out.push(format!(
                    "extrapolated: {} of the loss is of links whose {what} lies outside of what the drag was fitted at",
                    percent(share)
                ));
            }
        }
        out.push(format!("half of the loss is at angles to the flow below {}", degrees(s.median_angle_rad)));
        if let Some((module, power)) = s.gain_w {
            out.push(format!(
                "not dissipative: module {module} gains up to {} W from still water at speeds up to those reached; choose a law that takes power at every speed or, where it is by-origin, distribution = \"uniform\"",
                significant(power, 2)
            ));
        }
        if let Some(limit) = self.torque_limit_n_m.filter(|limit| p.torque_n_m > *limit) {
            out.push(format!(
                "beyond the drives: a joint needs {} N m, and they give {} N m",
                significant(p.torque_n_m, 3),
                significant(limit, 3)
            ));
        }
        if let Some(id) = &self.robot.estimates.1 {
            out.push(format!(
                "C_A of {id} refers to links without head and tail; here every module has the added mass of a link"
            ));
        }
        if self.robot.heavy_kg.is_none() {
            out.push("not every module states its volume: whether the robot is neutral is not known".to_owned());
        }
        let of = &self.robot.refers_to;
        let of = [of.major_semi_axis_m, of.minor_semi_axis_m, of.half_length_m];
        let words = ["half height", "half width", "half length"];
        for (k, name) in words.iter().enumerate() {
            let other = self.sections.iter().map(|s| s[k]).find(|own| (own / of[k] - 1.0).abs() > SAME);
            if let Some(own) = other {
                out.push(format!(
                    "the drag refers to a link whose {name} is {} mm, and a module's is {} mm: its forces are those of the link that was measured",
                    significant(1e3 * of[k], 4),
                    significant(1e3 * own, 4)
                ));
            }
        }
        if let Some(heavy) = self.robot.heavy_kg.filter(|heavy| heavy.abs() > NEUTRAL * self.robot.mass_kg) {
            let way = if heavy > 0.0 { "heavier" } else { "lighter" };
            out.push(format!(
                "not neutral: the robot is {} kg {way} than the water that its modules displace ({} of its mass); it swims in a plane only if something holds it there",
                significant(heavy.abs(), 2),
                percent(heavy.abs() / self.robot.mass_kg)
            ));
        }
        out
    }

    /// The same for a program, each number in SI with its unit in the name.
    #[must_use]
    pub fn as_json(&self) -> serde_json::Value {
        let (s, p) = (&self.swim, &self.swim.periodic);
        serde_json::json!({
            "robot": self.name,
            "modules": self.robot.chain.links.len(),
            "drag": self.robot.estimates.0,
            "added_mass": self.robot.estimates.1,
            "speed_m_s": p.speed_m_s,
            "cost_of_transport_j_m": s.cost_j_m,
            "cost_of_transport_positive_j_m": s.cost_positive_j_m,
            "cost_of_transport": s.cost,
            "power_net_w": p.net_w,
            "power_positive_w": p.positive_w,
            "power_absolute_w": p.absolute_w,
            "power_loss_w": p.loss_w,
            "torque_peak_n_m": p.torque_n_m,
            "rate_peak_rad_s": s.rate_rad_s,
            "turn_per_period_rad": p.turn,
            "floquet_multipliers": p.multipliers,
            "periodic_residual": p.residual,
            "extrapolated_loss_by_speed": s.extrapolated[0],
            "extrapolated_loss_by_angle": s.extrapolated[1],
            "median_angle_of_loss_rad": s.median_angle_rad,
            "gains_power": s.gain_w.map(|(module, watts)| serde_json::json!({"module": module, "power_w": watts})),
            "mass_less_displaced_kg": self.robot.heavy_kg,
            "trajectory": self.written,
            "remarks": self.sentences(),
        })
    }
}
