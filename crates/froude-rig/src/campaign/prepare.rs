//! A campaign before it is driven: read, planned, and every run of it checked. Nothing moves.

use std::path::PathBuf;

use crate::carriage::plan::{PlannedRun, Step, order_seed, plan};
use crate::carriage::{CarriageCampaign, CarriagePlan, Order, RigKind, declared};
use froude_control::config::{AxisConfig, Config, Limits};
use froude_hydro::fluid::density_kg_m3;
use froude_records::block::Block;
use froude_records::campaign::Campaign;
use froude_records::campaign_file::read_campaign;
use froude_records::run::Role;

use super::error::CampaignError;
use super::preflight::{check, check_campaign};
use super::setup;
use crate::campaign::preflight::{Expected, Forecast, Objection};
use crate::load::{Load, TowedBody};

/// What to drive and where the runs go.
#[derive(Debug, Clone, Default)]
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
    pub(super) campaign: Campaign,
    pub(super) carriage: CarriageCampaign,
    pub(super) asked: CarriagePlan,
    pub(super) load: Load,
    pub(super) control: Config,
    /// Folder of the runs.
    pub folder: PathBuf,
    /// The plan.
    pub steps: Vec<Step>,
    /// A forecast for each run.
    pub forecasts: Vec<Forecast>,
    /// Everything that speaks against it; empty when it may be driven.
    pub objections: Vec<Objection>,
    /// Time that each run takes on the rig, without the operator's, s.
    pub run_s: Vec<f64>,
    /// What others say of it before it is driven.
    pub beside: Vec<Block>,
    pub(super) job: DriveJob,
}

/// Relative run-to-run change of dry friction that is taken before any repeat has shown it (our assumption).
const ASSUMED_REPEATABILITY: f64 = 0.02;

impl Prepared {
    /// Whether a simulated rig is driven.
    #[must_use]
    pub fn is_twin(&self) -> bool {
        matches!(self.carriage.rig.kind, RigKind::Twin { .. })
    }

    /// The campaign.
    #[must_use]
    pub fn campaign(&self) -> &Campaign {
        &self.campaign
    }

    /// What the rig is asked to do.
    #[must_use]
    pub fn asked(&self) -> &CarriagePlan {
        &self.asked
    }

    /// The rig.
    #[must_use]
    pub fn carriage(&self) -> &CarriageCampaign {
        &self.carriage
    }

    /// The campaign's name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.campaign.name
    }

    /// The same campaign, recorded at every tick of the controller whatever the campaign's log rate: frequencies near the loop's own count.
    #[must_use]
    pub fn logging_every_tick(mut self) -> Self {
        self.carriage.rig.log_rate_hz = f64::INFINITY;
        self
    }

    /// Runs of the plan.
    pub fn runs(&self) -> impl Iterator<Item = &PlannedRun> {
        self.steps.iter().filter_map(|s| if let Step::Run(r) = s { Some(r) } else { None })
    }

    /// Whether the reference of the axis that tows is shaped for the load mode.
    #[must_use]
    pub fn is_shaped(&self) -> bool {
        self.control.axes[self.asked.axis as usize].mode_hz > 0.0
    }

    /// Time that the campaign takes on the rig, without the operator's, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.run_s.iter().sum()
    }

    /// The same where it stops after so many pairs, s.
    #[must_use]
    pub fn duration_of_pairs_s(&self, pairs: usize) -> f64 {
        // In blocks all dry runs come before the first wet one.
        let is_before = |role: Role| role == Role::Friction || (self.asked.order == Order::Blocks && role == Role::Dry);
        let is_driven = |run: &PlannedRun| is_before(run.role) || run.pair.is_none_or(|pair| pair as usize <= pairs);
        self.runs().zip(&self.run_s).filter(|(run, _)| is_driven(run)).map(|(_, s)| s).sum()
    }

    /// Smallest drag that one wet-minus-dry difference is expected to show (95 %), N.
    #[must_use]
    pub fn detectable_n(&self) -> f64 {
        1.96 * self.scatter_n().0
    }

    /// Standard deviation of one wet-minus-dry difference, N, with its degrees of freedom: as declared, else √2 times the assumed change of friction from run to run.
    #[must_use]
    pub fn scatter_n(&self) -> (f64, f64) {
        let assumed = || (std::f64::consts::SQRT_2 * ASSUMED_REPEATABILITY * self.friction_n(), f64::INFINITY);
        self.asked.expected_scatter_n.unwrap_or_else(assumed)
    }

    /// Friction of the carriage as a force at the chain, N.
    #[must_use]
    pub fn friction_n(&self) -> f64 {
        let drive = &self.control.axes[self.asked.axis as usize].drive;
        let spec =
            if self.asked.axis as usize == 0 { Some(&self.carriage.rig.y) } else { self.carriage.rig.x.as_ref() };
        let efficiency = spec.and_then(|s| s.constants.efficiency_forward).map_or(1.0, |e| e.value);
        efficiency * drive.coulomb_n_m * drive.gear_ratio / drive.sprocket_radius_m
    }
}

