//! What each method makes of the runs: steady points, how these scatter, and the errors that only it has.
//!
//! The scatter is that of the pairs, each left out in turn, since runs of one pair share mounts and the hour; with one pair that of its runs about the law. It is
//! not believed below what is known to differ between any two runs: noise and zeros of the sensor, or what the dry repeats show.

use froude_fit::budget::jackknife_of_one;
use froude_fit::replicates::{Floor, Replicates, together};
use froude_identify::regression::Scatter;
use froude_identify::uncertainty::SharedError;
use froude_records::finding::{Finding, Severity};
use froude_records::number::{percent, short_form};
use froude_records::text::counted;

use super::detectability::{Detectability, DryMean, predict};
use super::friction::{Cell, Friction, KNOT_SPACING_M, cells};
use super::run::{BodyState, DragRun, RunKind};
use super::steady::{Rejected, mean_speed, still_windows, window};
use super::{fsm, mbdp, mcd};
use crate::drag::point::{Method, Point, pairs, slope};
use crate::drag::setup::{Ballast, DragSetup};

/// The points of one method, in newtons.
#[derive(Debug, Clone)]
pub(super) struct Observed {
    pub method: Method,
    pub points: Vec<Point>,
    pub scatter: Scatter,
    /// Errors beside those that every method of a carriage has.
    pub errors: Vec<SharedError>,
    /// Friction that was identified elsewhere.
    pub elsewhere: Option<Elsewhere>,
}

/// What a model of the friction leaves where it was not identified.
#[derive(Debug, Clone, Copy)]
pub(super) struct Elsewhere {
    /// Drag that it finds on the dry tows, N s²/m².
    phantom: f64,
    /// Where it was identified, m.
    range_m: [f64; 2],
}

impl Elsewhere {
    pub fn finding(self, method: Method, d_n_s2_m2: f64) -> Finding {
        let Self { phantom, range_m: [from, to] } = self;
        Finding::new(
            Severity::Warning,
            "friction-elsewhere",
            format!(
                "{}: the friction identified from {from:.2} to {to:.2} m leaves a drag of {phantom:.3} N s^2/m^2 ({:.1} % of D_d) \
                 on the dry tows; identify it where the body is towed, or use the map",
                method.name(),
                100.0 * phantom / d_n_s2_m2
            ),
        )
    }
}

/// What is reported along the way.
#[derive(Debug, Default)]
pub(super) struct Reported {
    /// Runs that gave no point.
    pub rejected: Vec<(Method, Rejected)>,
    pub findings: Vec<Finding>,
}

/// Runs by what they are for.
pub(super) struct Tows<'r, 'a> {
    pub wet: Vec<&'r DragRun<'a>>,
    pub dry: Vec<&'r DragRun<'a>>,
    sweeps: Vec<&'r DragRun<'a>>,
    means: Vec<DryMean>,
}

/// Speeds of a wet and a dry run that differ by no more than this part are one: the loop of a carriage keeps closer to its reference.
const SPEEDS_DIFFER: f64 = 2e-3;

