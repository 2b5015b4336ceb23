//! Whether a log is the one that its sidecar was written for, and whether a run lies in a folder as it was driven.

use std::fmt;

use crate::hash::Fingerprint;
use crate::run::meta::RunMeta;

/// A campaign as its runs name it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct CampaignMark<'a> {
    /// Its name.
    pub name: &'a str,
    /// SHA-256 of its file; empty where it is not known.
    pub sha256: &'a str,
}

impl CampaignMark<'_> {
    /// The mark of a run.
    #[must_use]
    pub fn of(meta: &RunMeta) -> CampaignMark<'_> {
        CampaignMark { name: &meta.campaign, sha256: &meta.campaign_sha256 }
    }

    /// Whether both may be the same: a hash that is not known contradicts none.
    #[must_use]
    pub fn agrees(&self, other: &CampaignMark<'_>) -> bool {
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
#[must_use]
pub fn contradiction(log: &RunMeta, sidecar: &RunMeta) -> Option<String> {
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

/// How a file differs from the one that was recorded, as the rest of a sentence about it.
#[must_use]
pub fn difference(recorded: &Fingerprint, found: &Fingerprint) -> Option<String> {
    if found.bytes < recorded.bytes {
        return Some(format!("has {} of the {} bytes that were recorded: it was cut off", found.bytes, recorded.bytes));
    }
    (found != recorded).then(|| "is not the file that was recorded, its SHA-256 is another".to_owned())
}
