//! Whether a log is the one that its sidecar was written for, and whether a run lies in a folder as it was driven.

use std::fmt;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

use sha2::{Digest as _, Sha256};

use crate::error::{Place, RecordError, read_bytes};
use crate::finding::{Finding, Severity};
use crate::hash::{Fingerprint, fingerprint_of_file, hexadecimal};
use crate::run::log::GapCause;
use crate::run::meta::{RunMeta, RunStatus};
use crate::run::reader::{RunReader, head_of};
use crate::run::sidecar::{LARGEST_BYTES, read_run_meta};

/// Faults of a log as a whole.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Doubt {
    /// What sort of thing.
    pub kind: DoubtKind,
    /// The sentence a person reads; it names the file.
    pub text: String,
}

/// Sort of a doubt.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DoubtKind {
    /// Cut off, or changed: its bytes are not those that were recorded.
    Damaged,
    /// A whole log, but of another run, another campaign or another drive than its sidecar.
    Exchanged,
    /// No sidecar lies beside it.
    NoSidecar,
    /// Its sidecar does not say what bytes it should have.
    NoFingerprint,
    /// Its file has another name than its run.
    Renamed,
    /// Its sidecar says something else than the log itself: a person edited it.
    Edited,
}

impl Doubt {
    /// The same as a finding: damage and exchange are errors, an edit is a note.
    #[must_use]
    pub fn finding(&self) -> Finding {
        let (severity, code) = match self.kind {
            DoubtKind::Damaged => (Severity::Error, "run-damaged"),
            DoubtKind::Exchanged => (Severity::Error, "run-exchanged"),
            DoubtKind::NoSidecar => (Severity::Warning, "run-without-sidecar"),
            DoubtKind::NoFingerprint => (Severity::Warning, "run-without-hash"),
            DoubtKind::Renamed => (Severity::Warning, "run-renamed"),
            DoubtKind::Edited => (Severity::Note, "run-edited"),
        };
        Finding::new(severity, code, self.text.clone())
    }
}

/// A campaign as its runs name it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CampaignMark<'a> {
    /// Its name.
    pub name: &'a str,
    /// SHA-256 of its file; empty where it is not known.
    pub sha256: &'a str,
}

impl CampaignMark<'_> {
    fn of(meta: &RunMeta) -> CampaignMark<'_> {
        CampaignMark { name: &meta.campaign, sha256: &meta.campaign_sha256 }
    }

    /// Whether both may be the same: a hash that is not known contradicts none.
    fn agrees(&self, other: &CampaignMark<'_>) -> bool {
        let is_same_file = self.sha256.is_empty() || other.sha256.is_empty() || self.sha256 == other.sha256;
        self.name == other.name && is_same_file
    }
}

impl fmt::Display for CampaignMark<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{:?}", self.name)?;
        match self.sha256.get(..8) {
            Some(first) => write!(f, " (SHA-256 {first}…)"),
            None => Ok(()),
        }
    }
}

/// How a log and its sidecar contradict each other, as the rest of a sentence that begins with the log's name.
pub(crate) fn contradiction(log: &RunMeta, sidecar: &RunMeta) -> Option<String> {
    let (own, said) = (CampaignMark::of(log), CampaignMark::of(sidecar));
    if log.id != sidecar.id {
        return Some(format!(
            "is the log of run {} and its sidecar is that of {}: they were exchanged or renamed; give each log and each sidecar the \
             name of its own run",
            log.id, sidecar.id
        ));
    }
    (!own.agrees(&said)).then(|| {
        format!(
            "is of campaign {own} and its sidecar of {said}: they come from two drives; put the files that belong together side by side"
        )
    })
}

/// What lies in a folder under the name of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Pair {
    /// Nothing.
    Absent,
    /// Log and sidecar of a run that was driven as planned, and each is what the other says.
    Complete {
        /// What is known about the run.
        meta: Box<RunMeta>,
        /// Whether the log was compared with its fingerprint; runs of earlier versions have none, and only the log's own
        /// checksums were.
        is_compared: bool,
    },
    /// Something that is no complete run: put it aside and drive the run again.
    Again {
        /// Why, as a sentence.
        reason: String,
    },
}

