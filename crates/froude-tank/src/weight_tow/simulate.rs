//! The twin of a campaign's weight-driven runs: the logs and sidecars that it would give for chosen true coefficients.
//!
//! Scale, moving mass and friction are drawn about what is declared; a gain of the loads that the campaign shares, and an error of the speed that each
//! run has for itself (the mark out of its plane), as `[[source.uncertainty]]` states them.

use crate::names::WEIGHT_TOW;
use froude_identify::method::{Export, MethodError};
use froude_identify::simulate::{planned, truth};
use froude_records::campaign::{BudgetEntry, Campaign, PlanBlock, SensorSpec, Shared, Source};
use froude_records::units::Dimension;
use froude_rig::steady::Reading;
use froude_rig::weight_tow::{WeightRig, pull};

use super::reduce::WeightRun;
use super::section::{self, Lens, WeightTowSpec};
use super::track::metres;
use crate::declared::{needed, uncertain};
use crate::error::undeclared;
use crate::sensors::{Senses, reading, seed_and_sensors};
use crate::steady::simulate::{Plan, loads_at};
use crate::twin::{Draws, Sidecar, csv, pair, seed_of};

/// Part of the moving mass that hangs below the load cell: body and water.
const BELOW_CELL: f64 = 0.75;
/// Standard deviation of the zero of a run, N.
const ZERO_N: f64 = 0.2;
/// Moving mass of a twin whose campaign declares none, kg.
const USUAL_KG: f64 = 4.0;
/// Size of a pixel of a twin whose campaign declares none, m.
const USUAL_SCALE_M: f64 = 1.2e-3;
/// Where no pull moves the wagon, the balance is looked for up to this speed, m/s.
const FASTEST_M_S: f64 = 50.0;

/// The planned runs with their truth.
#[derive(Debug, Clone)]
pub struct Weights {
    /// Settings at the terminal speeds, the law and its coefficients.
    pub plan: Plan,
    /// Weight of each run, N.
    pub weight_n: Vec<f64>,
}

/// One run with its log.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// Its name.
    pub id: String,
    /// What is mounted.
    pub configuration: String,
    /// The angle, rad.
    pub angle_rad: f64,
    /// The weight, N.
    pub weight_n: f64,
    /// Time, s.
    pub time_s: Vec<f64>,
    /// The mark, pixels.
    pub mark_px: Vec<f64>,
    /// The mark as the reduction takes it, m.
    pub position_m: Vec<f64>,
    /// Names of the loads.
    pub names: Vec<String>,
    /// The loads as sensed, N.
    pub loads_n: Vec<Vec<f64>>,
}

impl Simulated {
    /// The log as the reduction takes it.
    #[must_use]
    pub fn view(&self) -> WeightRun<'_> {
        let loads = self.names.iter().zip(&self.loads_n);
        WeightRun {
            id: &self.id,
            angle_rad: self.angle_rad,
            weight_n: self.weight_n,
            time_s: &self.time_s,
            position_m: &self.position_m,
            loads: loads.map(|(name, values)| (name.as_str(), values.as_slice())).collect(),
        }
    }
}

/// `[source.weight_tow]`.
///
/// # Errors
///
/// It is not there, or cannot be read.
pub fn declared(source: &Source) -> Result<WeightTowSpec, MethodError> {
    let what = "nothing is declared of wagon and camera: write [source.weight_tow] with scale (the size of a pixel), moving_mass and friction";
    needed(source, WEIGHT_TOW, section::weight_tow, what)
}

/// Drag along the rail of a run at a speed, N.
fn drag_n(plan: &Plan, row: usize, speed_m_s: f64, angle_rad: f64) -> f64 {
    let loads = loads_at(plan, row, speed_m_s, angle_rad);
    let of = |name: &str| plan.law.responses.iter().position(|r| r == name).map_or(0.0, |k| loads[k]);
    -(of("f_x") * angle_rad.cos() - of("f_y") * angle_rad.sin())
}