impl<'r, 'a> Tows<'r, 'a> {
    pub fn of(runs: &'r [DragRun<'a>], setup: &DragSetup) -> Self {
        let of = |kind: RunKind, body: Option<BodyState>| {
            runs.iter().filter(|r| r.kind == kind && body.is_none_or(|b| r.body == b)).collect::<Vec<_>>()
        };
        Self {
            wet: of(RunKind::Tow, Some(BodyState::Wet)),
            dry: of(RunKind::Tow, Some(BodyState::Dry)),
            sweeps: of(RunKind::Friction, None),
            means: runs.iter().filter_map(|r| DryMean::of(r, setup)).collect(),
        }
    }

    /// What the dry repeats predict for so many points.
    pub fn promised(&self, points: &[Point], setup: &DragSetup) -> Option<Detectability> {
        predict(&self.means, differences_per_speed(points), pairs(points).len(), setup)
    }

    /// The points of a method; `None` where there are no runs for it.
    pub fn observed(&self, method: Method, setup: &DragSetup, reported: &mut Reported) -> Option<Observed> {
        match method {
            Method::Fsm => self.wet.iter().any(|r| r.force_n.is_some()).then(|| self.sensed(setup, reported)),
            Method::Mcd => (!self.dry.is_empty()).then(|| self.differences(setup, reported)),
            Method::MbdpFlexible if setup.flexible.is_none() => None,
            Method::MbdpConstant | Method::MbdpMapped | Method::MbdpFlexible => self.modelled(method, setup, reported),
        }
    }

    /// The force sensor. Its scatter is no less than what noise and zeros within the runs must give.
    fn sensed(&self, setup: &DragSetup, reported: &mut Reported) -> Observed {
        let all = self.wet.iter().map(|r| fsm::point(r, setup.sensor.drift_half_width_n, setup.steady));
        let points = keep(all, Method::Fsm, reported);
        let errors = unseen_drift(&points, &self.wet, setup, &mut reported.findings).into_iter().collect();
        let least = Floor {
            name: "noise and zeros of the runs (the pairs scatter less than these predict)".to_owned(),
            variance: vec![each_alone(&points, |p| p.standard_n).powi(2)],
            dof: points.iter().map(|p| p.effective_n).sum(),
        };
        let sets = repeats(&points).map(|r| r.above(least)).into_iter().collect();
        Observed { scatter: scatter(sets), errors, ..Observed::of(Method::Fsm, points, setup) }
    }

    fn differences(&self, setup: &DragSetup, reported: &mut Reported) -> Observed {
        let k = setup.force_per_volt_n();
        let all = self.wet.iter().map(|w| match self.dry.iter().find(|d| d.is_partner_of(w)) {
            Some(d) => mcd::point(w, d, k, setup.steady),
            None => Err(Rejected::Unusable(format!(
                "run {:?}: no dry run of pair {} at {} m/s in this direction",
                w.id,
                w.pair,
                w.target_speed_m_s * w.direction
            ))),
        });
        let mut points = keep(all, Method::Mcd, reported);
        let error = self.at_one_speed(&mut points, setup, reported);
        let promised = self.promised(&points, setup);
        let observed = Observed::of_differences(points, promised.as_ref(), setup);
        Observed { errors: error.into_iter().collect(), ..observed }
    }

    /// Takes off the differences what friction changes between the speeds of a wet and its dry run, B (v_wet − v_dry), with B of the dry runs, mapped where they
    /// allow it; its error is that of B, all of B where leaving one dry run out leaves none. Where a loop keeps the speed, only what it misses is corrected.
    fn at_one_speed(&self, points: &mut [Point], setup: &DragSetup, reported: &mut Reported) -> Option<SharedError> {
        let faster = |p: &Point| {
            let wet = self.wet.iter().find(|w| w.id == p.run)?;
            let dry = self.dry.iter().find(|d| d.is_partner_of(wet))?;
            let by_m_s = p.speed_m_s - mean_speed(dry, window(dry, setup.steady).ok()?);
            (wet.held.is_some() || by_m_s.abs() > SPEEDS_DIFFER * p.speed_m_s.abs()).then_some(by_m_s)
        };
        let faster_m_s: Vec<f64> = points.iter().map(|p| faster(p).unwrap_or(0.0)).collect();
        let most = points.iter().zip(&faster_m_s).map(|(p, by)| (by / p.speed_m_s).abs()).fold(0.0, f64::max);
        if most == 0.0 {
            return None;
        }
        let cells: Vec<Vec<Cell>> = self.dry.iter().map(|d| cells(d, setup.steady)).collect();
        let viscous = |is_mapped: bool, skip: Option<usize>| {
            let kept = cells.iter().enumerate().filter(|(i, _)| Some(*i) != skip).flat_map(|(_, cells)| cells);
            Friction::identify(kept, is_mapped).map(|friction| friction.viscous_v_s_m).filter(|b| *b != 0.0)
        };
        let known: Vec<(f64, Option<(f64, f64)>)> = [true, false]
            .into_iter()
            .filter_map(|is_mapped| {
                Some((viscous(is_mapped, None)?, jackknife_of_one(cells.len(), |i| viscous(is_mapped, Some(i)))))
            })
            .collect();
        let known = known.iter().find(|(_, scatter)| scatter.is_some()).or(known.first()).copied();
        let differ = format!("wet and dry runs differ in speed by up to {}", percent(most));
        let is_said = most > SPEEDS_DIFFER;
        let k = setup.force_per_volt_n();
        let Some((b, scatter)) = known else {
            if is_said {
                let text = format!(
                    "mcd: {differ}, and dry runs at one speed do not show how friction changes with speed: the drag includes that change. Add dry runs at other speeds"
                );
                reported.findings.push(Finding::new(Severity::Warning, "speeds-differ", text));
            }
            return None;
        };
        let (standard, dof) = scatter.unwrap_or((b.abs(), f64::INFINITY));
        for (p, by_m_s) in points.iter_mut().zip(&faster_m_s) {
            p.force_n -= k * b * by_m_s;
        }
        if is_said {
            let text = format!(
                "mcd: {differ}; friction changes with speed by {} N s/m (dry runs), and the drag is corrected for it",
                short_form(k * b, k * standard)
            );
            reported.findings.push(Finding::new(Severity::Note, "speeds-differ", text));
        }
        let direction: Vec<f64> = faster_m_s.iter().map(|by| k * by).collect();
        Some(SharedError::of_load(
            "friction between the speeds of wet and dry runs",
            setup.load(),
            &direction,
            standard,
            dof,
        ))
    }

    /// MBDP. Its type A has the scatter of the pairs, the friction identified anew without each of them, and that of the friction runs, each of
    /// their repeats left out in turn.
    fn modelled(&self, method: Method, setup: &DragSetup, reported: &mut Reported) -> Option<Observed> {
        let is_mapped = method != Method::MbdpConstant;
        let frictional: Vec<&DragRun<'_>> = match (is_mapped, self.sweeps.is_empty()) {
            (true, _) => self.dry.iter().chain(&self.sweeps).copied().collect(),
            (false, true) => self.dry.clone(),
            (false, false) => self.sweeps.clone(),
        };
        let k = setup.force_per_volt_n();
        let without_drag: Vec<Vec<Cell>> = frictional.iter().map(|r| cells(r, setup.steady)).collect();
        let with_drag: Vec<(u32, Vec<Cell>)> = self.wet.iter().map(|r| (r.pair, cells(r, setup.steady))).collect();
        // A map is made where it is used: friction runs elsewhere would leave stretches of it that nobody passed.
        let towed: Vec<f64> = with_drag.iter().flat_map(|c| &c.1).map(|c| c.position_m).collect();
        let [low, high] = super::steady::reach(&towed);
        let is_near = |c: &&Cell| !is_mapped || (low - KNOT_SPACING_M..=high + KNOT_SPACING_M).contains(&c.position_m);
        let identify = |is_kept: &dyn Fn(usize) -> bool| {
            let cells = without_drag.iter().enumerate().filter(|(i, _)| is_kept(*i)).flat_map(|(_, cells)| cells);
            Friction::identify(cells.filter(is_near), is_mapped)
        };
        let Some(friction) = identify(&|_| true) else {
            if !frictional.is_empty() {
                let why = if is_mapped {
                    "the dry runs do not cover the whole tow"
                } else {
                    "no dry run has a steady window"
                };
                let text = format!("{}: left out: {why}", method.name());
                reported.findings.push(Finding::new(Severity::Note, "no-friction", text));
            }
            return None;
        };
        let model = setup.flexible.filter(|_| method == Method::MbdpFlexible);
        let point = |run: &DragRun<'_>| match model {
            Some(model) => {
                mbdp::flexible_point(run, &friction, k, k / setup.ideal_force_per_volt_n, model, setup.steady)
            }
            None => mbdp::point(run, &friction, k, setup.steady),
        };
        let points = keep(self.wet.iter().map(|w| point(w)), method, reported);
        let groups = pairs(&points);
        let slope_without = |clusters: &[Cluster], skip: Cluster| {
            let without = identify(&|i| clusters[i] != skip)?;
            let (mut xx, mut xy) = (0.0, 0.0);
            for (_, cells) in with_drag.iter().filter(|c| Cluster::Pair(c.0) != skip && groups.contains(&c.0)) {
                let x = cells.first().map_or(0.0, |c| c.speed_m_s * c.speed_m_s.abs());
                let left =
                    cells.iter().map(|c| c.weight * (c.command_v - without.command_v(c.position_m, c.speed_m_s)));
                xx += x * x;
                xy += x * k * left.sum::<f64>() / cells.iter().map(|c| c.weight).sum::<f64>().max(f64::MIN_POSITIVE);
            }
            (xx > 0.0).then(|| vec![xy / xx])
        };
        // The runs of the friction that stand or fall with no pair, each left out in turn; and how many they are.
        let alone = |clusters: &[Cluster]| {
            let mut alone: Vec<Cluster> = Vec::new();
            for cluster in clusters {
                let is_of_pair = matches!(cluster, Cluster::Pair(pair) if groups.contains(pair));
                if !is_of_pair && !alone.contains(cluster) {
                    alone.push(*cluster);
                }
            }
            let set = Replicates::leaving_out("friction run", alone.len(), |g| slope_without(clusters, alone[g]));
            (set, alone.len())
        };
        // A wet run alone has half the variance of a difference, and friction that is known exactly adds none.
        let floor = self.promised(&points, setup).map(|d| of_dry_repeats(&d, 0.5_f64.sqrt(), &points, setup));
        let by_pair = clusters(&frictional, true);
        let of_pairs =
            Replicates::leaving_out("pair", groups.len(), |g| slope_without(&by_pair, Cluster::Pair(groups[g])));
        let (sets, is_known) = if let Some(pairs) = of_pairs {
            let (sweeps, count) = alone(&by_pair);
            let is_known = sweeps.is_some() || count == 0;
            (std::iter::once(Replicates { floor, ..pairs }).chain(sweeps).collect::<Vec<_>>(), is_known)
        } else {
            // Of one pair the wet runs scatter about the law, and the runs of the friction are left out in turn.
            let (dry, _) = alone(&clusters(&frictional, false));
            let is_known = dry.is_some();
            (repeats(&points).into_iter().chain(dry).collect(), is_known)
        };
        if !(is_known || points.is_empty()) {
            let text = format!(
                "{}: the interval does not include the uncertainty of the friction, which {}; add dry runs",
                method.name(),
                if frictional.len() == 1 {
                    "a single dry run does not show"
                } else {
                    "leaving out each dry run in turn does not determine"
                }
            );
            reported.findings.push(Finding::new(Severity::Warning, "friction-uncertain", text));
        }
        // The same model over the dry tows should find no drag; what it finds there it finds in the wet runs too.
        let of_nothing: Vec<Point> = self.dry.iter().filter_map(|d| point(d).ok()).collect();
        let chance = together("", &sets).filter(|_| is_known).map_or(f64::INFINITY, |part| part.standard(0));
        let phantom = slope(&of_nothing).filter(|phantom| phantom.abs() > chance);
        let left = phantom.map(|phantom| {
            let squares: Vec<f64> = points.iter().map(|p| p.speed_m_s * p.speed_m_s.abs()).collect();
            let name = "friction outside the range where it was identified, not corrected";
            SharedError::of_load(name, setup.load(), &squares, phantom.abs(), f64::INFINITY)
        });
        Some(Observed {
            scatter: scatter(sets),
            errors: left.into_iter().collect(),
            elsewhere: phantom.map(|phantom| Elsewhere { phantom, range_m: friction.range_m }),
            ..Observed::of(method, points, setup)
        })
    }
}

