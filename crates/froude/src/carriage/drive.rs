//! `froude run`: the pre-flight, then the campaign on the twin or the real rig.

use std::path::Path;

use froude_carriage::{forecast::foresee, live::Live};
use froude_rig::campaign::drive::drive as drive_until;
use froude_rig::campaign::prepare::prepare as prepared;
pub use froude_rig::campaign::prepare::{DriveJob, Prepared, prepare_with};
use froude_rig::campaign::runner::{Driven, Operator, Progress};
use froude_rig::campaign::stop::StopSwitch;
use froude_rig::carriage::plan::PlannedRun;

use crate::{Error, method};

/// Reads a campaign whole and checks every run of it. Nothing moves, nothing is written.
///
/// # Errors
///
/// As [`froude_rig::campaign::prepare::prepare`], and a mistake in the section of a method.
pub fn prepare(job: &DriveJob) -> Result<Prepared, Error> {
    let mut prepared = prepared(job)?;
    method::check_sections(prepared.campaign())?;
    foresee(&mut prepared);
    Ok(prepared)
}

/// Drives what passed its pre-flight until enough is known of D_d; goes on where an earlier drive into the same folder stopped.
///
/// # Errors
///
/// Objections of the pre-flight, a folder that belongs to another campaign, and whatever stops the drive.
pub fn drive(
    prepared: &Prepared,
    switch: &StopSwitch,
    operator: &mut dyn Operator,
    progress: &mut dyn Progress,
) -> Result<Driven, Error> {
    let mut live = Live::new(prepared.campaign(), prepared.carriage(), prepared.asked(), &prepared.folder);
    let mut look = |path: &Path, run: &PlannedRun| live.after(path, run);
    Ok(drive_until(prepared, switch, operator, progress, &mut look)?)
}
