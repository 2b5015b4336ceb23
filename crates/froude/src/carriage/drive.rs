//! `froude run`: the pre-flight, then the campaign on the twin or the real rig.

use std::path::{Path, PathBuf};

use froude_carriage::drag::calibration::Readings;
use froude_carriage::drag::detectability::DryMean;
use froude_carriage::drag::online::OnLine;
use froude_carriage::drag::{mcd, run as drag_run};
use froude_records::campaign::{Campaign, read_campaign};
use froude_records::carriage::plan::{PlannedRun, Step, order_seed, plan};
use froude_records::carriage::{CarriageCampaign, CarriagePlan, RigKind};
use froude_records::hash::sha256_of_bytes;
use froude_records::run::{BodyState, CampaignMark, Role, RunMeta, check_names, read_run};
use froude_rig::campaign::lock::FolderLock;
use froude_rig::campaign::preflight::{Expected, Forecast, Objection, check, check_campaign};
use froude_rig::campaign::runner::{self, Operator, Progress, Setting};
use froude_rig::campaign::stop::StopSwitch;
use froude_rig::campaign::{runner::Outcome, setup};
use froude_rig::drive::Rig;
use froude_rig::drive::twin::TwinRig;
use froude_rig::load::{Load, TowedBody};
use indexmap::IndexMap;

use crate::Error;
use froude_carriage::reduction::{calibration_from, setup_of};
use froude_carriage::runs::{density_kg_m3, for_drag};
use froude_records::run::{CAMPAIGN_COPY, LAST_RUN, STOPPED_EARLY};

/// What to drive and where the runs go.
#[derive(Debug, Clone)]
pub struct DriveJob {
    /// The campaign.
    pub campaign: PathBuf,
    /// Folder of the runs; beside the campaign, named after it, unless stated.
    pub out: Option<PathBuf>,
    /// Host's clock at the start, ns since 1970.
    pub start_unix_ns: u64,
    /// Date in words.
    pub date: String,
}

/// A campaign that has passed its pre-flight, or what speaks against it.
#[derive(Debug)]
pub struct Prepared {
    campaign: Campaign,
    carriage: CarriageCampaign,
    asked: CarriagePlan,
    load: Load,
    control: froude_control::config::Config,
    /// Folder of the runs.
    pub folder: PathBuf,
    /// The plan.
    pub steps: Vec<Step>,
    /// A forecast for each run.
    pub forecasts: Vec<Forecast>,
    /// Everything that speaks against it; empty when it may be driven.
    pub objections: Vec<Objection>,
    /// Time that the campaign takes on the rig, without the operator's, s.
    pub duration_s: f64,
    job: DriveJob,
}

/// Relative run-to-run change of dry friction that is taken before any repeat has shown it (our assumption).
const ASSUMED_REPEATABILITY: f64 = 0.02;

impl Prepared {
    /// Whether a simulated rig is driven.
    #[must_use]
    pub fn is_twin(&self) -> bool {
        matches!(self.carriage.rig.kind, RigKind::Twin { .. })
    }

    /// The campaign's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.campaign.name
    }

    /// Configuration of the axis that tows.
    #[must_use]
    pub fn axis(&self) -> &froude_control::config::AxisConfig {
        &self.control.axes[self.asked.axis as usize]
    }

    /// The same, recorded at every tick of the controller whatever the campaign's log rate: frequencies near the loop's own count.
    #[must_use]
    pub fn logging_every_tick(mut self) -> Self {
        self.carriage.rig.log_rate_hz = f64::INFINITY;
        self
    }

    /// Fastest steady speed that the campaign asks for, m/s, and its acceleration, m/s².
    #[must_use]
    pub fn hardest_ramp(&self) -> (f64, f64) {
        let fastest = |speeds: &[f64]| speeds.iter().copied().fold(0.0, f64::max);
        let friction = self.asked.friction.as_ref().map_or(0.0, |f| fastest(&f.speed_m_s));
        let warm_up = self.asked.warm_up.map_or(0.0, |w| w.speed_m_s);
        (fastest(&self.asked.speed_m_s).max(friction).max(warm_up), self.asked.acceleration_m_s2)
    }

    /// Declared efficiency of the gear when the motor drives.
    #[must_use]
    pub fn efficiency(&self) -> Option<froude_records::run::Declared> {
        let spec =
            if self.asked.axis as usize == 0 { Some(&self.carriage.rig.y) } else { self.carriage.rig.x.as_ref() };
        spec.and_then(|s| s.constants.efficiency_forward)
    }

    /// The controller's tick, µs.
    #[must_use]
    pub fn tick_us(&self) -> u32 {
        self.control.tick_us
    }

    /// Runs of the plan.
    pub fn runs(&self) -> impl Iterator<Item = &PlannedRun> {
        self.steps.iter().filter_map(|s| if let Step::Run(r) = s { Some(r) } else { None })
    }

    /// Whether the reference of the axis that tows is shaped for the load's mode.
    #[must_use]
    pub fn is_shaped(&self) -> bool {
        self.control.axes[self.asked.axis as usize].mode_hz > 0.0
    }

    /// Smallest drag that one wet-less-dry difference is expected to show (95 %), N: twice √2 times the assumed change of friction from run to
    /// run. The dry repeats replace it when they are there.
    #[must_use]
    pub fn detectable_n(&self) -> f64 {
        let drive = &self.control.axes[self.asked.axis as usize].drive;
        let spec =
            if self.asked.axis as usize == 0 { Some(&self.carriage.rig.y) } else { self.carriage.rig.x.as_ref() };
        let efficiency = spec.and_then(|s| s.constants.efficiency_forward).map_or(1.0, |e| e.value);
        // As the motor sees it through the gear, and as a force at the chain.
        let friction_n = efficiency * drive.coulomb_n_m * drive.gear_ratio / drive.sprocket_radius_m;
        1.96 * std::f64::consts::SQRT_2 * ASSUMED_REPEATABILITY * friction_n
    }
}

