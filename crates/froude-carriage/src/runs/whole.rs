//! Whether the runs that are reduced together are a whole campaign: all that it planned, and all that lie in their folder.
//!
//! A folder of runs holds a copy of its campaign, and that says what was planned. Where runs of the plan are not there, the campaign was not
//! driven to its end, or somebody took files away; the reduction goes on with what there is and says what it lacks. A campaign that stopped
//! because it knew enough lacks nothing: `stopped-early.txt` says after which run.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use froude_identify::method::MethodError;
use froude_identify::runs::files;
use froude_records::finding::{Finding, Severity};
use froude_records::hash::sha256_of_file;
use froude_records::read;
use froude_records::run::{CAMPAIGN_COPY, Role, RunMeta, RunStatus, read_run_meta};
use froude_records::text::counted;
use froude_rig::carriage::plan::{PlannedRun, Step, order_seed, plan};
use froude_rig::carriage::{CarriageCampaign, DrivenCampaign};

use super::set::is_put_aside;

/// Stretches of missing runs that are named.
const MOST_NAMED: usize = 6;

/// Name of the file that says why a campaign stopped before all its pairs were driven.
pub(crate) const STOPPED_EARLY: &str = "stopped-early.txt";

/// What its line with the last run begins with.
pub(crate) const LAST_RUN: &str = "last run: ";

/// Runs that lie complete in their folders.
#[derive(Debug, Default)]
pub struct Complete {
    by_folder: BTreeMap<PathBuf, Here>,
}

/// Those of one folder.
#[derive(Debug, Default)]
struct Here {
    ids: BTreeSet<String>,
    /// SHA-256 of the campaigns that they were driven by, as far as they say.
    campaigns: BTreeSet<String>,
}

impl Complete {
    /// One more.
    pub fn add(&mut self, log: &Path, meta: &RunMeta) {
        let here = self.by_folder.entry(folder_of(log)).or_default();
        here.ids.insert(meta.id.clone());
        if !meta.campaign_sha256.is_empty() {
            here.campaigns.insert(meta.campaign_sha256.clone());
        }
    }

    /// What a folder lacks of the plan of its campaign: a warning where that is runs of one of these roles, and a note where a campaign stopped
    /// early and lacks none. Nothing where no plan is known: no copy of the campaign, one that was edited since, or runs of another verb.
    #[must_use]
    pub fn against_plan(&self, folder: &Path, roles: &[Role]) -> Option<Finding> {
        let copy = folder.join(CAMPAIGN_COPY);
        if !copy.is_file() {
            return None;
        }
        let campaign = match DrivenCampaign::read(&copy) {
            Ok(campaign) => campaign,
            Err(error) => {
                let text = format!("the plan is not known: {error}");
                return Some(Finding::new(Severity::Warning, "campaign-unreadable", text));
            }
        };
        let none = Here::default();
        let here = self.by_folder.get(&plain(folder)).unwrap_or(&none);
        let sha256 = sha256_of_file(&copy).ok()?;
        if here.campaigns.iter().any(|driven_by| *driven_by != sha256) {
            return None;
        }
        let planned = planned(campaign.carriage.as_ref());
        let file = |run: &PlannedRun, extension: &str| folder.join(format!("{}.{extension}", run.id));
        if !planned.iter().any(|run| file(run, "mcap").exists() || file(run, "toml").exists()) {
            return None;
        }
        here.against(&planned, EarlyStop::read(folder), roles)
    }
}

impl Here {
    fn against(&self, planned: &[PlannedRun], stop: Option<EarlyStop>, roles: &[Role]) -> Option<Finding> {
        let is_there = |run: &PlannedRun| self.ids.contains(&run.id);
        let spared_from = stop.as_ref().map_or(planned.len(), |stop| stop.spared_from(planned, &self.ids));
        let is_missing: Vec<bool> = planned
            .iter()
            .enumerate()
            .map(|(i, run)| !is_there(run) && !(i >= spared_from && run.pair.is_some()))
            .collect();
        let there = planned.iter().filter(|run| is_there(run)).count();
        if planned.iter().zip(&is_missing).any(|(run, is_missing)| *is_missing && roles.contains(&run.role)) {
            let text = format!(
                "{there} of {} are complete; missing: {}. froude run with the same campaign drives what is missing",
                counted(planned.len(), "planned run", "planned runs"),
                stretches(planned, &is_missing)
            );
            return Some(Finding::new(Severity::Warning, "campaign-unfinished", text));
        }
        stop.filter(|_| there < planned.len()).map(|stop| {
            let text = format!(
                "{there} of {} planned runs were driven: the campaign stopped by its own rule (stop_when). {}",
                planned.len(),
                stop.why
            );
            Finding::new(Severity::Note, "stopped-early", text)
        })
    }
}

