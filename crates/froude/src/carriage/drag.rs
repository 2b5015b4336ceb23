//! D_d and C_D by force sensor, motor current and model, from the runs of a campaign.

use std::collections::BTreeSet;
use std::path::Path;

use froude_carriage::drag::calibration::{Calibration, CalibrationSetup, PULLEY_LOSS, Readings};
use froude_carriage::drag::coefficient::Method;
use froude_carriage::drag::report::{DragReport, drag_by};
use froude_carriage::drag::run::{self as drag_run, Ballast, DragRun, DragSetup, Efficiency, ErrorKeys, SensorBudget};
use froude_fit::budget::Uncertain;
use froude_records::campaign::Campaign;
use froude_records::finding::{Finding, Severity};
use froude_records::hash::{sha256_of_file, short_key};
use froude_records::number;
use froude_records::page::{Chart, ChartPanel, DocumentSection, Mark, Series, TextTable};
use froude_records::run::{AxisConstants, Role, RunLog};
use froude_records::text::counted;

use super::drive::STOPPED_EARLY;
use super::runs::{Runs, density_kg_m3, for_drag};
use super::servo::two_masses;
use crate::Error;

/// Standard acceleration of gravity, m/s².
const G_M_S2: f64 = 9.80665;

/// A calibration that knows newtons a volt to less than this part is none.
const USELESS: f64 = 0.2;

/// Standard uncertainty of the gain of a force sensor of which nobody declares it: what a cell in use has, a year after its certificate.
const UNDECLARED_GAIN: f64 = 0.01;

/// Standard uncertainty of the ballast that the operator puts on, as a part: it is weighed, the body's volume is what limits it.
const BALLAST_RELATIVE: f64 = 0.005;

/// Runs of a campaign, reduced by every method that they allow.
pub(super) struct Reduction {
    pub runs: Runs,
    pub setup: DragSetup,
    pub calibration: Option<Calibration>,
    pub report: DragReport,
}

