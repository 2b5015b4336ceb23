//! The swimmer: speed, power and cost of an independent program, and what scales.

use std::error::Error;
use std::path::Path;

use froude::hydro::drag::{CrossTerm, DragModel, Setting};
use froude::hydro::{Body, Link};
use froude::records::estimate::Estimate;
use froude::records::json::read_estimates;
use froude::swim::gait::{Envelope, Gait};
use froude::swim::joints::Drives;
use froude::swim::planar::Inertia;
use froude::swim::robot::Robot;
use froude::swim::robot_file::read_robot;
use froude::swim::shares::{Distribution, SMOOTH_M_S, Torque, shares};
use froude::swim::swim::Swim;

use crate::claims::{Claims, Verdict};

const CENTRES: &str = "Swimming: drag at the links' centres, against an independent program";
const STRIPS: &str = "Swimming: drag by strips, against an independent program";
const SHARED: &str = "Swimming: f4 of the whole robot in equal shares, against an independent program";
const REMARK: &str = "Swimming: the two sets of Remark 1 of the USR paper";
const SCALE: &str = "Swimming: what scales with the frequency";
const STRETCH: &str = "Swimming: where the loss is";

/// Of what the independent program prints.
const ALIKE: f64 = 0.003;
/// kg/m³.
const DENSITY: f64 = 1025.0;
const LINK: Link = Link { major_semi_axis_m: 0.0588, minor_semi_axis_m: 0.0394, half_length_m: 0.09 };
/// Sources with the published coefficients, as the page calls them.
pub const SOURCES: [(&str, &str); 3] =
    [("cfd", "CFD"), ("towing_rig", "towing rig"), ("circulation_tank_restricted", "circulation tank")];

/// Ten equal links with laws in the place of their own.
pub struct Mamba {
    robot: Robot,
}

impl Mamba {
    pub fn of(root: &Path) -> Result<Self, Box<dyn Error>> {
        let file = read_robot(&root.join("examples/mamba-swim/robot.toml"))?;
        Ok(Self { robot: Robot::of(&file)? })
    }

    /// Eight links with head and tail.
    pub fn with(&self, model: DragModel, coefficients: &[f64], torque: Torque) -> Robot {
        let body = Body { link: LINK, head_side_area_m2: 0.011, tail_side_area_m2: 0.008 };
        let cross_term = CrossTerm::Smooth { epsilon_m_s: SMOOTH_M_S };
        let setting = Setting { cross_term, ..Setting::as_published(body, 8.0, DENSITY) };
        let mut robot = self.robot.clone();
        let drags = shares(model, &setting, coefficients, (Distribution::Uniform, torque));
        for (link, drag) in robot.chain.links.iter_mut().zip(drags) {
            link.drag = drag;
        }
        robot
    }
}

/// As fitted: what lies outside of the record's ranges is told.
pub fn ranged(robot: Robot, estimate: &Estimate) -> Robot {
    let range = |key: &str| estimate.validity.get(key).map(|range| [range.low, range.high]);
    Robot { speed_m_s: range("speed"), angle_rad: range("angle"), ..robot }
}

/// 80 deg/s, 40 deg from joint to joint, 30 deg.
pub fn gait(envelope: Envelope) -> Gait {
    Gait::wave(30_f64.to_radians(), 80_f64.to_radians(), 40_f64.to_radians(), envelope)
}

pub fn swim(robot: &Robot, gait: &Gait) -> Result<Swim, Box<dyn Error>> {
    Ok(robot.swim(gait, &Drives::free(robot.chain.joints()), None)?)
}

/// Coefficients of an estimate in the order of its law.
pub fn coefficients(estimate: &Estimate, model: DragModel) -> Result<Vec<f64>, Box<dyn Error>> {
    let value = |name: &str| {
        let found = estimate.coefficients.get(name).and_then(|c| c.value);
        found.ok_or_else(|| format!("{} has no {name}", estimate.id).into())
    };
    model.coefficients().iter().map(|c| value(c.name)).collect()
}

pub fn published(root: &Path, source: &str, model: DragModel) -> Result<Vec<f64>, Box<dyn Error>> {
    coefficients(&record(root, source, model)?, model)
}

