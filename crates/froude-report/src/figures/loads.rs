//! Loads against speed, angle or another channel: points, model lines, 95 % band.
//!
//! One figure per load component and abscissa, one panel per configuration.
//! Lines that hold different angles or speeds have colours of one ramp.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use froude_records::number;
use froude_records::page::{Abscissa as Held, Against, Curve, Point, SourceSection};
use indexmap::IndexMap;

use crate::canvas::{Align, Canvas, Ink, shortened};
use crate::figures::drawing::{Drawing, MOST_NAMED, MOST_POINTS, drawn_by_chance, evenly, recommended, thinned};
use crate::plot::{
    ACCENT, Entry, LABEL_SIZE, MUTED, Panel, Span, Swatch, TEXT, Ticks, WIDTH, chunk_size, degree_ticks, draw_legend,
    drawable, grid_shape, legend_height, level_ink,
};
use crate::symbol::{Rich, Style, symbol_and_unit, unit_text};
use crate::tables::{counted, distinct};

/// From this many points on a panel shows them as a cloud behind the line, without bars.
const CLOUD: usize = 120;

/// A point belongs to a line that is this near in angle, 0.5°.
const SAME_ANGLE_RAD: f64 = 0.0088;

/// A point belongs to a line that is this near in speed, relative.
const SAME_SPEED: f64 = 0.03;

/// `Force`, `Moment` or `Load`.
fn load_word(component: &str) -> &'static str {
    match component.as_bytes().first() {
        Some(b'f' | b'F') => "Force",
        Some(b'm' | b'M') => "Moment",
        _ => "Load",
    }
}

/// What the points are.
fn points_word(section: &SourceSection) -> &'static str {
    if section.kind == "cfd" { "computed" } else { "measured" }
}

/// The abscissae that loads are drawn against.
#[derive(Debug, Clone, PartialEq)]
enum Abscissa {
    Speed,
    Angle,
    Other { quantity: String, unit: String },
}

impl Abscissa {
    fn of_curve(curve: &Curve) -> (Self, Option<f64>) {
        match &curve.against {
            Against::Speed { angle_rad } => (Self::Speed, Some(*angle_rad)),
            Against::Angle { speed_m_s } => (Self::Angle, Some(*speed_m_s)),
            Against::Other { quantity, unit } => (Self::Other { quantity: quantity.clone(), unit: unit.clone() }, None),
        }
    }

    /// Abscissa of a point and the value of what the lines hold.
    fn of_point(&self, p: &Point) -> Option<(f64, Option<f64>)> {
        match self {
            Self::Speed => Some((p.speed_m_s, Some(p.angle_rad))),
            Self::Angle => Some((p.angle_rad.to_degrees(), Some(p.speed_m_s))),
            Self::Other { quantity, unit } => {
                let is_own = p.of.other.as_ref().is_some_and(|[own, of]| own == quantity && of == unit);
                is_own.then_some((p.other, None))
            }
        }
    }

    fn shown(&self, x: f64) -> f64 {
        if *self == Self::Angle { x.to_degrees() } else { x }
    }

    fn word(&self) -> &str {
        match self {
            Self::Speed => "speed",
            Self::Angle => "angle",
            Self::Other { quantity, .. } => quantity,
        }
    }

    fn axis(&self) -> Rich {
        match self {
            Self::Speed => Rich::plain("Speed [m/s]"),
            Self::Angle => Rich::plain("Angle [°]"),
            Self::Other { quantity, unit } => symbol_and_unit(quantity, unit),
        }
    }

    fn ticks(&self, span: Span, wanted: usize) -> Ticks {
        if *self == Self::Angle { degree_ticks(span, wanted) } else { span.ticks(wanted) }
    }

    /// Name of what is held, before the legend.
    fn held(&self) -> &'static str {
        match self {
            Self::Speed => "Angle",
            Self::Angle => "Speed",
            Self::Other { .. } => "",
        }
    }

    fn level_text(&self, level: f64) -> String {
        match self {
            Self::Speed => number::degrees(level),
            _ => format!("{} m/s", number::plain(level, 3)),
        }
    }

    fn is_same_level(&self, a: f64, b: f64) -> bool {
        match self {
            Self::Speed => (a - b).abs() <= SAME_ANGLE_RAD,
            _ => (a - b).abs() <= SAME_SPEED * a.abs().max(b.abs()),
        }
    }
}

