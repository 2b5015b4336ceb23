//! Steady tows on the page: each run as it was reduced, and the first of them with their windows.

use froude_records::block::{Block, ResultColumn, ResultTable, Section, TableBuilder};
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, Mark};

use super::point::Load;
use super::row::Row;
use super::section::SteadySpec;
use crate::drawn::{self, first_of, over_time, series};
use crate::log::TankLog;
use crate::residual_spectrum::{self, Left};

/// Runs that are drawn; more would be a page of the same.
const DRAWN: usize = 6;

/// What was done to the runs.
#[must_use]
pub fn section(logs: &[TankLog], rows: &[Row], spec: &SteadySpec) -> Section {
    let paragraph = format!(
        "The steady window of a run is the longest stretch whose blocks of {} s have speeds within ± {} of the middle of their range, without the first {} s and, where \
         the log goes on, its last block. Means are tapered at both ends and count the correlation of their samples; the zero is the straight line between the means at rest before and after.",
        number::plain(spec.block_s, 4),
        number::percent(spec.tolerance),
        number::plain(spec.settle_s, 4)
    );
    let charts = std::iter::once(chart(logs, rows)).chain(spectra(logs, rows)).map(Block::from);
    Section::new("Runs and windows", [Block::words([paragraph]), table(logs, rows).into()].into_iter().chain(charts))
}

fn log_of<'a>(logs: &'a [TankLog], row: &Row) -> Option<&'a TankLog> {
    logs.iter().find(|log| log.log.meta.id == row.run)
}

fn table(logs: &[TankLog], rows: &[Row]) -> ResultTable {
    let ends = |row: &Row| {
        let (log, window) = (&log_of(logs, row)?.log, &row.point.window.steady);
        Some([log.time_s[window.start], log.time_s[window.end - 1]])
    };
    let window = |[from, to]: [f64; 2]| format!("{} to {}", number::fixed(from, 2), number::fixed(to, 2));
    let caption = "Each run as it was reduced; standard uncertainty from the scatter within the run in brackets.";
    let t = TableBuilder::new("runs", caption, rows);
    let mut columns = vec![
        t.text("run", "run", |row| row.run.clone()),
        t.text("configuration", "configuration", |row| row.configuration.clone()),
        t.number("angle_rad", "angle [deg]", |row| row.angle_rad).plain(4),
        t.text("", "window [s]", |row| ends(row).map(window)),
        t.interval("window_s", "", ends),
        t.number("speed_m_s", "speed [m/s]", |row| row.point.speed_m_s).plain(5),
        t.number("speed_scatter_m_s", "scatter of the speed [m/s]", |row| row.point.speed_scatter_m_s).significant(2),
    ];
    for (k, load) in rows.first().map_or(&[] as &[_], |row| &row.point.loads).iter().enumerate() {
        let (name, unit) = (&load.name, unit_of(&load.name));
        let zero = [format!("{name}_zero_{}", key_of(unit)), format!("zero of {name} [{unit}]")];
        let correlation = [format!("{name}_correlation_s"), format!("correlation of {name} [s]")];
        let correlation_s = |row: &Row| row.point.loads.get(k).map(|load| load.read.correlation_s);
        columns.extend([
            load_column(&t, name, |row| row.point.loads.get(k)),
            t.number(&correlation[0], &correlation[1], correlation_s).significant(2),
            t.number(&zero[0], &zero[1], |row| row.point.loads.get(k).map(|load| load.zero)).plain(4),
        ]);
    }
    t.build(columns)
}

/// A load of each run, with its standard uncertainty.
pub(crate) fn load_column<'r, R>(
    t: &TableBuilder<'r, R>,
    name: &str,
    of: impl Fn(&'r R) -> Option<&'r Load>,
) -> ResultColumn {
    let unit = unit_of(name);
    let keys = ["", "standard_"].map(|what| format!("{name}_{what}{}", key_of(unit)));
    let (value, standard) = (|row| of(row).map(|load| load.value), |row| of(row).map(|load| load.standard));
    t.uncertain([&keys[0], &keys[1]], &format!("{name} [{unit}]"), value, standard)
}

fn chart(logs: &[TankLog], rows: &[Row]) -> Chart {
    let panel = |row: &Row| {
        let (point, log) = (&row.point, &log_of(logs, row)?.log);
        let load = point.loads.first()?;
        let values = log.channels.get(&load.name).map_or(&[] as &[f64], |c| c.values.as_slice());
        let window = &point.window;
        let line = |name: &str, rows: &std::ops::Range<usize>, y: f64| {
            series(name, Mark::Line, [log.time_s[rows.start], log.time_s[rows.end - 1]], [y; 2])
        };
        let mean = |rows: &std::ops::Range<usize>| values[rows.clone()].iter().sum::<f64>() / rows.len() as f64;
        let mut drawn = vec![
            series("as read", Mark::Points, &log.time_s[..], values),
            line("window", &window.steady, load.read.value),
        ];
        let at_rest = [&window.before, &window.after].into_iter().filter(|rows| rows.len() > 1);
        drawn.extend(at_rest.map(|rows| line("at rest", rows, mean(rows))));
        let unit = unit_of(&load.name);
        Some(drawn::panel(format!("{} of {} [{unit}]", load.name, row.run), drawn))
    };
    let panels: Vec<ChartPanel> = rows.iter().take(DRAWN).filter_map(panel).collect();
    let of = first_of(panels.len(), rows.len());
    let caption = format!(
        "The first load in {of}the runs as it was read, its steady window with its mean, and the parts at rest."
    );
    over_time(["windows", "Load and windows"], caption, panels)
}

/// What the mean leaves of each load in the windows.
fn spectra(logs: &[TankLog], rows: &[Row]) -> Vec<Chart> {
    let loads = rows.first().map_or(&[] as &[_], |row| row.point.loads.as_slice());
    let chart = |load: &Load| {
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

/// Of a unit, at the end of a key.
fn key_of(unit: &str) -> String {
    unit.to_lowercase().replace(' ', "_")
}
