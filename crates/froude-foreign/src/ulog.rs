//! ULog, the flight logs of PX4: each instance of a topic is a part, `vehicle_attitude_0`.
//!
//! `time [s]` is the message's `timestamp` (µs) from the log's own start on. Fields have the names of pyulog, `q[0]` or
//! `esc[1].rpm`; texts (`char`) are passed over and named. ULog states no units. Dropouts are named with their place; a file
//! that was cut off gives what is whole, with a note.
//!
//! Why not the crate px4-ulog: the reader is smaller than what would check the crate's answers.
//!
//! Source: PX4 user guide, "ULog File Format", version 1.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::{Cells, Column, Contents, ForeignError, MAX_CELLS, Part};

const MAGIC: &[u8] = b"ULog\x01\x12\x35";
const HEADER: usize = 16;

/// Most numbers of a message, and formats in formats.
const MAX_COLUMNS: usize = 10_000;
const MAX_DEPTH: usize = 16;

/// Most fields of a format with those in it: a message has 65535 bytes.
const MAX_SEEN: usize = 200_000;

/// Most dropouts that a note lists.
const MAX_NAMED: usize = 10;

/// Reads a file.
///
/// # Errors
///
/// What is no ULog, contradicts the format, or holds no topic; each with its byte.
pub fn read(bytes: &[u8]) -> Result<Contents, ForeignError> {
    let refuse = |what: &str| Err(ForeignError(what.to_owned()));
    if bytes.starts_with(b"ULogEnc") {
        return refuse("the log is encrypted; decrypt it with the tool `decrypt_ulog.py` of PX4 first");
    }
    if !bytes.starts_with(MAGIC) {
        return refuse("the file does not begin as ULog does");
    }
    let Some(start_us) = bytes.get(8..HEADER).and_then(u64_of) else {
        return refuse("the file ends within its first 16 bytes");
    };
    let mut log = Log { start_us, last_us: start_us, ..Log::default() };
    let mut at = HEADER;
    while at < bytes.len() {
        let section_end =
            log.appended.iter().copied().find(|offset| *offset > at).unwrap_or(bytes.len()).min(bytes.len());
        let message = bytes.get(at..section_end).and_then(message);
        let Some((kind, body)) = message else {
            // What a section before an appended one has too much, was being written when the power went.
            if section_end == bytes.len() {
                log.notes
                    .push(format!("the file ends within the message at byte {at}: what was recorded last is missing"));
            }
            at = section_end;
            continue;
        };
        log.take(kind, body).map_err(|problem| ForeignError(format!("byte {at}: {problem}")))?;
        at += 3 + body.len();
    }
    log.finish()
}

/// Type and body of the message at the beginning; none where it is cut off.
fn message(bytes: &[u8]) -> Option<(u8, &[u8])> {
    let [low, high, kind, rest @ ..] = bytes else { return None };
    Some((*kind, rest.get(..usize::from(u16::from_le_bytes([*low, *high])))?))
}

fn u64_of(bytes: &[u8]) -> Option<u64> {
    Some(u64::from_le_bytes(*bytes.first_chunk()?))
}

fn u16_of(bytes: &[u8]) -> Option<u16> {
    Some(u16::from_le_bytes(*bytes.first_chunk()?))
}

/// A type of field.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Kind {
    fn of(name: &str) -> Option<Self> {
        Some(match name {
            "int8_t" => Self::I8,
            "uint8_t" | "bool" | "char" => Self::U8,
            "int16_t" => Self::I16,
            "uint16_t" => Self::U16,
            "int32_t" => Self::I32,
            "uint32_t" => Self::U32,
            "int64_t" => Self::I64,
            "uint64_t" => Self::U64,
            "float" => Self::F32,
            "double" => Self::F64,
            _ => return None,
        })
    }

    fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    fn number(self, bytes: &[u8]) -> Option<f64> {
        Some(match self {
            Self::I8 => f64::from(*bytes.first()? as i8),
            Self::U8 => f64::from(*bytes.first()?),
            Self::I16 => f64::from(i16::from_le_bytes(*bytes.first_chunk()?)),
            Self::U16 => f64::from(u16_of(bytes)?),
            Self::I32 => f64::from(i32::from_le_bytes(*bytes.first_chunk()?)),
            Self::U32 => f64::from(u32::from_le_bytes(*bytes.first_chunk()?)),
            Self::I64 => i64::from_le_bytes(*bytes.first_chunk()?) as f64,
            Self::U64 => u64_of(bytes)? as f64,
            Self::F32 => f64::from(f32::from_le_bytes(*bytes.first_chunk()?)),
            Self::F64 => f64::from_le_bytes(*bytes.first_chunk()?),
        })
    }
}