/// What one panel shows.
struct Content<'a> {
    configuration: &'a str,
    /// Abscissa, point and its level.
    points: Vec<(f64, &'a Point, Option<usize>)>,
    curves: Vec<(&'a Curve, Option<usize>)>,
    n_left_out: usize,
}

pub(super) fn load_drawings(section: &SourceSection) -> Vec<Drawing> {
    let components = distinct(
        section
            .points
            .iter()
            .map(|p| p.of.component.as_str())
            .chain(section.curves.iter().map(|c| c.component.as_str())),
    );
    let mut drawings = Vec::new();
    for component in components {
        let points: Vec<&Point> = section.points.iter().filter(|p| p.of.component == component).collect();
        let curves: Vec<&Curve> = section.curves.iter().filter(|c| c.component == component).collect();
        for abscissa in abscissae(&points, &curves) {
            drawings.extend(component_drawings(section, component, &abscissa, &points, &curves));
        }
    }
    drawings
}

/// What the loads of one component are drawn against: what the curves ask for,
/// else whatever varies.
fn abscissae(points: &[&Point], curves: &[&Curve]) -> Vec<Abscissa> {
    let mut out: Vec<Abscissa> = Vec::new();
    for curve in curves {
        let (abscissa, _) = Abscissa::of_curve(curve);
        if !out.contains(&abscissa) {
            out.push(abscissa);
        }
    }
    if out.is_empty() {
        let varies = |of: fn(&Point) -> f64, least: f64| {
            Span::of(points.iter().map(|p| of(p))).is_some_and(|s| s.width() > least)
        };
        if varies(|p| p.speed_m_s, 1e-6) {
            out.push(Abscissa::Speed);
        }
        if varies(|p| p.angle_rad, 1e-3) {
            out.push(Abscissa::Angle);
        }
        for [quantity, unit] in points.iter().filter_map(|p| p.of.other.as_ref()) {
            let abscissa = Abscissa::Other { quantity: quantity.clone(), unit: unit.clone() };
            if !out.contains(&abscissa) {
                out.push(abscissa);
            }
        }
        if out.is_empty() && !points.is_empty() {
            out.push(Abscissa::Speed);
        }
    }
    let rank = |a: &Abscissa| match a {
        Abscissa::Speed => 0,
        Abscissa::Angle => 1,
        Abscissa::Other { .. } => 2,
    };
    out.sort_by_key(rank);
    out
}

/// The distinct values held on lines, rising.
fn levels(abscissa: &Abscissa, curves: &[&Curve], points: &[&Point]) -> Vec<f64> {
    let mut held: Vec<f64> = curves
        .iter()
        .filter_map(|c| {
            let (a, level) = Abscissa::of_curve(c);
            level.filter(|l| a == *abscissa && drawable(*l))
        })
        .collect();
    if held.is_empty() {
        held = points.iter().filter_map(|p| abscissa.of_point(p)?.1).filter(|l| drawable(*l)).collect();
    }
    held.sort_by(f64::total_cmp);
    held.dedup_by(|b, a| abscissa.is_same_level(*a, *b));
    held
}

fn component_drawings(
    section: &SourceSection,
    component: &str,
    abscissa: &Abscissa,
    points: &[&Point],
    curves: &[&Curve],
) -> Vec<Drawing> {
    let curves: Vec<&Curve> = curves.iter().copied().filter(|c| Abscissa::of_curve(c).0 == *abscissa).collect();
    let levels = levels(abscissa, &curves, points);
    let level_of = |held: Option<f64>| {
        let near = |h: f64| {
            let of = |i: &usize| (levels[*i] - h).abs();
            (0..levels.len()).filter(|&i| abscissa.is_same_level(levels[i], h)).min_by(|a, b| of(a).total_cmp(&of(b)))
        };
        held.and_then(near)
    };
    // Of a sweep over angles the other speeds are part of the picture; of one over speeds the other angles would hide it.
    let needs_level = !curves.is_empty() && !levels.is_empty() && *abscissa != Abscissa::Angle;
    let configurations = distinct(
        points.iter().map(|p| p.of.configuration.as_str()).chain(curves.iter().map(|c| c.configuration.as_str())),
    );
    let mut by_configuration: BTreeMap<&str, Vec<&Point>> = BTreeMap::new();
    for &point in points {
        by_configuration.entry(&point.of.configuration).or_default().push(point);
    }
    let contents: Vec<Content> = configurations
        .into_iter()
        .map(|configuration| {
            let mut n_left_out = 0;
            let mut shown = Vec::new();
            for &p in by_configuration.get(configuration).into_iter().flatten() {
                let Some((x, held)) = abscissa.of_point(p) else { continue };
                let level = level_of(held);
                if needs_level && level.is_none() {
                    n_left_out += 1;
                } else {
                    shown.push((x, p, level));
                }
            }
            let points = thinned(&shown, MOST_POINTS);
            n_left_out += shown.len() - points.len();
            let curves = curves
                .iter()
                .filter(|c| c.configuration == configuration)
                .map(|c| (*c, level_of(Abscissa::of_curve(c).1)))
                .collect();
            Content { configuration, points, curves, n_left_out }
        })
        .filter(|c: &Content| !c.points.is_empty() || !c.curves.is_empty())
        .collect();
    if contents.is_empty() {
        return Vec::new();
    }
    let unit =
        points.first().map(|p| p.of.unit.as_str()).or_else(|| curves.first().map(|c| c.unit.as_str())).unwrap_or("");
    let best = recommended(section)
        .map(|e| e.law.name.as_str())
        .filter(|m| curves.iter().any(|c| c.model == *m))
        .or_else(|| curves.first().map(|c| c.model.as_str()));
    let look = Look { section, component, unit, abscissa, levels: &levels, best };
    let size = chunk_size(contents.len());
    let n_figures = contents.len().div_ceil(size);
    contents.chunks(size).enumerate().map(|(i, chunk)| draw_loads(&look, chunk, i, n_figures)).collect()
}

/// What all panels of a load figure share.
struct Look<'a> {
    section: &'a SourceSection,
    component: &'a str,
    unit: &'a str,
    abscissa: &'a Abscissa,
    levels: &'a [f64],
    best: Option<&'a str>,
}

