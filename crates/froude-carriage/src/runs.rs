//! Runs of a carriage, read from a folder as the reductions take them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use froude_control::status::Phase;
use froude_hydro::fluid;
use froude_identify::method::MethodError;
use froude_identify::runs::{files, of_method, refuse_others};
use froude_identify::wild;
use froude_records::RecordError;
use froude_records::campaign::{BodyAxis, Campaign, Fluid};
use froude_records::finding::{Finding, Severity};
use froude_records::run::marks::SegmentKind;
use froude_records::run::{
    BodyState, CAMPAIGN_COPY, DoubtKind, Role, RunLog, RunMeta, RunReader, RunStatus, TOW, read_run_meta,
};
use froude_records::text::counted;
use froude_records::units::Dimension;
use froude_rig::carriage::DrivenCampaign;

use crate::drag::run as drag;
use crate::drag::run::Window;

mod held;
mod imported;
pub mod inspect;
pub mod set;
mod topics;
pub mod whole;

pub(crate) use imported::not_applied;
use set::{Member, doubles, is_put_aside, strangers, summed_up};
use whole::{Complete, beside, folder_of};

/// Complete runs of a folder, and what was left out.
#[derive(Debug, Clone, Default)]
pub struct Runs {
    /// The folder, or that of the first file.
    pub folder: PathBuf,
    /// Runs in the order of their names.
    pub logs: Vec<RunLog>,
    /// Runs left out, gaps, and what the campaign planned and is not there.
    pub findings: Vec<Finding>,
    /// The campaign that lies with them.
    pub campaign: Option<DrivenCampaign>,
    /// The axis of the body along the travel, as the runs declare it or else their campaign; `None` where neither does.
    pub travel: Option<BodyAxis>,
    /// How many runs of the same roles lie beside single runs that were named, and were not named; 0 where whole folders were read.
    pub beside: usize,
    /// Files that say what the runs are, where those are logs of other programs.
    pub declared_by: Vec<PathBuf>,
    /// What was named, as results are called after it.
    named: Named,
}

/// What results are called after.
#[derive(Debug, Clone, Default)]
struct Named {
    /// A folder, or a run's log.
    first: PathBuf,
    /// What was named beside it.
    more: usize,
}

impl Runs {
    /// What these runs are called where no source names them: as their own campaign calls them, else as the results `what` are.
    #[must_use]
    pub fn own_name(&self, what: &str) -> String {
        let of_folder = || {
            let beside = self.results(what);
            beside.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
        };
        self.campaign.as_ref().map_or_else(of_folder, |c| c.campaign.name.clone())
    }

    /// Where results go that nobody named a folder for: beside what was read, and called after it, so that the results of a part never
    /// take the place of the whole campaign's.
    #[must_use]
    pub fn results(&self, what: &str) -> PathBuf {
        // The folder that the program was started in has a name of its own all the same.
        let is_nameless = self.named.first.file_name().is_none();
        let whole = is_nameless.then(|| std::fs::canonicalize(&self.named.first).ok()).flatten();
        let first = whole.as_ref().unwrap_or(&self.named.first);
        let stem = if first.is_dir() { first.file_name() } else { first.file_stem() };
        let stem = stem.map_or_else(|| "runs".to_owned(), |name| name.to_string_lossy().into_owned());
        let more = if self.named.more == 0 { String::new() } else { format!("-and-{}-more", self.named.more) };
        first.with_file_name(format!("{stem}{more}-{what}"))
    }
}

