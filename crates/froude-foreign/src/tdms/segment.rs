//! The segments of a TDMS file: which objects have data in each, and how their bytes lie.
//!
//! Source: NI, "TDMS File Format Internal Structure"; DAQmx indices, which it does not describe in full, as npTDMS 1.13 reads them.

use std::collections::BTreeMap;
use std::rc::Rc;

use super::bytes::{Cursor, Type, Value};

/// Lead-in of a segment.
const LEAD_IN: usize = 28;

const META_DATA: u32 = 1 << 1;
const NEW_OBJECTS: u32 = 1 << 2;
const RAW_DATA: u32 = 1 << 3;
const INTERLEAVED: u32 = 1 << 5;
const BIG_ENDIAN: u32 = 1 << 6;

const NO_DATA: u32 = 0xffff_ffff;
const AS_BEFORE: u32 = 0;
const FORMAT_CHANGING: u32 = 0x1269;
const DIGITAL_LINE: u32 = 0x126a;

/// How an object's values lie in a segment.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Index {
    pub kind: Type,
    /// Values in a chunk.
    pub count: usize,
    /// Bytes of them in a chunk; not for DAQmx.
    pub bytes: usize,
    /// Where its values are taken from in DAQmx data.
    pub scalers: Vec<Scaler>,
    /// Bytes of a sample in each buffer of DAQmx data.
    pub widths: Vec<usize>,
}

/// A value in the bytes of a sample of a DAQmx device.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Scaler {
    pub id: u32,
    pub kind: Type,
    pub buffer: usize,
    pub offset: usize,
    /// The one bit that counts, of a digital line.
    pub bit: Option<u32>,
}

/// An object and its data in a segment.
#[derive(Debug, Clone)]
pub(super) struct Object {
    pub path: Rc<str>,
    pub has_data: bool,
    pub index: Option<Rc<Index>>,
}

/// A segment with data.
#[derive(Debug)]
pub(super) struct Segment {
    pub objects: Rc<Vec<Object>>,
    pub start: usize,
    pub end: usize,
    pub is_big: bool,
    pub is_interleaved: bool,
    /// Its end was not written.
    pub is_cut: bool,
}

/// What the segments say.
#[derive(Debug, Default)]
pub(super) struct Layout {
    pub segments: Vec<Segment>,
    /// Properties by path, in the order in which objects appear.
    pub objects: Vec<(Rc<str>, BTreeMap<String, Value>)>,
    place: BTreeMap<Rc<str>, usize>,
    /// Bytes at the end that are of no whole segment.
    pub cut_at: Option<usize>,
}

impl Layout {
    /// Walks a file.
    ///
    /// # Errors
    ///
    /// What contradicts the format, with its byte.
    pub fn read(bytes: &[u8]) -> Result<Self, String> {
        let mut layout = Self::default();
        let mut known: BTreeMap<Rc<str>, Object> = BTreeMap::new();
        let mut objects: Rc<Vec<Object>> = Rc::default();
        let mut at = 0;
        while at < bytes.len() {
            let mut cursor = Cursor { bytes, at, is_big: false };
            let Ok(tag) = cursor.take(4) else {
                layout.cut_at = Some(at);
                break;
            };
            if tag != b"TDSm" {
                return Err(match (at, tag) {
                    (0, b"TDSh") => {
                        "it is the index of a TDMS file (.tdms_index); name the .tdms file beside it".to_owned()
                    }
                    (0, _) => "the file does not begin as TDMS does".to_owned(),
                    _ => format!("no segment begins at byte {at}, where one is expected; copy the file again"),
                });
            }
            if bytes.len() - at < LEAD_IN {
                layout.cut_at = Some(at);
                break;
            }
            let toc = cursor.u32()?;
            cursor.is_big = toc & BIG_ENDIAN != 0;
            let (_version, next, raw) = (cursor.u32()?, cursor.u64()?, cursor.u64()?);
            let place =
                |offset: u64| usize::try_from(offset).ok().and_then(|offset| (at + LEAD_IN).checked_add(offset));
            let start = place(raw).ok_or_else(|| format!("the segment at byte {at} claims data beyond its end"))?;
            let next = place(next).filter(|next| *next <= bytes.len());
            let (end, is_cut) = (next.unwrap_or(bytes.len()), next.is_none());
            if start > end {
                if is_cut {
                    layout.cut_at = Some(at);
                    break;
                }
                return Err(format!("the segment at byte {at} has its data behind its end"));
            }
            if toc & META_DATA != 0 {
                cursor.bytes = bytes.get(..start).unwrap_or(bytes);
                let mut list = if toc & NEW_OBJECTS != 0 { Vec::new() } else { objects.to_vec() };
                layout.metadata(&mut cursor, &mut list, &mut known)?;
                objects = Rc::new(list);
            } else if layout.segments.is_empty() && layout.objects.is_empty() {
                return Err(format!("the segment at byte {at} has no metadata, and none before it has"));
            }
            if toc & RAW_DATA != 0 && end > start {
                let is_interleaved = toc & INTERLEAVED != 0;
                let (objects, is_big) = (Rc::clone(&objects), cursor.is_big);
                layout.segments.push(Segment { objects, start, end, is_big, is_interleaved, is_cut });
            } else if is_cut {
                layout.cut_at = Some(at);
            }
            at = end;
        }
        Ok(layout)
    }

