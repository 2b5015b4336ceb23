//! Gmsh's MSH 2.2 and 4.1, ASCII and binary: triangles (types 2 and 9) and quadrilaterals (3, 10 and 16) of the first and second order.
//!
//! One of second order becomes four panels over the nodes on its edges (of eight nodes: four triangles around a quadrilateral): flat
//! corners alone would lose area where it is curved.
//!
//! Other elements are counted, named and left out; so are vertices that no panel uses, such as those inside a volume. Nodes may have
//! any numbers.

use std::collections::BTreeMap;

use indexmap::IndexMap;

use super::cursor::Cursor;
use crate::files::soup::{Place, Read, ReadError, counted};
use crate::mesh::{Mesh, Panel};
use crate::vector::Vec3;

/// Number of nodes of the element types, with the name that Gmsh gives them.
const TYPES: &[(i64, usize, &str)] = &[
    (1, 2, "lines"),
    (2, 3, "triangles"),
    (3, 4, "quadrilaterals"),
    (4, 4, "tetrahedra"),
    (5, 8, "hexahedra"),
    (6, 6, "prisms"),
    (7, 5, "pyramids"),
    (8, 3, "lines of second order"),
    (9, 6, "triangles of second order"),
    (10, 9, "quadrilaterals of second order"),
    (11, 10, "tetrahedra of second order"),
    (12, 27, "hexahedra of second order"),
    (13, 18, "prisms of second order"),
    (14, 14, "pyramids of second order"),
    (15, 1, "points"),
    (16, 8, "quadrilaterals of second order"),
    (17, 20, "hexahedra of second order"),
    (18, 15, "prisms of second order"),
    (19, 13, "pyramids of second order"),
    (20, 9, "triangles of third order"),
    (21, 10, "triangles of third order"),
    (22, 12, "triangles of fourth order"),
    (23, 15, "triangles of fourth order"),
    (24, 15, "triangles of fifth order"),
    (25, 21, "triangles of fifth order"),
    (26, 4, "lines of third order"),
    (27, 5, "lines of fourth order"),
    (28, 6, "lines of fifth order"),
    (29, 20, "tetrahedra of third order"),
    (30, 35, "tetrahedra of fourth order"),
    (31, 56, "tetrahedra of fifth order"),
    (36, 16, "quadrilaterals of third order"),
    (37, 25, "quadrilaterals of fourth order"),
    (92, 64, "hexahedra of third order"),
    (93, 125, "hexahedra of fourth order"),
];

/// Panels of the elements of a surface, by the places of their nodes: corners first, then the middles of the edges from the first corner
/// on, then the centre. A triangle ends at its first corner again.
const SURFACES: &[(i64, &[[usize; 4]])] = &[
    (2, &[[0, 1, 2, 0]]),
    (3, &[[0, 1, 2, 3]]),
    (9, &[[0, 3, 5, 0], [3, 1, 4, 3], [5, 4, 2, 5], [3, 4, 5, 3]]),
    (10, &[[0, 4, 8, 7], [4, 1, 5, 8], [8, 5, 2, 6], [7, 8, 6, 3]]),
    (16, &[[0, 4, 7, 0], [4, 1, 5, 4], [5, 2, 6, 5], [6, 3, 7, 6], [4, 5, 6, 7]]),
];

/// The name of one element: `line of second order`, `tetrahedron`.
fn one(many: &str) -> String {
    let (noun, order) = many.split_at(many.find(' ').unwrap_or(many.len()));
    match noun.strip_suffix("hedra") {
        Some(base) => format!("{base}hedron{order}"),
        None => format!("{}{order}", noun.trim_end_matches('s')),
    }
}

/// What to do about a version that is not read.
const SAVE_AS: &str = "save it with gmsh -save -format msh41 or msh22";

struct Msh<'a> {
    cursor: Cursor<'a>,
    is_binary: bool,
    /// Vertex of a node.
    vertices: IndexMap<u64, u32>,
    points: Vec<Vec3>,
    panels: Vec<Panel>,
    /// Elements of second order.
    divided: usize,
    left_out: BTreeMap<&'static str, u64>,
}

