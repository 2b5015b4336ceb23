//! The plan: run matrix, time in the tank, and the intervals to expect.
//!
//! Each planned run is simulated without errors and reduced. The noise of its load, what the errors of its speed do to that (an error δU moves a load by −∂f/∂U δU), and what the declared
//! constants move, go through the linearised fit ([`mod@super::linear`]).

use froude_identify::method::{MethodError, Prospect};
use froude_records::block::{ResultColumn, ResultTable, TableBuilder};
use froude_records::campaign::{BudgetEntry, Campaign, SensorSpec, Shared, Source};
use froude_records::text::counted;
use froude_records::units::Dimension;

use super::linear::{PlannedError, declared, linearised};
use super::method::Observed;
use super::read::reduced;
use super::reduced::{Planned, Reduced};
use super::settings::{Plan, loads_at};
use super::spec::values;
use super::twin::{Simulated, Twin};
use crate::error::TankError;
use crate::plan::{intervals, prospect as of_plan};
use crate::sensors::seed_and_sensors;

pub use crate::plan::Expected;

/// Step of differences by the speed, as part of it.
const STEP: f64 = 1e-4;
/// Repeats of the twin from which the variance of an observation is estimated: its root to 5 %, over all runs together more closely.
const REPEATS: u64 = 200;

/// The runs of a twin as they would be reduced, without errors.
///
/// # Errors
///
/// A run that gives no observation.
pub fn exact<M: Observed>(
    twin: &Twin<M>,
    sensors: &[SensorSpec],
) -> Result<(Vec<Simulated>, Vec<Reduced<M::Found>>), TankError> {
    let method = twin.method.planned(sensors);
    let runs = twin.exactly();
    let found = runs.iter().map(|run| reduced(&method, &run.view())).collect::<Result<_, _>>()?;
    Ok((runs, found))
}

/// The settings at the speeds that the runs are observed at.
fn at_the_speeds<M: Observed>(twin: &Twin<M>, reduced: &[Reduced<M::Found>]) -> Plan {
    let mut data = twin.plan.data.clone();
    data.put("speed", reduced.iter().map(|run| run.observation.speed_m_s).collect(), Dimension::SPEED);
    data.velocity_from_speed_and_angle();
    Plan { data, of_run: Vec::new(), ..twin.plan.clone() }
}

/// The intervals to expect of the coefficients of the planned law, by its runs as [`exact`] reduces them; `in_variables` where errors of the speed are fitted.
///
/// # Errors
///
/// A load that a run does not give, coefficients that the plan does not determine.
pub fn expected<M: Observed>(
    twin: &Twin<M>,
    source: &Source,
    reduced: &[Reduced<M::Found>],
    (sensors, in_variables): (&[SensorSpec], bool),
) -> Result<Vec<Expected>, MethodError> {
    let plan = &at_the_speeds(twin, reduced);
    let n = plan.data.rows;
    let value = |name: &str, i: usize| plan.data.values(name).map_or(0.0, |v| v[i]);
    let slope = |i: usize| -> Vec<f64> {
        let (u, angle) = (value("speed", i), value("angle", i));
        let (above, below) = (loads_at(plan, i, u * (1.0 + STEP), angle), loads_at(plan, i, u * (1.0 - STEP), angle));
        above.iter().zip(&below).map(|(a, b)| (a - b) / (2.0 * STEP * u)).collect()
    };
    let slopes: Vec<Vec<f64>> = (0..n).map(slope).collect();
    let repeated = repeated(twin, sensors, &slopes, reduced).map_err(MethodError::refused)?;
    let (of_budget, rows) = declared(plan, &source.uncertainty)?;
    let variance = |r: usize, i: usize| -> f64 {
        let by_speed = (slopes[i][r] * twin.method.speed_standard_m_s(&reduced[i].found)).powi(2);
        let own = twin.method.variance(&reduced[i], &plan.law.responses[r], sensors).map(|own| by_speed + own);
        own.unwrap_or_else(|| repeated[r][i]) + rows[r][i]
    };
    let moved = |k: usize| -> Vec<Vec<f64>> {
        let load = |r: usize, i: usize| {
            let own = reduced[i].load(&plan.law.responses[r]).map_or(0.0, |l| reduced[i].moves[k].loads_n[l]);
            own - slopes[i][r] * reduced[i].moves[k].speed_m_s
        };
        (0..slopes[0].len()).map(|r| (0..n).map(|i| load(r, i)).collect()).collect()
    };
    let of_rig =
        |(k, name): (usize, &&str)| PlannedError { name: (*name).to_owned(), dof: f64::INFINITY, moves: moved(k) };
    let errors: Vec<PlannedError> = twin.method.errors().iter().enumerate().map(of_rig).chain(of_budget).collect();
    // The fit knows errors of speed and angle by what each run has of them.
    let of_run =
        |entry: &BudgetEntry| entry.shared == Shared::Sample && ["speed", "angle"].contains(&entry.quantity.as_str());
    let has_them = source.uncertainty.iter().any(of_run)
        || reduced.iter().any(|run| twin.method.speed_standard_m_s(&run.found) > 0.0);
    linearised(plan, &variance, &errors, in_variables && has_them)
}

