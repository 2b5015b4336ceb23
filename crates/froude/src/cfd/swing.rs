//! `froude cfd swing`: the planned runs of a forced oscillation by OpenFOAM, as logs that `froude identify` takes like those of a tank.
//!
//! A run is done when its log and its sidecar are in the folder of the runs; the sidecar is written last, and holds the hash of the run's inputs. Its flow is in a folder beside, which is emptied when the run is begun again. Runs are named by what they are, so that a plan that grows keeps them. A run that fails stops no other.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use froude_cfd::case::{Case, Flow, Stop};
use froude_cfd::lock::Lock;
use froude_cfd::matrix::model;
use froude_cfd::openfoam::OpenFoam;
use froude_cfd::orphans;
use froude_cfd::oscillation::{Period, Swing, swing as compute};
use froude_cfd::solve::{How, Progress};
use froude_cfd::store::check_links;
use froude_records::RecordError;
use froude_records::campaign::{Input, Source, SourceKind, read_campaign};
use froude_records::hash::sha256_of_bytes;
use froude_records::number::significant;
use froude_records::output::inside;
use froude_records::page::{DocumentSection, TextTable};
use froude_records::read;
use froude_records::text::counted;
use froude_records::write::write_atomically;
use froude_tank::oscillation::computed;
use froude_tank::oscillation::setup::Setup;
use froude_tank::oscillation::simulate::Planned;
use serde_json::{Value, json};

use super::meshes::of_body;
use super::{Asked, CfdInput, MESHES, bodies};
use crate::Error;

/// Steps of time in a period.
const STEPS: usize = 200;
/// Marks the folder of a run's flow as one that a swing computes.
const MARK: &str = "froude-swing";
/// What the sidecar of a computed run says before the hash of its inputs.
const STAMP: &str = "Computed by froude cfd swing from the inputs ";

/// A run that was computed, or was there.
#[derive(Debug, Clone, PartialEq)]
pub struct Run {
    /// Its name.
    pub id: String,
    /// Its configuration; empty where the body has only one.
    pub configuration: String,
    /// Amplitude of the swing, m.
    pub amplitude_m: f64,
    /// Frequency, Hz.
    pub frequency_hz: f64,
    /// Speed forward, m/s.
    pub forward_m_s: f64,
    /// Keulegan-Carpenter number 2πA/D of the height D, which lies across the motion \[-\].
    pub keulegan_carpenter: f64,
    /// Stokes number f D²/ν likewise \[-\].
    pub stokes: f64,
    /// What its last period says of added mass and damping; `None` of a run that was there.
    pub last: Option<Period>,
    /// Time of a processor, s; likewise.
    pub cpu_s: Option<f64>,
}

/// What was computed.
#[derive(Debug, Clone, PartialEq)]
pub struct Swung {
    /// The folder of the logs.
    pub folder: PathBuf,
    /// All planned runs that have a log.
    pub runs: Vec<Run>,
    /// Planned runs without one.
    pub open: usize,
    /// Runs that failed now, and why.
    pub failed: Vec<(String, String)>,
    /// Whether it was stopped.
    pub was_cancelled: bool,
    volume_m3: Vec<f64>,
    density_kg_m3: f64,
}

/// One run with all that its computation takes.
struct Job {
    planned: Planned,
    case: Case,
    swing: Swing,
    mesh: PathBuf,
    /// Across the motion, m.
    height_m: f64,
    stamp: String,
}

