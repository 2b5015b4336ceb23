//! What pictures that are filled with colours share: axes outside of them, and the bar that says what a colour is.

use froude_records::page::Scale;

use crate::canvas::{Align, Canvas, Ink};
use crate::chart::{label, ticks};
use crate::plot::{LABEL_SIZE, MUTED, Panel, Span, TEXT, TICK_SIZE};
use crate::symbol::Rich;

/// Parts of a bar, and shades of a picture.
pub(crate) const SHADES: usize = 100;
/// Between a picture and its bar, and the bar's width.
pub(crate) const GAP: f64 = 26.0;
pub(crate) const BAR: f64 = 18.0;
/// For the bar's numbers and name.
pub(crate) const RIGHT: f64 = 84.0;
/// By how much a part goes under its neighbours, so that nothing shines through.
pub(crate) const OVER: f64 = 0.7;

/// Ticks and labels, as many as wanted along each axis; an axis may fall.
pub(crate) fn axes(canvas: &mut Canvas, frame: &Panel, labels: [&str; 2], wanted: [usize; 2]) {
    let rising = |s: Span| Span { low: s.low.min(s.high), high: s.low.max(s.high) };
    let (x, y) = (rising(frame.x).ticks(wanted[0]), rising(frame.y).ticks(wanted[1]));
    for &place in &y.places {
        canvas.line((frame.left - 5.0, frame.at_y(place)), (frame.left, frame.at_y(place)), MUTED, 1.0);
        let at = (frame.left - 8.0, frame.at_y(place));
        canvas.text(&Rich::plain(&y.label(place)), at, TICK_SIZE, MUTED, Align::Right);
    }
    for &place in &x.places {
        canvas.line((frame.at_x(place), frame.bottom()), (frame.at_x(place), frame.bottom() + 5.0), MUTED, 1.0);
        let at = (frame.at_x(place), frame.bottom() + 15.0);
        canvas.text(&Rich::plain(&x.label(place)), at, TICK_SIZE, MUTED, Align::Center);
    }
    let middle = frame.top + 0.5 * frame.height;
    canvas.upward_text(&y.titled(Rich::plain(labels[1])), (14.0, middle), LABEL_SIZE, TEXT);
    let at = (frame.left + 0.5 * frame.width, frame.bottom() + 38.0);
    canvas.text(&x.titled(Rich::plain(labels[0])), at, LABEL_SIZE, TEXT, Align::Center);
}

/// The bar of a range from `low` to `high` on a scale, in the place of `bar`, its name at `name_x`.
pub(crate) fn bar(canvas: &mut Canvas, bar: &Panel, scale: Scale, name: &str, name_x: f64, ink: fn(f64) -> Ink) {
    let at = |part: usize| bar.bottom() - bar.height * part as f64 / SHADES as f64;
    for part in 0..SHADES {
        canvas.rectangle((bar.left, at(part + 1) - OVER), (bar.right(), at(part)), ink(shade(part)));
    }
    let ticks = ticks(bar.y, scale, 6);
    for &place in &ticks.places {
        canvas.line((bar.right(), bar.at_y(place)), (bar.right() + 4.0, bar.at_y(place)), MUTED, 1.0);
        let at = (bar.right() + 8.0, bar.at_y(place));
        canvas.text(&label(&ticks, scale, place), at, TICK_SIZE, MUTED, Align::Left);
    }
    let middle = bar.top + 0.5 * bar.height;
    canvas.upward_text(&ticks.titled(Rich::plain(name)), (name_x, middle), LABEL_SIZE, TEXT);
}

/// The place of a shade between 0 and 1.
pub(crate) fn shade(part: usize) -> f64 {
    (part as f64 + 0.5) / SHADES as f64
}
