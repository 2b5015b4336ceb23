//! The plan of a forced oscillation: run matrix, time in the tank, and the intervals to expect.

use std::f64::consts::TAU;

use froude_hydro::similarity::keulegan_carpenter;
use froude_identify::method::{MethodError, Prospect};
use froude_records::block::{ResultTable, TableBuilder};
use froude_records::campaign::{Campaign, Source};

use super::forces::Drag;
use super::forecast::forecast;
use super::section;
use super::setup::{Setup, declared, setup_of};
use super::simulate::senses;
use super::simulate::{Planned, Truths, configurations, planned};
use crate::plan;
use crate::sensors::seed_and_sensors;

/// What the plan of a source takes and determines.
///
/// # Errors
///
/// What the campaign does not declare, runs too short for their cycles, coefficients that the plan does not determine.
pub fn prospect(campaign: &Campaign, source: &Source) -> Result<Prospect, MethodError> {
    let (spec, blocks) = (declared(source)?, section::plan(source)?);
    let setup = setup_of(campaign, source, &spec, &configurations(&blocks))?;
    let truth = Truths::of(campaign, source, &setup)?;
    let planned = planned(&blocks, &setup);
    let (_, sensors) = seed_and_sensors(campaign, &senses())?;
    // Another law than the true one is off by what it lacks, which no linearisation forecasts.
    let drag = Drag::new(truth.law.clone()).map_err(MethodError::refused)?;
    let found = forecast(&planned, &setup, &truth, &drag, sensors, &campaign.identify).map_err(MethodError::refused)?;
    let duration_s = planned.iter().map(|run| run.swing.duration_s()).sum();
    let paragraph = plan::of_joint_fit(planned.len(), duration_s, "configuration");
    let law = format!(", with the drag law {} of [simulate]", drag.law.name);
    let tables = [matrix(&planned, &found.cycles, &setup, campaign), plan::intervals(&found.expected, &law)];
    Ok(plan::prospect(source, (planned.len(), duration_s), tables, vec![paragraph]))
}

fn matrix(planned: &[Planned], cycles: &[usize], setup: &Setup, campaign: &Campaign) -> ResultTable {
    let height_m = campaign.body.as_ref().and_then(|b| b.link).map(|link| 2.0 * link.major_semi_axis_m);
    let speed_m_s = |run: &Planned| setup.radius_m.value.abs() * run.swing.amplitude_rad * run.swing.omega_rad_s;
    let rows: Vec<_> = planned.iter().zip(cycles).map(|(run, cycles)| (run, speed_m_s(run), cycles)).collect();
    let kc = |run: &Planned, speed| height_m.map(|h| keulegan_carpenter(speed, TAU / run.swing.omega_rad_s, h));
    let t = TableBuilder::new("matrix", "Run matrix.", &rows);
    t.build(vec![
        t.text("run", "run", |(run, ..)| run.id.clone()),
        t.text("configuration", "configuration", |(run, ..)| setup.bodies[run.body].name.clone()),
        t.number("flow_m_s", "stream [m/s]", |(run, ..)| run.flow_m_s).significant(3),
        t.number("amplitude_rad", "amplitude [deg]", |(run, ..)| run.swing.amplitude_rad).plain(4),
        t.number("omega_rad_s", "ω [deg/s]", |(run, ..)| run.swing.omega_rad_s).plain(4),
        t.number("frequency_hz", "frequency [Hz]", |(run, ..)| run.swing.omega_rad_s / TAU).plain(4),
        t.number("speed_m_s", "speed amplitude [m/s]", |(_, speed, _)| *speed).significant(3),
        t.number("acceleration_m_s2", "acceleration amplitude [m/s²]", |(run, speed, _)| {
            speed * run.swing.omega_rad_s
        })
        .significant(3),
        t.number("kc", "KC [1]", |(run, speed, _)| kc(run, *speed)).significant(3),
        t.count("cycles", "cycles used", |(.., cycles)| **cycles),
        t.number("duration_s", "duration [s]", |(run, ..)| run.swing.duration_s()).places(1),
    ])
}
