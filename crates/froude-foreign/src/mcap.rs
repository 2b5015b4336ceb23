//! MCAP logs that other programs recorded: each topic is a part, at its own stamps.
//!
//! | messages                        | read                                                        |
//! |---------------------------------|-------------------------------------------------------------|
//! | `json`, with or without a schema | numbers and truth values by their path                     |
//! | `cdr` with `ros2msg`            | numbers of the definition and of those in it                |
//! | everything else                 | passed over; the note says with what to convert the topic   |
//!
//! **Time.** `time [s]` is the message's `header.stamp` where every message of the topic has one, else the file's log time. It
//! counts from the file's first log time, so topics lie beside each other; stamps of a clock that is more than a day off
//! count from the topic's own first. Messages stay in the order of the file.
//!
//! Chunks are checked against their checksums before they are read. A file that was cut off gives what is whole, with a note.
//!
//! Format: the MCAP specification, version 0 (mcap.dev/spec).

mod json;
mod ros2;

use std::collections::BTreeMap;
use std::io::Read;

use mcap::McapError;
use mcap::records::op;
use mcap::sans_io::linear_reader::{LinearReadEvent, LinearReader, LinearReaderOptions};

use crate::guard::guarded;
use crate::{Cells, Column, Contents, ForeignError, MAX_CELLS, Part};

/// Largest chunk: as many times its file, and at most so many bytes.
const TIMES: u64 = 200;
const MAX_CHUNK: u64 = 256 << 20;

const NS_PER_S: i128 = 1_000_000_000;

/// Stamps that are further than this from the file's own are of another clock.
const OTHER_CLOCK_NS: i128 = 86_400 * NS_PER_S;

/// Reads a log of so many bytes.
///
/// # Errors
///
/// A file that is no MCAP, is damaged, or has no topic that can be read; a message that does not fit its definition.
pub fn read(input: &mut dyn Read, bytes: u64) -> Result<Contents, ForeignError> {
    guarded("the log", || records(input, bytes))
}

fn records(input: &mut dyn Read, bytes: u64) -> Result<Contents, ForeignError> {
    let mut log = Log::default();
    let mut notes = Vec::new();
    let limit = bytes.saturating_mul(TIMES).clamp(1 << 20, MAX_CHUNK);
    let options = LinearReaderOptions::default()
        .with_prevalidate_chunk_crcs(true)
        .with_record_length_limit(usize::try_from(limit).unwrap_or(usize::MAX));
    let mut reader = LinearReader::new_with_options(options);
    let (mut passed, mut n_records) = (0_u64, 0_u64);
    while let Some(event) = reader.next_event() {
        match event {
            Ok(LinearReadEvent::ReadRequest(need)) => {
                // No more than the file can still have: a length in it may be a lie.
                let left = bytes.saturating_sub(passed).saturating_add(1);
                let buffer = reader.insert(need.min(usize::try_from(left).unwrap_or(usize::MAX)));
                let n =
                    input.read(buffer).map_err(|e| ForeignError(format!("cannot be read at byte {passed}: {e}")))?;
                reader.notify_read(n);
                passed += n as u64;
            }
            Ok(LinearReadEvent::Record { opcode, data }) => {
                n_records += 1;
                log.take(opcode, data)?;
            }
            Err(McapError::BadMagic) if n_records == 0 => {
                return Err(ForeignError("the file does not begin as MCAP does".to_owned()));
            }
            Err(McapError::UnexpectedEof) => {
                notes.push(format!(
                    "the file ends at byte {passed} without its end mark: messages that were recorded last may be missing \
                     (`mcap recover` writes a whole file of what is there)"
                ));
                break;
            }
            Err(error) => {
                return Err(ForeignError(format!(
                    "the file is damaged before byte {passed}: {error}; copy it again, or write what is whole to a new file with \
                     `mcap recover`"
                )));
            }
        }
    }
    log.finish(notes)
}

