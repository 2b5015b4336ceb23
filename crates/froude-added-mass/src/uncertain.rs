//! Numbers that people read otherwise than programs.

use froude_records::block::{ResultColumn, TableBuilder};
use froude_records::number;

/// A value with its expanded uncertainty.
#[must_use]
pub fn with_uncertainty([value, expanded]: [f64; 2]) -> String {
    if expanded.is_finite() { number::plus_minus(value, expanded) } else { number::plain(value, 6) }
}

/// Columns of values with their expanded uncertainties, which have keys of their own.
pub fn expanded<'r, R>(
    t: &TableBuilder<'r, R>,
    key: &str,
    head: &str,
    of: impl Fn(&'r R) -> [f64; 2],
) -> [ResultColumn; 3] {
    [
        t.number(key, "", |row| of(row)[0]),
        t.number(&format!("expanded_95/{key}"), "", |row| of(row)[1]),
        t.text("", head, |row| with_uncertainty(of(row))),
    ]
}

/// A column of numbers, and of `words` of them for people.
pub fn told<'r, R, N: Into<Option<f64>>>(
    t: &TableBuilder<'r, R>,
    key: &str,
    head: &str,
    of: impl Fn(&'r R) -> N,
    words: impl Fn(f64) -> String,
) -> [ResultColumn; 2] {
    [t.number(key, "", &of), t.text("", head, |row| of(row).into().map(&words))]
}

/// Percent to two places, with its sign.
pub fn signed_percent(part: f64) -> String {
    format!("{:+.2} %", 100.0 * part)
}
