//! The plan of a free decay: run matrix, time, peaks of each release, and the intervals to expect.

use froude_identify::method::{MethodError, Prospect};
use froude_records::block::{ResultTable, TableBuilder};
use froude_records::campaign::{Campaign, Source};
use froude_records::text::counted;

use super::fit::Method;
use super::forecast::{Forecast, forecast, peaks_of};
use super::record::LAW;
use super::releases::{senses, truth_of};
use super::run::DecaySetup;
use super::section::{duration_s, release};
use crate::matrix::Point;
use crate::plan::{self, minutes};
use crate::sensors::seed_and_sensors;

/// What the plan of a source takes and determines.
///
/// # Errors
///
/// What the campaign does not declare, releases with too few peaks, coefficients that they do not determine.
pub fn prospect(
    campaign: &Campaign,
    source: &Source,
    planned: &[Point],
    setup: &DecaySetup,
) -> Result<Prospect, MethodError> {
    let truth = truth_of(campaign, setup.axis)?;
    let (_, sensors) = seed_and_sensors(campaign, &senses(setup.axis))?;
    let found = forecast(planned, setup, truth, sensors).map_err(MethodError::refused)?;
    let duration_s = planned.iter().map(duration_s).sum();
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
    let law = format!(", with the law {LAW} of [simulate]");
    let tables = [matrix(planned, &found, setup), plan::intervals(&found.expected, &law)];
    Ok(plan::prospect(source, (planned.len(), duration_s), tables, paragraphs))
}

fn matrix(planned: &[Point], found: &Forecast, setup: &DecaySetup) -> ResultTable {
    let caption = format!(
        "Run matrix; a peak is the extreme of a half cycle that is further from rest than {} times the noise of a sample.",
        setup.window.smallest_over_noise
    );
    let is_angle = setup.axis.is_rotation();
    let [key, head] = if is_angle { ["from_rad", "released from [deg]"] } else { ["from_m", "released from [m]"] };
    let t = TableBuilder::new("matrix", caption, planned);
    t.build(vec![
        t.text("run", "run", |run| run.id.clone()),
        t.text("configuration", "configuration", |run| run.configuration.clone()),
        t.number(key, head, |run| release(run).displacement).plain(4),
        t.count("peaks", "peaks", |run| peaks_of(found, &run.id)),
        t.number("duration_s", "duration [s]", duration_s).places(1),
    ])
}