impl Look<'_> {
    fn ink(&self, level: Option<usize>) -> Ink {
        match level {
            Some(level) => level_ink(level, self.levels.len()),
            None if self.levels.is_empty() => ACCENT,
            None => MUTED,
        }
    }

    /// Range of the loads in a panel: all of points and lines, the band as far as
    /// it does not hide them.
    fn load_span(&self, content: &Content) -> Option<Span> {
        let loads = content
            .points
            .iter()
            .map(|(_, p, _)| p.measured)
            .chain(content.curves.iter().flat_map(|(c, _)| c.y.iter().copied()));
        let mut span = Span::of(loads)?;
        if *self.abscissa == Abscissa::Speed {
            span = span.with(0.0);
        }
        let limit = Span { low: span.low - 0.5 * span.width(), high: span.high + 0.5 * span.width() };
        let edges = content
            .curves
            .iter()
            .filter(|(c, _)| Some(c.model.as_str()) == self.best)
            .flat_map(|(c, _)| c.low.iter().chain(&c.high).copied());
        let bars = content.points.iter().flat_map(|(_, p, _)| {
            let reach = number::usable(p.standard).map_or(0.0, |u| 2.0 * u);
            [p.measured - reach, p.measured + reach]
        });
        if let Some(band) = Span::of(edges.chain(bars)) {
            span = span.with(band.low.max(limit.low)).with(band.high.min(limit.high));
        }
        Some(span)
    }

    fn legend(&self, contents: &[Content]) -> Vec<Entry> {
        let mut entries = Vec::new();
        let has_points = contents.iter().any(|c| !c.points.is_empty());
        let has_curves = contents.iter().any(|c| !c.curves.is_empty());
        if self.levels.len() > 1 {
            entries.push(Entry { swatch: Swatch::None, ink: TEXT, text: Rich::plain(self.abscissa.held()) });
            let swatch = match (has_points, has_curves) {
                (true, true) => Swatch::LineAndDot,
                (false, _) => Swatch::Line,
                _ => Swatch::Dot,
            };
            let all: Vec<usize> = (0..self.levels.len()).collect();
            for i in evenly(&all, MOST_NAMED) {
                let text = Rich::plain(&self.abscissa.level_text(self.levels[i]));
                entries.push(Entry { swatch, ink: self.ink(Some(i)), text });
            }
        } else {
            let ink = self.ink(self.levels.first().map(|_| 0));
            let at = match self.levels.first() {
                Some(level) => format!(" at {}", self.abscissa.level_text(*level)),
                None => String::new(),
            };
            if has_points {
                entries.push(Entry {
                    swatch: Swatch::Dot,
                    ink,
                    text: Rich::plain(&format!("{}{at}", points_word(self.section))),
                });
            }
            if let (true, Some(best)) = (has_curves, self.best) {
                entries.push(Entry { swatch: Swatch::Line, ink, text: Rich::plain(&format!("model {best}")) });
            }
        }
        if !self.levels.is_empty() && contents.iter().any(|c| c.points.iter().any(|(_, _, level)| level.is_none())) {
            entries.push(Entry { swatch: Swatch::Dot, ink: self.ink(None), text: Rich::plain("other speeds") });
        }
        let others = distinct(
            contents
                .iter()
                .flat_map(|c| c.curves.iter().map(|(c, _)| c.model.as_str()))
                .filter(|m| Some(*m) != self.best),
        );
        for model in others.into_iter().take(4) {
            entries.push(Entry { swatch: Swatch::Dashed, ink: MUTED, text: Rich::plain(&format!("model {model}")) });
        }
        entries
    }
}

