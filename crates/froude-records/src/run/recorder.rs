//! Recording a run so that no crash takes more of it than its last moments.
//!
//! `ID.mcap` grows by whole chunks; `ID.toml` beside it says what the run is, for people. Two separate claims:
//!
//! | what dies                    | what is kept                                                                          |
//! |------------------------------|---------------------------------------------------------------------------------------|
//! | the program (`kill -9`)      | every tick older than 50 ms of run time: a chunk is handed to the system at least that often |
//! | the machine (power)          | what was there 1 s before, as far as the disk keeps its word: `fsync` twice a second, by a thread of its own |
//!
//! Run time is what the caller's ticks say, simulated or real. A caller whose ticks stop coming calls
//! [`Recorder::advance`], so that the last of them are not kept back.
//!
//! **Time.** A tick costs some microseconds. Now and then one waits for the disk: tens of milliseconds while the system
//! writes back. A caller that must not wait (a serial port without a ring behind it) records in a thread of its own.
//!
//! **Memory.** One chunk (at most 40 ms, or 1 MiB), and the index that viewers want at the end of the file: about 0.3 kB a
//! chunk, 27 MB for an hour.
//!
//! **A full disk** is an error of [`Recorder::record`]. What was torn is cut off again, so the file ends with a whole chunk;
//! the caller stops the carriage (category 1) and calls [`Recorder::finish`].

use std::fs::File;
use std::io::{BufWriter, Seek as _};
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;

use crate::error::{RecordError, reason};
use crate::hash::Sealed;
use crate::run::channel::{BOARD, Meaning};
use crate::run::layout::{ChannelSpec, Layout, text};
use crate::run::log::EventKind;
use crate::run::meta::{RunMeta, RunStatus};
use crate::run::sidecar::{END_RECORD_NAME, RECORD_NAME, to_record, write_run_meta};
use crate::run::sync::Syncer;

type Writer = mcap::Writer<NoSeek<BufWriter<Sealed<File>>>>;

/// Run time after which a chunk is handed to the system: 10 ms before the 50 ms that are claimed.
const CHUNK_NS: u64 = 40_000_000;

/// A chunk that is larger is handed over earlier.
const LARGEST_CHUNK: u64 = 1 << 20;

/// How chunks are packed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Packing {
    /// Not at all.
    None,
    /// LZ4: half the size for hardly any time.
    #[default]
    Lz4,
    /// Zstandard: smaller, for more time.
    Zstd,
}

/// A run being recorded.
pub struct Recorder {
    path: PathBuf,
    meta: RunMeta,
    layout: Layout,
    /// Channel of the file by topic, in the order of the layout.
    topics: Vec<u16>,
    events: u16,
    /// `None` after a failure.
    writer: Option<Writer>,
    /// A second handle of the same file: for cutting off what was torn.
    file: File,
    syncer: Syncer,
    message: Vec<u8>,
    last_tick: Option<u64>,
    ticks_handed: u64,
    ticks_kept: u64,
    n_events: u32,
    chunk_begun_ns: Option<u64>,
    whole_bytes: u64,
}

