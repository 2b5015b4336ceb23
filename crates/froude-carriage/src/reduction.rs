//! D_d and C_D by force sensor, motor current and model, from the runs of a campaign.

use std::collections::BTreeSet;
use std::path::Path;

use froude_fit::budget::Uncertain;
use froude_fit::distribution::t_two_sided;
use froude_hydro::similarity::GRAVITY_M_S2;
use froude_identify::method::MethodError;
use froude_records::campaign::Fluid;
use froude_records::finding::{Finding, Severity};
use froude_records::hash::{sha256_of_file, short_key};
use froude_records::number;
use froude_records::run::{AxisConstants, Declared, Role, RunLog};
use froude_records::text::counted;
use froude_rig::carriage::{DrivenCampaign, LogsRig};

use crate::drag::calibration::record::Known;
use crate::drag::calibration::{Calibration, CalibrationSetup, PULLEY_LOSS, Readings};
use crate::drag::point::Method;
use crate::drag::report::{DragReport, drag_by};
use crate::drag::run::{self as drag_run, DragRun};
use crate::drag::setup::{Ballast, DragSetup, DriveUnit, Efficiency, ErrorKeys, SensorBudget};
use crate::drag::tracking::{Tracking, tracking};
use crate::runs::whole::STOPPED_EARLY;
use crate::runs::{Runs, density_kg_m3, for_drag};
use crate::two_masses::{relative_errors, two_masses};

pub mod page;

/// A calibration that knows the force per volt to less than this part is none.
const USELESS: f64 = 0.2;

/// Standard uncertainty of the gain of a force sensor of which nobody declares it: what a cell in use has, a year after its certificate.
const UNDECLARED_GAIN: f64 = 0.01;

/// Standard uncertainty of the ballast that the operator puts on, as a part: it is weighed, the body's volume is what limits it.
const BALLAST_RELATIVE: f64 = 0.005;

/// Runs of a campaign, reduced by every method that they allow.
pub struct Reduction {
    /// The runs.
    pub runs: Runs,
    /// What is declared of rig, body and water.
    pub setup: DragSetup,
    /// Force per volt from known weights, where there were any.
    pub calibration: Option<Calibration>,
    /// What each method gave.
    pub report: DragReport,
    /// How closely the carriage followed its reference, where the logs have one.
    pub tracking: Vec<Tracking>,
}

/// Calibrates where known weights were hung, and reduces by these methods.
///
/// # Errors
///
/// A channel that is missing or that no carriage has, a declaration that the budget needs, and what the methods refuse.
pub fn reduce(runs: Runs, methods: &[Method]) -> Result<Reduction, MethodError> {
    let of_logs = runs.logs.iter().map(for_drag).collect::<Result<Vec<_>, _>>()?;
    let references = of_logs.iter().zip(&runs.logs).filter_map(|(run, log)| Some((run.as_ref()?, reference_m(log)?)));
    let tracking = tracking(references);
    let reduced: Vec<DragRun<'_>> = of_logs.into_iter().flatten().collect();
    let constants = runs.logs.iter().find_map(|log| log.meta.moving_axis());
    let (two_masses, no_two_masses) = two_masses(&runs.logs);
    let mut setup = setup_of(runs.campaign.as_ref(), constants);
    setup.travel = runs.travel;
    setup.flexible = two_masses.map(|report| report.flexible());
    let (calibration, why_not) = calibration_of(&reduced, runs.campaign.as_ref(), &setup);
    setup.calibration = calibration.as_ref().map(|c| c.force_per_volt).or(setup.calibration);
    setup.keys = keys(&runs, constants)?;
    let undeclared = undeclared(runs.campaign.as_ref(), &reduced)?;
    let stopped = stopped_early(&runs, &reduced);
    setup.looks = stopped.map_or(1, |s| s.planned);
    let part = part_of(&runs);
    if let Some(part) = &part {
        setup.name = format!("{}, {}", setup.name, part.of);
    }
    let mut report = drag_by(&reduced, &setup, methods).map_err(MethodError::refused)?;
    report.findings.extend(undeclared);
    report.findings.extend(part.map(|part| part.finding));
    report.findings.extend(stopped.map(|stop| stop.finding(runs.beside > 0)));
    report.findings.extend(runs.findings.iter().cloned());
    report.findings.extend(why_not);
    report.findings.extend(no_two_masses);
    report.findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    drop(reduced);
    Ok(Reduction { runs, setup, calibration, report, tracking })
}

