//! What all pages share: the sheet around their contents.

use froude_records::text::visible;
use maud::{DOCTYPE, Markup, PreEscaped, html};

use crate::style::{POLICY, STYLE};

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

pub(crate) fn count(n: &mut usize) -> usize {
    *n += 1;
    *n
}
