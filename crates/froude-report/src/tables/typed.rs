//! A typed table as HTML.

use froude_records::block::{Digits, ResultTable, laid_out};
use maud::{Markup, html};

use super::counter::Tables;
use super::symbols::html_symbols;

/// Cells longer than this are sentences, and break into lines.
const WORDS: usize = 44;

pub(crate) fn table_markup(table: &ResultTable, tables: &mut Tables) -> Markup {
    // A head without rows would read as if none had been found.
    let Some(text) = laid_out(table).filter(|text| !text.rows.is_empty()) else { return Markup::default() };
    let caption = tables.caption(&text.caption);
    let is_words =
        |column: usize| text.rows.iter().any(|row| row.get(column).is_some_and(|c| c.chars().count() > WORDS));
    let class: Vec<&str> =
        (0..text.head.len()).map(|column| if is_words(column) { "message" } else { "num" }).collect();
    let class_of = |column: usize| class.get(column).copied().unwrap_or("num");
    let digits: Vec<Digits> =
        if table.are_facts { Vec::new() } else { table.shown().map(|column| column.digits).collect() };
    let written = |column: usize, cell: &str| match digits.get(column) {
        Some(Digits::Symbol) => html_symbols(cell),
        Some(Digits::Normalised) if is_beyond(cell) => html! { span class="bad" { (cell) } },
        _ => html! { (cell) },
    };
    html! {
        div class="table wide" {
            table class=[class.contains(&"message").then_some("named")] {
                (caption)
                thead {
                    tr {
                        @for (i, head) in text.head.iter().enumerate() {
                            th scope="col" class=[(i > 0).then(|| class_of(i))] { (head) }
                        }
                    }
                }
                tbody {
                    @for row in &text.rows {
                        tr {
                            @for (i, cell) in row.iter().enumerate() {
                                @if i == 0 { th scope="row" { (written(i, cell)) } } @else { td class=(class_of(i)) { (written(i, cell)) } }
                            }
                        }
                    }
                }
            }
        }
    }
}

/// Whether a normalised difference is beyond 1, as it is written; with a power of ten it is.
fn is_beyond(cell: &str) -> bool {
    cell.contains('×') || cell.trim_start_matches('−').parse::<f64>().is_ok_and(|e_n| e_n > 1.0)
}