/// Computes the runs of a campaign's forced oscillation that have no log yet, `jobs` at a time. `now` hears how far it is.
///
/// # Errors
///
/// A campaign without such a source, or that does not say how its flow is computed; OpenFOAM is not there; logs that the plan does not have, or that other inputs gave; another process computes it.
pub fn swing(
    campaign: &Path,
    name: Option<&str>,
    jobs: usize,
    cancel: &AtomicBool,
    now: &(dyn Fn(&str) + Sync),
) -> Result<Swung, Error> {
    let read = read_campaign(campaign)?;
    let source = chosen(&read.sources, name).map_err(|problem| CfdInput { path: campaign.to_owned(), problem })?;
    let (setup, planned) = computed::asked(&read, source).map_err(Error::Method)?;
    let runs = source.input.path();
    inside(campaign, runs, &source.place, "runs", "froude cfd swing")?;
    let folder = runs.with_file_name(format!("{}-cfd", runs.file_name().unwrap_or_default().to_string_lossy()));
    inside(campaign, &folder, &source.place, "runs", "froude cfd swing")?;
    check_links(&folder)?;
    let asked = Asked::of(&read, source, folder)?;
    let programs = OpenFoam::find()?;
    for path in [&asked.folder, runs] {
        std::fs::create_dir_all(path).map_err(|source| RecordError::output(path, &source))?;
    }
    let all = prepared(&asked, &setup, planned, cancel, now)?;
    let _lock = Lock::take(&asked.folder)?;
    let of = |job: &Job, end: &str| runs.join(format!("{}.{end}", job.planned.id));
    let is_open = |job: &&Job| !(of(job, "toml").exists() && of(job, "csv").exists());
    check_logs(runs, &all)?;
    let open: Vec<&Job> = all.iter().filter(is_open).collect();
    let (done, failed) = every(&open, jobs, &asked.folder, runs, &setup, &programs, cancel, now);
    let row = |job: &Job| {
        let found = done.iter().find(|(id, _)| *id == job.planned.id).map(|(_, found)| *found);
        Run {
            id: job.planned.id.clone(),
            configuration: job.case.configuration.clone(),
            amplitude_m: job.swing.amplitude_m[1],
            frequency_hz: job.swing.frequency_hz,
            forward_m_s: job.swing.forward_m_s,
            keulegan_carpenter: job.swing.keulegan_carpenter(job.height_m),
            stokes: job.swing.stokes(job.height_m, job.case.water.viscosity_m2_s),
            last: found.and_then(|(last, _)| last),
            cpu_s: found.map(|(_, cpu_s)| cpu_s),
        }
    };
    let ended: Vec<&Job> = all.iter().filter(|job| !is_open(job)).collect();
    Ok(Swung {
        folder: runs.to_owned(),
        runs: ended.iter().map(|job| row(job)).collect(),
        open: all.len() - ended.len(),
        was_cancelled: cancel.load(Ordering::Relaxed) && ended.len() + failed.len() < all.len(),
        failed,
        volume_m3: ended.iter().map(|job| setup.bodies[job.planned.body].reference_volume_m3).collect(),
        density_kg_m3: setup.density_kg_m3.value,
    })
}

/// Everything in the folder of the runs must be of this plan and of these inputs: `froude identify` fits whatever lies there.
fn check_logs(runs: &Path, all: &[Job]) -> Result<(), Error> {
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
            return Err(CfdInput { path, problem: problem.to_owned() }.into());
        }
    }
    Ok(())
}

/// The only computed source that is a forced oscillation and says how its flow is computed, or the one of a name.
fn chosen<'a>(sources: &'a [Source], name: Option<&str>) -> Result<&'a Source, String> {
    let is_it = |s: &&Source| {
        s.kind == SourceKind::Cfd && s.oscillation.is_some() && s.cfd.is_some() && matches!(s.input, Input::Runs { .. })
    };
    let found: Vec<&Source> = sources.iter().filter(is_it).filter(|s| name.is_none_or(|name| s.name == name)).collect();
    match found[..] {
        [only] => {
            let spec = only.cfd.as_ref();
            if spec.is_some_and(|s| s.tank.is_some() || s.fine.is_some() || !s.study.is_empty()) {
                return Err("asks for a tank, a finer mesh or a study of a body that swings; take tank, fine and study out of [source.cfd]: mesh and step are varied by hand".to_owned());
            }
            Ok(only)
        }
        [] => Err("has no source that swings and says how its flow is computed: write kind = \"cfd\", method = \"forced_oscillation\", runs = \"runs\", [source.forced_oscillation], [[source.plan]] and [source.cfd] with a body".to_owned()),
        _ => {
            let names = found.iter().map(|s| format!("{:?}", s.name)).collect::<Vec<_>>().join(", ");
            Err(format!("has the sources {names} that swing; say which with --source"))
        }
    }
}

