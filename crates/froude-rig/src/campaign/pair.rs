//! Whether a sidecar and its log belong together.

use std::path::Path;

use froude_records::RecordError;
use froude_records::hash::fingerprint_of_file;
use froude_records::read::whole;
use froude_records::run::{
    CampaignMark, DoubtKind, GapCause, RunMeta, RunReader, RunStatus, contradiction, difference, head_of, read_run_meta,
};

/// The largest sidecar that is looked into.
const LARGEST_BYTES: u64 = 1 << 20;

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
    if !sidecar.exists() || whole(&sidecar, LARGEST_BYTES, "a run's sidecar").is_ok_and(is_blank) {
        return Ok(None);
    }
    let meta = read_run_meta(&sidecar)?;
    let refuse = |path: &Path, problem: String| Err(RecordError::Refused(format!("{} {problem}", path.display())));
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
