//! STL: triangles by their corners, ASCII or binary.
//!
//! A file whose length is that of its count of triangles is binary, whatever its header begins with: some programs write `solid` there.

use super::cursor::Cursor;
use crate::files::soup::{Read, ReadError, Soup, counted};
use crate::mesh::{Mesh, Panel};
use crate::vector::{Vec3, cross, dot, sub};

/// Bytes before the first triangle, and of a triangle.
const HEAD: usize = 84;
const TRIANGLE: usize = 50;

pub(super) fn looks_like(bytes: &[u8]) -> bool {
    has_binary_length(bytes) || begins_as_text(bytes)
}

/// The count of a binary file.
fn count(bytes: &[u8]) -> Option<u32> {
    bytes.get(80..HEAD)?.first_chunk().map(|b| u32::from_le_bytes(*b))
}

fn has_binary_length(bytes: &[u8]) -> bool {
    count(bytes).is_some_and(|n| HEAD as u64 + TRIANGLE as u64 * u64::from(n) == bytes.len() as u64)
}

fn begins_as_text(bytes: &[u8]) -> bool {
    let text = bytes.trim_ascii_start();
    let is_solid = text.get(..5).is_some_and(|b| b.eq_ignore_ascii_case(b"solid"));
    is_solid && !bytes[..bytes.len().min(HEAD)].contains(&0)
}

pub(super) fn read(cursor: Cursor<'_>) -> Read {
    let bytes = cursor.rest();
    if begins_as_text(bytes) && !has_binary_length(bytes) { ascii(cursor) } else { binary(cursor) }
}

/// Triangles, and how their normals agree with the order of their corners.
#[derive(Default)]
struct Triangles {
    soup: Soup,
    with: usize,
    against: usize,
}

impl Triangles {
    fn push(&mut self, normal: Vec3, corners: [Vec3; 3]) {
        let [a, b, c] = corners;
        let along = dot(normal, cross(sub(b, a), sub(c, a)));
        self.with += usize::from(along > 0.0);
        self.against += usize::from(along < 0.0);
        let [a, b, c] = corners.map(|point| self.soup.vertex(point));
        self.soup.mesh.panels.push(Panel::triangle(a, b, c));
    }

    fn done(self, mut notes: Vec<String>) -> (Mesh, Vec<String>) {
        if self.against > self.with {
            let reported = self.with + self.against;
            notes.push(format!(
                "the normals of {} of {reported} triangles contradict the order of their corners; the order was used",
                self.against
            ));
        }
        (self.soup.mesh, notes)
    }
}

fn binary(mut cursor: Cursor<'_>) -> Read {
    cursor.skip(80, "a header of 80 bytes")?;
    let count = cursor.u32("the number of triangles")?;
    let mut triangles = Triangles::default();
    let mut coloured = 0;
    for number in 1..=count {
        let expected = || format!("triangle {number} of {count}");
        let triangle: [u8; TRIANGLE] = cursor.take(&expected())?;
        let mut inside = Cursor::new("", &triangle);
        let mut point = || -> Result<Vec3, ReadError> { Ok([inside.f32("")?, inside.f32("")?, inside.f32("")?]) };
        let (normal, corners) = (point()?, [point()?, point()?, point()?]);
        coloured += usize::from(triangle[48..] != [0, 0]);
        triangles.push(normal, corners);
    }
    let mut notes = Vec::new();
    if coloured > 0 {
        notes.push(format!("attributes of {} left out", counted(coloured, "triangle", "triangles")));
    }
    let rest = cursor.rest().len();
    if rest > 0 {
        notes.push(format!("{} after the last triangle left out", counted(rest, "byte", "bytes")));
    }
    Ok(triangles.done(notes))
}

fn ascii(mut cursor: Cursor<'_>) -> Read {
    let mut triangles = Triangles::default();
    let (mut solids, mut is_open) = (0, false);
    while let Some(word) = cursor.word() {
        if word.is("solid") && !is_open {
            (solids, is_open) = (solids + 1, true);
            cursor.line();
        } else if word.is("endsolid") && is_open {
            is_open = false;
            cursor.line();
        } else if word.is("facet") && is_open {
            facet(&mut cursor, &mut triangles)?;
        } else {
            let expected = if is_open { "facet or endsolid" } else { "solid" };
            return Err(cursor.unexpected(word.at, &word.shown(), expected));
        }
    }
    if is_open {
        return Err(cursor.ends("facet or endsolid"));
    }
    let notes = if solids > 1 { vec![format!("{solids} solids in one mesh")] } else { Vec::new() };
    Ok(triangles.done(notes))
}

fn facet(cursor: &mut Cursor<'_>, triangles: &mut Triangles) -> Result<(), ReadError> {
    let point = |cursor: &mut Cursor<'_>, what: [&str; 3]| -> Result<Vec3, ReadError> {
        Ok([cursor.number(what[0])?, cursor.number(what[1])?, cursor.number(what[2])?])
    };
    must_be(cursor, &["normal"])?;
    let normal = point(cursor, ["x of a normal", "y of a normal", "z of a normal"])?;
    must_be(cursor, &["outer", "loop"])?;
    let mut corner = || {
        must_be(cursor, &["vertex"])?;
        point(cursor, ["x of a corner", "y of a corner", "z of a corner"])
    };
    let corners = [corner()?, corner()?, corner()?];
    must_be(cursor, &["endloop", "endfacet"])?;
    triangles.push(normal, corners);
    Ok(())
}

fn must_be(cursor: &mut Cursor<'_>, words: &[&str]) -> Result<(), ReadError> {
    for expected in words {
        let word = cursor.word().ok_or_else(|| cursor.ends(expected))?;
        if !word.is(expected) {
            return Err(cursor.unexpected(word.at, &word.shown(), expected));
        }
    }
    Ok(())
}
