//! The plan: run matrix, time in the tank, and the intervals to expect.

use std::f64::consts::TAU;

use froude_identify::method::{MethodError, Prospect};
use froude_records::block::{ResultTable, TableBuilder};
use froude_records::campaign::{Campaign, Source};
use froude_records::run::Role;

use super::forecast::{Forecast, forecast, planned_still_fits, sensors_of};
use super::matrix::Planned;
use super::method::MotorDriven;
use super::setup::Setup;
use super::spec::{Number, Point};
use super::still_fit::is_still;
use super::still_page;
use super::twin::{Twin, senses};
use crate::plan;
use crate::sensors::seed_and_sensors;

/// What the plan of a source takes and determines.
///
/// # Errors
///
/// What the campaign does not declare, runs too short for their cycles, coefficients that the plan does not determine.
pub fn prospect<M: MotorDriven>(campaign: &Campaign, source: &Source) -> Result<Prospect, MethodError> {
    // Another law than the true one is off by what it lacks, which no linearisation forecasts.
    let twin = Twin::<M>::of(campaign, source)?;
    let (_, sensors) = seed_and_sensors(campaign, &senses::<M>())?;
    let found = forecast(&twin, &twin.setup, sensors, &campaign.identify).map_err(MethodError::refused)?;
    let duration_s = twin.planned.iter().map(|run| run.swing.duration_s()).sum();
    let mut paragraphs = vec![plan::of_joint_fit(twin.planned.len(), duration_s, M::SPEC.changed)];
    let noiseless = M::SPEC.loads.iter().zip(sensors_of::<M>(sensors));
    let noiseless: Vec<&str> = noiseless
        .filter(|(_, sensor)| sensor.is_none_or(|s| s.noise.is_none_or(|noise| noise <= 0.0)))
        .map(|(load, _)| load.name)
        .collect();
    if !noiseless.is_empty() {
        let only = if noiseless.len() == M::SPEC.loads.len() { ", which include the declared errors only" } else { "" };
        paragraphs.push(format!(
            "Mind: no noise of {} is declared, and none is in the intervals{only}. Write [[simulate.sensor]] quantity = \"{}\" with its noise.",
            noiseless.join(" and "),
            noiseless[0]
        ));
    }
    let in_water = twin.planned.iter().filter(|run| run.point.role == Role::Test);
    let rates = in_water
        .map(|run| run.swing.amplitude * run.swing.omega_rad_s)
        .fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], rate| [low.min(rate), high.max(rate)]);
    paragraphs.extend(twin.setup.method.about_plan(&found, rates));
    let law = twin.setup.method.law();
    let law = if law == M::SPEC.law { String::new() } else { format!(", with the law {law} of [simulate]") };
    let still_fits = planned_still_fits(&twin, sensors).map_err(MethodError::refused)?;
    let setup = Setup { still_fits, ..twin.setup.clone() };
    let stills: Vec<&Planned> = twin.planned.iter().filter(|run| is_still(&run.point)).collect();
    let of_stills = || [still_runs::<M>(&stills), still_page::constants(&setup)];
    let tables = [matrix(&twin, &found)];
    let tables = tables.into_iter().chain((!stills.is_empty()).then(of_stills).into_iter().flatten());
    let tables = tables.chain([plan::intervals(&found.expected, &law)]);
    Ok(plan::prospect(source, (twin.planned.len(), duration_s), tables, paragraphs))
}

fn still_runs<M: MotorDriven>(runs: &[&Planned]) -> ResultTable {
    let motion = M::SPEC.motion;
    let t = TableBuilder::new("still_runs", "Still runs.", runs);
    t.build(vec![
        t.text("run", "run", |run| run.id.clone()),
        t.text("configuration", "configuration", |run| run.point.configuration.clone()),
        t.number(&format!("{}_{}", motion.name, motion.unit), &format!("{} [{}]", motion.name, motion.shown), |run| {
            run.swing.middle
        })
        .plain(4),
        t.number("duration_s", "duration [s]", |run| run.swing.duration_s()).places(1),
    ])
}

fn matrix<M: MotorDriven>(twin: &Twin<M>, found: &Forecast) -> ResultTable {
    let motion = M::SPEC.motion;
    let moved: Vec<&Planned> = twin.planned.iter().filter(|run| !is_still(&run.point)).collect();
    let points: Vec<&Point> = moved.iter().map(|run| &run.point).collect();
    let numbers =
        |run: &Planned| twin.setup.method.numbers(&run.point, &twin.setup, run.swing.amplitude, run.swing.omega_rad_s);
    let rows: Vec<(&Planned, Vec<Number>, usize)> =
        moved.into_iter().zip(&found.cycles).map(|(run, cycles)| (run, numbers(run), *cycles)).collect();
    let t = TableBuilder::new("matrix", "Run matrix.", &rows);
    let (key, head) = (format!("amplitude_{}", motion.unit), format!("amplitude [{}]", motion.shown));
    let mut columns = vec![t.text("run", "run", |(run, ..)| run.id.clone())];
    columns.extend(twin.setup.method.mounted(&TableBuilder::new("", "", &points)));
    columns.extend([
        t.number(&key, &head, |(run, ..)| run.swing.amplitude).plain(4),
        t.number("omega_rad_s", "ω [deg/s]", |(run, ..)| run.swing.omega_rad_s).plain(4),
        t.number("frequency_hz", "frequency [Hz]", |(run, ..)| run.swing.omega_rad_s / TAU).plain(4),
    ]);
    let first = rows.first().map_or(&[][..], |(_, numbers, _)| numbers.as_slice());
    columns.extend(first.iter().enumerate().filter_map(|(i, number)| {
        let [key, head] = number.column?;
        Some(t.number(key, head, |(_, numbers, _)| numbers[i].value).significant(3))
    }));
    columns.push(t.count("cycles", "cycles used", |(.., cycles)| *cycles));
    columns.push(t.number("duration_s", "duration [s]", |(run, ..)| run.swing.duration_s()).places(1));
    t.build(columns)
}
