//! Panels: ranges, ticks, axes and colours that every figure shares.
//!
//! The look: left and bottom axis lines, light horizontal rules, ticks outside,
//! units in every axis label, legend above the panels and never on the data.

use crate::canvas::{Align, Canvas, Ink, Xy, text_width};
use crate::symbol::{Rich, Style};
use froude_records::number;

/// Width of every figure in CSS pixels.
pub(crate) const WIDTH: f64 = 860.0;

/// Most panels in one figure.
pub(crate) const MOST_PANELS: usize = 9;

pub(crate) const TEXT: Ink = Ink::new(0x1f_29_33);
pub(crate) const MUTED: Ink = Ink::new(0x5b_67_70);
pub(crate) const AXIS: Ink = Ink::new(0x8a_94_9c);
pub(crate) const RULE: Ink = Ink::new(0xe4_e8_eb);
pub(crate) const ACCENT: Ink = Ink::new(0x00_5b_96);
pub(crate) const ALERT: Ink = Ink::new(0xb3_45_00);

pub(crate) const LABEL_SIZE: f64 = 13.0;
pub(crate) const TICK_SIZE: f64 = 12.0;

/// Colours of unordered things (after Okabe and Ito, darkened for paper).
const CATEGORIES: [Ink; 7] = [
    Ink::new(0x00_5b_96),
    Ink::new(0xd5_5e_00),
    Ink::new(0x00_8b_6b),
    Ink::new(0xb8_5c_92),
    Ink::new(0xd8_9a_00),
    Ink::new(0x4a_a3_d4),
    Ink::new(0x5b_67_70),
];

/// Colour of the `index`th of unordered things.
pub(crate) fn category(index: usize) -> Ink {
    CATEGORIES[index % CATEGORIES.len()]
}

/// Anchors of the ramp for ordered things: dark blue to ochre, lightness rising,
/// distinguished without red and green.
const RAMP: [(f64, f64, f64); 5] =
    [(16.0, 42.0, 92.0), (20.0, 98.0, 140.0), (42.0, 145.0, 140.0), (122.0, 166.0, 80.0), (214.0, 150.0, 30.0)];

/// Colour of the `index`th of `n` ordered things.
pub(crate) fn level_ink(index: usize, n: usize) -> Ink {
    ramp(if n < 2 { 0.25 } else { index.min(n - 1) as f64 / (n - 1) as f64 })
}

/// Colour of a place from 0 to 1 on the ramp.
pub(crate) fn ramp(t: f64) -> Ink {
    let t = t.clamp(0.0, 1.0);
    let place = t * (RAMP.len() - 1) as f64;
    let low = (place.floor() as usize).min(RAMP.len() - 2);
    let part = place - low as f64;
    let mix = |a: f64, b: f64| (a + (b - a) * part).round() as u32;
    let (a, b) = (RAMP[low], RAMP[low + 1]);
    Ink::new(mix(a.0, b.0) << 16 | mix(a.1, b.1) << 8 | mix(a.2, b.2))
}

/// A range that always has a width and never overflows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    pub(crate) low: f64,
    pub(crate) high: f64,
}

/// Numbers beyond this are not drawn.
const DRAWABLE: f64 = 1e300;

/// Whether a number can be drawn.
pub(crate) fn drawable(x: f64) -> bool {
    x.is_finite() && x.abs() <= DRAWABLE
}

impl Span {
    /// The range of the drawable numbers; `None` when there is none.
    pub(crate) fn of(numbers: impl IntoIterator<Item = f64>) -> Option<Self> {
        numbers.into_iter().filter(|x| drawable(*x)).fold(None, |span: Option<Self>, x| {
            Some(span.map_or(Self { low: x, high: x }, |s| Self { low: s.low.min(x), high: s.high.max(x) }))
        })
    }

    pub(crate) fn width(self) -> f64 {
        self.high - self.low
    }

    pub(crate) fn with(self, x: f64) -> Self {
        Self { low: self.low.min(x), high: self.high.max(x) }
    }

    pub(crate) fn union(self, other: Self) -> Self {
        self.with(other.low).with(other.high)
    }

    pub(crate) fn contains(self, x: f64) -> bool {
        (self.low..=self.high).contains(&x)
    }

