//! MAT files of level 5, as MATLAB writes them with `-v6` and `-v7` (its default), Octave with `-v7`, and SciPy.
//!
//! | in the file | here |
//! |---|---|
//! | vectors and matrices of numbers, `logical` | columns of numbers; whole numbers above 2⁵³ are rounded to 53 bits |
//! | `char`, a `cell` of texts | columns of texts |
//! | `struct` | a table of its own, by its path: `run.force` |
//! | an array of `struct` with single values | a table with one row for each element; else each element by itself |
//! | complex, sparse, other cells, three dimensions, `table`, `datetime`, objects | left out, with what to do in MATLAB |
//!
//! The crate matrw 0.1.4 panics on damaged data and rejects the files of SciPy for a comma that their header lacks.
//!
//! # Source
//!
//! MathWorks, *MAT-File Format*, R2019b. The layout of objects, which it leaves out, is that of SciPy's `io.matlab`.

use std::io::Read;

use flate2::read::ZlibDecoder;

use crate::variables::{Value, contents};
use crate::{Contents, ForeignError, MAX_BYTES, MAX_CELLS};

const HEADER_BYTES: usize = 128;
/// Most bytes that a compressed variable may unpack to: numbers of eight bytes, and names.
const MAX_VARIABLE_BYTES: u64 = 8 * MAX_CELLS as u64 + (64 << 20);
/// Most structures inside of each other.
const MAX_DEPTH: usize = 32;

/// Whether a file begins as a MAT file of level 5 does.
#[must_use]
pub fn is_mat5(bytes: &[u8]) -> bool {
    matches!(bytes.get(124..HEADER_BYTES), Some([_, 1, b'I', b'M'] | [1, _, b'M', b'I'])) && !bytes.starts_with(&[0])
}

/// Reads a MAT file of level 5.
///
/// # Errors
///
/// If it is of another level, damaged or too large, or if nothing in it is read.
pub fn read(bytes: &[u8]) -> Result<Contents, ForeignError> {
    if bytes.len() as u64 > MAX_BYTES {
        return Err(ForeignError(format!(
            "has {} MiB; MAT files of at most {} MiB are read",
            bytes.len() >> 20,
            MAX_BYTES >> 20
        )));
    }
    if bytes.starts_with(b"# Created by Octave") || bytes.starts_with(b"Octave-1") {
        return Err(ForeignError(
            "is in Octave's own format, which Octave alone reads; in Octave, load it and save it with save -v7 NAME.mat".into(),
        ));
    }
    if !is_mat5(bytes) {
        return Err(ForeignError(
            "is not a MAT file of level 5: its bytes 125 to 128 are not its version; in MATLAB load it and save it with save(\"NAME.mat\", \
             \"-v7\")"
                .into(),
        ));
    }
    let is_big = bytes.get(126) == Some(&b'M');
    let mut file = Elements { rest: bytes.get(HEADER_BYTES..).unwrap_or_default(), at: HEADER_BYTES, is_big };
    let mut variables = Vec::new();
    let mut n_cells = 0;
    while !file.rest.is_empty() {
        let at = file.at;
        let element = file.next()?;
        let (name, value) = match element.kind {
            Kind::COMPRESSED => {
                let mut unpacked = Vec::new();
                let mut packed = ZlibDecoder::new(element.bytes).take(MAX_VARIABLE_BYTES + 1);
                packed
                    .read_to_end(&mut unpacked)
                    .map_err(|e| damaged(at, &format!("a variable cannot be unpacked ({e})")))?;
                if unpacked.len() as u64 > MAX_VARIABLE_BYTES {
                    return Err(ForeignError(format!(
                        "byte {at}: a variable unpacks to more than {} MiB, the most that is read; save the columns that are needed",
                        MAX_VARIABLE_BYTES >> 20
                    )));
                }
                let inner = Elements { rest: &unpacked, at: 0, is_big }.next()?;
                if inner.kind != Kind::MATRIX {
                    return Err(damaged(at, "what is compressed is not a variable"));
                }
                matrix(inner.inside(is_big), 0, &mut n_cells)?
            }
            Kind::MATRIX => matrix(element.inside(is_big), 0, &mut n_cells)?,
            kind => return Err(damaged(at, &format!("expected a variable, found an element of type {}", kind.0))),
        };
        // Without a name: data of objects, which the variables refer to.
        if !name.is_empty() {
            variables.push((name, value));
        }
    }
    contents(variables)
}