    fn metadata(
        &mut self,
        cursor: &mut Cursor<'_>,
        list: &mut Vec<Object>,
        known: &mut BTreeMap<Rc<str>, Object>,
    ) -> Result<(), String> {
        let mut places: BTreeMap<Rc<str>, usize> =
            list.iter().enumerate().map(|(i, object)| (Rc::clone(&object.path), i)).collect();
        for _ in 0..cursor.u32()? {
            let path: Rc<str> = cursor.text()?.into();
            let before = places.get(&path).and_then(|i| list.get(*i)).or_else(|| known.get(&path));
            let at = cursor.at;
            let index = match cursor.u32()? {
                NO_DATA => None,
                AS_BEFORE => Some(before.and_then(|object| object.index.clone()).ok_or_else(|| {
                    format!("at byte {at} {path} is said to have data as before, and has none before")
                })?),
                header => Some(Rc::new(index(cursor, header).map_err(|e| format!("{path}: {e}"))?)),
            };
            let has_data = index.is_some();
            let index = index.or_else(|| before.and_then(|object| object.index.clone()));
            let object = Object { path: Rc::clone(&path), has_data, index };
            match places.get(&path).and_then(|i| list.get_mut(*i)) {
                Some(place) => *place = object.clone(),
                None => {
                    places.insert(Rc::clone(&path), list.len());
                    list.push(object.clone());
                }
            }
            known.insert(Rc::clone(&path), object);
            let place = *self.place.entry(Rc::clone(&path)).or_insert_with(|| {
                self.objects.push((Rc::clone(&path), BTreeMap::new()));
                self.objects.len() - 1
            });
            for _ in 0..cursor.u32()? {
                let (name, value) = (cursor.text()?, cursor.value()?);
                if let Some((_, properties)) = self.objects.get_mut(place) {
                    properties.insert(name, value);
                }
            }
        }
        Ok(())
    }
}

fn index(cursor: &mut Cursor<'_>, header: u32) -> Result<Index, String> {
    let at = cursor.at - 4;
    let kind = cursor.u32()?;
    let kind = Type::of(kind).map_err(|kind| format!("its values are {kind}, which is not read"))?;
    let dimension = cursor.u32()?;
    let count = usize::try_from(cursor.u64()?).map_err(|_| "it claims more values than memory has bytes".to_owned())?;
    if dimension != 1 {
        return Err(format!("at byte {at} its values have {dimension} dimensions; expected 1"));
    }
    if matches!(header, FORMAT_CHANGING | DIGITAL_LINE) {
        return daqmx(cursor, header, kind, count);
    }
    let too_many = || format!("at byte {at} it claims {count} values, more than the file has bytes");
    let bytes = match (kind, kind.size(), header) {
        (Type::Text, _, 28) => usize::try_from(cursor.u64()?).map_err(|_| too_many())?,
        (_, Some(size), 20) => count.checked_mul(size).ok_or_else(too_many)?,
        _ => return Err(format!("at byte {at} an index of {header} bytes does not fit its type")),
    };
    Ok(Index { kind, count, bytes, scalers: Vec::new(), widths: Vec::new() })
}

fn daqmx(cursor: &mut Cursor<'_>, header: u32, kind: Type, count: usize) -> Result<Index, String> {
    let mut scalers = Vec::new();
    for _ in 0..cursor.u32()? {
        let code = cursor.u32()?;
        let scaler_kind = Type::of_scaler(code).ok_or_else(|| format!("a scaler has the unknown type {code}"))?;
        let (buffer, place) = (cursor.u32()? as usize, cursor.u32()?);
        let (offset, bit) = if header == DIGITAL_LINE {
            cursor.take(1)?;
            ((place / 8) as usize, Some(place % 8))
        } else {
            cursor.u32()?;
            (place as usize, None)
        };
        let id = cursor.u32()?;
        scalers.push(Scaler { id, kind: scaler_kind, buffer, offset, bit });
    }
    if kind != Type::Daqmx && !matches!(scalers.as_slice(), [only] if only.kind == kind) {
        return Err("its type is not that of its one scaler".to_owned());
    }
    let mut widths = Vec::new();
    for _ in 0..cursor.u32()? {
        widths.push(cursor.u32()? as usize);
    }
    for scaler in &scalers {
        let width = widths.get(scaler.buffer).copied().unwrap_or(0);
        let end = scaler.kind.size().and_then(|size| scaler.offset.checked_add(size));
        if end.is_none_or(|end| end > width) {
            return Err(format!("scaler {} lies beyond the {width} bytes of a sample", scaler.id));
        }
    }
    Ok(Index { kind, count, bytes: 0, scalers, widths })
}