/// Where the fields of a format lie.
#[derive(Debug, Clone, Default)]
struct Layout {
    /// Name, type and offset of every number.
    fields: Vec<(String, Kind, usize)>,
    /// Place of `timestamp`.
    timestamp: Option<usize>,
    texts: Vec<String>,
    size: usize,
    /// Fields that were looked at, of every kind.
    n_seen: usize,
}

/// An instance of a topic.
#[derive(Debug)]
struct Topic {
    name: String,
    layout: Layout,
    time_us: Vec<u64>,
    columns: Vec<Vec<f64>>,
}

#[derive(Default)]
struct Log {
    start_us: u64,
    last_us: u64,
    appended: Vec<usize>,
    /// Fields by the name of their format.
    formats: BTreeMap<String, String>,
    /// Place in `topics` by number of the subscription.
    subscribed: BTreeMap<u16, usize>,
    topics: Vec<Topic>,
    /// Length in ms, and the time before it.
    dropouts: Vec<(u16, u64)>,
    n_cells: usize,
    notes: Vec<String>,
}

impl Log {
    fn take(&mut self, kind: u8, body: &[u8]) -> Result<(), String> {
        match kind {
            b'B' => self.flags(body),
            b'F' => {
                let text = std::str::from_utf8(body).map_err(|_| "a format is not text".to_owned())?;
                let (name, fields) =
                    text.split_once(':').ok_or_else(|| format!("`{text}` is not a format; expected `name:fields`"))?;
                self.formats.insert(name.to_owned(), fields.to_owned());
                Ok(())
            }
            b'A' => self.subscribe(body),
            b'R' => {
                self.subscribed.remove(&u16_of(body).ok_or("a message is shorter than its head")?);
                Ok(())
            }
            b'D' => self.data(body),
            b'O' => {
                let length = u16_of(body).ok_or("a message is shorter than its head")?;
                self.dropouts.push((length, self.last_us));
                Ok(())
            }
            // Information, parameters, texts and marks of synchronisation, and what later versions may add.
            other if other.is_ascii_uppercase() => Ok(()),
            other => Err(format!("unknown ULog message type {other}: the file is damaged; copy it again")),
        }
    }

    fn flags(&mut self, body: &[u8]) -> Result<(), String> {
        let incompatible = body.get(8..16).ok_or("the flags are cut off")?;
        let is_appended = incompatible.first().is_some_and(|bits| bits & 1 != 0);
        let has_others = incompatible.first().is_some_and(|bits| bits & !1 != 0)
            || incompatible.iter().skip(1).any(|bits| *bits != 0);
        if has_others {
            return Err(
                "the log uses ULog features that are not read; convert it with ulog2csv (PyPI pyulog)".to_owned()
            );
        }
        if is_appended {
            let offsets = body.get(16..).unwrap_or_default().chunks_exact(8).filter_map(u64_of);
            self.appended =
                offsets.filter(|offset| *offset > 0).filter_map(|offset| usize::try_from(offset).ok()).collect();
            self.appended.sort_unstable();
        }
        Ok(())
    }

    fn subscribe(&mut self, body: &[u8]) -> Result<(), String> {
        let [instance, low, high, name @ ..] = body else { return Err("a subscription is cut off".to_owned()) };
        let name = std::str::from_utf8(name).map_err(|_| "the name of a topic is not text".to_owned())?;
        let mut layout = Layout::default();
        self.lay_out(name, "", &mut layout, 0)?;
        let own = format!("{name}_{instance}");
        let place = self.topics.iter().position(|topic| topic.name == own);
        let place = place.unwrap_or_else(|| {
            let columns = vec![Vec::new(); layout.fields.len()];
            self.topics.push(Topic { name: own, layout, time_us: Vec::new(), columns });
            self.topics.len() - 1
        });
        self.subscribed.insert(u16::from_le_bytes([*low, *high]), place);
        Ok(())
    }