fn damaged(at: usize, why: &str) -> ForeignError {
    ForeignError(format!("the MAT file is damaged at byte {at}: {why}; copy it again, or load and save it in MATLAB"))
}

/// Type of an element.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
struct Kind(u32);

impl Kind {
    const INT8: Self = Self(1);
    const UINT8: Self = Self(2);
    const INT16: Self = Self(3);
    const UINT16: Self = Self(4);
    const INT32: Self = Self(5);
    const UINT32: Self = Self(6);
    const SINGLE: Self = Self(7);
    const DOUBLE: Self = Self(9);
    const INT64: Self = Self(12);
    const UINT64: Self = Self(13);
    const MATRIX: Self = Self(14);
    const COMPRESSED: Self = Self(15);
    const UTF8: Self = Self(16);
    const UTF16: Self = Self(17);
    const UTF32: Self = Self(18);
}

/// A piece of data with its type.
struct Element<'a> {
    kind: Kind,
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Element<'a> {
    fn inside(&self, is_big: bool) -> Elements<'a> {
        Elements { rest: self.bytes, at: self.at, is_big }
    }
}

/// Elements one after the other.
struct Elements<'a> {
    rest: &'a [u8],
    /// Place of `rest`, in the file or in what a variable unpacks to.
    at: usize,
    is_big: bool,
}

impl<'a> Elements<'a> {
    fn u32(&self, at: usize) -> Result<u32, ForeignError> {
        let bytes = self.rest.get(at..).and_then(|rest| rest.first_chunk());
        let bytes = bytes.ok_or_else(|| damaged(self.at, "it ends inside of a variable"))?;
        Ok(if self.is_big { u32::from_be_bytes(*bytes) } else { u32::from_le_bytes(*bytes) })
    }

    fn next(&mut self) -> Result<Element<'a>, ForeignError> {
        let tag = self.u32(0)?;
        // A small element has its size in the upper half of its type, and its data in what would be the size.
        let (kind, start, size) =
            if tag >> 16 == 0 { (tag, 8, self.u32(4)? as usize) } else { (tag & 0xFFFF, 4, (tag >> 16) as usize) };
        let kind = Kind(kind);
        let bytes = self.rest.get(start..start + size).filter(|_| start == 8 || size <= 4);
        let at = self.at + start;
        let bytes = bytes.ok_or_else(|| {
            let there = self.rest.len().saturating_sub(start);
            damaged(self.at, &format!("an element of {size} bytes is announced, {there} follow"))
        })?;
        let padded =
            if start == 4 { 8 } else { start + size.next_multiple_of(if kind == Kind::COMPRESSED { 1 } else { 8 }) };
        let padded = padded.min(self.rest.len());
        self.rest = self.rest.get(padded..).unwrap_or_default();
        self.at += padded;
        Ok(Element { kind, bytes, at })
    }

    /// The next element, which must be bytes of a name.
    fn name(&mut self) -> Result<String, ForeignError> {
        let element = self.next()?;
        match element.kind {
            Kind::INT8 | Kind::UINT8 | Kind::UTF8 => {
                Ok(String::from_utf8_lossy(element.bytes).trim_end_matches('\0').to_owned())
            }
            kind => Err(damaged(element.at, &format!("expected a name, found an element of type {}", kind.0))),
        }
    }
}

