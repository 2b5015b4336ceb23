//! The weight-driven rig on the page: each run as it was reduced, and the first of them with their tracks.

use froude_records::block::{Block, ResultTable, Section, TableBuilder};
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, Mark};

use super::keys::WeightTow;
use super::reduce::Found;
use crate::drawn::{self, first_of, over_time, series};
use crate::log::TankLog;
use crate::observed::reduced::Reduced;
use crate::residual_spectrum::{self, Left};
use crate::steady::page::load_column;
use crate::steady::point::Load;

/// Runs that are drawn; more would be a page of the same.
const DRAWN: usize = 6;

/// A run with its log.
type Shown<'a> = (&'a Reduced<Found>, &'a TankLog);

/// What was done to the runs.
#[must_use]
pub fn section(reduced: &[Reduced<Found>], logs: &[TankLog], spec: &WeightTow) -> Section {
    let log_of = |run: &str| logs.iter().find(|log| log.log.meta.id == run);
    let runs: Vec<Shown<'_>> = reduced.iter().filter_map(|run| Some((run, log_of(&run.point.id)?))).collect();
    let paragraph = format!(
        "The speed of a run is that of the last {} m of its way. Where no moving mass is declared, a run must be shown to change its speed by less than {} there, and the load cell gives its drag; else the drag along the rail is \
         what the weight, less the friction and the inertia of the moving mass, leaves for it, at the speed that the wagon has, if that is {} of its terminal speed or more.",
        number::plain(spec.window_m, 4),
        number::percent(spec.tolerance),
        number::percent(spec.reached)
    );
    let blocks = [Block::words([paragraph]), table(&runs).into(), chart(&runs).into()];
    Section::new("Runs and tracks", blocks.into_iter().chain(spectrum(&runs).map(Block::from)))
}

fn table(runs: &[Shown<'_>]) -> ResultTable {
    let caption = "Each run as it was reduced; in brackets the standard uncertainty by the errors of its track, or by the scatter within its window.";
    let t = TableBuilder::new("runs", caption, runs);
    let mut columns = vec![
        t.text("run", "run", |(run, _)| run.point.id.clone()),
        t.text("configuration", "configuration", |(run, _)| run.point.configuration.clone()),
        t.number("angle_rad", "angle [deg]", |(run, _)| run.point.condition("angle")).plain(4),
        t.uncertain(
            ["speed_m_s", "speed_standard_m_s"],
            "speed [m/s]",
            |(run, _)| run.found.track.speed_m_s,
            |(run, _)| run.found.track.standard_m_s,
        ),
        t.number("change", "change over the window [%]", |(run, _)| run.found.track.change[0]).places(1),
        t.text("", "fraction of terminal speed", |(run, _)| {
            run.found.reached().map_or_else(|| "steady".to_owned(), number::percent)
        }),
        t.number("reached", "", |(run, _)| run.found.reached()),
    ];
    let loads = runs.first().map_or(&[] as &[_], |(run, _)| &run.observation.loads);
    let column = |(k, load): (usize, &Load)| {
        load_column(&t, &load.name, move |(run, _): &Shown<'_>| run.observation.loads.get(k))
    };
    columns.extend(loads.iter().enumerate().map(column));
    t.build(columns)
}

fn chart(runs: &[Shown<'_>]) -> Chart {
    let panel = |(run, log): &Shown<'_>| {
        let (time_s, position, window) = (&log.log.time_s, &run.found.position_m, run.found.track.window.clone());
        let track = series("track", Mark::Points, &time_s[..], &position[..]);
        let last = series("last part of the way", Mark::Line, &time_s[window.clone()], &position[window]);
        drawn::panel(format!("{} [m]", run.point.id), vec![track, last])
    };
    let panels: Vec<ChartPanel> = runs.iter().take(DRAWN).map(panel).collect();
    let of = first_of(panels.len(), runs.len());
    let caption = format!("Position along the rail in {of}the runs, and the part that the speed is taken over.");
    over_time(["tracks", "Tracks"], caption, panels)
}

/// What the parabola leaves of the tracks.
fn spectrum(runs: &[Shown<'_>]) -> Option<Chart> {
    let left = runs
        .iter()
        .map(|(run, log)| Left::of(&log.log.time_s[run.found.track.window.clone()], run.found.track.left_m.clone()));
    residual_spectrum::chart(
        &left.collect::<Vec<_>>(),
        ("position about the parabola over the last part of the way", "m"),
        "Flat is the noise of the pixels; a line is a camera or a wagon that shakes; a rise towards low frequencies is a track whose errors are correlated, or a speed that a parabola does not follow.",
    )
}