/// A topic's messages as far as they were read.
struct Topic {
    name: String,
    decoder: Decoder,
    log_times: Vec<u64>,
    columns: Vec<Vec<f64>>,
    row: Vec<f64>,
}

enum Decoder {
    Json(json::Topic),
    Ros2(ros2::Message),
    /// Why it is not read.
    None(String),
}

#[derive(Default)]
struct Log {
    /// Name, encoding and text.
    schemas: BTreeMap<u16, (String, String, Vec<u8>)>,
    topics: BTreeMap<u16, Topic>,
    first_log_time: Option<u64>,
    n_cells: usize,
}

impl Log {
    fn take(&mut self, opcode: u8, data: &[u8]) -> Result<(), ForeignError> {
        let damaged = |what: &str| ForeignError(format!("{what} in the file is shorter than its own lengths say"));
        match opcode {
            op::SCHEMA => {
                let (id, schema) = schema(data).ok_or_else(|| damaged("a schema"))?;
                self.schemas.entry(id).or_insert(schema);
            }
            op::CHANNEL => {
                let channel = Channel::parse(data).ok_or_else(|| damaged("a channel"))?;
                if !self.topics.contains_key(&channel.id) {
                    let decoder = self.decoder(&channel);
                    let topic = Topic {
                        name: channel.topic,
                        decoder,
                        log_times: Vec::new(),
                        columns: Vec::new(),
                        row: Vec::new(),
                    };
                    self.topics.insert(channel.id, topic);
                }
            }
            op::MESSAGE => self.message(data).ok_or_else(|| damaged("a message"))??,
            _ => {}
        }
        Ok(())
    }

    fn decoder(&self, channel: &Channel) -> Decoder {
        let schema = self.schemas.get(&channel.schema);
        let schema_encoding = schema.map_or("", |(_, encoding, _)| encoding.as_str());
        let found = match schema {
            Some((name, ..)) => {
                format!("messages in {} with the schema {name} ({schema_encoding})", channel.encoding)
            }
            None => format!("messages in {} without a schema", channel.encoding),
        };
        let none = |advice: &str| Decoder::None(format!("{found}; {advice}"));
        match (channel.encoding.as_str(), schema_encoding) {
            ("json", _) => Decoder::Json(json::Topic::default()),
            ("cdr", "ros2msg") => {
                let (name, text) = schema.map_or(("", &[][..]), |(name, _, text)| (name, text));
                match ros2::Message::parse(name, &String::from_utf8_lossy(text)) {
                    Ok(message) => Decoder::Ros2(message),
                    Err(problem) => Decoder::None(format!("{found}: {problem}")),
                }
            }
            ("cdr", _) => none(
                "CDR is read with definitions as ros2msg: record again in ROS 2 Humble or later, or write the topic as CSV with PlotJuggler",
            ),
            ("ros1", _) => {
                none("convert the file to ROS 2 with rosbags-convert, or write the topic as CSV with PlotJuggler")
            }
            ("protobuf", _) => {
                none("write the topic as JSON (Python: mcap-protobuf-support) or as CSV with PlotJuggler")
            }
            _ => none("expected json, or cdr with ros2msg; write the topic as one of these, or as CSV"),
        }
    }

    /// `None` for a message that is shorter than its head, or of no channel.
    fn message(&mut self, data: &[u8]) -> Option<Result<(), ForeignError>> {
        let mut bytes = Bytes(data);
        let (channel, _sequence, log_time, _publish_time) = (bytes.u16()?, bytes.u32()?, bytes.u64()?, bytes.u64()?);
        let topic = self.topics.get_mut(&channel)?;
        let first = self.first_log_time.get_or_insert(log_time);
        *first = log_time.min(*first);
        let before = topic.n_cells();
        Some(topic.take(log_time, bytes.0).and_then(|()| {
            self.n_cells += topic.n_cells() - before;
            if self.n_cells > MAX_CELLS {
                let problem = format!(
                    "the topics have more than {MAX_CELLS} numbers; write fewer topics to a file (`mcap filter`)"
                );
                return Err(ForeignError(problem));
            }
            Ok(())
        }))
    }