pub(super) fn read(mut cursor: Cursor<'_>) -> Read {
    let (version, is_binary) = head(&mut cursor)?;
    let mut msh = Msh {
        cursor,
        is_binary,
        vertices: IndexMap::new(),
        points: Vec::new(),
        panels: Vec::new(),
        divided: 0,
        left_out: BTreeMap::new(),
    };
    while let Some(word) = msh.cursor.word() {
        match (word.text, version) {
            (b"$Nodes", Version::Two) => msh.nodes_2()?,
            (b"$Nodes", Version::Four) => msh.nodes_4()?,
            (b"$Elements", Version::Two) => msh.elements_2()?,
            (b"$Elements", Version::Four) => msh.elements_4()?,
            (b"$ParametricNodes", _) => {
                let (place, what) = (msh.cursor.place(word.at), "the section $ParametricNodes".to_owned());
                return Err(msh.cursor.not_read(place, what, "save it without Mesh.SaveParametric, or as version 4.1"));
            }
            ([b'$', name @ ..], _) => {
                skip_section(&mut msh.cursor, name)?;
                continue;
            }
            _ => return Err(msh.cursor.unexpected(word.at, &word.shown(), "a section, such as $Nodes,")),
        }
        let end = if word.text == b"$Nodes" { "$EndNodes" } else { "$EndElements" };
        let found = msh.cursor.word().ok_or_else(|| msh.cursor.ends(end))?;
        if found.text != end.as_bytes() {
            return Err(msh.cursor.unexpected(found.at, &found.shown(), end));
        }
    }
    Ok(msh.done())
}

#[derive(Clone, Copy)]
enum Version {
    Two,
    Four,
}

fn head(cursor: &mut Cursor<'_>) -> Result<(Version, bool), ReadError> {
    let expected = "$MeshFormat";
    let word = cursor.word().ok_or_else(|| cursor.ends(expected))?;
    if word.text != expected.as_bytes() {
        return Err(cursor.unexpected(word.at, &word.shown(), expected));
    }
    let word = cursor.word().ok_or_else(|| cursor.ends("the version"))?;
    let version = match word.text {
        b"2.2" | b"2.1" | b"2" | b"2.0" => Version::Two,
        b"4.1" => Version::Four,
        other => {
            let what = format!("version {}", String::from_utf8_lossy(&other[..other.len().min(8)]));
            return Err(cursor.not_read(cursor.place(word.at), what, SAVE_AS));
        }
    };
    let is_binary = cursor.whole(0, 1, "0 for text or 1 for binary")? == 1;
    cursor.whole(8, 8, "8, the bytes of a number,")?;
    if is_binary {
        cursor.line();
        let at = cursor.at();
        let one: [u8; 4] = cursor.take("the number 1 that tells the order of bytes")?;
        match one {
            [1, 0, 0, 0] => {}
            [0, 0, 0, 1] => cursor.is_big_endian = true,
            _ => return Err(cursor.unexpected_byte(at, &format!("{one:?}"), "the number 1 in four bytes")),
        }
    }
    let expected = "$EndMeshFormat";
    let word = cursor.word().ok_or_else(|| cursor.ends(expected))?;
    if word.text != expected.as_bytes() {
        return Err(cursor.unexpected(word.at, &word.shown(), expected));
    }
    Ok((version, is_binary))
}

/// Passes a section over, whatever is in it.
fn skip_section(cursor: &mut Cursor<'_>, name: &[u8]) -> Result<(), ReadError> {
    let end = [b"$End", name].concat();
    match cursor.rest().windows(end.len()).position(|window| window == end) {
        Some(position) => {
            cursor.go_to(cursor.at() + position + end.len());
            Ok(())
        }
        None => Err(cursor.ends(&String::from_utf8_lossy(&end[..end.len().min(32)]))),
    }
}

