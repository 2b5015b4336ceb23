//! Residuals: against the fitted load, against the abscissa, against normal quantiles.

use std::collections::BTreeMap;

use froude_records::page::{Point, SourceSection};

use crate::canvas::{Align, Canvas, Ink, shortened};
use crate::figures::drawing::{Drawing, MOST_NAMED, MOST_POINTS, drawn_by_chance, evenly, recommended, thinned};
use crate::plot::{
    ACCENT, AXIS, Entry, LABEL_SIZE, Panel, Span, Swatch, TEXT, WIDTH, draw_legend, drawable, legend_height, level_ink,
};
use crate::statistics::{mean_and_deviation, normal_quantile};
use crate::symbol::{Rich, symbol_and_unit};
use crate::tables::distinct;

/// Components in one residual figure: three rows of three panels.
const RESIDUAL_ROWS: usize = 3;

pub(super) fn residual_drawings(section: &SourceSection) -> Vec<Drawing> {
    let usable: Vec<&Point> = section.points.iter().filter(|p| drawable(p.measured) && drawable(p.fitted)).collect();
    let components = distinct(usable.iter().map(|p| p.of.component.as_str()));
    let configurations = distinct(usable.iter().map(|p| p.of.configuration.as_str()));
    let n_figures = components.len().div_ceil(RESIDUAL_ROWS);
    components
        .chunks(RESIDUAL_ROWS)
        .enumerate()
        .map(|(i, chunk)| {
            let part = if n_figures > 1 { format!(" ({} of {n_figures})", i + 1) } else { String::new() };
            draw_residuals(section, &usable, chunk, &configurations, &part)
        })
        .collect()
}

/// Left edge of the first panel, and what lies between two of them.
const LEFT: f64 = 66.0;
const GAP: f64 = 20.0;
/// Above a row of panels, their height, and what their axis takes below.
const HEAD: f64 = 14.0;
const HEIGHT: f64 = 190.0;
const FOOT: f64 = 46.0;

fn draw_residuals(
    section: &SourceSection,
    points: &[&Point],
    components: &[&str],
    configurations: &[&str],
    part: &str,
) -> Drawing {
    let legend = legend(configurations);
    let legend_tall = legend_height(&legend, LEFT);
    let mut canvas = Canvas::new(WIDTH, legend_tall + components.len() as f64 * (HEAD + HEIGHT + FOOT));
    draw_legend(&mut canvas, &legend, LEFT, 0.0);
    let rank: BTreeMap<&str, usize> = configurations.iter().enumerate().map(|(i, c)| (*c, i)).collect();
    let ink_of = |p: &Point| match configurations.len() {
        0 | 1 => ACCENT,
        n => level_ink(rank.get(p.of.configuration.as_str()).copied().unwrap_or(0), n),
    };
    let mut is_thinned = false;
    for (row, component) in components.iter().enumerate() {
        let mine: Vec<&Point> = points.iter().copied().filter(|p| p.of.component == *component).collect();
        let top = legend_tall + row as f64 * (HEAD + HEIGHT + FOOT) + HEAD;
        draw_row(&mut canvas, top, component, &mine, &ink_of);
        is_thinned |= mine.len() > MOST_POINTS;
    }
    let model = recommended(section).map_or_else(String::new, |e| format!(" of model {}", e.law.name));
    let mut caption = format!(
        "Residuals{model} (measured − fitted), {}{part}: against the fitted load, against speed, angle or time, \
         and ordered against normal quantiles (line: normal distribution with the residuals' mean and standard deviation).",
        section.name
    );
    if is_thinned {
        caption.push_str(" Points are thinned evenly.");
    }
    caption.push_str(&drawn_by_chance(section));
    Drawing {
        slug: format!("{}-residuals", section.name),
        title: format!("{}: residuals{part}", section.name),
        caption,
        canvas,
    }
}

/// The configurations by ink, evenly chosen where they are many; nothing where there is but one.
fn legend(configurations: &[&str]) -> Vec<Entry> {
    if configurations.len() < 2 {
        return Vec::new();
    }
    evenly(configurations, MOST_NAMED + 1)
        .into_iter()
        .map(|c| Entry {
            swatch: Swatch::Dot,
            ink: level_ink(configurations.iter().position(|x| *x == c).unwrap_or(0), configurations.len()),
            text: Rich::plain(&shortened(if c.is_empty() { "(no configuration)" } else { c }, 24)),
        })
        .collect()
}