/// Makes the meshes, and says what each run takes.
fn prepared(
    asked: &Asked,
    setup: &Setup,
    planned: Vec<Planned>,
    cancel: &AtomicBool,
    now: &(dyn Fn(&str) + Sync),
) -> Result<Vec<Job>, Error> {
    let mut meshed = Vec::new();
    bodies::each(asked, setup.bodies.iter().map(|body| &body.name), &mut |body| {
        if cancel.load(Ordering::SeqCst) {
            return Err(Error::Stopped);
        }
        meshed.extend(of_body(asked, &body, cancel, now)?);
        Ok(())
    })?;
    let job = |planned: Planned| {
        let name = &setup.bodies[planned.body].name;
        let body = meshed.iter().find(|group| group.meshed.configuration == *name)?;
        let swing = Swing {
            amplitude_m: [0.0, setup.radius_m.value * planned.swing.amplitude_rad, 0.0],
            frequency_hz: planned.swing.omega_rad_s / std::f64::consts::TAU,
            forward_m_s: planned.swing.flow_m_s,
            steps: STEPS,
            periods: planned.swing.periods.ceil() as usize,
        };
        let speed_m_s = swing.speed_m_s().hypot(swing.forward_m_s);
        let reynolds = speed_m_s * body.meshed.reference.width_m / asked.water.viscosity_m2_s;
        let case = Case {
            id: planned.id.clone(),
            configuration: name.clone(),
            mesh: body.meshed.mesh.clone(),
            is_half: asked.spec.is_half,
            flow: Flow { speed_m_s, angle_rad: 0.0, pitch_rad: 0.0 },
            water: asked.water,
            model: model(&asked.spec, reynolds),
            stop: Stop { iterations: 1, window: 1, drift: 0.0, spread: 0.0 },
            reference: body.meshed.reference,
            start_from: None,
        };
        let rig = (setup.bodies[planned.body].mass_kg.value, setup.bodies[planned.body].buoyancy_n.map(|b| b.value));
        // The log has the angle, which the swing knows only times the radius.
        let inputs = format!("{} {swing:?} {rig:?} {}", case.hash(), planned.swing.amplitude_rad);
        let stamp = format!("{STAMP}{}", sha256_of_bytes(inputs.as_bytes()));
        let mesh = asked.folder.join(MESHES).join(&case.mesh);
        Some(Job { planned, mesh, case, swing, height_m: body.height_m, stamp })
    };
    Ok(planned.into_iter().filter_map(job).collect())
}

/// The last period of each run that was computed, with its cost; and those that failed, with the reason. What was cancelled is in neither.
type Found = (Vec<(String, (Option<Period>, f64))>, Vec<(String, String)>);

