//! An excited response on the page: coefficients over the period, signals with their window and fit, spectrum of what is left, budget.

use froude_records::number;
use froude_records::page::{Chart, ChartPanel, DocumentSection, Mark, Scale, Series, TextTable};
use froude_signal::spectrum::density;

use super::coefficients::{AtPeriod, NAMES, UNITS, Used};
use super::setup::WaveRun;

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
pub fn coefficients(found: &[AtPeriod]) -> DocumentSection {
    let rows = found.iter().flat_map(|at| {
        [0, 1].map(|j| {
            let (value, c) = (at.values[j], at.combined[j]);
            let is_stated = j == 0 || at.is_declared;
            let of = |text: String| if is_stated { text } else { "–".to_owned() };
            vec![
                number::fixed(at.period_s, 3),
                NAMES[j].to_owned(),
                if is_stated { number::short_form(value, c.standard) } else { NONE.to_owned() },
                UNITS[j].to_owned(),
                of(number::interval(c.interval(value))),
                of(number::significant(c.type_a, 2)),
                of(number::significant(c.type_b, 2)),
                of(format!("{} and {}", number::plain(at.halves[0][j], 3), number::plain(at.halves[1][j], 3))),
                of(number::fixed(at.correlation(), 2)),
            ]
        })
    });
    let table = TextTable {
        caption: "Added mass and damping at each period of the wave; standard uncertainty in brackets. The halves are those of the window: where they differ, the start has not decayed or reflections are \
                  back. The correlation is that of the two coefficients of a period."
            .to_owned(),
        head: ["period [s]", "coefficient", "value", "unit", "95 % interval", "type A", "type B", "from the halves", "correlation"]
            .map(str::to_owned)
            .to_vec(),
        rows: rows.collect(),
    };
    let why = "B33 is not determined: B33 only with the declared window before reflections (window in [source.excited_response]).";
    let paragraphs = if found.iter().all(|at| at.is_declared) { Vec::new() } else { vec![why.to_owned()] };
    DocumentSection {
        title: "Results".to_owned(),
        paragraphs,
        tables: vec![table],
        charts: over_period(found).into_iter().collect(),
    }
}

/// Runs and fits.
#[must_use]
pub fn section(found: &[AtPeriod], runs: &[WaveRun<'_>]) -> DocumentSection {
    let paragraph = "Force of the held body and motion of the free one are fitted by harmonics of the wavemaker's own frequency, over whole cycles of the window, and divided by the wavemaker's motion, so that \
                     both runs stand on its clock and for one wave. Then (−ω²(m + A33) + iωB33 + C33) z = F.";
    DocumentSection {
        title: "Runs and fit".to_owned(),
        paragraphs: vec![paragraph.to_owned()],
        tables: vec![table(found, runs), budget(found)],
        charts: std::iter::once(signals(found, runs)).chain(spectrum(found, runs)).collect(),
    }
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
        ChartPanel { y_label: label.to_owned(), series: vec![series], ..ChartPanel::default() }
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

fn table(found: &[AtPeriod], runs: &[WaveRun<'_>]) -> TextTable {
    let rows = found.iter().flat_map(AtPeriod::used).map(|used| {
        let (run, response) = (&runs[used.run], &used.response);
        let relative = (response.variance / response.transfer.norm_sqr()).sqrt();
        vec![
            run.id.to_owned(),
            if run.is_held() { "held" } else { "free" }.to_owned(),
            number::plain(used.wave.period_s(), 5),
            number::plain(1e3 * used.wave.amplitude, 4),
            number::plain(used.wave.start_s, 4),
            response.cycles.to_string(),
            format!("{} {}", number::significant(response.amplitude, 4), run.shows.unit()),
            number::plain(response.transfer.im.atan2(response.transfer.re).to_degrees(), 4),
            number::percent(relative),
        ]
    });
    TextTable {
        caption: "Each run as it was used: amplitude and phase of force or motion at the wave's frequency, the phase before the wavemaker's; the scatter is that of one component, from the lines beside the \
                  wave's frequency."
            .to_owned(),
        head: [
            "run",
            "body",
            "period found [s]",
            "stroke [mm]",
            "start [s]",
            "cycles used",
            "amplitude",
            "phase [deg]",
            "scatter",
        ]
        .map(str::to_owned)
        .to_vec(),
        rows: rows.collect(),
    }
}

/// What costs what, by period.
fn budget(found: &[AtPeriod]) -> TextTable {
    let rows = found.iter().flat_map(|at| {
        let cells = |name: String, a: f64, b: f64| {
            let damping = if at.is_declared { number::significant(b, 2) } else { "–".to_owned() };
            vec![number::fixed(at.period_s, 3), name, number::significant(a, 2), damping]
        };
        let parts =
            at.parts.iter().map(move |p| cells(format!("{} ({})", p.name, p.kind), p.standard(0), p.standard(1)));
        let combined = cells("combined".to_owned(), at.combined[0].standard, at.combined[1].standard);
        parts.chain([combined]).collect::<Vec<_>>()
    });
    TextTable {
        caption: "Standard uncertainties, by error.".to_owned(),
        head: ["period [s]", "error (type)", "A33 [kg]", "B33 [N s/m]"].map(str::to_owned).to_vec(),
        rows: rows.collect(),
    }
}

fn signals(found: &[AtPeriod], runs: &[WaveRun<'_>]) -> Chart {
    let all: Vec<&Used> = found.iter().flat_map(AtPeriod::used).collect();
    let panel = |used: &&Used| {
        let (run, rows) = (&runs[used.run], used.response.rows.clone());
        let start = used.wave.start_s;
        let since: Vec<f64> = run.time_s.iter().map(|t| t - start).collect();
        let every = run.time_s.len().div_ceil(POINTS).max(1);
        let thin = |x: &[f64]| x.iter().step_by(every).copied().collect::<Vec<f64>>();
        let line = |name: &str, mark: Mark, x: Vec<f64>, y: Vec<f64>| Series {
            name: name.to_owned(),
            mark,
            x,
            y,
            ..Series::default()
        };
        let low = run.signal.iter().copied().fold(f64::INFINITY, f64::min);
        let high = run.signal.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let edge = |i: usize| line("window", Mark::Dashed, vec![since[i]; 2], vec![low, high]);
        let body = if run.is_held() { "held" } else { "free" };
        ChartPanel {
            y_label: format!("{}, {body} [{}]", run.id, run.shows.unit()),
            series: vec![
                line("measured", Mark::Line, thin(&since), thin(&run.signal)),
                line("fitted, where used", Mark::Line, since[rows.clone()].to_vec(), used.response.fitted.clone()),
                edge(rows.start),
                edge(rows.end - 1),
            ],
            ..ChartPanel::default()
        }
    };
    let panels: Vec<ChartPanel> = all.iter().take(DRAWN).map(panel).collect();
    let of = if panels.len() < all.len() { format!("the first {} of ", panels.len()) } else { String::new() };
    Chart {
        name: "signals".to_owned(),
        title: "Force and motion, window and fit".to_owned(),
        caption: format!(
            "Force on the held body and motion of the free one in {of}the runs, as measured, with the window, and the fit where it was used."
        ),
        x_label: "time after the wavemaker's start [s]".to_owned(),
        panels,
        ..Chart::default()
    }
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
        let series = Series {
            name: run.id.to_owned(),
            mark: Mark::Line,
            x: frequency[1..].to_vec(),
            y: power[1..].to_vec(),
            ..Series::default()
        };
        Some((run.is_held(), series))
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
