//! A chart of any two quantities: stacked panels over one abscissa, lines, points, bands; linear or logarithmic.
//!
//! For what is not a load against speed or angle: a Bode plot, friction over position, tracking over time, spectra.

use froude_records::page::{Chart, ChartPanel, Mark, Scale, Series};

use crate::canvas::{Align, Canvas, text_width};
use crate::plot::{
    Entry, LABEL_SIZE, MUTED, Panel, Span, Swatch, TEXT, TICK_SIZE, Ticks, WIDTH, category, draw_legend, drawable,
    legend_height,
};
use crate::symbol::Rich;

/// Longest line that is drawn point by point; longer ones are drawn by the extremes of equal stretches.
const MOST_POINTS: usize = 2_000;
const LEFT: f64 = 74.0;
const HEIGHT: f64 = 210.0;
const GAP: f64 = 26.0;

/// The chart as SVG.
///
#[must_use]
pub fn svg(chart: &Chart) -> String {
    canvas(chart).svg(&crate::figures::drawing::slug(&chart.name), &chart.title, &chart.caption)
}

pub(crate) fn canvas(chart: &Chart) -> Canvas {
    Drawn(chart).canvas()
}

/// A chart on its way to a canvas.
struct Drawn<'a>(&'a Chart);

impl Drawn<'_> {
    fn canvas(&self) -> Canvas {
        let names = self.names();
        let legend: Vec<Entry> = names
            .iter()
            .enumerate()
            .map(|(i, (name, mark))| Entry {
                swatch: match mark {
                    Mark::Line => Swatch::Line,
                    Mark::Dashed => Swatch::Dashed,
                    Mark::Points => Swatch::Dot,
                },
                ink: category(i),
                text: Rich::plain(name),
            })
            .collect();
        let spans: Vec<Span> = self.0.panels.iter().map(y_span).collect();
        let labels = self.0.panels.iter().zip(&spans).flat_map(|(panel, span)| {
            let ticks = ticks(*span, panel.y_scale, 5);
            let wide = |place: &f64| text_width(&label(&ticks, panel.y_scale, *place), TICK_SIZE);
            ticks.places.iter().map(wide).collect::<Vec<_>>()
        });
        // The name of the ordinate stands left of the widest number.
        let left = labels.fold(LEFT, |left, wide| left.max(wide + 34.0));
        let top = legend_height(&legend, left) + 8.0;
        let n = self.0.panels.len() as f64;
        let total = top + n * HEIGHT + (n - 1.0).max(0.0) * GAP + 52.0;
        let mut canvas = Canvas::new(WIDTH, total);
        draw_legend(&mut canvas, &legend, left, 0.0);
        let x_all =
            self.0.panels.iter().flat_map(|p| p.series.iter().flat_map(|s| s.x.iter().map(|&x| on(self.0.x_scale, x))));
        let x_span = Span::of(x_all).map_or(Span { low: 0.0, high: 1.0 }, |s| s.aired(0.02));
        for (i, (panel, y)) in self.0.panels.iter().zip(spans).enumerate() {
            let frame = Panel {
                left,
                top: top + i as f64 * (HEIGHT + GAP),
                width: WIDTH - left - 20.0,
                height: HEIGHT,
                x: x_span,
                y,
            };
            let is_last = i + 1 == self.0.panels.len();
            self.axes(&mut canvas, &frame, panel, is_last);
            for series in &panel.series {
                let ink = category(names.iter().position(|(n, _)| *n == series.name).unwrap_or(0));
                draw(&mut canvas, &frame, series, (self.0.x_scale, panel.y_scale), ink);
            }
        }
        canvas
    }

    fn names(&self) -> Vec<(&str, Mark)> {
        let mut out: Vec<(&str, Mark)> = Vec::new();
        for series in self.0.panels.iter().flat_map(|p| &p.series) {
            if !series.name.is_empty() && !out.iter().any(|(n, _)| *n == series.name) {
                out.push((&series.name, series.mark));
            }
        }
        out
    }

    fn axes(&self, canvas: &mut Canvas, frame: &Panel, panel: &ChartPanel, is_last: bool) {
        let x = ticks(frame.x, self.0.x_scale, 8);
        let y = ticks(frame.y, panel.y_scale, 5);
        frame.axes(canvas, None, None, (&x, &y));
        for &place in &y.places {
            let text = label(&y, panel.y_scale, place);
            canvas.text(&text, (frame.left - 8.0, frame.at_y(place)), TICK_SIZE, MUTED, Align::Right);
        }
        let titled = |ticks: &Ticks, scale: Scale, text: &str| match scale {
            Scale::Linear => ticks.titled(Rich::plain(text)),
            Scale::Logarithmic => Rich::plain(text),
        };
        let middle = frame.top + 0.5 * frame.height;
        canvas.upward_text(&titled(&y, panel.y_scale, &panel.y_label), (14.0, middle), LABEL_SIZE, TEXT);
        if is_last {
            for &place in &x.places {
                let text = label(&x, self.0.x_scale, place);
                canvas.text(&text, (frame.at_x(place), frame.bottom() + 14.0), TICK_SIZE, MUTED, Align::Center);
            }
            let at = (frame.left + 0.5 * frame.width, frame.bottom() + 38.0);
            canvas.text(&titled(&x, self.0.x_scale, &self.0.x_label), at, LABEL_SIZE, TEXT, Align::Center);
        }
    }
}

