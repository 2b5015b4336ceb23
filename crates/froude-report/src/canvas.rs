//! A drawing surface in typographic points of the screen, which writes SVG.
//!
//! Coordinates here are CSS pixels with fractions. What is written are whole steps, ten to a pixel, and the view box scales the picture:
//! that is a third shorter than fractions. Text stays text; symbols get real sub- and superscripts.

use std::fmt::Write as _;

use froude_records::text::visible;

use crate::symbol::{Rich, Style};

/// Steps of the drawing grid per CSS pixel.
const FINENESS: f64 = 10.0;

/// Coordinates beyond this are cut, so that none leaves the integers.
const FARTHEST: f64 = 1e6;

/// Fonts of the figures: what laboratories print with, then what is there.
const FONTS: &str = "&apos;Source Sans 3&apos;, &apos;Segoe UI&apos;, &apos;Helvetica Neue&apos;, Arial, &apos;Liberation Sans&apos;, sans-serif";

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

    /// As the fill or the stroke of an element.
    fn paint(self, of: &str) -> String {
        let Self { rgb: (r, g, b), alpha } = self;
        let opacity = if alpha == 1.0 { String::new() } else { format!(" {of}-opacity=\"{alpha}\"") };
        format!("{opacity} {of}=\"#{r:02X}{g:02X}{b:02X}\"")
    }

    fn stroke(self, width: f64) -> String {
        let steps = (width * FINENESS).round().clamp(1.0, 1000.0);
        format!("{} stroke-width=\"{steps}\"", self.paint("stroke"))
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
    /// Elements, one a line.
    body: String,
    /// Areas side by side, under all elements: each ink with its outlines, as SVG writes them.
    mosaic: Vec<(Ink, String)>,
}

fn grid(at: Xy) -> (i32, i32) {
    let step = |x: f64| {
        if x.is_finite() { (x.clamp(-FARTHEST, FARTHEST) * FINENESS).round() as i32 } else { 0 }
    };
    (step(at.0), step(at.1))
}

/// Corners of a line or an area.
fn points(places: &[Xy]) -> String {
    places.iter().map(|place| grid(*place)).fold(String::new(), |mut out, (x, y)| {
        let _ = write!(out, "{x},{y} ");
        out
    })
}

impl Canvas {
    pub(crate) fn new(width: f64, height: f64) -> Self {
        Self { width, height, body: String::new(), mosaic: Vec::new() }
    }

    pub(crate) fn line(&mut self, from: Xy, to: Xy, ink: Ink, width: f64) {
        let ((x1, y1), (x2, y2), stroke) = (grid(from), grid(to), ink.stroke(width));
        let _ = writeln!(self.body, "<line{stroke} x1=\"{x1}\" y1=\"{y1}\" x2=\"{x2}\" y2=\"{y2}\"/>");
    }

