//! The figures of a report, in the order in which they stand in it.
//!
//! Every figure is drawn from the records alone and with an upper limit on what
//! is drawn, so that ten million observations give a picture and not a file that
//! nobody can open; a caption says when points were left out.

mod budget;
mod forest;
mod loads;
mod residuals;

use froude_records::estimate::Estimate;

use crate::canvas::Canvas;
use crate::input::{Report, ReportError};
use froude_records::page::Chart;
use froude_records::page::SourceSection;

use budget::budget_drawing;
pub(crate) use budget::{budget_rows, ranked_inputs, share};
use forest::forest_drawings;
use loads::load_drawings;
use residuals::residual_drawings;

/// Most points drawn in one panel.
const MOST_POINTS: usize = 1500;

/// Most lines named in a legend.
const MOST_NAMED: usize = 8;

/// Most rows in a forest plot or a bar chart.
const MOST_ROWS: usize = 24;

/// A figure of the report.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// Name for a file of its own, unique in the report: `figure-03-tank-f_x-against-speed.svg`.
    pub file_name: String,
    /// Title in a few words.
    pub title: String,
    /// Caption, in whole sentences.
    pub caption: String,
    /// The picture: an SVG document.
    pub svg: String,
}

/// Where in the report a figure stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Place {
    Block(usize),
    Loads(usize),
    Residuals(usize),
    Budget(usize),
    Forest,
}

/// A figure before it has its number.
struct Drawing {
    slug: String,
    title: String,
    caption: String,
    canvas: Canvas,
}

/// The figures of a report, each as an SVG document of its own.
///
/// # Errors
///
/// [`ReportError::Figure`] when the drawing library refuses a figure.
pub fn figures(report: &Report) -> Result<Vec<Figure>, ReportError> {
    Ok(placed_figures(report)?.into_iter().map(|(_, figure)| figure).collect())
}

/// All figures with their places, numbered through.
pub(crate) fn placed_figures(report: &Report) -> Result<Vec<(Place, Figure)>, ReportError> {
    let mut drawings: Vec<(Place, Drawing)> = Vec::new();
    for (i, block) in report.blocks.iter().enumerate() {
        let drawing = |chart: &Chart| Drawing {
            slug: chart.name.clone(),
            title: chart.title.clone(),
            caption: chart.caption.clone(),
            canvas: crate::chart::canvas(chart),
        };
        drawings.extend(block.charts.iter().map(|chart| (Place::Block(i), drawing(chart))));
    }
    for (i, section) in report.sources.iter().enumerate() {
        drawings.extend(load_drawings(section).into_iter().map(|d| (Place::Loads(i), d)));
        drawings.extend(residual_drawings(section).into_iter().map(|d| (Place::Residuals(i), d)));
        drawings.extend(budget_drawing(section).into_iter().map(|d| (Place::Budget(i), d)));
    }
    drawings.extend(forest_drawings(report).into_iter().map(|d| (Place::Forest, d)));
    drawings
        .into_iter()
        .enumerate()
        .map(|(i, (place, drawing))| {
            let id = format!("figure-{:02}", i + 1);
            let svg = drawing
                .canvas
                .svg(&id, &drawing.title, &drawing.caption)
                .map_err(|reason| ReportError::Figure { figure: drawing.title.clone(), reason })?;
            let file_name = format!("{id}-{}.svg", slug(&drawing.slug));
            Ok((place, Figure { file_name, title: drawing.title, caption: drawing.caption, svg }))
        })
        .collect()
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

/// Distinct texts in the order of their appearance.
fn distinct<'a>(texts: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let mut seen = std::collections::BTreeSet::new();
    texts.into_iter().filter(|t| seen.insert(*t)).collect()
}

/// What a caption states about points that are a sample.
fn drawn_by_chance(section: &SourceSection) -> String {
    section.sample_of.map_or_else(String::new, |n| format!(" The points are a random sample of {n} observations."))
}

/// Every `n`th of many, so that at most `limit` stay.
fn thinned<T: Copy>(all: &[T], limit: usize) -> Vec<T> {
    let step = all.len().div_ceil(limit.max(1)).max(1);
    all.iter().copied().step_by(step).collect()
}

/// At most `limit` of a list, first and last among them.
fn evenly<T: Copy>(all: &[T], limit: usize) -> Vec<T> {
    if all.len() <= limit || limit < 2 {
        return all.iter().copied().take(limit.max(1)).collect();
    }
    (0..limit).map(|i| all[i * (all.len() - 1) / (limit - 1)]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slugs_are_safe_and_short() {
        assert_eq!(slug("circulation tank/f_x <1>"), "circulation-tank-f_x-1");
        assert_eq!(slug("../../etc"), "etc");
        assert!(slug(&"x".repeat(500)).len() <= 48);
    }

    #[test]
    fn evenly_keeps_both_ends() {
        let all: Vec<usize> = (0..31).collect();
        let few = evenly(&all, 8);
        assert_eq!((few.len(), few[0], few[7]), (8, 0, 30));
        assert_eq!(evenly(&all[..3], 8), [0, 1, 2]);
    }
}