/// Name and content of a variable or field.
fn matrix(mut body: Elements<'_>, depth: usize, n_cells: &mut usize) -> Result<(String, Value), ForeignError> {
    let is_big = body.is_big;
    if body.rest.is_empty() {
        let empty = Value::Numbers { rows: 0, columns: 0, data: Vec::new(), unit: String::new() };
        return Ok((String::new(), empty));
    }
    if depth > MAX_DEPTH {
        return Err(ForeignError(format!("byte {}: structures lie more than {MAX_DEPTH} deep in each other", body.at)));
    }
    let flags = body.next()?;
    let flags = flags.inside(is_big).u32(0)?;
    let (class, is_complex) = (flags & 0xFF, flags & 0x0800 != 0);
    // An object of a class has no dimensions: its name, its kind of system, its class.
    if class == 17 {
        let name = body.name()?;
        let (_, class) = (body.name()?, body.name()?);
        return Ok((name.clone(), Value::Unread(object(&class, &name))));
    }
    let dimensions = body.next()?;
    let mut dims = numbers(&dimensions, is_big)?;
    let name = body.name()?;
    while dims.len() > 2 && dims.last() == Some(&1.0) {
        dims.pop();
    }
    let size = |i: usize| dims.get(i).map_or(0, |n| *n as usize);
    let (rows, columns) = (size(0), size(1));
    let n = dims.iter().fold(1_usize, |n, dim| n.saturating_mul(*dim as usize));
    let unread = |reason: String| Ok((name.clone(), Value::Unread(reason)));
    if dims.len() > 2 && matches!(class, 1..=15) {
        return unread(format!(
            "has {} dimensions; save its slices, {name}(:,:,1) and so on, as variables of their own",
            dims.len()
        ));
    }
    let value = match class {
        1 => {
            let mut texts = Vec::new();
            while !body.rest.is_empty() && texts.len() < n {
                match child(&mut body, depth, n_cells)? {
                    Value::Texts(text) if text.len() == 1 => texts.extend(text),
                    _ => {
                        return unread(format!(
                            "is a cell array; save a matrix of it, cell2mat({name}), or a file of it, writetable(cell2table({name}), \
                             \"{name}.csv\")"
                        ));
                    }
                }
            }
            Value::Texts(texts)
        }
        // An object of the old kind has the name of its class first.
        3 => return unread(object(&body.name()?, &name)),
        2 => structure(body, n, depth, n_cells)?,
        4 => {
            let element = body.next()?;
            Value::Texts(texts(&letters(&element, is_big)?, rows))
        }
        5 => return unread(format!("is sparse; save full({name})")),
        6..=15 if is_complex => {
            return unread(format!("is complex; save real({name}) and imag({name}) as variables of their own"));
        }
        6..=15 => {
            let element = body.next()?;
            *n_cells = n_cells.saturating_add(n);
            if *n_cells > MAX_CELLS {
                return Err(ForeignError(format!(
                    "variable {name:?}: with it the file has more than {} million numbers, the most that are read; save the columns that \
                     are needed",
                    MAX_CELLS / 1_000_000
                )));
            }
            let data = numbers(&element, is_big)?;
            if data.len() != n {
                return Err(damaged(
                    element.at,
                    &format!("variable {name:?} announces {rows} × {columns} numbers and has {}", data.len()),
                ));
            }
            Value::Numbers { rows, columns, data, unit: String::new() }
        }
        16 => return unread("is a function".to_owned()),
        class => {
            return Err(damaged(
                body.at,
                &format!("variable {name:?} has the class {class}, which the format does not define"),
            ));
        }
    };
    Ok((name, value))
}

/// The next element inside of a variable, which must be one, too.
fn child(body: &mut Elements<'_>, depth: usize, n_cells: &mut usize) -> Result<Value, ForeignError> {
    let element = body.next()?;
    if element.kind != Kind::MATRIX {
        return Err(damaged(element.at, &format!("expected a field, found an element of type {}", element.kind.0)));
    }
    Ok(matrix(element.inside(body.is_big), depth + 1, n_cells)?.1)
}

/// Fields of a structure, or of an array of them.
fn structure(mut body: Elements<'_>, n: usize, depth: usize, n_cells: &mut usize) -> Result<Value, ForeignError> {
    let is_big = body.is_big;
    let length = body.next()?.inside(is_big).u32(0)? as usize;
    let names = body.next()?;
    if length == 0 {
        return Err(damaged(names.at, "names of fields have no letters"));
    }
    let names = names.bytes.chunks(length).map(|name| {
        let end = name.iter().position(|b| *b == 0).unwrap_or(name.len());
        String::from_utf8_lossy(name.get(..end).unwrap_or_default()).into_owned()
    });
    let names: Vec<String> = names.collect();
    let mut elements = Vec::new();
    if names.is_empty() {
        return Ok(Value::Fields(Vec::new()));
    }
    for _ in 0..n {
        let mut fields = Vec::new();
        for name in &names {
            fields.push((name.clone(), child(&mut body, depth, n_cells)?));
        }
        elements.push(fields);
    }
    Ok(match <[_; 1]>::try_from(elements) {
        Ok([fields]) => Value::Fields(fields),
        Err(elements) => Value::Elements(elements),
    })
}

