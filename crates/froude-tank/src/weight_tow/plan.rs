//! The plan of weight-driven runs: what speed each reaches, and the intervals to expect.
//!
//! Each planned run is pulled without errors on the twin and reduced; the errors of its track and loads, and what scale, mass, friction and the unknown law
//! move, go through the linearised fit ([`crate::steady::plan`]). A speed that errs by δU moves a load by −∂f/∂U δU.

use froude_identify::method::{MethodError, Prospect};
use froude_records::block::{ResultTable, TableBuilder};
use froude_records::campaign::{Campaign, SensorSpec, Source};
use froude_records::number;
use froude_records::run::Declared;
use froude_records::text::counted;
use froude_records::units::Dimension;

use super::reduce::{ERRORS, Reduced, reduce};
use super::section::{self, WeightTowSpec};
use super::simulate::senses;
use super::simulate::{Simulated, Weights, declared, simulated, weights_of};
use crate::plan::{Expected, prospect as of_plan};
use crate::sensors::seed_and_sensors;
use crate::steady::plan::{self as steady, PlannedError};
use crate::steady::simulate::{Plan, loads_at};

/// Step of differences by the speed, as part of it.
const STEP: f64 = 1e-4;

/// Errors of a track, m: noise and steps of the mark.
fn noise_m(spec: &WeightTowSpec, sensors: &[SensorSpec]) -> f64 {
    let mark = sensors.iter().find(|s| s.quantity == "mark");
    let step = |s: &SensorSpec| s.resolution.unwrap_or(0.0) / 12.0_f64.sqrt();
    spec.scale_m.map_or(1.0, |s| s.value) * mark.map_or(0.0, |s| s.noise.unwrap_or(0.0).hypot(step(s)))
}

/// The runs of a plan as the reduction gives them, without errors; `sensors` say how well it will know them.
///
/// # Errors
///
/// A run that gives no observation.
pub fn exact(
    weights: &Weights,
    spec: &WeightTowSpec,
    sensors: &[SensorSpec],
) -> Result<(Vec<Simulated>, Vec<Reduced>), MethodError> {
    let noise_m = noise_m(spec, sensors);
    let without = |d: Declared| Declared::exact(d.value);
    let true_spec = WeightTowSpec {
        scale_m: spec.scale_m.map(without),
        moving_mass_kg: spec.moving_mass_kg.map(without),
        friction_n: without(spec.friction_n),
        ..*spec
    };
    let runs = simulated(weights, &true_spec, &[], &[], 0);
    let reduced = runs.iter().map(|run| reduce(&run.view(), spec, Some(noise_m))).collect::<Result<_, _>>();
    Ok((runs, reduced.map_err(MethodError::refused)?))
}

/// The settings at the speeds that the runs have in their windows, not at the terminal ones.
fn at_the_speeds(plan: &Plan, reduced: &[Reduced]) -> Plan {
    let mut data = plan.data.clone();
    data.put("speed", reduced.iter().map(|r| r.point.speed_m_s).collect(), Dimension::SPEED);
    data.velocity_from_speed_and_angle();
    Plan { data, law: plan.law.clone(), values: plan.values.clone(), of_run: Vec::new() }
}

