//! Reading a run, whole or in bounded memory, however much of its file there is.
//!
//! A file that was cut off (power, `kill -9`, a full disk) gives every tick of its whole chunks, a gap that says what is
//! missing, and the status `interrupted`. A damaged chunk is passed over and reported as a gap with its byte. A tick is taken only when
//! every topic has its message of it.
//!
//! **Whether it is the log.** Where the sidecar has the log's SHA-256 the whole file is summed before anything in it is read: one pass
//! more over the file. All checksums that the file has itself (chunks, data, summary) are checked against it
//! besides. What does not fit is in [`RunReader::doubts`].

mod channels;
mod end;
mod ticks;

use std::fs::{File, TryLockError};
use std::io::{BufReader, Read, Seek};
use std::path::{Path, PathBuf};

use indexmap::IndexMap;
use mcap::records::op;

use crate::error::{Place, RecordError, reason};
use crate::hash::Fingerprint;
use crate::nearest::suggestion;
use crate::run::allowance::{Allowance, holds};
use crate::run::channel::{BOARD, LOG, Meaning};
use crate::run::doubt::{Doubt, DoubtKind};
use crate::run::file::{Step, Walk, metadata, records, unpack};
use crate::run::layout::Kind;
use crate::run::log::{Channel, Event, Gap, GapCause, RunLog};
use crate::run::meta::{RunMeta, RunStatus};
use crate::run::seal::contradiction;
use crate::run::sidecar::{END_RECORD_NAME, RECORD_NAME, differing, of_record, read_run_meta};

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
    has_ended: bool,
    schemas: IndexMap<u16, String>,
    topics: Vec<ReadTopic>,
    /// Place in `topics` by channel of the file.
    topic_of_channel: Vec<Option<usize>>,
    events_channel: Option<u16>,
    /// Topics that Froude does not record.
    others: Vec<String>,
    /// Whether anything in the file says that Froude recorded it.
    is_own: bool,
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
        let file = crate::read::open(path)?;
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
        let walk = Walk::new(input).map_err(failed)?.ok_or_else(|| {
            RecordError::syntax(
                Place::byte(path, 0),
                "the file does not begin as MCAP does; runs are MCAP files that `froude run` records",
            )
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
            has_ended: false,
            schemas: IndexMap::new(),
            topics: Vec::new(),
            topic_of_channel: Vec::new(),
            events_channel: None,
            others: Vec::new(),
            is_own: false,
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
        reader.check_own()?;
        Ok(reader)
    }

    /// Faults of the log as a whole; settled when the last block has been read.
    #[must_use]
    pub fn doubts(&self) -> &[Doubt] {
        &self.doubts
    }

    /// Only these channels, in the order of the file: others cost neither time nor memory.
    ///
    /// # Errors
    ///
    /// A name that the run does not have, with the nearest.
    pub fn select(mut self, names: &[&str]) -> Result<Self, RecordError> {
        for name in names {
            if !self.channels.iter().any(|(own, _)| own == name) {
                let near = suggestion(name, self.channels.iter().map(|(own, _)| own.as_str()));
                return Err(RecordError::unknown_column(Place::whole(&self.path), name, near));
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

    fn doubt(&mut self, kind: DoubtKind, problem: &str) {
        self.doubts.push(Doubt { kind, text: format!("{} {problem}", self.path.display()) });
    }

    fn failed(&self, error: &std::io::Error) -> RecordError {
        RecordError::Read { path: self.path.clone(), reason: reason(error) }
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
            self.damaged("the metadata there does not fit into its record".to_owned());
            return Ok(());
        };
        if ![RECORD_NAME, END_RECORD_NAME].contains(&name) {
            return Ok(());
        }
        self.is_own = true;
        let own = match of_record(&self.path, &entries) {
            Ok(own) => own,
            Err(error @ RecordError::NewerSchema { .. }) => return Err(error),
            Err(error) => {
                let problem = match error {
                    RecordError::Checksum { .. } => "it was changed".to_owned(),
                    other => other.to_string(),
                };
                let problem = format!("what is said of the run at byte {offset} cannot be read: {problem}");
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
        if let Some(problem) = problem {
            self.damaged(format!("the chunk at byte {offset} is damaged: {problem}"));
        }
        Ok(())
    }

    fn damaged(&mut self, problem: String) {
        self.damage.get_or_insert_with(|| problem.clone());
        self.rows.pending.get_or_insert((GapCause::Damaged, problem));
    }
}

/// What a log states about itself at its beginning; `None` where that cannot be read.
///
/// # Errors
///
/// A file that cannot be read.
pub fn head_of(path: &Path) -> Result<Option<RunMeta>, RecordError> {
    let failed = |e: std::io::Error| RecordError::Read { path: path.to_owned(), reason: reason(&e) };
    let Some(mut walk) = Walk::new(BufReader::new(crate::read::open(path)?)).map_err(failed)? else {
        return Ok(None);
    };
    while let Step::Record { opcode: op::METADATA, .. } = walk.next().map_err(failed)? {
        if let Some((RECORD_NAME, entries)) = metadata(&walk.body) {
            return Ok(of_record(path, &entries).ok());
        }
    }
    Ok(None)
}
