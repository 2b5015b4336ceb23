//! What all pages share: the sheet around their contents, and tables.

use froude_records::block::{Digits, ResultTable, laid_out};
use froude_records::text::visible;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::style::{POLICY, STYLE};
use crate::tables::{Tables, html_symbols};

/// Cells longer than this are sentences, and break into lines.
const WORDS: usize = 44;

/// A page around its contents: everything stands in it.
pub(crate) fn sheet(title: &str, contents: &Markup, main: &Markup) -> String {
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta http-equiv="Content-Security-Policy" content=(POLICY);
                meta name="viewport" content="width=device-width, initial-scale=1";
                meta name="generator" content="Froude";
                title { (title) }
                style { (PreEscaped(STYLE)) }
            }
            body {
                div class="sheet" {
                    nav aria-label="Sections" { p { "Contents" } (contents) }
                    main { (main) }
                }
            }
        }
    };
    visible(&page.into_string()).into_owned()
}

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

pub(crate) fn count(n: &mut usize) -> usize {
    *n += 1;
    *n
}
