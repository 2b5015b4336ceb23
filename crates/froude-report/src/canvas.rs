//! A drawing surface in typographic points of the screen, over the SVG backend of `plotters`.
//!
//! `plotters` draws on whole pixels. The surface is therefore ten times as fine
//! as what it shows: coordinates here are CSS pixels with fractions, the picture
//! is scaled by its view box. Text stays text; symbols get real sub- and
//! superscripts.

use std::fmt::Write as _;

use froude_records::text::visible;
use plotters::backend::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontFamily, FontStyle, FontTransform, RGBAColor, ShapeStyle, TextStyle};

use crate::symbol::{Rich, Style};

/// Steps of the drawing grid per CSS pixel.
const FINENESS: f64 = 10.0;

/// Coordinates beyond this are cut, so that none leaves the integers of the backend.
const FARTHEST: f64 = 1e6;

/// The SVG text size of `plotters` is its font size over this.
const PLOTTERS_FONT_RATIO: f64 = 1.24;

/// Fonts of the figures: what laboratories print with, then what is there.
const FONTS: &str = "'Source Sans 3', 'Segoe UI', 'Helvetica Neue', Arial, 'Liberation Sans', sans-serif";

/// Marks the place of a text whose markup is put in afterwards.
const PLACE: char = '\u{e000}';

/// A colour with its opacity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Ink {
    pub(crate) rgb: (u8, u8, u8),
    pub(crate) alpha: f64,
}

impl Ink {
    pub(crate) const fn new(hex: u32) -> Self {
        Self { rgb: ((hex >> 16) as u8, (hex >> 8) as u8, hex as u8), alpha: 1.0 }
    }

    pub(crate) const fn faint(self, alpha: f64) -> Self {
        Self { alpha, ..self }
    }
}

/// Ink and line width in CSS pixels.
#[derive(Debug, Clone, Copy)]
struct Pen {
    ink: Ink,
    width: f64,
}

impl Pen {
    fn style(self) -> ShapeStyle {
        let Ink { rgb: (r, g, b), alpha } = self.ink;
        let stroke_width = (self.width * FINENESS).round().clamp(1.0, 1000.0) as u32;
        ShapeStyle { color: RGBAColor(r, g, b, alpha), filled: true, stroke_width }
    }
}

/// Where a text stands relative to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    Left,
    Center,
    Right,
}

/// A place in CSS pixels, y downwards.
pub(crate) type Xy = (f64, f64);

/// The surface.
pub(crate) struct Canvas {
    width: f64,
    height: f64,
    /// Drawing steps, played to the backend at the end.
    steps: Vec<Step>,
    /// Areas side by side, under all steps: each ink with its outlines, as SVG writes them.
    mosaic: Vec<(Ink, String)>,
}

enum Step {
    Line(Xy, Xy, Pen),
    Path(Vec<Xy>, Pen),
    Area(Vec<Xy>, Pen),
    Rectangle(Xy, Xy, Pen),
    Circle(Xy, f64, Pen, bool),
    Text { text: Rich, at: Xy, size: f64, ink: Ink, align: Align, upwards: bool },
}

fn grid(at: Xy) -> (i32, i32) {
    let step = |x: f64| {
        if x.is_finite() { (x.clamp(-FARTHEST, FARTHEST) * FINENESS).round() as i32 } else { 0 }
    };
    (step(at.0), step(at.1))
}

impl Canvas {
    pub(crate) fn new(width: f64, height: f64) -> Self {
        Self { width, height, steps: Vec::new(), mosaic: Vec::new() }
    }

    pub(crate) fn line(&mut self, from: Xy, to: Xy, ink: Ink, width: f64) {
        self.steps.push(Step::Line(from, to, Pen { ink, width }));
    }

    pub(crate) fn path(&mut self, places: Vec<Xy>, ink: Ink, width: f64) {
        if places.len() > 1 {
            self.steps.push(Step::Path(places, Pen { ink, width }));
        }
    }