/// Reads the complete tows of these roles below `paths` (folders, or single runs by their log or their sidecar). Truths of a twin are not read.
///
/// Logs of other programs whose sidecars state the method `tow` are read by what their campaign declares of the rig.
/// A log that is damaged, cut off or gone is left out with a finding, and so is said what a folder lacks of its campaign.
///
/// # Errors
///
/// A path without runs, a run that cannot be read; a run that is there twice, of another campaign than the runs beside it, or
/// whose log and sidecar were exchanged.
pub fn read(paths: &[PathBuf], roles: &[Role], campaign: Option<&Path>) -> Result<Runs, MethodError> {
    let logs = imported::logs(paths)?;
    if !logs.is_empty() {
        return imported::read(paths, &logs, roles, campaign);
    }
    let mut out = Runs { folder: first_folder(paths), ..Runs::default() };
    let (mut members, mut doubts, mut others) = (Vec::new(), Vec::new(), Vec::new());
    let mut complete = Complete::default();
    let files = files(paths)?;
    for file in &files {
        match seen(file, roles)? {
            Seen::Nothing => {}
            Seen::OfAnotherMethod(meta) => others.push(meta),
            Seen::OfAnotherRole(meta) => complete.add(file, &meta),
            Seen::LeftOut(why) => out.findings.push(why),
            Seen::Whole(log) => {
                complete.add(file, &log.meta);
                if let Some(what) = wild::sample(&log, &[]) {
                    let text = format!(
                        "{}: left out: {what}; check the sensor and its cable, and repeat the run",
                        log.meta.id
                    );
                    out.findings.push(Finding::new(Severity::Warning, "run-left-out", text));
                    continue;
                }
                members.push(Member::of(file, &log.meta)?);
                doubts.extend(log.doubts.iter().cloned());
                for gap in &log.lost {
                    let text = format!("{}: {}", log.meta.id, gap.text);
                    out.findings.push(Finding::new(Severity::Warning, "run-gap", text));
                }
                out.logs.push(*log);
            }
        }
    }
    let mut set = doubles(&members);
    set.extend(strangers(&members)?);
    if let Some(first) = set.iter().find(|f| f.severity == Severity::Error) {
        let more = set.iter().filter(|f| f.severity == Severity::Error).count() - 1;
        return Err(MethodError::NoSet { first: first.message.clone(), more });
    }
    out.findings.extend(set);
    out.findings.extend(summed_up(&doubts));
    out.take_folders(paths, &files, roles, &complete)?;
    let copy = out.folder.join(CAMPAIGN_COPY);
    let path = campaign.map(Path::to_owned).or_else(|| copy.exists().then_some(copy));
    out.campaign = path.as_deref().map(DrivenCampaign::read).transpose()?;
    out.travel = attitude(&out.logs, out.campaign.as_ref().map(|c| &c.campaign))?;
    if out.logs.is_empty() {
        refuse_others(&out.folder, TOW, &others)?;
        return Err(out.no_run(roles));
    }
    if let Some(first) = others.first() {
        let text = format!(
            "{} not of the method {TOW} and left out (the first is {}, of {})",
            counted(others.len(), "run is", "runs are"),
            first.id,
            of_method(first)
        );
        out.findings.push(Finding::new(Severity::Note, "run-of-another-method", text));
    }
    Ok(out)
}

impl Runs {
    /// Which whole folders were read, what they lack of their campaign, and what the results are called after.
    fn take_folders(
        &mut self,
        paths: &[PathBuf],
        files: &[PathBuf],
        roles: &[Role],
        complete: &Complete,
    ) -> Result<(), MethodError> {
        let singles: Vec<PathBuf> = files.iter().filter(|log| !paths.contains(&folder_of(log))).cloned().collect();
        // A calibration from another folder, beside whole folders of runs, is no part of a campaign: it is asked for its force per volt alone.
        let is_borrowed = |log: &PathBuf| {
            let role = self.logs.iter().find(|known| &known.path == log).map(|known| known.meta.role);
            role == Some(Role::Calibration) && paths.iter().any(|path| path.is_dir())
        };
        let parts: Vec<PathBuf> = singles.iter().filter(|log| !is_borrowed(log)).cloned().collect();
        self.beside = beside(&parts, roles)?.len();
        let mut folders: Vec<PathBuf> = paths.iter().filter(|path| path.is_dir()).cloned().collect();
        if self.beside == 0 {
            // All that lies there was named, one by one.
            folders.extend(parts.iter().map(|log| folder_of(log)).collect::<BTreeSet<_>>());
        }
        for folder in &folders {
            // That a campaign stopped early is said by whoever pays for it.
            let lacking = complete.against_plan(folder, roles).filter(|finding| finding.severity > Severity::Note);
            self.findings.extend(lacking);
        }
        self.named = match folders.as_slice() {
            [folder] if self.beside == 0 => Named { first: folder.clone(), more: 0 },
            _ => {
                let of_folders = paths.iter().filter(|path| path.is_dir()).count();
                let first = paths.iter().find(|path| path.is_dir()).or(singles.first());
                Named {
                    first: first.cloned().unwrap_or_default(),
                    more: (of_folders + singles.len()).saturating_sub(1),
                }
            }
        };
        Ok(())
    }