/// Calibrates where known weights were hung, and reduces by these methods.
pub(super) fn reduce(runs: Runs, methods: &[Method]) -> Result<Reduction, Error> {
    let reduced: Vec<DragRun<'_>> =
        runs.logs.iter().map(for_drag).collect::<Result<Vec<_>, _>>()?.into_iter().flatten().collect();
    let constants = runs.logs.iter().find_map(|log| log.meta.moving_axis());
    let (two_masses, no_two_masses) = two_masses(&runs.logs);
    let mut setup = setup_of(runs.campaign.as_ref(), constants);
    setup.travel = runs.travel;
    setup.flexible = two_masses.map(|report| report.flexible());
    let (calibration, why_not) = calibration_of(&reduced, runs.campaign.as_ref(), &setup);
    setup.calibration = calibration.as_ref().map(|c| c.force_per_volt);
    setup.keys = keys(&runs, constants)?;
    let undeclared = undeclared(runs.campaign.as_ref(), &reduced)?;
    let stopped = stopped_early(&runs, &reduced);
    setup.looks = stopped.map_or(1, |s| s.planned);
    let part = part_of(&runs);
    if let Some(part) = &part {
        setup.name = format!("{}, {}", setup.name, part.of);
    }
    let mut report = drag_by(&reduced, &setup, methods)?;
    report.findings.extend(undeclared);
    report.findings.extend(part.map(|part| part.finding));
    report.findings.extend(stopped.map(|stop| stop.finding(runs.beside > 0)));
    report.findings.extend(runs.findings.iter().cloned());
    report.findings.extend(why_not);
    report.findings.extend(no_two_masses);
    report.findings.sort_by_key(|f| std::cmp::Reverse(f.severity));
    drop(reduced);
    Ok(Reduction { runs, setup, calibration, report })
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
        "{named} of the {all} runs that lie there and tell drag {} named: this is no result of the campaign, and its record is called \
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
            "the campaign stopped {when}because its interval was short enough; chance makes some intervals short, so that all \
             intervals here hold over {} (Bonferroni)",
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
/// Wet runs without ballast of a body whose volume is not declared: nothing says what buoyancy takes off the wheels.
fn undeclared(campaign: Option<&Campaign>, runs: &[DragRun<'_>]) -> Result<Option<Finding>, Error> {
    let carriage = campaign.and_then(|c| c.carriage.as_ref());
    let is_ballasted = carriage.and_then(|c| c.plan.as_ref()).is_none_or(|p| p.is_ballasted);
    let volume_m3 = campaign.and_then(|c| c.body.as_ref()).and_then(|b| b.volume_m3);
    if !is_ballasted && volume_m3.is_none() {
        return Err(Error::Nothing(
            "the wet runs carried no ballast and the campaign declares no volume of the body: nothing says what buoyancy takes off the \
             wheels. Write volume = \"6.283e-3 m^3\" (its own) in [body]; 0 is not assumed"
                .to_owned(),
        ));
    }
    let has_sensor = runs.iter().any(|r| r.force_n.is_some());
    let gain = carriage.and_then(|c| c.rig.force_sensor.as_ref()).and_then(|f| f.gain_standard);
    Ok((has_sensor && gain.is_none()).then(|| {
        Finding::new(
            Severity::Note,
            "gain-not-declared",
            format!(
                "no uncertainty of the force sensor's gain is declared; {} is taken. Write gain_standard in [rig.force_sensor]",
                number::percent(UNDECLARED_GAIN)
            ),
        )
    }))
}

/// What is declared, from the campaign where there is one, else from what the runs say of their rig.
#[must_use]
pub(crate) fn setup_of(campaign: Option<&Campaign>, axis: Option<&AxisConstants>) -> DragSetup {
    let mut setup = DragSetup::of_the_paper();
    setup.efficiency = Efficiency::Undeclared;
    setup.density_kg_m3 = density_kg_m3(campaign);
    let carriage = campaign.and_then(|c| c.carriage.as_ref());
    if let Some(campaign) = campaign {
        setup.name.clone_from(&campaign.name);
        setup.reference_area_m2 = campaign.body.as_ref().and_then(|b| b.reference_area_m2);
        setup.travel = campaign.body.as_ref().and_then(|b| b.travel);
    }
    let spec = carriage.map(|c| &c.rig.y);
    if let Some(c) = spec.map(|s| &s.constants).or(axis) {
        let ratio = c.gear_ratio.value / c.sprocket_radius_m.value;
        setup.ideal_force_per_volt_n = ratio * c.torque_constant_n_m_a.value * c.amplifier_a_v.value;
        let relative = |d: &froude_records::run::Declared| d.standard_uncertainty / d.value;
        setup.torque_constant_relative = relative(&c.torque_constant_n_m_a).hypot(relative(&c.amplifier_a_v));
        setup.speed_scale_relative = relative(&c.sprocket_radius_m);
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
        campaign.and_then(|c| c.body.as_ref()).and_then(|b| b.volume_m3).map(|v| setup.density_kg_m3 * v);
    let strut = carriage.and_then(|c| c.plan.as_ref()).and_then(|p| p.strut_drag_n_s2_m2);
    setup.strut_n_s2_m2 = strut.map(|s| Uncertain::new(s.value, s.standard_uncertainty));
    setup.ballast = match carriage.and_then(|c| c.plan.as_ref()).map(|p| p.is_ballasted) {
        Some(false) => Ballast::Unballasted { unloaded_n: G_M_S2 * displaced_kg.unwrap_or(0.0), rolling: None },
        _ => Ballast::Matched { carried_kg: displaced_kg.map(|kg| Uncertain::new(kg, BALLAST_RELATIVE * kg)) },
    };
    setup
}

/// Standard uncertainty of the weights, as a part: that of the heaviest, which tells the most.
pub(crate) fn weight_relative(calibration: &froude_records::carriage::Calibration) -> f64 {
    calibration.weight_standard_n / calibration.weights_n.iter().copied().fold(f64::MIN_POSITIVE, f64::max)
}

/// Calibration from the runs with weights; a finding where there are such runs and they do not calibrate.
pub(crate) fn calibration_of(
    runs: &[DragRun<'_>],
    campaign: Option<&Campaign>,
    setup: &DragSetup,
) -> (Option<Calibration>, Option<Finding>) {
    let mut readings = Readings::default();
    for run in runs {
        readings.push(run, setup.steady);
    }
    calibration_from(&readings, campaign, setup)
}

/// The same from what such runs showed.
pub(crate) fn calibration_from(
    readings: &Readings,
    campaign: Option<&Campaign>,
    setup: &DragSetup,
) -> (Option<Calibration>, Option<Finding>) {
    if readings.is_empty() {
        return (None, None);
    }
    let declared =
        campaign.and_then(|c| c.carriage.as_ref()).and_then(|c| c.plan.as_ref()).and_then(|p| p.calibration.as_ref());
    let weight_relative = declared.map_or(1e-3, weight_relative);
    let asked = CalibrationSetup {
        ideal_force_per_volt_n: setup.ideal_force_per_volt_n,
        weight_relative,
        pulley_loss: declared
            .and_then(|c| c.pulley_loss)
            .map_or(PULLEY_LOSS, |p| Uncertain::new(p.value, p.standard_uncertainty)),
        steady: setup.steady,
    };
    match readings.calibrate(&asked) {
        Ok(c) if c.efficiency.value > 1.0 + 3.0 * c.efficiency.standard || c.efficiency.relative() > USELESS => (
            None,
            Some(Finding::new(
                Severity::Error,
                "calibration-impossible",
                format!(
                    "the known weights say a gear of efficiency {} ± {}: not used. Look whether the weight hung all the way (floor), at the \
                     weights declared, K_T, the amplifier's gain and the sprocket's radius",
                    number::significant(c.efficiency.value, 3),
                    number::significant(c.efficiency.standard, 2)
                ),
            )),
        ),
        Ok(calibration) => (Some(calibration), None),
        Err(error) => (None, Some(Finding::new(Severity::Warning, "not-calibrated", error.to_string()))),
    }
}

/// Key of a calibration: of the runs that it was made from. Whoever calibrates with the same runs has the same error.
fn calibrated_by(runs: &Runs) -> Result<Option<String>, Error> {
    let of = |log: &&RunLog| log.meta.role == Role::Calibration;
    let mut sums = runs.logs.iter().filter(of).map(|log| sha256_of_file(&log.path)).collect::<Result<Vec<_>, _>>()?;
    sums.sort_unstable();
    Ok((!sums.is_empty()).then(|| format!("force_per_volt/{}", short_key(sums.join(" ").as_bytes()))))
}

/// Keys of the errors that other campaigns may have too. Campaigns that declare the same constants drove the same rig, with the same sensor.
fn keys(runs: &Runs, axis: Option<&AxisConstants>) -> Result<ErrorKeys, Error> {
    let carriage = runs.campaign.as_ref().and_then(|c| c.carriage.as_ref());
    let used = carriage.map(|c| &c.rig.y.constants).or(axis);
    let sensor = carriage.and_then(|c| c.rig.force_sensor.as_ref()).filter(|sensor| sensor.gain_standard.is_some());
    let key = |what: &str, text: String| format!("{what}/{}", short_key(text.as_bytes()));
    Ok(ErrorKeys {
        calibration: calibrated_by(runs)?,
        rig: used.map(|c| {
            let AxisConstants {
                torque_constant_n_m_a,
                amplifier_a_v,
                gear_ratio,
                sprocket_radius_m,
                counts_per_revolution,
                ..
            } = c;
            let all = [torque_constant_n_m_a, amplifier_a_v, gear_ratio, sprocket_radius_m];
            key("rig", format!("{all:?} {counts_per_revolution}"))
        }),
        sensor: sensor.map(|sensor| key("sensor", format!("{sensor:?}"))),
    })
}

/// What belongs to all methods on the page: the paper's Table IV with its figure, which is the summary; calibration and runs.
pub(super) fn sections(reduction: &Reduction) -> (DocumentSection, Vec<DocumentSection>) {
    let Reduction { runs, setup, calibration, report } = reduction;
    let drag = DocumentSection {
        title: "Drag by every method".to_owned(),
        paragraphs: summary(report, setup),
        tables: vec![methods_table(report)],
        charts: vec![force_chart(report)],
    };
    let mut more = Vec::new();
    if let Some(c) = calibration {
        let mut paragraphs = vec![format!(
            "{} N/V with its interval {} N/V, from {}; the gear's efficiency is {}.",
            number::short_form(c.force_per_volt.force_per_volt_n.value, c.force_per_volt.force_per_volt_n.standard),
            number::interval(c.interval_95),
            counted(c.used, "driving run", "driving runs"),
            number::short_form(c.efficiency.value, c.efficiency.standard),
        )];
        paragraphs.extend(c.notes.iter().cloned());
        more.push(DocumentSection { title: "Calibration".to_owned(), paragraphs, ..DocumentSection::default() });
    }
    let rows = runs
        .logs
        .iter()
        .map(|log| {
            let m = &log.meta;
            vec![
                m.id.clone(),
                m.role.name().to_owned(),
                m.carriage.pair.map_or_else(|| "–".to_owned(), |p| p.to_string()),
                m.carriage.target_speed_m_s.map_or_else(|| "–".to_owned(), |v| number::plain(v, 3)),
                super::runs::way(m.carriage.direction).to_owned(),
                number::plain(log.duration_s(), 3),
            ]
        })
        .collect();
    more.push(DocumentSection {
        title: "Runs".to_owned(),
        tables: vec![TextTable {
            caption: "Complete runs that were read.".to_owned(),
            head: ["run", "kind", "pair", "speed [m/s]", "way", "length [s]"].map(str::to_owned).to_vec(),
            rows,
        }],
        ..DocumentSection::default()
    });
    (drag, more)
}

/// What the runs say, in sentences.
fn summary(report: &DragReport, setup: &DragSetup) -> Vec<String> {
    let mut out = Vec::new();
    if let Some(c) = report.coefficients.iter().find(|c| Some(c.method) == report.recommended) {
        let half = c.interval_95.map(|[l, h]| 0.5 * (h - l));
        let value = half.map_or_else(|| number::plain(c.value, 4), |h| number::plus_minus(c.value, h));
        out.push(format!("Recommended: {}, D_d = {value} N s²/m² (95 %).", c.method.words()));
    } else {
        let has_interval = report.coefficients.iter().any(|c| c.interval_95.is_some());
        let why = if has_interval {
            "neither the force sensor nor the difference of wet and dry runs states an interval here, and those of the models rest on \
             their own friction"
        } else {
            "no method can state an interval from these runs"
        };
        out.push(format!("No D_d is recommended: {why}."));
    }
    if setup.calibration.is_none() {
        out.push(
            "Newtons a volt were not calibrated with known weights: no D_d from motor currents is stated better than the declared \
             efficiency of the gear and K_T allow."
                .to_owned(),
        );
    }
    if let Some(d) = &report.detectability {
        out.push(format!(
            "One wet-less-dry difference scatters by {} N (dry repeats, {}); {} at a speed {} a drag above {} N.",
            number::significant(d.difference_n, 2),
            number::degrees_of_freedom(d.dof),
            counted(d.differences, "difference", "differences"),
            if d.differences == 1 { "shows" } else { "show" },
            number::significant(d.expanded_n, 2),
        ));
        out.push(format!(
            "Over all speeds together the smallest D_d that exceeds its scatter is {} N s²/m².",
            number::significant(d.smallest_n_s2_m2, 2)
        ));
        let speeds = report.coefficients.iter().flat_map(|c| c.points.iter().map(|p| p.speed_m_s.abs()));
        let slowest = speeds.fold(f64::INFINITY, f64::min);
        if let Some(c) = report.coefficients.iter().find(|c| c.method == Method::Mcd) {
            out.extend(d.advice(c.value, slowest));
        }
    }
    if let Some(a) = &report.agreement {
        out.push(format!(
            "The wet repeats scatter by {} N where {} N were predicted (p = {}).",
            number::significant(a.observed_n, 2),
            number::significant(a.predicted_n, 2),
            number::p_value(a.p),
        ));
    }
    if let Some(m) = &report.added_mass {
        let what = match m.ballast_kg {
            Some(kg) if kg != 0.0 => {
                format!(
                    "water that moves along (added mass, water inside; {} kg of ballast taken off)",
                    number::plain(kg, 3)
                )
            }
            Some(_) => "water that moves along (added mass, water inside)".to_owned(),
            None => {
                "what the wet run carries more than the dry one (added mass, water inside, ballast of unknown mass)"
                    .to_owned()
            }
        };
        out.push(format!(
            "From the ramps: {what}: {} kg, interval {} kg, {}.",
            number::short_form(m.mass_kg.value, m.mass_kg.standard),
            number::interval(m.interval_95),
            counted(m.runs, "pair of runs", "pairs of runs")
        ));
    }
    out
}

/// The methods side by side: the paper's Table IV.
fn methods_table(report: &DragReport) -> TextTable {
    let rows = report
        .coefficients
        .iter()
        .zip(&report.drag_coefficients)
        .zip(&report.ratios)
        .map(|((c, drag), ratio)| {
            let missing = || number::MISSING.to_owned();
            vec![
                c.method.words().to_owned(),
                number::plain(c.value, 5),
                c.interval_95.map_or_else(missing, number::interval),
                c.relative_half_width().map_or_else(missing, number::percent),
                drag.map_or_else(missing, |(value, _)| number::plain(value, 4)),
                drag.and_then(|(_, i)| i).map_or_else(missing, number::interval),
                number::plain(*ratio, 4),
                c.pairs.to_string(),
            ]
        })
        .collect();
    TextTable {
        caption: "D_d by every method that the runs allow; ratio to the force sensor, or to MCD where there is none."
            .to_owned(),
        head: ["method", "D_d [N s²/m²]", "95 % interval", "half-width", "C_D [1]", "95 % interval", "ratio", "pairs"]
            .map(str::to_owned)
            .to_vec(),
        rows,
    }
}

/// Force over speed by method, with the recommended curve: the paper's Figure 2.
fn force_chart(report: &DragReport) -> Chart {
    let mut series: Vec<Series> = report
        .coefficients
        .iter()
        .map(|c| Series {
            name: c.method.name().to_owned(),
            mark: Mark::Points,
            x: c.points.iter().map(|p| p.speed_m_s).collect(),
            y: c.points.iter().map(|p| p.force_n).collect(),
            ..Series::default()
        })
        .collect();
    if let Some(c) = report.coefficients.iter().find(|c| Some(c.method) == report.recommended) {
        let fastest = c.points.iter().map(|p| p.speed_m_s).fold(0.0, f64::max);
        let slowest = c.points.iter().map(|p| p.speed_m_s).fold(0.0, f64::min);
        let x: Vec<f64> = (0..=100).map(|i| slowest + (fastest - slowest) * f64::from(i) / 100.0).collect();
        let [low, high] = c.interval_95.unwrap_or([c.value; 2]);
        let curve = |d: f64| x.iter().map(|v| d * v * v.abs()).collect::<Vec<f64>>();
        series.push(Series {
            name: format!("D_d v|v|, {}", c.method.name()),
            mark: Mark::Line,
            y: curve(c.value),
            low: x.iter().map(|v| (low * v * v.abs()).min(high * v * v.abs())).collect(),
            high: x.iter().map(|v| (low * v * v.abs()).max(high * v * v.abs())).collect(),
            x,
        });
    }
    Chart {
        name: "drag".to_owned(),
        title: "Drag over speed".to_owned(),
        caption:
            "Drag of each steady window by method; the line is D_d v|v| of the recommended one with its 95 % band."
                .to_owned(),
        x_label: "speed [m/s]".to_owned(),
        panels: vec![ChartPanel { y_label: "drag [N]".to_owned(), series, ..ChartPanel::default() }],
        ..Chart::default()
    }
}