/// Reads a campaign and checks every run of it. Nothing moves, nothing is written.
///
/// # Errors
///
/// See [`Error`]: a campaign without `[rig]` or `[carriage]`, a missing constant, an unknown truth of the twin.
pub fn prepare(job: &DriveJob) -> Result<Prepared, Error> {
    prepare_with(job, &plan)
}

/// The same with another plan: what is asked for, where forward runs begin, a seed of the order.
///
/// # Errors
///
/// As [`prepare`].
pub fn prepare_with(job: &DriveJob, plan: &dyn Fn(&CarriagePlan, f64, u64) -> Vec<Step>) -> Result<Prepared, Error> {
    let campaign = read_campaign(&job.campaign)?;
    let path = job.campaign.display();
    let carriage = campaign
        .carriage
        .clone()
        .ok_or_else(|| Error::Nothing(format!("{path}: nothing to drive: the campaign has no [rig]")))?;
    let asked = carriage.plan.clone().ok_or_else(|| {
        Error::Nothing(format!("{path}: [rig] says what is driven, [carriage] must state what it is to do"))
    })?;
    if asked.axis as usize == 1 && carriage.rig.x.is_none() {
        return Err(Error::Nothing(format!(
            "{}: axis = \"x\" tows along an axis that is not described: write [rig.x], with the keys of [rig.y]",
            asked.place
        )));
    }
    let drag_n_s2_m2 = asked.expected_drag_n_s2_m2.unwrap_or(0.0);
    let density_kg_m3 = density_kg_m3(Some(&campaign));
    // The body with its water and added mass: twice what it displaces, where nothing else is known; and the ballast, once that.
    let volume_m3 = campaign.body.as_ref().and_then(|b| b.volume_m3);
    let displaced_m3 = volume_m3.unwrap_or(TowedBody::CYLINDER.displaced_m3);
    let displaced_kg = density_kg_m3 * displaced_m3;
    let towed_kg = if asked.is_ballasted { 3.0 } else { 2.0 } * displaced_kg;
    let control = setup::control(&carriage, towed_kg)?;
    let axis = control.axes[asked.axis as usize];
    let start_m = asked.start_m.unwrap_or(0.5 * (axis.limits.hard_low_m + axis.limits.hard_high_m - asked.distance_m));
    let steps = plan(&asked, start_m, order_seed(&carriage.rig.kind));
    // What is not declared of the twin's body is the cylinder's, in proportion to the volume; [rig.twin] overrides it.
    let scale = displaced_m3 / TowedBody::CYLINDER.displaced_m3;
    let body = TowedBody {
        mass_kg: scale * TowedBody::CYLINDER.mass_kg,
        displaced_m3,
        body_water_kg: scale * TowedBody::CYLINDER.body_water_kg,
        added_mass_kg: scale * TowedBody::CYLINDER.added_mass_kg,
        drag_n_s2_m2,
    };
    let load = Load { body, density_kg_m3, ..Load::default() };
    let spec =
        if asked.axis as usize == 0 { &carriage.rig.y } else { carriage.rig.x.as_ref().unwrap_or(&carriage.rig.y) };
    let expected = Expected {
        drag_n_s2_m2,
        wet_mass_kg: towed_kg,
        dry_mass_kg: displaced_kg,
        efficiency: spec.constants.efficiency_forward.map_or(1.0, |e| e.value),
        assumed_volume_m3: volume_m3.is_none().then_some(displaced_m3),
    };
    let (mut forecasts, mut objections) = (Vec::new(), check_campaign(&asked, &carriage.rig, &control));
    let mut duration_s = 0.0;
    for step in &steps {
        if let Step::Run(run) = step {
            let (forecast, against) = check(run, &asked, &control, &expected);
            duration_s += run.settle_s + 2.0 * asked.still_s + forecast.duration_s;
            // The way back to the start.
            duration_s += asked.distance_m / return_speed_m_s(&asked, &axis.limits);
            forecasts.push(forecast);
            objections.extend(against);
        }
    }
    let folder = job.out.clone().unwrap_or_else(|| {
        let stem = job.campaign.file_stem().map_or_else(|| "campaign".to_owned(), |s| s.to_string_lossy().into_owned());
        job.campaign.with_file_name(format!("{stem}-runs"))
    });
    Ok(Prepared {
        campaign,
        carriage,
        asked,
        load,
        control,
        folder,
        steps,
        forecasts,
        objections,
        duration_s,
        job: job.clone(),
    })
}