impl Msh<'_> {
    /// A number of four bytes in binary.
    fn int(&mut self, expected: &str) -> Result<i64, ReadError> {
        if self.is_binary {
            Ok(self.cursor.i32(expected)?.into())
        } else {
            self.cursor.whole(i64::MIN, i64::MAX, expected)
        }
    }

    /// A number of eight bytes in binary.
    fn size(&mut self, expected: &str) -> Result<u64, ReadError> {
        if self.is_binary {
            self.cursor.u64(expected)
        } else {
            self.cursor.whole(0, i64::MAX, expected).map(|n| n as u64)
        }
    }

    fn point(&mut self) -> Result<Vec3, ReadError> {
        let mut point = [0.0; 3];
        for (x, expected) in point.iter_mut().zip(["x of a node", "y of a node", "z of a node"]) {
            *x = if self.is_binary { self.cursor.f64(expected)? } else { self.cursor.number(expected)? };
        }
        Ok(point)
    }

    /// Begin of the numbers: in binary data they follow the end of the line at once.
    fn begin(&mut self) {
        if self.is_binary {
            self.cursor.line();
        }
    }

    fn unexpected(&self, at: usize, found: &str, expected: &str) -> ReadError {
        let tell = if self.is_binary { Cursor::unexpected_byte } else { Cursor::unexpected };
        tell(&self.cursor, at, found, expected)
    }

    /// Where the next number begins.
    fn here(&self) -> usize {
        if self.is_binary { self.cursor.at() } else { self.cursor.clone().word().map_or(0, |word| word.at) }
    }

    fn node(&mut self, at: usize, tag: u64, point: Vec3) -> Result<(), ReadError> {
        if self.vertices.insert(tag, self.points.len() as u32).is_some() {
            return Err(self.unexpected(at, &format!("node {tag} for a second time"), "a node that is not there yet"));
        }
        self.points.push(point);
        Ok(())
    }

    fn nodes_2(&mut self) -> Result<(), ReadError> {
        let count = self.cursor.whole(0, i64::MAX, "the number of nodes")?;
        self.begin();
        for _ in 0..count {
            let at = self.here();
            let tag = self.int("the number of a node")?;
            let point = self.point()?;
            self.node(at, tag as u64, point)?;
        }
        Ok(())
    }

    fn nodes_4(&mut self) -> Result<(), ReadError> {
        self.begin();
        let blocks = self.size("the number of blocks")?;
        for expected in ["the number of nodes", "the least number of a node", "the largest number of a node"] {
            self.size(expected)?;
        }
        let mut tags = Vec::new();
        for _ in 0..blocks {
            let at = self.here();
            let dimension = self.int("the dimension of a block")?;
            self.int("the entity of a block")?;
            let parametric = self.int("whether nodes have parameters")?;
            let count = self.size("the number of nodes of a block")?;
            if !(0..=3).contains(&dimension) {
                return Err(self.unexpected(at, &dimension.to_string(), "a dimension from 0 to 3"));
            }
            tags.clear();
            for _ in 0..count {
                tags.push((self.here(), self.size("the number of a node")?));
            }
            for &(at, tag) in &tags {
                let point = self.point()?;
                for _ in 0..if parametric == 0 { 0 } else { dimension } {
                    let expected = "a parameter of a node";
                    if self.is_binary {
                        self.cursor.f64(expected)?
                    } else {
                        self.cursor.number(expected)?
                    };
                }
                self.node(at, tag, point)?;
            }
        }
        Ok(())
    }

    /// The panels of an element, by the numbers of its nodes.
    fn panels(
        &mut self,
        split: &[[usize; 4]],
        nodes: usize,
        next: fn(&mut Self) -> Result<u64, ReadError>,
    ) -> Result<(), ReadError> {
        let mut of = [0; 9];
        for node in of.iter_mut().take(nodes) {
            let at = self.here();
            let tag = next(self)?;
            *node = *self
                .vertices
                .get(&tag)
                .ok_or_else(|| self.unexpected(at, &format!("node {tag}"), "one of the nodes above"))?;
        }
        self.panels.extend(split.iter().map(|[a, b, c, d]| Panel::quad(of[*a], of[*b], of[*c], of[*d])));
        self.divided += usize::from(split.len() > 1);
        Ok(())
    }

    /// Name and nodes of a type.
    fn kind(&self, at: usize, kind: i64) -> Result<(usize, &'static str), ReadError> {
        if let Some((_, nodes, name)) = TYPES.iter().find(|(number, ..)| *number == kind) {
            return Ok((*nodes, name));
        }
        let place = if self.is_binary { Place::Byte(at) } else { self.cursor.place(at) };
        Err(self.cursor.not_read(place, format!("element type {kind}"), "save triangles and quadrilaterals only"))
    }

    fn leave_out(&mut self, name: &'static str, count: u64) {
        *self.left_out.entry(name).or_default() += count;
    }

    fn elements_2(&mut self) -> Result<(), ReadError> {
        let count = self.cursor.whole(0, i64::MAX, "the number of elements")? as u64;
        self.begin();
        let next = |msh: &mut Self| msh.int("a node of an element").map(|tag| tag as u64);
        let mut done = 0;
        while done < count {
            if !self.is_binary {
                self.int("the number of an element")?;
            }
            let at = self.here();
            let kind = self.int("the type of an element")?;
            let (nodes, name) = self.kind(at, kind)?;
            // In binary, elements of one type come in a row.
            let row = if self.is_binary { self.int("a number of elements")? } else { 1 };
            let tags = self.int("a number of tags")?;
            if row < 1 || tags < 0 {
                return Err(self.unexpected(at, &format!("{row} elements with {tags} tags"), "one element or more"));
            }
            for _ in 0..row {
                if self.is_binary {
                    self.int("the number of an element")?;
                }
                for _ in 0..tags {
                    self.int("a tag of an element")?;
                }
                self.element(kind, nodes, name, next)?;
            }
            done = done.saturating_add(row as u64);
        }
        Ok(())
    }

    fn elements_4(&mut self) -> Result<(), ReadError> {
        self.begin();
        let blocks = self.size("the number of blocks")?;
        for expected in ["the number of elements", "the least number of an element", "the largest number of an element"]
        {
            self.size(expected)?;
        }
        let next = |msh: &mut Self| msh.size("a node of an element");
        for _ in 0..blocks {
            self.int("the dimension of a block")?;
            self.int("the entity of a block")?;
            let at = self.here();
            let kind = self.int("the type of the elements of a block")?;
            let count = self.size("the number of elements of a block")?;
            let (nodes, name) = self.kind(at, kind)?;
            for _ in 0..count {
                self.size("the number of an element")?;
                self.element(kind, nodes, name, next)?;
            }
        }
        Ok(())
    }

    fn element(
        &mut self,
        kind: i64,
        nodes: usize,
        name: &'static str,
        next: fn(&mut Self) -> Result<u64, ReadError>,
    ) -> Result<(), ReadError> {
        if let Some((_, split)) = SURFACES.iter().find(|(number, _)| *number == kind) {
            return self.panels(split, nodes, next);
        }
        for _ in 0..nodes {
            next(self)?;
        }
        self.leave_out(name, 1);
        Ok(())
    }

    fn done(self) -> (Mesh, Vec<String>) {
        let mut notes = Vec::new();
        if !self.left_out.is_empty() {
            let list: Vec<String> =
                self.left_out.iter().map(|(name, count)| counted(*count as usize, &one(name), name)).collect();
            notes.push(format!(
                "left out: {}; panels are triangles and quadrilaterals of first and second order",
                list.join(", ")
            ));
        }
        if self.divided > 0 {
            let elements = counted(self.divided, "element of second order", "elements of second order");
            notes.push(format!("{elements} divided at the nodes on their edges"));
        }
        let mut mesh = Mesh { vertices: self.points, panels: self.panels };
        let unused = mesh.drop_unused_vertices();
        if unused > 0 {
            notes.push(format!("{} that no panel uses left out", counted(unused, "node", "nodes")));
        }
        (mesh, notes)
    }
}