/// The intervals to expect of the coefficients of the planned law.
///
/// # Errors
///
/// Runs that give no observation, coefficients that the plan does not determine.
pub fn expected(
    weights: &Weights,
    source: &Source,
    spec: &WeightTowSpec,
    reduced: &[Reduced],
    (sensors, in_variables): (&[SensorSpec], bool),
) -> Result<Vec<Expected>, MethodError> {
    let plan = &at_the_speeds(&weights.plan, reduced);
    let value = |name: &str, i: usize| plan.data.values(name).map_or(0.0, |v| v[i]);
    let slope = |i: usize| -> Vec<f64> {
        let (u, angle) = (value("speed", i), value("angle", i));
        let (above, below) = (loads_at(plan, i, u * (1.0 + STEP), angle), loads_at(plan, i, u * (1.0 - STEP), angle));
        above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * STEP * u)).collect()
    };
    let slopes: Vec<Vec<f64>> = (0..plan.data.rows).map(slope).collect();
    let step_s = 1.0 / spec.rate_hz;
    let (declared, rows) = steady::declared(plan, &source.uncertainty)?;
    let variance = |r: usize, i: usize| -> f64 {
        let found = &reduced[i];
        let by_speed = (slopes[i][r] * found.track.standard_m_s).powi(2);
        let parts_s = [found.track.window.len(), found.track.before.len()].map(|n| n as f64 * step_s);
        let own = |name: &str| steady::variance(sensors, name, parts_s, step_s);
        let name = plan.law.responses[r].as_str();
        // Of a run that accelerates only what is across the rail comes from the cell.
        let by_cell = if found.balance.is_none() {
            own(name)
        } else {
            let (sin, cos) = value("angle", i).sin_cos();
            let across = sin * sin * own("f_x") + cos * cos * own("f_y");
            let along = found.drag_standard_n.powi(2);
            if name == "f_x" { sin * sin * across + cos * cos * along } else { cos * cos * across + sin * sin * along }
        };
        by_speed + by_cell + rows[r][i]
    };
    let moved = |k: usize| -> Vec<Vec<f64>> {
        let load = |r: usize, i: usize| {
            let found = &reduced[i];
            let at = found.point.loads.iter().position(|l| l.name == plan.law.responses[r]);
            let own = at.map_or(0.0, |l| found.moves[k].loads_n[l]);
            own - slopes[i][r] * found.moves[k].speed_m_s
        };
        (0..plan.law.responses.len()).map(|r| (0..plan.data.rows).map(|i| load(r, i)).collect()).collect()
    };
    let of_rig =
        |(k, name): (usize, &&str)| PlannedError { name: (*name).to_owned(), dof: f64::INFINITY, moves: moved(k) };
    let errors: Vec<PlannedError> = ERRORS.iter().enumerate().map(of_rig).chain(declared).collect();
    steady::linearised(plan, &variance, &errors, in_variables)
}

/// What the plan of a source takes and determines.
///
/// # Errors
///
/// What the campaign does not declare, runs that give no observation, coefficients that the plan does not determine.
pub fn prospect(campaign: &Campaign, source: &Source) -> Result<Prospect, MethodError> {
    let spec = declared(source)?;
    let weights = weights_of(campaign, source, &spec, section::plan(source)?)?;
    let (_, sensors) = seed_and_sensors(campaign, &senses(&weights))?;
    let (runs, reduced) = exact(&weights, &spec, sensors)?;
    let expected = expected(&weights, source, &spec, &reduced, (sensors, campaign.identify.errors_in_variables))?;
    let duration_s: f64 = runs.iter().map(duration_s).sum();
    let accelerating = reduced.iter().filter(|r| r.balance.is_some()).count();
    let paragraph = format!(
        "{} of {:.1} min in all on the log, over {} m of way, waits between them not counted; {accelerating} of them do not become steady and are balanced. The intervals are those of the \
         linearised fit at the true coefficients of [simulate], with the noise of [[simulate.sensor]] and everything that is declared; bounds are not counted, nor that errors of the \
         speed bias a fit without errors_in_variables.",
        counted(runs.len(), "run", "runs"),
        duration_s / 60.0,
        number::plain(spec.travel_m, 3)
    );
    let tables = [matrix(&runs, &reduced, &weights.plan), steady::coefficients(&weights.plan, &expected)];
    Ok(of_plan(source, (runs.len(), duration_s), tables, vec![paragraph]))
}

fn duration_s(run: &Simulated) -> f64 {
    run.time_s[run.time_s.len() - 1]
}

fn matrix(runs: &[Simulated], reduced: &[Reduced], plan: &Plan) -> ResultTable {
    let rows: Vec<_> = runs.iter().zip(reduced).enumerate().collect();
    let terminal = plan.data.values("speed");
    let t = TableBuilder::new("matrix", "Run matrix.", &rows);
    t.build(vec![
        t.text("run", "run", |(_, (run, _))| run.id.clone()),
        t.text("configuration", "configuration", |(_, (run, _))| run.configuration.clone()),
        t.number("weight_n", "weight [N]", |(_, (run, _))| run.weight_n).significant(3),
        t.number("angle_rad", "angle [deg]", |(_, (run, _))| run.angle_rad).plain(4),
        t.number("speed_m_s", "speed at the end [m/s]", |(_, (_, found))| found.track.speed_m_s).significant(3),
        t.text("", "fraction of terminal speed", |(_, (_, found))| {
            found.reached().map_or_else(|| "steady".to_owned(), number::percent)
        }),
        t.number("reached", "", |(_, (_, found))| found.reached()),
        t.number("terminal_m_s", "terminal speed [m/s]", |(i, _)| terminal?.get(*i).copied()).significant(3),
        t.number("duration_s", "duration [s]", |(_, (run, _))| duration_s(run)).places(1),
    ])
}
