//! Tables as rows of written cells, for the page and the terminal.

use super::{Block, ResultColumn, ResultTable, Section, TableBuilder};
use crate::number::MISSING;
use crate::page::{DocumentSection, TextTable};

/// A table as people read it; `None` where programs alone read it.
#[must_use]
pub fn laid_out(table: &ResultTable) -> Option<TextTable> {
    let shown: Vec<&ResultColumn> = table.shown().collect();
    if shown.is_empty() {
        return None;
    }
    let unit = |column: &ResultColumn| column.unit.as_ref().map_or_else(String::new, |unit| unit.text.clone());
    if table.are_facts {
        let fact = |column: &&ResultColumn| Some(vec![column.head.clone(), column.text(0)?, unit(column)]);
        return Some(TextTable {
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
    Some(TextTable { caption: table.caption.clone(), head: shown.iter().map(head).collect(), rows })
}

impl ResultTable {
    /// The columns that people read.
    pub fn shown(&self) -> impl Iterator<Item = &ResultColumn> {
        self.columns.iter().filter(|column| !column.head.is_empty())
    }
}

/// A table whose cells are written already, for people alone.
impl From<TextTable> for ResultTable {
    fn from(TextTable { caption, head, rows }: TextTable) -> Self {
        let t = TableBuilder::new("", caption, &rows);
        let column = |(i, head): (usize, &String)| t.text("", head, move |row: &Vec<String>| row.get(i).cloned());
        t.build(head.iter().enumerate().map(column).collect())
    }
}

/// A section that is written already, for people alone.
impl From<DocumentSection> for Section {
    fn from(DocumentSection { title, paragraphs, tables, charts }: DocumentSection) -> Self {
        let tables = tables.into_iter().map(|table| ResultTable::from(table).into());
        Self::new(
            title,
            [Block::words(paragraphs)].into_iter().chain(tables).chain(charts.into_iter().map(Block::Chart)),
        )
    }
}

/// The same, with its tables before its sentences.
#[must_use]
pub fn summary(section: DocumentSection) -> Section {
    let mut out = Section::from(section);
    let is_words = |block: &Block| matches!(block, Block::Text { .. });
    out.blocks.sort_by_key(|block| (matches!(block, Block::Chart(_)), is_words(block)));
    out
}
