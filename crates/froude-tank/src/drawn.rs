//! Charts of runs.

use froude_records::page::{Chart, ChartPanel, Mark, Series};

pub(crate) fn series(name: &str, mark: Mark, x: impl Into<Vec<f64>>, y: impl Into<Vec<f64>>) -> Series {
    Series { name: name.to_owned(), mark, x: x.into(), y: y.into(), ..Series::default() }
}

pub(crate) fn panel(y_label: String, series: Vec<Series>) -> ChartPanel {
    ChartPanel { y_label, series, ..ChartPanel::default() }
}

/// Panels over the time, s.
pub(crate) fn over_time([name, title]: [&str; 2], caption: String, panels: Vec<ChartPanel>) -> Chart {
    let [name, title, x_label] = [name, title, "time [s]"].map(str::to_owned);
    Chart { name, title, caption, x_label, panels, ..Chart::default() }
}

/// `the first 6 of ` runs, where not all are drawn.
pub(crate) fn first_of(drawn: usize, all: usize) -> String {
    if drawn < all { format!("the first {drawn} of ") } else { String::new() }
}