/// A published estimate.
pub fn record(root: &Path, source: &str, model: DragModel) -> Result<Estimate, Box<dyn Error>> {
    let file = read_estimates(&root.join(format!("examples/mamba/published/{source}.json")))?;
    let named = |e: &Estimate| DragModel::from_name(&e.law.name) == Some(model);
    Ok(file.estimates.into_iter().find(named).ok_or(format!("{source} has no such law"))?)
}

/// Numbers with how many decimals are printed.
type Printed<'a> = &'a [(f64, i32)];

fn row(claims: &mut Claims, section: &'static str, what: &str, found: &[f64], printed: Printed<'_>) {
    let words = |numbers: &mut dyn Iterator<Item = (f64, i32)>| {
        numbers.map(|(x, digits)| format!("{x:.0$}", digits as usize)).collect::<Vec<_>>().join(", ")
    };
    let holds = found.iter().zip(printed).all(|(found, (expected, digits))| {
        (found - expected).abs() <= ALIKE * expected.abs() + 0.5 * 10_f64.powi(-digits)
    });
    let expected = format!("{}, within 0.3 % and half a unit of print", words(&mut printed.iter().copied()));
    let found = words(&mut found.iter().zip(printed).map(|(x, (_, digits))| (*x, digits + 1)));
    claims.holds(section, what, &expected, found, holds);
}

pub fn all(claims: &mut Claims, root: &Path) -> Result<(), Box<dyn Error>> {
    let mamba = Mamba::of(root)?;
    centres(claims, root, &mamba)?;
    strips(claims, root, &mamba)?;
    shared(claims, root, &mamba)?;
    remark(claims, root, &mamba)?;
    scales(claims, root, &mamba)?;
    stretched(claims, root, &mamba)
}

/// U, `P_net`, `P_positive`, J/m.
fn centres(claims: &mut Claims, root: &Path, mamba: &Mamba) -> Result<(), Box<dyn Error>> {
    let rows = [
        [
            [0.2078, 0.0854, 0.465, 0.411],
            [0.1421, 0.0553, 0.178, 0.389],
            [0.2048, 0.0426, 0.444, 0.208],
            [0.1599, 0.0248, 0.158, 0.155],
        ],
        [
            [0.1636, 0.3394, 0.651, 2.075],
            [0.0899, 0.1676, 0.270, 1.864],
            [0.1600, 0.2251, 0.567, 1.407],
            [0.1081, 0.0988, 0.207, 0.914],
        ],
        [
            [0.1840, 0.3225, 0.624, 1.753],
            [0.1107, 0.1773, 0.274, 1.601],
            [0.1838, 0.1696, 0.518, 0.923],
            [0.1380, 0.0844, 0.191, 0.612],
        ],
    ];
    let cases = [
        (DragModel::F1, Envelope::Lateral, "f1, lateral"),
        (DragModel::F1, Envelope::Eel, "f1, eel"),
        (DragModel::F2, Envelope::Lateral, "f2, lateral"),
        (DragModel::F2, Envelope::Eel, "f2, eel"),
    ];
    for ((source, name), rows) in SOURCES.into_iter().zip(rows) {
        for ((model, envelope, words), printed) in cases.iter().zip(rows) {
            let robot = mamba.with(*model, &published(root, source, *model)?, Torque::Friction);
            let found = swim(&robot, &gait(envelope.clone()))?;
            let p = &found.periodic;
            let printed: Vec<(f64, i32)> = printed.into_iter().zip([4, 4, 3, 3]).collect();
            let what = format!("{name}, {words}: speed m/s, net and positive power W, cost J/m");
            row(
                claims,
                CENTRES,
                &what,
                &[p.means.speed_m_s, p.means.net_w, p.means.positive_w, found.periodic.means.cost_j_m()],
                &printed,
            );
        }
    }
    Ok(())
}

