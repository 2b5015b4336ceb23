//! What all drawings share: how many points and names they hold, and which are drawn.

use froude_records::estimate::Estimate;
use froude_records::page::SourceSection;

use crate::canvas::Canvas;

/// Most points drawn in one panel.
pub(crate) const MOST_POINTS: usize = 1500;

/// Most lines named in a legend.
pub(crate) const MOST_NAMED: usize = 8;

/// Most rows in a forest plot or a bar chart.
pub(crate) const MOST_ROWS: usize = 24;

/// A figure before it has its number.
pub(crate) struct Drawing {
    pub(crate) slug: String,
    pub(crate) title: String,
    pub(crate) caption: String,
    pub(crate) canvas: Canvas,
}

/// A name made safe for files and anchors.
pub(crate) fn slug(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        if out.len() >= 48 {
            break;
        }
        if c.is_ascii_alphanumeric() || c == '_' {
            out.push(c.to_ascii_lowercase());
        } else if !out.ends_with('-') && !out.is_empty() {
            out.push('-');
        }
    }
    out.trim_matches('-').to_owned()
}

/// The estimate that the summary shows: the recommended one, else none.
pub(crate) fn recommended(section: &SourceSection) -> Option<&Estimate> {
    section.estimates.iter().find(|e| e.recommended)
}

/// What a caption states about points that are a sample.
pub(crate) fn drawn_by_chance(section: &SourceSection) -> String {
    section.sample_of.map_or_else(String::new, |n| format!(" The points are a random sample of {n} observations."))
}

/// Every `n`th of many, so that at most `limit` stay.
pub(crate) fn thinned<T: Copy>(all: &[T], limit: usize) -> Vec<T> {
    let step = all.len().div_ceil(limit.max(1)).max(1);
    all.iter().copied().step_by(step).collect()
}

/// At most `limit` of a list, first and last among them.
pub(crate) fn evenly<T: Copy>(all: &[T], limit: usize) -> Vec<T> {
    if all.len() <= limit || limit < 2 {
        return all.iter().copied().take(limit.max(1)).collect();
    }
    (0..limit).map(|i| all[i * (all.len() - 1) / (limit - 1)]).collect()
}