/// Reference positions of a log of Froude's own, m.
fn reference_m(log: &RunLog) -> Option<&[f64]> {
    let channel = log.channels.get(&format!("{}/reference_position", log.meta.carriage.axis.name()))?;
    Some(&channel.values)
}

/// A result of some of the runs that lie in a folder.
struct PartOf {
    /// What it is a result of, beside the campaign's name.
    of: String,
    finding: Finding,
}

fn part_of(runs: &Runs) -> Option<PartOf> {
    let (named, all) = (runs.logs.len(), runs.logs.len() + runs.beside);
    let of = match runs.logs.as_slice() {
        _ if runs.beside == 0 => return None,
        [one] => one.meta.id.clone(),
        _ => format!("{named} of {all} runs"),
    };
    let folders: BTreeSet<_> = runs.logs.iter().filter_map(|log| log.path.parent()).collect();
    let folders: Vec<String> = folders
        .into_iter()
        .map(|folder| if folder.as_os_str().is_empty() { Path::new(".") } else { folder })
        .map(|folder| folder.display().to_string())
        .collect();
    let text = format!(
        "{named} of the {all} runs in the folder that determine drag {} named: this is not the result of the campaign, and its record is called \
         {of:?}. froude carriage drag {} takes them all",
        if named == 1 { "was" } else { "were" },
        folders.join(" "),
    );
    Some(PartOf { of, finding: Finding::new(Severity::Warning, "part-of-a-campaign", text) })
}

/// A campaign that stopped because its interval was short enough.
#[derive(Debug, Clone, Copy)]
struct EarlyStop {
    found: usize,
    planned: usize,
}

impl EarlyStop {
    fn finding(self, is_part: bool) -> Finding {
        let Self { found, planned } = self;
        let when = if is_part { String::new() } else { format!("after {found} of {planned} pairs ") };
        let text = format!(
            "the campaign stopped {when}because its interval was narrow enough; some intervals are narrow by chance, so all intervals \
             here hold simultaneously over {} (Bonferroni)",
            counted(planned, "look", "looks")
        );
        Finding::new(Severity::Note, "stopped-early", text)
    }
}

