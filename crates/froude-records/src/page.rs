//! What a page is made from: figures of any two quantities, and the report on a record.
//!
//! Whoever has a result says every word and every number of it here; a page or a terminal shows them. Nothing is computed or drawn.

mod observation;
mod report;
mod source;

pub use observation::{Abscissa, Against, Curve, Observed, Point};
pub use report::{InputFile, Report};
pub use source::{BudgetRow, SelectionRow, SourceSection};

/// How an axis runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Scale {
    /// Evenly.
    #[default]
    Linear,
    /// In decades; numbers ≤ 0 are not drawn.
    Logarithmic,
}

/// How a series is drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Mark {
    /// A line.
    #[default]
    Line,
    /// A dashed line: a reference, a limit.
    Dashed,
    /// Points, with bars where `low` and `high` are given.
    Points,
}

/// One line or cloud of points. `low` and `high` are empty or as long as `y`.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Series {
    /// Name in the legend; series of the same name share a colour and an entry.
    pub name: String,
    /// How it is drawn.
    pub mark: Mark,
    /// Abscissae.
    pub x: Vec<f64>,
    /// Ordinates.
    pub y: Vec<f64>,
    /// Lower ends of the interval.
    pub low: Vec<f64>,
    /// Upper ends.
    pub high: Vec<f64>,
}

/// One panel.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ChartPanel {
    /// Label of the ordinate, unit included: `|L| [1]`.
    pub y_label: String,
    /// How it runs.
    pub y_scale: Scale,
    /// What is drawn.
    pub series: Vec<Series>,
}

/// A figure of panels over one abscissa.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Chart {
    /// Stem of the file's name.
    pub name: String,
    /// Title, for readers who do not see the picture.
    pub title: String,
    /// Caption below the figure.
    pub caption: String,
    /// Label of the abscissa, unit included.
    pub x_label: String,
    /// How it runs.
    pub x_scale: Scale,
    /// From top to bottom.
    pub panels: Vec<ChartPanel>,
}

/// One quantity over two: a cell for each pair.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Map {
    /// Stem of the file's name.
    pub name: String,
    /// Title, for readers who do not see the picture.
    pub title: String,
    /// Caption below the figure.
    pub caption: String,
    /// Label of the abscissa, unit included.
    pub x_label: String,
    /// Label of the ordinate, unit included.
    pub y_label: String,
    /// Name of what is shown, unit included.
    pub value_label: String,
    /// How its colours run.
    pub value_scale: Scale,
    /// Abscissae, rising.
    pub x: Vec<f64>,
    /// Ordinates, rising.
    pub y: Vec<f64>,
    /// A row per ordinate, a column per abscissa; what is no number, or has no place on the scale, is hatched.
    pub values: Vec<f64>,
    /// Column and row of the cell that is marked, with its name.
    pub best: Option<(usize, usize, String)>,
}

/// A quantity over a plane, in one view or several.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Field {
    /// Stem of the file's name.
    pub name: String,
    /// Title, for readers who do not see the picture.
    pub title: String,
    /// Caption below the figure; what was left out is said behind it.
    pub caption: String,
    /// Name of what is shown, unit included.
    pub value_label: String,
    /// From top to bottom, all of one scale and with the same colours.
    pub views: Vec<View>,
}

/// One view.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct View {
    /// Above it.
    pub title: String,
    /// Label of the abscissa, unit included.
    pub x_label: String,
    /// Label of the ordinate, unit included.
    pub y_label: String,
    /// Abscissae at the left and at the right edge; they may fall.
    pub x: [f64; 2],
    /// Ordinates at the lower and at the upper edge; they may fall.
    pub y: [f64; 2],
    /// What is filled; a later one covers an earlier one, and what leaves the edges is cut.
    pub polygons: Vec<Polygon>,
    /// Lines over them.
    pub lines: Vec<[[f64; 2]; 2]>,
    /// Direction of a flow, with its name.
    pub flow: Option<([f64; 2], String)>,
}

/// A convex polygon of one value.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Polygon {
    /// Its corners in their order around it.
    pub corners: Vec<[f64; 2]>,
    /// Its value.
    pub value: f64,
}