fn strips(claims: &mut Claims, root: &Path, mamba: &Mamba) -> Result<(), Box<dyn Error>> {
    let rows = [
        [(0.2080, 4), (0.0585, 4), (0.281, 3)],
        [(0.1668, 4), (0.285, 3), (1.707, 3)],
        [(0.1899, 4), (0.2237, 4), (1.178, 3)],
    ];
    for ((source, name), printed) in SOURCES.into_iter().zip(rows) {
        let robot = mamba.with(DragModel::F2, &published(root, source, DragModel::F2)?, Torque::Strip);
        let found = swim(&robot, &gait(Envelope::Lateral))?;
        let what = format!("{name}, f2, lateral: speed m/s, net power W, cost J/m");
        let all = [found.periodic.means.speed_m_s, found.periodic.means.net_w, found.periodic.means.cost_j_m()];
        row(claims, STRIPS, &what, &all, &printed);
    }
    let (tank, _) = SOURCES[2];
    for (model, words, printed) in
        [(DragModel::F1, "f1", 2.062), (DragModel::F2, "f2", 1.178), (DragModel::F4, "f4", 0.478)]
    {
        let robot = mamba.with(model, &published(root, tank, model)?, Torque::Strip);
        let found = swim(&robot, &gait(Envelope::Lateral))?;
        row(
            claims,
            STRIPS,
            &format!("circulation tank, {words}, lateral: cost J/m"),
            &[found.periodic.means.cost_j_m()],
            &[(printed, 3)],
        );
    }
    Ok(())
}

