//! The weight-driven rig on the page: each run as it was reduced, and the first of them with their tracks.

use froude_records::block::{Block, ResultTable, Section, TableBuilder};
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, Mark};

use super::reduce::Reduced;
use super::section::WeightTowSpec;
use crate::drawn::{self, first_of, over_time, series};
use crate::log::TankLog;
use crate::residual_spectrum::{self, Left};
use crate::steady::page::load_column;
use crate::steady::point::Load;
use crate::steady::row::Row;

/// Runs that are drawn; more would be a page of the same.
const DRAWN: usize = 6;

/// What was done to the runs.
#[must_use]
pub fn section(
    rows: &[Row],
    reduced: &[Reduced],
    logs: &[TankLog],
    positions: &[Vec<f64>],
    spec: &WeightTowSpec,
) -> Section {
    let paragraph = format!(
        "The speed of a run is that of the last {} m of its way. Where no moving mass is declared, a run must be shown to change its speed by less than {} there, and the load cell gives its drag; else the drag along the rail is \
         what the weight, less the friction and the inertia of the moving mass, leaves for it, at the speed that the wagon has, if that is {} of its terminal speed or more.",
        number::plain(spec.window_m, 4),
        number::percent(spec.tolerance),
        number::percent(spec.reached)
    );
    let blocks = [Block::words([paragraph]), table(rows, reduced).into(), chart(rows, reduced, logs, positions).into()];
    Section::new("Runs and tracks", blocks.into_iter().chain(spectrum(rows, reduced, logs).map(Block::from)))
}

fn table(rows: &[Row], reduced: &[Reduced]) -> ResultTable {
    let both: Vec<_> = rows.iter().zip(reduced).collect();
    let caption = "Each run as it was reduced; in brackets the standard uncertainty by the errors of its track, or by the scatter within its window.";
    let t = TableBuilder::new("runs", caption, &both);
    let mut columns = vec![
        t.text("run", "run", |(row, _)| row.run.clone()),
        t.text("configuration", "configuration", |(row, _)| row.configuration.clone()),
        t.number("angle_rad", "angle [deg]", |(row, _)| row.angle_rad).plain(4),
        t.uncertain(
            ["speed_m_s", "speed_standard_m_s"],
            "speed [m/s]",
            |(_, found)| found.track.speed_m_s,
            |(_, found)| found.track.standard_m_s,
        ),
        t.number("change", "change over the window [%]", |(_, found)| found.track.change[0]).places(1),
        t.text("", "fraction of terminal speed", |(_, found)| {
            found.reached().map_or_else(|| "steady".to_owned(), number::percent)
        }),
        t.number("reached", "", |(_, found)| found.reached()),
    ];
    let loads = rows.first().map_or(&[] as &[_], |row| &row.point.loads);
    let column = |(k, load): (usize, &Load)| load_column(&t, &load.name, |(row, _)| row.point.loads.get(k));
    columns.extend(loads.iter().enumerate().map(column));
    t.build(columns)
}

fn chart(rows: &[Row], reduced: &[Reduced], logs: &[TankLog], positions: &[Vec<f64>]) -> Chart {
    let panel = |(row, found): (&Row, &Reduced)| {
        let at = logs.iter().position(|log| log.log.meta.id == row.run)?;
        let (time_s, position) = (&logs[at].log.time_s, &positions[at]);
        let window = found.track.window.clone();
        let track = series("track", Mark::Points, &time_s[..], &position[..]);
        let last = series("last part of the way", Mark::Line, &time_s[window.clone()], &position[window]);
        Some(drawn::panel(format!("{} [m]", row.run), vec![track, last]))
    };
    let panels: Vec<ChartPanel> = rows.iter().zip(reduced).take(DRAWN).filter_map(panel).collect();
    let of = first_of(panels.len(), rows.len());
    let caption = format!("Position along the rail in {of}the runs, and the part that the speed is taken over.");
    over_time(["tracks", "Tracks"], caption, panels)
}

/// What the parabola leaves of the tracks.
fn spectrum(rows: &[Row], reduced: &[Reduced], logs: &[TankLog]) -> Option<Chart> {
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
