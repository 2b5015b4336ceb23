//! Tables as rows of written cells, for the page and the terminal.

use super::{ResultColumn, ResultTable};
use crate::number::MISSING;

/// A table whose cells are written, with the digits that their uncertainty allows.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct LaidOut {
    /// Caption.
    pub caption: String,
    /// Column heads, units included.
    pub head: Vec<String>,
    /// Rows, a cell per head; the first cell names the row.
    pub rows: Vec<Vec<String>>,
}

/// A table as people read it; `None` where it is JSON only.
#[must_use]
pub fn laid_out(table: &ResultTable) -> Option<LaidOut> {
    let shown: Vec<&ResultColumn> = table.shown().collect();
    if shown.is_empty() {
        return None;
    }
    let unit = |column: &ResultColumn| column.unit.as_ref().map_or_else(String::new, |unit| unit.text.clone());
    if table.are_facts {
        let fact = |column: &&ResultColumn| Some(vec![column.head.clone(), column.text(0)?, unit(column)]);
        return Some(LaidOut {
            caption: table.caption.clone(),
            head: ["quantity", "value", "unit"].map(str::to_owned).to_vec(),
            rows: shown.iter().filter_map(fact).collect(),
        });
    }
    let head = |column: &&ResultColumn| match unit(column) {
        none if none.is_empty() => column.head.clone(),
        unit => format!("{} [{unit}]", column.head),
    };
    let row = |row: usize| -> Vec<String> {
        shown.iter().map(|column| column.text(row).unwrap_or_else(|| MISSING.to_owned())).collect()
    };
    let rows = match &table.shown_rows {
        Some(rows) => rows.iter().map(|&i| row(i)).collect(),
        None => (0..table.n_rows).map(row).collect(),
    };
    Some(LaidOut { caption: table.caption.clone(), head: shown.iter().map(head).collect(), rows })
}

impl ResultTable {
    /// The columns that people read.
    pub fn shown(&self) -> impl Iterator<Item = &ResultColumn> {
        self.columns.iter().filter(|column| !column.head.is_empty())
    }
}