    fn no_run(&self, roles: &[Role]) -> MethodError {
        let names: Vec<&str> = roles.iter().map(|k| k.name()).collect();
        let left = match self.findings.first() {
            Some(first) => format!("; left out: {}", first.message),
            None => String::new(),
        };
        let text = format!(
            "no complete run of the roles {}; drive a campaign first: froude run CAMPAIGN.toml{left}",
            names.join(", ")
        );
        MethodError::input(&self.folder, text)
    }
}

/// What a file is to a reading of some roles.
enum Seen {
    /// Another file of TOML, or a run of another role that is not complete.
    Nothing,
    OfAnotherMethod(RunMeta),
    /// A complete run of another role.
    OfAnotherRole(RunMeta),
    LeftOut(Finding),
    Whole(Box<RunLog>),
}

fn seen(file: &Path, roles: &[Role]) -> Result<Seen, MethodError> {
    let sidecar = file.with_extension("toml");
    if sidecar.exists() {
        let meta = match read_run_meta(&sidecar) {
            // Another file of TOML that lies in the folder.
            Err(_) if !file.exists() => return Ok(Seen::Nothing),
            meta => meta?,
        };
        if let Some(seen) = by_sidecar(file, meta, roles) {
            return Ok(seen);
        }
    }
    let reader = match RunReader::open(file) {
        // A sidecar says that a run was recorded there: its log is damaged where not even its beginning is one.
        Err(error @ RecordError::Syntax { .. }) if sidecar.exists() => {
            let damaged = Finding::new(Severity::Error, "run-damaged", error.to_string());
            return Ok(Seen::LeftOut(left_out_for(damaged)));
        }
        reader => reader?,
    };
    let wanted: Vec<String> =
        reader.channels().iter().map(|c| c.0.clone()).filter(|name| !name.starts_with("truth/")).collect();
    by_log(file, reader.select(&wanted.iter().map(String::as_str).collect::<Vec<_>>())?.read_all()?, roles)
}

/// What the sidecar alone decides; `None` where the log is to be read.
fn by_sidecar(file: &Path, meta: RunMeta, roles: &[Role]) -> Option<Seen> {
    let is_whole = meta.status == RunStatus::Complete;
    if meta.method != TOW {
        return Some(Seen::OfAnotherMethod(meta));
    }
    if !roles.contains(&meta.role) {
        let counts = is_whole && file.exists() && !is_put_aside(file, &meta);
        return Some(if counts { Seen::OfAnotherRole(meta) } else { Seen::Nothing });
    }
    let why = if is_put_aside(file, &meta) {
        put_aside(file, &meta)
    } else if !is_whole {
        Finding::new(Severity::Note, "run-left-out", left_out(&meta))
    } else if !file.exists() {
        left_out_for(gone(file, &meta))
    } else {
        return None;
    };
    Some(Seen::LeftOut(why))
}

