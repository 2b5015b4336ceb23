//! The end of a run: what is missing there, what became of it, and whether its file is the one that the sidecar was written for.

use std::io::{Read, Seek};

use super::{Block, RunReader};
use crate::error::{Place, RecordError};
use crate::run::doubt::DoubtKind;
use crate::run::file::End;
use crate::run::log::{Gap, GapCause};
use crate::run::meta::RunStatus;
use crate::run::seal::difference;

impl<R: Read + Seek> RunReader<R> {
    /// The end of the file: what is missing there, and what became of the run.
    pub(super) fn end(&mut self, end: End, block: &mut Block) -> Result<(), RecordError> {
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

    /// What is declared of a channel has the unit that the log has.
    fn check_units(&self) -> Result<(), RecordError> {
        let declared = |name: &String| self.meta.channels.get(name).map(|meaning| &meaning.unit);
        let mut both = self.channels.iter().filter_map(|(name, unit)| Some((name, unit, declared(name)?)));
        let Some((name, unit, declared)) = both.find(|(_, unit, declared)| unit != declared) else { return Ok(()) };
        let path = if self.has_sidecar { self.path.with_extension("toml") } else { self.path.clone() };
        Err(RecordError::value(
            Place::whole(&path),
            format!("channels.{name:?}.unit"),
            format!("is {declared:?}; expected {unit:?}, in which {} was recorded", self.path.display()),
        ))
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
}