    /// The range with air at both ends, and a width in every case; an end at zero stays there.
    pub(crate) fn aired(self, part: f64) -> Self {
        let size = self.low.abs().max(self.high.abs());
        if self.width() <= 1e-9 * size || self.width() <= 1.0 / DRAWABLE {
            let half = if size > 10.0 / DRAWABLE { 0.1 * size } else { 1.0 };
            return Self { low: self.low - half, high: self.high + half };
        }
        let air = self.width() * part;
        Self {
            low: if self.low == 0.0 { 0.0 } else { self.low - air },
            high: if self.high == 0.0 { 0.0 } else { self.high + air },
        }
    }

    /// Ticks at round numbers inside the range, about `wanted` of them, and
    /// the power of ten to be taken out of their labels.
    pub(crate) fn ticks(self, wanted: usize) -> Ticks {
        let raw = self.width() / wanted.max(1) as f64;
        if !raw.is_finite() || raw <= 0.0 {
            return Ticks { places: Vec::new(), power: 0, decimals: 0 };
        }
        let magnitude = 10f64.powf(raw.log10().floor());
        let off = |step: &f64| (step / raw).ln().abs();
        let step = [1.0, 2.0, 5.0, 10.0]
            .map(|m| m * magnitude)
            .into_iter()
            .min_by(|a, b| off(a).total_cmp(&off(b)))
            .unwrap_or(raw);
        self.ticks_every(step)
    }

    /// Ticks at multiples of a step.
    pub(crate) fn ticks_every(self, step: f64) -> Ticks {
        let none = Ticks { places: Vec::new(), power: 0, decimals: 0 };
        if !step.is_finite() || step <= 0.0 {
            return none;
        }
        let first = (self.low / step - 1e-9).ceil();
        let last = (self.high / step + 1e-9).floor();
        if !first.is_finite() || !last.is_finite() || last - first > 60.0 {
            return none;
        }
        let n = (last - first).max(-1.0) as i64;
        let places: Vec<f64> = (0..=n).map(|i| (first + i as f64) * step).collect();
        let size = self.low.abs().max(self.high.abs()).log10().floor() as i32;
        let power = if size >= 5 || size <= -4 { size } else { 0 };
        let decimals = (power - (step * 1.0001).log10().floor() as i32).clamp(0, 12) as usize;
        Ticks { places, power, decimals }
    }
}

/// Places of ticks and how they are written.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ticks {
    pub(crate) places: Vec<f64>,
    /// Power of ten that stands in the axis label.
    pub(crate) power: i32,
    pub(crate) decimals: usize,
}

impl Ticks {
    pub(crate) fn label(&self, x: f64) -> String {
        let half = self.power / 2;
        number::fixed(x / 10f64.powi(half) / 10f64.powi(self.power - half), self.decimals)
    }

    /// The axis label with the power of ten that the ticks leave out.
    pub(crate) fn titled(&self, title: Rich) -> Rich {
        if self.power == 0 {
            return title;
        }
        title.and("  × 10").then(Rich::styled(Style::Superscript, &self.power.to_string().replace('-', "−")))
    }
}

/// A rectangle with two axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Panel {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) x: Span,
    pub(crate) y: Span,
}

impl Panel {
    pub(crate) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    pub(crate) fn at_x(&self, x: f64) -> f64 {
        self.left + (x - self.x.low) / self.x.width() * self.width
    }

    pub(crate) fn at_y(&self, y: f64) -> f64 {
        self.bottom() - (y - self.y.low) / self.y.width() * self.height
    }

    /// Place of a point; `None` when it is not drawable or lies outside.
    pub(crate) fn at(&self, x: f64, y: f64) -> Option<Xy> {
        (drawable(x) && drawable(y) && self.x.contains(x) && self.y.contains(y)).then(|| (self.at_x(x), self.at_y(y)))
    }