/// Whether the folder says that its campaign stopped early.
fn stopped_early(runs: &Runs, reduced: &[DragRun<'_>]) -> Option<EarlyStop> {
    let plan = runs.campaign.as_ref()?.carriage.as_ref()?.plan.as_ref()?;
    if !runs.folder.join(STOPPED_EARLY).exists() {
        return None;
    }
    let wet = reduced.iter().filter(|r| r.body == drag_run::BodyState::Wet && r.kind == drag_run::RunKind::Tow);
    let mut pairs: Vec<u32> = wet.map(|r| r.pair).collect();
    pairs.sort_unstable();
    pairs.dedup();
    Some(EarlyStop { found: pairs.len(), planned: plan.repeats })
}

/// Declarations that the budget needs and the campaign lacks.
///
/// # Errors
///
/// Wet runs without ballast of a body whose volume is not declared: the wheel load that buoyancy removes is not known.
fn undeclared(campaign: Option<&DrivenCampaign>, runs: &[DragRun<'_>]) -> Result<Option<Finding>, MethodError> {
    let carriage = campaign.and_then(|c| c.carriage.as_ref());
    let logs = campaign.and_then(|c| c.logs.as_ref());
    let planned = carriage.and_then(|c| c.plan.as_ref()).map(|p| p.is_ballasted);
    let is_ballasted = planned.or(logs.map(|logs| logs.is_ballasted)).unwrap_or(true);
    let volume_m3 = campaign.and_then(|c| c.campaign.body.as_ref()).and_then(|b| b.volume_m3);
    if !is_ballasted && volume_m3.is_none() {
        return Err(MethodError::Undeclared { place: String::new(), what:
            "the wet runs carried no ballast and the campaign declares no volume of the body: the wheel load that buoyancy removes is not \
             known. Write volume = \"6.283e-3 m^3\" (its own) in [body]; 0 is not assumed"
                .to_owned(),
        });
    }
    if let (Some(_), Some(DrivenCampaign { campaign, .. })) = (logs, campaign)
        && campaign.fluid == Fluid::default()
    {
        let what = "the water is not declared, and C_D refers to its density: write [fluid] density = \"998 kg/m^3\", or temperature = \"20 degC\"";
        return Err(MethodError::input(&campaign.path, what));
    }
    let has_sensor = runs.iter().any(|r| r.force_n.is_some());
    let gain = carriage.and_then(|c| c.rig.force_sensor.as_ref()).and_then(|f| f.gain_standard);
    Ok((has_sensor && gain.is_none()).then(|| {
        Finding::new(
            Severity::Note,
            "gain-not-declared",
            format!(
                "no uncertainty of the force sensor's gain is declared; {} is assumed. Write gain_standard in [rig.force_sensor]",
                number::percent(UNDECLARED_GAIN)
            ),
        )
    }))
}

/// What is declared, from the campaign where there is one, else from what the runs state about their rig.
#[must_use]
pub fn setup_of(campaign: Option<&DrivenCampaign>, axis: Option<&AxisConstants>) -> DragSetup {
    let mut setup = DragSetup::of_the_paper();
    setup.efficiency = Efficiency::Undeclared;
    setup.density_kg_m3 = density_kg_m3(campaign.map(|c| &c.campaign));
    let carriage = campaign.and_then(|c| c.carriage.as_ref());
    if let Some(DrivenCampaign { campaign, .. }) = campaign {
        setup.name.clone_from(&campaign.name);
        let area = campaign.body.as_ref().and_then(|b| Some((b.reference_area_m2?, b.reference_area_standard_m2)));
        setup.reference_area_m2 = area.map(|(area, _)| area);
        let of_area = area.map_or(0.0, |(area, standard)| standard / area);
        setup.reference_relative = of_area.hypot(campaign.fluid.density_standard_kg_m3 / setup.density_kg_m3);
        setup.travel = campaign.body.as_ref().and_then(|b| b.travel);
    }
    let spec = carriage.map(|c| &c.rig.y);
    if let Some(c) = spec.map(|s| &s.constants).or(axis) {
        let ratio = c.gear_ratio.value / c.sprocket_radius_m.value;
        setup.ideal_force_per_volt_n = ratio * c.torque_constant_n_m_a.value * c.amplifier_a_v.value;
        [setup.torque_constant_relative, setup.speed_scale_relative] = relative_errors(c);
        if let Some(e) = &c.efficiency_forward {
            setup.efficiency = Efficiency::Declared(Uncertain::new(e.value, e.standard_uncertainty));
        }
    }
    if let Some(drift_n) = carriage.and_then(|c| c.rig.force_sensor.as_ref()).and_then(|f| f.drift_n) {
        setup.sensor = SensorBudget { drift_half_width_n: drift_n, ..setup.sensor };
    }
    let declared = carriage.and_then(|c| c.rig.force_sensor.as_ref()).and_then(|f| f.gain_standard);
    setup.sensor.gain_relative = declared.unwrap_or(UNDECLARED_GAIN);
    let displaced_kg =
        campaign.and_then(|c| c.campaign.body.as_ref()).and_then(|b| b.volume_m3).map(|v| setup.density_kg_m3 * v);
    let logs = campaign.and_then(|c| c.logs.as_ref());
    if let Some(logs) = logs {
        let LogsRig { force_per_unit: Declared { value, standard_uncertainty }, .. } = *logs;
        setup.ideal_force_per_volt_n = value;
        setup.calibration = Some(Uncertain::new(value, standard_uncertainty));
        setup.drive = if logs.is_current { DriveUnit::CURRENT } else { DriveUnit::DECLARED };
        setup.speed_scale_relative = logs.position_relative;
    }
    let plan = carriage.and_then(|c| c.plan.as_ref());
    let strut = plan.and_then(|p| p.strut_drag_n_s2_m2).or(logs.and_then(|logs| logs.strut_drag_n_s2_m2));
    setup.strut_n_s2_m2 = strut.map(|s| Uncertain::new(s.value, s.standard_uncertainty));
    setup.ballast = match plan.map(|p| p.is_ballasted).or(logs.map(|logs| logs.is_ballasted)) {
        Some(false) => Ballast::Unballasted { unloaded_n: GRAVITY_M_S2 * displaced_kg.unwrap_or(0.0), rolling: None },
        _ => Ballast::Matched { carried_kg: displaced_kg.map(|kg| Uncertain::new(kg, BALLAST_RELATIVE * kg)) },
    };
    setup
}

/// Standard uncertainty of a campaign's weights, as a part; 0.1 % where it declares none, as of shop weights.
fn declared_weight_relative(campaign: Option<&DrivenCampaign>) -> f64 {
    let plan = campaign.and_then(|c| c.carriage.as_ref()).and_then(|c| c.plan.as_ref());
    plan.and_then(|p| p.calibration.as_ref()).map_or(1e-3, weight_relative)
}

/// Standard uncertainty of the weights, as a part: that of the heaviest, which tells the most.
pub fn weight_relative(calibration: &froude_rig::carriage::Calibration) -> f64 {
    calibration.weight_standard_n / calibration.weights_n.iter().copied().fold(f64::MIN_POSITIVE, f64::max)
}

/// Key of the error of the declared weights: campaigns that declare the same weights on a carriage of the same size hung the same ones.
fn weights_key(campaign: Option<&DrivenCampaign>) -> Option<String> {
    let carriage = campaign?.carriage.as_ref()?;
    let calibration = carriage.plan.as_ref()?.calibration.as_ref()?;
    let axis = &carriage.rig.y;
    let size = (axis.travel_m, axis.constants.sprocket_radius_m.value, axis.constants.counts_per_revolution);
    let text = format!("{:?} {:e} {size:?}", calibration.weights_n, calibration.weight_standard_n);
    Some(format!("weights/{}", short_key(text.as_bytes())))
}

/// Loss of the campaign's pulley, as a part of the weight; [`PULLEY_LOSS`] where it declares none.
pub(crate) fn pulley_loss(campaign: Option<&DrivenCampaign>) -> Uncertain {
    let plan = campaign.and_then(|c| c.carriage.as_ref()).and_then(|c| c.plan.as_ref());
    let declared = plan.and_then(|p| p.calibration.as_ref()).and_then(|c| c.pulley_loss);
    declared.map_or(PULLEY_LOSS, |p| Uncertain::new(p.value, p.standard_uncertainty))
}

/// What is known of the errors of a campaign's calibration, on the rig of this key: campaigns that take the same loss on one rig have one pulley.
#[must_use]
pub fn known_of_calibration(campaign: Option<&DrivenCampaign>, rig: Option<&str>) -> Known {
    let loss = pulley_loss(campaign);
    Known {
        weight_relative: declared_weight_relative(campaign),
        weights: weights_key(campaign),
        pulley_standard: loss.standard,
        pulley: rig.map(|rig| format!("{rig}/pulley {:e} {:e}", loss.value, loss.standard)),
    }
}

/// Calibration from the runs with weights; a finding where there are such runs and they do not calibrate.
#[must_use]
pub fn calibration_of(
    runs: &[DragRun<'_>],
    campaign: Option<&DrivenCampaign>,
    setup: &DragSetup,
) -> (Option<Calibration>, Option<Finding>) {
    calibration_from(&Readings::of(runs, setup.steady), campaign, setup)
}

/// False-alarm probability of reporting friction by direction.
const BY_DIRECTION: f64 = 0.004;

/// What runs both ways say of friction by direction, and whether they can.
fn friction_by_direction(c: &Calibration) -> Option<Finding> {
    if c.is_one_way_missed {
        let text = "the runs cannot separate direction-dependent friction from the force per volt: a 10 % difference in friction shifts it by about 3 %. Repeat runs without weight in \
                    both directions";
        return Some(Finding::new(Severity::Warning, "friction-by-direction", text.to_owned()));
    }
    let one_way = c.one_way_n.filter(|d| t_two_sided(d.value / d.standard, d.dof) < BY_DIRECTION)?;
    let text = format!(
        "friction is {} N along +y and {} N along −y: the force per volt accounts for both; check for a tilted rail, a cable or a brake",
        number::significant(c.friction_n + one_way.value, 3),
        number::significant(c.friction_n - one_way.value, 3)
    );
    Some(Finding::new(Severity::Note, "friction-by-direction", text))
}

/// The same from what such runs showed.
#[must_use]
pub fn calibration_from(
    readings: &Readings,
    campaign: Option<&DrivenCampaign>,
    setup: &DragSetup,
) -> (Option<Calibration>, Option<Finding>) {
    if readings.is_empty() {
        return (None, None);
    }
    let weight_relative = declared_weight_relative(campaign);
    let asked = CalibrationSetup {
        ideal_force_per_volt_n: setup.ideal_force_per_volt_n,
        ideal_relative: setup.torque_constant_relative.hypot(setup.speed_scale_relative),
        weight_relative,
        pulley_loss: pulley_loss(campaign),
        steady: setup.steady,
    };
    match readings.calibrate(&asked) {
        Ok(c) if c.efficiency.value > 1.0 + 3.0 * c.efficiency.standard || c.efficiency.relative() > USELESS => (
            None,
            Some(Finding::new(
                Severity::Error,
                "calibration-impossible",
                format!(
                    "the known weights give a gear efficiency of {} ± {}: not used. Check that the weight hung free over the whole travel (floor), the \
                     declared weights, K_T, the amplifier's gain and the sprocket's radius",
                    number::significant(c.efficiency.value, 3),
                    number::significant(c.efficiency.standard, 2)
                ),
            )),
        ),
        Ok(calibration) => {
            let finding = friction_by_direction(&calibration);
            (Some(calibration), finding)
        }
        Err(error) => (None, Some(Finding::new(Severity::Warning, "not-calibrated", error.to_string()))),
    }
}

/// Key of a calibration: of the runs that it was made from. Whoever calibrates with the same runs has the same error.
fn calibrated_by(runs: &Runs) -> Result<Option<String>, MethodError> {
    let of = |log: &&RunLog| log.meta.role == Role::Calibration;
    let mut sums = runs.logs.iter().filter(of).map(|log| sha256_of_file(&log.path)).collect::<Result<Vec<_>, _>>()?;
    sums.sort_unstable();
    Ok((!sums.is_empty()).then(|| format!("force_per_volt/{}", short_key(sums.join(" ").as_bytes()))))
}

/// Key of the rig: campaigns that declare the same constants drove the same one. Runs without their campaign say theirs themselves (`axis`).
#[must_use]
pub fn rig_key(runs: &Runs, axis: Option<&AxisConstants>) -> Option<String> {
    if let Some(logs) = runs.campaign.as_ref().and_then(|c| c.logs.as_ref()) {
        let LogsRig { force_per_unit: Declared { value, standard_uncertainty }, is_current, position_relative, .. } =
            logs;
        let text = format!("{value:e} {standard_uncertainty:e} {is_current} {position_relative:e}");
        return Some(format!("rig/{}", short_key(text.as_bytes())));
    }
    let carriage = runs.campaign.as_ref().and_then(|c| c.carriage.as_ref());
    let AxisConstants {
        torque_constant_n_m_a,
        amplifier_a_v,
        gear_ratio,
        sprocket_radius_m,
        counts_per_revolution,
        ..
    } = carriage.map(|c| &c.rig.y.constants).or(axis)?;
    let all = [torque_constant_n_m_a, amplifier_a_v, gear_ratio, sprocket_radius_m];
    Some(format!("rig/{}", short_key(format!("{all:?} {counts_per_revolution}").as_bytes())))
}

/// Keys of the errors that other campaigns may have too. Campaigns that declare the same constants drove the same rig, with the same sensor.
fn keys(runs: &Runs, axis: Option<&AxisConstants>) -> Result<ErrorKeys, MethodError> {
    let carriage = runs.campaign.as_ref().and_then(|c| c.carriage.as_ref());
    let sensor = carriage.and_then(|c| c.rig.force_sensor.as_ref()).filter(|sensor| sensor.gain_standard.is_some());
    let key = |what: &str, text: String| format!("{what}/{}", short_key(text.as_bytes()));
    let rig = rig_key(runs, axis);
    let is_of_logs = runs.campaign.as_ref().is_some_and(|c| c.logs.is_some());
    Ok(ErrorKeys {
        // A declared force per volt is the rig's.
        calibration: if is_of_logs { rig.clone().map(|rig| format!("{rig}/force")) } else { calibrated_by(runs)? },
        rig,
        sensor: sensor.map(|sensor| key("sensor", format!("{sensor:?}"))),
    })
}