fn draw_loads(look: &Look, contents: &[Content], index: usize, n_figures: usize) -> Drawing {
    let (columns, rows) = grid_shape(contents.len());
    let spans: Vec<Span> =
        contents.iter().map(|c| look.load_span(c).unwrap_or(Span { low: 0.0, high: 0.0 }).aired(0.06)).collect();
    let widest = spans.iter().map(|s| s.width()).fold(0.0, f64::max);
    let narrowest = spans.iter().map(|s| s.width()).fold(f64::INFINITY, f64::min);
    let is_shared = narrowest >= widest / 6.0;
    let shared = spans.iter().copied().reduce(Span::union).unwrap_or(Span { low: 0.0, high: 1.0 });
    let mut x = Span::of(contents.iter().flat_map(|c| {
        c.points
            .iter()
            .map(|(x, _, _)| *x)
            .chain(c.curves.iter().flat_map(|(c, _)| c.x.iter().map(|x| look.abscissa.shown(*x))))
    }))
    .unwrap_or(Span { low: 0.0, high: 1.0 });
    if *look.abscissa == Abscissa::Speed {
        x = x.with(0.0);
    }
    let x = x.aired(0.03);

    let legend = look.legend(contents);
    let height = [330.0, 250.0, 190.0][columns - 1];
    let left = 66.0;
    let gap = if is_shared { 20.0 } else { 58.0 };
    let has_titles = contents.iter().any(|c| !c.configuration.is_empty());
    let head = if has_titles { 22.0 } else { 8.0 };
    let foot = 24.0;
    let width = (WIDTH - left - 12.0 - gap * (columns - 1) as f64) / columns as f64;
    let legend_tall = legend_height(&legend, left);
    let total = legend_tall + rows as f64 * (head + height + foot) + 22.0;
    let mut canvas = Canvas::new(WIDTH, total);
    draw_legend(&mut canvas, &legend, left, 0.0);
    let x_ticks = look.abscissa.ticks(x, if columns == 1 { 9 } else { 5 });
    let mut y_title = symbol_and_unit(look.component, look.unit);
    for (i, content) in contents.iter().enumerate() {
        let (column, row) = (i % columns, i / columns);
        let y = if is_shared { shared } else { spans[i] };
        let panel = Panel {
            left: left + column as f64 * (width + gap),
            top: legend_tall + row as f64 * (head + height + foot) + head,
            width,
            height,
            x,
            y,
        };
        let y_ticks = y.ticks(if rows == 1 { 6 } else { 4 });
        if i == 0 && is_shared {
            y_title = y_ticks.titled(y_title);
        }
        let shows_y = !is_shared || column == 0;
        let shows_x = i + columns >= contents.len();
        panel.axes(&mut canvas, shows_x.then_some(&x_ticks), shows_y.then_some(&y_ticks), (&x_ticks, &y_ticks));
        if has_titles {
            let title = Rich::styled(Style::Bold, &shortened(content.configuration, 40));
            let title = if is_shared { title } else { y_ticks.titled(title) };
            canvas.text(&title, (panel.left, panel.top - 11.0), LABEL_SIZE, TEXT, Align::Left);
        }
        draw_content(look, content, &panel, &mut canvas);
    }
    let middle = legend_tall + head + (total - legend_tall - head - 46.0) / 2.0;
    canvas.upward_text(&y_title, (12.0, middle), LABEL_SIZE, TEXT);
    let x_title = x_ticks.titled(look.abscissa.axis());
    canvas.text(&x_title, (left + (WIDTH - left - 12.0) / 2.0, total - 10.0), LABEL_SIZE, TEXT, Align::Center);

    let part = if n_figures > 1 { format!(" ({} of {n_figures})", index + 1) } else { String::new() };
    let word = look.abscissa.word();
    let title = format!("{}: {} against {word}{part}", look.section.name, look.component);
    Drawing {
        slug: format!("{}-{}-against-{word}", look.section.name, look.component),
        caption: load_caption(look, contents, is_shared, &part) + &drawn_by_chance(look.section),
        title,
        canvas,
    }
}