/// Why and where a campaign stopped, as its folder says.
#[derive(Debug)]
struct EarlyStop {
    why: String,
    /// The run after which it stopped; earlier versions did not write it.
    last: Option<String>,
}

impl EarlyStop {
    fn read(folder: &Path) -> Option<Self> {
        let text = read::text(&folder.join(STOPPED_EARLY), read::OWN_BYTES, "a note").ok()?;
        let last = text.lines().find_map(|line| line.strip_prefix(LAST_RUN)).map(str::to_owned);
        Some(Self { why: text.lines().next().unwrap_or_default().to_owned(), last })
    }

    /// Index of the first run of the plan that was not needed any more.
    fn spared_from(&self, planned: &[PlannedRun], complete: &BTreeSet<String>) -> usize {
        let of_last = self.last.as_ref().and_then(|last| planned.iter().position(|run| run.id == *last));
        let of_pairs = |run: &PlannedRun| run.pair.is_some() && complete.contains(&run.id);
        of_last.or_else(|| planned.iter().rposition(of_pairs)).map_or(planned.len(), |i| i + 1)
    }
}

/// The runs that `froude run` drives of a campaign, in order; none where it drives none.
fn planned(carriage: Option<&CarriageCampaign>) -> Vec<PlannedRun> {
    let Some(carriage) = carriage else { return Vec::new() };
    let Some(asked) = &carriage.plan else { return Vec::new() };
    // Where forward runs begin is no part of a run's name.
    let steps = plan(asked, asked.start_m.unwrap_or(0.0), order_seed(&carriage.rig.kind));
    let run = |step| if let Step::Run(run) = step { Some(run) } else { None };
    steps.into_iter().filter_map(run).collect()
}

/// Runs in a row as their first and last: `011-dry to 017-wet (7 runs)`.
fn stretches(planned: &[PlannedRun], missing: &[bool]) -> String {
    let (mut named, mut left, mut i) = (Vec::new(), 0, 0);
    while i < planned.len() {
        let n = missing[i..].iter().take_while(|m| **m).count();
        if n > 0 && named.len() == MOST_NAMED {
            left += n;
        } else if n > 0 {
            let (first, last) = (&planned[i].id, &planned[i + n - 1].id);
            named.push(match n {
                1 => first.clone(),
                2 => format!("{first}, {last}"),
                _ => format!("{first} to {last} ({n} runs)"),
            });
        }
        i += n.max(1);
    }
    let more = if left == 0 { String::new() } else { format!(" and {left} more") };
    named.join(", ") + &more
}

/// Complete runs of these roles that lie beside the named logs, and were not named.
pub(crate) fn beside(named: &[PathBuf], roles: &[Role]) -> Result<Vec<PathBuf>, MethodError> {
    let folders: BTreeSet<PathBuf> = named.iter().map(|log| folder_of(log)).collect();
    let mut out = Vec::new();
    for folder in folders {
        for log in files(std::slice::from_ref(&folder))? {
            let is_named = named.iter().any(|named| named.file_name() == log.file_name() && folder_of(named) == folder);
            let Ok(meta) = read_run_meta(&log.with_extension("toml")) else { continue };
            let is_whole = meta.status == RunStatus::Complete && log.exists() && !is_put_aside(&log, &meta);
            if !is_named && is_whole && roles.contains(&meta.role) {
                out.push(log);
            }
        }
    }
    Ok(out)
}

/// The folder that a file lies in; `.` where its path is a name alone.
pub(crate) fn folder_of(file: &Path) -> PathBuf {
    plain(file.parent().unwrap_or(Path::new("")))
}

fn plain(folder: &Path) -> PathBuf {
    if folder.as_os_str().is_empty() { PathBuf::from(".") } else { folder.to_owned() }
}