    /// A path of dashes, `dash` on and `gap` off.
    pub(crate) fn dashed(&mut self, places: &[Xy], ink: Ink, width: f64, dash: f64, gap: f64) {
        let period = (dash + gap).max(1.0);
        let mut done = 0.0;
        for pair in places.windows(2) {
            let [(x0, y0), (x1, y1)] = *pair else { continue };
            let length = (x1 - x0).hypot(y1 - y0);
            if !length.is_finite() || length <= 0.0 || length > 20_000.0 {
                continue;
            }
            let mut at = 0.0;
            while at < length {
                let phase: f64 = (done + at) % period;
                let (is_dash, left) = if phase < dash { (true, dash - phase) } else { (false, period - phase) };
                let end = (at + left.max(0.05)).min(length);
                if is_dash {
                    let place = |s: f64| (x0 + (x1 - x0) * s / length, y0 + (y1 - y0) * s / length);
                    self.line(place(at), place(end), ink, width);
                }
                at = end;
            }
            done += length;
        }
    }

    pub(crate) fn area(&mut self, places: Vec<Xy>, ink: Ink) {
        if places.len() > 2 {
            self.steps.push(Step::Area(places, Pen { ink, width: 1.0 }));
        }
    }

    /// An area among others side by side, under everything else: no seam shines through between two of them.
    pub(crate) fn mosaic(&mut self, places: &[Xy], ink: Ink) {
        let mut at = (0, 0);
        let mut outline = String::new();
        for (index, place) in places.iter().enumerate() {
            let (x, y) = grid(*place);
            let before = if index == 0 { 'M' } else { 'l' };
            let _ = write!(outline, "{before}{} {}", x - at.0, y - at.1);
            at = (x, y);
        }
        outline.push('z');
        match self.mosaic.last_mut() {
            Some((last, outlines)) if *last == ink => outlines.push_str(&outline),
            _ => self.mosaic.push((ink, outline)),
        }
    }

    pub(crate) fn rectangle(&mut self, upper_left: Xy, lower_right: Xy, ink: Ink) {
        self.steps.push(Step::Rectangle(upper_left, lower_right, Pen { ink, width: 1.0 }));
    }

    /// A filled disc with a white rim, so that neighbours stay apart.
    pub(crate) fn dot(&mut self, at: Xy, radius: f64, ink: Ink) {
        let white = Pen { ink: WHITE, width: 1.0 };
        self.steps.push(Step::Circle(at, radius + 0.8, white, true));
        self.steps.push(Step::Circle(at, radius, Pen { ink, width: 1.0 }, true));
    }

    /// A small disc without rim, for clouds of points.
    pub(crate) fn speck(&mut self, at: Xy, radius: f64, ink: Ink) {
        self.steps.push(Step::Circle(at, radius, Pen { ink, width: 1.0 }, true));
    }

    /// An open ring on white.
    pub(crate) fn ring(&mut self, at: Xy, radius: f64, ink: Ink, width: f64) {
        self.steps.push(Step::Circle(at, radius, Pen { ink: WHITE, width: 1.0 }, true));
        self.steps.push(Step::Circle(at, radius, Pen { ink, width }, false));
    }

    /// Text whose middle height lies on `at`.
    pub(crate) fn text(&mut self, text: Rich, at: Xy, size: f64, ink: Ink, align: Align) {
        self.steps.push(Step::Text { text, at, size, ink, align, upwards: false });
    }

    /// Centred text that reads upwards.
    pub(crate) fn upward_text(&mut self, text: Rich, at: Xy, size: f64, ink: Ink) {
        self.steps.push(Step::Text { text, at, size, ink, align: Align::Center, upwards: true });
    }

    /// The picture as SVG, with a title and a description for readers who do not see it.
    pub(crate) fn svg(&self, id: &str, title: &str, description: &str) -> Result<String, String> {
        let (w, h) = grid((self.width, self.height));
        let mut body = String::new();
        let mut markups = Vec::new();
        {
            let mut backend = SVGBackend::with_string(&mut body, (w.max(1).unsigned_abs(), h.max(1).unsigned_abs()));
            for step in &self.steps {
                play(step, &mut backend, &mut markups)?;
            }
            backend.present().map_err(|e| e.to_string())?;
        }
        // The backend's own head has the fine size; ours has the shown one.
        let inner = body.split_once(">\n").map_or("", |(_, rest)| rest);
        let inner = slimmed(inner);
        let mut out = String::with_capacity(inner.len() + 1024);
        let _ = writeln!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {w} {h}\" width=\"{}\" height=\"{}\" \
             role=\"img\" aria-labelledby=\"{id}-title {id}-desc\">\n\
             <title id=\"{id}-title\">{}</title>\n<desc id=\"{id}-desc\">{}</desc>",
            self.width,
            self.height,
            escaped(title),
            escaped(description),
        );
        if !self.mosaic.is_empty() {
            out.push_str("<g shape-rendering=\"crispEdges\">\n");
            for (Ink { rgb: (r, g, b), .. }, outlines) in &self.mosaic {
                let _ = writeln!(out, "<path fill=\"#{r:02x}{g:02x}{b:02x}\" d=\"{outlines}\"/>");
            }
            out.push_str("</g>\n");
        }
        let mut pieces = inner.split(PLACE);
        out.push_str(pieces.next().unwrap_or(""));
        let mut markups = markups.iter();
        for piece in pieces {
            if let Some(markup) = markups.next() {
                out.push_str(markup);
            }
            out.push_str(piece);
        }
        Ok(visible(&out).into_owned())
    }
}