    /// Axis lines, rules and tick labels.
    pub(crate) fn axes(&self, canvas: &mut Canvas, x: Option<&Ticks>, y: Option<&Ticks>, ticks: (&Ticks, &Ticks)) {
        for &place in &ticks.1.places {
            let at = self.at_y(place);
            canvas.line((self.left, at), (self.right(), at), if place == 0.0 { AXIS.faint(0.8) } else { RULE }, 0.8);
        }
        canvas.line((self.left, self.top), (self.left, self.bottom()), AXIS, 1.0);
        canvas.line((self.left, self.bottom()), (self.right(), self.bottom()), AXIS, 1.0);
        for &place in &ticks.1.places {
            canvas.line((self.left - 4.0, self.at_y(place)), (self.left, self.at_y(place)), AXIS, 1.0);
        }
        for &place in &ticks.0.places {
            let at = self.at_x(place);
            canvas.line((at, self.bottom()), (at, self.bottom() + 4.0), AXIS, 1.0);
        }
        if let Some(ticks) = x {
            for &place in &ticks.places {
                let text = Rich::plain(&ticks.label(place));
                canvas.text(&text, (self.at_x(place), self.bottom() + 14.0), TICK_SIZE, MUTED, Align::Center);
            }
        }
        if let Some(ticks) = y {
            for &place in &ticks.places {
                let text = Rich::plain(&ticks.label(place));
                canvas.text(&text, (self.left - 8.0, self.at_y(place)), TICK_SIZE, MUTED, Align::Right);
            }
        }
    }

    /// A line through the drawable places inside the panel, broken where it leaves.
    pub(crate) fn strokes(&self, x: &[f64], y: &[f64]) -> Vec<Vec<Xy>> {
        let mut strokes = vec![Vec::new()];
        for (&x, &y) in x.iter().zip(y) {
            match (self.at(x, y), strokes.last_mut()) {
                (Some(at), Some(stroke)) => stroke.push(at),
                (None, Some(stroke)) if !stroke.is_empty() => strokes.push(Vec::new()),
                _ => {}
            }
        }
        strokes.retain(|s| s.len() > 1);
        strokes
    }

    /// A band, cut at the panel's edges.
    pub(crate) fn band(&self, x: &[f64], low: &[f64], high: &[f64]) -> Vec<Xy> {
        let cut = |y: f64| self.at_y(y.max(self.y.low).min(self.y.high));
        let places: Vec<(f64, f64, f64)> = x
            .iter()
            .zip(low.iter().zip(high))
            .filter(|(x, (l, h))| drawable(**x) && self.x.contains(**x) && drawable(**l) && drawable(**h))
            .map(|(x, (l, h))| (self.at_x(*x), cut(*l), cut(*h)))
            .collect();
        places.iter().map(|p| (p.0, p.1)).chain(places.iter().rev().map(|p| (p.0, p.2))).collect()
    }

    /// A word in the middle of an empty panel.
    pub(crate) fn say(&self, canvas: &mut Canvas, text: &str) {
        let at = (self.left + self.width / 2.0, self.top + self.height / 2.0);
        canvas.text(&Rich::plain(text), at, TICK_SIZE, MUTED, Align::Center);
    }
}

/// Columns and rows for `n` panels.
pub(crate) fn grid_shape(n: usize) -> (usize, usize) {
    let columns = match n {
        0 | 1 => 1,
        2 | 4 => 2,
        _ => 3,
    };
    (columns, n.div_ceil(columns).max(1))
}

/// Splits `n` panels into figures of equal size, at most [`MOST_PANELS`] each.
pub(crate) fn chunk_size(n: usize) -> usize {
    let figures = n.div_ceil(MOST_PANELS).max(1);
    n.div_ceil(figures).max(1)
}

/// Distance of tick steps for degrees: 5, 10, 15, 30, 45, 90, 180.
pub(crate) fn degree_ticks(span: Span, wanted: usize) -> Ticks {
    let raw = span.width() / wanted.max(1) as f64;
    [1.0, 2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0]
        .into_iter()
        .find(|s| *s >= raw * 0.999 && raw > 0.5)
        .map_or_else(|| span.ticks(wanted), |step| span.ticks_every(step))
}

/// How a legend entry is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Swatch {
    LineAndDot,
    Line,
    Dashed,
    Dot,
    Ring,
    Square,
    Interval,
    Bound,
    None,
}

/// One legend entry.
pub(crate) struct Entry {
    pub(crate) swatch: Swatch,
    pub(crate) ink: Ink,
    pub(crate) text: Rich,
}

/// Height of one legend row.
const LEGEND_ROW: f64 = 20.0;

fn entry_width(entry: &Entry) -> f64 {
    let swatch = match entry.swatch {
        Swatch::None => 0.0,
        Swatch::Dot | Swatch::Ring | Swatch::Square => 16.0,
        _ => 30.0,
    };
    swatch + text_width(&entry.text, LABEL_SIZE) + 18.0
}