/// The runs of a plan ([`section::plan`]), each at the speed where the drag along the rail is what pulls.
///
/// # Errors
///
/// What the campaign does not declare; a weight that friction holds.
pub fn weights_of(
    campaign: &Campaign,
    source: &Source,
    spec: &WeightTowSpec,
    blocks: Vec<PlanBlock>,
) -> Result<Weights, MethodError> {
    // The weight stands where the speed of a table's plan does, until the balance is found.
    let own = Source { plan: blocks, ..source.clone() };
    let mut alone = campaign.clone();
    alone.sources = vec![own.clone()];
    let mut data = planned(&alone, &own)?;
    let (law, values) = truth(&alone, &data)?;
    let weight_n = data.values("speed").unwrap_or_default().to_vec();
    let angle = data.values("angle").unwrap_or_default().to_vec();
    let plan = Plan { data: data.clone(), law, values, of_run: Vec::new() };
    let mut speeds = Vec::new();
    for row in 0..plan.data.rows {
        let pull = weight_n[row] - spec.friction_n.value;
        let over = |u: f64| drag_n(&plan, row, u, angle[row]) - pull;
        if pull <= 0.0 || over(FASTEST_M_S) < 0.0 {
            let what = format!(
                "a weight of {} N has no terminal speed against friction of {} N and the drag of [simulate]; plan another weight",
                weight_n[row], spec.friction_n.value
            );
            return Err(undeclared(&source.place, what));
        }
        let (mut low, mut high) = (0.0, FASTEST_M_S);
        for _ in 0..80 {
            let middle = 0.5 * (low + high);
            if over(middle) < 0.0 { low = middle } else { high = middle }
        }
        speeds.push(0.5 * (low + high));
    }
    data.put("speed", speeds, Dimension::SPEED);
    data.velocity_from_speed_and_angle();
    Ok(Weights { plan: Plan { data, ..plan }, weight_n })
}

/// Pixels of positions.
fn pixels(position_m: &[f64], scale_m: f64, lens: Option<Lens>, middle_m: f64) -> Vec<f64> {
    let of = |x: &f64| match lens {
        None => x / scale_m,
        Some(Lens { centre_px, radial }) => {
            let y = (x - middle_m) / scale_m;
            let mut d = y;
            for _ in 0..50 {
                d -= (d * (1.0 + radial * d * d) - y) / (1.0 + 3.0 * radial * d * d);
            }
            centre_px + d
        }
    };
    position_m.iter().map(of).collect()
}