    fn finish(self, mut notes: Vec<String>) -> Result<Contents, ForeignError> {
        if self.topics.is_empty() {
            notes.insert(0, "the file has no topics".to_owned());
        }
        let origin = i128::from(self.first_log_time.unwrap_or(0));
        let mut parts: Vec<Part> = Vec::new();
        for (id, mut topic) in self.topics {
            if parts.iter().any(|part| part.name == topic.name) {
                topic.name = format!("{} (channel {id})", topic.name);
            }
            if let Some(part) = topic.part(origin, &mut notes) {
                parts.push(part);
            }
        }
        if parts.is_empty() {
            return Err(ForeignError(format!("no topic of this MCAP file can be read: {}", notes.join("; "))));
        }
        Ok(Contents { parts, notes, left_out: Vec::new() })
    }
}

impl Topic {
    fn n_cells(&self) -> usize {
        self.log_times.len() * (1 + self.columns.len())
    }

    fn take(&mut self, log_time: u64, data: &[u8]) -> Result<(), ForeignError> {
        let names = match &mut self.decoder {
            Decoder::None(_) => {
                self.log_times.push(log_time);
                return Ok(());
            }
            Decoder::Json(topic) => topic.decode(data, &mut self.row).map(|()| topic.columns.len()),
            Decoder::Ros2(message) => {
                self.row.resize(message.columns.len(), f64::NAN);
                message.decode(data, &mut self.row).map(|()| message.columns.len())
            }
        };
        let n_columns = names.map_err(|problem| {
            let n = self.log_times.len() + 1;
            ForeignError(format!("topic {}, message {n} (log time {log_time} ns): {problem}", self.name))
        })?;
        // A column that appears late has no number before.
        let before = self.log_times.len();
        self.columns.resize_with(n_columns, || vec![f64::NAN; before]);
        for (column, value) in self.columns.iter_mut().zip(&self.row) {
            column.push(*value);
        }
        self.log_times.push(log_time);
        Ok(())
    }

    fn part(self, origin: i128, notes: &mut Vec<String>) -> Option<Part> {
        let (names, skipped, is_kept): (Vec<String>, Vec<String>, Vec<bool>) = match self.decoder {
            Decoder::None(why) => {
                let n = self.log_times.len();
                let messages = if n == 1 { "message" } else { "messages" };
                notes.push(format!("topic {} is not read ({n} {messages}): {why}", self.name));
                return None;
            }
            Decoder::Json(topic) => {
                let is_kept = topic.columns.iter().map(|name| topic.is_kept(name)).collect();
                let skipped = topic.skipped.iter().map(|(path, what)| format!("{path} ({what})")).collect();
                (topic.columns, skipped, is_kept)
            }
            Decoder::Ros2(message) => {
                let is_kept = vec![true; message.columns.len()];
                (message.columns, message.skipped, is_kept)
            }
        };
        if self.log_times.is_empty() {
            notes.push(format!("topic {} has no messages", self.name));
            return None;
        }
        let time = Time::of(&names, &self.columns, &self.log_times);
        let mut columns = vec![number("time", "s", time.seconds(origin))];
        for (i, (name, values)) in names.iter().zip(self.columns).enumerate() {
            if time.is_part(i) || !is_kept.get(i).copied().unwrap_or(true) {
                continue;
            }
            let n_missing = values.iter().filter(|value| value.is_nan()).count();
            if n_missing > 0 {
                notes.push(format!(
                    "topic {}: {name} is missing or not a number in {n_missing} of {} messages",
                    self.name,
                    values.len()
                ));
            }
            columns.push(number(name, "", values));
        }
        if !skipped.is_empty() {
            notes.push(format!("topic {}: not read: {}", self.name, skipped.join(", ")));
        }
        if columns.len() == 1 {
            notes.push(format!("topic {} has no numbers", self.name));
            return None;
        }
        notes.push(format!("topic {}: time is {}", self.name, time.describe(origin)));
        Some(Part { name: self.name, columns })
    }
}