/// What the log itself says, which may have no sidecar.
fn by_log(file: &Path, log: RunLog, roles: &[Role]) -> Result<Seen, MethodError> {
    let is_whole = log.meta.status == RunStatus::Complete;
    if log.meta.method != TOW {
        return Ok(Seen::OfAnotherMethod(log.meta));
    }
    if !roles.contains(&log.meta.role) {
        return Ok(if is_whole { Seen::OfAnotherRole(log.meta) } else { Seen::Nothing });
    }
    if is_put_aside(file, &log.meta) {
        return Ok(Seen::LeftOut(put_aside(file, &log.meta)));
    }
    let doubt = |kind| log.doubts.iter().find(|doubt| doubt.kind == kind);
    if let Some(doubt) = doubt(DoubtKind::Exchanged) {
        return Err(MethodError::NoSet { first: doubt.text.clone(), more: 0 });
    }
    Ok(if let Some(doubt) = doubt(DoubtKind::Damaged) {
        Seen::LeftOut(left_out_for(doubt.finding()))
    } else if is_whole {
        Seen::Whole(Box::new(log))
    } else {
        Seen::LeftOut(Finding::new(Severity::Note, "run-left-out", left_out(&log.meta)))
    })
}

/// The axis of the body along the travel, on which the runs and their campaign must agree as far as they declare it.
fn attitude(logs: &[RunLog], campaign: Option<&Campaign>) -> Result<Option<BodyAxis>, MethodError> {
    let of_run = |log: &RunLog| {
        let sidecar = log.path.with_extension("toml");
        Some((if sidecar.exists() { sidecar } else { log.path.clone() }, "mounted", log.meta.mounted.travel?))
    };
    let of_campaign = |campaign: &Campaign| {
        let travel = campaign.body.as_ref().and_then(|body| body.travel)?;
        Some((campaign.path.clone(), "body", travel))
    };
    let mut declared = logs.iter().filter_map(of_run).chain(campaign.and_then(of_campaign));
    let Some((first, section, axis)) = declared.next() else { return Ok(None) };
    let Some((path, own_section, other)) = declared.find(|(.., other)| *other != axis) else { return Ok(Some(axis)) };
    Err(MethodError::input(
        path,
        format!(
            "`travel` in [{own_section}] is {:?}; expected {:?}, as [{section}] of {} declares: a body has one orientation along its travel. Correct \
             the one that is wrong, or reduce the runs of each orientation separately",
            other.name(),
            axis.name(),
            first.display()
        ),
    ))
}

/// What made room for another drive of the same run.
#[must_use]
pub fn put_aside(log: &Path, meta: &RunMeta) -> Finding {
    let (id, sidecar) = (&meta.id, log.with_extension("toml"));
    let again = if log.with_file_name(format!("{id}.mcap")).exists() {
        format!("{id} was driven again since")
    } else {
        format!("froude run drives {id} again")
    };
    let text = if log.exists() {
        format!("{} was set aside, and is left out; {again}", log.display())
    } else {
        format!(
            "{} was set aside and its log is missing: nothing of that drive can be read, and the file may be deleted; {again}",
            sidecar.display()
        )
    };
    Finding::new(Severity::Note, "run-left-out", text)
}

/// A finding with what became of the run.
fn left_out_for(mut finding: Finding) -> Finding {
    finding.message += ". It was left out";
    finding
}

/// A run of which only the sidecar is left.
#[must_use]
pub fn gone(log: &Path, meta: &RunMeta) -> Finding {
    let (severity, became) = match meta.status {
        RunStatus::Complete => (Severity::Error, "was completed".to_owned()),
        RunStatus::Running => (Severity::Warning, "has no end".to_owned()),
        status => (Severity::Warning, format!("is {}", status.name())),
    };
    let text = format!(
        "the log {} is gone: its sidecar says that {} {became}; copy it back, or froude run drives it again",
        log.display(),
        meta.id
    );
    Finding::new(severity, "run-gone", text)
}