/// The rig of a campaign, what is asked of it, and the controller that they configure.
#[derive(Debug, Clone)]
pub struct Configured {
    carriage: CarriageCampaign,
    asked: CarriagePlan,
    control: Config,
    /// What the body displaces, m³; that of the twin's cylinder where no volume is declared.
    displaced_m3: f64,
    density_kg_m3: f64,
    /// The body with its water, added mass and ballast, kg, at most.
    towed_kg: f64,
}

impl Configured {
    /// Configuration of the axis that tows.
    #[must_use]
    pub fn axis(&self) -> &AxisConfig {
        &self.control.axes[self.asked.axis as usize]
    }

    /// Fastest steady speed that the campaign asks for, m/s, and its acceleration, m/s².
    #[must_use]
    pub fn hardest_ramp(&self) -> (f64, f64) {
        let fastest = |speeds: &[f64]| speeds.iter().copied().fold(0.0, f64::max);
        let friction = self.asked.friction.as_ref().map_or(0.0, |f| fastest(&f.speed_m_s));
        let warm_up = self.asked.warm_up.map_or(0.0, |w| w.speed_m_s);
        (fastest(&self.asked.speed_m_s).max(friction).max(warm_up), self.asked.acceleration_m_s2)
    }

    /// The controller's tick, µs.
    #[must_use]
    pub fn tick_us(&self) -> u32 {
        self.control.tick_us
    }
}

/// The controller as a campaign configures it.
///
/// # Errors
///
/// See [`CampaignError`]: a campaign without `[rig]` or `[carriage]`, a missing constant.
pub fn configured(campaign: &Campaign) -> Result<Configured, CampaignError> {
    let path = || campaign.path.clone();
    let carriage = declared(campaign)?.ok_or_else(|| CampaignError::NoRig { path: path() })?;
    let asked = carriage.plan.clone().ok_or_else(|| CampaignError::NoPlan { path: path() })?;
    if asked.axis as usize == 1 && carriage.rig.x.is_none() {
        return Err(CampaignError::NoAxis { place: asked.place.to_string() });
    }
    let fluid = &campaign.fluid;
    let density_kg_m3 = density_kg_m3(fluid.density_kg_m3, fluid.temperature_degc, fluid.salinity_g_kg);
    // The body with its water and added mass: twice what it displaces, where nothing else is known; and the ballast, once that.
    let volume_m3 = campaign.body.as_ref().and_then(|b| b.volume_m3);
    let displaced_m3 = volume_m3.unwrap_or(TowedBody::CYLINDER.displaced_m3);
    let towed_kg = if asked.is_ballasted { 3.0 } else { 2.0 } * density_kg_m3 * displaced_m3;
    let control = setup::control(&carriage, towed_kg)?;
    Ok(Configured { carriage, asked, control, displaced_m3, density_kg_m3, towed_kg })
}

/// Reads a campaign and checks every run of it. Nothing moves, nothing is written.
///
/// # Errors
///
/// See [`CampaignError`]: a campaign without `[rig]` or `[carriage]`, a missing constant, an unknown truth of the twin.
pub fn prepare(job: &DriveJob) -> Result<Prepared, CampaignError> {
    prepare_with(job, &plan)
}

/// The same with another plan: what is asked for, where forward runs begin, a seed of the order.
///
/// # Errors
///
/// As [`prepare`].
pub fn prepare_with(
    job: &DriveJob,
    plan: &dyn Fn(&CarriagePlan, f64, u64) -> Vec<Step>,
) -> Result<Prepared, CampaignError> {
    let campaign = read_campaign(&job.campaign)?;
    let configured = configured(&campaign)?;
    let Configured { carriage, asked, control, displaced_m3, density_kg_m3, .. } = configured;
    let (displaced_kg, towed_kg) = (density_kg_m3 * displaced_m3, configured.towed_kg);
    let drag_n_s2_m2 = asked.expected_drag_n_s2_m2.unwrap_or(0.0);
    let volume_m3 = campaign.body.as_ref().and_then(|b| b.volume_m3);
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
    let mut run_s = Vec::new();
    for step in &steps {
        if let Step::Run(run) = step {
            let (forecast, against) = check(run, &asked, &control, &expected);
            let way_back_s = asked.distance_m / return_speed_m_s(&asked, &axis.limits);
            run_s.push(run.settle_s + 2.0 * asked.still_s + forecast.duration_s + way_back_s);
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
        run_s,
        beside: Vec::new(),
        job: job.clone(),
    })
}

/// Speed of the way back to the start of a run, m/s.
pub(super) fn return_speed_m_s(asked: &CarriagePlan, limits: &Limits) -> f64 {
    let fastest = asked.speed_m_s.iter().copied().fold(0.0, f64::max);
    fastest.clamp(0.05, 0.5).min(limits.speed_m_s)
}
