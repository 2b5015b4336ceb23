//! Reading a run, whole or in bounded memory, however much of its file there is.
//!
//! A file that was cut off (power, `kill -9`, a full disk) gives every tick of its whole chunks, a gap that says what is
//! missing, and the status `interrupted`. A damaged chunk is passed over and reported as a gap with its byte, or refused
//! ([`RunReader::refuse_damage`]). A tick is taken only when every topic has its message of it.
//!
//! **Whether it is the log.** Where the sidecar has the log's SHA-256 the whole file is summed before anything in it is read: one pass
//! more over the file. All checksums that the file has itself (chunks, data, summary) are checked against it
//! besides. What does not fit is in [`RunReader::doubts`].

use std::fs::{File, TryLockError};
use std::io::{BufReader, Read, Seek};
use std::path::{Path, PathBuf};

use indexmap::IndexMap;
use mcap::records::op;

use crate::error::{Place, RecordError, reason};
use crate::hash::Fingerprint;
use crate::run::allowance::{Allowance, holds};
use crate::run::channel::{BOARD, LOG, Meaning};
use crate::run::doubt::{Doubt, DoubtKind};
use crate::run::file::{End, FileChannel, Message, Step, Summary, Walk, metadata, records, schema, unpack};
use crate::run::layout::{Decoder, Kind, PREFIX_KEY, text};
use crate::run::log::{Channel, Event, EventKind, Gap, GapCause, RunLog};
use crate::run::meta::{RunMeta, RunStatus};
use crate::run::seal::{contradiction, difference};
use crate::run::sidecar::{END_RECORD_NAME, RECORD_NAME, differing, of_record, read_run_meta};
use crate::text::counted;

/// Most channels of one run.
const MOST_CHANNELS: usize = 10_000;

/// A part of a run: a chunk's ticks, with what happened and what is missing in it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Block {
    /// Time of each tick, s.
    pub time_s: Vec<f64>,
    /// A column per channel of [`RunReader::channels`].
    pub columns: Vec<Vec<f64>>,
    /// What happened.
    pub events: Vec<Event>,
    /// What is missing, up to the first tick of the next block.
    pub lost: Vec<Gap>,
}

/// A run being read, a chunk at a time.
pub struct RunReader<R> {
    path: PathBuf,
    walk: Walk<R>,
    meta: RunMeta,
    has_sidecar: bool,
    is_being_recorded: bool,
    /// The sidecar says that the run has no end yet.
    is_unfinished: bool,
    refuses_damage: bool,
    has_ended: bool,
    schemas: IndexMap<u16, String>,
    topics: Vec<ReadTopic>,
    /// Place in `topics` by channel of the file.
    topic_of_channel: Vec<Option<usize>>,
    events_channel: Option<u16>,
    channels: Vec<(String, String)>,
    unpacked: Vec<u8>,
    allowance: Allowance,
    rows: Rows,
    /// What the file is, where the sidecar says what it should be.
    found: Option<Fingerprint>,
    /// What is wrong inside the file, the first of it.
    damage: Option<String>,
    doubts: Vec<Doubt>,
}

/// A topic with the fields that are wanted.
struct ReadTopic {
    channel: u16,
    /// Type and offset in the message, and the column.
    fields: Vec<(Kind, usize, usize)>,
    is_filled: bool,
}

/// Ticks being put together.
#[derive(Default)]
struct Rows {
    row: Vec<f64>,
    n_filled: usize,
    sequence: u32,
    last: Option<(u64, f64)>,
    first_log_time: Option<u64>,
    /// Why the next gap is there.
    pending: Option<(GapCause, String)>,
}

/// Reads a whole run into memory.
///
/// # Errors
///
/// See [`RunReader::open`].
pub fn read_run(path: &Path) -> Result<RunLog, RecordError> {
    RunReader::open(path)?.read_all()
}