impl Recorder {
    /// Begins `folder/ID.mcap` and `folder/ID.toml`, status `running`. The folder must exist.
    ///
    /// # Errors
    ///
    /// An id that is no file name, a run of that name that is there already, a log rate that is not positive, a folder
    /// that cannot be written.
    pub fn create(folder: &Path, meta: RunMeta, layout: Layout, packing: Packing) -> Result<Self, RecordError> {
        check(&meta)?;
        let meta = with_channels(meta, &layout)?;
        let path = folder.join(format!("{}.mcap", meta.id));
        let failed = |error: &std::io::Error| RecordError::Write { path: path.clone(), reason: reason(error) };
        if path.with_extension("toml").exists() {
            return Err(RecordError::RunExists { path: path.with_extension("toml") });
        }
        let file = match File::options().write(true).create_new(true).open(&path) {
            Ok(file) => file,
            Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists => return Err(RecordError::RunExists { path }),
            Err(e) => return Err(failed(&e)),
        };
        // Readers tell by the lock that the run goes on. A disk without locks is no reason not to record.
        let _ = file.try_lock();
        let second = file.try_clone().map_err(|e| failed(&e))?;
        let third = file.try_clone().map_err(|e| failed(&e))?;
        let mut recorder = Self {
            topics: Vec::new(),
            events: 0,
            writer: Some(open_writer(file, packing).map_err(|e| failed(&in_words(e)))?),
            file: second,
            syncer: Syncer::start(third).map_err(|e| failed(&e))?,
            message: Vec::new(),
            last_tick: None,
            ticks_handed: 0,
            ticks_kept: 0,
            n_events: 0,
            chunk_begun_ns: None,
            whole_bytes: 0,
            path: path.clone(),
            meta: RunMeta { status: RunStatus::Running, ..meta },
            layout,
        };
        recorder.declare().map_err(|e| failed(&in_words(e)))?;
        recorder.flush()?;
        write_run_meta(&recorder.path.with_extension("toml"), &recorder.meta)?;
        Ok(recorder)
    }

    /// Metadata, schemas and channels: a small chunk of their own, so that damage further on cannot take them along.
    fn declare(&mut self) -> mcap::McapResult<()> {
        let Some(writer) = &mut self.writer else { return Ok(()) };
        writer.write_metadata(&Metadata { name: RECORD_NAME.to_owned(), metadata: to_record(&self.meta) })?;
        for topic in self.layout.topics() {
            let schema = writer.add_schema(&topic.schema_name(), "ros2msg", topic.schema_text().as_bytes())?;
            self.topics.push(writer.add_channel(schema, &topic.name, "cdr", &topic.metadata())?);
        }
        let schema = writer.add_schema(text::SCHEMA_NAME, "ros2msg", text::SCHEMA.as_bytes())?;
        self.events = writer.add_channel(schema, text::TOPIC, "cdr", &std::collections::BTreeMap::new())?;
        Ok(())
    }

    /// Records one tick: a value per channel of the layout. Ticks count from the start of the run at the log rate; a tick
    /// that is left out is reported by the reader as a gap.
    ///
    /// # Errors
    ///
    /// [`RecordError::Refused`] for a tick that is not later than the last one, or a row of another length: nothing is
    /// recorded, and recording may go on. [`RecordError::Recording`] where the disk is full or fails: stop the carriage.
    pub fn record(&mut self, tick: u64, row: &[f64]) -> Result<(), RecordError> {
        let refuse = |problem: String| {
            Err(RecordError::Refused(format!("cannot record tick {tick} of {}: {problem}", self.path.display())))
        };
        let width = self.layout.channels().len();
        if row.len() != width {
            return refuse(format!("it has {} values, the layout has {width} channels", row.len()));
        }
        if let Some(last) = self.last_tick
            && tick <= last
        {
            return refuse(format!("the last one was {last}; ticks must increase"));
        }
        let log_time = self.log_time(tick);
        let topics = self.layout.topics().iter().zip(&self.topics);
        let Some(writer) = &mut self.writer else { return Err(self.failed_before()) };
        let mut result = Ok(());
        for (topic, channel) in topics {
            self.message.clear();
            topic.encode(row, &mut self.message);
            // The sequence number is the tick: gaps are found by it.
            let header =
                MessageHeader { channel_id: *channel, sequence: tick as u32, log_time, publish_time: log_time };
            result = result.and_then(|()| writer.write_to_known_channel(&header, &self.message));
        }
        result.map_err(|e| self.fail(in_words(e)))?;
        self.last_tick = Some(tick);
        self.ticks_handed += 1;
        self.advance(tick)
    }

    /// Tells that run time has come to `tick` without anything to record: what is older than 40 ms is handed to the system.
    ///
    /// # Errors
    ///
    /// [`RecordError::Recording`], as [`Recorder::record`].
    pub fn advance(&mut self, tick: u64) -> Result<(), RecordError> {
        let now = self.log_time(tick);
        let begun = *self.chunk_begun_ns.get_or_insert(now);
        if now.saturating_sub(begun) < CHUNK_NS {
            return Ok(());
        }
        self.flush()
    }