impl Observed {
    /// Points whose repeats alone tell their scatter.
    pub fn of(method: Method, mut points: Vec<Point>, setup: &DragSetup) -> Self {
        restore_buoyancy(method, &mut points, setup);
        let scatter = scatter(repeats(&points).into_iter().collect());
        Self { method, points, scatter, errors: Vec::new(), elsewhere: None }
    }

    /// Differences of wet and dry runs; pairs are compared with what the dry repeats predict.
    pub fn of_differences(points: Vec<Point>, promised: Option<&Detectability>, setup: &DragSetup) -> Self {
        let mut out = Self::of(Method::Mcd, points, setup);
        if let (Some(promised), Scatter::Replicates { sets, .. }) = (promised, &mut out.scatter) {
            for set in sets.iter_mut().filter(|set| set.left_out == "pair") {
                set.floor = Some(of_dry_repeats(promised, 1.0, &out.points, setup));
            }
        }
        out
    }
}

/// Pairs left out in turn, where there are two; else the runs. All points have one weight, and the fastest decide the slope, so that a jackknife of runs that err
/// alike has fewer degrees of freedom than runs: their variance is no smaller than s²/Σ v⁴.
fn repeats(points: &[Point]) -> Option<Replicates> {
    let pairs = pairs(points);
    if pairs.len() >= 2 {
        let without = |g: usize| slope(points.iter().filter(|p| p.pair != pairs[g])).map(|d| vec![d]);
        return Replicates::leaving_out("pair", pairs.len(), without);
    }
    let without = |g: usize| slope(points.iter().enumerate().filter(|(i, _)| *i != g).map(|(_, p)| p)).map(|d| vec![d]);
    let runs = Replicates::leaving_out("run", points.len(), without)?;
    let d = slope(points)?;
    let (squares, left) = points.iter().fold((0.0, 0.0), |(squares, left), p| {
        let x = p.speed_m_s * p.speed_m_s.abs();
        (squares + x * x, left + (p.force_n - d * x).powi(2))
    });
    let dof = points.len() as f64 - 1.0;
    // Where the scatter grows with the speed the jackknife shows it, and is the larger one.
    Some(runs.above(Floor { name: OF_RUNS.to_owned(), variance: vec![left / (dof * squares)], dof }))
}