impl RunReader<BufReader<File>> {
    /// Opens `RUN.mcap`; what `RUN.toml` beside it says goes before what the file says.
    ///
    /// # Errors
    ///
    /// A file that cannot be read or is no MCAP file, a sidecar or metadata that cannot be read. Never an end that is
    /// missing.
    pub fn open(path: &Path) -> Result<Self, RecordError> {
        let failed = |e: std::io::Error| RecordError::Read { path: path.to_owned(), reason: reason(&e) };
        let file = File::open(path).map_err(failed)?;
        if file.metadata().map_err(failed)?.is_dir() {
            return Err(RecordError::Read { path: path.to_owned(), reason: "it is a folder".to_owned() });
        }
        let is_being_recorded = match file.try_lock_shared() {
            Err(TryLockError::WouldBlock) => true,
            Ok(()) => file.unlock().is_err(),
            Err(TryLockError::Error(_)) => false,
        };
        let sidecar = path.with_extension("toml");
        let meta = sidecar.exists().then(|| read_run_meta(&sidecar)).transpose()?;
        let mut reader = Self::new(path, BufReader::with_capacity(1 << 18, file), meta)?;
        reader.is_being_recorded = is_being_recorded;
        Ok(reader)
    }
}

impl<R: Read + Seek> RunReader<R> {
    /// The same from any bytes; `path` is for messages, `meta` what a sidecar says.
    ///
    /// # Errors
    ///
    /// As [`RunReader::open`].
    pub fn new(path: &Path, input: R, meta: Option<RunMeta>) -> Result<Self, RecordError> {
        let failed = |e: std::io::Error| RecordError::Read { path: path.to_owned(), reason: reason(&e) };
        let walk = Walk::new(input).map_err(failed)?.ok_or_else(|| RecordError::Syntax {
            place: Place::byte(path, 0),
            problem: "the file does not begin as MCAP does; runs are MCAP files that `froude run` records".to_owned(),
        })?;
        let id = || path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let is_unfinished = meta.as_ref().is_some_and(|meta| meta.status == RunStatus::Running);
        let mut reader = Self {
            path: path.to_owned(),
            allowance: Allowance::of(walk.length()),
            walk,
            has_sidecar: meta.is_some(),
            meta: meta.unwrap_or_else(|| RunMeta { id: id(), ..RunMeta::default() }),
            is_being_recorded: false,
            is_unfinished,
            refuses_damage: false,
            has_ended: false,
            schemas: IndexMap::new(),
            topics: Vec::new(),
            topic_of_channel: Vec::new(),
            events_channel: None,
            channels: Vec::new(),
            unpacked: Vec::new(),
            rows: Rows::default(),
            found: None,
            damage: None,
            doubts: Vec::new(),
        };
        if reader.meta.log.is_some() {
            reader.found = Some(reader.walk.fingerprint().map_err(failed)?);
        }
        reader.find_channels()?;
        Ok(reader)
    }

    /// Faults of the log as a whole; settled when the last block has been read.
    #[must_use]
    pub fn doubts(&self) -> &[Doubt] {
        &self.doubts
    }

    /// A damaged chunk is an error that names its byte, not a gap.
    #[must_use]
    pub fn refuse_damage(mut self) -> Self {
        self.refuses_damage = true;
        self
    }

    /// Only these channels, in the order of the file: others cost neither time nor memory.
    ///
    /// # Errors
    ///
    /// A name that the run does not have, with the nearest.
    pub fn select(mut self, names: &[&str]) -> Result<Self, RecordError> {
        for name in names {
            if !self.channels.iter().any(|(own, _)| own == name) {
                return Err(RecordError::UnknownColumn {
                    place: Place::whole(&self.path),
                    column: (*name).to_owned(),
                    advice: crate::nearest::suggestion(name, self.channels.iter().map(|(own, _)| own.as_str())),
                });
            }
        }
        let mut kept = 0;
        let place: Vec<Option<usize>> =
            self.channels.iter().map(|(name, _)| names.contains(&name.as_str()).then(|| (kept, kept += 1).0)).collect();
        for topic in &mut self.topics {
            topic.fields.retain_mut(|field| place[field.2].map(|column| field.2 = column).is_some());
        }
        self.topics.retain(|topic| !topic.fields.is_empty());
        self.channels.retain(|(name, _)| names.contains(&name.as_str()));
        self.index_topics();
        Ok(self)
    }

    /// Name and unit of each column.
    #[must_use]
    pub fn channels(&self) -> &[(String, String)] {
        &self.channels
    }