fn draw_content(look: &Look, content: &Content, panel: &Panel, canvas: &mut Canvas) {
    let is_best = |c: &Curve| Some(c.model.as_str()) == look.best;
    let shown = |c: &Curve| -> Vec<f64> { c.x.iter().map(|x| look.abscissa.shown(*x)).collect() };
    let is_cloud = content.points.len() >= CLOUD;
    for (curve, level) in content.curves.iter().filter(|(c, _)| is_best(c)) {
        canvas.area(&panel.band(&shown(curve), &curve.low, &curve.high), look.ink(*level).faint(0.16));
    }
    let mut n_drawn = 0;
    let mut dots = Vec::new();
    for (x, p, level) in &content.points {
        let Some(at) = panel.at(*x, p.measured) else { continue };
        n_drawn += 1;
        let ink = look.ink(*level);
        if is_cloud {
            canvas.speck(at, if content.points.len() < 400 { 2.3 } else { 1.7 }, ink.faint(0.65));
        } else {
            dots.push((at, p, ink));
        }
    }
    for (curve, level) in &content.curves {
        for stroke in panel.strokes(&shown(curve), &curve.y) {
            if is_best(curve) {
                canvas.path(&stroke, look.ink(*level), if is_cloud { 1.3 } else { 1.7 });
            } else {
                canvas.dashed(&stroke, look.ink(*level).faint(0.8), 1.3, 5.0, 3.5);
            }
        }
    }
    let radius = if dots.len() > 60 { 2.6 } else { 3.2 };
    for (at, p, ink) in &dots {
        let Some(u) = number::usable(p.standard) else { continue };
        let reach = 2.0 * u / panel.y.width() * panel.height;
        if reach > radius + 0.5 && reach.is_finite() {
            let (top, bottom) = ((at.1 - reach).max(panel.top), (at.1 + reach).min(panel.bottom()));
            canvas.line((at.0, top), (at.0, bottom), ink.faint(0.5), 1.0);
        }
    }
    for (at, _, ink) in dots {
        canvas.dot(at, radius, ink);
    }
    if n_drawn == 0 && content.curves.is_empty() {
        panel.say(canvas, "no finite value");
    }
}

/// What all lines hold, with its value where they hold it at one.
fn held_words<'a>(curves: impl Iterator<Item = &'a Curve>) -> String {
    let mut all: IndexMap<&str, Vec<&Held>> = IndexMap::new();
    for held in curves.flat_map(|curve| &curve.held) {
        all.entry(&held.quantity).or_default().push(held);
    }
    let words = all.into_iter().map(|(quantity, held)| {
        let is_one = held.iter().all(|h| h.value == held[0].value);
        let unit = if held[0].unit == "1" { String::new() } else { format!(" {}", unit_text(&held[0].unit)) };
        if is_one {
            format!("{quantity} = {}{unit}", number::plain(held[0].value, 4))
        } else {
            format!("{quantity} at its median in each panel")
        }
    });
    let words: Vec<String> = words.collect();
    if words.is_empty() { String::new() } else { format!(", for {}", words.join(", ")) }
}

fn load_caption(look: &Look, contents: &[Content], is_shared: bool, part: &str) -> String {
    let mut out = format!(
        "{} {} against {}, {}{part}.",
        load_word(look.component),
        look.component,
        look.abscissa.word(),
        look.section.name
    );
    let has_points = contents.iter().any(|c| !c.points.is_empty());
    if has_points {
        let _ = write!(out, " Points: {}", points_word(look.section));
        let has_bars = |c: &Content| {
            c.points.len() < CLOUD && c.points.iter().any(|(_, p, _)| number::usable(p.standard).is_some())
        };
        if contents.iter().any(has_bars) {
            out.push_str(", bars ± 2 standard uncertainties where they are larger than the point");
        }
        out.push('.');
    }
    if let Some(best) = look.best {
        let has_band = contents
            .iter()
            .any(|c| c.curves.iter().any(|(c, _)| c.model == best && !c.low.is_empty() && !c.high.is_empty()));
        let _ = write!(out, " Lines: model {best}");
        out.push_str(if has_band { " with its 95 % band" } else { "; no band is known" });
        out.push_str(&held_words(contents.iter().flat_map(|c| &c.curves).map(|(curve, _)| *curve)));
        out.push('.');
    }
    if !is_shared {
        out.push_str(" The panels have their own vertical scales.");
    }
    let n_left_out: usize = contents.iter().map(|c| c.n_left_out).sum();
    if n_left_out > 0 {
        let _ = write!(
            out,
            " {} not drawn (away from the lines' {}, or thinned).",
            counted(n_left_out, "observation is", "observations are"),
            match look.abscissa {
                Abscissa::Speed => "angles",
                Abscissa::Angle => "speeds",
                Abscissa::Other { .. } => "conditions",
            }
        );
    }
    out
}