/// Scatter of the only pair.
const OF_RUNS: &str = "scatter of the runs about the law";

/// Sets of replicates under their name.
fn scatter(sets: Vec<Replicates>) -> Scatter {
    let name = match sets.as_slice() {
        [one] if one.left_out == "run" => OF_RUNS,
        [wet, _] if wet.left_out == "run" => "scatter of wet runs about the law and of dry runs",
        [_, _] => "scatter of pairs and of friction runs",
        _ => "scatter between pairs",
    };
    Scatter::Replicates { name: name.to_owned(), sets }
}

/// The floor that dry repeats put under the scatter of pairs, `part` of their standard deviation: see [`Detectability::floor_n_s2_m2`].
fn of_dry_repeats(promised: &Detectability, part: f64, points: &[Point], setup: &DragSetup) -> Floor {
    let (rest, dof) = promised.floor_n_s2_m2;
    Floor {
        name: "scatter of the dry repeats (the pairs scatter less than these predict)".to_owned(),
        variance: vec![(part * rest).hypot(on_drag(points, setup)).powi(2)],
        dof,
    }
}

/// The points that came out; the others are noted.
fn keep(all: impl Iterator<Item = Result<Point, Rejected>>, method: Method, reported: &mut Reported) -> Vec<Point> {
    let mut out = Vec::new();
    for point in all {
        match point {
            Ok(point) => out.push(point),
            Err(why) => reported.rejected.push((method, why)),
        }
    }
    out
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
    // D_d for a newton more in each point: Σ x / Σ x², x = v|v|.
    let x = || points.iter().map(|p| p.speed_m_s * p.speed_m_s.abs());
    let moved = half_n * x().sum::<f64>() / x().map(|x| x * x).sum::<f64>();
    findings.push(Finding::new(
        Severity::Warning,
        "zero-on-one-side",
        format!(
            "fsm: {} no still window on one side of the tow; the declared drift of ± {half_n:.2} N moves D_d by \
             up to {:.2} N s^2/m^2. Keep the carriage at rest for two seconds before and after each tow",
            counted(open, "wet run has", "wet runs have"),
            moved.abs(),
        ),
    ));
    let name = "drift of the sensor not seen in a still window";
    Some(SharedError::between(name, setup.load(), &vec![1.0; points.len()], [-half_n, half_n]))
}

