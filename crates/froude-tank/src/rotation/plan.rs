//! The plan of a rotation: run matrix, time in the tank, and the intervals to expect.

use std::f64::consts::TAU;

use froude_identify::method::{ExpectedCoefficient, MethodError, Prospect};
use froude_records::block::summary;
use froude_records::campaign::{Campaign, Source};
use froude_records::number;
use froude_records::page::{DocumentSection, TextTable};
use froude_rig::rotation::Mounted;

use super::findings::one_rate;
use super::fit::{LAMBDAS, LAW};
use super::forecast::{Forecast, forecast};
use super::setup::Setup;
use super::simulate::senses;
use super::simulate::{Planned, Truths, planned};
use super::source::{declared, setup_of};
use crate::joint::page::{expected, minutes};
use crate::sensors::seed_and_sensors;

/// What the plan of a source takes and determines.
///
/// # Errors
///
/// What the campaign does not declare, runs too short for their cycles, coefficients that the plan does not determine.
pub fn prospect(campaign: &Campaign, source: &Source) -> Result<Prospect, MethodError> {
    let setup = setup_of(campaign, source, declared(source)?)?;
    let truth = Truths::of(campaign, source, &setup)?;
    let planned = planned(source);
    let (_, sensors) = seed_and_sensors(campaign, &senses())?;
    let found = forecast(&planned, &setup, &truth, sensors, &campaign.identify).map_err(MethodError::refused)?;
    let each = found.expected.iter().map(|e| ExpectedCoefficient {
        model: LAW.to_owned(),
        name: e.name.clone(),
        unit: e.unit.clone(),
        value: e.value,
        standard_uncertainty: e.combined.standard,
        half_width_95: e.combined.arms[1],
    });
    let duration_s = planned.iter().map(duration_s).sum();
    let mut paragraphs = vec![format!(
        "{} of {} in all on the log, waits between them and changes of what is mounted not counted. The intervals are those of the linearised joint fit at the true coefficients of \
         [simulate], with the noise of [[simulate.sensor]] and everything that is declared.",
        froude_records::text::counted(planned.len(), "run", "runs"),
        minutes(duration_s)
    )];
    let pairs = [(0, 1), (0, 2), (1, 2)].into_iter().filter_map(|(i, j)| {
        let r = found.correlation(LAMBDAS[i], LAMBDAS[j])?;
        Some(format!("{} with {} {r:.2}", LAMBDAS[i], LAMBDAS[j]))
    });
    let pairs: Vec<String> = pairs.collect();
    if !pairs.is_empty() {
        paragraphs.push(format!("Correlations to expect: {}.", pairs.join(", ")));
    }
    let in_water = planned.iter().filter(|run| run.turn.mounted == Mounted::Body);
    let rates = in_water
        .map(|run| run.turn.amplitude_rad * run.turn.omega_rad_s)
        .fold([f64::INFINITY, 0.0], |[low, high]: [f64; 2], rate| [low.min(rate), high.max(rate)]);
    paragraphs.extend(one_rate(rates, found.correlation(LAMBDAS[1], LAMBDAS[2])).map(|text| format!("Mind: {text}.")));
    let section = summary(DocumentSection {
        title: format!("Plan of {}", source.name),
        paragraphs,
        tables: vec![runs(&planned, &found, &setup), expected(&found.expected, &found.parts, "")],
        charts: Vec::new(),
    });
    Ok(Prospect { source: source.name.clone(), runs: planned.len(), duration_s, expected: each.collect(), section })
}

fn duration_s(run: &Planned) -> f64 {
    run.turn.still_s + run.turn.periods * TAU / run.turn.omega_rad_s
}

fn runs(planned: &[Planned], found: &Forecast, setup: &Setup) -> TextTable {
    let rows = planned.iter().zip(&found.cycles).map(|(run, cycles)| {
        let (alpha, omega) = (run.turn.amplitude_rad, run.turn.omega_rad_s);
        vec![
            run.id.clone(),
            words(run.turn.mounted).to_owned(),
            number::plain(alpha.to_degrees(), 4),
            number::plain(omega.to_degrees(), 4),
            number::plain(omega / TAU, 4),
            number::significant(alpha * omega, 3),
            tip_kc(setup, alpha).map_or_else(|| "–".to_owned(), |kc| number::significant(kc, 3)),
            cycles.to_string(),
            number::fixed(duration_s(run), 1),
        ]
    });
    TextTable {
        caption: "Run matrix.".to_owned(),
        head: [
            "run",
            "mounted",
            "amplitude [deg]",
            "ω [deg/s]",
            "frequency [Hz]",
            "rate amplitude [rad/s]",
            "KC of the tip [1]",
            "cycles used",
            "duration [s]",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows.collect(),
    }
}

/// What is mounted, in words.
#[must_use]
pub fn words(mounted: Mounted) -> &'static str {
    match mounted {
        Mounted::Body => "body",
        Mounted::BodyInAir => "body, in air",
        Mounted::Shaft => "shaft alone",
    }
}

/// Keulegan and Carpenter's number of the end of the link, u T/D = 2π α l/(2a); `None` where no link is declared.
#[must_use]
pub fn tip_kc(setup: &Setup, amplitude_rad: f64) -> Option<f64> {
    setup.link.map(|link| TAU * amplitude_rad * link.half_length_m / (2.0 * link.major_semi_axis_m))
}