    /// Adds the fields of a format behind those that are there.
    fn lay_out(&self, name: &str, path: &str, layout: &mut Layout, depth: usize) -> Result<(), String> {
        let fields = self.formats.get(name).ok_or_else(|| format!("the format of {name} is missing"))?;
        for field in fields.split(';').filter(|field| !field.is_empty()) {
            if depth > MAX_DEPTH || layout.fields.len() > MAX_COLUMNS {
                return Err(format!(
                    "{name} has more than {MAX_COLUMNS} numbers, or lies more than {MAX_DEPTH} formats deep"
                ));
            }
            let (kind, own) =
                field.split_once(' ').ok_or_else(|| format!("`{field}` is not a field; expected `type name`"))?;
            let (kind, length) = match kind.split_once('[') {
                None => (kind, None),
                Some((kind, length)) => {
                    let length = length.strip_suffix(']').and_then(|length| length.parse::<u16>().ok());
                    (kind, Some(length.ok_or_else(|| format!("`{field}`: expected `type[length] name`"))?))
                }
            };
            let path = format!("{path}{own}");
            let is_kept = !own.starts_with("_padding") && kind != "char";
            if kind == "char" {
                layout.texts.push(path.clone());
            }
            for i in 0..length.unwrap_or(1) {
                layout.n_seen += 1;
                if layout.n_seen > MAX_SEEN || layout.size > usize::from(u16::MAX) {
                    return Err(format!("{name} describes messages that are longer than a message can be"));
                }
                let path = if length.is_some() { format!("{path}[{i}]") } else { path.clone() };
                let Some(number) = Kind::of(kind) else {
                    self.lay_out(kind, &format!("{path}."), layout, depth + 1)?;
                    continue;
                };
                if path == "timestamp" && number == Kind::U64 {
                    layout.timestamp = Some(layout.size);
                } else if is_kept {
                    layout.fields.push((path, number, layout.size));
                }
                layout.size += number.size();
            }
        }
        Ok(())
    }

    fn data(&mut self, body: &[u8]) -> Result<(), String> {
        let number = u16_of(body).ok_or("a message is shorter than its head")?;
        let data = body.get(2..).unwrap_or_default();
        let topic = self.subscribed.get(&number).and_then(|place| self.topics.get_mut(*place));
        let topic = topic.ok_or_else(|| format!("a message is of topic {number}, which nothing declares"))?;
        let Some(timestamp) = topic.layout.timestamp else { return Ok(()) };
        let short = || {
            format!(
                "a message of {} has {} bytes, too few for the {} of its format",
                topic.name,
                data.len(),
                topic.layout.size
            )
        };
        let time_us = data.get(timestamp..).and_then(u64_of).ok_or_else(short)?;
        // All or none: a row must not be shorter in some columns.
        let cells =
            topic.layout.fields.iter().map(|(_, kind, at)| data.get(*at..).and_then(|bytes| kind.number(bytes)));
        let row: Vec<f64> = cells.collect::<Option<_>>().ok_or_else(short)?;
        self.n_cells += 1 + row.len();
        if self.n_cells > MAX_CELLS {
            return Err(format!("the topics have more than {MAX_CELLS} numbers"));
        }
        topic.time_us.push(time_us);
        topic.columns.iter_mut().zip(row).for_each(|(column, cell)| column.push(cell));
        self.last_us = time_us;
        Ok(())
    }

    fn seconds(&self, time_us: u64) -> f64 {
        (i128::from(time_us) - i128::from(self.start_us)) as f64 / 1e6
    }

    fn finish(mut self) -> Result<Contents, ForeignError> {
        let mut notes = std::mem::take(&mut self.notes);
        if !self.dropouts.is_empty() {
            let total: u64 = self.dropouts.iter().map(|(ms, _)| u64::from(*ms)).sum();
            let mut note = format!("{} of the recorder, {total} ms together:", counted(self.dropouts.len(), "dropout"));
            for (ms, last_us) in self.dropouts.iter().take(MAX_NAMED) {
                let _ = write!(note, " {ms} ms after {:.3} s,", self.seconds(*last_us));
            }
            notes
                .push(note.trim_end_matches(',').to_owned() + if self.dropouts.len() > MAX_NAMED { ", …" } else { "" });
        }
        let topics = std::mem::take(&mut self.topics);
        let mut parts = Vec::new();
        for topic in topics {
            let name = topic.name;
            if topic.layout.timestamp.is_none() {
                notes.push(format!("topic {name} is not read: it has no field `uint64_t timestamp`"));
                continue;
            }
            if topic.time_us.is_empty() {
                notes.push(format!("topic {name} has no messages"));
                continue;
            }
            if !topic.layout.texts.is_empty() {
                notes.push(format!("topic {name}: not read: {} (text)", topic.layout.texts.join(", ")));
            }
            let time = topic.time_us.iter().map(|us| self.seconds(*us)).collect();
            let mut columns = vec![column("time", "s", time)];
            let fields = topic.layout.fields.into_iter().zip(topic.columns);
            columns.extend(fields.map(|((field, ..), values)| column(&field, "", values)));
            parts.push(Part { name, columns });
        }
        if parts.is_empty() {
            notes.insert(0, "no topic of this ULog file can be read".to_owned());
            return Err(ForeignError(notes.join("; ")));
        }
        notes.push(format!(
            "times count from the start of the log, {:.6} s after the vehicle's",
            self.start_us as f64 / 1e6
        ));
        Ok(Contents { parts, notes, left_out: Vec::new() })
    }
}

fn column(name: &str, unit: &str, values: Vec<f64>) -> Column {
    Column { name: name.to_owned(), unit: unit.to_owned(), cells: Cells::Numbers(values) }
}

fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}
