//! The weight-driven rig on the page: each run as it was reduced, and the first of them with their tracks.

use froude_records::number;
use froude_records::page::{Chart, ChartPanel, DocumentSection, Mark, Series, TextTable};
use froude_records::run::ImportedRun;
use froude_records::weight_tow::WeightTowSpec;

use super::reduce::Reduced;
use crate::residual_spectrum::{self, Left};
use crate::steady::row::Row;

/// Runs that are drawn; more would be a page of the same.
const DRAWN: usize = 6;

/// What was done to the runs.
#[must_use]
pub fn section(
    rows: &[Row],
    reduced: &[Reduced],
    logs: &[ImportedRun],
    positions: &[Vec<f64>],
    spec: &WeightTowSpec,
) -> DocumentSection {
    let paragraph = format!(
        "The speed of a run is that of the last {} m of its way. Where no moving mass is declared, a run must be shown to change its speed by less than {} there, and the load cell gives its drag; else the drag along the rail is \
         what the weight, less the friction and the inertia of the moving mass, leaves for it, at the speed that the wagon has, if that is {} of its terminal speed or more.",
        number::plain(spec.window_m, 4),
        number::percent(spec.tolerance),
        number::percent(spec.reached)
    );
    DocumentSection {
        title: "Runs and tracks".to_owned(),
        paragraphs: vec![paragraph],
        tables: vec![table(rows, reduced)],
        charts: std::iter::once(chart(rows, reduced, logs, positions)).chain(spectrum(rows, reduced, logs)).collect(),
    }
}

fn table(rows: &[Row], reduced: &[Reduced]) -> TextTable {
    let mut head: Vec<String> =
        ["run", "configuration", "angle [deg]", "speed [m/s]", "change over the window [%]", "reached"]
            .map(str::to_owned)
            .to_vec();
    for load in rows.first().map_or(&[] as &[_], |row| &row.point.loads) {
        head.push(format!("{} [N]", load.name));
    }
    let cells = rows.iter().zip(reduced).map(|(row, found)| {
        let mut out = vec![
            row.run.clone(),
            row.configuration.clone(),
            number::plain(row.angle_rad.to_degrees(), 4),
            number::short_form(found.track.speed_m_s, found.track.standard_m_s),
            number::fixed(1e2 * found.track.change[0], 1),
            found
                .balance
                .map_or_else(|| "steady".to_owned(), |b| number::percent(found.track.speed_m_s / b.terminal_m_s)),
        ];
        out.extend(row.point.loads.iter().map(|load| number::short_form(load.value, load.standard)));
        out
    });
    TextTable {
        caption: "Each run as it was reduced; in brackets the standard uncertainty by the errors of its track, or by the scatter within its window.".to_owned(),
        head,
        rows: cells.collect(),
    }
}

fn chart(rows: &[Row], reduced: &[Reduced], logs: &[ImportedRun], positions: &[Vec<f64>]) -> Chart {
    let panel = |(row, found): (&Row, &Reduced)| {
        let at = logs.iter().position(|log| log.log.meta.id == row.run)?;
        let (time_s, position) = (&logs[at].log.time_s, &positions[at]);
        let series = |name: &str, mark: Mark, range: std::ops::Range<usize>| Series {
            name: name.to_owned(),
            mark,
            x: time_s[range.clone()].to_vec(),
            y: position[range].to_vec(),
            ..Series::default()
        };
        Some(ChartPanel {
            y_label: format!("{} [m]", row.run),
            series: vec![
                series("track", Mark::Points, 0..position.len()),
                series("last part of the way", Mark::Line, found.track.window.clone()),
            ],
            ..ChartPanel::default()
        })
    };
    let panels: Vec<ChartPanel> = rows.iter().zip(reduced).take(DRAWN).filter_map(panel).collect();
    let of = if panels.len() < rows.len() { format!("the first {} of ", panels.len()) } else { String::new() };
    Chart {
        name: "tracks".to_owned(),
        title: "Tracks".to_owned(),
        caption: format!("Position along the rail in {of}the runs, and the part that the speed is taken over."),
        x_label: "time [s]".to_owned(),
        panels,
        ..Chart::default()
    }
}

/// What the parabola leaves of the tracks.
fn spectrum(rows: &[Row], reduced: &[Reduced], logs: &[ImportedRun]) -> Option<Chart> {
    let left = rows.iter().zip(reduced).filter_map(|(row, found)| {
        let log = logs.iter().find(|log| log.log.meta.id == row.run)?;
        let window = found.track.window.clone();
        Some(Left::of(&log.log.time_s[window], found.track.left_m.clone()))
    });
    residual_spectrum::chart(
        &left.collect::<Vec<_>>(),
        ("position about the parabola over the last part of the way", "m"),
        "Flat is the noise of the pixels; a line is a camera or a wagon that shakes; a rise towards low frequencies is a track whose errors are correlated, or a speed that a parabola does not follow.",
    )
}