/// Numbers of any type of storage: MATLAB stores doubles as bytes where they fit.
fn numbers(element: &Element<'_>, is_big: bool) -> Result<Vec<f64>, ForeignError> {
    macro_rules! all {
        ($type:ty) => {{
            let (chunks, rest) = element.bytes.as_chunks::<{ size_of::<$type>() }>();
            if !rest.is_empty() {
                return Err(damaged(element.at, "a number is cut off"));
            }
            let number = |b: &[u8; size_of::<$type>()]| {
                (if is_big { <$type>::from_be_bytes(*b) } else { <$type>::from_le_bytes(*b) }) as f64
            };
            Ok(chunks.iter().map(number).collect())
        }};
    }
    #[allow(clippy::cast_lossless, reason = "one line for all types")]
    match element.kind {
        Kind::INT8 => all!(i8),
        Kind::UINT8 => all!(u8),
        Kind::INT16 => all!(i16),
        Kind::UINT16 => all!(u16),
        Kind::INT32 => all!(i32),
        Kind::UINT32 => all!(u32),
        Kind::SINGLE => all!(f32),
        Kind::DOUBLE => all!(f64),
        Kind::INT64 => all!(i64),
        Kind::UINT64 => all!(u64),
        kind => Err(damaged(element.at, &format!("expected numbers, found an element of type {}", kind.0))),
    }
}

/// Letters of a `char` array.
fn letters(element: &Element<'_>, is_big: bool) -> Result<Vec<char>, ForeignError> {
    Ok(match element.kind {
        Kind::UTF8 => String::from_utf8_lossy(element.bytes).chars().collect(),
        Kind::UINT16 | Kind::UTF16 => {
            let units: Vec<u16> =
                numbers(&Element { kind: Kind::UINT16, ..*element }, is_big)?.iter().map(|x| *x as u16).collect();
            String::from_utf16_lossy(&units).chars().collect()
        }
        Kind::UTF32 => {
            let codes = numbers(&Element { kind: Kind::UINT32, ..*element }, is_big)?;
            codes.iter().map(|x| char::from_u32(*x as u32).unwrap_or('\u{FFFD}')).collect()
        }
        // One byte each: Latin-1, of which ASCII is a part.
        _ => element.bytes.iter().map(|b| char::from(*b)).collect(),
    })
}

/// Rows of a `char` array, which is stored column by column and padded with blanks.
fn texts(letters: &[char], rows: usize) -> Vec<String> {
    let row = |i: usize| letters.iter().skip(i).step_by(rows.max(1)).collect::<String>().trim_end().to_owned();
    (0..rows.max(1)).take(letters.len().max(1)).map(row).collect()
}

/// What to do about an object.
pub(crate) fn object(class: &str, name: &str) -> String {
    let what = match class {
        "table" => format!(
            "save it as a file, writetable({name}, \"{name}.csv\"), or as {name} = table2struct({name}, \"ToScalar\", true)"
        ),
        "timetable" => format!("save it as a file, writetimetable({name}, \"{name}.csv\")"),
        "datetime" => format!("save {name} = posixtime({name}), seconds since 1970"),
        "duration" => format!("save {name} = seconds({name})"),
        "string" | "categorical" => format!("save {name} = cellstr({name})"),
        "timeseries" => format!("save {name}_time = {name}.Time and {name}_data = {name}.Data"),
        _ => format!("save the columns that are needed as vectors, or {name} = struct({name})"),
    };
    let kind = if class.is_empty() { "an object".to_owned() } else { format!("a {class} object") };
    format!("is {kind}, which MATLAB alone reads; in MATLAB, {what}")
}
