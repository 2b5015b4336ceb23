//! Blocks and findings as a terminal shows them.

use comfy_table::{Cell, CellAlignment, ContentArrangement, LineStyle, Table};
use froude_records::block::{Block, LaidOut, laid_out};
use froude_records::finding::{Finding, Severity};
use froude_records::text::visible;

/// Blocks as lines of at most 120 characters, with an empty line between them; `has_details` where a person asked for details too.
#[must_use]
pub fn blocks(all: &[Block], has_details: bool) -> Vec<String> {
    let mut out = Vec::new();
    add(all, has_details, &mut out);
    out
}

fn add(all: &[Block], has_details: bool, out: &mut Vec<String>) {
    let gap = |out: &mut Vec<String>| {
        if !out.is_empty() {
            out.push(String::new());
        }
    };
    for block in all {
        match block {
            Block::Text { texts, .. } if !texts.is_empty() => {
                gap(out);
                out.extend(texts.iter().map(|text| if text.starts_with("  ") { hanging(text) } else { text.clone() }));
            }
            Block::Table(table) => {
                let Some(text) = laid_out(table).filter(|table| !table.rows.is_empty()) else { continue };
                gap(out);
                if !text.caption.is_empty() {
                    out.push(wrapped(&text.caption));
                }
                for panel in panels(printable(text), 1 + table.more_names, WIDEST) {
                    out.push(fitted(&panel, WIDEST).to_string());
                }
            }
            Block::Section(section) if !section.is_detail || has_details => {
                add(&section.blocks, has_details, out);
            }
            Block::Text { .. }
            | Block::Section(_)
            | Block::Estimates(_)
            | Block::Chart(_)
            | Block::Map(_)
            | Block::Field(_) => {}
        }
    }
}

/// Findings, as they are given.
#[must_use]
pub fn findings(findings: &[Finding]) -> Vec<String> {
    if findings.is_empty() {
        return vec!["No findings.".to_owned()];
    }
    let line = |f: &Finding| {
        let grade = match f.severity {
            Severity::Error => "ERROR  ",
            Severity::Warning => "warning",
            Severity::Note => "note   ",
        };
        let source = f.source.as_ref().map_or(String::new(), |s| format!("{s}: "));
        format!("  {grade}  [{}] {source}{}", f.code, f.message)
    };
    std::iter::once("Findings".to_owned()).chain(findings.iter().map(line)).collect()
}

/// A text in lines of at most 120 characters.
#[must_use]
pub fn wrapped(text: &str) -> String {
    wrap(text, WIDEST)
}

/// Control characters are escaped before a text is wrapped: a carriage return would count as a space.
fn printable(text: LaidOut) -> LaidOut {
    let all = |cells: Vec<String>| cells.iter().map(|cell| visible(cell).into_owned()).collect::<Vec<_>>();
    LaidOut { caption: String::new(), head: all(text.head), rows: text.rows.into_iter().map(all).collect() }
}

/// What is said of something above: it stands two spaces in, and its further lines four.
fn hanging(text: &str) -> String {
    format!("  {}", wrap(text, WIDEST - 4).replace('\n', "\n    "))
}

/// A table that is too wide for its words, in several that each begin with the columns that name its rows.
fn panels(text: LaidOut, names: usize, widest: usize) -> Vec<LaidOut> {
    let least = |i: usize| {
        let cells = std::iter::once(&text.head).chain(&text.rows).filter_map(|row| row.get(i));
        3 + cells.flat_map(|cell| words(cell)).map(|word| word.chars().count()).max().unwrap_or(0)
    };
    let columns = text.head.len();
    let named: usize = (0..names.min(columns)).map(least).sum();
    let (mut out, mut left): (Vec<Vec<usize>>, usize) = (Vec::new(), 0);
    for i in names.min(columns)..columns {
        let own = least(i);
        match out.last_mut().filter(|_| own <= left) {
            Some(panel) => panel.push(i),
            None => {
                out.push(vec![i]);
                left = (widest + 1).saturating_sub(named);
            }
        }
        left = left.saturating_sub(own);
    }
    if out.len() < 2 {
        return vec![text];
    }
    let part = |panel: Vec<usize>| {
        let of =
            |row: &Vec<String>| (0..names).chain(panel.iter().copied()).filter_map(|i| row.get(i).cloned()).collect();
        LaidOut { caption: String::new(), head: of(&text.head), rows: text.rows.iter().map(of).collect() }
    };
    out.into_iter().map(part).collect()
}

/// A table as wide as the line; numbers to the right. No word is broken: a table of long words is wider.
fn fitted(text: &LaidOut, widest: usize) -> Table {
    let widths = widths(text, widest);
    let wrapped = |row: &[String]| -> Vec<String> {
        row.iter().enumerate().map(|(i, cell)| wrap(cell, widths.get(i).copied().unwrap_or(usize::MAX))).collect()
    };
    let mut out = Table::new();
    out.load_style(comfy_table::presets::UTF8_HORIZONTAL_ONLY.row_separator(LineStyle::none()))
        .set_content_arrangement(ContentArrangement::Disabled)
        .set_header(wrapped(&text.head));
    for row in &text.rows {
        out.add_row(wrapped(row).into_iter().enumerate().map(|(i, cell)| {
            self::cell(cell).set_alignment(if i == 0 { CellAlignment::Left } else { CellAlignment::Right })
        }));
    }
    out
}

