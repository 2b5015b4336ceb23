//! A campaign that passed its pre-flight, driven on the twin or the real rig into its own folder.

use std::path::Path;

use crate::carriage::RigKind;
use froude_control::config::Limits;
use froude_records::hash::sha256_of_bytes;
use froude_records::read;
use froude_records::run::{CAMPAIGN_COPY, CampaignMark};
use froude_records::write::write_atomically;
use indexmap::IndexMap;

use super::error::CampaignError;
use super::lock;
use super::pair::check_names;
use super::prepare::{Prepared, return_speed_m_s};
use super::runner::{self, Driven, Look, Operator, Progress, RunnerError};
use super::setup;
use super::stop::StopSwitch;
use crate::campaign::runner::Setting;
use crate::drive::Rig;
use crate::drive::serial::SerialRig;
use crate::drive::twin::TwinRig;
use crate::load::Load;

/// Longest that homing may take, s: half as long again as the way from the far hard stop does, and a minute for turning and settling.
fn homing_s(limits: &Limits) -> f64 {
    60.0 + 1.5 * (limits.hard_high_m - limits.hard_low_m) / limits.unhomed_speed_m_s
}

/// Drives what passed its pre-flight; goes on where an earlier drive into the same folder stopped. `look_at` is called after every run.
///
/// # Errors
///
/// Objections of the pre-flight, a folder that belongs to another campaign, and whatever stops the drive.
pub fn drive(
    prepared: &Prepared,
    switch: &StopSwitch,
    operator: &mut dyn Operator,
    progress: &mut dyn Progress,
    look_at: &mut Look<'_>,
) -> Result<Driven, CampaignError> {
    if let Some(first) = prepared.objections.first() {
        let more = prepared.objections.len() - 1;
        return Err(CampaignError::Refused { first: first.clone(), more });
    }
    let _alone = lock::take(&prepared.folder, &prepared.job.date, prepared.job.start_unix_ns)?;
    let campaign_sha256 = own_folder(&prepared.folder, &prepared.job.campaign)?;
    // Exchanged and foreign files are for a person to sort out, before anything moves.
    let mark = CampaignMark { name: &prepared.campaign.name, sha256: &campaign_sha256 };
    for run in prepared.runs() {
        check_names(&prepared.folder, &run.id, mark)?;
    }
    let (mut rig, load, twin_seed) = rig_of(prepared)?;
    let axis = &prepared.control.axes[prepared.asked.axis as usize];
    let mut constants = IndexMap::from([("y".to_owned(), prepared.carriage.rig.y.constants)]);
    constants.extend(prepared.carriage.rig.x.as_ref().map(|x| ("x".to_owned(), x.constants)));
    let every = rig.ticks_per_sample();
    let wanted = rig.rate_hz() * every as f64 / prepared.carriage.rig.log_rate_hz;
    let decimation = ((wanted / every as f64).round().max(1.0) as u64) * every;
    let setting = Setting {
        campaign: prepared.campaign.name.clone(),
        campaign_sha256: campaign_sha256.clone(),
        folder: prepared.folder.clone(),
        asked: prepared.asked.clone(),
        return_speed_m_s: return_speed_m_s(&prepared.asked, &axis.limits),
        homing_s: prepared.control.axes.map(|axis| homing_s(&axis.limits)),
        is_shaped: axis.mode_hz > 0.0,
        travel: prepared.campaign.body.as_ref().and_then(|body| body.travel),
        constants,
        load,
        twin_seed,
        decimation,
        start_unix_ns: if prepared.is_twin() { 0 } else { prepared.job.start_unix_ns },
        date: prepared.job.date.clone(),
    };
    Ok(runner::drive(&prepared.steps, &setting, rig.as_mut(), switch, operator, progress, look_at)?)
}

type Readied = (Box<dyn Rig + Send>, Load, Option<u64>);

fn rig_of(prepared: &Prepared) -> Result<Readied, CampaignError> {
    match &prepared.carriage.rig.kind {
        RigKind::Twin { seed, .. } => {
            let (twin, load) = setup::twin(&prepared.carriage, prepared.load)?;
            let rig = TwinRig::new(&twin, prepared.control, *seed).map_err(RunnerError::from)?;
            // What the campaign does not declare is not there: a real rig would have nothing to record either.
            let rig = if prepared.carriage.rig.force_sensor.is_some() { rig } else { rig.without_force_sensor() };
            Ok((Box::new(rig), load, Some(*seed)))
        }
        RigKind::Serial { port, baud } => {
            let rig = SerialRig::open(port, *baud, prepared.control).map_err(RunnerError::from)?;
            Ok((Box::new(rig), prepared.load, None))
        }
    }
}

/// Makes the folder and puts the campaign's copy there, and gives its SHA-256; a copy of another campaign is refused.
fn own_folder(folder: &Path, campaign: &Path) -> Result<String, CampaignError> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| CampaignError::Output { path, source }
    };
    std::fs::create_dir_all(folder).map_err(failed(folder))?;
    let text = read::whole(campaign, read::OWN_BYTES, "a campaign")?;
    let copy = folder.join(CAMPAIGN_COPY);
    match read::if_there(&copy, read::OWN_BYTES, "a campaign")? {
        Some(there) if there == text => {}
        Some(_) => return Err(CampaignError::OtherCampaign { folder: folder.to_owned() }),
        None => write_atomically(&copy, &text)?,
    }
    Ok(sha256_of_bytes(&text))
}
