//! The forest plot: every source's value of a coefficient, with its interval.
//!
//! Only coefficients of the same model stand side by side: equal names of
//! different models are different things.

use std::fmt::Write as _;

use froude_records::estimate::{Estimate, Status};
use froude_records::number;

use crate::canvas::{Align, Canvas, Ink, shortened, text_width};
use crate::figures::drawing::{Drawing, MOST_ROWS};
use crate::plot::{
    ACCENT, ALERT, AXIS, Entry, LABEL_SIZE, MUTED, Panel, RULE, Span, Swatch, TEXT, TICK_SIZE, Ticks, WIDTH,
    chunk_size, draw_legend, drawable, grid_shape, legend_height,
};
use crate::symbol::{Rich, Style, symbol_and_unit};
use crate::tables::{counted, distinct};
use froude_records::page::Report;

/// Every estimate with the label of its source, fitted ones first.
fn all_estimates(report: &Report) -> Vec<(String, bool, &Estimate)> {
    let fitted = report.sources.iter().flat_map(|s| s.estimates.iter().map(move |e| (s.name.clone(), false, e)));
    let published = report.published.iter().map(|e| {
        let is_taken = report.sources.iter().any(|s| s.name == e.source);
        let label = if is_taken { format!("{} (published)", e.source) } else { e.source.clone() };
        (label, true, e)
    });
    fitted.chain(published).collect()
}

pub(super) fn forest_drawings(report: &Report) -> Vec<Drawing> {
    let all = all_estimates(report);
    let mut drawings = Vec::new();
    for model in distinct(all.iter().map(|(_, _, e)| e.law.name.as_str())) {
        let rows: Vec<&(String, bool, &Estimate)> = all.iter().filter(|(_, _, e)| e.law.name == model).collect();
        // One source alone is beside nothing: its coefficients stand in its own section.
        if distinct(rows.iter().map(|(source, _, _)| source.as_str())).len() < 2 {
            continue;
        }
        let coefficients: Vec<&str> =
            distinct(rows.iter().flat_map(|(_, _, e)| e.coefficients.keys().map(String::as_str)))
                .into_iter()
                .filter(|name| rows.iter().any(|(_, _, e)| mark(name, e).is_some()))
                .collect();
        if coefficients.is_empty() {
            continue;
        }
        let size = chunk_size(coefficients.len());
        let n_figures = coefficients.len().div_ceil(size);
        for (i, chunk) in coefficients.chunks(size).enumerate() {
            let part = if n_figures > 1 { format!(" ({} of {n_figures})", i + 1) } else { String::new() };
            drawings.push(draw_forest(model, chunk, &rows, &part));
        }
    }
    drawings
}

/// How a coefficient is shown in the forest plot.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Mark {
    /// Value with its interval.
    Known(f64, [f64; 2]),
    /// On a bound, with its interval where one is known.
    Bound(f64, Option<[f64; 2]>),
    /// Given by the campaign.
    Fixed(f64),
    /// No interval stated.
    Open(f64),
}

impl Mark {
    fn value(self) -> f64 {
        match self {
            Self::Known(v, _) | Self::Bound(v, _) | Self::Fixed(v) | Self::Open(v) => v,
        }
    }

    fn ends(self) -> Option<[f64; 2]> {
        match self {
            Self::Known(_, ends) => Some(ends),
            Self::Bound(_, ends) => ends,
            _ => None,
        }
    }
}

fn mark(name: &str, estimate: &Estimate) -> Option<Mark> {
    let c = estimate.coefficients.get(name)?;
    let value = number::finite(c.value).filter(|v| drawable(*v))?;
    if matches!(c.status, Status::Undetermined | Status::Excluded) {
        return None;
    }
    // Two standard uncertainties of what one cluster decides are no interval.
    let standard = number::usable(c.standard_uncertainty).filter(|_| !estimate.without_interval().contains(&name));
    let ends = c
        .interval_95
        .or_else(|| standard.map(|u| [value - 2.0 * u, value + 2.0 * u]))
        .filter(|e| drawable(e[0]) && drawable(e[1]) && e[0] <= e[1]);
    Some(match (c.status, ends) {
        (Status::AtBound | Status::BoundContradicted, ends) => Mark::Bound(value, ends),
        (Status::Fixed, None) if estimate.kind != "published" => Mark::Fixed(value),
        (_, Some(ends)) => Mark::Known(value, ends),
        (_, None) => Mark::Open(value),
    })
}