    /// Records an event at the time of `tick`; a fault is handed to the system at once.
    ///
    /// # Errors
    ///
    /// [`RecordError::Recording`], as [`Recorder::record`].
    pub fn event(&mut self, tick: u64, kind: &EventKind, sentence: &str) -> Result<(), RecordError> {
        let log_time = self.log_time(tick);
        let level = match kind {
            EventKind::Fault => 40,
            EventKind::Warning | EventKind::Link => 30,
            _ => 20,
        };
        self.message.clear();
        text::encode(log_time, level, kind.name(), sentence, &mut self.message);
        let header =
            MessageHeader { channel_id: self.events, sequence: self.n_events, log_time, publish_time: log_time };
        let Some(writer) = &mut self.writer else { return Err(self.failed_before()) };
        writer.write_to_known_channel(&header, &self.message).map_err(|e| self.fail(in_words(e)))?;
        self.n_events = self.n_events.wrapping_add(1);
        self.chunk_begun_ns.get_or_insert(log_time);
        if *kind == EventKind::Fault { self.flush() } else { Ok(()) }
    }

    /// Hands all that was recorded to the system.
    ///
    /// # Errors
    ///
    /// [`RecordError::Recording`], as [`Recorder::record`].
    pub fn flush(&mut self) -> Result<(), RecordError> {
        if let Some(why) = self.syncer.failure() {
            return Err(self.fail(why));
        }
        let Some(writer) = &mut self.writer else { return Err(self.failed_before()) };
        let flushed = writer.flush().map_err(in_words).and_then(|()| self.file.stream_position());
        self.whole_bytes = flushed.map_err(|e| self.fail(e))?;
        self.ticks_kept = self.ticks_handed;
        self.chunk_begun_ns = None;
        Ok(())
    }

    /// What is known about the run; it is written again by [`Recorder::finish`].
    pub fn meta_mut(&mut self) -> &mut RunMeta {
        &mut self.meta
    }

    /// What is known about the run.
    #[must_use]
    pub fn meta(&self) -> &RunMeta {
        &self.meta
    }

    /// The `.mcap` file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Ticks recorded so far.
    #[must_use]
    pub fn ticks(&self) -> u64 {
        self.ticks_handed
    }

    /// Bytes handed to the system so far, all in whole chunks.
    #[must_use]
    pub fn bytes(&self) -> u64 {
        self.whole_bytes
    }

    /// Ends the run: last chunk, metadata with the status, index, and the sidecar with the log's length and hash (taken while it
    /// was written); all brought to the disk.
    ///
    /// After a failure there is nothing to add to the file; the sidecar is written where the disk lets it.
    ///
    /// # Errors
    ///
    /// [`RecordError::Recording`] where the file cannot be ended (what is in it stays readable),
    /// [`RecordError::Write`] where only the sidecar cannot be written.
    pub fn finish(mut self, status: RunStatus) -> Result<PathBuf, RecordError> {
        self.meta.status = status;
        let ended = if self.writer.is_some() { self.end() } else { Ok(()) };
        if ended.is_err() && status == RunStatus::Complete {
            self.meta.status = RunStatus::Interrupted;
        }
        let written = write_run_meta(&self.path.with_extension("toml"), &self.meta);
        ended.and(written).map(|()| self.path.clone())
    }

    fn end(&mut self) -> Result<(), RecordError> {
        self.flush()?;
        let Some(writer) = &mut self.writer else { return Err(self.failed_before()) };
        let metadata = Metadata { name: END_RECORD_NAME.to_owned(), metadata: to_record(&self.meta) };
        let ended = writer.write_metadata(&metadata).and_then(|()| writer.finish()).map_err(in_words);
        ended.and_then(|_| self.file.sync_all()).map_err(|e| self.fail(e))?;
        let sealed = self.writer.take().map(|writer| writer.into_inner().into_inner().into_inner());
        self.meta.log = sealed.and_then(Result::ok).map(Sealed::fingerprint);
        Ok(())
    }

