//! Public items that no code names but that which declares them: what only tests, benches and examples reach.
//!
//! Names count, not paths: an item that shares its name with another counts as reached, and so does one that a format string names. A re-export reaches nothing.

use std::collections::BTreeMap;

use proc_macro2::{Delimiter, TokenTree};

/// How often each name stands in code, and how often as that of a public item which is declared there.
#[derive(Default)]
pub struct Names {
    mentioned: BTreeMap<String, usize>,
    declared: BTreeMap<String, usize>,
    is_use: bool,
}

impl Names {
    /// Takes the tree at `at`; groups are walked by the caller.
    pub fn see(&mut self, trees: &[TokenTree], at: usize) {
        match &trees[at] {
            TokenTree::Ident(word) => {
                let is_generic = matches!(trees.get(at + 1), Some(TokenTree::Punct(next)) if next.as_char() == '<');
                self.is_use |= word == "use" && !is_generic;
                if self.is_use {
                    return;
                }
                *self.mentioned.entry(word.to_string()).or_default() += 1;
                if word == "pub"
                    && let Some(name) = item(&trees[at + 1..])
                {
                    *self.declared.entry(name).or_default() += 1;
                }
            }
            TokenTree::Punct(end) if end.as_char() == ';' => self.is_use = false,
            TokenTree::Literal(text) => {
                // What stands before the first brace is no name.
                for part in text.to_string().split('{').skip(1) {
                    let name: String = part.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                    *self.mentioned.entry(name).or_default() += 1;
                }
            }
            _ => {}
        }
    }

    pub fn add(&mut self, more: &Self) {
        for (own, more) in [(&mut self.mentioned, &more.mentioned), (&mut self.declared, &more.declared)] {
            for (name, n) in more {
                *own.entry(name.clone()).or_default() += n;
            }
        }
    }

    /// The items that nothing names beside their declaration.
    pub fn unreached(&self) -> Vec<&str> {
        let is_alone = |(name, n): &(&String, &usize)| self.mentioned.get(*name).is_none_or(|all| all <= n);
        self.declared.iter().filter(is_alone).map(|(name, _)| name.as_str()).collect()
    }
}

/// Name of the item whose visibility stands before.
fn item(trees: &[TokenTree]) -> Option<String> {
    let is_scope =
        matches!(trees.first(), Some(TokenTree::Group(group)) if group.delimiter() == Delimiter::Parenthesis);
    let words = ["async", "const", "unsafe", "fn", "static", "struct", "enum", "trait", "type"];
    let rest = &trees[usize::from(is_scope)..];
    let is_word = |tree: &&TokenTree| matches!(tree, TokenTree::Ident(word) if words.iter().any(|w| word == w));
    match (rest.iter().take_while(is_word).count(), rest.iter().find(|tree| !is_word(tree))) {
        (1.., Some(TokenTree::Ident(name))) => Some(name.to_string()),
        _ => None,
    }
}