/// Rows that the legend needs between `left` and the right edge.
fn legend_rows(entries: &[Entry], left: f64) -> Vec<Vec<&Entry>> {
    let mut rows: Vec<Vec<&Entry>> = vec![Vec::new()];
    let mut x = left;
    for entry in entries {
        let width = entry_width(entry);
        if x + width > WIDTH && x > left {
            rows.push(Vec::new());
            x = left;
        }
        x += width;
        if let Some(row) = rows.last_mut() {
            row.push(entry);
        }
    }
    rows
}

/// Height of the legend; 0 without entries.
pub(crate) fn legend_height(entries: &[Entry], left: f64) -> f64 {
    if entries.is_empty() { 0.0 } else { legend_rows(entries, left).len() as f64 * LEGEND_ROW + 6.0 }
}

/// Draws the legend from `top` down.
pub(crate) fn draw_legend(canvas: &mut Canvas, entries: &[Entry], left: f64, top: f64) {
    let mut y = top + LEGEND_ROW / 2.0;
    for row in legend_rows(entries, left) {
        let mut x = left;
        for entry in row {
            let ink = entry.ink;
            let mut text_at = x + 30.0;
            match entry.swatch {
                Swatch::LineAndDot => {
                    canvas.line((x, y), (x + 24.0, y), ink, 1.8);
                    canvas.dot((x + 12.0, y), 3.0, ink);
                }
                Swatch::Line => canvas.line((x, y), (x + 24.0, y), ink, 1.8),
                Swatch::Dashed => canvas.dashed(&[(x, y), (x + 24.0, y)], ink, 1.4, 5.0, 3.5),
                Swatch::Interval => {
                    canvas.line((x, y), (x + 24.0, y), ink, 1.6);
                    canvas.dot((x + 12.0, y), 4.0, ink);
                }
                Swatch::Bound => {
                    canvas.line((x + 3.0, y), (x + 24.0, y), ink, 1.6);
                    canvas.rectangle((x, y - 5.0), (x + 3.5, y + 5.0), ink);
                }
                Swatch::Dot => {
                    canvas.dot((x + 5.0, y), 3.2, ink);
                    text_at = x + 16.0;
                }
                Swatch::Ring => {
                    canvas.ring((x + 5.0, y), 4.0, ink, 1.4);
                    text_at = x + 16.0;
                }
                Swatch::Square => {
                    canvas.rectangle((x, y - 5.0), (x + 10.0, y + 5.0), ink);
                    text_at = x + 16.0;
                }
                Swatch::None => text_at = x,
            }
            canvas.text(&entry.text, (text_at, y), LABEL_SIZE, TEXT, Align::Left);
            x += entry_width(entry);
        }
        y += LEGEND_ROW;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn ticks_are_round_and_inside() {
        let ticks = Span { low: 0.0, high: 1.03 }.ticks(5);
        let labels: Vec<String> = ticks.places.iter().map(|x| ticks.label(*x)).collect();
        assert_eq!(labels, ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]);
        let ticks = Span { low: -3.2e-6, high: 0.0 }.ticks(4);
        assert_eq!(ticks.power, -6);
        assert_eq!(ticks.label(-2e-6), "−2");
        let ticks = degree_ticks(Span { low: 0.0, high: 90.0 }, 4);
        assert_eq!(ticks.places, [0.0, 30.0, 60.0, 90.0]);
    }

    #[test]
    fn panels_are_spread_evenly_over_figures() {
        assert_eq!(chunk_size(10), 5);
        assert_eq!(chunk_size(9), 9);
        assert_eq!(chunk_size(0), 1);
        assert_eq!(grid_shape(5), (3, 2));
        assert_eq!(grid_shape(0), (1, 1));
    }

    proptest! {
        /// Every pair of numbers gives a range with a width, and few ticks.
        #[test]
        fn any_numbers_give_a_range_and_ticks(a in any::<f64>(), b in any::<f64>(), n in 0usize..20) {
            if let Some(span) = Span::of([a, b]) {
                let span = span.aired(0.05);
                prop_assert!(span.width() > 0.0 && span.width().is_finite(), "{:?}", span);
                let ticks = span.ticks(n);
                prop_assert!(ticks.places.len() <= 64);
                for x in &ticks.places {
                    prop_assert!(!ticks.label(*x).contains("NaN"));
                }
                prop_assert!(degree_ticks(span, n).places.len() <= 64);
            }
        }
    }
}
