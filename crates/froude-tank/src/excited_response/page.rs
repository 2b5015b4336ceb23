//! An excited response on the page: coefficients over the period, signals with their window and fit, spectrum of what is left, budget.

use froude_fit::budget::Part;
use froude_records::block::{Block, ResultTable, Section, TableBuilder};
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, Mark, Scale, Series};
use froude_signal::spectrum::density;

use super::coefficients::{AtPeriod, NAMES, UNITS, Used};
use super::response::Response;
use super::setup::WaveRun;
use super::wave::Wave;
use crate::drawn::{self, first_of, over_time, series};

/// Runs that are drawn; more would be a page of the same.
const DRAWN: usize = 10;
/// Points of a drawn signal.
const POINTS: usize = 3_000;
/// Segments that a run is cut into for its spectrum, at least.
const SEGMENTS: usize = 2;
/// In the place of what is not determined.
const NONE: &str = "not determined";

/// The coefficients of all periods.
#[must_use]
pub fn coefficients(found: &[AtPeriod]) -> Section {
    let rows: Vec<(&AtPeriod, usize)> = found.iter().flat_map(|at| [(at, 0), (at, 1)]).collect();
    let stated = |(at, j): &(&AtPeriod, usize)| {
        (*j == 0 || at.is_declared).then(|| (at.values[*j], at.combined[*j], at.halves.map(|half| half[*j])))
    };
    let caption = "Added mass and damping at each period of the wave; standard uncertainty in brackets. The halves are those of the window: where they differ, the start has not decayed or reflections are \
                   back. The correlation is that of the two coefficients of a period.";
    let t = TableBuilder::new("coefficients", caption, &rows);
    let value =
        |row| stated(row).map_or_else(|| NONE.to_owned(), |(value, c, _)| number::short_form(value, c.standard));
    let halves = |[a, b]: [f64; 2]| format!("{} and {}", number::plain(a, 3), number::plain(b, 3));
    let number = |row| stated(row).map(|(value, ..)| value);
    let standard = |row| stated(row).map(|(_, c, _)| c.standard);
    let table = t.build(vec![
        t.number("period_s", "period [s]", |(at, _)| at.period_s).places(3),
        t.text("coefficient", "coefficient", |(_, j)| NAMES[*j].to_owned()),
        t.text("", "value", value),
        t.uncertain(["value", "standard_uncertainty"], "", number, standard),
        t.text("unit", "unit", |(_, j)| UNITS[*j].to_owned()),
        t.interval("interval_95", "95 % interval", |row| stated(row).map(|(value, c, _)| c.interval(value))),
        t.number("type_a", "type A", |row| stated(row).map(|(_, c, _)| c.type_a)).significant(2),
        t.number("type_b", "type B", |row| stated(row).map(|(_, c, _)| c.type_b)).significant(2),
        t.text("", "from the halves", |row| stated(row).map(|(.., of)| halves(of))),
        t.numbers("from_halves", "", |row| stated(row).map(|(.., halves)| halves.to_vec())),
        t.number("correlation", "correlation", |row| stated(row).map(|_| row.0.correlation())).places(2),
    ]);
    let why = "B33 is not determined: B33 only with the declared window before reflections (window in [source.excited_response]).";
    let said = found.iter().any(|at| !at.is_declared).then(|| why.to_owned());
    let chart = over_period(found).map(Block::from);
    Section::new("Results", [table.into(), Block::words(said)].into_iter().chain(chart))
}

