//! Names of coefficients and units as HTML.

use maud::{Markup, html};

use crate::symbol::{Rich, Style, symbol, unit_text};

/// A name as a symbol, with the name itself in its tooltip.
pub(crate) fn html_symbol(name: &str) -> Markup {
    let Rich { runs } = symbol(name);
    html! {
        span class="symbol" title=(name) {
            @for (i, (style, text)) in runs.iter().enumerate() {
                @match style {
                    Style::Upright => (text),
                    Style::Bold => b { (text) },
                    Style::Italic => i { (text) },
                    Style::Subscript => {
                        @if let Some((Style::Superscript, upper)) = runs.get(i + 1) {
                            span class="both" { sup { (upper) } sub { (text) } }
                        } @else {
                            sub { (text) }
                        }
                    },
                    Style::Superscript => {
                        @if !matches!(i.checked_sub(1).and_then(|k| runs.get(k)), Some((Style::Subscript, _))) {
                            sup { (text) }
                        }
                    },
                }
            }
        }
    }
}

/// A name as a symbol, with another in brackets where there is one.
pub(super) fn html_symbols(cell: &str) -> Markup {
    match cell.strip_suffix(')').and_then(|cell| cell.split_once(" (")) {
        Some((name, label)) => html! { (html_symbol(name)) " (" (html_symbol(label)) ")" },
        None => html_symbol(cell),
    }
}

/// A unit behind a number; nothing for a pure number.
pub(crate) fn html_unit(unit: &str) -> Markup {
    html! { @if unit != "1" && !unit.is_empty() { " " span class="unit" { (unit_text(unit)) } } }
}

/// A unit in brackets for a head.
pub(super) fn head_unit(unit: &str) -> Markup {
    html! { @if !unit.is_empty() { " " span class="unit" { "[" (unit_text(unit)) "]" } } }
}
