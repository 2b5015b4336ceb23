//! The plan of a rotation: run matrix, time in the tank, and the intervals to expect.

use std::f64::consts::TAU;

use froude_identify::method::{MethodError, Prospect};
use froude_records::block::{ResultTable, TableBuilder};
use froude_records::campaign::{Campaign, Source};
use froude_rig::rotation::Mounted;

use super::findings::one_rate;
use super::fit::LAMBDAS;
use super::forecast::{Forecast, forecast};
use super::section::{self, setup_of};
use super::setup::{Setup, tip_kc, words};
use super::simulate::senses;
use super::simulate::{Planned, Truths, planned};
use crate::plan;
use crate::sensors::seed_and_sensors;

/// What the plan of a source takes and determines.
///
/// # Errors
///
/// What the campaign does not declare, runs too short for their cycles, coefficients that the plan does not determine.
pub fn prospect(campaign: &Campaign, source: &Source) -> Result<Prospect, MethodError> {
    let (setup, blocks) = (setup_of(campaign, source)?, section::plan(source)?);
    let truth = Truths::of(campaign, &blocks, &setup)?;
    let planned = planned(&blocks);
    let (_, sensors) = seed_and_sensors(campaign, &senses())?;
    let found = forecast(&planned, &setup, &truth, sensors, &campaign.identify).map_err(MethodError::refused)?;
    let duration_s = planned.iter().map(|run| run.swing.duration_s()).sum();
    let mut paragraphs = vec![plan::of_joint_fit(planned.len(), duration_s, "what is mounted")];
    let pairs = [(0, 1), (0, 2), (1, 2)].into_iter().filter_map(|(i, j)| {
        let r = found.correlation(LAMBDAS[i], LAMBDAS[j])?;
        Some(format!("{} with {} {r:.2}", LAMBDAS[i], LAMBDAS[j]))
    });
    let pairs: Vec<String> = pairs.collect();
    if !pairs.is_empty() {
        paragraphs.push(format!("Correlations to expect: {}.", pairs.join(", ")));
    }
    let in_water = planned.iter().filter(|run| run.mounted == Mounted::Body);
    let rates = in_water
        .map(|run| run.swing.amplitude_rad * run.swing.omega_rad_s)
        .fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], rate| [low.min(rate), high.max(rate)]);
    paragraphs.extend(one_rate(rates, found.correlation(LAMBDAS[1], LAMBDAS[2])).map(|text| format!("Mind: {text}.")));
    let tables = [matrix(&planned, &found, &setup), plan::intervals(&found.expected, "")];
    Ok(plan::prospect(source, (planned.len(), duration_s), tables, paragraphs))
}

fn matrix(planned: &[Planned], found: &Forecast, setup: &Setup) -> ResultTable {
    let rows: Vec<_> = planned.iter().map(|run| (run, &run.swing)).zip(&found.cycles).collect();
    let t = TableBuilder::new("matrix", "Run matrix.", &rows);
    t.build(vec![
        t.text("run", "run", |((run, _), _)| run.id.clone()),
        t.text("mounted", "mounted", |((run, _), _)| words(run.mounted).to_owned()),
        t.number("amplitude_rad", "amplitude [deg]", |((_, turn), _)| turn.amplitude_rad).plain(4),
        t.number("omega_rad_s", "ω [deg/s]", |((_, turn), _)| turn.omega_rad_s).plain(4),
        t.number("frequency_hz", "frequency [Hz]", |((_, turn), _)| turn.omega_rad_s / TAU).plain(4),
        t.number("rate_rad_s", "rate amplitude [rad/s]", |((_, turn), _)| turn.amplitude_rad * turn.omega_rad_s)
            .significant(3),
        t.number("tip_kc", "KC of the tip [1]", |((_, turn), _)| tip_kc(setup, turn.amplitude_rad)).significant(3),
        t.count("cycles", "cycles used", |(_, cycles)| **cycles),
        t.number("duration_s", "duration [s]", |((run, _), _)| run.swing.duration_s()).places(1),
    ])
}