    /// What is known about the run; its status is settled when the last block has been read.
    #[must_use]
    pub fn meta(&self) -> &RunMeta {
        &self.meta
    }

    /// The next chunk's ticks into `block`, whose memory is used again; `false` at the end, when `block` may still hold a
    /// last gap.
    ///
    /// # Errors
    ///
    /// The disk fails, metadata of a newer version, or damage that is refused.
    pub fn read_block(&mut self, block: &mut Block) -> Result<bool, RecordError> {
        block.time_s.clear();
        block.events.clear();
        block.lost.clear();
        block.columns.resize(self.channels.len(), Vec::new());
        block.columns.iter_mut().for_each(Vec::clear);
        while !self.has_ended {
            let step = self.walk.next().map_err(|e| self.failed(&e))?;
            match step {
                Step::Record { opcode, offset } => self.take(opcode, offset, block)?,
                Step::End(end) => self.end(end, block)?,
            }
            if !(block.time_s.is_empty() && block.events.is_empty()) {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The whole run into memory.
    ///
    /// # Errors
    ///
    /// As [`RunReader::read_block`].
    pub fn read_all(mut self) -> Result<RunLog, RecordError> {
        let mut log = RunLog { path: self.path.clone(), ..RunLog::default() };
        let mut columns = vec![Vec::new(); self.channels.len()];
        let mut block = Block::default();
        loop {
            let goes_on = self.read_block(&mut block)?;
            holds(&self.path, log.time_s.len() + block.time_s.len(), self.channels.len())?;
            log.time_s.append(&mut block.time_s);
            log.events.append(&mut block.events);
            log.lost.append(&mut block.lost);
            columns.iter_mut().zip(&mut block.columns).for_each(|(all, part)| all.append(part));
            if !goes_on {
                break;
            }
        }
        let clock = if self.meta.method.is_empty() { LOG } else { BOARD };
        log.channels = self
            .channels
            .into_iter()
            .zip(columns)
            .map(|((name, unit), values)| {
                let declared = self.meta.channels.get(&name).cloned();
                (
                    name.clone(),
                    Channel { meaning: declared.unwrap_or_else(|| Meaning::of(&name, &unit, clock)), values },
                )
            })
            .collect();
        // Logs of earlier versions say nothing of their channels.
        for (name, channel) in &log.channels {
            self.meta.channels.entry(name.clone()).or_insert_with(|| channel.meaning.clone());
        }
        // An event may be recorded behind ticks that are later than it.
        log.events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        log.meta = self.meta;
        log.doubts = self.doubts;
        Ok(log)
    }

    /// What is declared of a channel has the unit that the log has.
    fn check_units(&self) -> Result<(), RecordError> {
        let declared = |name: &String| self.meta.channels.get(name).map(|meaning| &meaning.unit);
        let mut both = self.channels.iter().filter_map(|(name, unit)| Some((name, unit, declared(name)?)));
        let Some((name, unit, declared)) = both.find(|(_, unit, declared)| unit != declared) else { return Ok(()) };
        let path = if self.has_sidecar { self.path.with_extension("toml") } else { self.path.clone() };
        Err(RecordError::Value {
            place: Place::whole(&path),
            key: format!("channels.{name:?}.unit"),
            problem: format!("is {declared:?}; expected {unit:?}, in which {} was recorded", self.path.display()),
        })
    }

    fn doubt(&mut self, kind: DoubtKind, problem: &str) {
        self.doubts.push(Doubt { kind, text: format!("{} {problem}", self.path.display()) });
    }

    /// A run has the name of its files; one that was set aside has a word more.
    fn check_name(&mut self) {
        let stem = self.path.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
        let rest = stem.strip_prefix(&self.meta.id).map(|rest| rest.is_empty() || rest.starts_with('.'));
        if rest != Some(true) {
            let text = format!("is the log of run {}: the file was copied or renamed", self.meta.id);
            self.doubt(DoubtKind::Renamed, &text);
        }
    }

    /// At the end of the file: whether it is the one that the sidecar was written for.
    fn settle(&mut self) {
        self.check_name();
        let sidecar = self.path.with_extension("toml");
        let sidecar = sidecar.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        let is_exchanged = self.doubts.iter().any(|doubt| doubt.kind == DoubtKind::Exchanged);
        let damage = self.damage.take().or_else(|| {
            let is_cut = self.meta.log.as_ref().zip(self.found.as_ref()).is_some_and(|(a, b)| b.bytes < a.bytes);
            is_cut.then(String::new)
        });
        match (&self.meta.log, &self.found) {
            (Some(recorded), Some(found)) => match (difference(recorded, found), damage) {
                (None, _) => {}
                // What it is instead is said already.
                (Some(_), _) if is_exchanged => {}
                (Some(what), Some(_)) => {
                    self.doubt(DoubtKind::Damaged, &format!("{what}; copy it again from where it was recorded"));
                }
                (Some(_), None) => self.doubt(
                    DoubtKind::Exchanged,
                    &format!(
                        "is a whole log, and not the one that {sidecar} was written for (its SHA-256 is another): they come from two drives; \
                         put the files that belong together side by side"
                    ),
                ),
            },
            _ => {
                if let Some(problem) = damage {
                    self.doubt(DoubtKind::Damaged, &format!("is damaged: {problem}; copy it again from where it was recorded"));
                }
                if !self.has_sidecar {
                    let text = format!("has no sidecar {sidecar}: only the log's own checksums vouch for it");
                    self.doubt(DoubtKind::NoSidecar, &text);
                } else if !self.is_unfinished {
                    let text = format!(
                        "is not compared with anything: {sidecar} has no SHA-256 of it, as runs of earlier versions; only the log's own \
                         checksums vouch for it"
                    );
                    self.doubt(DoubtKind::NoFingerprint, &text);
                }
            }
        }
    }

    fn failed(&self, error: &std::io::Error) -> RecordError {
        RecordError::Read { path: self.path.clone(), reason: reason(error) }
    }

    /// Schemas and channels: from the summary of a whole file, else from the beginning up to the first chunk with any.
    fn find_channels(&mut self) -> Result<(), RecordError> {
        let summary = self.walk.go_to_summary().map_err(|e| self.failed(&e))?;
        if let Summary::Damaged(problem) = summary {
            self.damage.get_or_insert(problem);
        } else if summary == Summary::None && self.meta.log.is_some() {
            // A log that was finished has one.
            self.damage.get_or_insert_with(|| "its end cannot be found".to_owned());
        } else if summary == Summary::Here {
            while let Some(opcode) = self.walk.next_of_summary().map_err(|e| self.failed(&e))? {
                let body = std::mem::take(&mut self.walk.body);
                self.declare(opcode, &body);
                self.walk.body = body;
            }
        }
        self.walk.rewind().map_err(|e| self.failed(&e))?;
        while self.topics.is_empty() {
            let Step::Record { opcode, offset } = self.walk.next().map_err(|e| self.failed(&e))? else { break };
            let body = std::mem::take(&mut self.walk.body);
            match opcode {
                op::CHUNK => {
                    let mut unpacked = std::mem::take(&mut self.unpacked);
                    for (opcode, body) in unpack(&body, &mut unpacked).iter().flat_map(|c| records(c)).flatten() {
                        self.declare(opcode, body);
                    }
                    self.unpacked = unpacked;
                    self.allowance.take(&self.path, self.unpacked.len())?;
                }
                op::METADATA => self.take_metadata(offset, &body)?,
                _ => self.declare(opcode, &body),
            }
            self.walk.body = body;
        }
        self.walk.rewind().map_err(|e| self.failed(&e))?;
        self.allowance = Allowance::of(self.walk.length());
        self.index_topics();
        Ok(())
    }

    fn index_topics(&mut self) {
        self.topic_of_channel.clear();
        for (i, topic) in self.topics.iter().enumerate() {
            let channel = usize::from(topic.channel);
            if self.topic_of_channel.len() <= channel {
                self.topic_of_channel.resize(channel + 1, None);
            }
            self.topic_of_channel[channel] = Some(i);
        }
        self.rows.row = vec![0.0; self.channels.len()];
    }

    /// Takes a schema or a channel; what is not a flat message of numbers, or no log of events, is left alone.
    fn declare(&mut self, opcode: u8, body: &[u8]) {
        match opcode {
            op::SCHEMA => {
                if let Some((id, "ros2msg", text)) = schema(body) {
                    self.schemas.insert(id, String::from_utf8_lossy(text).into_owned());
                }
            }
            op::CHANNEL => {
                if let Some(channel) = FileChannel::parse(body).filter(|channel| channel.encoding == "cdr") {
                    self.declare_channel(&channel);
                }
            }
            _ => {}
        }
    }

    fn declare_channel(&mut self, channel: &FileChannel<'_>) {
        let Some(schema) = self.schemas.get(&channel.schema) else { return };
        if channel.topic == text::TOPIC && schema == text::SCHEMA {
            self.events_channel = Some(channel.id);
            return;
        }
        let is_known = self.topics.iter().any(|topic| topic.channel == channel.id);
        let Some(decoder) = Decoder::parse(schema).filter(|_| !is_known) else { return };
        let prefix = channel.metadata.get(PREFIX_KEY).cloned();
        let prefix = prefix.unwrap_or_else(|| format!("{}/", channel.topic.trim_matches('/')));
        let mut fields = Vec::new();
        for (field, kind, offset) in decoder.fields {
            let name = format!("{prefix}{field}");
            let is_taken = self.channels.iter().any(|(own, _)| *own == name);
            if is_taken || self.channels.len() == MOST_CHANNELS {
                continue;
            }
            let unit = channel.metadata.get(&field).cloned().unwrap_or_else(|| "1".to_owned());
            fields.push((kind, offset, self.channels.len()));
            self.channels.push((name, unit));
        }
        if !fields.is_empty() {
            self.topics.push(ReadTopic { channel: channel.id, fields, is_filled: false });
        }
    }

    fn take(&mut self, opcode: u8, offset: u64, block: &mut Block) -> Result<(), RecordError> {
        let body = std::mem::take(&mut self.walk.body);
        let taken = match opcode {
            op::CHUNK => self.take_chunk(offset, &body, block),
            op::METADATA => self.take_metadata(offset, &body),
            op::MESSAGE => {
                self.take_message(&body, block);
                Ok(())
            }
            _ => Ok(()),
        };
        self.walk.body = body;
        taken
    }

    fn take_metadata(&mut self, offset: u64, body: &[u8]) -> Result<(), RecordError> {
        let Some((name, entries)) = metadata(body) else {
            return self.damaged(offset, "the metadata there does not fit into its record".to_owned());
        };
        if ![RECORD_NAME, END_RECORD_NAME].contains(&name) {
            return Ok(());
        }
        let own = match of_record(&self.path, &entries) {
            Ok(own) => own,
            Err(error @ RecordError::NewerSchema { .. }) => return Err(error),
            Err(error) => {
                let problem = match error {
                    RecordError::Checksum { .. } => "it was changed".to_owned(),
                    other => other.to_string(),
                };
                let problem = format!("what is said of the run at byte {offset} cannot be read: {problem}");
                if self.refuses_damage {
                    return self.damaged(offset, problem);
                }
                self.damage.get_or_insert(problem);
                return Ok(());
            }
        };
        let is_end = name == END_RECORD_NAME;
        if !self.has_sidecar {
            self.meta = own;
            return Ok(());
        }
        let is_known = self.doubts.iter().any(|doubt| matches!(doubt.kind, DoubtKind::Exchanged | DoubtKind::Edited));
        if let Some(problem) = contradiction(&own, &self.meta).filter(|_| !is_known) {
            self.doubt(DoubtKind::Exchanged, &problem);
        } else if is_end && !self.is_unfinished && !is_known {
            let keys = differing(&own, &self.meta);
            if !keys.is_empty() {
                let text =
                    format!("has a sidecar that was edited: it gives other values of {} than the log", keys.join(", "));
                self.doubt(DoubtKind::Edited, &text);
            }
        }
        if self.meta.status == RunStatus::Running {
            // The file was ended and the sidecar was not.
            self.meta.status = own.status;
        }
        Ok(())
    }

    fn take_chunk(&mut self, offset: u64, body: &[u8], block: &mut Block) -> Result<(), RecordError> {
        let mut unpacked = std::mem::take(&mut self.unpacked);
        let mut problem = None;
        match unpack(body, &mut unpacked) {
            Ok(content) => {
                for record in records(content) {
                    match record {
                        Ok((op::MESSAGE, body)) => self.take_message(body, block),
                        Ok(_) => {}
                        Err(()) => problem = Some("its records do not fit into it".to_owned()),
                    }
                }
            }
            Err(error) => problem = Some(error),
        }
        self.unpacked = unpacked;
        self.allowance.take(&self.path, self.unpacked.len())?;
        problem
            .map_or(Ok(()), |problem| self.damaged(offset, format!("the chunk at byte {offset} is damaged: {problem}")))
    }

    fn damaged(&mut self, offset: u64, problem: String) -> Result<(), RecordError> {
        if self.refuses_damage {
            return Err(RecordError::Syntax {
                place: Place::byte(&self.path, offset),
                problem: format!("{problem}; copy the file again, or read it without what is damaged"),
            });
        }
        self.damage.get_or_insert_with(|| problem.clone());
        self.rows.pending.get_or_insert((GapCause::Damaged, problem));
        Ok(())
    }

    fn take_message(&mut self, body: &[u8], block: &mut Block) {
        let Some(message) = Message::parse(body) else { return };
        if Some(message.channel) == self.events_channel {
            if let Some((kind, text)) = text::decode(message.data) {
                let time_s = self.seconds(message.log_time);
                block.events.push(Event { time_s, kind: EventKind::of_name(&kind), text });
            }
            return;
        }
        let Some(topic) = self.topic_of_channel.get(usize::from(message.channel)).copied().flatten() else { return };
        if self.rows.n_filled > 0 && message.sequence != self.rows.sequence {
            // The last tick never became whole; the jump of the ticks tells it.
            self.topics.iter_mut().for_each(|topic| topic.is_filled = false);
            self.rows.n_filled = 0;
        }
        self.rows.sequence = message.sequence;
        let topic = &mut self.topics[topic];
        for (kind, offset, column) in &topic.fields {
            let Some(value) = Decoder::field(message.data, *kind, *offset) else { return };
            self.rows.row[*column] = value;
        }
        if !std::mem::replace(&mut topic.is_filled, true) {
            self.rows.n_filled += 1;
        }
        if self.rows.n_filled == self.topics.len() {
            self.topics.iter_mut().for_each(|topic| topic.is_filled = false);
            self.rows.n_filled = 0;
            self.take_row(&message, block);
        }
    }

    /// Run time of a time in the file.
    fn seconds(&mut self, log_time: u64) -> f64 {
        let start = match self.meta.start_unix_ns {
            0 if self.meta.log_rate_hz <= 0.0 => *self.rows.first_log_time.get_or_insert(log_time),
            start => start,
        };
        // Two parts: a difference of 64 bits would be rounded to microseconds.
        let ns = i128::from(log_time) - i128::from(start);
        (ns / 1_000_000_000) as f64 + (ns % 1_000_000_000) as f64 / 1e9
    }

    /// A tick that is whole: its number, its time, and what is missing before it.
    fn take_row(&mut self, message: &Message<'_>, block: &mut Block) {
        let seconds = self.seconds(message.log_time);
        let rate = self.meta.log_rate_hz;
        let (tick, time_s) = if rate > 0.0 {
            let tick = unwrap(message.sequence, seconds * rate);
            (tick, tick as f64 / rate)
        } else {
            (u64::from(message.sequence), seconds)
        };
        let rows = &mut self.rows;
        if let Some(column) = rows.row.iter().position(|v| !v.is_finite()) {
            let (name, value) = (&self.channels[column].0, rows.row[column]);
            rows.pending.get_or_insert((GapCause::NotFinite, format!("{name} is {value} in tick {tick}")));
            return;
        }
        if let Some((last, last_s)) = rows.last
            && (time_s <= last_s || (rate > 0.0 && tick <= last))
        {
            let problem = format!("tick {tick} comes after tick {last}");
            rows.pending.get_or_insert((GapCause::Damaged, problem));
            return;
        }
        let missing = match rows.last {
            Some((last, _)) if rate > 0.0 => Some(tick - last - 1),
            _ => None,
        };
        if rows.pending.is_some() || missing.is_some_and(|n| n > 0) {
            let never = || (GapCause::Link, "they never reached the recorder".to_owned());
            let (cause, why) = rows.pending.take().unwrap_or_else(never);
            let count = missing.map_or_else(
                || "an unknown number of ticks is".to_owned(),
                |n| counted(n as usize, "tick is", "ticks are"),
            );
            let from_s = rows.last.map(|(_, s)| s);
            let text = format!("{count} missing before {time_s} s: {why}");
            block.lost.push(Gap { from_s, to_s: Some(time_s), ticks: missing, cause, text });
        }
        rows.last = Some((tick, time_s));
        block.time_s.push(time_s);
        block.columns.iter_mut().zip(&rows.row).for_each(|(column, value)| column.push(*value));
    }

    /// The end of the file: what is missing there, and what became of the run.
    fn end(&mut self, end: End, block: &mut Block) -> Result<(), RecordError> {
        self.has_ended = true;
        let from_s = self.rows.last.map(|(_, s)| s);
        if let Some((cause, why)) = self.rows.pending.take() {
            let text = format!("the last ticks before the end are missing: {why}");
            block.lost.push(Gap { from_s, to_s: None, ticks: None, cause, text });
        }
        let unfinished = |status| match status {
            RunStatus::Running | RunStatus::Complete => RunStatus::Interrupted,
            other => other,
        };
        match end {
            End::Whole if self.meta.status == RunStatus::Running => self.meta.status = RunStatus::Interrupted,
            End::Whole => {}
            End::Changed { problem } => {
                if self.meta.status == RunStatus::Running {
                    self.meta.status = RunStatus::Interrupted;
                }
                if self.refuses_damage {
                    return self.damaged(0, problem);
                }
                self.damage.get_or_insert(problem);
            }
            End::CutOff { .. } if self.is_being_recorded => self.meta.status = RunStatus::Running,
            End::CutOff { offset, lost } => {
                self.meta.status = unfinished(self.meta.status);
                let text = format!(
                    "the file ends at byte {} without its end mark: what was recorded after {} is lost, {}",
                    offset + lost,
                    from_s.map_or_else(|| "the start".to_owned(), |s| format!("{s} s")),
                    if lost == 0 {
                        "no byte of it came to the file".to_owned()
                    } else {
                        format!("{lost} bytes of it, from byte {offset} on, are not a whole chunk")
                    }
                );
                if !self.is_unfinished {
                    self.damage.get_or_insert_with(|| text.clone());
                }
                block.lost.push(Gap { from_s, to_s: None, ticks: None, cause: GapCause::CutOff, text });
            }
            End::Broken { offset, lost, problem } => {
                self.meta.status = unfinished(self.meta.status);
                let problem = format!("{problem}; the {lost} bytes from byte {offset} on cannot be read");
                if self.refuses_damage {
                    return self.damaged(offset, problem);
                }
                self.damage.get_or_insert_with(|| problem.clone());
                block.lost.push(Gap { from_s, to_s: None, ticks: None, cause: GapCause::Damaged, text: problem });
            }
        }
        if self.damage.is_none() {
            self.check_units()?;
        }
        self.settle();
        Ok(())
    }
}

/// What a log states about itself at its beginning; `None` where that cannot be read.
pub(crate) fn head_of(path: &Path) -> Result<Option<RunMeta>, RecordError> {
    let failed = |e: std::io::Error| RecordError::Read { path: path.to_owned(), reason: reason(&e) };
    let Some(mut walk) = Walk::new(BufReader::new(File::open(path).map_err(failed)?)).map_err(failed)? else {
        return Ok(None);
    };
    while let Step::Record { opcode: op::METADATA, .. } = walk.next().map_err(failed)? {
        if let Some((RECORD_NAME, entries)) = metadata(&walk.body) {
            return Ok(of_record(path, &entries).ok());
        }
    }
    Ok(None)
}

/// The tick with these lowest 32 bits that is nearest to `expected`.
fn unwrap(sequence: u32, expected: f64) -> u64 {
    let expected = expected.clamp(0.0, 9e15) as u64;
    let low = expected as u32;
    let ahead = sequence.wrapping_sub(low) as i32;
    expected.saturating_add_signed(i64::from(ahead))
}
