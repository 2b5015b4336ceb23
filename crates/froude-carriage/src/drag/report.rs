//! All methods side by side over one campaign: the paper's Table IV with what it lacked.

use froude_fit::budget::Kind;
use froude_fit::distribution::coverage_factor;
use froude_identify::IdentifyError;
use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};
use froude_records::number::significant;
use froude_records::text::counted;

use super::added_mass::{AddedMass, added_mass};
use super::coefficient::Coefficient;
use super::detectability::{Agreement, Detectability, agreement, zero_change};
use super::error::DragError;
use super::observed::{Reported, Tows};
use super::record;
use super::run::{BodyState, DragRun, RunKind};
use super::steady::Rejected;
use crate::drag::differences::coefficient;
use crate::drag::point::Method;
use crate::drag::setup::{Ballast, DragSetup, Efficiency};

/// Fewer pairs than this have an interval that is mostly Student's t.
const FEW_PAIRS: usize = 4;
/// A constant force beside the drag is reported when it exceeds this many standard uncertainties of its own …
const OFFSET_REPORTED: f64 = 3.0;
/// … and moves D_d by more than this part of it.
const OFFSET_MATTERS: f64 = 0.005;

/// What the runs say about the drag.
#[derive(Debug, Clone)]
pub struct DragReport {
    /// D_d by every method that the runs allow: FSM, MCD, MBDP constant, mapped, flexible.
    pub coefficients: Vec<Coefficient>,
    /// D_d of the reference method: the force sensor, else MCD, else the first.
    pub reference_n_s2_m2: Option<f64>,
    /// The method whose estimate is recommended.
    pub recommended: Option<Method>,
    /// What the dry repeats predict.
    pub detectability: Option<Detectability>,
    /// Whether the wet repeats kept it.
    pub agreement: Option<Agreement>,
    /// Added mass plus entrained water.
    pub added_mass: Option<AddedMass>,
    /// Runs that gave no point, with the method.
    pub rejected: Vec<(Method, Rejected)>,
    /// What is doubtful.
    pub findings: Vec<Finding>,
    /// The coefficients as records.
    pub estimates: Vec<Estimate>,
}

