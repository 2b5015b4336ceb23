//! The figures of a report, in the order in which they stand in it.
//!
//! Every figure is drawn from the records alone and with an upper limit on what
//! is drawn, so that ten million observations give a picture and not a file that
//! nobody can open; a caption says when points were left out.

mod budget;
pub(crate) mod drawing;
mod forest;
mod loads;
mod residuals;

use budget::budget_drawing;
use forest::forest_drawings;
use froude_records::block::Block;
use loads::load_drawings;
use residuals::residual_drawings;

use crate::figures::drawing::{Drawing, slug};
use froude_records::page::Report;

pub(crate) use budget::{budget_rows, ranked_inputs, share};

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

/// The figures of a report, each as an SVG document of its own.
#[must_use]
pub fn figures(report: &Report) -> Vec<Figure> {
    placed_figures(report).into_iter().map(|(_, figure)| figure).collect()
}

/// All figures with their places, numbered through.
pub(crate) fn placed_figures(report: &Report) -> Vec<(Place, Figure)> {
    let mut drawings: Vec<(Place, Drawing)> = Vec::new();
    for (i, section) in report.blocks.iter().enumerate() {
        drawings.extend(drawings_of(&section.blocks).into_iter().map(|d| (Place::Block(i), d)));
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
            let svg = drawing.canvas.svg(&id, &drawing.title, &drawing.caption);
            let file_name = format!("{id}-{}.svg", slug(&drawing.slug));
            (place, Figure { file_name, title: drawing.title, caption: drawing.caption, svg })
        })
        .collect()
}

/// The drawings of blocks, in their order.
fn drawings_of(blocks: &[Block]) -> Vec<Drawing> {
    let of = |block: &Block| {
        let (name, title, caption, canvas) = match block {
            Block::Chart(chart) => (&chart.name, &chart.title, chart.caption.clone(), crate::chart::canvas(chart)),
            Block::Map(map) => (&map.name, &map.title, map.caption.clone(), crate::map::canvas(map)),
            Block::Field(field) => {
                (&field.name, &field.title, crate::field::caption(field), crate::field::canvas(field))
            }
            Block::Section(section) => return drawings_of(&section.blocks),
            Block::Text { .. } | Block::Table(_) | Block::Estimates(_) => return Vec::new(),
        };
        vec![Drawing { slug: name.clone(), title: title.clone(), caption, canvas }]
    };
    blocks.iter().flat_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::drawing::evenly;

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