/// White.
pub(crate) const WHITE: Ink = Ink::new(0xff_ff_ff);

fn play(step: &Step, backend: &mut SVGBackend<'_>, markups: &mut Vec<String>) -> Result<(), String> {
    let drawn = match step {
        Step::Line(from, to, pen) => backend.draw_line(grid(*from), grid(*to), &pen.style()),
        Step::Path(places, pen) => backend.draw_path(places.iter().map(|p| grid(*p)), &pen.style()),
        Step::Area(places, pen) => backend.fill_polygon(places.iter().map(|p| grid(*p)), &pen.style()),
        Step::Rectangle(upper_left, lower_right, pen) => {
            let ((x0, y0), (x1, y1)) = (grid(*upper_left), grid(*lower_right));
            backend.draw_rect((x0, y0), (x1.max(x0), y1.max(y0)), &pen.style(), true)
        }
        Step::Circle(at, radius, pen, is_filled) => {
            let radius = (radius * FINENESS).round().clamp(1.0, 1e4) as u32;
            backend.draw_circle(grid(*at), radius, &pen.style(), *is_filled)
        }
        Step::Text { text, at, size, ink, align, upwards } => {
            let h = match align {
                Align::Left => HPos::Left,
                Align::Center => HPos::Center,
                Align::Right => HPos::Right,
            };
            let font = (FontFamily::Name(FONTS), size * FINENESS * PLOTTERS_FONT_RATIO, FontStyle::Normal);
            let color = RGBAColor(ink.rgb.0, ink.rgb.1, ink.rgb.2, ink.alpha);
            let style = TextStyle::from(font)
                .transform(if *upwards { FontTransform::Rotate270 } else { FontTransform::None })
                .color(&color)
                .pos(Pos::new(h, VPos::Center));
            markups.push(markup(text, size * FINENESS));
            backend.draw_text(&PLACE.to_string(), &style, grid(*at))
        }
    };
    drawn.map_err(|e| e.to_string())
}

/// The runs of a text as `tspan`s; `size` is the font size in drawing steps. A
/// superscript behind a subscript stands above it.
fn markup(text: &Rich, size: f64) -> String {
    let mut out = String::new();
    let mut raised = 0.0;
    let mut lower_width = 0.0;
    let mut owed = 0.0;
    for (style, run) in &text.runs {
        if run.is_empty() {
            continue;
        }
        let width = run.chars().map(letter_width).sum::<f64>() * SMALL * size;
        let (height, mut attributes) = match style {
            Style::Upright => (0.0, String::new()),
            Style::Bold => (0.0, " font-weight=\"600\"".to_owned()),
            Style::Italic => (0.0, " font-style=\"italic\"".to_owned()),
            Style::Subscript => (-0.26 * size, format!(" font-size=\"{:.0}\"", size * SMALL)),
            Style::Superscript => (0.52 * size, format!(" font-size=\"{:.0}\"", size * SMALL)),
        };
        let mut dx = owed;
        owed = 0.0;
        if *style == Style::Superscript && lower_width > 0.0 {
            dx -= lower_width;
            owed = (lower_width - width).max(0.0);
        }
        lower_width = if *style == Style::Subscript { width } else { 0.0 };
        if dx.abs() >= 0.5 {
            let _ = write!(attributes, " dx=\"{dx:.0}\"");
        }
        let dy: f64 = raised - height;
        raised = height;
        if dy != 0.0 {
            let _ = write!(attributes, " dy=\"{dy:.0}\"");
        }
        if attributes.is_empty() {
            out.push_str(&escaped(run));
        } else {
            let _ = write!(out, "<tspan{attributes}>{}</tspan>", escaped(run));
        }
    }
    out
}

