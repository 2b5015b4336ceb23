//! Lines and tokens of each crate: what compiles, without comments, blank lines and tests; and all lines with them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use proc_macro2::{Delimiter, TokenStream, TokenTree};

use crate::cycles::{self, Modules};
use crate::unreached::Names;

/// Counts of one crate.
#[derive(Default)]
struct Count {
    /// Lines of its `src` that carry a token outside of comments and tests.
    code: usize,
    /// A pair of brackets counts as one.
    tokens: usize,
    /// All lines of its `src`.
    source: usize,
    /// All lines of its tests, benches and examples, and of test modules with a file of their own.
    tests: usize,
    /// Its modules, and what they name.
    modules: Modules,
    /// The names in it.
    names: Names,
}

impl Count {
    fn add(&mut self, more: &Self) {
        self.code += more.code;
        self.tokens += more.tokens;
        self.source += more.source;
        self.tests += more.tests;
        self.names.add(&more.names);
    }

    fn row(&self, name: &str) -> String {
        format!("{name:24} {:8} {:9} {:10} {:8}", self.code, self.tokens, self.source, self.tests)
    }
}

/// Prints a row per crate, and the total.
pub fn lines(root: &Path) -> Result<(), String> {
    println!("{:24} {:>8} {:>9} {:>10} {:>8}", "crate", "code", "tokens", "src, all", "tests");
    let mut total = Count::default();
    let mut circles = Vec::new();
    for folder in folders(root)? {
        let count = of_crate(&folder)?;
        println!("{}", count.row(&folder.strip_prefix(root).unwrap_or(&folder).display().to_string()));
        total.add(&count);
        circles.extend(cycles::cycles(&count.modules));
    }
    println!("{}", total.row("total"));
    println!("files of a crate that name each other in a circle: {circles:?}");
    println!("public items that tests alone reach: {:?}", total.names.unreached());
    Ok(())
}