/// Whom a run that the friction is identified from stands or falls with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cluster {
    /// A dry tow: with its pair.
    Pair(u32),
    /// A dry tow alone.
    Tow(usize),
    /// A friction run: with its repeat of all speeds, or alone where repeats are not distinguished.
    Sweep(u32),
}

/// Clusters of the runs that the friction is identified from; dry tows by their pair or each alone.
fn clusters(runs: &[&DragRun<'_>], by_pair: bool) -> Vec<Cluster> {
    let mut repeats = runs.iter().filter(|r| r.kind == RunKind::Friction).map(|r| r.pair);
    let first = repeats.next();
    let is_told = repeats.any(|r| Some(r) != first);
    let of = |(i, r): (usize, &&DragRun<'_>)| match r.kind {
        RunKind::Friction => Cluster::Sweep(if is_told { r.pair } else { i as u32 }),
        _ if by_pair => Cluster::Pair(r.pair),
        _ => Cluster::Tow(i),
    };
    runs.iter().enumerate().map(of).collect()
}

/// What K_T's drift from run to run does to D_d through the drag itself.
fn on_drag(points: &[Point], setup: &DragSetup) -> f64 {
    setup.torque_constant_drift_relative * each_alone(points, |p| p.force_n)
}

/// Standard uncertainty of the slope from forces that err independently, each by `standard_n`: √(Σ x² u²)/Σ x², x = v².
fn each_alone(points: &[Point], standard_n: impl Fn(&Point) -> f64) -> f64 {
    let x = |p: &Point| p.speed_m_s * p.speed_m_s;
    let xx: f64 = points.iter().map(|p| x(p) * x(p)).sum();
    let sum: f64 = points.iter().map(|p| (x(p) * standard_n(p)).powi(2)).sum();
    if xx > 0.0 { sum.sqrt() / xx } else { 0.0 }
}

/// Differences at one speed: both directions and all pairs.
fn differences_per_speed(points: &[Point]) -> usize {
    let fastest = points.iter().map(|p| p.speed_m_s.abs()).fold(0.0, f64::max);
    points.iter().filter(|p| p.speed_m_s.abs() > 0.99 * fastest).count()
}

/// Puts the friction back that buoyancy took off the wheels in the wet runs, where the rolling coefficient is declared.
fn restore_buoyancy(method: Method, points: &mut [Point], setup: &DragSetup) {
    if let (true, Ballast::Unballasted { unloaded_n, rolling: Some(rolling) }) = (method.is_sensorless(), setup.ballast)
    {
        for p in points {
            p.force_n += rolling.value * unloaded_n * p.speed_m_s.signum();
        }
    }
}
