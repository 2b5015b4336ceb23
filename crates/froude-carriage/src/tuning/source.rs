//! Experiments on the loop as sources: gains and their margins from relay and sweep, modes from sweeps bare, dry and wet.

use froude_identify::answer::{Answer, Made};
use froude_identify::method::{Found, Method, MethodError, Need};
use froude_identify::source::ReadFile;
use froude_records::block::Section;
use froude_records::campaign::{Campaign, Source};
use froude_records::estimate::Estimate;
use froude_records::run::{CAMPAIGN_COPY, Role, TOW};
use froude_rig::campaign::prepare::configured;

use super::choice::{self, tuned};
use super::modes::{self, modes_of};
use crate::runs::Runs;
use crate::source::{DRIVEN, file_of, files_of, named, runs_of};
use crate::tuning::bench::ConfiguredLoop;

/// Gains of the position loop, with the margins that they have on the measured response.
#[derive(Debug)]
pub struct Tuning;

/// Modes of the carriage in each state of the body.
#[derive(Debug)]
pub struct Resonance;

const SWEEP: Need = Need::of(&["sweep"], DRIVEN);
const TUNED: [Need; 2] = [SWEEP, Need { is_optional: true, ..Need::of(&["relay"], DRIVEN) }];
const SWEPT: [Need; 1] = [SWEEP];

impl Method for Tuning {
    fn names(&self) -> &'static [&'static str] {
        &["tuning"]
    }

    fn words(&self, _: &str) -> &'static str {
        "gains of the position loop from a relay and a sweep"
    }

    fn needs(&self, _: &str) -> &'static [Need] {
        &TUNED
    }

    fn runs(&self) -> &'static str {
        TOW
    }

    /// The gains as configured, and the ramps that all must follow, are those of the campaign that lies with the runs.
    fn identify(
        &self,
        _: &Campaign,
        source: &Source,
        _: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Found, MethodError> {
        found(source, "tuning", &[Role::Relay, Role::Sweep], progress, |runs, name| {
            let what = || {
                format!(
                    "no campaign lies with these runs, and gains are judged by the rig that it declares; copy it there as {CAMPAIGN_COPY}"
                )
            };
            let declared = runs.campaign.as_ref().ok_or_else(|| MethodError::input(&runs.folder, what()))?;
            let configured = configured(&declared.campaign).map_err(MethodError::refused)?;
            progress("judging gains");
            let of = ConfiguredLoop {
                axis: configured.axis(),
                tick_us: configured.tick_us(),
                hardest_ramp: configured.hardest_ramp(),
            };
            let tuned = tuned(&runs.logs, of)?;
            let files = files_of(runs);
            let of_all = |estimate| (estimate, files.clone());
            let estimates = choice::record::estimates(name, &tuned).into_iter().map(of_all).collect();
            Ok((estimates, choice::page::section(&tuned)))
        })
    }
}

impl Method for Resonance {
    fn names(&self) -> &'static [&'static str] {
        &["resonance"]
    }

    fn words(&self, _: &str) -> &'static str {
        "modes of the carriage from sweeps"
    }

    fn needs(&self, _: &str) -> &'static [Need] {
        &SWEPT
    }

    fn runs(&self) -> &'static str {
        TOW
    }

    fn identify(
        &self,
        _: &Campaign,
        source: &Source,
        _: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Found, MethodError> {
        found(source, "resonance", &[Role::Sweep], progress, |runs, name| {
            progress("finding the modes");
            let modes = modes_of(&runs.logs)?;
            // Each is of its own sweep.
            let of_sweep = |(i, estimate): (usize, Estimate)| (estimate, vec![file_of(&runs.logs[i])]);
            let estimates = modes::record::estimates(name, &modes).into_iter().map(of_sweep).collect();
            Ok((estimates, modes::page::section(&modes)))
        })
    }
}

/// Reduces the runs of a source in these roles: estimates with their files, and the section that reports them. `reduce` receives the name that
/// the estimates begin with.
fn found(
    source: &Source,
    what: &str,
    roles: &[Role],
    progress: &dyn Fn(&str),
    reduce: impl FnOnce(&Runs, &str) -> Result<(Vec<(Estimate, Vec<ReadFile>)>, Section), MethodError>,
) -> Result<Found, MethodError> {
    let Some(runs) = runs_of(&Campaign::default(), source, roles, progress)? else { return Ok(Found::default()) };
    let (estimates, summary) = reduce(&runs, &named(source, &runs, what))?;
    let answer = |(estimate, files): (Estimate, Vec<ReadFile>)| -> Answer {
        Made { name: format!("{}, {}", estimate.source, estimate.law.name), estimate, files }.into()
    };
    Ok(Found {
        results: estimates.into_iter().map(answer).collect(),
        summary: Some(summary),
        beside: Some(runs.results(what)),
        is_part: runs.beside > 0,
        findings: runs.findings,
        ..Found::default()
    })
}
