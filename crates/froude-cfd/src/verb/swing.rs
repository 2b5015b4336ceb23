//! `froude cfd swing`: the planned runs of a forced oscillation by OpenFOAM, as logs that `froude identify` takes like those of a tank.
//!
//! A run is done when its log and its sidecar are in the folder of the runs; the sidecar is written last, and holds the hash of the run's inputs. Its flow is in a folder beside, which is emptied when the run is begun again. Runs are named by what they are, so that a plan that grows keeps them. A run that fails stops no other.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use froude_identify::method::{Export, MethodError};
use froude_records::RecordError;
use froude_records::block::{Block, TableBuilder, facts};
use froude_records::campaign::{Campaign, Input, Source, SourceKind};
use froude_records::campaign_file::read_campaign;
use froude_records::hash::sha256_of_bytes;
use froude_records::outcome::{Exit, Outcome};
use froude_records::output::inside;
use froude_records::read;
use froude_records::text::counted;
use froude_records::write::write_atomically;

use super::asked::Asked;
use super::bodies;
use super::error::VerbError;
use super::meshes::{MESHES, of_body};
use super::run::stopped;
use crate::case::{Case, Flow, Stop};
use crate::lock::Lock;
use crate::matrix::model;
use crate::openfoam::OpenFoam;
use crate::orphans;
use crate::oscillation::{Period, Swing, swing as compute};
use crate::section::{CFD, declared};
use crate::solve::{How, Progress};
use crate::store::check_links;

/// The section of a source whose runs swing.
const FORCED_OSCILLATION: &str = "forced_oscillation";
/// Steps of time in a period.
const STEPS: usize = 200;
/// Marks the folder of a run's flow as one that a swing computes.
const MARK: &str = "froude-swing";
/// What the sidecar of a computed run says before the hash of its inputs.
const STAMP: &str = "Computed by froude cfd swing from the inputs ";

/// A run of a forced oscillation that is to be computed.
#[derive(Debug, Clone, PartialEq)]
pub struct SwungRun {
    /// Its name.
    pub id: String,
    /// Its configuration.
    pub configuration: String,
    /// From the pivot to the body, m.
    pub radius_m: f64,
    /// Amplitude of the angle, rad.
    pub amplitude_rad: f64,
    /// Angular frequency, rad/s.
    pub omega_rad_s: f64,
    /// Speed forward, m/s.
    pub forward_m_s: f64,
    /// Periods; a part counts as one.
    pub periods: f64,
    /// Mass of the body on the rig, kg.
    pub mass_kg: f64,
    /// Its buoyancy, N.
    pub buoyancy_n: Option<f64>,
    /// Volume that C_A refers to, m³.
    pub volume_m3: f64,
}

/// Log and sidecar of a run by its place in the plan, from times, s, and forces of the water across, N, with a line for people.
type Files = Box<dyn Fn(usize, &[f64], &[f64], &str) -> [Export; 2] + Sync>;

/// What a source plans.
pub struct Planned {
    /// The runs.
    pub runs: Vec<SwungRun>,
    /// Configurations of the source.
    pub configurations: Vec<String>,
    /// Of the water, kg/m³.
    pub density_kg_m3: f64,
    /// Writes logs as those of a tank are written.
    pub files: Files,
}

/// A run that was computed, or was there.
struct Run<'a> {
    job: &'a Job,
    /// What its last period says of added mass and damping, and the time of a processor, s; `None` of a run that was there.
    last: Option<(Option<Period>, f64)>,
}

/// One run with all that its computation takes.
struct Job {
    /// Its place in the plan.
    place: usize,
    planned: SwungRun,
    case: Case,
    swing: Swing,
    mesh: PathBuf,
    /// Across the motion, m.
    height_m: f64,
    stamp: String,
}