/// Reduces a campaign's runs to D_d and C_D by every method that they allow.
///
/// # Errors
///
/// [`DragError`] for columns of unequal length, samples that are not finite, impossible declarations, no wet run. A run
/// without a usable window is no error: it is left out and reported.
pub fn drag_report(runs: &[DragRun<'_>], setup: &DragSetup) -> Result<DragReport, DragError> {
    drag_by(runs, setup, &Method::ALL)
}

/// The same by some of the methods; nothing is stated about the others.
///
/// # Errors
///
/// As [`drag_report`].
pub fn drag_by(runs: &[DragRun<'_>], setup: &DragSetup, methods: &[Method]) -> Result<DragReport, DragError> {
    check(runs, setup)?;
    let tows = Tows::of(runs, setup);
    if tows.wet.is_empty() {
        let given = counted(runs.len(), "run", "runs");
        return Err(DragError(format!("no wet run among {given}: drag needs tows with the body in the water")));
    }
    let mut reported = Reported::default();
    let mut coefficients: Vec<Coefficient> = Vec::new();
    for method in Method::ALL.into_iter().filter(|method| methods.contains(method)) {
        let Some(observed) = tows.observed(method, setup, &mut reported) else { continue };
        let elsewhere = observed.elsewhere;
        if let Some(mut c) = or_reported(method, coefficient(observed, setup), &mut reported.findings) {
            reported.findings.append(&mut c.result.findings);
            reported.findings.extend(elsewhere.map(|elsewhere| elsewhere.finding(method, c.value)));
            coefficients.push(c);
        }
    }
    Ok(judge(runs, setup, coefficients, methods.contains(&Method::Mcd).then_some(&tows), reported))
}

/// The methods beside each other: which is the best, whether they agree among themselves and with what the dry repeats predict.
///
/// `tows` where motor current differences were asked for.
fn judge(
    runs: &[DragRun<'_>],
    setup: &DragSetup,
    mut coefficients: Vec<Coefficient>,
    tows: Option<&Tows<'_, '_>>,
    reported: Reported,
) -> DragReport {
    let Reported { rejected, mut findings } = reported;
    let by = |method: Method| coefficients.iter().find(|c| c.method == method);
    let reference_n_s2_m2 = by(Method::Fsm).or(by(Method::Mcd)).or(coefficients.first()).map(|c| c.value);
    let differences = by(Method::Mcd).map_or(&[][..], |c| &c.points);
    let promised = tows.filter(|tows| !tows.dry.is_empty()).and_then(|tows| tows.promised(differences, setup));
    let agrees = promised.as_ref().and_then(|d| agreement(differences, d, setup));
    let detectability = promised.map(|d| Detectability { zero_change_n: zero_change(runs, setup), ..d });
    let recommended = recommended(coefficients.iter().filter(|c| !is_impossible(c, setup)));
    findings.extend(doubts(runs, setup, &coefficients, detectability.as_ref(), agrees));
    let added_mass = added_mass(runs, setup);
    findings.extend(added_mass.as_ref().filter(|m| m.interval_95[1] < 0.0).map(|m| {
        Finding::new(
            Severity::Warning,
            "negative-added-mass",
            format!(
                "the ramps give {:.2} kg of added mass plus entrained water, which no body has. Check the ballast \
                 (volume), counts_per_revolution, and that dry and wet runs are labelled correctly",
                m.mass_kg.value
            ),
        )
    }));
    let is_swing = |why: &Rejected| matches!(why, Rejected::Swings { .. });
    findings.extend(swings(&rejected));
    findings.extend(
        rejected
            .iter()
            .filter(|(_, why)| !is_swing(why))
            .map(|(method, why)| Finding::new(Severity::Warning, "run-left-out", format!("{}: {why}", method.name()))),
    );
    for c in &mut coefficients {
        let (notes, is_best) = (record::notes(c, setup, runs), recommended == Some(c.method));
        c.result.n_read = runs.len();
        for estimate in &mut c.result.estimates {
            estimate.diagnostics.notes.clone_from(&notes);
            estimate.recommended = is_best;
            // What is declared is known also where nothing tells the scatter.
            for coefficient in estimate.coefficients.values_mut() {
                coefficient.type_b = Some(c.type_b);
            }
        }
    }
    DragReport {
        reference_n_s2_m2,
        recommended,
        detectability,
        agreement: agrees,
        added_mass,
        rejected,
        findings,
        estimates: coefficients.iter().flat_map(|c| c.result.estimates.iter().cloned()).collect(),
        coefficients,
    }
}

/// A method that cannot be fitted costs its own row and says so.
fn or_reported(
    method: Method,
    fitted: Result<Option<Coefficient>, IdentifyError>,
    findings: &mut Vec<Finding>,
) -> Option<Coefficient> {
    fitted.unwrap_or_else(|error| {
        findings.push(Finding::new(Severity::Warning, "not-fitted", format!("{}: {error}", method.name())));
        None
    })
}

/// The narrowest interval among the methods that need no model of the friction, or the first method's; a number without an interval or that no body has is
/// recommended to nobody.
#[must_use]
fn recommended<'a>(all: impl IntoIterator<Item = &'a Coefficient> + Clone) -> Option<Method> {
    all.clone()
        .into_iter()
        .filter(|c| matches!(c.method, Method::Fsm | Method::Mcd))
        .filter_map(|c| c.relative_half_width().map(|h| (c.method, h)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .map(|m| m.0)
        .or_else(|| all.into_iter().next().filter(|c| c.interval_95.is_some()).map(|c| c.method))
}

/// Lints of the result.
fn doubts(
    runs: &[DragRun<'_>],
    setup: &DragSetup,
    all: &[Coefficient],
    detectability: Option<&Detectability>,
    agreement: Option<Agreement>,
) -> Vec<Finding> {
    let mut out: Vec<Finding> = not_calibrated(setup, all).into_iter().chain(wheel_load(runs, setup)).collect();
    for c in all {
        out.extend(unphysical(c, setup));
        out.extend([few_pairs(c), constant_beside_drag(c), drifts_in_window(c)].into_iter().flatten());
    }
    if let (Some(d), Some(c)) = (detectability, all.iter().find(|c| c.method == Method::Mcd)) {
        let slowest = c.points.iter().map(|p| p.speed_m_s.abs()).fold(f64::INFINITY, f64::min);
        let advice = d.advice(c.value, slowest);
        out.extend(advice.map(|text| Finding::new(Severity::Note, "under-uncertainty", text)));
    }
    out.extend(sensor_against_current(all));
    out.extend(agreement.filter(|a| !a.is_within_band()).map(wet_scatters_otherwise));
    out
}

fn not_calibrated(setup: &DragSetup, all: &[Coefficient]) -> Option<Finding> {
    if setup.calibration.is_some() || !all.iter().any(|c| c.method.is_sensorless()) {
        return None;
    }
    let text = match setup.efficiency {
        Efficiency::Undeclared => "the drive is not calibrated and no gear efficiency is declared: eq. 8 and 9 are used as \
             printed, which gives F/η (25 % too much at η = 0.8); the intervals cover efficiencies from 0.6 to 1. Calibrate \
             with a known weight over a pulley"
            .to_owned(),
        Efficiency::Declared(e) => format!(
            "not calibrated: no D_d from the motor's current is more accurate than the declared efficiency ({:.1} %) and K_T \
             ({:.1} %) allow",
            100.0 * e.relative(),
            100.0 * setup.torque_constant_relative
        ),
    };
    Some(Finding::new(Severity::Warning, "not-calibrated", text))
}

/// What buoyancy takes from the wheels, where nothing replaces it or the runs say otherwise than the setup.
fn wheel_load(runs: &[DragRun<'_>], setup: &DragSetup) -> Option<Finding> {
    let is_dry_and_light = |r: &DragRun<'_>| r.kind == RunKind::Tow && r.body == BodyState::Dry && !r.is_ballasted;
    let (code, text) = match setup.ballast {
        Ballast::Unballasted { unloaded_n, rolling: None } => (
            "wet-not-ballasted",
            format!(
                "the wet runs carried no ballast to replace the wheel load that buoyancy removes, {unloaded_n:.0} N: at a \
                 rolling resistance coefficient of 0.01 that is {:.2} N of friction, which appears as less drag; the intervals cover \
                 coefficients from 0 to 0.02",
                0.01 * unloaded_n
            ),
        ),
        Ballast::Matched { .. } if runs.iter().any(is_dry_and_light) => (
            "ballast-contradicts",
            "the setup states that wheel loads match, but runs are marked as not ballasted; state how much load buoyancy removes"
                .to_owned(),
        ),
        _ => return None,
    };
    Some(Finding::new(Severity::Warning, code, text))
}

/// A C_D that no body has.
fn unphysical(c: &Coefficient, setup: &DragSetup) -> Option<Finding> {
    let name = format!("D_d ({})", c.method.name());
    froude_identify::lint::drag_coefficient(&name, c.value, setup.density_kg_m3, setup.reference_area_m2?)
}

/// Whether no body has such a drag coefficient: neither its estimate nor an end of its interval.
fn is_impossible(c: &Coefficient, setup: &DragSetup) -> bool {
    let ends = c.interval_95.into_iter().flatten().map(|value| Coefficient { value, ..c.clone() });
    unphysical(c, setup).is_some() && ends.into_iter().all(|end| unphysical(&end, setup).is_some())
}

/// A pair that narrows an interval by less than this factor is no remedy.
const LITTLE: f64 = 1.1;

fn few_pairs(c: &Coefficient) -> Option<Finding> {
    let scatter_dof = c.budget.iter().find(|p| p.kind == Kind::A).map_or(0.0, |p| p.dof[0]);
    if c.pairs >= FEW_PAIRS || scatter_dof >= FEW_PAIRS as f64 {
        return None;
    }
    let so = match (c.interval_95, scatter_dof.round() as usize) {
        (None, _) => "their scatter is not known, and no interval is stated".to_owned(),
        (_, dof) => {
            let variance = |is_scatter: bool| {
                let parts = c.budget.iter().filter(|part| (part.kind == Kind::A) == is_scatter);
                parts.map(|part| part.covariance[(0, 0)]).sum::<f64>()
            };
            let (pairs, known) = (c.pairs as f64, scatter_dof.max(1.0));
            // What is declared keeps its width; the scatter shrinks with the pairs, and its factor with their degrees of freedom.
            let width = |more: f64| {
                let scatter = variance(true) * pairs / (pairs + more) * coverage_factor(0.95, known + more).powi(2);
                (scatter + variance(false) * coverage_factor(0.95, f64::INFINITY).powi(2)).sqrt()
            };
            let (narrower, of_scatter) =
                (width(0.0) / width(1.0), counted(dof, "degree of freedom", "degrees of freedom"));
            if narrower < LITTLE {
                format!(
                    "the scatter has {of_scatter}, and most of the interval is due to declared errors, which more pairs leave"
                )
            } else {
                format!(
                    "the scatter has {of_scatter} and the width of its interval is mostly due to Student's t; one more pair (every speed again, wet and dry) would narrow it \
                     by a factor of about {}",
                    significant(narrower, 2)
                )
            }
        }
    };
    let text = format!("{}: {}; {so}", c.method.name(), counted(c.pairs, "pair", "pairs"));
    Some(Finding::new(Severity::Warning, "few-pairs", text))
}

fn constant_beside_drag(c: &Coefficient) -> Option<Finding> {
    let f = c.offset_n.filter(|f| f.value.abs() > OFFSET_REPORTED * f.standard)?;
    let share = Some(offset_share(c, f.value)).filter(|share| *share > OFFSET_MATTERS)?;
    let text = format!(
        "{}: a constant force of {:+.3} ± {:.3} N remains beside the drag, {:.1} % of the drag over the speeds towed: friction that wet and dry do \
         not share (wheel load, wet strut, a drifting zero)",
        c.method.name(),
        f.value,
        f.standard,
        100.0 * share
    );
    Some(Finding::new(Severity::Warning, "constant-beside-drag", text))
}

fn drifts_in_window(c: &Coefficient) -> Option<Finding> {
    let trending = c.points.iter().filter(|p| p.trend_n.is_some()).count();
    let is_observed = c.method.is_sensorless() && c.method != Method::MbdpConstant;
    (is_observed && trending > 1 + c.points.len() / 10).then(|| {
        let text = format!(
            "{}: in {trending} of {} windows the force changes by more than its noise explains",
            c.method.name(),
            c.points.len()
        );
        Finding::new(Severity::Note, "force-drifts-in-window", text)
    })
}

fn wet_scatters_otherwise(a: Agreement) -> Finding {
    let text = format!(
        "wet repeats scatter by {:.3} N where the dry ones predict {:.3} N (p = {:.4}): {}",
        a.observed_n,
        a.predicted_n,
        a.p,
        if a.ratio > 1.0 {
            "water not at rest, or a mount that does not repeat"
        } else {
            "the dry runs were disturbed, and the detection limit is too pessimistic"
        }
    );
    Finding::new(Severity::Warning, "wet-scatters-otherwise", text)
}

/// One sentence for all runs that a swinging load has spoiled: they have one cause.
fn swings(rejected: &[(Method, Rejected)]) -> Option<Finding> {
    let mut runs: Vec<&str> = Vec::new();
    let mut first = None;
    for (_, why) in rejected {
        if let Rejected::Swings { run, .. } = why {
            first = first.or(Some(why));
            if !runs.contains(&run.as_str()) {
                runs.push(run);
            }
        }
    }
    let more = if runs.len() > 1 {
        format!(" ({} likewise)", counted(runs.len() - 1, "more run", "more runs"))
    } else {
        String::new()
    };
    first.map(|why| {
        Finding::new(
            Severity::Warning,
            "load-swings",
            format!("left out of the evaluation by motor current{more}: {why}"),
        )
    })
}

/// Force sensor and motor current measure one drag: a difference beyond both intervals (E_n > 1, ISO 13528:2022, 9.7) is a fault
/// that neither budget knows.
fn sensor_against_current(all: &[Coefficient]) -> Option<Finding> {
    let of = |method: Method| {
        let c = all.iter().find(|c| c.method == method)?;
        c.interval_95.map(|interval| (c.value, interval))
    };
    let ((sensor, its), (current, other)) = (of(Method::Fsm)?, of(Method::Mcd)?);
    let apart = (sensor - current).abs();
    // The arm that points to the other value: intervals with an undeclared efficiency or buoyancy reach to one side.
    let arm = |value: f64, [low, high]: [f64; 2], to: f64| if to < value { value - low } else { high - value };
    let allowed = arm(sensor, its, current).hypot(arm(current, other, sensor));
    (apart > allowed).then(|| {
        Finding::new(
            Severity::Warning,
            "methods-disagree",
            format!(
                "force sensor and motor current differ by {apart:.3} N s^2/m^2 ({:.1} %), their intervals allow {allowed:.3}: one of the \
                 budgets misses something. Check the sensor's gain and alignment, the weights of the calibration, ballast and strut",
                100.0 * apart / sensor.abs()
            ),
        )
    })
}

/// What a constant force makes of D_d, as part of it: F₀ Σv²/Σv⁴ / D_d.
fn offset_share(c: &Coefficient, force_n: f64) -> f64 {
    let (square, quartic) =
        c.points.iter().fold((0.0, 0.0), |(s, q), p| (s + p.speed_m_s.powi(2), q + p.speed_m_s.powi(4)));
    (force_n * square / quartic / c.value).abs()
}

fn check(runs: &[DragRun<'_>], setup: &DragSetup) -> Result<(), DragError> {
    for run in runs {
        let n = run.time_s.len();
        let columns: [(&'static str, Option<&[f64]>); 5] = [
            ("time", Some(run.time_s)),
            ("position", Some(run.position_m)),
            ("reference speed", Some(run.reference_speed_m_s)),
            ("command", Some(run.command_v)),
            ("force", run.force_n),
        ];
        for (column, values) in columns {
            let Some(values) = values else { continue };
            if values.len() != n {
                let found = values.len();
                return Err(DragError(format!("run {:?}: {column} has {found} samples where time has {n}", run.id)));
            }
            if let Some(index) = values.iter().position(|x| !x.is_finite()) {
                return Err(DragError(format!("run {:?}: {column} at sample {index} is not finite", run.id)));
            }
        }
    }
    for (what, value) in [
        ("force per volt", setup.force_per_volt_n()),
        ("density", setup.density_kg_m3),
        ("reference area", setup.reference_area_m2.unwrap_or(1.0)),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(DragError(format!("{what} is {value}; it must be positive and finite")));
        }
    }
    Ok(())
}
