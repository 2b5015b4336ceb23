//! All methods side by side over one campaign: the paper's Table IV with what it lacked.

use froude_fit::budget::{Kind, jackknife_of_one};
use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};
use froude_records::text::counted;

use super::added_mass::{AddedMass, added_mass};
use super::coefficient::{Coefficient, Method, Point, TypeA, coefficient, each_alone, pairs, scatter, slope, slope_of};
use super::detectability::{Agreement, Detectability, DryMean, agreement, floored, predict, zero_change};
use super::error::DragError;
use super::friction::{Cell, Friction, KNOT_SPACING_M, cells};
use super::run::{Ballast, BodyState, DragRun, DragSetup, Efficiency, RunKind};
use super::steady::{Rejected, still_windows};
use super::{fsm, mbdp, mcd, record};
use crate::error::IdentifyError;
use crate::uncertainty::SharedError;

/// Fewer pairs than this have an interval that is mostly Student's t.
const FEW_PAIRS: usize = 4;
/// A constant force beside the drag is told when it exceeds this many standard uncertainties of its own …
const OFFSET_TOLD: f64 = 3.0;
/// … and moves D_d by more than this part of it.
const OFFSET_MATTERS: f64 = 0.005;

/// What the runs say about the drag.
#[derive(Debug, Clone)]
pub struct DragReport {
    /// D_d by every method that the runs allow: FSM, MCD, MBDP constant, mapped, flexible.
    pub coefficients: Vec<Coefficient>,
    /// C_D of each, with its interval, where an area is declared; same order.
    pub drag_coefficients: Vec<Option<(f64, Option<[f64; 2]>)>>,
    /// Each D_d over that of the reference method (force sensor, else MCD); same order.
    pub ratios: Vec<f64>,
    /// The method whose estimate is recommended.
    pub recommended: Option<Method>,
    /// What the dry repeats promised.
    pub detectability: Option<Detectability>,
    /// Whether the wet repeats kept it.
    pub agreement: Option<Agreement>,
    /// Water that moves along.
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
/// without a usable window is no error: it is left out and told.
pub fn drag_report(runs: &[DragRun<'_>], setup: &DragSetup) -> Result<DragReport, DragError> {
    drag_by(runs, setup, &Method::ALL)
}

/// The same by some of the methods; nothing is said of the others.
///
/// # Errors
///
/// As [`drag_report`].
pub fn drag_by(runs: &[DragRun<'_>], setup: &DragSetup, methods: &[Method]) -> Result<DragReport, DragError> {
    let is_asked = |method: Method| methods.contains(&method);
    check(runs, setup)?;
    let wet: Vec<&DragRun<'_>> = tows(runs, BodyState::Wet);
    let dry: Vec<&DragRun<'_>> = tows(runs, BodyState::Dry);
    if wet.is_empty() {
        return Err(DragError::NoWetRuns { n: runs.len() });
    }
    let mut rejected = Vec::new();
    let mut findings = Vec::new();
    let mut coefficients = Vec::new();
    if is_asked(Method::Fsm) && wet.iter().any(|r| r.force_n.is_some()) {
        let all = wet.iter().map(|r| fsm::point(r, setup.sensor.drift_half_width_n, setup.steady));
        let points = keep(all, Method::Fsm, &mut rejected);
        let type_a = sensed_scatter(&points);
        let drift = unseen_drift(&points, &wet, setup, &mut findings);
        let sensed = coefficient(Method::Fsm, points, setup, type_a, drift.into_iter().collect());
        coefficients.extend(or_told(Method::Fsm, sensed, &mut findings));
    }
    let k = setup.force_per_volt_n();
    let differences = wet.iter().map(|w| match dry.iter().find(|d| d.is_partner_of(w)) {
        Some(d) => mcd::point(w, d, k, setup.steady),
        None => {
            Err(Rejected::NoPartner { run: w.id.to_owned(), pair: w.pair, speed_m_s: w.target_speed_m_s * w.direction })
        }
    });
    let means: Vec<DryMean> = dry.iter().filter_map(|r| DryMean::of(r, setup)).collect();
    let (mut detectability, mut agrees) = (None, None);
    if is_asked(Method::Mcd) && !dry.is_empty() {
        let points = keep(differences, Method::Mcd, &mut rejected);
        let of_pairs = predict(&means, differences_per_speed(&points), pairs(&points).len(), setup);
        agrees = of_pairs.as_ref().and_then(|d| agreement(&points, d, setup));
        let of_current = of_differences(points, of_pairs.as_ref(), setup);
        coefficients.extend(or_told(Method::Mcd, of_current, &mut findings));
        detectability = of_pairs.map(|d| Detectability { zero_change_n: zero_change(runs, setup), ..d });
    }
    let sweeps: Vec<&DragRun<'_>> = runs.iter().filter(|r| r.kind == RunKind::Friction).collect();
    let for_constant = if sweeps.is_empty() { &dry } else { &sweeps };
    if is_asked(Method::MbdpConstant) {
        let constant = Method::MbdpConstant;
        coefficients.extend(model_based(constant, &wet, for_constant, &dry, setup, &mut rejected, &mut findings));
    }
    let everywhere: Vec<&DragRun<'_>> = dry.iter().chain(&sweeps).copied().collect();
    let mapped = [Method::MbdpMapped, Method::MbdpFlexible];
    let is_possible = |m: &Method| is_asked(*m) && (*m == Method::MbdpMapped || setup.flexible.is_some());
    for method in mapped.into_iter().filter(is_possible) {
        coefficients.extend(model_based(method, &wet, &everywhere, &dry, setup, &mut rejected, &mut findings));
    }
    let by = |method: Method| coefficients.iter().find(|c| c.method == method);
    let current = by(Method::Mcd);
    let reference = by(Method::Fsm).or(current).or(coefficients.first()).map(|c| c.value);
    let recommended = recommended(&coefficients);
    findings.extend(doubts(runs, setup, &coefficients, detectability.as_ref(), agrees));
    let added_mass = added_mass(runs, setup);
    findings.extend(added_mass.as_ref().filter(|m| m.interval_95[1] < 0.0).map(|m| {
        Finding::new(
            Severity::Warning,
            "negative-added-mass",
            format!(
                "the ramps say that {:.2} kg of water move along: no body has that. Look at the ballast (volume), at \
                 counts_per_revolution, and whether dry and wet runs are what they are called",
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
    let estimates =
        coefficients.iter().map(|c| record::estimate(c, setup, runs, recommended == Some(c.method))).collect();
    Ok(DragReport {
        drag_coefficients: coefficients
            .iter()
            .map(|c| setup.reference_area_m2.map(|a| c.drag_coefficient(setup.density_kg_m3, a)))
            .collect(),
        ratios: coefficients.iter().map(|c| c.value / reference.unwrap_or(f64::NAN)).collect(),
        recommended,
        detectability,
        agreement: agrees,
        added_mass,
        rejected,
        findings,
        estimates,
        coefficients,
    })
}

fn tows<'r, 'a>(runs: &'r [DragRun<'a>], body: BodyState) -> Vec<&'r DragRun<'a>> {
    runs.iter().filter(|r| r.kind == RunKind::Tow && r.body == body).collect()
}

/// The points that came out; the others are noted.
fn keep(
    all: impl Iterator<Item = Result<Point, Rejected>>,
    method: Method,
    rejected: &mut Vec<(Method, Rejected)>,
) -> Vec<Point> {
    let mut out = Vec::new();
    for point in all {
        match point {
            Ok(point) => out.push(point),
            Err(why) => rejected.push((method, why)),
        }
    }
    out
}

/// A method that cannot be fitted costs its own row and says so.
fn or_told(
    method: Method,
    fitted: Result<Option<Coefficient>, IdentifyError>,
    findings: &mut Vec<Finding>,
) -> Option<Coefficient> {
    fitted.unwrap_or_else(|error| {
        findings.push(Finding::new(Severity::Warning, "not-fitted", format!("{}: {error}", method.name())));
        None
    })
}

/// Where stand-stills do not bracket the tow, the sensor's drift is not seen and may be the same in all runs: then it does
/// not average down, except that it pulls the same way in tows out and back.
fn unseen_drift(
    points: &[Point],
    wet: &[&DragRun<'_>],
    setup: &DragSetup,
    findings: &mut Vec<Finding>,
) -> Option<SharedError> {
    let is_open = |r: &&&DragRun<'_>| r.force_n.is_some() && still_windows(r, setup.steady).iter().any(Option::is_none);
    let open = wet.iter().filter(is_open).count();
    if open == 0 || points.is_empty() {
        return None;
    }
    let half_n = setup.sensor.drift_half_width_n;
    findings.push(Finding::new(
        Severity::Warning,
        "zero-on-one-side",
        format!(
            "fsm: {} no still window on one side of the tow; the declared drift of ± {half_n:.2} N moves D_d by \
             up to {:.2} N s^2/m^2. Stand still for two seconds before and after",
            counted(open, "wet run has", "wet runs have"),
            half_n * slope_of(points, |_| 1.0).abs(),
        ),
    ));
    let name = "drift of the sensor that no still window shows";
    Some(SharedError::between(name, setup.load(), &vec![1.0; points.len()], [-half_n, half_n]))
}

/// Whom a run that the friction is identified from stands or falls with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cluster {
    /// A dry tow: with its pair.
    Pair(u32),
    /// A friction run: with its repeat of all speeds, or alone where repeats are not told apart.
    Sweep(u32),
}

/// Clusters of the runs that the friction is identified from.
fn clusters(runs: &[&DragRun<'_>]) -> Vec<Cluster> {
    let mut repeats = runs.iter().filter(|r| r.kind == RunKind::Friction).map(|r| r.pair);
    let first = repeats.next();
    let is_told = repeats.any(|r| Some(r) != first);
    let of = |(i, r): (usize, &&DragRun<'_>)| match r.kind {
        RunKind::Friction => Cluster::Sweep(if is_told { r.pair } else { i as u32 }),
        _ => Cluster::Pair(r.pair),
    };
    runs.iter().enumerate().map(of).collect()
}

/// MBDP. Its type A has the scatter of the pairs, the friction identified anew without each of them, and that of the friction runs,
/// each of their repeats left out in turn.
fn model_based(
    method: Method,
    wet: &[&DragRun<'_>],
    frictional: &[&DragRun<'_>],
    dry: &[&DragRun<'_>],
    setup: &DragSetup,
    rejected: &mut Vec<(Method, Rejected)>,
    findings: &mut Vec<Finding>,
) -> Option<Coefficient> {
    let is_mapped = method != Method::MbdpConstant;
    let k = setup.force_per_volt_n();
    let without_drag: Vec<(Cluster, Vec<Cell>)> =
        clusters(frictional).into_iter().zip(frictional.iter().map(|r| cells(r, setup.steady))).collect();
    let with_drag: Vec<(u32, Vec<Cell>)> = wet.iter().map(|r| (r.pair, cells(r, setup.steady))).collect();
    // A map is made where it is used: friction runs elsewhere would leave stretches of it that nobody passed.
    let towed: Vec<f64> = with_drag.iter().flat_map(|c| &c.1).map(|c| c.position_m).collect();
    let [low, high] = super::fsm::reach(&towed);
    let is_near = |c: &&Cell| !is_mapped || (low - KNOT_SPACING_M..=high + KNOT_SPACING_M).contains(&c.position_m);
    let identify = |skip: Option<Cluster>| {
        let cells = without_drag.iter().filter(|c| Some(c.0) != skip).flat_map(|c| &c.1);
        Friction::identify(cells.filter(is_near), is_mapped)
    };
    let Some(friction) = identify(None) else {
        if !frictional.is_empty() {
            let why = if is_mapped {
                "the dry runs do not pass every stretch of the tow"
            } else {
                "no dry run has a steady window"
            };
            findings.push(Finding::new(Severity::Note, "no-friction", format!("{}: left out: {why}", method.name())));
        }
        return None;
    };
    let model = setup.flexible.filter(|_| method == Method::MbdpFlexible);
    let point = |run: &DragRun<'_>| match model {
        Some(model) => mbdp::flexible_point(run, &friction, k, k / setup.ideal_force_per_volt_n, model, setup.steady),
        None => mbdp::point(run, &friction, k, setup.steady),
    };
    let points = keep(wet.iter().map(|w| point(w)), method, rejected);
    let groups = pairs(&points);
    let without = |skip: Cluster| {
        let without = identify(Some(skip))?;
        let (mut xx, mut xy) = (0.0, 0.0);
        for (_, cells) in with_drag.iter().filter(|c| Cluster::Pair(c.0) != skip && groups.contains(&c.0)) {
            let x = cells.first().map_or(0.0, |c| c.speed_m_s * c.speed_m_s.abs());
            let left = cells.iter().map(|c| c.weight * (c.command_v - without.command_v(c.position_m, c.speed_m_s)));
            xx += x * x;
            xy += x * k * left.sum::<f64>() / cells.iter().map(|c| c.weight).sum::<f64>().max(f64::MIN_POSITIVE);
        }
        (xx > 0.0).then(|| xy / xx)
    };
    let mut sweeps: Vec<Cluster> =
        without_drag.iter().map(|c| c.0).filter(|c| matches!(c, Cluster::Sweep(_))).collect();
    sweeps.dedup();
    let of_pairs = jackknife_of_one(groups.len(), |g| without(Cluster::Pair(groups[g])));
    let of_sweeps = jackknife_of_one(sweeps.len(), |g| without(sweeps[g]));
    // A wet run alone has half the variance of a difference, and friction that is known exactly adds none.
    let promised = predict(
        &dry.iter().filter_map(|r| DryMean::of(r, setup)).collect::<Vec<_>>(),
        differences_per_speed(&points),
        groups.len(),
        setup,
    );
    let of_repeats = of_pairs.map(|pairs| match &promised {
        Some(Detectability { floor_n_s2_m2: (rest, dof), .. }) => {
            held(pairs, ((0.5_f64.sqrt() * rest).hypot(on_drag(&points, setup)), *dof))
        }
        None => TypeA { standard: pairs.0, dof: pairs.1, name: "scatter between pairs" },
    });
    let named = of_repeats.map(|a| match of_sweeps {
        Some(sweeps) => {
            let (standard, dof) = together((a.standard, a.dof), sweeps);
            TypeA { standard, dof, name: "scatter of pairs and of friction runs" }
        }
        None => a,
    });
    // The same model over the dry tows should find no drag; what it finds there it finds in the wet runs too.
    let of_nothing: Vec<Point> = dry.iter().filter_map(|d| point(d).ok()).collect();
    let scatter = named.map_or(f64::INFINITY, |t| t.standard);
    let phantom = slope(&of_nothing).filter(|phantom| phantom.abs() > scatter);
    let left = phantom.map(|phantom| {
        let squares: Vec<f64> = points.iter().map(|p| p.speed_m_s * p.speed_m_s.abs()).collect();
        let name = "friction where it was not identified, left as it is";
        SharedError::of_load(name, setup.load(), &squares, phantom.abs(), f64::INFINITY)
    });
    let out = or_told(method, coefficient(method, points, setup, named, left.into_iter().collect()), findings)?;
    if let Some(phantom) = phantom {
        let from = friction.range_m;
        findings.push(Finding::new(
            Severity::Warning,
            "friction-elsewhere",
            format!(
                "{}: the friction identified from {:.2} to {:.2} m leaves a drag of {phantom:.3} N s^2/m^2 ({:.1} % of D_d) \
                 on the dry tows; identify it where the body is towed, or use the map",
                method.name(),
                from[0],
                from[1],
                100.0 * phantom / out.value
            ),
        ));
    }
    Some(out)
}

/// Two independent scatters: root of the sum of squares, degrees of freedom by Welch and Satterthwaite.
fn together((u, dof): (f64, f64), (v, other): (f64, f64)) -> (f64, f64) {
    (u.hypot(v), froude_fit::propagate::effective_dof(&[(u * u, dof), (v * v, other)]))
}

/// D_d from wet-less-dry differences, its scatter held against what the dry repeats show.
///
/// # Errors
///
/// As [`coefficient`].
pub fn of_differences(
    points: Vec<Point>,
    promised: Option<&Detectability>,
    setup: &DragSetup,
) -> Result<Option<Coefficient>, IdentifyError> {
    let type_a = scatter(&points).and_then(|(u, dof, shared)| {
        let (rest, rest_dof) = promised.filter(|_| shared == "pair")?.floor_n_s2_m2;
        Some(held((u, dof), (rest.hypot(on_drag(&points, setup)), rest_dof)))
    });
    coefficient(Method::Mcd, points, setup, type_a, Vec::new())
}

/// The scatter of pairs, or the floor under it.
fn held(seen: (f64, f64), floor: (f64, f64)) -> TypeA {
    let (standard, dof) = floored(seen, floor);
    let name = if standard > seen.0 {
        "scatter of the dry repeats (the pairs agree better than these allow)"
    } else {
        "scatter between pairs"
    };
    TypeA { standard, dof, name }
}

/// What K_T's drift from run to run does to D_d through the drag itself.
fn on_drag(points: &[Point], setup: &DragSetup) -> f64 {
    setup.torque_constant_drift_relative * each_alone(points, |p| p.force_n)
}

/// Scatter of the force sensor: that of the pairs, and not less than what noise and zeros within the runs must give.
fn sensed_scatter(points: &[Point]) -> Option<TypeA> {
    let (standard, _, _) = scatter(points)?;
    let least = each_alone(points, |p| p.standard_n);
    (least > standard).then_some(TypeA {
        standard: least,
        dof: points.iter().map(|p| p.effective_n).sum(),
        name: "noise and zeros of the runs (the pairs agree better than these allow)",
    })
}

/// Differences at one speed: both directions and all pairs.
fn differences_per_speed(points: &[Point]) -> usize {
    let fastest = points.iter().map(|p| p.speed_m_s.abs()).fold(0.0, f64::max);
    points.iter().filter(|p| p.speed_m_s.abs() > 0.99 * fastest).count()
}

/// The narrowest interval among the methods that need no model of the friction, or the first method's; a number without an interval is
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
    let mut out = Vec::new();
    let mut warn = |code: &str, text: String| out.push(Finding::new(Severity::Warning, code, text));
    if setup.calibration.is_none() && all.iter().any(|c| c.method.is_sensorless()) {
        let text = match setup.efficiency {
            Efficiency::Undeclared => "nothing is calibrated and no gear efficiency is declared: eq. 8 and 9 are taken as \
                 printed, which gives F/η (25 % too much at η = 0.8); the intervals reach over efficiencies from 0.6 to 1. \
                 Hang a known weight over a pulley"
                .to_owned(),
            Efficiency::Declared(e) => format!(
                "not calibrated: no D_d from the motor's current is better than the declared efficiency ({:.1} %) and K_T \
                 ({:.1} %) allow",
                100.0 * e.relative(),
                100.0 * setup.torque_constant_relative
            ),
        };
        warn("not-calibrated", text);
    }
    if let Ballast::Unballasted { unloaded_n, rolling: None } = setup.ballast {
        warn(
            "wet-not-ballasted",
            format!(
                "the wet runs carried no ballast for what buoyancy takes off the wheels, {unloaded_n:.0} N: at a \
                 rolling coefficient of 0.01 that is {:.2} N of friction that looks like less drag; the intervals reach over \
                 coefficients from 0 to 0.02",
                0.01 * unloaded_n
            ),
        );
    } else if matches!(setup.ballast, Ballast::Matched { .. })
        && tows(runs, BodyState::Dry).iter().any(|r| !r.is_ballasted)
    {
        warn(
            "ballast-contradicts",
            "the setup says that wheel loads match, but runs are marked as not ballasted; say how much load buoyancy takes off"
                .to_owned(),
        );
    }
    for c in all {
        let name = c.method.name();
        if let Some(area) = setup.reference_area_m2
            && let Some(finding) =
                crate::lint::drag_coefficient(&format!("D_d ({name})"), c.value, setup.density_kg_m3, area)
        {
            out.push(finding);
        }
        let scatter_dof = c.budget.iter().find(|p| p.kind == Kind::A).map_or(0.0, |p| p.dof[0]);
        if c.pairs < FEW_PAIRS && scatter_dof < FEW_PAIRS as f64 {
            let so = match (c.interval_95, scatter_dof.round() as usize) {
                (None, _) => "nothing tells their scatter, and no interval is stated".to_owned(),
                (_, dof) => format!(
                    "the scatter has {} and its interval is mostly Student's t",
                    counted(dof, "degree of freedom", "degrees of freedom")
                ),
            };
            let pairs = counted(c.pairs, "pair", "pairs");
            out.push(Finding::new(Severity::Warning, "few-pairs", format!("{name}: {pairs}; {so}")));
        }
        if let Some(f) = c.offset_n
            && f.value.abs() > OFFSET_TOLD * f.standard
            && offset_share(c, f.value) > OFFSET_MATTERS
        {
            out.push(Finding::new(
                Severity::Warning,
                "constant-beside-drag",
                format!(
                    "{name}: a constant {:+.3} ± {:.3} N stands beside the drag, {:.1} % of D_d: friction that wet and dry do \
                     not share (wheel load, wet strut, a drifting zero)",
                    f.value,
                    f.standard,
                    100.0 * offset_share(c, f.value)
                ),
            ));
        }
        let trending: Vec<&Point> = c.points.iter().filter(|p| p.trend_n.is_some()).collect();
        if c.method.is_sensorless() && c.method != Method::MbdpConstant && trending.len() > 1 + c.points.len() / 10 {
            out.push(Finding::new(
                Severity::Note,
                "force-drifts-in-window",
                format!(
                    "{name}: in {} of {} windows the force changes by more than chance",
                    trending.len(),
                    c.points.len()
                ),
            ));
        }
    }
    if let (Some(d), Some(c)) = (detectability, all.iter().find(|c| c.method == Method::Mcd)) {
        let slowest = c.points.iter().map(|p| p.speed_m_s.abs()).fold(f64::INFINITY, f64::min);
        if let Some(text) = d.advice(c.value, slowest) {
            out.push(Finding::new(Severity::Note, "under-uncertainty", text));
        }
    }
    out.extend(sensor_against_current(all));
    if let Some(a) = agreement
        && !a.is_within_band()
    {
        out.push(Finding::new(
            Severity::Warning,
            "wet-scatters-otherwise",
            format!(
                "wet repeats scatter by {:.3} N where dry ones promised {:.3} N (p = {:.4}): {}",
                a.observed_n,
                a.predicted_n,
                a.p,
                if a.ratio > 1.0 {
                    "water not at rest, or a mount that does not repeat"
                } else {
                    "the dry runs had a trouble of their own, and the limit of detection is too pessimistic"
                }
            ),
        ));
    }
    out
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
        Finding::new(Severity::Warning, "load-swings", format!("left out by the motor's current{more}: {why}"))
    })
}

/// Force sensor and motor current measure one drag: a difference beyond both intervals (E_n > 1, ISO 13528:2022, 9.7) is a trouble
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
                return Err(DragError::Length { run: run.id.to_owned(), column, found: values.len(), expected: n });
            }
            if let Some(index) = values.iter().position(|x| !x.is_finite()) {
                return Err(DragError::NotFinite { run: run.id.to_owned(), column, index });
            }
        }
    }
    let positive = "positive and finite";
    for (what, value) in [
        ("newtons a volt", setup.force_per_volt_n()),
        ("density", setup.density_kg_m3),
        ("reference area", setup.reference_area_m2.unwrap_or(1.0)),
    ] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(DragError::Declared { what, value, must: positive });
        }
    }
    Ok(())
}