/// Looks whether run `id` of `campaign` lies complete in `folder`; the whole log is read.
///
/// # Errors
///
/// What a person has to decide, because driving on would bury it: a sidecar that was edited or cannot be read, a log or a
/// sidecar of another run or of another campaign.
pub fn check_pair(folder: &Path, id: &str, campaign: CampaignMark<'_>) -> Result<Pair, RecordError> {
    let log = folder.join(format!("{id}.mcap"));
    let Some(meta) = check_names(folder, id, campaign)? else {
        return Ok(if log.exists() {
            Pair::Again { reason: format!("{id}.mcap has no sidecar {id}.toml") }
        } else {
            Pair::Absent
        });
    };
    let again = |reason: String| Ok(Pair::Again { reason });
    if !log.exists() {
        return again(format!("the log {id}.mcap is gone; {id}.toml says {}", meta.status.name()));
    }
    match (meta.status, meta.note.as_str()) {
        (RunStatus::Complete, _) => {}
        (RunStatus::Running, _) => return again(format!("{id} was interrupted without notice: it has no end")),
        (status, "") => return again(format!("{id} is {}", status.name())),
        (status, note) => return again(format!("{id} is {}: {note}", status.name())),
    }
    let Some(recorded) = &meta.log else {
        let read = match RunReader::open(&log).and_then(RunReader::read_all) {
            Ok(read) => read,
            Err(error) => return again(format!("{id} cannot be read: {error}")),
        };
        let gap = read.lost.iter().find(|gap| matches!(gap.cause, GapCause::CutOff | GapCause::Damaged));
        let damage = read.doubts.iter().find(|doubt| doubt.kind == DoubtKind::Damaged);
        return match damage.map(|d| &d.text).or(gap.map(|g| &g.text)) {
            Some(text) => again(format!("{id} is damaged: {text}")),
            None => Ok(Pair::Complete { meta: Box::new(meta), is_compared: false }),
        };
    };
    let found = fingerprint_of_file(&log)?;
    match difference(recorded, &found) {
        Some(what) => again(format!("{id}.mcap {what}")),
        None => Ok(Pair::Complete { meta: Box::new(meta), is_compared: true }),
    }
}

/// The sidecar of a run, `None` where there is none or nothing is written in it: it and the head of its log must name this run and this campaign.
///
/// Only the beginning of the log is read, so that a whole folder is looked through before anything moves.
///
/// # Errors
///
/// As [`check_pair`].
pub fn check_names(folder: &Path, id: &str, campaign: CampaignMark<'_>) -> Result<Option<RunMeta>, RecordError> {
    let (log, sidecar) = (folder.join(format!("{id}.mcap")), folder.join(format!("{id}.toml")));
    // What a power cut leaves of a file that was just made: it says nothing of any run.
    let is_blank = |bytes: Vec<u8>| bytes.iter().all(|byte| byte.is_ascii_whitespace() || *byte == 0);
    if !sidecar.exists() || read_bytes(&sidecar, LARGEST_BYTES, "a run's sidecar").is_ok_and(is_blank) {
        return Ok(None);
    }
    let meta = read_run_meta(&sidecar)?;
    let refuse = |path: &Path, problem: String| Err(RecordError::NotItsRun { place: Place::whole(path), problem });
    if meta.id != id {
        let problem = format!(
            "is the sidecar of run {}, not of {id}: it was renamed or exchanged; give log and sidecar the name of their own run, or \
             move both out of the folder",
            meta.id
        );
        return refuse(&sidecar, problem);
    }
    let own = CampaignMark::of(&meta);
    if !own.agrees(&campaign) {
        let problem = format!(
            "is of campaign {own}, and {campaign} is driven here: move {id}.mcap and {id}.toml out of the folder, or name another \
             folder with --out"
        );
        return refuse(&sidecar, problem);
    }
    if log.exists()
        && let Some(inside) = head_of(&log)?
        && let Some(problem) = contradiction(&inside, &meta)
    {
        return refuse(&log, problem);
    }
    Ok(Some(meta))
}

/// How a file differs from the one that was recorded, as the rest of a sentence about it.
pub(crate) fn difference(recorded: &Fingerprint, found: &Fingerprint) -> Option<String> {
    if found.bytes < recorded.bytes {
        return Some(format!("has {} of the {} bytes that were recorded: it was cut off", found.bytes, recorded.bytes));
    }
    (found != recorded).then(|| "is not the file that was recorded, its SHA-256 is another".to_owned())
}

/// A file that is being written, and its fingerprint so far.
pub(crate) struct Sealed {
    file: File,
    sum: Sha256,
    bytes: u64,
}

impl Sealed {
    pub fn new(file: File) -> Self {
        Self { file, sum: Sha256::new(), bytes: 0 }
    }

    /// Of all that was written.
    pub fn fingerprint(self) -> Fingerprint {
        Fingerprint { bytes: self.bytes, sha256: hexadecimal(&self.sum.finalize()) }
    }
}

impl Write for Sealed {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let n = self.file.write(bytes)?;
        self.sum.update(&bytes[..n]);
        self.bytes += n as u64;
        Ok(n)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file.flush()
    }
}