/// Why a run that is not complete is left out. One that still says `running` was never closed.
fn left_out(meta: &RunMeta) -> String {
    let id = &meta.id;
    match (meta.status, meta.note.as_str()) {
        (RunStatus::Running, "") => format!(
            "{id} was never closed and was left out: it was interrupted without notice (program killed, power lost), or is being driven now; \
             froude run drives it again"
        ),
        (status, "") => format!("{id} is {} and was left out; froude run drives it again", status.name()),
        (status, note) => format!("{id} is {} and was left out: {note}", status.name()),
    }
}

fn first_folder(paths: &[PathBuf]) -> PathBuf {
    let first = paths.first().cloned().unwrap_or_default();
    if first.is_dir() { first } else { first.parent().map_or_else(PathBuf::new, Path::to_owned) }
}

/// State of an exciting axis in a log.
pub const EXCITING: f64 = Phase::Exciting as u8 as f64;

/// Largest number in a channel of a carriage, SI: no carriage goes a thousand kilometres or pulls a meganewton.
const LARGEST: f64 = 1e6;

/// Whether a number is beyond any carriage.
pub(crate) fn implausible(x: f64) -> bool {
    x.is_nan() || x.abs() > LARGEST
}

/// A channel of a run, checked against what a carriage can reach.
///
/// # Errors
///
/// No such channel, another dimension, or a sample that no carriage has.
pub fn column<'l>(log: &'l RunLog, name: &str, dimension: Dimension) -> Result<&'l [f64], MethodError> {
    let values = log.channel(name, dimension)?;
    match values.iter().position(|x| implausible(*x)) {
        None => Ok(values),
        Some(i) => Err(MethodError::input(
            &log.path,
            format!(
                "{name} is {:e} {dimension} at {:.3} s, which no carriage reaches: the log is damaged, or its unit is wrong",
                values[i],
                log.time_s.get(i).copied().unwrap_or(f64::NAN)
            ),
        )),
    }
}

/// What drives a run, in the unit that its force is known for: the command, V, or of a log without one the current, A.
///
/// # Errors
///
/// As [`column()`].
pub fn drive(log: &RunLog) -> Result<&[f64], MethodError> {
    let [command, current] = ["command", "current"].map(|name| format!("{}/{name}", log.meta.carriage.axis.name()));
    if !log.channels.contains_key(&command) && log.channels.contains_key(&current) {
        return column(log, &current, Dimension::CURRENT);
    }
    column(log, &command, Dimension::VOLTAGE)
}

/// The rows that are declared to be steady.
fn window_of(log: &RunLog) -> Option<Window> {
    let steady = log.meta.declared.segments.iter().find(|segment| segment.kind == SegmentKind::Steady)?;
    let first = log.time_s.partition_point(|t| *t < steady.from_s);
    let end = log.time_s.partition_point(|t| *t <= steady.to_s);
    (end > first).then_some(Window { first, end })
}

/// A run as the reductions of drag and calibration take it; `None` for runs that are neither.
///
/// # Errors
///
/// A channel that is missing or of another dimension.
pub fn for_drag(log: &RunLog) -> Result<Option<drag::DragRun<'_>>, MethodError> {
    let meta = &log.meta;
    let kind = match meta.role {
        Role::Dry | Role::Wet => drag::RunKind::Tow,
        Role::Friction => drag::RunKind::Friction,
        Role::Calibration => drag::RunKind::Calibration,
        _ => return Ok(None),
    };
    let (Some(target_speed_m_s), Some(direction)) = (meta.carriage.target_speed_m_s, meta.carriage.direction) else {
        return Ok(None);
    };
    let axis = meta.carriage.axis.name();
    let column = |name: &str, dimension| column(log, &format!("{axis}/{name}"), dimension);
    let force_n = if log.channels.contains_key("force") && axis == "y" {
        Some(self::column(log, "force", Dimension::FORCE)?)
    } else {
        None
    };
    Ok(Some(drag::DragRun {
        id: &meta.id,
        time_s: &log.time_s,
        position_m: column("position", Dimension::LENGTH)?,
        reference_speed_m_s: column("reference_velocity", Dimension::SPEED)?,
        command_v: drive(log)?,
        held: window_of(log),
        force_n,
        kind,
        body: meta.mounted.body,
        target_speed_m_s,
        direction: direction.sign(),
        pair: meta.carriage.pair.unwrap_or(0),
        is_ballasted: meta.mounted.is_ballasted,
        hung_weight_n: meta.mounted.hung_weight_n,
    }))
}