fn shared(claims: &mut Claims, root: &Path, mamba: &Mamba) -> Result<(), Box<dyn Error>> {
    let lateral = gait(Envelope::Lateral);
    let rows: [(usize, Torque, &str, Printed<'_>); 4] = [
        (1, Torque::CrossFlow, "torque of the drag across", &[(0.1701, 4), (1.141, 3), (0.1491, 4)]),
        (2, Torque::CrossFlow, "torque of the drag across", &[(0.0842, 4), (0.420, 3), (0.2005, 4)]),
        (1, Torque::Friction, "torque of the skin friction", &[(0.1562, 4), (1.048, 3)]),
        (2, Torque::Friction, "torque of the skin friction", &[(0.0680, 4), (0.339, 3)]),
    ];
    for (source, torque, words, printed) in rows {
        let (source, name) = SOURCES[source];
        let robot = mamba.with(DragModel::F4, &published(root, source, DragModel::F4)?, torque);
        let found = swim(&robot, &lateral)?;
        let all = [found.periodic.means.net_w, found.periodic.means.cost_j_m(), found.periodic.means.speed_m_s];
        let what = format!("{name}, f4, {words}: net power W, cost J/m, speed m/s");
        row(claims, SHARED, &what, &all[..printed.len()], printed);
    }
    let robot = mamba.with(DragModel::F4, &published(root, "cfd", DragModel::F4)?, Torque::CrossFlow);
    let found = swim(&robot, &lateral)?;
    let (multiplier, turn) = (found.periodic.multipliers[0], found.periodic.means.turn.to_degrees());
    claims.add(
        SHARED,
        "CFD, f4: straight swimming",
        "turns onto a circle after some 20 periods",
        format!("largest Floquet multiplier {multiplier:.3}, turn {turn:.2} deg a period"),
        if multiplier > 1.0 || turn.abs() > 0.1 { Verdict::Finding } else { Verdict::Measured },
    );
    Ok(())
}

/// Both sets of Remark 1, f1 with linear and quadratic terms alike, at the links' centres, with their own added mass.
pub fn of_remark(mamba: &Mamba, c_f: f64, c_d: f64, c_a: f64) -> Result<Swim, Box<dyn Error>> {
    let mut robot = mamba.with(DragModel::F1, &[c_f, c_d], Torque::Friction);
    let (a, l) = (LINK.major_semi_axis_m, LINK.half_length_m);
    // USR eq. 8, with λ₁ = μ l²/3 of the reference.
    let across_kg = DENSITY * std::f64::consts::PI * c_a * a * a * 2.0 * l;
    for link in &mut robot.chain.links {
        link.added = Inertia { turn: across_kg * l * l / 3.0, y: across_kg, ..Inertia::default() };
    }
    swim(&robot, &gait(Envelope::Lateral))
}

// 3.14 W is a power.
#[allow(clippy::approx_constant)]
fn remark(claims: &mut Claims, root: &Path, mamba: &Mamba) -> Result<(), Box<dyn Error>> {
    let first = of_remark(mamba, 0.3, 1.75, 1.5)?;
    let p = &first.periodic;
    let printed = [(0.114, 3), (3.14, 2), (27.7, 1)];
    row(
        claims,
        REMARK,
        "C_f 0.3, C_D 1.75, C_A 1.5: speed m/s, net power W, cost J/m",
        &[p.means.speed_m_s, p.means.net_w, first.periodic.means.cost_j_m()],
        &printed,
    );
    let tank = mamba.with(DragModel::F2, &published(root, SOURCES[2].0, DragModel::F2)?, Torque::Friction);
    let ratio = first.periodic.means.cost_j_m() / swim(&tank, &gait(Envelope::Lateral))?.periodic.means.cost_j_m();
    row(claims, REMARK, "its cost over that of the tank's f2", &[ratio], &[(30.0, 0)]);
    for c_f in [0.01, 0.03] {
        let theory = of_remark(mamba, c_f, 1.0, 1.0)?;
        let found = format!(
            "{:.4} m/s, {:.3} W, {:.2} J/m",
            theory.periodic.means.speed_m_s,
            theory.periodic.means.net_w,
            theory.periodic.means.cost_j_m()
        );
        claims.add(REMARK, &format!("theory, C_f {c_f}, C_D 1, C_A 1"), "no figure", found, Verdict::Measured);
    }
    Ok(())
}

fn scales(claims: &mut Claims, root: &Path, mamba: &Mamba) -> Result<(), Box<dyn Error>> {
    let away = |robot: &Robot| -> Result<f64, Box<dyn Error>> {
        let slow = gait(Envelope::Lateral);
        let fast = Gait { frequency: 2.0 * slow.frequency, ..slow.clone() };
        let (slow, fast) = (swim(robot, &slow)?, swim(robot, &fast)?);
        let [u, p, cost] = [
            fast.periodic.means.speed_m_s / slow.periodic.means.speed_m_s / 2.0,
            fast.periodic.means.net_w / slow.periodic.means.net_w / 8.0,
            fast.periodic.means.cost_j_m() / slow.periodic.means.cost_j_m() / 4.0,
        ];
        Ok([u, p, cost].map(|x| (x - 1.0).abs()).into_iter().fold(0.0, f64::max))
    };
    // Of the linear terms nothing is left; the cross term keeps its ε.
    let square = |model: DragModel| -> Result<Robot, Box<dyn Error>> {
        let all = published(root, SOURCES[2].0, model)?;
        let kept = model.coefficients().iter().zip(all).map(|(c, x)| if c.name.ends_with("_II") { x } else { 0.0 });
        Ok(mamba.with(model, &kept.collect::<Vec<_>>(), Torque::Strip))
    };
    let plain = away(&square(DragModel::F2)?)?;
    claims.holds(
        SCALE,
        "circulation tank, f2 without its linear terms, twice the frequency: U ∝ ω, P ∝ ω³, cost ∝ ω²",
        "to 1e-10",
        format!("{plain:.1e}"),
        plain < 1e-10,
    );
    let smooth = away(&square(DragModel::F4)?)?;
    claims.add(
        SCALE,
        "f4 without its linear terms, whose cross term passes broadside within ε = 1 mm/s",
        "ε is a speed of its own, and the scaling is broken",
        format!("{smooth:.1e}"),
        Verdict::Measured,
    );
    Ok(())
}

fn stretched(claims: &mut Claims, root: &Path, mamba: &Mamba) -> Result<(), Box<dyn Error>> {
    for (source, name) in SOURCES {
        for (torque, words) in [(Torque::Strip, "strips"), (Torque::Friction, "at the links' centres")] {
            let robot = mamba.with(DragModel::F2, &published(root, source, DragModel::F2)?, torque);
            let found = swim(&robot, &gait(Envelope::Lateral))?;
            claims.add(
                STRETCH,
                &format!("{name}, f2, {words}: median angle of the loss, share of it along the links"),
                "about 11 deg and 64 %, which are CFD's at the links' centres",
                format!("{:.1} deg, {:.0} %", found.effort.median_angle_rad.to_degrees(), 100.0 * found.effort.along),
                Verdict::Measured,
            );
        }
    }
    Ok(())
}