fn draw_forest(model: &str, coefficients: &[&str], rows: &[&(String, bool, &Estimate)], part: &str) -> Drawing {
    let shown: Vec<&(String, bool, &Estimate)> = rows.iter().copied().take(MOST_ROWS).collect();
    let label = |row: &(String, bool, &Estimate)| Rich::plain(&shortened(&row.0, 34));
    let widest = shown.iter().map(|r| text_width(&label(r), LABEL_SIZE)).fold(0.0, f64::max);
    let left = (widest + 18.0).clamp(80.0, 250.0);
    let (columns, n_rows) = grid_shape(coefficients.len());
    let gap = 26.0;
    let pitch = 22.0;
    let (head, foot) = (26.0, 30.0);
    let height = shown.len() as f64 * pitch + 6.0;
    let width = (WIDTH - left - 16.0 - gap * (columns - 1) as f64) / columns as f64;
    let marks: Vec<Vec<Option<Mark>>> =
        coefficients.iter().map(|name| shown.iter().map(|(_, _, e)| mark(name, e)).collect()).collect();
    let has = |test: fn(&Mark) -> bool| marks.iter().flatten().flatten().any(test);
    let mut legend = Vec::new();
    let mut name = |is_there: bool, swatch: Swatch, ink: Ink, text: &str| {
        if is_there {
            legend.push(Entry { swatch, ink, text: Rich::plain(text) });
        }
    };
    name(has(|m| matches!(m, Mark::Known(..))), Swatch::Interval, ACCENT, "value and 95 % interval");
    name(has(|m| matches!(m, Mark::Bound(..))), Swatch::Bound, ACCENT, "at its bound, interval beyond it");
    name(has(|m| matches!(m, Mark::Open(_))), Swatch::Ring, TEXT, "no interval stated");
    name(has(|m| matches!(m, Mark::Fixed(_))), Swatch::Square, MUTED, "fixed by the campaign");
    let legend_tall = legend_height(&legend, left);
    let total = legend_tall + n_rows as f64 * (head + height + foot);
    let mut canvas = Canvas::new(WIDTH, total);
    draw_legend(&mut canvas, &legend, left, 0.0);
    let mut is_cut = false;
    for (i, (coefficient, marks)) in coefficients.iter().zip(&marks).enumerate() {
        let (column, row) = (i % columns, i / columns);
        let unit = shown
            .iter()
            .find_map(|(_, _, e)| e.coefficients.get(*coefficient))
            .map_or("1", |c| if c.unit.is_empty() { "1" } else { c.unit.as_str() });
        let x = forest_span(marks);
        is_cut |= marks.iter().flatten().filter_map(|m| m.ends()).any(|[low, high]| low < x.low || high > x.high);
        let panel = Panel {
            left: left + column as f64 * (width + gap),
            top: legend_tall + row as f64 * (head + height + foot) + head,
            width,
            height,
            x,
            y: Span { low: 0.0, high: 1.0 },
        };
        let ticks = spaced_ticks(x, if columns == 1 { 8 } else { 3 }, width);
        canvas.line((panel.left, panel.bottom()), (panel.right(), panel.bottom()), AXIS, 1.0);
        for &place in &ticks.places {
            let at = panel.at_x(place);
            let ink = if place == 0.0 { AXIS } else { RULE };
            canvas.line((at, panel.top), (at, panel.bottom()), ink, 0.8);
            canvas.line((at, panel.bottom()), (at, panel.bottom() + 4.0), AXIS, 1.0);
            let text = Rich::plain(&ticks.label(place));
            canvas.text(&text, (at, panel.bottom() + 14.0), TICK_SIZE, MUTED, Align::Center);
        }
        let title = ticks.titled(symbol_and_unit(&shortened(coefficient, 40), unit));
        canvas.text(&title, (panel.left, panel.top - 12.0), LABEL_SIZE + 1.0, TEXT, Align::Left);
        for (k, (source, mark)) in shown.iter().zip(marks).enumerate() {
            let y = panel.top + 3.0 + (k as f64 + 0.5) * pitch;
            if column == 0 {
                canvas.text(&label(source), (left - 14.0, y), LABEL_SIZE, TEXT, Align::Right);
            }
            if let Some(mark) = mark {
                draw_mark(&mut canvas, &panel, *mark, y, source.1, coefficient, source.2);
                continue;
            }
            let word = match source.2.coefficients.get(*coefficient).map(|c| c.status) {
                None => "not in this record",
                Some(Status::Excluded) => "excluded",
                Some(_) => "not determined",
            };
            let at = (panel.left + panel.width / 2.0, y);
            canvas.text(&Rich::styled(Style::Italic, word), at, TICK_SIZE - 0.5, MUTED, Align::Center);
        }
    }
    let mut caption = format!(
        "Coefficients of model {model} from every source{part}. Only coefficients of the same model are set side by side."
    );
    if is_cut {
        caption.push_str(" An arrow means that the interval goes on beyond the panel.");
    }
    if shown.len() < rows.len() {
        let further = counted(rows.len() - shown.len(), "further source stands", "further sources stand");
        let _ = write!(caption, " {further} in the tables only.");
    }
    Drawing {
        slug: format!("forest-{model}"),
        title: format!("Coefficients of model {model} by source{part}"),
        caption,
        canvas,
    }
}