/// Density of the campaign's water, kg/m³; fresh water at 20 °C where none is declared.
#[must_use]
pub fn density_kg_m3(campaign: Option<&Campaign>) -> f64 {
    let fluid = campaign.map(|c| &c.fluid);
    let of = |value: fn(&Fluid) -> Option<f64>| fluid.and_then(value);
    fluid::density_kg_m3(of(|f| f.density_kg_m3), of(|f| f.temperature_degc), of(|f| f.salinity_g_kg))
}

/// What rode on the carriage, for a heading: ", bare carriage", ", body dry and body wet"; empty where no run says.
#[must_use]
pub fn mounted(mounts: &[BodyState]) -> String {
    let name = |body: &BodyState| match body {
        BodyState::None => "bare carriage",
        BodyState::Dry => "body dry",
        BodyState::Wet => "body wet",
    };
    let names: Vec<&str> = mounts.iter().map(name).collect();
    if names.is_empty() { String::new() } else { format!(", {}", names.join(" and ")) }
}

/// What rides on the carriage in these runs, each state once.
pub fn mounts<'a>(logs: impl IntoIterator<Item = &'a RunLog>) -> Vec<BodyState> {
    let mut out: Vec<BodyState> = Vec::new();
    for log in logs {
        if !out.contains(&log.meta.mounted.body) {
            out.push(log.meta.mounted.body);
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use froude_records::campaign::BodySpec;
    use froude_records::run::Mounted;

    use super::*;

    #[test]
    fn the_attitude_is_that_of_the_runs_or_else_of_the_campaign_and_one_for_all() {
        let log = |path: &str, travel| {
            let mounted = Mounted { travel, ..Mounted::default() };
            RunLog { path: path.into(), meta: RunMeta { mounted, ..RunMeta::default() }, ..RunLog::default() }
        };
        let campaign = |travel| {
            let body = Some(BodySpec { travel, ..BodySpec::default() });
            Campaign { body, ..Campaign::of_table(Path::new("campaign.toml"), None) }
        };
        let (x, y) = (Some(BodyAxis::X), Some(BodyAxis::Y));
        let of = |runs: [Option<BodyAxis>; 2], declared| {
            let logs = [log("045-wet.mcap", runs[0]), log("046-wet.mcap", runs[1])];
            attitude(&logs, Some(&campaign(declared))).map_err(|error| error.to_string())
        };
        assert_eq!(of([None, None], None), Ok(None));
        assert_eq!(of([None, None], y), Ok(y));
        assert_eq!(of([None, x], None), Ok(x));
        assert_eq!(of([x, x], x), Ok(x));
        let told = |file: &str, section: &str| {
            Err(format!(
                "{file}: `travel` in [{section}] is \"y\"; expected \"x\", as [mounted] of 045-wet.mcap declares: a body has one orientation along \
                 its travel. Correct the one that is wrong, or reduce the runs of each orientation separately"
            ))
        };
        assert_eq!(of([x, y], None), told("046-wet.mcap", "mounted"));
        assert_eq!(of([x, None], y), told("campaign.toml", "body"));
    }

    #[test]
    fn a_run_that_was_never_closed_says_what_became_of_it() {
        let mut meta = RunMeta { id: "084-wet".to_owned(), status: RunStatus::Running, ..RunMeta::default() };
        let told = left_out(&meta);
        assert!(told.contains("was never closed and was left out: it was interrupted without notice"), "{told}");
        meta.status = RunStatus::Interrupted;
        "stopped by the operator".clone_into(&mut meta.note);
        assert!(left_out(&meta).ends_with("is interrupted and was left out: stopped by the operator"));
    }
}