/// A cell; of a text that no table can show, its beginning.
fn cell(text: String) -> Cell {
    match text.char_indices().nth(LONGEST_CELL) {
        Some((end, _)) => Cell::new(format!("{}…", &text[..end])),
        None => Cell::new(text),
    }
}

/// Widest line of a table: what a printed page and most terminals hold.
const WIDEST: usize = 120;
/// Longest text of a cell, in characters: the table is laid out letter by letter.
const LONGEST_CELL: usize = 1000;
/// A first column up to this is not wrapped.
const LONGEST_NAME: usize = 24;

/// A width for each column: that of its longest word, and what is left of the line to the columns that would be wrapped most.
fn widths(text: &LaidOut, widest: usize) -> Vec<usize> {
    let columns = || 0..text.head.len();
    let cells = |i: usize| std::iter::once(&text.head).chain(&text.rows).filter_map(move |row| row.get(i));
    let length = |t: &str| t.chars().count();
    let whole: Vec<usize> = columns().map(|i| cells(i).map(|c| length(c)).max().unwrap_or(0)).collect();
    let mut out: Vec<usize> =
        columns().map(|i| cells(i).flat_map(|c| words(c)).map(|w| length(&w)).max().unwrap_or(0)).collect();
    // A space on either side of each column, and one between them.
    let mut left = (widest + 1).saturating_sub(out.iter().sum::<usize>() + 3 * out.len());
    // What names the row stays on one line, where it is a name and not a sentence.
    if let (Some(first), Some(&name)) = (out.first_mut(), whole.first())
        && name <= LONGEST_NAME
        && name - *first <= left
    {
        left -= name - *first;
        *first = name;
    }
    while left > 0 {
        let lines = |i: &usize| whole[*i] as f64 / out[*i].max(1) as f64;
        let Some(most) = columns().filter(|&i| out[i] < whole[i]).max_by(|a, b| lines(a).total_cmp(&lines(b))) else {
            break;
        };
        out[most] += 1;
        left -= 1;
    }
    out
}

/// Words, of which an interval, a unit in brackets or a number with thin spaces is one.
fn words(text: &str) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    let is_break = |c: char| c.is_whitespace() && !matches!(c, '\u{a0}' | '\u{202f}');
    for word in text.split(is_break).filter(|word| !word.is_empty()) {
        match out.last_mut().filter(|last| last.starts_with('[') && !last.contains(']')) {
            Some(open) => {
                open.push(' ');
                open.push_str(word);
            }
            None => out.push(word.to_owned()),
        }
    }
    out
}

/// The text in lines of at most `width` characters, broken between words only.
fn wrap(text: &str, width: usize) -> String {
    let (mut out, mut column) = (String::new(), 0);
    for word in words(text) {
        let length = word.chars().count();
        if column > 0 && column + 1 + length > width {
            out.push('\n');
            column = 0;
        } else if column > 0 {
            out.push(' ');
            column += 1;
        }
        out += &word;
        column += length;
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn preflight() -> LaidOut {
        let texts = |cells: &[&str]| cells.iter().map(|c| (*c).to_owned()).collect::<Vec<_>>();
        let head = [
            "kind",
            "speed [m/s]",
            "direction",
            "time [s]",
            "steady [s]",
            "command [V]",
            "rms current [A]",
            "coast [m]",
        ];
        let row = ["excitation", "0.100", "backward", "123.4", "112.3", "12.34", "1.23", "0.123"];
        let named = ["calibration 10 N", "measured response", "backward", "123.4", "112.3", "12.34", "1.23", "0.123"];
        LaidOut { caption: String::new(), head: texts(&head), rows: vec![texts(&row), texts(&named)] }
    }

    #[test]
    fn no_word_of_a_table_is_broken_at_any_width() {
        let table = preflight();
        let words: Vec<&str> =
            std::iter::once(&table.head).chain(&table.rows).flatten().flat_map(|c| c.split_whitespace()).collect();
        for widest in [10, 60, 80, 100, 120] {
            let printed = fitted(&table, widest).to_string();
            let found: Vec<&str> = printed.split_whitespace().collect();
            for word in &words {
                assert!(found.contains(word), "{word} at {widest} columns:\n{printed}");
            }
        }
    }

    #[test]
    fn a_table_is_as_wide_as_the_page_where_its_words_fit() {
        for widest in [90, 100, 120] {
            let printed = fitted(&preflight(), widest).to_string();
            let longest = printed.lines().map(|l| l.chars().count()).max().unwrap_or(0);
            assert!(longest <= widest, "{longest} of {widest}:\n{printed}");
        }
    }
}
