//! Wavefront OBJ: `v x y z`, then `f` with the numbers of vertices from 1, or from the last one backwards.

use std::collections::BTreeMap;

use super::cursor::{Cursor, Word};
use crate::files::soup::{Polygons, Read, ReadError};
use crate::mesh::Mesh;

/// Statements that have nothing to do with panels; they are counted and left out.
const OTHERS: &[&str] = &[
    "vt",
    "vn",
    "vp",
    "g",
    "o",
    "s",
    "mg",
    "l",
    "p",
    "mtllib",
    "usemtl",
    "usemap",
    "maplib",
    "cstype",
    "deg",
    "bmat",
    "step",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
];

pub(super) fn looks_like(bytes: &[u8]) -> bool {
    let mut cursor = Cursor::new("", bytes);
    while let Some(line) = cursor.line() {
        match Cursor::new("", line.text).word() {
            None => {}
            Some(word) if word.text.starts_with(b"#") => {}
            Some(word) if word.is("v") => return true,
            Some(word) if OTHERS.iter().any(|other| word.is(other)) => {}
            Some(_) => return false,
        }
    }
    false
}

pub(super) fn read(mut cursor: Cursor<'_>) -> Read {
    // A face may name vertices that come later.
    let vertices = count_vertices(cursor.clone());
    let mut mesh = Mesh::default();
    let mut polygons = Polygons::default();
    let mut corners = Vec::new();
    let mut others: BTreeMap<&str, usize> = BTreeMap::new();
    while let Some(word) = cursor.word() {
        if word.text.starts_with(b"#") {
            cursor.line();
        } else if word.text == b"v" {
            let [x, y, z] = ["x of a vertex", "y of a vertex", "z of a vertex"];
            mesh.vertices.push([cursor.number_of_line(x)?, cursor.number_of_line(y)?, cursor.number_of_line(z)?]);
            // A weight or a colour may follow.
            cursor.line();
        } else if word.text == b"f" {
            corners.clear();
            while let Some(corner) = word_of_statement(&mut cursor) {
                corners.push(vertex(&cursor, corner, mesh.vertices.len(), vertices)?);
            }
            if corners.len() < 3 {
                let found = format!("a face with {} corners", corners.len());
                return Err(cursor.unexpected(word.at, &found, "one with three or more"));
            }
            polygons.push(&corners);
        } else if let Some(other) = OTHERS.iter().find(|other| word.text == other.as_bytes()) {
            *others.entry(other).or_default() += 1;
            while word_of_statement(&mut cursor).is_some() {}
        } else {
            return Err(cursor.unexpected(word.at, &word.shown(), "v, f or another statement of the format"));
        }
    }
    let mut notes: Vec<String> = polygons.note().into_iter().collect();
    if !others.is_empty() {
        let list: Vec<String> = others.iter().map(|(word, count)| format!("{count} {word}")).collect();
        notes.push(format!("statements without panels left out: {}", list.join(", ")));
    }
    mesh.panels = polygons.panels;
    Ok((mesh, notes))
}

fn count_vertices(mut cursor: Cursor<'_>) -> usize {
    let mut count = 0;
    while let Some(word) = cursor.word() {
        count += usize::from(word.text == b"v");
        if word.text == b"v" || word.text.starts_with(b"#") {
            cursor.line();
        } else {
            while word_of_statement(&mut cursor).is_some() {}
        }
    }
    count
}

/// The next word of a statement; a backslash continues it on the next line, `#` ends it.
fn word_of_statement<'a>(cursor: &mut Cursor<'a>) -> Option<Word<'a>> {
    loop {
        let word = cursor.word_of_line()?;
        if word.text.starts_with(b"#") {
            cursor.line();
            return None;
        }
        if word.text != b"\\" {
            return Some(word);
        }
        cursor.line();
    }
}

/// A corner `v`, `v/vt`, `v//vn` or `v/vt/vn`.
fn vertex(cursor: &Cursor<'_>, corner: Word<'_>, before: usize, all: usize) -> Result<u32, ReadError> {
    let length = corner.text.iter().position(|b| *b == b'/').unwrap_or(corner.text.len());
    let number = Word { at: corner.at, text: &corner.text[..length] };
    let index = match number.whole() {
        Some(0) | None => None,
        Some(n) if n > 0 => Some(n - 1),
        Some(n) => n.checked_add(before as i64),
    };
    match index.filter(|i| (0..all as i64).contains(i)) {
        Some(i) => Ok(i as u32),
        None => {
            let expected = format!("a vertex from 1 to {all}, or from -{before} to -1,");
            Err(cursor.unexpected(corner.at, &corner.shown(), &expected))
        }
    }
}