fn return_speed_m_s(asked: &CarriagePlan, limits: &froude_control::config::Limits) -> f64 {
    let fastest = asked.speed_m_s.iter().copied().fold(0.0, f64::max);
    fastest.clamp(0.05, 0.5).min(limits.speed_m_s)
}

/// Longest that homing may take, s: half as long again as the way from the far hard stop does, and a minute for turning and settling.
fn homing_s(limits: &froude_control::config::Limits) -> f64 {
    60.0 + 1.5 * (limits.hard_high_m - limits.hard_low_m) / limits.unhomed_speed_m_s
}

/// Drives what passed its pre-flight; goes on where an earlier drive into the same folder stopped.
///
/// # Errors
///
/// Objections of the pre-flight, a folder that belongs to another campaign, and whatever stops the drive.
pub fn drive(
    prepared: &Prepared,
    switch: &StopSwitch,
    operator: &mut dyn Operator,
    progress: &mut dyn Progress,
) -> Result<Outcome, Error> {
    if let Some(first) = prepared.objections.first() {
        let more = prepared.objections.len() - 1;
        let more = if more == 0 { String::new() } else { format!(" ({more} more: froude run --check)") };
        return Err(Error::Nothing(format!("nothing was moved: {}: {}{more}", first.id, first.text)));
    }
    let _alone = FolderLock::take(&prepared.folder, &prepared.job.date, prepared.job.start_unix_ns)?;
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
    let mut live = Live::new(prepared);
    let mut enough = |path: &Path, run: &PlannedRun| live.after(path, run);
    Ok(runner::drive(&prepared.steps, &setting, rig.as_mut(), switch, operator, progress, &mut enough)?)
}

type Driven = (Box<dyn Rig + Send>, Load, Option<u64>);

fn rig_of(prepared: &Prepared) -> Result<Driven, Error> {
    match &prepared.carriage.rig.kind {
        RigKind::Twin { seed, .. } => {
            let (twin, load) = setup::twin(&prepared.carriage, prepared.load)?;
            let rig = TwinRig::new(&twin, prepared.control, *seed).map_err(runner::RunnerError::from)?;
            // What the campaign does not declare is not there: a real rig would have nothing to record either.
            let rig = if prepared.carriage.rig.force_sensor.is_some() { rig } else { rig.without_force_sensor() };
            Ok((Box::new(rig), load, Some(*seed)))
        }
        RigKind::Serial { port, baud } => {
            let rig = froude_rig::drive::serial::SerialRig::open(port, *baud, prepared.control)
                .map_err(runner::RunnerError::from)?;
            Ok((Box::new(rig), prepared.load, None))
        }
    }
}

/// Makes the folder and puts the campaign's copy there, and gives its SHA-256; a copy of another campaign is refused.
fn own_folder(folder: &Path, campaign: &Path) -> Result<String, Error> {
    let failed = |path: &Path| {
        let path = path.to_owned();
        move |source| Error::Output { path, source }
    };
    std::fs::create_dir_all(folder).map_err(failed(folder))?;
    let text = std::fs::read(campaign).map_err(failed(campaign))?;
    let copy = folder.join(CAMPAIGN_COPY);
    match std::fs::read(&copy) {
        Ok(there) if there == text => {}
        Ok(_) => {
            return Err(Error::Nothing(format!(
                "{} holds runs of another campaign, or of an earlier state of this one ({CAMPAIGN_COPY} differs): name another folder \
             with --out",
                folder.display()
            )));
        }
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => froude_records::write::write_atomically(&copy, &text)?,
        Err(e) => return Err(failed(&copy)(e)),
    }
    Ok(sha256_of_bytes(&text))
}