/// Air between the labels of two ticks, and between those of neighbouring panels.
const TICK_AIR: f64 = 16.0;

/// At most about `wanted` ticks, fewer where their labels would run into each other.
fn spaced_ticks(x: Span, wanted: usize, width: f64) -> Ticks {
    let fits = |ticks: &Ticks| {
        let labels: f64 =
            ticks.places.iter().map(|p| text_width(&Rich::plain(&ticks.label(*p)), TICK_SIZE) + TICK_AIR).sum();
        labels <= width
    };
    (1..=wanted).rev().map(|n| x.ticks(n)).find(fits).unwrap_or_else(|| x.ticks(1))
}

/// Range of a forest panel: all values, and intervals as far as they do not
/// squeeze the others.
fn forest_span(marks: &[Option<Mark>]) -> Span {
    let present: Vec<Mark> = marks.iter().flatten().copied().collect();
    let Some(values) = Span::of(present.iter().map(|m| m.value())) else {
        return Span { low: 0.0, high: 0.0 }.aired(0.05);
    };
    let mut reaches: Vec<f64> = present
        .iter()
        .filter_map(|m| m.ends().map(|[l, h]| (m.value() - l).max(h - m.value())))
        .filter(|r| drawable(*r))
        .collect();
    reaches.sort_by(f64::total_cmp);
    let middle = reaches.get(reaches.len() / 2).copied().unwrap_or(0.0);
    let limit = (4.0 * middle).max(values.width());
    let span = present
        .iter()
        .filter_map(|m| m.ends())
        .fold(values, |span, [low, high]| span.with(low.max(values.low - limit)).with(high.min(values.high + limit)));
    // Zero is worth showing when it is near.
    let gap = span.low.max(-span.high);
    let span = if gap > 0.0 && gap < 0.6 * span.width() { span.with(0.0) } else { span };
    let aired = span.aired(0.06);
    // Also an end at zero gets air: a marker sits on it.
    Span { low: aired.low.min(span.low - 0.04 * aired.width()), high: aired.high.max(span.high + 0.04 * aired.width()) }
}

fn draw_mark(
    canvas: &mut Canvas,
    panel: &Panel,
    mark: Mark,
    y: f64,
    is_published: bool,
    coefficient: &str,
    estimate: &Estimate,
) {
    let is_contradicted = estimate.coefficients.get(coefficient).is_some_and(|c| c.status == Status::BoundContradicted);
    let ink = if is_contradicted {
        ALERT
    } else if is_published {
        TEXT
    } else {
        ACCENT
    };
    if let Some([low, high]) = mark.ends() {
        let (x0, x1) = (panel.at_x(low.max(panel.x.low)), panel.at_x(high.min(panel.x.high)));
        canvas.line((x0, y), (x1, y), ink, 1.6);
        if low < panel.x.low {
            canvas.area(&[(x0, y), (x0 + 7.0, y - 4.0), (x0 + 7.0, y + 4.0)], ink);
        }
        if high > panel.x.high {
            canvas.area(&[(x1, y), (x1 - 7.0, y - 4.0), (x1 - 7.0, y + 4.0)], ink);
        }
    }
    let at = (panel.at_x(mark.value().max(panel.x.low).min(panel.x.high)), y);
    match mark {
        Mark::Known(..) => canvas.dot(at, 4.0, ink),
        Mark::Bound(..) => canvas.rectangle((at.0 - 1.8, y - 6.0), (at.0 + 1.8, y + 6.0), ink),
        Mark::Fixed(_) => canvas.rectangle((at.0 - 4.0, y - 4.0), (at.0 + 4.0, y + 4.0), MUTED),
        Mark::Open(_) => canvas.ring(at, 4.2, ink, 1.5),
    }
}
