//! The rig of the twin: the speed that a weight would come to, and what camera and cell log of a wagon.

use froude_rig::weight_tow::{WeightRig, pull};

use super::channels::MARK;
use super::keys::WeightTow;
use super::track::Lens;
use crate::observed::rig::{Loads, Rig, Trace};
use crate::observed::spec::Point;

/// Constants of the twin, by their place.
const SCALE: usize = 0;
const MASS: usize = 1;
const FRICTION: usize = 2;
/// Part of the moving mass that hangs below the load cell: body and water.
const BELOW_CELL: f64 = 0.75;
/// Where no pull moves the wagon, the balance is looked for up to this speed, m/s.
const FASTEST_M_S: f64 = 50.0;
/// Points of the tabulated law: linear between them to 1e-6 of a quadratic one.
const GRID: usize = 400;

/// What a load has along the rail, by its name.
fn along(load: &str, angle_rad: f64) -> f64 {
    if load == "f_x" { angle_rad.cos() } else { -angle_rad.sin() }
}

/// The speed at which the drag along the rail is what pulls, m/s.
pub(super) fn terminal_m_s(rig: &WeightTow, run: &Point, loads: &Loads<'_>) -> Result<f64, String> {
    let (weight_n, angle) = (run.condition("weight"), loads.angle_rad());
    let pull = weight_n - rig.friction_n.value;
    let drag_n = |u: f64| -loads.names().iter().zip(loads.at(u)).map(|(name, f)| f * along(name, angle)).sum::<f64>();
    let over = |u: f64| drag_n(u) - pull;
    if pull <= 0.0 || over(FASTEST_M_S) < 0.0 {
        return Err(format!(
            "a weight of {weight_n} N has no terminal speed against friction of {} N and the drag of [simulate]; plan another weight",
            rig.friction_n.value
        ));
    }
    let (mut low, mut high) = (0.0, FASTEST_M_S);
    for _ in 0..80 {
        let middle = 0.5 * (low + high);
        if over(middle) < 0.0 { low = middle } else { high = middle }
    }
    Ok(0.5 * (low + high))
}

/// A run as camera and cell log it.
pub(super) fn pulled(own: &WeightTow, run: &Point, rig: &mut Rig<'_>) -> Trace {
    let angle = rig.loads.angle_rad();
    let names = rig.loads.names();
    let along: Vec<f64> = names.iter().map(|name| along(name, angle)).collect();
    let mass = rig.constants[MASS];
    let wagon = WeightRig {
        moving_mass_kg: mass,
        below_cell_kg: BELOW_CELL * mass,
        weight_n: run.condition("weight"),
        friction_n: rig.constants[FRICTION].max(0.0),
        travel_m: own.travel_m,
        still_s: own.still_s,
        rate_hz: own.rate_hz,
    };
    // The law along the rail, tabulated once: a run asks for it some ten thousand times.
    let top = 2.0 * rig.speed_m_s;
    let grid: Vec<Vec<f64>> = (0..=GRID).map(|g| rig.loads.at(top * (g.max(1) as f64) / GRID as f64)).collect();
    let zero_at_rest = |g: usize| if g == 0 { 0.0 } else { 1.0 };
    let at = |v: f64, k: usize| {
        let place = (v / top * GRID as f64).clamp(0.0, GRID as f64 - 1e-9);
        let (g, part) = (place as usize, place.fract());
        (1.0 - part) * zero_at_rest(g) * grid[g][k] + part * grid[g + 1][k]
    };
    let rail = |v: f64| -(0..names.len()).map(|k| at(v, k) * along[k]).sum::<f64>();
    let loads = |v: f64| (0..names.len()).map(|k| at(v, k)).collect();
    let trace = pull(wagon, &rig.readings, &rail, &loads, &along, rig.seed);
    let mut marks = pixels(&trace.position_m, rig.constants[SCALE], own.lens, 0.5 * own.travel_m);
    let middle = own.lens.map_or(0.0, |l| l.centre_px);
    let sensor = rig.sensors.iter().find(|s| s.quantity == MARK.name);
    let (noise, step) = (sensor.and_then(|s| s.noise), sensor.and_then(|s| s.resolution));
    for mark in &mut marks {
        *mark = middle + rig.stretch * (*mark - middle) + noise.unwrap_or(0.0) * rig.draws.normal();
        if let Some(step) = step.filter(|s| *s > 0.0) {
            *mark = (*mark / step).round() * step;
        }
    }
    let columns = std::iter::once((MARK.name.to_owned(), marks)).chain(names.iter().cloned().zip(trace.loads_n));
    Trace { time_s: trace.time_s, columns: columns.collect() }
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