    fn log_time(&self, tick: u64) -> u64 {
        log_time_ns(&self.meta, tick)
    }

    /// Cuts off what was torn; nothing more is recorded.
    fn fail(&mut self, error: std::io::Error) -> RecordError {
        if let Some(writer) = self.writer.take() {
            // Dropped whole, the writer would go on writing.
            let _ = writer.into_inner().into_inner().into_parts();
        }
        let _ = self.file.set_len(self.whole_bytes);
        let _ = self.file.sync_all();
        RecordError::Recording { path: self.path.clone(), reason: reason(&error), ticks: self.ticks_kept }
    }

    fn failed_before(&self) -> RecordError {
        RecordError::Recording {
            path: self.path.clone(),
            reason: "it failed before".to_owned(),
            ticks: self.ticks_kept,
        }
    }
}

impl Drop for Recorder {
    /// A recorder that is dropped was not finished: the file stays as a crash would leave it, but for its last chunk.
    fn drop(&mut self) {
        if let Some(mut writer) = self.writer.take() {
            let _ = writer.flush();
            let _ = writer.into_inner().into_inner().into_parts();
        }
    }
}

/// Time of a tick in the file: nanoseconds since 1970 where the start is known, else since the start.
pub(crate) fn log_time_ns(meta: &RunMeta, tick: u64) -> u64 {
    let rate = meta.log_rate_hz;
    let seconds = (tick as f64 / rate).floor();
    // Split, so that the nanoseconds of a long run are not rounded.
    let rest = tick as f64 - seconds * rate;
    let ns = seconds as u128 * 1_000_000_000 + (rest / rate * 1e9).round() as u128;
    meta.start_unix_ns.saturating_add(u64::try_from(ns).unwrap_or(u64::MAX))
}

/// What is known about the run with what its channels are, as far as nobody declared it by what their names tell.
fn with_channels(mut meta: RunMeta, layout: &Layout) -> Result<RunMeta, RecordError> {
    for ChannelSpec { name, unit, .. } in layout.channels() {
        let known = meta.channels.entry(name.clone()).or_insert_with(|| Meaning::of(name, unit, BOARD));
        if known.unit != *unit {
            let problem = format!("is declared in {:?}, and is recorded in {unit:?}", known.unit);
            return Err(RecordError::Refused(format!("channel `{name}` {problem}")));
        }
    }
    Ok(meta)
}

fn check(meta: &RunMeta) -> Result<(), RecordError> {
    let refuse =
        |key: &str, problem: String| Err(RecordError::Refused(format!("run {:?}: `{key}` {problem}", meta.id)));
    let is_name = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    if meta.id.is_empty() || meta.id.len() > 200 || meta.id.starts_with('.') || !meta.id.chars().all(is_name) {
        return refuse(
            "id",
            format!("is {:?}; it names the run's files: write letters, digits, `-`, `_` and `.`", meta.id),
        );
    }
    if !(meta.log_rate_hz.is_finite() && meta.log_rate_hz > 0.0) {
        return refuse("log_rate", format!("is {} Hz; it must be larger than zero", meta.log_rate_hz));
    }
    Ok(())
}

fn open_writer(file: File, packing: Packing) -> mcap::McapResult<Writer> {
    mcap::WriteOptions::new()
        .profile("ros2")
        .library(concat!("froude ", env!("CARGO_PKG_VERSION")))
        .compression(match packing {
            Packing::None => None,
            Packing::Lz4 => Some(mcap::Compression::Lz4),
            Packing::Zstd => Some(mcap::Compression::Zstd),
        })
        .compression_threads(0)
        .chunk_size(Some(LARGEST_CHUNK))
        // Chunks are made in memory and written in one piece.
        .disable_seeking(true)
        .create(NoSeek::new(BufWriter::with_capacity(1 << 16, Sealed::new(file))))
}

/// The system's error inside one of the library, for its words.
fn in_words(error: mcap::McapError) -> std::io::Error {
    match error {
        mcap::McapError::Io(error) => error,
        other => std::io::Error::other(other.to_string()),
    }
}
