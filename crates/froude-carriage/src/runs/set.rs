//! Whether the runs that are reduced together are a set: no run twice, all that lie beside a campaign of that campaign.
//!
//! A log in two folders, or under two names, narrows every interval for nothing. Two logs are one run when their bytes are the
//! same, or when both say the same campaign (name and SHA-256 of its file) and the same run of it.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use froude_records::RecordError;
use froude_records::finding::{Finding, Severity};
use froude_records::hash::sha256_of_file;
use froude_records::run::{CAMPAIGN_COPY, Doubt, DoubtKind, RunMeta};
use froude_records::text::counted;

/// A log of the set, as far as it tells it from others.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Member {
    /// The log.
    pub path: PathBuf,
    id: String,
    campaign: String,
    campaign_sha256: String,
    sha256: String,
}

impl Member {
    /// Of a log whose fingerprint was compared, or whose bytes are summed now.
    ///
    /// # Errors
    ///
    /// A log that cannot be read.
    pub fn of(path: &Path, meta: &RunMeta) -> Result<Self, RecordError> {
        let sha256 = match &meta.log {
            Some(log) => log.sha256.clone(),
            None => sha256_of_file(path)?,
        };
        Ok(Self {
            path: path.to_owned(),
            id: meta.id.clone(),
            campaign: meta.campaign.clone(),
            campaign_sha256: meta.campaign_sha256.clone(),
            sha256,
        })
    }

    fn is_of_the_same_run(&self, other: &Self) -> bool {
        let (a, b) = (&self.campaign_sha256, &other.campaign_sha256);
        self.id == other.id && self.campaign == other.campaign && (a.is_empty() || b.is_empty() || a == b)
    }
}

/// Whether a run was set aside, to be driven again: its files have a word more than its name (`045-wet.interrupted-1`).
pub fn is_put_aside(log: &Path, meta: &RunMeta) -> bool {
    let stem = log.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    stem.strip_prefix(&meta.id).is_some_and(|rest| rest.starts_with('.'))
}

/// A finding for every member that is there before.
#[must_use]
pub fn doubles(members: &[Member]) -> Vec<Finding> {
    let mut by_hash: BTreeMap<&str, &Member> = BTreeMap::new();
    let mut by_id: BTreeMap<&str, Vec<&Member>> = BTreeMap::new();
    let mut out = Vec::new();
    for member in members {
        let same_bytes = by_hash.get(member.sha256.as_str());
        let same_id = by_id.entry(&member.id).or_default();
        let (now, id) = (member.path.display(), &member.id);
        let text = if let Some(first) = same_bytes {
            if first.path == member.path {
                format!("{now} is named twice: name every folder and every run once")
            } else {
                format!(
                    "{now} is the same log as {}, byte for byte: a run that counts twice makes every interval too narrow. Name one of \
                     them, or move the copy out",
                    first.path.display()
                )
            }
        } else if let Some(first) = same_id.iter().find(|other| member.is_of_the_same_run(other)) {
            format!(
                "{now} and {} are both run {id} of campaign {:?}: it was driven twice, and its pairs cannot be distinguished. Reduce \
                 each drive separately",
                first.path.display(),
                member.campaign
            )
        } else {
            by_hash.insert(&member.sha256, member);
            same_id.push(member);
            continue;
        };
        out.push(Finding::new(Severity::Error, "run-doubled", text));
    }
    out
}

/// Findings where runs that lie in one folder are not all of the campaign whose copy lies there.
///
/// # Errors
///
/// A copy of a campaign that cannot be read.
pub fn strangers(members: &[Member]) -> Result<Vec<Finding>, RecordError> {
    let mut folders: Vec<&Path> = members.iter().filter_map(|m| m.path.parent()).collect();
    folders.sort_unstable();
    folders.dedup();
    let mut out = Vec::new();
    for folder in folders {
        // Runs of earlier versions say no hash; they are held to nothing here.
        let own: Vec<&Member> =
            members.iter().filter(|m| m.path.parent() == Some(folder) && !m.campaign_sha256.is_empty()).collect();
        let copy = folder.join(CAMPAIGN_COPY);
        let copied = if copy.is_file() { Some(sha256_of_file(&copy)?) } else { None };
        let mut counts: Vec<(&str, usize)> = Vec::new();
        for member in &own {
            match counts.iter_mut().find(|(sha256, _)| *sha256 == member.campaign_sha256) {
                Some((_, n)) => *n += 1,
                None => counts.push((&member.campaign_sha256, 1)),
            }
        }
        let is_copied = |sha256: &str| copied.as_deref() == Some(sha256);
        // Theirs is the campaign that lies there; else the one that most name.
        let Some((home, n)) = counts.iter().max_by_key(|(sha256, n)| (is_copied(sha256), *n)).copied() else {
            continue;
        };
        for stranger in own.iter().filter(|m| m.campaign_sha256 != home) {
            out.push(Finding::new(
                Severity::Error,
                "run-of-another-campaign",
                format!(
                    "{} is of another campaign ({:?}, SHA-256 {}…) than the {} in its folder ({}…): move it out, with its sidecar",
                    stranger.path.display(),
                    stranger.campaign,
                    start(&stranger.campaign_sha256),
                    counted(n, "other run", "other runs"),
                    start(home),
                ),
            ));
        }
        if copied.is_some() && !is_copied(home) {
            out.push(Finding::new(
                Severity::Warning,
                "campaign-changed",
                format!(
                    "{} is not the campaign that its runs were driven by (SHA-256 {}…): it was edited or replaced; what it declares now \
                     is used",
                    copy.display(),
                    start(home)
                ),
            ));
        }
    }
    Ok(out)
}

fn start(sha256: &str) -> &str {
    sha256.get(..8).unwrap_or(sha256)
}

/// Doubts of many logs as findings, one for each sort.
#[must_use]
pub fn summed_up(doubts: &[Doubt]) -> Vec<Finding> {
    let sorts = [DoubtKind::NoSidecar, DoubtKind::NoFingerprint, DoubtKind::Renamed, DoubtKind::Edited];
    let mut out = Vec::new();
    for kind in sorts {
        let mut all = doubts.iter().filter(|doubt| doubt.kind == kind);
        if let Some(first) = all.next() {
            let mut finding = first.finding();
            match all.count() {
                0 => {}
                more => finding.message += &format!(" (so it is with {more} more)"),
            }
            out.push(finding);
        }
    }
    out
}
