//! What a campaign's plan takes and determines, before a day in the tank is paid for.

use std::path::Path;

use froude_identify::method::Prospect;
use froude_identify::simulate::tables::SimulateError;
use froude_records::block::{Section, facts};
use froude_records::outcome::Outcome;
use froude_rig::carriage::declared;

use crate::{Error, carriage::drive, method};

/// Run matrix, time and intervals to expect of every source that plans runs; of a carriage the runs that it would drive.
///
/// # Errors
///
/// See [`Error`]: a campaign that plans no runs, or does not declare what they need.
pub fn plan(path: &Path) -> Result<Outcome, Error> {
    let campaign = method::read_campaign(path)?;
    let mut out = Vec::new();
    for source in campaign.sources.iter().filter(|source| source.plans_runs()) {
        for (method, _) in method::of(source, None)? {
            out.extend(method.plan(&campaign, source).map_err(Error::Method)?);
        }
    }
    if out.is_empty() && declared(&campaign)?.is_some_and(|carriage| carriage.plan.is_some()) {
        return Ok(drive::prepare(&drive::DriveJob { campaign: campaign.path, ..Default::default() })?.outcome());
    }
    if out.is_empty() {
        return Err(SimulateError::NoPlan { path: campaign.path }.into());
    }
    Ok(Outcome { blocks: out.into_iter().map(|prospect| section(prospect).into()).collect(), ..Outcome::default() })
}

fn section(prospect: Prospect) -> Section {
    let f = facts("", "", &prospect);
    let about = f.build(vec![
        f.text("source", "", |p| p.source.clone()),
        f.count("runs", "", |p| p.runs),
        f.number("duration_s", "", |p| p.duration_s),
    ]);
    let blocks = [vec![about.into()], prospect.section.blocks].concat();
    Section { key: "sources[]".to_owned(), blocks, ..prospect.section }
}