/// The folders of xtask, of the crates and of the firmware.
fn folders(root: &Path) -> Result<Vec<PathBuf>, String> {
    let mut out = vec![root.join("xtask")];
    for parent in ["crates", "firmware"] {
        out.extend(entries(&root.join(parent))?.into_iter().filter(|path| path.join("src").is_dir()));
    }
    out.sort();
    Ok(out)
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>, String> {
    let read = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut out: Vec<PathBuf> = read.filter_map(|entry| Some(entry.ok()?.path())).collect();
    out.sort();
    Ok(out)
}

fn sources(folder: &Path, out: &mut Vec<PathBuf>) -> Result<(), String> {
    for path in entries(folder)? {
        if path.is_dir() {
            sources(&path, out)?;
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
    Ok(())
}

fn of_crate(folder: &Path) -> Result<Count, String> {
    let mut count = Count::default();
    let (mut files, mut tests) = (Vec::new(), BTreeSet::new());
    sources(&folder.join("src"), &mut files)?;
    let mut read = Vec::new();
    for path in files {
        let text = text(&path)?;
        let stream = TokenStream::from_str(&text).map_err(|e| format!("{}: {e}", path.display()))?;
        let mut seen = Seen::default();
        seen.walk(stream);
        let stem = path.with_extension("");
        let is_root = matches!(path.file_name().and_then(|n| n.to_str()), Some("lib.rs" | "main.rs" | "mod.rs"));
        let below = if is_root { path.parent().map_or_else(PathBuf::new, Path::to_owned) } else { stem };
        tests.extend(seen.test_modules.iter().map(|name| below.join(name)));
        read.push((path, text.lines().count(), seen));
    }
    for (path, all, seen) in read {
        if tests.iter().any(|module| path.with_extension("") == *module || path.starts_with(module)) {
            count.tests += all;
        } else {
            let module = path.strip_prefix(folder.join("src")).unwrap_or(&path).with_extension("");
            let mut module: Vec<String> = module.iter().map(|part| part.to_string_lossy().into_owned()).collect();
            module.pop_if(|name| matches!(name.as_str(), "lib" | "main" | "mod"));
            if !module.is_empty() {
                count.modules.insert(module, seen.paths);
            }
            count.names.add(&seen.names);
            count.source += all;
            count.code += seen.lines.len();
            count.tokens += seen.tokens;
        }
    }
    for part in ["tests", "benches", "examples"] {
        let mut files = Vec::new();
        if folder.join(part).is_dir() {
            sources(&folder.join(part), &mut files)?;
        }
        for path in files {
            count.tests += text(&path)?.lines().count();
        }
    }
    Ok(count)
}

fn text(path: &Path) -> Result<String, String> {
    std::fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))
}

/// Lines and tokens of one file outside of comments and tests.
#[derive(Default)]
struct Seen {
    lines: BTreeSet<usize>,
    tokens: usize,
    test_modules: Vec<String>,
    /// Paths inside of the crate.
    paths: Vec<Vec<String>>,
    names: Names,
}

impl Seen {
    fn walk(&mut self, stream: TokenStream) {
        let trees: Vec<TokenTree> = stream.into_iter().collect();
        let mut at = 0;
        while at < trees.len() {
            match attribute(&trees[at..]) {
                Some((words, len)) if words.starts_with("doc ") => at += len,
                Some((words, len)) if words == "cfg (test)" || words.starts_with("cfg (all (test") => {
                    at += len;
                    at += self.test_item(&trees[at..]);
                }
                _ => {
                    cycles::paths(&trees, at, &mut self.paths);
                    self.names.see(&trees, at);
                    self.see(&trees[at]);
                    at += 1;
                }
            }
        }
    }

    fn see(&mut self, tree: &TokenTree) {
        self.tokens += 1;
        if let TokenTree::Group(group) = tree {
            self.lines.extend([group.span_open().start().line, group.span_close().end().line]);
            self.walk(group.stream());
        } else {
            self.lines.extend(tree.span().start().line..=tree.span().end().line);
        }
    }

    /// Length of the item that begins here; a module in a file of its own is recorded.
    fn test_item(&mut self, trees: &[TokenTree]) -> usize {
        let is_end = |tree: &TokenTree| match tree {
            TokenTree::Punct(punct) => punct.as_char() == ';',
            TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
            _ => false,
        };
        let end = trees.iter().position(is_end).map_or(trees.len(), |i| i + 1);
        if let [.., TokenTree::Ident(word), TokenTree::Ident(name), TokenTree::Punct(_)] = &trees[..end]
            && word == "mod"
        {
            self.test_modules.push(name.to_string());
        }
        end
    }
}

/// The paths that a file names.
#[cfg(test)]
pub fn named(text: &str) -> Vec<Vec<String>> {
    let mut seen = Seen::default();
    seen.walk(TokenStream::from_str(text).unwrap_or_default());
    seen.paths
}

/// The words of an attribute that begins here, and how many trees it takes.
fn attribute(trees: &[TokenTree]) -> Option<(String, usize)> {
    let is = |at: usize, c: char| matches!(trees.get(at), Some(TokenTree::Punct(punct)) if punct.as_char() == c);
    let at = if is(1, '!') { 2 } else { 1 };
    match trees.get(at) {
        Some(TokenTree::Group(group)) if is(0, '#') && group.delimiter() == Delimiter::Bracket => {
            Some((group.stream().to_string(), at + 1))
        }
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_blank_lines_and_tests_are_not_code() {
        let text = "//! A file.\n\n/// One.\nfn one() -> u8 {\n    // Why.\n    1\n}\n#[cfg(test)]\nmod tests {\n    fn two() {}\n}\n#[cfg(test)]\nmod more;\n";
        let mut seen = Seen::default();
        seen.walk(TokenStream::from_str(text).unwrap_or_default());
        assert_eq!(seen.lines.into_iter().collect::<Vec<_>>(), [4, 6, 7]);
        assert_eq!((seen.tokens, seen.test_modules), (8, vec!["more".to_owned()]));
    }

    /// The facade is verbs, re-exports, demo and inspect, and the program parses, calls and prints. The facade has grown back twice: what a method
    /// or a verb needs belongs into a crate of its own.
    #[test]
    fn what_was_made_small_stays_small() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
        for (name, most) in [("crates/froude", 1_600), ("crates/froude-cli", 2_000)] {
            let lines = of_crate(&root.join(name)).map(|count| count.source);
            assert!(lines.as_ref().is_ok_and(|lines| *lines <= most), "{name}: {lines:?} of {most} lines");
        }
    }

    #[test]
    fn no_files_of_a_crate_name_each_other_in_a_circle() {
        for folder in folders(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..")).unwrap() {
            let circles = cycles::cycles(&of_crate(&folder).unwrap().modules);
            assert!(circles.is_empty(), "{}: {circles:?}", folder.display());
        }
    }

    /// What tests may reach alone: published bodies and settings, what they set or read in a twin or an emulated board, what holds book and schemas to
    /// the declarations, what the validation judges by; `translation_table` is named by assembly.
    const BY_TESTS: [&str; 22] = [
        "ESTIMATE_1_JSON_SCHEMA",
        "MCD",
        "NECKED_MAMBA",
        "SMOOTH_MAMBA",
        "drag_report",
        "extrapolation",
        "force_drift_n",
        "holds_one",
        "inject",
        "key_table",
        "launch",
        "lossless",
        "lost_ticks",
        "motor_side_mode_hz",
        "polar",
        "run_alone",
        "run_factors",
        "solve_in_time",
        "translation_table",
        "twin_mut",
        "z_limit",
        "z_score",
    ];

    /// Code that no verb reaches is read, built and changed for nothing.
    #[test]
    fn no_public_item_is_reached_by_tests_alone() {
        let mut all = Count::default();
        for folder in folders(&Path::new(env!("CARGO_MANIFEST_DIR")).join("..")).unwrap() {
            all.add(&of_crate(&folder).unwrap());
        }
        assert_eq!(all.names.unreached(), BY_TESTS);
    }

    #[test]
    fn an_item_is_reached_where_code_or_a_format_string_names_it() {
        let text = "pub fn a() {} pub(crate) const fn b() {} fn c() { b() } pub const D: u8 = 1; fn e() { println!(\"{D}\") } pub use x::a; pub struct F { pub g: u8 }";
        let mut seen = Seen::default();
        seen.walk(TokenStream::from_str(text).unwrap_or_default());
        assert_eq!(seen.names.unreached(), ["F", "a"]);
    }
}