/// Size of sub- and superscripts against the text.
const SMALL: f64 = 0.74;

/// The backend's elements without attributes that say what holds anyway: most of
/// a cloud of points. Opacity becomes that of the fill or the stroke, which
/// printers need no group for. No text of a record is in here yet.
fn slimmed(elements: &str) -> String {
    let mut out = String::with_capacity(elements.len());
    for line in elements.lines() {
        let line = line.replace(" opacity=\"1\"", "").replace(" stroke=\"none\" stroke-width=\"10\"", "");
        if line.starts_with("<circle") || line.starts_with("<polygon") || line.starts_with("<rect") {
            out.push_str(&line.replace(" opacity=", " fill-opacity="));
        } else if line.starts_with("<line") || line.starts_with("<polyline") {
            out.push_str(&line.replace(" opacity=", " stroke-opacity="));
        } else {
            out.push_str(&line);
        }
        out.push('\n');
    }
    out
}

/// Text safe inside an element; characters that XML forbids are left out.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' | PLACE => {}
            c if c.is_control() && !matches!(c, '\t' | '\n' | '\r') => {}
            c => out.push(c),
        }
    }
    out
}

/// Width of a text in CSS pixels, from the mean widths of a grotesque: within
/// about a tenth, enough to place a legend.
pub(crate) fn text_width(text: &Rich, size: f64) -> f64 {
    let mut total = 0.0;
    let mut lower_width = 0.0;
    for (style, run) in &text.runs {
        let scale = match style {
            Style::Subscript | Style::Superscript => SMALL,
            Style::Bold => 1.06,
            _ => 1.0,
        };
        let width = run.chars().map(letter_width).sum::<f64>() * scale * size;
        total += if *style == Style::Superscript { (width - lower_width).max(0.0) } else { width };
        lower_width = if *style == Style::Subscript { width } else { 0.0 };
    }
    total
}

fn letter_width(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' => 0.27,
        ' ' | 'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '/' | '-' => 0.33,
        'm' | 'M' | 'W' | '%' | '—' => 0.88,
        'w' | 'A'..='Z' => 0.69,
        '\u{1100}'..='\u{ffff}' if c >= '\u{2e80}' => 1.0,
        _ => 0.56,
    }
}

/// At most `limit` characters, the rest as an ellipsis.
pub(crate) fn shortened(text: &str, limit: usize) -> String {
    if text.chars().count() <= limit {
        return text.to_owned();
    }
    let kept: String = text.chars().take(limit.saturating_sub(1)).collect();
    format!("{}…", kept.trim_end())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_escaped_and_stays_text() {
        let mut canvas = Canvas::new(100.0, 50.0);
        canvas.text(Rich::plain("<b>&\u{0}\u{e000}x"), (10.0, 10.0), 12.0, WHITE, Align::Left);
        canvas.text(crate::symbol::symbol("C_d_II"), (f64::NAN, 1e300), 12.0, WHITE, Align::Right);
        let svg = canvas.svg("a", "t<", "d&").unwrap();
        assert!(svg.contains("&lt;b&gt;&amp;x"), "{svg}");
        assert!(svg.contains("<title id=\"a-title\">t&lt;</title>"));
        assert!(svg.contains(">II</tspan>") && svg.trim_end().ends_with("</svg>"));
        assert!(!svg.contains('\u{e000}') && !svg.contains('\u{0}'));
    }

    #[test]
    fn dashes_end_and_cover_their_part() {
        let mut canvas = Canvas::new(100.0, 50.0);
        canvas.dashed(&[(0.0, 0.0), (100.0, 0.0), (100.0, 0.0), (f64::NAN, 0.0)], WHITE, 1.0, 4.0, 3.0);
        let covered: f64 =
            canvas.steps.iter().map(|s| if let Step::Line((x0, _), (x1, _), _) = s { x1 - x0 } else { 0.0 }).sum();
        assert!((covered - 58.0).abs() < 1.0, "{covered}");
    }
}
