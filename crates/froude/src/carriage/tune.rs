//! `froude carriage tune` and `froude carriage resonance`: experiments on the loop, driven, recorded and read.
//!
//! Tune: a relay's limit cycle and a sweep on the bare carriage, read by [`froude_carriage::tuning::choice`]. Resonance: the same sweep bare, dry and
//! wet, read by [`froude_carriage::tuning::modes`]. Both write a record, so that loops and modes of two days are compared like any other estimates.

use std::path::{Path, PathBuf};

use froude_carriage::runs::{Runs, read};
use froude_carriage::source::files_of;
use froude_carriage::tuning::candidate::ConfiguredLoop;
use froude_carriage::tuning::choice::{self, Tuned, tuned};
use froude_carriage::tuning::modes::{self, CarriageModes, modes_of};
use froude_records::carriage::plan::{Experiments, resonance, tuning};
use froude_records::estimate::{Estimate, EstimateFile};
use froude_records::page::DocumentSection;
use froude_records::run::Role;
use froude_report::document::Document;
use froude_rig::campaign::runner::{Operator, Progress};
use froude_rig::campaign::stop::StopSwitch;

use super::drive::{DriveJob, Prepared, drive, prepare_with};
use crate::Error;
use crate::data_files::DataFiles;
use crate::results::{self, Written};

/// The sweep below the margins, Hz: from well below the chain to well above the crossover of a loop that is stiff against it.
const TUNING_HZ: [f64; 2] = [2.0, 150.0];

/// What an experiment found, and where it is written.
#[derive(Debug, Clone)]
pub struct Experimented<T> {
    /// What it found.
    pub found: T,
    /// The record.
    pub file: EstimateFile,
    /// Where record and page lie.
    pub written: Written,
}

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
) -> Result<Experimented<Tuned>, Error> {
    let experiments = Experiments { sweep_hz: TUNING_HZ, ..Experiments::default() };
    let prepared = prepare_with(&with_folder(job, "tune"), &|asked, start_m, _| tuning(asked, start_m, &experiments))?
        .logging_every_tick();
    results::can_be_written(&report_of(&prepared))?;
    drive(&prepared, switch, operator, progress)?.whole()?;
    let runs = read(std::slice::from_ref(&prepared.folder), &[Role::Relay, Role::Sweep], None)?;
    let of =
        ConfiguredLoop { axis: prepared.axis(), tick_us: prepared.tick_us(), hardest_ramp: prepared.hardest_ramp() };
    let found = tuned(&runs.logs, of, &experiments)?;
    // The margins are read off the sweep, the gains by Ziegler and Nichols off the relay.
    let estimates = choice::record::estimates(prepared.name(), &found).into_iter().map(|e| (e, None)).collect();
    let (file, written) =
        write(&prepared, &runs, estimates, choice::page::section(&found), ("Carriage · tuning", &job.date))?;
    Ok(Experimented { found, file, written })
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
) -> Result<Experimented<CarriageModes>, Error> {
    let experiments = Experiments::default();
    let prepared =
        prepare_with(&with_folder(job, "resonance"), &|asked, start_m, _| resonance(asked, start_m, &experiments))?;
    results::can_be_written(&report_of(&prepared))?;
    drive(&prepared, switch, operator, progress)?.whole()?;
    let runs = read(std::slice::from_ref(&prepared.folder), &[Role::Sweep], None)?;
    let drive = &prepared.axis().drive;
    let rad_m = drive.gear_ratio / drive.sprocket_radius_m;
    let found = modes_of(&runs.logs, rad_m, prepared.efficiency(), &experiments)?;
    let estimates = modes::record::estimates(prepared.name(), &found);
    let estimates = estimates.into_iter().map(|(state, estimate)| (estimate, Some(state))).collect();
    let (file, written) =
        write(&prepared, &runs, estimates, modes::page::section(&found), ("Carriage · resonance", &job.date))?;
    Ok(Experimented { found, file, written })
}

fn with_folder(job: &DriveJob, what: &str) -> DriveJob {
    let stem = job.campaign.file_stem().map_or_else(|| "campaign".to_owned(), |s| s.to_string_lossy().into_owned());
    let out = job.out.clone().unwrap_or_else(|| job.campaign.with_file_name(format!("{stem}-{what}")));
    DriveJob { out: Some(out), ..job.clone() }
}

/// Beside the runs, in a folder of its own: it is replaced as a whole, and runs never are.
fn report_of(prepared: &Prepared) -> PathBuf {
    prepared.folder.join("report")
}

/// Writes the record and the page; each estimate is of one of the runs, by its index, or of all.
fn write(
    prepared: &Prepared,
    runs: &Runs,
    estimates: Vec<(Estimate, Option<usize>)>,
    section: DocumentSection,
    (sort, date): (&str, &str),
) -> Result<(EstimateFile, Written), Error> {
    let named = |path: &Path| path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let mut files = DataFiles::new(&named);
    let all = files_of(runs);
    let mut out = Vec::new();
    for (mut estimate, run) in estimates {
        let read = run.and_then(|i| all.get(i..=i)).unwrap_or(&all);
        estimate.data = files.keys_of(read, |_| true)?;
        out.push(estimate);
    }
    let file = EstimateFile {
        data: files.into_map(),
        findings: runs.findings.clone(),
        versions: results::versions(),
        ..EstimateFile::of(out)
    };
    let document = Document {
        sort: sort.to_owned(),
        title: prepared.name().to_owned(),
        date: Some(date.to_owned()),
        sections: vec![section],
        findings: runs.findings.clone(),
        ..Document::default()
    };
    let written = results::write(&report_of(prepared), &file, &[], &[], &[], &document.html()?)?;
    Ok((file, written))
}