/// Computes the runs of a campaign's forced oscillation that have no log yet, `jobs` at a time. `now` is told the progress; `plan` returns the runs of a source.
///
/// # Errors
///
/// A campaign without such a source, or that does not say how its flow is computed; OpenFOAM is not installed; logs that the plan does not have, or that other inputs gave; another process computes it.
pub fn swing(
    campaign: &Path,
    name: Option<&str>,
    jobs: usize,
    cancel: &AtomicBool,
    now: &(dyn Fn(&str) + Sync),
    plan: &dyn Fn(&Campaign, &Source) -> Result<Planned, MethodError>,
) -> Result<Outcome, VerbError> {
    let read = read_campaign(campaign)?;
    let source = chosen(&read, name)?;
    let planned = plan(&read, source)?;
    let runs = source.input.path();
    inside(campaign, runs, &source.place, "runs", "froude cfd swing")?;
    let folder = runs.with_file_name(format!("{}-cfd", runs.file_name().unwrap_or_default().to_string_lossy()));
    inside(campaign, &folder, &source.place, "runs", "froude cfd swing")?;
    check_links(&folder)?;
    let asked = Asked::of(&read, source, folder)?;
    let openfoam = OpenFoam::find()?;
    for path in [&asked.folder, runs] {
        std::fs::create_dir_all(path).map_err(|source| RecordError::output(path, &source))?;
    }
    let all = prepared(&asked, &planned, cancel, now)?;
    let _lock = Lock::take(&asked.folder)?;
    let of = |job: &Job, end: &str| runs.join(format!("{}.{end}", job.planned.id));
    let is_open = |job: &&Job| !(of(job, "toml").exists() && of(job, "csv").exists());
    check_logs(runs, &all)?;
    let open: Vec<&Job> = all.iter().filter(is_open).collect();
    let work = Work { folder: &asked.folder, runs, files: &planned.files, openfoam: &openfoam, cancel, now };
    let (done, failed) = work.every(&open, jobs);
    let row = |job| {
        let found = done.iter().find(|(id, _)| *id == Job::id(job));
        Run { job, last: found.map(|(_, found)| *found) }
    };
    let ended: Vec<Run<'_>> = all.iter().filter(|job| !is_open(job)).map(row).collect();
    let exit = if cancel.load(Ordering::Relaxed) && ended.len() + failed.len() < all.len() {
        stopped("swing", campaign)
    } else if failed.is_empty() {
        Exit::Done
    } else {
        Exit::Failed(format!("{} of the runs failed, each for the reason above; the others are done", failed.len()))
    };
    let blocks = blocks(runs, &ended, all.len() - ended.len(), &failed, planned.density_kg_m3, &exit);
    Ok(Outcome { blocks, exit, ..Outcome::default() })
}

/// Everything in the folder of the runs must be of this plan and of these inputs: `froude identify` fits whatever lies there.
fn check_logs(runs: &Path, all: &[Job]) -> Result<(), VerbError> {
    let failed = |source| RecordError::output(runs, &source);
    for entry in std::fs::read_dir(runs).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let job = all.iter().find(|job| path.file_stem().is_some_and(|stem| *stem == *job.planned.id));
        let is_sidecar = path.extension().is_some_and(|end| end == "toml");
        let has_stamp = |job: &Job| {
            read::text(&path, read::OWN_BYTES, "a sidecar")
                .is_ok_and(|text| text.starts_with(&format!("# {}\n", job.stamp)))
        };
        if job.is_none_or(|job| is_sidecar && !has_stamp(job)) {
            let problem = "is not of a run that this plan computes from these inputs, and froude identify would fit it with the others; take the run's log and sidecar away, or name another folder in `runs`";
            return Err(VerbError::input(&path, problem));
        }
    }
    Ok(())
}

/// The only computed source that is a forced oscillation and says how its flow is computed, or the one of a name.
fn chosen<'a>(campaign: &'a Campaign, name: Option<&str>) -> Result<&'a Source, VerbError> {
    let refused = |problem: &str| Err(VerbError::input(&campaign.path, problem.to_owned()));
    let is_it = |s: &&Source| {
        s.kind == SourceKind::Cfd
            && s.has_section(FORCED_OSCILLATION)
            && s.has_section(CFD)
            && matches!(s.input, Input::Runs { .. })
    };
    let found: Vec<&Source> =
        campaign.sources.iter().filter(is_it).filter(|s| name.is_none_or(|name| s.name == name)).collect();
    match found[..] {
        [only] => {
            if declared(only)?.is_some_and(|s| s.tank.is_some() || s.fine.is_some() || !s.study.is_empty()) {
                return refused(
                    "asks for a tank, a finer mesh or a study of a body that swings; take tank, fine and study out of [source.cfd]: mesh and step are varied by hand",
                );
            }
            Ok(only)
        }
        [] => refused(
            "has no source that swings and says how its flow is computed: write kind = \"cfd\", method = \"forced_oscillation\", runs = \"runs\", [source.forced_oscillation], [[source.plan]] and [source.cfd] with a body",
        ),
        _ => {
            let names = found.iter().map(|s| format!("{:?}", s.name)).collect::<Vec<_>>().join(", ");
            refused(&format!("has the sources {names} that swing; say which with --source"))
        }
    }
}

