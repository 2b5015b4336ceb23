//! Cells and tables as the terminal shows them.

use comfy_table::{Cell, CellAlignment, ContentArrangement, Table};

use crate::out::say;

pub fn table(header: &[&str]) -> Table {
    let mut table = Table::new();
    table
        .load_style(comfy_table::presets::UTF8_HORIZONTAL_ONLY)
        .set_content_arrangement(ContentArrangement::Dynamic)
        .set_width(WIDEST)
        .set_header(header.iter().map(cell));
    table
}

/// A cell; of a text that no table can show, its beginning.
pub fn cell(text: impl ToString) -> Cell {
    let text = text.to_string();
    match text.char_indices().nth(LONGEST_CELL) {
        Some((end, _)) => Cell::new(format!("{}…", &text[..end])),
        None => Cell::new(text),
    }
}

pub fn right(text: String) -> Cell {
    cell(text).set_alignment(CellAlignment::Right)
}

/// Prints a sentence in lines of at most [`WIDEST`] characters, two spaces in.
pub fn sentence(text: &str) {
    let mut line = " ".to_owned();
    for word in text.split_whitespace() {
        if line.chars().count() + 1 + word.chars().count() > usize::from(WIDEST) && !line.trim().is_empty() {
            say!("{line}");
            line.clear();
            line.push_str("   ");
        }
        line = line + " " + word;
    }
    say!("{line}");
}

/// Widest line of a table: what a printed page and most terminals hold.
pub(crate) const WIDEST: u16 = 120;

/// Longest text of a cell, in characters: the table is laid out letter by letter.
pub(crate) const LONGEST_CELL: usize = 1000;
