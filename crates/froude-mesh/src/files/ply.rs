//! PLY: a header of elements and properties, then their values as text or binary.
//!
//! Of the element `vertex` x, y, z are read, of `face` the list `vertex_indices` (or `vertex_index`).

use std::collections::BTreeSet;

use super::cursor::Cursor;
use crate::files::soup::{Polygons, Read, ReadError, counted};
use crate::mesh::Mesh;

/// Type of a value.
#[derive(Clone, Copy, PartialEq)]
enum Type {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Type {
    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    const fn bytes(self) -> u64 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }
}

struct Property<'a> {
    name: &'a [u8],
    /// Of its length, when it is a list.
    length: Option<Type>,
    value: Type,
}

struct Element<'a> {
    at: usize,
    name: &'a [u8],
    count: u64,
    properties: Vec<Property<'a>>,
}

struct Values<'a> {
    cursor: Cursor<'a>,
    is_binary: bool,
}

impl Values<'_> {
    fn value(&mut self, kind: Type, expected: &str) -> Result<f64, ReadError> {
        let c = &mut self.cursor;
        if !self.is_binary {
            return c.number(expected);
        }
        Ok(match kind {
            Type::I8 => c.little(expected).map(i8::from_le_bytes)?.into(),
            Type::U8 => c.little(expected).map(u8::from_le_bytes)?.into(),
            Type::I16 => c.little(expected).map(i16::from_le_bytes)?.into(),
            Type::U16 => c.little(expected).map(u16::from_le_bytes)?.into(),
            Type::I32 => c.i32(expected)?.into(),
            Type::U32 => c.u32(expected)?.into(),
            Type::F32 => c.f32(expected)?,
            Type::F64 => c.f64(expected)?,
        })
    }

    /// A value that counts or names something: whole, from 0, below a limit.
    fn index(&mut self, kind: Type, limit: u64, expected: &str) -> Result<u64, ReadError> {
        let at = if self.is_binary { self.cursor.at() } else { self.cursor.clone().word().map_or(0, |word| word.at) };
        let value = self.value(kind, expected)?;
        if value >= 0.0 && value < limit as f64 && value.fract() == 0.0 {
            return Ok(value as u64);
        }
        let c = &self.cursor;
        let tell = if self.is_binary { Cursor::unexpected_byte } else { Cursor::unexpected };
        Err(tell(c, at, &value.to_string(), expected))
    }

    /// Passes a property over.
    fn skip(&mut self, property: &Property<'_>, element: &str) -> Result<(), ReadError> {
        let length = match property.length {
            None => 1,
            Some(kind) => self.index(kind, u64::MAX, &format!("the length of a list of {element}"))?,
        };
        let expected = format!("a value of {element}");
        if self.is_binary {
            return self.cursor.skip(length.saturating_mul(property.value.bytes()), &expected);
        }
        for _ in 0..length {
            self.cursor.number(&expected)?;
        }
        Ok(())
    }
}

pub(super) fn read(mut cursor: Cursor<'_>) -> Read {
    let (is_binary, elements) = header(&mut cursor)?;
    let vertices = elements.iter().find(|e| e.name == b"vertex").map_or(0, |e| e.count);
    let mut values = Values { cursor, is_binary };
    let mut mesh = Mesh::default();
    let mut polygons = Polygons::default();
    let mut notes = Vec::new();
    for element in &elements {
        match element.name {
            b"vertex" => read_vertices(&mut values, element, &mut mesh)?,
            b"face" => read_faces(&mut values, element, vertices, &mut polygons)?,
            name => {
                let name = String::from_utf8_lossy(name);
                // Without a property there is nothing to read, however many there are.
                if !element.properties.is_empty() {
                    for _ in 0..element.count {
                        for property in &element.properties {
                            values.skip(property, &name)?;
                        }
                    }
                }
                notes.push(format!("{} {name} left out", element.count));
            }
        }
    }
    let rest = values.cursor.rest().trim_ascii_start().len();
    if rest > 0 {
        notes.push(format!("{} after the last element left out", counted(rest, "byte", "bytes")));
    }
    notes.extend(polygons.note());
    mesh.panels = polygons.panels;
    Ok((mesh, notes))
}

