//! What a reader gives: the polygons of a file, or what is wrong with it and where.

use std::fmt;

use indexmap::IndexMap;

use crate::mesh::{Mesh, Panel};
use crate::vector::Vec3;

/// Where in a file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Place {
    /// In text, both from 1; columns count bytes.
    Line {
        /// The line.
        line: usize,
        /// The column.
        column: usize,
    },
    /// In binary data, from 0.
    Byte(usize),
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line { line, column } => write!(f, "line {line}, column {column}"),
            Self::Byte(offset) => write!(f, "byte {offset}"),
        }
    }
}

/// What is wrong with a file, where in it, and what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct ReadError(pub(crate) String);

/// What a reader returns: the mesh, and what it has to say.
pub(crate) type Read = Result<(Mesh, Vec<String>), ReadError>;

/// A mesh whose panels come as points: those that are the same to the bit are one vertex (0 and −0 are the same).
#[derive(Default)]
pub(crate) struct Soup {
    pub(crate) mesh: Mesh,
    numbers: IndexMap<[u64; 3], u32>,
}

impl Soup {
    pub(crate) fn vertex(&mut self, point: Vec3) -> u32 {
        let next = self.mesh.vertices.len() as u32;
        let number = *self.numbers.entry(bits(point)).or_insert(next);
        if number == next {
            self.mesh.vertices.push(point);
        }
        number
    }
}

/// Polygons become panels; those with more than four corners become triangles around their first corner.
#[derive(Default)]
pub(crate) struct Polygons {
    pub(crate) panels: Vec<Panel>,
    fans: usize,
}

impl Polygons {
    /// Three corners at least; fewer are no polygon and are not taken.
    pub(crate) fn push(&mut self, corners: &[u32]) {
        match *corners {
            [a, b, c] => self.panels.push(Panel::triangle(a, b, c)),
            [a, b, c, d] => self.panels.push(Panel::quad(a, b, c, d)),
            [a, ref rest @ ..] if rest.len() > 3 => {
                self.fans += 1;
                self.panels.extend(rest.windows(2).map(|pair| Panel::triangle(a, pair[0], pair[1])));
            }
            _ => {}
        }
    }

    pub(crate) fn note(&self) -> Option<String> {
        (self.fans > 0).then(|| {
            format!("{} with more than four corners divided into triangles", counted(self.fans, "face", "faces"))
        })
    }
}

/// A half and its mirror image, with the note that says so.
pub(crate) fn mirrored_whole(half: &Mesh, axis: usize, why: &str, notes: &mut Vec<String>) -> Mesh {
    let letter = ["x", "y", "z"][axis.min(2)];
    let has = |side: fn(&f64) -> bool| half.vertices.iter().any(|v| side(&v[axis]));
    notes.push(format!("{why}: {} mirrored in the plane {letter} = 0", counted(half.panels.len(), "panel", "panels")));
    if has(|c| *c > 0.0) && has(|c| *c < 0.0) {
        notes.push(format!("the mirrored part lies on both sides of {letter} = 0: it and its image may overlap"));
    }
    half.with_mirror_image(axis)
}

/// "1 face", "2 faces".
pub(crate) fn counted(count: usize, one: &str, more: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { more })
}

/// The bits of a point, the same for 0 and −0.
pub(crate) fn bits(point: Vec3) -> [u64; 3] {
    point.map(|x| (x + 0.0).to_bits())
}