/// The logs of all planned runs; the same seed gives the same logs. `sensors` are `mark` (pixels), `f_x` and `f_y`.
#[must_use]
pub fn simulated(
    weights: &Weights,
    spec: &WeightTowSpec,
    sensors: &[SensorSpec],
    budget: &[BudgetEntry],
    seed: u64,
) -> Vec<Simulated> {
    let mut draws = Draws::of(seed);
    let plan = &weights.plan;
    let scale = spec.scale_m.map_or(USUAL_SCALE_M, |s| s.value);
    let true_scale = spec.scale_m.map_or(USUAL_SCALE_M, |s| draws.about(uncertain(s)));
    let mass = spec.moving_mass_kg.map_or(USUAL_KG, |m| draws.about(uncertain(m)));
    let friction = draws.about(uncertain(spec.friction_n)).max(0.0);
    let common: Vec<f64> = budget.iter().map(|_| draws.normal()).collect();
    let of = |name: &str| sensors.iter().find(|s| s.quantity == name);
    let mut out = Vec::new();
    for row in 0..plan.data.rows {
        let names = plan.law.responses.clone();
        let mut gains = vec![1.0; names.len()];
        let mut stretch = 1.0;
        for (entry, common) in budget.iter().zip(&common).filter(|(entry, _)| entry.relative) {
            let z = if entry.shared == Shared::Campaign { *common } else { draws.normal() };
            if entry.quantity == "speed" {
                stretch *= 1.0 + entry.standard * z;
            } else if let Some(k) = names.iter().position(|r| *r == entry.quantity) {
                gains[k] *= 1.0 + entry.standard * z;
            }
        }
        let each = names.iter().zip(&gains);
        let readings: Vec<Reading> =
            each.map(|(name, gain)| reading(sensors, &[name], ZERO_N * draws.normal(), *gain)).collect();
        let angle = plan.data.values("angle").map_or(0.0, |a| a[row]);
        let along: Vec<f64> = names.iter().map(|n| if n == "f_x" { angle.cos() } else { -angle.sin() }).collect();
        let rig = WeightRig {
            moving_mass_kg: mass,
            below_cell_kg: BELOW_CELL * mass,
            weight_n: weights.weight_n[row],
            friction_n: friction,
            travel_m: spec.travel_m,
            still_s: spec.still_s,
            rate_hz: spec.rate_hz,
        };
        // The law along the rail, tabulated once: a run asks for it some ten thousand times.
        let top = 2.0 * plan.data.values("speed").map_or(1.0, |v| v[row]);
        let grid: Vec<Vec<f64>> =
            (0..=GRID).map(|g| loads_at(plan, row, top * (g.max(1) as f64) / GRID as f64, angle)).collect();
        let zero_at_rest = |g: usize| if g == 0 { 0.0 } else { 1.0 };
        let at = |v: f64, k: usize| {
            let place = (v / top * GRID as f64).clamp(0.0, GRID as f64 - 1e-9);
            let (g, part) = (place as usize, place.fract());
            (1.0 - part) * zero_at_rest(g) * grid[g][k] + part * grid[g + 1][k]
        };
        let rail = |v: f64| -(0..names.len()).map(|k| at(v, k) * along[k]).sum::<f64>();
        let loads = |v: f64| (0..names.len()).map(|k| at(v, k)).collect();
        let trace = pull(rig, &readings, &rail, &loads, &along, seed_of(seed, row));
        let mut marks = pixels(&trace.position_m, true_scale, spec.lens, 0.5 * spec.travel_m);
        let middle = spec.lens.map_or(0.0, |l| l.centre_px);
        let (noise, step) = (of("mark").and_then(|s| s.noise), of("mark").and_then(|s| s.resolution));
        for mark in &mut marks {
            *mark = middle + stretch * (*mark - middle) + noise.unwrap_or(0.0) * draws.normal();
            if let Some(step) = step.filter(|s| *s > 0.0) {
                *mark = (*mark / step).round() * step;
            }
        }
        out.push(Simulated {
            id: format!("{:03}", row + 1),
            configuration: plan.data.configuration[row].clone(),
            angle_rad: angle,
            weight_n: weights.weight_n[row],
            position_m: metres(&marks, scale, spec.lens),
            time_s: trace.time_s,
            mark_px: marks,
            names,
            loads_n: trace.loads_n,
        });
    }
    out
}

/// Points of the tabulated law: linear between them to 1e-6 of a quadratic one.
const GRID: usize = 400;

/// What the twin has: the mark in pixels, and the loads of the law.
pub(super) fn senses(weights: &Weights) -> [Senses<'_>; 2] {
    [Senses::white("mark"), Senses::with_memory(weights.plan.law.responses.iter().map(String::as_str))]
}

/// The files of all planned runs of a source: a log and its sidecar each.
///
/// # Errors
///
/// What the campaign does not declare.
pub fn files(campaign: &Campaign, source: &Source) -> Result<Vec<Export>, MethodError> {
    let spec = declared(source)?;
    let weights = weights_of(campaign, source, &spec, section::plan(source)?)?;
    let (seed, sensors) = seed_and_sensors(campaign, &senses(&weights))?;
    let runs = simulated(&weights, &spec, sensors, &source.uncertainty, seed);
    Ok(runs.iter().flat_map(|run| pair(&run.id, log(run), sidecar(run))).collect())
}

fn log(run: &Simulated) -> String {
    let loads = run.loads_n.iter().map(|load| (load.as_slice(), 6));
    let columns: Vec<(&[f64], usize)> = std::iter::once((run.mark_px.as_slice(), 4)).chain(loads).collect();
    csv(&format!("time,mark,{}", run.names.join(",")), &run.time_s, &columns)
}

fn sidecar(run: &Simulated) -> String {
    let mark = ["mark", "mark", "1", "sensor", "   # pixels along the rail"];
    let loads = run.names.iter().map(|load| [load, load, "N", "body", ""]);
    let degrees = (run.angle_rad.to_degrees() * 1e9).round() / 1e9;
    let sidecar = Sidecar {
        said: "A run of the twin.",
        method: WEIGHT_TOW,
        role: "test",
        configuration: &run.configuration,
        conditions: &[format!("angle = \"{degrees} deg\""), format!("weight = \"{} N\"", run.weight_n)],
        time: "time",
        columns: &std::iter::once(mark).chain(loads).collect::<Vec<_>>(),
        width: 4,
    };
    sidecar.text()
}