fn every(
    open: &[&Job],
    jobs: usize,
    folder: &Path,
    runs: &Path,
    setup: &Setup,
    programs: &OpenFoam,
    cancel: &AtomicBool,
    now: &(dyn Fn(&str) + Sync),
) -> Found {
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let found: Mutex<Found> = Mutex::default();
    let work = || {
        while !cancel.load(Ordering::Relaxed) {
            let Some(job) = open.get(next.fetch_add(1, Ordering::Relaxed)) else { return };
            let tell = |p: Progress| {
                let (ended, all) = (done.load(Ordering::Relaxed), open.len());
                now(&format!("{ended} of {all} runs done; {} at step {} of {}", job.case.id, p.iteration, p.of));
            };
            let how = How { openfoam: programs, ranks: 1, cancel, tell: &tell };
            let one = one(job, folder, runs, setup, &how);
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
fn one(
    job: &Job,
    folder: &Path,
    runs: &Path,
    setup: &Setup,
    how: &How<'_>,
) -> Result<Option<(Option<Period>, f64)>, Error> {
    let own = folder.join(&job.planned.id);
    orphans::end(&own);
    let failed = |source| RecordError::output(&own, &source);
    // What was begun carries a mark; anything else of this name is somebody's.
    let mark = own.join(MARK);
    if mark.exists() {
        std::fs::remove_dir_all(&own).map_err(failed)?;
    } else if std::fs::read_dir(&own).is_ok_and(|mut entries| entries.next().is_some()) {
        let problem = "was not written by froude cfd swing and would be emptied; move it away".to_owned();
        return Err(CfdInput { path: own, problem }.into());
    }
    std::fs::create_dir_all(&own).map_err(failed)?;
    write_atomically(&mark, job.stamp.as_bytes())?;
    let swung = match compute(&job.case, &job.swing, &job.mesh, &own, how) {
        Ok(swung) => swung,
        Err(error) if error.is_cancelled() => return Ok(None),
        Err(error) => {
            return Err(CfdInput { path: own, problem: error.to_string() }.into());
        }
    };
    let time_s: Vec<f64> = swung.samples.iter().map(|s| s.time).collect();
    let fluid_n: Vec<f64> = swung.samples.iter().map(|s| s.total()[1]).collect();
    for file in computed::files(&job.planned, setup, &time_s, &fluid_n, &job.stamp) {
        write_atomically(&runs.join(&file.name), &file.content)?;
    }
    Ok(Some((swung.periods.last().copied(), swung.cpu_s)))
}

impl Swung {
    /// C_A of a run by its last period \[-\].
    fn added(&self, row: usize) -> Option<f64> {
        Some(self.runs[row].last?.added_mass_kg / (self.density_kg_m3 * self.volume_m3[row]))
    }

    /// What a person reads.
    #[must_use]
    pub fn section(&self) -> DocumentSection {
        let dash = || "–".to_owned();
        let row = |(i, run): (usize, &Run)| {
            vec![
                run.id.clone(),
                run.configuration.clone(),
                significant(run.amplitude_m, 3),
                significant(run.frequency_hz, 3),
                significant(run.forward_m_s, 3),
                significant(run.keulegan_carpenter, 3),
                significant(run.stokes, 3),
                self.added(i).map_or_else(dash, |c| significant(c, 4)),
                run.last.map_or_else(dash, |last| significant(last.damping_n_s_m, 3)),
                run.cpu_s.map_or_else(dash, |s| significant(s, 3)),
            ]
        };
        let head = [
            "run",
            "body",
            "amplitude, m",
            "frequency, Hz",
            "forward, m/s",
            "KC",
            "β",
            "C_A",
            "damping, N s/m",
            "CPU, s",
        ];
        let mut paragraphs = if self.runs.is_empty() {
            Vec::new()
        } else {
            vec!["C_A and damping are of the last period alone, by its first harmonic; froude identify fits all runs at once, with the drag law and intervals. No interval holds the error of the mesh and of the step: compute a finer mesh, and see.".to_owned()]
        };
        paragraphs.extend(self.failed.iter().map(|(id, why)| format!("{id} failed: {why}")));
        if self.open > 0 {
            paragraphs.push(format!("{} no log yet", counted(self.open, "run has", "runs have")));
        }
        DocumentSection {
            title: "Computed".to_owned(),
            paragraphs,
            tables: if self.runs.is_empty() {
                Vec::new()
            } else {
                vec![TextTable {
                    caption: format!("runs in {}; – of those that were there", self.folder.display()),
                    head: head.map(str::to_owned).to_vec(),
                    rows: self.runs.iter().enumerate().map(row).collect(),
                }]
            },
            charts: Vec::new(),
        }
    }

    /// The same for a program.
    #[must_use]
    pub fn as_json(&self) -> Value {
        let row = |(i, run): (usize, &Run)| {
            json!({
                "run": run.id,
                "configuration": run.configuration,
                "amplitude_m": run.amplitude_m,
                "frequency_hz": run.frequency_hz,
                "forward_m_s": run.forward_m_s,
                "keulegan_carpenter": run.keulegan_carpenter,
                "stokes": run.stokes,
                "added_mass_kg": run.last.map(|last| last.added_mass_kg),
                "C_A": self.added(i),
                "damping_n_s_m": run.last.map(|last| last.damping_n_s_m),
                "cpu_s": run.cpu_s,
            })
        };
        json!({
            "folder": self.folder,
            "runs": self.runs.iter().enumerate().map(row).collect::<Vec<_>>(),
            "open": self.open,
            "failed": self.failed.iter().map(|(id, why)| json!({"run": id, "reason": why})).collect::<Vec<_>>(),
            "was_cancelled": self.was_cancelled,
        })
    }
}
