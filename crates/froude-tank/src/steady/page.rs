//! Steady tows on the page: each run as it was reduced, and the first of them with their windows.

use froude_records::number;
use froude_records::page::{Chart, ChartPanel, DocumentSection, Mark, Series, TextTable};
use froude_records::run::ImportedRun;
use froude_records::steady::SteadySpec;

use super::row::Row;
use crate::residual_spectrum::{self, Left};

/// Runs that are drawn; more would be a page of the same.
const DRAWN: usize = 6;

/// What was done to the runs.
#[must_use]
pub fn section(logs: &[ImportedRun], rows: &[Row], spec: &SteadySpec) -> DocumentSection {
    let paragraph = format!(
        "The steady window of a run is the longest stretch whose blocks of {} s have speeds within ± {} of the middle of their range, without the first {} s and, where \
         the log goes on, its last block. Means are tapered at both ends and count the correlation of their samples; the zero is the straight line between the means at rest before and after.",
        number::plain(spec.block_s, 4),
        number::percent(spec.tolerance),
        number::plain(spec.settle_s, 4)
    );
    DocumentSection {
        title: "Runs and windows".to_owned(),
        paragraphs: vec![paragraph],
        tables: vec![table(logs, rows)],
        charts: std::iter::once(chart(logs, rows)).chain(spectra(logs, rows)).collect(),
    }
}

fn log_of<'a>(logs: &'a [ImportedRun], row: &Row) -> Option<&'a ImportedRun> {
    logs.iter().find(|log| log.log.meta.id == row.run)
}

fn table(logs: &[ImportedRun], rows: &[Row]) -> TextTable {
    let Some(Row { point: first, .. }) = rows.first() else { return TextTable::default() };
    let head = ["run", "configuration", "angle [deg]", "window [s]", "speed [m/s]", "scatter of the speed [m/s]"];
    let mut head: Vec<String> = head.map(str::to_owned).to_vec();
    for load in &first.loads {
        let unit = unit_of(&load.name);
        head.push(format!("{} [{unit}]", load.name));
        head.push(format!("correlation of {} [s]", load.name));
        head.push(format!("zero of {} [{unit}]", load.name));
    }
    let cells = rows.iter().map(|row| {
        let point = &row.point;
        let at =
            |sample: usize| log_of(logs, row).map_or_else(String::new, |log| number::fixed(log.log.time_s[sample], 2));
        let mut out = vec![
            row.run.clone(),
            row.configuration.clone(),
            number::plain(row.angle_rad.to_degrees(), 4),
            format!("{} to {}", at(point.window.steady.start), at(point.window.steady.end - 1)),
            number::plain(point.speed_m_s, 5),
            number::significant(point.speed_scatter_m_s, 2),
        ];
        for load in &point.loads {
            out.push(number::short_form(load.value, load.standard));
            out.push(number::significant(load.read.correlation_s, 2));
            out.push(number::plain(load.zero, 4));
        }
        out
    });
    TextTable {
        caption: "Each run as it was reduced; standard uncertainty from the scatter within the run in brackets."
            .to_owned(),
        head,
        rows: cells.collect(),
    }
}

fn chart(logs: &[ImportedRun], rows: &[Row]) -> Chart {
    let panel = |row: &Row| {
        let (point, log) = (&row.point, &log_of(logs, row)?.log);
        let load = point.loads.first()?;
        let values = log.channels.get(&load.name).map_or(&[] as &[f64], |c| c.values.as_slice());
        let window = &point.window;
        let line = |name: &str, rows: &std::ops::Range<usize>, y: f64| Series {
            name: name.to_owned(),
            mark: Mark::Line,
            x: vec![log.time_s[rows.start], log.time_s[rows.end - 1]],
            y: vec![y; 2],
            ..Series::default()
        };
        let mean = |rows: &std::ops::Range<usize>| values[rows.clone()].iter().sum::<f64>() / rows.len() as f64;
        let mut series = vec![Series {
            name: "as read".to_owned(),
            mark: Mark::Points,
            x: log.time_s.clone(),
            y: values.to_vec(),
            ..Series::default()
        }];
        series.push(line("window", &window.steady, load.read.value));
        let at_rest = [&window.before, &window.after].into_iter().filter(|rows| rows.len() > 1);
        series.extend(at_rest.map(|rows| line("at rest", rows, mean(rows))));
        let unit = unit_of(&load.name);
        Some(ChartPanel { y_label: format!("{} of {} [{unit}]", load.name, row.run), series, ..ChartPanel::default() })
    };
    let panels: Vec<ChartPanel> = rows.iter().take(DRAWN).filter_map(panel).collect();
    let of = if panels.len() < rows.len() { format!("the first {} of ", panels.len()) } else { String::new() };
    Chart {
        name: "windows".to_owned(),
        title: "Load and windows".to_owned(),
        caption: format!(
            "The first load in {of}the runs as it was read, its steady window with its mean, and the parts at rest."
        ),
        x_label: "time [s]".to_owned(),
        panels,
        ..Chart::default()
    }
}

/// What the mean leaves of each load in the windows.
fn spectra(logs: &[ImportedRun], rows: &[Row]) -> Vec<Chart> {
    let loads = rows.first().map_or(&[] as &[_], |row| row.point.loads.as_slice());
    let chart = |load: &super::point::Load| {
        let left = rows.iter().filter_map(|row| {
            let (log, window) = (&log_of(logs, row)?.log, row.point.window.steady.clone());
            Some(Left::of(&log.time_s[window.clone()], log.channels.get(&load.name)?.values[window].to_vec()))
        });
        let found = residual_spectrum::chart(
            &left.collect::<Vec<_>>(),
            (&format!("{} about its mean over the steady window", load.name), unit_of(&load.name)),
            "A line is a vibration of the rig or the shedding of vortices; a rise towards low frequencies is noise that is correlated, which the standard uncertainty of the mean counts.",
        )?;
        Some(Chart {
            name: format!("residual-spectrum-{}", load.name.replace('_', "-")),
            title: format!("{} of {}", found.title, load.name),
            ..found
        })
    };
    loads.iter().filter_map(chart).collect()
}

fn unit_of(load: &str) -> &'static str {
    if load.starts_with('m') { "N m" } else { "N" }
}
