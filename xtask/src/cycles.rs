//! Files of a crate that name each other in a circle: none of them can be read, or moved, without the others.
//!
//! A path counts as written, from `crate::`, `super::` or `self::` on. What the root of a crate re-exports counts as the root's, and what a parent
//! takes of its own children by their bare names does not count.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{Delimiter, TokenTree};

/// The modules of a crate, each with the paths that its file names.
pub type Modules = BTreeMap<Vec<String>, Vec<Vec<String>>>;

/// Collects the path that begins at `at` with `crate::`, `super::` or `self::`; a `use` with braces gives one path for each branch.
pub fn paths(trees: &[TokenTree], at: usize, out: &mut Vec<Vec<String>>) {
    let is_colon = |tree: &TokenTree| matches!(tree, TokenTree::Punct(colon) if colon.as_char() == ':');
    let is_root =
        matches!(&trees[at], TokenTree::Ident(root) if ["crate", "super", "self"].iter().any(|word| root == word));
    let goes_on = at > 1 && trees[at - 2..at].iter().all(is_colon);
    let is_path = trees[at + 1..].iter().take_while(|tree| is_colon(tree)).count() == 2;
    // `pub(in crate::a)` takes nothing from there.
    let is_visibility = at > 0 && matches!(&trees[at - 1], TokenTree::Ident(word) if word == "in");
    if is_root && is_path && !goes_on && !is_visibility {
        branches(&trees[at..], Vec::new(), out);
    }
}

fn branches(trees: &[TokenTree], mut path: Vec<String>, out: &mut Vec<Vec<String>>) {
    match trees {
        [TokenTree::Ident(name), TokenTree::Punct(a), TokenTree::Punct(b), rest @ ..]
            if a.as_char() == ':' && b.as_char() == ':' =>
        {
            path.push(name.to_string());
            branches(rest, path, out);
        }
        [TokenTree::Group(group), ..] if group.delimiter() == Delimiter::Brace => {
            let trees: Vec<TokenTree> = group.stream().into_iter().collect();
            let is_comma = |tree: &TokenTree| matches!(tree, TokenTree::Punct(comma) if comma.as_char() == ',');
            trees.split(is_comma).for_each(|branch| branches(branch, path.clone(), out));
        }
        [TokenTree::Ident(name), ..] => {
            path.push(name.to_string());
            out.push(path);
        }
        // A glob, or `::<T>`.
        _ => out.push(path),
    }
}

/// Groups of modules that all name each other, directly or through others; the root of the crate is left out.
pub fn cycles(modules: &Modules) -> Vec<Vec<String>> {
    let uses: BTreeMap<&Vec<String>, BTreeSet<&Vec<String>>> = modules
        .iter()
        .map(|(own, paths)| (own, paths.iter().filter_map(|path| module_of(own, path, modules)).collect()))
        .collect();
    let reached = |from: &Vec<String>| {
        let mut seen: BTreeSet<&Vec<String>> = BTreeSet::new();
        let mut next: Vec<&Vec<String>> = uses[from].iter().copied().collect();
        while let Some(module) = next.pop() {
            if seen.insert(module) {
                next.extend(&uses[module]);
            }
        }
        seen
    };
    let all: BTreeMap<&Vec<String>, BTreeSet<&Vec<String>>> = uses.keys().map(|own| (*own, reached(own))).collect();
    let circle = |own: &Vec<String>| -> Vec<String> {
        all[own].iter().filter(|other| all[**other].contains(own)).map(|other| other.join("::")).collect()
    };
    let groups: BTreeSet<Vec<String>> = uses.keys().map(|own| circle(own)).collect();
    groups.into_iter().filter(|group| group.len() > 1).collect()
}

/// The module whose file a path leads to from the file of `own`.
fn module_of<'m>(own: &Vec<String>, path: &[String], modules: &'m Modules) -> Option<&'m Vec<String>> {
    let up = path.iter().take_while(|part| *part == "super").count();
    let (base, rest) = match path.first().map(String::as_str) {
        Some("crate") => (&own[..0], &path[1..]),
        Some("super") => (&own[..own.len().saturating_sub(up)], &path[up..]),
        _ => (&own[..], &path[1..]),
    };
    let full = [base, rest].concat();
    let longest = (1..=full.len()).rev().find_map(|n| modules.get_key_value(&full[..n]));
    longest.map(|(module, _)| module).filter(|module| *module != own)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lines::named;

    fn of(files: &[(&str, &str)]) -> Vec<Vec<String>> {
        let module = |name: &str| name.split("::").map(str::to_owned).collect();
        cycles(&files.iter().map(|(name, text)| (module(name), named(text))).collect())
    }

    #[test]
    fn a_circle_is_found_however_it_is_written_and_a_chain_is_none() {
        let [a, b, d] = ["use crate::{b::B, c};", "use crate::c::{d::D, E};", "use super::super::a::A;"];
        assert_eq!(of(&[("a", a), ("b", b), ("c", ""), ("c::d", d)]), [["a", "b", "c::d"]]);
        for back in [
            "fn f() { crate::a::g(1) }",
            "use crate::a::*;",
            "fn f(x: crate::a::A) {}",
            "fn f() { crate::a::g::<u8>() }",
        ] {
            assert_eq!(of(&[("a", "use crate::b::B;"), ("b", back)]), [["a", "b"]], "{back}");
        }
        for no_way_back in
            ["pub(in crate::a) fn f() {}", "#[cfg(test)] mod tests { use crate::a::A; }", "use crate::c::C;"]
        {
            assert_eq!(of(&[("a", "use crate::b::B;"), ("b", no_way_back), ("c", "")]), [[""; 0]; 0], "{no_way_back}");
        }
    }
}