/// Makes the meshes and prepares the case of each run.
fn prepared(
    asked: &Asked,
    planned: &Planned,
    cancel: &AtomicBool,
    now: &(dyn Fn(&str) + Sync),
) -> Result<Vec<Job>, VerbError> {
    let mut meshed = Vec::new();
    bodies::each(asked, &planned.configurations, &mut |body| {
        if cancel.load(Ordering::SeqCst) {
            return Err(VerbError::Stopped);
        }
        meshed.extend(of_body(asked, &body, cancel, now)?);
        Ok(())
    })?;
    let job = |(place, planned): (usize, &SwungRun)| {
        let body = meshed.iter().find(|group| group.meshed.configuration == planned.configuration)?;
        let swing = Swing {
            amplitude_m: [0.0, planned.radius_m * planned.amplitude_rad, 0.0],
            frequency_hz: planned.omega_rad_s / std::f64::consts::TAU,
            forward_m_s: planned.forward_m_s,
            steps: STEPS,
            periods: planned.periods.ceil() as usize,
        };
        let speed_m_s = swing.speed_m_s().hypot(swing.forward_m_s);
        let reynolds = speed_m_s * body.meshed.reference.width_m / asked.water.viscosity_m2_s;
        let case = Case {
            id: planned.id.clone(),
            configuration: planned.configuration.clone(),
            mesh: body.meshed.mesh.clone(),
            is_half: asked.spec.is_half,
            flow: Flow { speed_m_s, angle_rad: 0.0, pitch_rad: 0.0 },
            water: asked.water,
            model: model(&asked.spec, reynolds),
            stop: Stop { iterations: 1, window: 1, drift: 0.0, spread: 0.0 },
            reference: body.meshed.reference,
            start_from: None,
        };
        let rig = (planned.mass_kg, planned.buoyancy_n);
        // The log has the angle, which the swing knows only times the radius.
        let inputs = format!("{} {swing:?} {rig:?} {}", case.hash(), planned.amplitude_rad);
        let stamp = format!("{STAMP}{}", sha256_of_bytes(inputs.as_bytes()));
        let mesh = asked.folder.join(MESHES).join(&case.mesh);
        Some(Job { place, planned: planned.clone(), mesh, case, swing, height_m: body.height_m, stamp })
    };
    Ok(planned.runs.iter().enumerate().filter_map(job).collect())
}

impl Job {
    fn id(&self) -> &str {
        &self.planned.id
    }
}

/// What all runs share.
struct Work<'a> {
    /// Of their flows.
    folder: &'a Path,
    /// Of their logs.
    runs: &'a Path,
    files: &'a Files,
    openfoam: &'a OpenFoam,
    cancel: &'a AtomicBool,
    now: &'a (dyn Fn(&str) + Sync),
}

/// The last period of each run that was computed, with its cost; and those that failed, with the reason. What was cancelled is in neither.
type Found = (Vec<(String, (Option<Period>, f64))>, Vec<(String, String)>);

