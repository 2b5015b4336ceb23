//! The plan of a free decay: run matrix, time, peaks of each release, and the intervals to expect.

use froude_identify::method::{ExpectedCoefficient, MethodError, Prospect};
use froude_records::block::summary;
use froude_records::campaign::{Campaign, Source};
use froude_records::number;
use froude_records::page::{DocumentSection, TextTable};
use froude_records::text::counted;

use super::fit::Method;
use super::forecast::{Forecast, forecast, peaks_of};
use super::record::LAW;
use super::releases::senses;
use super::releases::{Planned, planned, truth_of};
use super::run::DecaySetup;
use crate::joint::page::{expected as expected_table, minutes};
use crate::sensors::seed_and_sensors;

/// What the plan of a source takes and determines.
///
/// # Errors
///
/// What the campaign does not declare, releases with too few peaks, coefficients that they do not determine.
pub fn prospect(campaign: &Campaign, source: &Source, setup: &DecaySetup) -> Result<Prospect, MethodError> {
    let truth = truth_of(campaign, setup.axis)?;
    let planned = planned(source);
    let (_, sensors) = seed_and_sensors(campaign, &senses(setup.axis))?;
    let found = forecast(&planned, setup, truth, sensors).map_err(MethodError::refused)?;
    let duration_s = planned.iter().map(|run| run.release.held_s + run.release.free_s).sum();
    let expected = found.expected.iter().map(|e| ExpectedCoefficient {
        model: LAW.to_owned(),
        name: e.name.clone(),
        unit: e.unit.clone(),
        value: e.value,
        standard_uncertainty: e.combined.standard,
        half_width_95: e.combined.arms[1],
    });
    let few = planned.iter().filter(|run| peaks_of(&found, &run.id) < Method::Envelope.fewest_peaks()).count();
    let of_envelope = match few {
        0 => String::new(),
        few => format!(
            " {} fewer peaks than the {} that decay_envelope needs.",
            counted(few, "release has", "releases have"),
            Method::Envelope.fewest_peaks()
        ),
    };
    let mut paragraphs = vec![format!(
        "{} of {} in all on the log, waits between them until the water is at rest not counted.{of_envelope} The intervals are those of decay_output_error, linearised at the true \
         coefficients of [simulate], with the noise of [[simulate.sensor]] and everything that is declared.",
        counted(planned.len(), "release", "releases"),
        minutes(duration_s)
    )];
    paragraphs.extend(found.left_out.iter().map(|why| format!("Of no use: {why}.")));
    let section = summary(DocumentSection {
        title: format!("Plan of {}", source.name),
        paragraphs,
        tables: vec![
            runs(&planned, &found, setup),
            expected_table(&found.expected, &found.parts, &format!(", with the law {LAW} of [simulate]")),
        ],
        charts: Vec::new(),
    });
    Ok(Prospect { source: source.name.clone(), runs: planned.len(), duration_s, expected: expected.collect(), section })
}

fn runs(planned: &[Planned], found: &Forecast, setup: &DecaySetup) -> TextTable {
    let is_rotation = setup.axis.is_rotation();
    let rows = planned.iter().map(|run| {
        let from = run.release.displacement;
        vec![
            run.id.clone(),
            run.configuration.clone(),
            number::plain(if is_rotation { from.to_degrees() } else { from }, 4),
            peaks_of(found, &run.id).to_string(),
            number::fixed(run.release.held_s + run.release.free_s, 1),
        ]
    });
    let from = if is_rotation { "released from [deg]" } else { "released from [m]" };
    TextTable {
        caption: format!(
            "Run matrix; a peak is the extreme of a half cycle that is further from rest than {} times the noise of a sample.",
            setup.window.smallest_over_noise
        ),
        head: ["run", "configuration", from, "peaks", "duration [s]"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
    }
}