/// Variance of each load of each run with what its speed does to it, N², by repeated runs with noise alone, about their mean: a sensor's bias is no scatter. Nothing where the method
/// states its own.
///
/// # Errors
///
/// A run that gives no observation in half of its repeats.
fn repeated<M: Observed>(
    twin: &Twin<M>,
    sensors: &[SensorSpec],
    slopes: &[Vec<f64>],
    reduced: &[Reduced<M::Found>],
) -> Result<Vec<Vec<f64>>, TankError> {
    let names = &twin.plan.law.responses;
    if names.iter().all(|name| reduced.iter().all(|run| twin.method.variance(run, name, sensors).is_some())) {
        return Ok(Vec::new());
    }
    let constants = values(&twin.method.constants());
    let mut errors = vec![vec![Vec::new(); reduced.len()]; names.len()];
    for seed in 1..=REPEATS {
        for (i, run) in twin.noisy(sensors, seed).iter().enumerate() {
            let found = twin.method.reduce(&run.view(), &constants).ok();
            for (of_load, (r, name)) in errors.iter_mut().zip(names.iter().enumerate()) {
                let Some((l, (found, _))) = reduced[i].load(name).zip(found.as_ref()) else { continue };
                of_load[i].push(found.loads[l].value - slopes[i][r] * found.speed_m_s);
            }
        }
    }
    let variance = |(of, run): (Vec<f64>, &Reduced<M::Found>)| {
        let n = of.len() as f64;
        if 2.0 * n < REPEATS as f64 {
            let what = format!(
                "gives an observation in {n} of {REPEATS} repeats with the noise of [[simulate.sensor]]: plan it longer, or with another setting"
            );
            return Err(TankError::of_run(&run.point.id, what));
        }
        let mean = of.iter().sum::<f64>() / n;
        Ok(of.iter().map(|error| (error - mean).powi(2)).sum::<f64>() / (n - 1.0))
    };
    errors.into_iter().map(|of_load| of_load.into_iter().zip(reduced).map(variance).collect()).collect()
}

/// What the plan of a source takes and determines.
///
/// # Errors
///
/// What the campaign does not declare, runs that give no observation, coefficients that the plan does not determine.
pub fn prospect<M: Observed>(campaign: &Campaign, source: &Source) -> Result<Prospect, MethodError> {
    let twin = Twin::<M>::of(campaign, source)?;
    let (_, sensors) = seed_and_sensors(campaign, &twin.senses())?;
    let (runs, reduced) = exact(&twin, sensors).map_err(MethodError::refused)?;
    let expected = expected(&twin, source, &reduced, (sensors, campaign.identify.errors_in_variables))?;
    let duration_s: f64 = runs.iter().map(|run| twin.method.duration_s(&run.point, run.duration_s())).sum();
    let has_speed_errors = reduced.iter().any(|run| twin.method.speed_standard_m_s(&run.found) > 0.0);
    let bias = ", nor that errors of the speed bias a fit without errors_in_variables";
    let paragraph = format!(
        "{} of {:.1} min in all on the log, {}. The intervals are those of the \
         linearised fit at the true coefficients of [simulate], with the noise of [[simulate.sensor]] and everything that is declared; bounds are not counted{}.",
        counted(runs.len(), "run", "runs"),
        duration_s / 60.0,
        twin.method.about_plan(&reduced),
        if has_speed_errors { bias } else { "" }
    );
    let law = format!(", with the law {} of [simulate]", twin.plan.law.name);
    let tables = [matrix(&twin, &runs, &reduced), intervals(&expected, &law)];
    Ok(of_plan(source, (runs.len(), duration_s), tables, vec![paragraph]))
}

fn matrix<M: Observed>(twin: &Twin<M>, runs: &[Simulated], reduced: &[Reduced<M::Found>]) -> ResultTable {
    let each = runs.iter().zip(reduced).enumerate();
    let rows: Vec<Planned<'_, M::Found>> = each
        .map(|(row, (simulated, run))| Planned {
            run,
            speed_m_s: twin.speed_m_s(row),
            duration_s: twin.method.duration_s(&run.point, simulated.duration_s()),
        })
        .collect();
    let t = TableBuilder::new("matrix", "Run matrix.", &rows);
    let mut columns = vec![
        t.text("run", "run", |row| row.run.point.id.clone()),
        t.text("configuration", "configuration", |row| row.run.point.configuration.clone()),
    ];
    let is_planned = |name: &str| M::SPEC.plan.iter().any(|key| key.name == name);
    columns.extend(M::SPEC.conditions.iter().filter(|condition| is_planned(condition.name)).map(|condition| {
        let [key, head] = condition.column;
        ResultColumn { digits: condition.digits, ..t.number(key, head, |row| row.run.point.condition(condition.name)) }
    }));
    columns.extend(twin.method.columns(&t));
    t.build(columns)
}