/// What the ordinate of a panel covers.
fn y_span(panel: &ChartPanel) -> Span {
    let values = panel.series.iter().flat_map(|s| s.y.iter().chain(&s.low).chain(&s.high));
    let all = values.map(|&y| on(panel.y_scale, y));
    Span::of(all).map_or(Span { low: 0.0, high: 1.0 }, |s| s.aired(0.06))
}

/// A number on its axis.
pub(crate) fn on(scale: Scale, x: f64) -> f64 {
    match scale {
        Scale::Linear => x,
        Scale::Logarithmic if x > 0.0 => x.log10(),
        Scale::Logarithmic => f64::NAN,
    }
}

/// Round ticks; in decades 1, 2, 5 where there are few of them.
pub(crate) fn ticks(span: Span, scale: Scale, wanted: usize) -> Ticks {
    match scale {
        Scale::Linear => span.ticks(wanted),
        Scale::Logarithmic => {
            let parts: &[f64] = if span.width() <= 2.5 { &[1.0, 2.0, 5.0] } else { &[1.0] };
            let every = (span.width() / 10.0).ceil().max(1.0) as i32;
            let decades = (span.low.floor() as i32)..=(span.high.ceil() as i32);
            let places = decades
                .filter(|d| d % every == 0)
                .flat_map(|d| parts.iter().map(move |p| f64::from(d) + p.log10()))
                .filter(|&place| span.contains(place))
                .collect();
            Ticks { places, power: 0, decimals: 0 }
        }
    }
}

pub(crate) fn label(ticks: &Ticks, scale: Scale, place: f64) -> Rich {
    match scale {
        Scale::Linear => Rich::plain(&ticks.label(place)),
        Scale::Logarithmic if (-3.0..4.0).contains(&place) => {
            Rich::plain(&froude_records::number::significant(10f64.powf(place), 1))
        }
        Scale::Logarithmic => Rich::plain(&format!("{:.0e}", 10f64.powf(place))),
    }
}

/// More points than these are samples of a log: each dot's rim would cover the dots beside it.
const MOST_DOTS: usize = 300;
/// Radius of the specks that stand for them.
const SPECK: f64 = 1.0;