fn header<'a>(cursor: &mut Cursor<'a>) -> Result<(bool, Vec<Element<'a>>), ReadError> {
    let mut is_binary = None;
    let mut elements: Vec<Element<'a>> = Vec::new();
    let mut names = BTreeSet::new();
    let first = cursor.line().ok_or_else(|| cursor.ends("ply"))?;
    if first.text != b"ply" {
        return Err(cursor.unexpected(first.at, &first.shown(), "ply"));
    }
    loop {
        let line = cursor.line().ok_or_else(|| cursor.ends("end_header"))?;
        let mut words = line.text.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty());
        let wrong = |expected: &str| cursor.unexpected(line.at, &line.shown(), expected);
        let number = |word: &[u8]| std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
        match [words.next(), words.next(), words.next(), words.next(), words.next()] {
            [Some(b"comment" | b"obj_info") | None, ..] => {}
            [Some(b"format"), Some(kind), Some(b"1.0"), ..] => match kind {
                b"ascii" => is_binary = Some(false),
                b"binary_little_endian" => is_binary = Some(true),
                b"binary_big_endian" => (is_binary, cursor.is_big_endian) = (Some(true), true),
                _ => return Err(wrong("the format ascii, binary_little_endian or binary_big_endian")),
            },
            [Some(b"element"), Some(name), Some(count), ..] => {
                let count = number(count).ok_or_else(|| wrong("element, its name and its number"))?;
                if !names.insert(name) {
                    return Err(wrong("an element that is not there yet"));
                }
                elements.push(Element { at: line.at, name, count, properties: Vec::new() });
            }
            [Some(b"property"), Some(b"list"), Some(length), Some(value), Some(name)] => {
                let kinds = Type::named(length).zip(Type::named(value));
                let (element, (length, value)) =
                    elements.last_mut().zip(kinds).ok_or_else(|| wrong("a list of an element, of known types,"))?;
                element.properties.push(Property { name, length: Some(length), value });
            }
            [Some(b"property"), Some(value), Some(name), ..] if value != b"list" => {
                let kind = Type::named(value);
                let (element, value) =
                    elements.last_mut().zip(kind).ok_or_else(|| wrong("a property of an element, of a known type,"))?;
                element.properties.push(Property { name, length: None, value });
            }
            [Some(b"end_header"), ..] => {
                let is_binary = is_binary.ok_or_else(|| wrong("format, before the header ends,"))?;
                return Ok((is_binary, elements));
            }
            _ => return Err(wrong("a line of the header (format, element, property, comment, end_header)")),
        }
    }
}

fn read_vertices(values: &mut Values<'_>, element: &Element<'_>, mesh: &mut Mesh) -> Result<(), ReadError> {
    let axis = |property: &Property<'_>| {
        let axis = [b"x", b"y", b"z"].iter().position(|axis| property.name == *axis);
        axis.filter(|_| property.length.is_none())
    };
    let axes: Vec<Option<usize>> = element.properties.iter().map(axis).collect();
    if (0..3).any(|axis| !axes.contains(&Some(axis))) {
        let expected = "an element vertex with the properties x, y and z";
        return Err(values.cursor.unexpected(element.at, "one without them", expected));
    }
    for _ in 0..element.count {
        let mut point = [0.0; 3];
        for (property, axis) in element.properties.iter().zip(&axes) {
            match *axis {
                Some(axis) => point[axis] = values.value(property.value, "a coordinate of a vertex")?,
                None => values.skip(property, "vertex")?,
            }
        }
        mesh.vertices.push(point);
    }
    Ok(())
}

fn read_faces(
    values: &mut Values<'_>,
    element: &Element<'_>,
    vertices: u64,
    polygons: &mut Polygons,
) -> Result<(), ReadError> {
    let is_corners = |property: &Property<'_>| {
        matches!(property.name, b"vertex_indices" | b"vertex_index") && property.length.is_some()
    };
    if element.properties.iter().filter(|p| is_corners(p)).count() != 1 {
        let expected = "an element face with one list vertex_indices";
        return Err(values.cursor.unexpected(element.at, "one with another number of them", expected));
    }
    let expected = format!("the number of a vertex, below {vertices},");
    let mut corners = Vec::new();
    for _ in 0..element.count {
        for property in &element.properties {
            match property.length.filter(|_| is_corners(property)) {
                None => values.skip(property, "face")?,
                Some(length) => {
                    corners.clear();
                    let at = values.cursor.at();
                    let count = values.index(length, u64::MAX, "the number of corners of a face")?;
                    for _ in 0..count {
                        corners.push(values.index(property.value, vertices, &expected)? as u32);
                    }
                    if count < 3 {
                        let found = format!("a face with {count} corners");
                        let c = &values.cursor;
                        let tell = if values.is_binary { Cursor::unexpected_byte } else { Cursor::unexpected };
                        return Err(tell(c, at, &found, "one with three or more"));
                    }
                    polygons.push(&corners);
                }
            }
        }
    }
    Ok(())
}