/// Runs and fits.
#[must_use]
pub fn section(found: &[AtPeriod], runs: &[WaveRun<'_>]) -> Section {
    let paragraph = "Force of the held body and motion of the free one are fitted by harmonics of the wavemaker's own frequency, over whole cycles of the window, and divided by the wavemaker's motion, so that \
                     both runs stand on its clock and for one wave. Then (−ω²(m + A33) + iωB33 + C33) z = F.";
    let blocks = [
        Block::words([paragraph.to_owned()]),
        table(found, runs).into(),
        budget(found).into(),
        signals(found, runs).into(),
    ];
    Section::new("Runs and fit", blocks.into_iter().chain(spectrum(found, runs).map(Block::from)))
}

/// A33 and B33 over the period; nothing to draw for one.
fn over_period(found: &[AtPeriod]) -> Option<Chart> {
    let panel = |j: usize| {
        let drawn: Vec<&AtPeriod> = found.iter().filter(|at| j == 0 || at.is_declared).collect();
        let of = |value: &dyn Fn(&AtPeriod) -> f64| drawn.iter().map(|at| value(at)).collect::<Vec<f64>>();
        let series = Series {
            name: "with 95 % interval".to_owned(),
            mark: Mark::Points,
            x: of(&|at| at.period_s),
            y: of(&|at| at.values[j]),
            low: of(&|at| at.combined[j].interval(at.values[j])[0]),
            high: of(&|at| at.combined[j].interval(at.values[j])[1]),
        };
        let label = if j == 0 { "A33 [kg]" } else { "B33 [N s/m]" };
        drawn::panel(label.to_owned(), vec![series])
    };
    let has_damping = found.iter().any(|at| at.is_declared);
    (found.len() > 1).then(|| Chart {
        name: "coefficients".to_owned(),
        title: "Added mass and damping over the period".to_owned(),
        caption: "Added mass and damping in heave at each period of the wave.".to_owned(),
        x_label: "period [s]".to_owned(),
        panels: std::iter::once(panel(0)).chain(has_damping.then(|| panel(1))).collect(),
        ..Chart::default()
    })
}

fn table(found: &[AtPeriod], runs: &[WaveRun<'_>]) -> ResultTable {
    let rows: Vec<(&WaveRun<'_>, &Wave, &Response)> =
        found.iter().flat_map(AtPeriod::used).map(|used| (&runs[used.run], &used.wave, &used.response)).collect();
    let caption = "Each run as it was used: amplitude and phase of force or motion at the wave's frequency, the phase before the wavemaker's; the scatter is that of one component, from the lines beside the \
                   wave's frequency.";
    let t = TableBuilder::new("runs", caption, &rows);
    let amplitude = |(run, _, found): &(&WaveRun<'_>, _, &Response)| {
        format!("{} {}", number::significant(found.amplitude, 4), run.shows.unit())
    };
    t.build(vec![
        t.text("run", "run", |(run, ..)| run.id.to_owned()),
        t.text("body", "body", |(run, ..)| if run.is_held() { "held" } else { "free" }.to_owned()),
        t.number("period_s", "period found [s]", |(_, wave, _)| wave.period_s()).plain(5),
        t.number("stroke_m", "stroke [mm]", |(_, wave, _)| wave.amplitude).plain(4),
        t.number("start_s", "start [s]", |(_, wave, _)| wave.start_s).plain(4),
        t.count("cycles", "cycles used", |(.., found)| found.cycles),
        t.text("", "amplitude", amplitude),
        t.number("amplitude", "", |(.., found)| found.amplitude),
        t.text("unit", "", |(run, ..)| run.shows.unit().to_owned()),
        t.number("phase_rad", "phase [deg]", |(.., found)| found.transfer.im.atan2(found.transfer.re)).plain(4),
        t.number("scatter", "scatter", |(.., found)| (found.variance / found.transfer.norm_sqr()).sqrt()).percent(),
    ])
}

/// What costs what, by period.
fn budget(found: &[AtPeriod]) -> ResultTable {
    let rows = found.iter().flat_map(|at| {
        let by_part = |p: &Part| (at, format!("{} ({})", p.name, p.kind), [p.standard(0), p.standard(1)]);
        let combined = (at, "combined".to_owned(), at.combined.map(|c| c.standard));
        at.parts.iter().map(by_part).chain([combined]).collect::<Vec<_>>()
    });
    let rows: Vec<(&AtPeriod, String, [f64; 2])> = rows.collect();
    let t = TableBuilder::new("budget", "Standard uncertainties, by error.", &rows);
    t.build(vec![
        t.number("period_s", "period [s]", |(at, ..)| at.period_s).places(3),
        t.text("error", "error (type)", |(_, name, _)| name.clone()),
        t.number("A33", "A33 [kg]", |(.., standard)| standard[0]).significant(2),
        t.number("B33", "B33 [N s/m]", |(at, _, standard)| at.is_declared.then_some(standard[1])).significant(2),
    ])
}

fn signals(found: &[AtPeriod], runs: &[WaveRun<'_>]) -> Chart {
    let all: Vec<&Used> = found.iter().flat_map(AtPeriod::used).collect();
    let panel = |used: &&Used| {
        let (run, rows) = (&runs[used.run], used.response.rows.clone());
        let start = used.wave.start_s;
        let since: Vec<f64> = run.time_s.iter().map(|t| t - start).collect();
        let every = run.time_s.len().div_ceil(POINTS).max(1);
        let thin = |x: &[f64]| x.iter().step_by(every).copied().collect::<Vec<f64>>();
        let low = run.signal.iter().copied().fold(f64::INFINITY, f64::min);
        let high = run.signal.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let edge = |i: usize| series("window", Mark::Dashed, [since[i]; 2], [low, high]);
        let body = if run.is_held() { "held" } else { "free" };
        let drawn = vec![
            series("measured", Mark::Line, thin(&since), thin(&run.signal)),
            series("fitted, where used", Mark::Line, &since[rows.clone()], &used.response.fitted[..]),
            edge(rows.start),
            edge(rows.end - 1),
        ];
        drawn::panel(format!("{}, {body} [{}]", run.id, run.shows.unit()), drawn)
    };
    let panels: Vec<ChartPanel> = all.iter().take(DRAWN).map(panel).collect();
    let of = first_of(panels.len(), all.len());
    let caption = format!(
        "Force on the held body and motion of the free one in {of}the runs, as measured, with the window, and the fit where it was used."
    );
    let chart = over_time(["signals", "Force and motion, window and fit"], caption, panels);
    Chart { x_label: "time after the wavemaker's start [s]".to_owned(), ..chart }
}

/// The spectrum of what the fits leave of each run.
fn spectrum(found: &[AtPeriod], runs: &[WaveRun<'_>]) -> Option<Chart> {
    let of = |used: &Used| {
        let (run, rows) = (&runs[used.run], used.response.rows.clone());
        let segment = (rows.len() / SEGMENTS).checked_ilog2().map(|bits| 1_usize << bits).filter(|n| *n >= 16)?;
        let rate_hz = (rows.len() - 1) as f64 / (run.time_s[rows.end - 1] - run.time_s[rows.start]);
        let left: Vec<f64> = run.signal[rows].iter().zip(&used.response.fitted).map(|(x, f)| x - f).collect();
        let (frequency, power) = density(&left, rate_hz, segment).ok()?;
        // The mean was taken off: the first line says nothing.
        Some((run.is_held(), series(run.id, Mark::Line, &frequency[1..], &power[1..])))
    };
    let all: Vec<(bool, Series)> = found.iter().flat_map(AtPeriod::used).take(DRAWN).filter_map(of).collect();
    let panel = |is_held: bool, y_label: &str| ChartPanel {
        y_label: y_label.to_owned(),
        y_scale: Scale::Logarithmic,
        series: all.iter().filter(|(held, _)| *held == is_held).map(|(_, s)| s.clone()).collect(),
    };
    (!all.is_empty()).then(|| Chart {
        name: "residual-spectrum".to_owned(),
        title: "Spectrum of the residuals".to_owned(),
        caption: "Power density of what the fits leave. Power beside the wave's frequency is an amplitude that changes within the window: a start that has not decayed, reflections that come back.".to_owned(),
        x_label: "frequency [Hz]".to_owned(),
        x_scale: Scale::Logarithmic,
        panels: vec![panel(true, "force, held [unit²/Hz]"), panel(false, "motion, free [unit²/Hz]")],
    })
}