impl Work<'_> {
    fn every(&self, open: &[&Job], jobs: usize) -> Found {
        let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
        let found: Mutex<Found> = Mutex::default();
        let work = || {
            while !self.cancel.load(Ordering::Relaxed) {
                let Some(job) = open.get(next.fetch_add(1, Ordering::Relaxed)) else { return };
                let tell = |p: Progress| {
                    let (ended, all) = (done.load(Ordering::Relaxed), open.len());
                    (self.now)(&format!(
                        "{ended} of {all} runs done; {} at step {} of {}",
                        job.case.id, p.iteration, p.of
                    ));
                };
                let how = How { openfoam: self.openfoam, ranks: 1, cancel: self.cancel, tell: &tell };
                let one = self.one(job, &how);
                done.fetch_add(1, Ordering::Relaxed);
                let (ended, failed) = &mut *found.lock().unwrap_or_else(PoisonError::into_inner);
                match one {
                    Ok(last) => ended.extend(last.map(|last| (job.planned.id.clone(), last))),
                    Err(error) => failed.push((job.planned.id.clone(), error.to_string())),
                }
            }
        };
        std::thread::scope(|scope| {
            for _ in 0..jobs.min(open.len()) {
                scope.spawn(work);
            }
        });
        found.into_inner().unwrap_or_else(PoisonError::into_inner)
    }

    /// Computes a run and writes its log; `None` where it was cancelled.
    fn one(&self, job: &Job, how: &How<'_>) -> Result<Option<(Option<Period>, f64)>, VerbError> {
        let own = self.folder.join(&job.planned.id);
        orphans::end(&own);
        let failed = |source| RecordError::output(&own, &source);
        // What was begun carries a mark; anything else of this name is somebody's.
        let mark = own.join(MARK);
        if mark.exists() {
            std::fs::remove_dir_all(&own).map_err(failed)?;
        } else if std::fs::read_dir(&own).is_ok_and(|mut entries| entries.next().is_some()) {
            let problem = "was not written by froude cfd swing and would be emptied; move it away";
            return Err(VerbError::input(&own, problem));
        }
        std::fs::create_dir_all(&own).map_err(failed)?;
        write_atomically(&mark, job.stamp.as_bytes())?;
        let swung = match compute(&job.case, &job.swing, &job.mesh, &own, how) {
            Ok(swung) => swung,
            Err(error) if error.is_cancelled() => return Ok(None),
            Err(error) => return Err(VerbError::input(&own, error.to_string())),
        };
        let time_s: Vec<f64> = swung.samples.iter().map(|s| s.time).collect();
        let fluid_n: Vec<f64> = swung.samples.iter().map(|s| s.total()[1]).collect();
        for file in (self.files)(job.place, &time_s, &fluid_n, &job.stamp) {
            write_atomically(&self.runs.join(&file.name), &file.content)?;
        }
        Ok(Some((swung.periods.last().copied(), swung.cpu_s)))
    }
}

fn blocks(
    folder: &Path,
    runs: &[Run<'_>],
    open: usize,
    failed: &[(String, String)],
    density_kg_m3: f64,
    exit: &Exit,
) -> Vec<Block> {
    let f = facts("", "", &folder);
    let about = f.build(vec![
        f.text("folder", "", |folder| folder.display().to_string()),
        f.count("open", "", |_| open),
        f.flag("was_cancelled", "", |_| matches!(exit, Exit::Stopped(_))),
    ]);
    let t = TableBuilder::new("runs", format!("runs in {}; — of those that were there", folder.display()), runs);
    let last = |run: &Run<'_>| run.last.and_then(|(last, _)| last);
    let added = |run: &Run<'_>| last(run).map(|last| last.added_mass_kg / (density_kg_m3 * run.job.planned.volume_m3));
    let computed = t.build(vec![
        t.text("run", "run", |run| run.job.planned.id.clone()),
        t.text("configuration", "body", |run| run.job.case.configuration.clone()),
        t.number("amplitude_m", "amplitude [m]", |run| run.job.swing.amplitude_m[1]).significant(3),
        t.number("frequency_hz", "frequency [Hz]", |run| run.job.swing.frequency_hz).significant(3),
        t.number("forward_m_s", "forward [m/s]", |run| run.job.swing.forward_m_s).significant(3),
        t.number("keulegan_carpenter", "KC", |run| run.job.swing.keulegan_carpenter(run.job.height_m)).significant(3),
        t.number("stokes", "β", |run| run.job.swing.stokes(run.job.height_m, run.job.case.water.viscosity_m2_s))
            .significant(3),
        t.number("added_mass_kg", "", |run| last(run).map(|last| last.added_mass_kg)),
        t.number("C_A", "C_A", added),
        t.number("damping_n_s_m", "damping [N s/m]", |run| last(run).map(|last| last.damping_n_s_m)).significant(3),
        t.number("cpu_s", "CPU [s]", |run| run.last.map(|(_, cpu_s)| cpu_s)).significant(3),
    ]);
    let t = TableBuilder::new("failed", "", failed);
    let why = t.build(vec![t.text("run", "", |(id, _)| id.clone()), t.text("reason", "", |(_, why)| why.clone())]);
    let mut said = if runs.is_empty() {
        Vec::new()
    } else {
        vec!["C_A and damping are of the last period alone, by its first harmonic; froude identify fits all runs at once, with the drag law and intervals. No interval holds the error of the mesh and of the step: compute a finer mesh, and see.".to_owned()]
    };
    said.extend(failed.iter().map(|(id, why)| format!("{id} failed: {why}")));
    if open > 0 {
        said.push(format!("{} no log yet", counted(open, "run has", "runs have")));
    }
    vec![about.into(), computed.into(), why.into(), Block::text("", said)]
}