fn draw(canvas: &mut Canvas, frame: &Panel, series: &Series, scales: (Scale, Scale), ink: crate::canvas::Ink) {
    let x: Vec<f64> = series.x.iter().map(|&x| on(scales.0, x)).collect();
    let put = |values: &[f64]| -> Vec<f64> { values.iter().map(|&y| on(scales.1, y)).collect() };
    let (y, low, high) = (put(&series.y), put(&series.low), put(&series.high));
    match series.mark {
        Mark::Points if x.len() > MOST_DOTS => {
            let mut last = (f64::NEG_INFINITY, f64::NEG_INFINITY);
            for at in x.iter().zip(&y).filter_map(|(&x, &y)| frame.at(x, y)) {
                // Specks on one another are one.
                if f64::hypot(at.0 - last.0, at.1 - last.1) >= 0.5 * SPECK {
                    canvas.speck(at, SPECK, ink);
                    last = at;
                }
            }
        }
        Mark::Points => {
            for (i, (&x, &y)) in x.iter().zip(&y).enumerate() {
                if let (Some(&low), Some(&high)) = (low.get(i), high.get(i))
                    && drawable(low)
                    && drawable(high)
                    && drawable(x)
                {
                    let cut = |y: f64| frame.at_y(y.max(frame.y.low).min(frame.y.high));
                    canvas.line((frame.at_x(x), cut(low)), (frame.at_x(x), cut(high)), ink, 1.2);
                }
                if let Some(at) = frame.at(x, y) {
                    canvas.dot(at, 3.0, ink);
                }
            }
        }
        Mark::Line | Mark::Dashed => {
            if low.len() == x.len() && high.len() == x.len() {
                canvas.area(&frame.band(&x, &low, &high), ink.faint(0.18));
            }
            let (x, y) = thinned(&x, &y);
            for stroke in frame.strokes(&x, &y) {
                if series.mark == Mark::Dashed {
                    canvas.dashed(&stroke, ink, 1.4, 5.0, 3.5);
                } else {
                    canvas.path(&stroke, ink, 1.6);
                }
            }
        }
    }
}

/// A long line by the smallest and largest of equal stretches, in their order: no peak is lost.
fn thinned(x: &[f64], y: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let n = x.len().min(y.len());
    if n <= MOST_POINTS {
        return (x[..n].to_vec(), y[..n].to_vec());
    }
    let stretch = n.div_ceil(MOST_POINTS / 2);
    let mut out = (Vec::new(), Vec::new());
    for start in (0..n).step_by(stretch) {
        let part = start..(start + stretch).min(n);
        let by = |a: &usize, b: &usize| y[*a].total_cmp(&y[*b]);
        if let (Some(low), Some(high)) = (part.clone().min_by(by), part.max_by(by)) {
            for i in [low.min(high), low.max(high)] {
                out.0.push(x[i]);
                out.1.push(y[i]);
            }
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(x: Vec<f64>, y: Vec<f64>) -> Chart {
        Chart {
            name: "bode".to_owned(),
            title: "Open loop".to_owned(),
            x_label: "frequency [Hz]".to_owned(),
            x_scale: Scale::Logarithmic,
            panels: vec![ChartPanel {
                y_label: "|L| [1]".to_owned(),
                y_scale: Scale::Logarithmic,
                series: vec![Series { name: "measured".to_owned(), x, y, ..Series::default() }],
            }],
            ..Chart::default()
        }
    }

    #[test]
    fn a_bode_panel_has_its_decades_and_labels() {
        let x: Vec<f64> = (0..50).map(|i| 10f64.powf(f64::from(i) / 24.5)).collect();
        let y = x.iter().map(|f| 1.0 / (f * f)).collect();
        let drawn = svg(&chart(x, y));
        for text in ["frequency [Hz]", "|L| [1]", "10", "100", "measured"] {
            assert!(drawn.lines().any(|line| line.trim() == text), "{text} is missing");
        }
    }

    #[test]
    fn numbers_that_a_logarithm_does_not_take_leave_no_mark_and_no_panic() {
        let drawn = svg(&chart(vec![0.0, -1.0, f64::NAN, 1.0, 2.0], vec![1.0, 1.0, 1.0, 0.0, f64::INFINITY]));
        assert!(!drawn.contains("NaN") && drawn.ends_with("</svg>\n"));
        assert!(svg(&Chart::default()).ends_with("</svg>\n"));
    }

    #[test]
    fn a_long_record_is_drawn_with_its_spikes() {
        let x: Vec<f64> = (0..100_000).map(f64::from).collect();
        let mut y = vec![0.0; 100_000];
        y[54_321] = 1.0;
        let (_, thin) = thinned(&x, &y);
        assert!(thin.len() <= MOST_POINTS + 2 && thin.contains(&1.0));
    }
}