/// D_d while the campaign runs: every wet run with its dry partner gives a point.
struct Live {
    online: Option<OnLine>,
    setup: drag_run::DragSetup,
    campaign: Campaign,
    folder: PathBuf,
    /// Runs whose partner has not been driven yet; a log of megabytes is read again when it has.
    waiting: Vec<Waiting>,
    calibration: Readings,
    is_calibrated: bool,
    /// Differences seen, whether they gave a point or not.
    differences: usize,
    per_pair: usize,
}

/// A run that waits for its partner.
struct Waiting {
    path: PathBuf,
    meta: RunMeta,
}

impl Live {
    fn new(prepared: &Prepared) -> Self {
        let asked = &prepared.asked;
        let constants = if asked.axis as usize == 0 {
            Some(&prepared.carriage.rig.y.constants)
        } else {
            prepared.carriage.rig.x.as_ref().map(|x| &x.constants)
        };
        let directions = if asked.directions == froude_records::carriage::Directions::Both { 2 } else { 1 };
        Self {
            online: asked.stop_at_relative_half_width.map(|target| OnLine::new(target, directions)),
            setup: drag_run::DragSetup { looks: asked.repeats, ..setup_of(Some(&prepared.campaign), constants) },
            campaign: prepared.campaign.clone(),
            folder: prepared.folder.clone(),
            waiting: Vec::new(),
            calibration: Readings::default(),
            is_calibrated: false,
            differences: 0,
            per_pair: asked.speed_m_s.len() * directions,
        }
    }

    /// Reads the run again from its file and asks whether enough is known. A run that gives no point only gives none.
    fn after(&mut self, path: &Path, run: &PlannedRun) -> Option<String> {
        self.online.as_ref()?;
        if !matches!(run.role, Role::Dry | Role::Wet | Role::Calibration) {
            return None;
        }
        let log = read_run(path).ok()?;
        if run.role == Role::Calibration {
            if let Ok(Some(run)) = for_drag(&log) {
                self.calibration.push(&run, self.setup.steady);
            }
            return None;
        }
        self.calibrate();
        let online = self.online.as_mut()?;
        if let Ok(Some(run)) = for_drag(&log)
            && let Some(mean) = DryMean::of(&run, &self.setup)
        {
            online.push_dry(mean);
        }
        let partner = self.waiting.iter().position(|other| {
            other.meta.carriage.pair == log.meta.carriage.pair
                && other.meta.carriage.target_speed_m_s == log.meta.carriage.target_speed_m_s
                && other.meta.carriage.direction == log.meta.carriage.direction
        });
        let Some(partner) = partner else {
            self.waiting.push(Waiting { path: path.to_owned(), meta: log.meta });
            return None;
        };
        let other = read_run(&self.waiting.swap_remove(partner).path);
        self.differences += 1;
        if let Ok(other) = &other
            && let (wet, dry) = if log.meta.mounted.body == BodyState::Wet { (&log, other) } else { (other, &log) }
            && let (Ok(Some(wet)), Ok(Some(dry))) = (for_drag(wet), for_drag(dry))
            && let Ok(point) = mcd::point(&wet, &dry, self.setup.force_per_volt_n(), self.setup.steady)
        {
            online.push(point);
        }
        // A look is taken after whole pairs only, also where a run of them gave no point.
        if !self.differences.is_multiple_of(self.per_pair) {
            return None;
        }
        let status = online.status(&self.setup)?;
        if !status.may_stop {
            return None;
        }
        let why = format!(
            "D_d = {:.2} ± {:.2} N s²/m² after {} pairs: its 95 % interval is as narrow as asked; the remaining pairs are left out",
            status.value,
            status.half_width.unwrap_or(f64::NAN),
            status.pairs
        );
        // A folder that cannot be written to has stopped the recorder long before; then the report does without.
        let said = format!("{why}\n{LAST_RUN}{}\n", run.id);
        let _ = froude_records::write::write_atomically(&self.folder.join(STOPPED_EARLY), said.as_bytes());
        Some(why)
    }

    /// Force per volt of the weights, as the report will take them, before the first look.
    fn calibrate(&mut self) {
        if self.is_calibrated {
            return;
        }
        self.is_calibrated = true;
        let (calibration, _) = calibration_from(&self.calibration, Some(&self.campaign), &self.setup);
        self.setup.calibration = calibration.map(|c| c.force_per_volt);
    }
}
