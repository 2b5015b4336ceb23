//! `froude carriage tune` and `froude carriage resonance`: experiments on the loop, driven, recorded, and read as any other runs.
//!
//! Tune: a relay's limit cycle and a sweep on the bare carriage. Resonance: the same sweep bare, dry and wet.

use froude_rig::campaign::runner::{Operator, Progress};
use froude_rig::campaign::stop::StopSwitch;
use froude_rig::carriage::plan::{Experiments, resonance, tuning};

use froude_carriage::tuning::source::{Resonance, Tuning};
use froude_identify::method::Method;

use super::drive::{DriveJob, Prepared, drive, prepare_with};
use crate::pipeline::{Identified, Input, Job, identify};
use crate::{Error, results};

/// The sweep below the margins, Hz: from well below the chain to well above the crossover of a loop that is stiff against it.
const TUNING_HZ: [f64; 2] = [2.0, 150.0];

/// Drives relay and sweep, and proposes gains; the record has the margins of each.
///
/// # Errors
///
/// See [`Error`].
pub fn tune(
    job: &DriveJob,
    switch: &StopSwitch,
    operator: &mut dyn Operator,
    progress: &mut dyn Progress,
) -> Result<Identified, Error> {
    let experiments = Experiments { sweep_hz: TUNING_HZ, ..Experiments::default() };
    let prepared = prepare_with(&with_folder(job, "tune"), &|asked, start_m, _| tuning(asked, start_m, &experiments))?
        .logging_every_tick();
    driven(&prepared, &Tuning, &job.date, switch, operator, progress)
}

/// Drives a sweep bare, dry and wet, and proposes a shaper; the record has the modes of each.
///
/// # Errors
///
/// See [`Error`].
pub fn find_resonance(
    job: &DriveJob,
    switch: &StopSwitch,
    operator: &mut dyn Operator,
    progress: &mut dyn Progress,
) -> Result<Identified, Error> {
    let experiments = Experiments::default();
    let prepared =
        prepare_with(&with_folder(job, "resonance"), &|asked, start_m, _| resonance(asked, start_m, &experiments))?;
    driven(&prepared, &Resonance, &job.date, switch, operator, progress)
}

fn with_folder(job: &DriveJob, what: &str) -> DriveJob {
    let stem = job.campaign.file_stem().map_or_else(|| "campaign".to_owned(), |s| s.to_string_lossy().into_owned());
    let out = job.out.clone().unwrap_or_else(|| job.campaign.with_file_name(format!("{stem}-{what}")));
    DriveJob { out: Some(out), ..job.clone() }
}

/// Drives and reads; the results lie beside the runs, in a folder of their own: it is replaced as a whole, and runs never are.
fn driven(
    prepared: &Prepared,
    method: &'static dyn Method,
    date: &str,
    switch: &StopSwitch,
    operator: &mut dyn Operator,
    progress: &mut dyn Progress,
) -> Result<Identified, Error> {
    let out = prepared.folder.join("report");
    results::can_be_written(&out)?;
    drive(prepared, switch, operator, progress)?.whole()?;
    let input = Input::Runs { paths: vec![prepared.folder.clone()], campaign: None };
    identify(&Job { out: Some(out), method: Some(method), date: Some(date.to_owned()), ..Job::of(input) }, &|_| {})
}