const fn residual(p: &Point) -> f64 {
    p.measured - p.fitted
}

/// The three panels of a load, side by side.
fn draw_row(canvas: &mut Canvas, top: f64, component: &str, mine: &[&Point], ink_of: &dyn Fn(&Point) -> Ink) {
    let Some(y) = Span::of(mine.iter().map(|p| residual(p))) else { return };
    let largest = y.low.abs().max(y.high.abs());
    let y = Span { low: -largest, high: largest }.aired(0.08);
    let y_ticks = y.ticks(4);
    let unit = mine.first().map_or("", |p| p.of.unit.as_str());
    let width = (WIDTH - LEFT - 12.0 - 2.0 * GAP) / 3.0;
    for (column, (places, title)) in abscissae(component, unit, mine).into_iter().enumerate() {
        let x = Span::of(places.iter().map(|p| p.0)).unwrap_or(Span { low: 0.0, high: 0.0 }).aired(0.05);
        let left = LEFT + column as f64 * (width + GAP);
        let panel = Panel { left, top, width, height: HEIGHT, x, y };
        let x_ticks = x.ticks(4);
        panel.axes(canvas, Some(&x_ticks), (column == 0).then_some(&y_ticks), (&x_ticks, &y_ticks));
        if column == 2 {
            let (mean, deviation) = mean_and_deviation(mine.iter().map(|p| residual(p)));
            let quantiles: Vec<f64> = (0..=60).map(|i| x.low + x.width() * f64::from(i) / 60.0).collect();
            let normal: Vec<f64> = quantiles.iter().map(|z| mean + deviation * z).collect();
            for stroke in panel.strokes(&quantiles, &normal) {
                canvas.path(&stroke, AXIS, 1.2);
            }
        }
        for (x, p) in places {
            if let Some(at) = panel.at(x, residual(p)) {
                canvas.speck(at, if mine.len() > 300 { 1.7 } else { 2.4 }, ink_of(p).faint(0.75));
            }
        }
        let below = (panel.left + panel.width / 2.0, panel.bottom() + 34.0);
        canvas.text(&x_ticks.titled(title), below, LABEL_SIZE, TEXT, Align::Center);
        if column == 0 {
            let title = y_ticks.titled(Rich::plain("Residual ").then(symbol_and_unit(component, unit)));
            canvas.upward_text(&title, (12.0, panel.top + panel.height / 2.0), LABEL_SIZE, TEXT);
        }
    }
}

/// What residuals are drawn against, with its title: the fitted load, the speed (or what stands for it where there is but one), normal quantiles.
fn abscissae<'a>(component: &str, unit: &str, mine: &[&'a Point]) -> [(Vec<(f64, &'a Point)>, Rich); 3] {
    let drawn = thinned(mine, MOST_POINTS);
    let fitted = drawn.iter().map(|p| (p.fitted, *p)).collect();
    let is_one_speed = Span::of(drawn.iter().map(|p| p.speed_m_s)).is_none_or(|s| s.width() < 1e-9);
    let motion = if is_one_speed && drawn.iter().all(|p| p.of.other.is_some()) {
        let name = drawn.iter().find_map(|p| p.of.other.as_ref());
        let places = drawn.iter().map(|p| (p.other, *p)).collect();
        (places, name.map_or_else(Rich::default, |[quantity, unit]| symbol_and_unit(quantity, unit)))
    } else {
        (drawn.iter().map(|p| (p.speed_m_s, *p)).collect(), Rich::plain("Speed [m/s]"))
    };
    let mut sorted = mine.to_vec();
    sorted.sort_by(|a, b| residual(a).total_cmp(&residual(b)));
    let n = sorted.len() as f64;
    let ranked: Vec<(f64, &Point)> =
        sorted.iter().enumerate().map(|(i, p)| (normal_quantile((i as f64 + 0.625) / (n + 0.25)), *p)).collect();
    [
        (fitted, Rich::plain("Fitted ").then(symbol_and_unit(component, unit))),
        motion,
        (thinned(&ranked, MOST_POINTS), Rich::plain("Normal quantile [1]")),
    ]
}
