//! The number that each table has in its caption.

use maud::{Markup, html};

/// Counter of the tables.
#[derive(Default)]
pub(crate) struct Tables {
    n: usize,
}

impl Tables {
    /// The next table's caption.
    pub(crate) fn caption(&mut self, text: &str) -> Markup {
        self.n += 1;
        html! { caption { b { "Table " (self.n) ". " } (text) } }
    }
}
