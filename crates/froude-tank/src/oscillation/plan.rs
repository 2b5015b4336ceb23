//! The plan of a forced oscillation: run matrix, time in the tank, and the intervals to expect.

use std::f64::consts::TAU;

use froude_hydro::similarity::keulegan_carpenter;
use froude_identify::method::{ExpectedCoefficient, MethodError, Prospect};
use froude_records::block::summary;
use froude_records::campaign::{Campaign, Source};
use froude_records::number;
use froude_records::page::{DocumentSection, TextTable};

use super::forces::Drag;
use super::forecast::forecast;
use super::setup::Setup;
use super::simulate::senses;
use super::simulate::{Planned, Truths, configurations, planned};
use super::source::{declared, setup_of};
use crate::joint::page::{expected as expected_table, minutes};
use crate::sensors::seed_and_sensors;

/// What the plan of a source takes and determines.
///
/// # Errors
///
/// What the campaign does not declare, runs too short for their cycles, coefficients that the plan does not determine.
pub fn prospect(campaign: &Campaign, source: &Source) -> Result<Prospect, MethodError> {
    let spec = declared(source)?;
    let setup = setup_of(campaign, source, spec, &configurations(source))?;
    let truth = Truths::of(campaign, source, &setup)?;
    let planned = planned(source, &setup);
    let (_, sensors) = seed_and_sensors(campaign, &senses())?;
    // Another law than the true one is off by what it lacks, which no linearisation forecasts.
    let drag = Drag::new(truth.law.clone()).map_err(MethodError::refused)?;
    let law = drag.law.name.clone();
    let found = forecast(&planned, &setup, &truth, &drag, sensors, &campaign.identify).map_err(MethodError::refused)?;
    let expected = found.expected.iter().map(|e| ExpectedCoefficient {
        model: law.clone(),
        name: e.name.clone(),
        unit: e.unit.clone(),
        value: e.value,
        standard_uncertainty: e.combined.standard,
        half_width_95: e.combined.arms[1],
    });
    let (expected, tables) = (
        expected.collect(),
        vec![
            runs(&planned, &found.cycles, &setup, campaign),
            expected_table(&found.expected, &found.parts, &format!(", with the drag law {law} of [simulate]")),
        ],
    );
    let duration_s = planned.iter().map(duration_s).sum();
    let section = summary(DocumentSection {
        title: format!("Plan of {}", source.name),
        paragraphs: vec![format!(
            "{} of {} in all on the log, waits between them and changes of configuration not counted. The intervals are those of the linearised joint fit at the true coefficients of \
             [simulate], with the noise of [[simulate.sensor]] and everything that is declared.",
            froude_records::text::counted(planned.len(), "run", "runs"),
            minutes(duration_s)
        )],
        tables,
        charts: Vec::new(),
    });
    Ok(Prospect { source: source.name.clone(), runs: planned.len(), duration_s, expected, section })
}

fn duration_s(run: &Planned) -> f64 {
    run.swing.still_s + run.swing.periods * TAU / run.swing.omega_rad_s
}

fn runs(planned: &[Planned], cycles: &[usize], setup: &Setup, campaign: &Campaign) -> TextTable {
    let height_m = campaign.body.as_ref().and_then(|b| b.link).map(|link| 2.0 * link.major_semi_axis_m);
    let rows = planned.iter().zip(cycles).map(|(run, cycles)| {
        let (alpha, omega) = (run.swing.amplitude_rad, run.swing.omega_rad_s);
        let speed = setup.radius_m.value.abs() * alpha * omega;
        vec![
            run.id.clone(),
            setup.bodies[run.body].name.clone(),
            number::significant(run.swing.flow_m_s, 3),
            number::plain(alpha.to_degrees(), 4),
            number::plain(omega.to_degrees(), 4),
            number::plain(omega / TAU, 4),
            number::significant(speed, 3),
            number::significant(speed * omega, 3),
            height_m
                .map_or_else(|| "–".to_owned(), |h| number::significant(keulegan_carpenter(speed, TAU / omega, h), 3)),
            cycles.to_string(),
            number::fixed(duration_s(run), 1),
        ]
    });
    TextTable {
        caption: "Run matrix.".to_owned(),
        head: [
            "run",
            "configuration",
            "stream [m/s]",
            "amplitude [deg]",
            "ω [deg/s]",
            "frequency [Hz]",
            "speed amplitude [m/s]",
            "acceleration amplitude [m/s²]",
            "KC [1]",
            "cycles used",
            "duration [s]",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows.collect(),
    }
}