fn number(name: &str, unit: &str, values: Vec<f64>) -> Column {
    Column { name: name.to_owned(), unit: unit.to_owned(), cells: Cells::Numbers(values) }
}

/// The times of a topic, ns.
struct Time {
    /// Columns of `header.stamp`, where that is the time.
    stamp: Option<[usize; 2]>,
    ns: Vec<i128>,
}

impl Time {
    fn of(names: &[String], columns: &[Vec<f64>], log_times: &[u64]) -> Self {
        let place = |of: &[&str]| names.iter().position(|name| of.contains(&name.as_str()));
        let stamp = place(&["header.stamp.sec", "header.stamp.secs"]).zip(place(&[
            "header.stamp.nanosec",
            "header.stamp.nsec",
            "header.stamp.nsecs",
        ]));
        if let Some((sec, nanosec)) = stamp
            && let (Some(seconds), Some(nanoseconds)) = (columns.get(sec), columns.get(nanosec))
        {
            let ns = seconds
                .iter()
                .zip(nanoseconds)
                .map(|(s, ns)| (s.is_finite() && ns.is_finite()).then(|| NS_PER_S * *s as i128 + *ns as i128));
            // A stamp of zero was never set.
            let ns: Option<Vec<i128>> = ns.map(|ns| ns.filter(|ns| *ns != 0)).collect();
            if let Some(ns) = ns {
                return Self { stamp: Some([sec, nanosec]), ns };
            }
        }
        Self { stamp: None, ns: log_times.iter().map(|ns| i128::from(*ns)).collect() }
    }

    fn is_part(&self, column: usize) -> bool {
        self.stamp.is_some_and(|stamp| stamp.contains(&column))
    }

    fn is_of_other_clock(&self, origin: i128) -> bool {
        self.ns.first().is_some_and(|first| (first - origin).abs() > OTHER_CLOCK_NS)
    }

    fn seconds(&self, origin: i128) -> Vec<f64> {
        let own = self.ns.first().copied().unwrap_or(0);
        let origin = if self.is_of_other_clock(origin) { own } else { origin };
        self.ns.iter().map(|ns| (ns - origin) as f64 / NS_PER_S as f64).collect()
    }

    fn describe(&self, origin: i128) -> &'static str {
        match (self.stamp, self.is_of_other_clock(origin)) {
            (None, _) => "the log time",
            (Some(_), false) => "header.stamp",
            (Some(_), true) => "header.stamp, from the topic's first on: its clock is not that of the log",
        }
    }
}

struct Channel {
    id: u16,
    schema: u16,
    topic: String,
    encoding: String,
}

impl Channel {
    fn parse(data: &[u8]) -> Option<Self> {
        let mut bytes = Bytes(data);
        Some(Self { id: bytes.u16()?, schema: bytes.u16()?, topic: bytes.text()?, encoding: bytes.text()? })
    }
}

fn schema(data: &[u8]) -> Option<(u16, (String, String, Vec<u8>))> {
    let mut bytes = Bytes(data);
    let (id, name, encoding) = (bytes.u16()?, bytes.text()?, bytes.text()?);
    let length = bytes.u32()? as usize;
    Some((id, (name, encoding, bytes.take(length)?.to_vec())))
}

/// Bytes of a record that are still to be read.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, n: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(n)?;
        self.0 = rest;
        Some(taken)
    }

    fn u16(&mut self) -> Option<u16> {
        Some(u16::from_le_bytes(*self.take(2)?.first_chunk()?))
    }

    fn u32(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(*self.take(4)?.first_chunk()?))
    }

    fn u64(&mut self) -> Option<u64> {
        Some(u64::from_le_bytes(*self.take(8)?.first_chunk()?))
    }

    fn text(&mut self) -> Option<String> {
        let length = self.u32()? as usize;
        Some(String::from_utf8_lossy(self.take(length)?).into_owned())
    }
}