    pub(crate) fn path(&mut self, places: &[Xy], ink: Ink, width: f64) {
        if places.len() > 1 {
            let (stroke, points) = (ink.stroke(width), points(places));
            let _ = writeln!(self.body, "<polyline fill=\"none\"{stroke} points=\"{points}\"/>");
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

    pub(crate) fn area(&mut self, places: &[Xy], ink: Ink) {
        if places.len() > 2 {
            let _ = writeln!(self.body, "<polygon{} points=\"{}\"/>", ink.paint("fill"), points(places));
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
        let ((x0, y0), (x1, y1), fill) = (grid(upper_left), grid(lower_right), ink.paint("fill"));
        let (width, height) = ((x1 - x0).max(0), (y1 - y0).max(0));
        let _ = writeln!(
            self.body,
            "<rect x=\"{x0}\" y=\"{y0}\" width=\"{width}\" height=\"{height}\"{fill} stroke=\"none\"/>"
        );
    }

    /// A filled disc with a white rim, so that neighbours stay apart.
    pub(crate) fn dot(&mut self, at: Xy, radius: f64, ink: Ink) {
        self.speck(at, radius + 0.8, WHITE);
        self.speck(at, radius, ink);
    }

    /// A small disc without rim, for clouds of points.
    pub(crate) fn speck(&mut self, at: Xy, radius: f64, ink: Ink) {
        self.circle(at, radius, &ink.paint("fill"));
    }

    /// An open ring on white.
    pub(crate) fn ring(&mut self, at: Xy, radius: f64, ink: Ink, width: f64) {
        self.speck(at, radius, WHITE);
        self.circle(at, radius, &format!(" fill=\"none\"{}", ink.stroke(width)));
    }

    fn circle(&mut self, at: Xy, radius: f64, paint: &str) {
        let ((x, y), radius) = (grid(at), (radius * FINENESS).round().clamp(1.0, 1e4));
        let _ = writeln!(self.body, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\"{paint}/>");
    }

    /// Text whose middle height lies on `at`.
    pub(crate) fn text(&mut self, text: &Rich, at: Xy, size: f64, ink: Ink, align: Align) {
        self.write(text, at, size, ink, align, false);
    }

    /// Centred text that reads upwards.
    pub(crate) fn upward_text(&mut self, text: &Rich, at: Xy, size: f64, ink: Ink) {
        self.write(text, at, size, ink, Align::Center, true);
    }

    fn write(&mut self, text: &Rich, at: Xy, size: f64, ink: Ink, align: Align, is_upwards: bool) {
        let ((x, y), size) = (grid(at), size * FINENESS);
        let anchor = match align {
            Align::Left => "start",
            Align::Center => "middle",
            Align::Right => "end",
        };
        let turned = if is_upwards { format!(" transform=\"rotate(270, {x}, {y})\"") } else { String::new() };
        let _ = writeln!(
            self.body,
            "<text x=\"{x}\" y=\"{y}\" dy=\"0.5ex\" text-anchor=\"{anchor}\" font-family=\"{FONTS}\" font-size=\"{size}\"{}{turned}>\n{}\n</text>",
            ink.paint("fill"),
            markup(text, size),
        );
    }

    /// The picture as SVG, with a title and a description for readers who do not see it.
    pub(crate) fn svg(&self, id: &str, title: &str, description: &str) -> String {
        let (w, h) = grid((self.width, self.height));
        let mut out = String::with_capacity(self.body.len() + 1024);
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
        out.push_str(&self.body);
        out.push_str("</svg>\n");
        visible(&out).into_owned()
    }
}

/// White.
pub(crate) const WHITE: Ink = Ink::new(0xff_ff_ff);

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

/// Text safe inside an element; characters that XML forbids are left out.
pub(crate) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '&' => out.push_str("&amp;"),
            '"' => out.push_str("&quot;"),
            '\u{fffe}' | '\u{ffff}' => {}
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
        canvas.text(&Rich::plain("<b>&\u{0}x"), (10.0, 10.0), 12.0, WHITE, Align::Left);
        canvas.text(&crate::symbol::symbol("C_d_II"), (f64::NAN, 1e300), 12.0, WHITE, Align::Right);
        let svg = canvas.svg("a", "t<", "d&");
        assert!(svg.contains("&lt;b&gt;&amp;x"), "{svg}");
        assert!(svg.contains("<title id=\"a-title\">t&lt;</title>"));
        assert!(svg.contains(">II</tspan>") && svg.trim_end().ends_with("</svg>"));
        assert!(!svg.contains('\u{0}'));
    }

    #[test]
    fn dashes_end_and_cover_their_part() {
        let mut canvas = Canvas::new(100.0, 50.0);
        canvas.dashed(&[(0.0, 0.0), (100.0, 0.0), (100.0, 0.0), (f64::NAN, 0.0)], WHITE, 1.0, 4.0, 3.0);
        let number = |line: &str, name: &str| -> f64 {
            line.split_once(&format!(" {name}=\"")).unwrap().1.split('"').next().unwrap().parse().unwrap()
        };
        let lines = canvas.body.lines();
        let covered = lines.map(|line| number(line, "x2") - number(line, "x1")).sum::<f64>() / FINENESS;
        assert!((covered - 58.0).abs() < 1.0, "{covered}");
    }
}
