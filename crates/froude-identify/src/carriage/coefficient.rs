//! D_d from steady points: least squares, scatter by pairs, budget, interval.
//!
//! F = D_d v|v| through the origin, all points with one weight: friction repeats to a part of itself, so the scatter
//! hardly grows with speed. Type A is the delete-a-pair jackknife, since runs of one pair share mounts and the hour;
//! it has pairs − 1 degrees of freedom. Type B are errors that all pairs share. The interval is Welch and Satterthwaite's;
//! errors to one side (an efficiency that nobody declared) are drawn. Drawing everything, Student's t for the scatter,
//! was tried: with five pairs it is 13 % wider and covers 97 %.
//!
//! **Source.** Efron & Stein (1981), Ann. Stat. 9 (jackknife); JCGM 100:2008 (GUM); JCGM 101:2008 (draws).

use froude_fit::distribution::coverage_factor;
use froude_fit::propagate::{effective_dof, expanded};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

use super::run::{Ballast, DragSetup, Efficiency, UNDECLARED_EFFICIENCY, UNDECLARED_ROLLING, Uncertain};

/// Draws for an interval: its ends then scatter by 1.5 % of the standard uncertainty.
const DRAWS: usize = 20_000;
/// Seed of the draws.
const SEED: u64 = 0x5eed;
/// Probability outside the interval, both sides together.
const OUTSIDE: f64 = 0.05;

/// A steady force.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// The (wet) run.
    pub run: String,
    /// Mean speed over the window, m/s, signed.
    pub speed_m_s: f64,
    /// Resistance, N, with the sign of the speed.
    pub force_n: f64,
    /// Standard uncertainty of that from within the window, N; run-to-run changes are not in it.
    pub standard_n: f64,
    /// Number of independent samples in the window.
    pub effective_n: f64,
    /// Pair (cluster).
    pub pair: u32,
    /// Positions of the window, m, low and high.
    pub position_m: [f64; 2],
    /// Change of the force over the window, N, where it is more than chance.
    pub trend_n: Option<f64>,
}

/// How the force was got.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// Force sensor.
    Fsm,
    /// Motor current difference, eq. 8.
    Mcd,
    /// Model based, eq. 9, one Coulomb and one viscous number.
    MbdpConstant,
    /// Model based, friction mapped over position.
    MbdpMapped,
    /// Model based, two masses and a chain, friction mapped.
    MbdpFlexible,
}

impl Method {
    /// As it stands in records and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fsm => "fsm",
            Self::Mcd => "mcd",
            Self::MbdpConstant => "mbdp_constant",
            Self::MbdpMapped => "mbdp_mapped",
            Self::MbdpFlexible => "mbdp_flexible",
        }
    }

    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Fsm => "force sensor, zero from still windows",
            Self::Mcd => "motor current difference of wet and dry runs, paired by position",
            Self::MbdpConstant => "motor current less constant Coulomb and viscous friction",
            Self::MbdpMapped => "motor current less friction mapped over position",
            Self::MbdpFlexible => "motor current less two-mass model with friction mapped over position",
        }
    }

    /// Whether the force comes from the motor's current.
    #[must_use]
    pub const fn is_sensorless(self) -> bool {
        !matches!(self, Self::Fsm)
    }
}

/// How an error of D_d is distributed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Normal; with finite degrees of freedom Student's t.
    Bell,
    /// Uniform between two errors, N s²/m²: the truth is the value plus one of them.
    Between(f64, f64),
}

/// A line of the budget.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// What errs.
    pub name: String,
    /// Who shares the error: `run`, `pair`, `campaign`.
    pub shared: &'static str,
    /// Standard uncertainty that it gives D_d, N s²/m².
    pub standard: f64,
    /// Degrees of freedom.
    pub dof: f64,
    /// Its distribution.
    pub shape: Shape,
    /// `A` or `B` (GUM).
    pub kind: char,
    /// True where repeats show it already: it is listed and not added.
    pub in_scatter: bool,
}

/// D_d by one method.
#[derive(Debug, Clone, PartialEq)]
pub struct Coefficient {
    /// How.
    pub method: Method,
    /// D_d, N s²/m².
    pub value: f64,
    /// Combined standard uncertainty; `None` where nothing tells the scatter.
    pub standard: Option<f64>,
    /// Its part from the scatter.
    pub type_a: Option<f64>,
    /// Its part from declared errors.
    pub type_b: f64,
    /// Effective degrees of freedom (Welch–Satterthwaite).
    pub dof: f64,
    /// 95 % interval, over all looks.
    pub interval_95: Option<[f64; 2]>,
    /// Looks that the interval pays for ([`DragSetup::looks`]).
    pub looks: usize,
    /// The budget, scatter first.
    pub budget: Vec<Part>,
    /// Points.
    pub points: Vec<Point>,
    /// Pairs among them.
    pub pairs: usize,
    /// A constant force beside the drag, N (in the direction of motion's resistance), if fitted with one: friction that
    /// the dry runs did not have. Zero is expected.
    pub offset_n: Option<Uncertain>,
}

impl Coefficient {
    /// C_D = 2 D_d/(ρA), with its interval.
    #[must_use]
    pub fn drag_coefficient(&self, density_kg_m3: f64, area_m2: f64) -> (f64, Option<[f64; 2]>) {
        let q = 0.5 * density_kg_m3 * area_m2;
        (self.value / q, self.interval_95.map(|[low, high]| [low / q, high / q]))
    }

    /// Half-width of the interval as part of the value.
    #[must_use]
    pub fn relative_half_width(&self) -> Option<f64> {
        self.interval_95.map(|[low, high]| 0.5 * (high - low) / self.value.abs())
    }
}

impl Coefficient {
    /// Adds a line to the budget and widens the interval by it.
    pub(super) fn widen(&mut self, part: Part) {
        self.type_b = self.type_b.hypot(part.standard);
        self.budget.push(part);
        if self.standard.is_some() {
            let (standard, dof, interval) = combine(self.value, &self.budget, self.looks);
            (self.standard, self.dof, self.interval_95) = (Some(standard), dof, Some(interval));
        }
    }
}

/// Slope through the origin over v|v|; `None` without a moving point.
#[must_use]
pub fn slope<'a>(points: impl IntoIterator<Item = &'a Point>) -> Option<f64> {
    let (mut xx, mut xy) = (0.0, 0.0);
    for p in points {
        let x = p.speed_m_s * p.speed_m_s.abs();
        xx += x * x;
        xy += x * p.force_n;
    }
    (xx > 0.0).then(|| xy / xx)
}

/// Change of the slope for a unit of a force that each point has in part: Σ x f / Σ x².
pub(super) fn slope_of(points: &[Point], force: impl Fn(&Point) -> f64) -> f64 {
    let (mut xx, mut xy) = (0.0, 0.0);
    for p in points {
        let x = p.speed_m_s * p.speed_m_s.abs();
        xx += x * x;
        xy += x * force(p);
    }
    xy / xx
}

/// Delete-one jackknife of a statistic over groups: standard uncertainty and degrees of freedom.
///
/// `without(g)` is the statistic with group `g` left out. `None` below two groups, or where one group decides.
#[must_use]
pub fn jackknife(groups: usize, without: impl Fn(usize) -> Option<f64>) -> Option<(f64, f64)> {
    if groups < 2 {
        return None;
    }
    let values: Vec<f64> = (0..groups).map(without).collect::<Option<_>>()?;
    let g = groups as f64;
    let mean = values.iter().sum::<f64>() / g;
    let variance = (g - 1.0) / g * values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>();
    Some((variance.sqrt(), g - 1.0))
}

/// Distinct pairs, in order of appearance.
#[must_use]
pub fn pairs(points: &[Point]) -> Vec<u32> {
    let mut out: Vec<u32> = Vec::new();
    for p in points {
        if !out.contains(&p.pair) {
            out.push(p.pair);
        }
    }
    out
}

/// Type A of the slope: over pairs where there are two, else over the points of the one pair.
pub(super) fn scatter(points: &[Point]) -> Option<(f64, f64, &'static str)> {
    let pairs = pairs(points);
    if pairs.len() >= 2 {
        let (u, dof) = jackknife(pairs.len(), |g| slope(points.iter().filter(|p| p.pair != pairs[g])))?;
        return Some((u, dof, "pair"));
    }
    let leave = |i: usize| slope(points.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, p)| p));
    jackknife(points.len(), leave).map(|(u, dof)| (u, dof, "run"))
}

/// F = F₀ sgn v + D v|v|: F₀ with its uncertainty over pairs.
fn offset(points: &[Point]) -> Option<Uncertain> {
    let fit = |skip: Option<u32>| {
        let (mut n, mut x1, mut x2, mut y0, mut xy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for p in points.iter().filter(|p| Some(p.pair) != skip) {
            let (x, y) = (p.speed_m_s * p.speed_m_s, p.force_n * p.speed_m_s.signum());
            n += 1.0;
            x1 += x;
            x2 += x * x;
            y0 += y;
            xy += x * y;
        }
        let determinant = n * x2 - x1 * x1;
        // Points at one speed do not tell a constant from a square.
        (determinant > 1e-6 * n * x2).then(|| (x2 * y0 - x1 * xy) / determinant)
    };
    let pairs = pairs(points);
    let (standard, dof) = jackknife(pairs.len(), |g| fit(Some(pairs[g])))?;
    Some(Uncertain { value: fit(None)?, standard, dof })
}

/// A scatter that was found otherwise than from the points alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TypeA {
    /// Standard uncertainty of D_d, N s²/m².
    pub standard: f64,
    /// Its degrees of freedom.
    pub dof: f64,
    /// Its line in the budget.
    pub name: &'static str,
}

/// D_d of points already in newtons, its scatter replaced by `type_a` where the method has more to shake than its points.
///
/// `None` without a moving point.
#[must_use]
pub fn coefficient(
    method: Method,
    mut points: Vec<Point>,
    setup: &DragSetup,
    type_a: Option<TypeA>,
) -> Option<Coefficient> {
    let mut budget = Vec::new();
    restore_buoyancy(method, &mut points, setup);
    let measured = slope(&points)?;
    let value = measured - setup.strut_n_s2_m2.map_or(0.0, |s| s.value);
    let found = match type_a {
        Some(TypeA { standard, dof, name }) => Some((standard, dof, "pair", name)),
        None => scatter(&points).map(|(u, dof, shared)| {
            let name = if shared == "pair" { "scatter between pairs" } else { "scatter of the runs about the law" };
            (u, dof, shared, name)
        }),
    };
    if let Some((standard, dof, shared, name)) = found {
        budget.push(Part {
            name: name.to_owned(),
            shared,
            standard,
            dof,
            shape: Shape::Bell,
            kind: 'A',
            in_scatter: false,
        });
    }
    shared_errors(method, &points, measured, setup, &mut budget);
    let combined = found.map(|_| combine(value, &budget, setup.looks));
    let type_b = budget.iter().filter(|p| p.kind == 'B' && !p.in_scatter).map(|p| p.standard * p.standard).sum::<f64>();
    Some(Coefficient {
        method,
        value,
        standard: combined.map(|c| c.0),
        type_a: found.map(|f| f.0),
        type_b: type_b.sqrt(),
        dof: combined.map_or(f64::NAN, |c| c.1),
        interval_95: combined.map(|c| c.2),
        looks: setup.looks,
        pairs: pairs(&points).len(),
        offset_n: offset(&points),
        budget,
        points,
    })
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

/// Errors that all pairs share, and those that the scatter already shows.
fn shared_errors(method: Method, points: &[Point], measured: f64, setup: &DragSetup, budget: &mut Vec<Part>) {
    let mut part = |name: &str, standard: f64, dof: f64, shape: Shape, shared: &'static str, in_scatter: bool| {
        if standard > 0.0 {
            budget.push(Part {
                name: name.to_owned(),
                shared,
                standard: standard.abs(),
                dof,
                shape,
                kind: 'B',
                in_scatter,
            });
        }
    };
    let never = f64::INFINITY;
    let size = measured.abs();
    if method.is_sensorless() {
        match (setup.calibration, setup.efficiency) {
            (Some(c), _) => {
                let f = c.force_per_volt_n;
                part("newtons a volt, calibrated", size * f.relative(), f.dof, Shape::Bell, "campaign", false);
            }
            (None, efficiency) => {
                let torque = size * setup.torque_constant_relative;
                part("K_T and amplifier gain, declared", torque, never, Shape::Bell, "campaign", false);
                match efficiency {
                    Efficiency::Declared(e) => {
                        part("gear efficiency, declared", size * e.relative(), e.dof, Shape::Bell, "campaign", false);
                    }
                    Efficiency::Undeclared => {
                        let [low, high] = UNDECLARED_EFFICIENCY.map(|e| measured * (e - 1.0));
                        let shape = Shape::Between(low, high);
                        part("gear efficiency, not declared", one_sided(low, high), never, shape, "campaign", false);
                    }
                }
            }
        }
        let drift = size * setup.torque_constant_drift_relative * each_alone(points, |p| p.speed_m_s.powi(2));
        part("drift of K_T from run to run, on the drag", drift, never, Shape::Bell, "run", true);
        if let Ballast::Unballasted { unloaded_n, rolling } = setup.ballast {
            let per_newton = slope_of(points, |p| p.speed_m_s.signum());
            if let Some(r) = rolling {
                let standard = per_newton * unloaded_n * r.standard;
                part("rolling friction that buoyancy takes off", standard, r.dof, Shape::Bell, "campaign", false);
            } else {
                let [low, high] = UNDECLARED_ROLLING.map(|c| c * unloaded_n * per_newton);
                let shape = Shape::Between(low, high);
                let standard = one_sided(low, high);
                part(
                    "rolling friction that buoyancy takes off, not declared",
                    standard,
                    never,
                    shape,
                    "campaign",
                    false,
                );
            }
        }
    } else {
        part("gain of the sensor", size * setup.sensor.gain_relative, never, Shape::Bell, "campaign", false);
        let zero = each_alone(points, |p| p.standard_n);
        part("noise, zero of the sensor and its drift", zero, never, Shape::Bell, "run", true);
    }
    // v² takes the sprocket's radius twice; newtons that are not calibrated, (n/R) K_T K_amp, once more in the same direction.
    let times = if method.is_sensorless() && setup.calibration.is_none() { 3.0 } else { 2.0 };
    part(
        "length of an encoder count",
        times * size * setup.speed_scale_relative,
        never,
        Shape::Bell,
        "campaign",
        false,
    );
    if let Some(strut) = setup.strut_n_s2_m2 {
        part("drag of the strut", strut.standard, strut.dof, Shape::Bell, "campaign", false);
    }
}

/// Standard uncertainty of the slope from forces that err independently, each by `standard_n`: √(Σ x² u²)/Σ x², x = v².
pub(super) fn each_alone(points: &[Point], standard_n: impl Fn(&Point) -> f64) -> f64 {
    let (mut sum, mut xx) = (0.0, 0.0);
    for p in points {
        let x = p.speed_m_s * p.speed_m_s;
        sum += (x * standard_n(p)).powi(2);
        xx += x * x;
    }
    if xx > 0.0 { sum.sqrt() / xx } else { 0.0 }
}

/// Standard uncertainty of a value left uncorrected for an error between two limits: the mean counts too (GUM F.2.4.5).
fn one_sided(low: f64, high: f64) -> f64 {
    let (mean, half) = (0.5 * (low + high), 0.5 * (high - low));
    (mean * mean + half * half / 3.0).sqrt()
}

/// Combined standard uncertainty, effective degrees of freedom, 95 % interval (held to contain the value), Bonferroni over `looks`.
///
/// Bells alone: Welch and Satterthwaite. With a one-sided error among them: draws of that error and of one bell that
/// stands for all bells, as wide as their coverage factor says.
fn combine(value: f64, budget: &[Part], looks: usize) -> (f64, f64, [f64; 2]) {
    let outside = OUTSIDE / looks.max(1) as f64;
    let counted = || budget.iter().filter(|p| !p.in_scatter);
    let variance_of = |part: &Part| (part.standard * part.standard, part.dof);
    let entries: Vec<(f64, f64)> = counted().map(variance_of).collect();
    let bells: Vec<(f64, f64)> = counted().filter(|p| p.shape == Shape::Bell).map(variance_of).collect();
    let limits: Vec<(f64, f64)> = counted()
        .filter_map(|p| match p.shape {
            Shape::Between(low, high) => Some((low, high)),
            Shape::Bell => None,
        })
        .collect();
    let standard = entries.iter().map(|e| e.0).sum::<f64>().sqrt();
    let dof = effective_dof(&entries);
    let half = expanded(&bells, 1.0 - outside).expanded;
    if limits.is_empty() {
        return (standard, dof, [value - half, value + half]);
    }
    let bell = half / coverage_factor(1.0 - outside, f64::INFINITY);
    let mut rng = Pcg64Mcg::seed_from_u64(SEED);
    let mut draws: Vec<f64> = (0..DRAWS)
        .map(|_| {
            let z: f64 = StandardNormal.sample(&mut rng);
            limits.iter().fold(value + bell * z, |sum, (low, high)| sum + low + (high - low) * rng.random::<f64>())
        })
        .collect();
    let mut at = |probability: f64| {
        let k = ((DRAWS as f64 * probability) as usize).min(DRAWS - 1);
        *draws.select_nth_unstable_by(k, f64::total_cmp).1
    };
    let (low, high) = (at(0.5 * outside), at(1.0 - 0.5 * outside));
    (standard, dof, [low.min(value), high.max(value)])
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(pair: u32, speed_m_s: f64, force_n: f64) -> Point {
        Point {
            run: String::new(),
            speed_m_s,
            force_n,
            standard_n: 0.01,
            effective_n: 10.0,
            pair,
            position_m: [0.0, 1.0],
            trend_n: None,
        }
    }

    /// Equal pairs: the jackknife is the standard deviation of the pairs' slopes over √pairs.
    #[test]
    fn the_scatter_of_equal_pairs_is_that_of_their_means() {
        let d = [19.0, 20.5, 20.1, 19.8];
        let points: Vec<Point> =
            (0..4).flat_map(|k| [0.2, -0.5].map(|v: f64| point(k, v, d[k as usize] * v * v.abs()))).collect();
        let mean = d.iter().sum::<f64>() / 4.0;
        let s = (d.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / 3.0).sqrt();
        let (u, dof, _) = scatter(&points).unwrap();
        assert!((u - s / 2.0).abs() < 1e-12 && dof == 3.0, "{u} {dof}");
        assert!((slope(&points).unwrap() - mean).abs() < 1e-12);
    }

    #[test]
    fn a_constant_force_beside_the_drag_is_told() {
        let points: Vec<Point> = (0..3)
            .flat_map(|k| {
                [0.1, 0.3, -0.5]
                    .map(|v: f64| point(k, v, 20.0 * v * v.abs() - (0.6 + 0.01 * f64::from(k)) * v.signum()))
            })
            .collect();
        let offset = offset(&points).unwrap();
        assert!((offset.value + 0.61).abs() < 1e-9 && offset.standard < 0.01, "{offset:?}");
    }

    /// Type A of five pairs beside a certificate's type B: the stated interval covers 95 % of repeated campaigns.
    ///
    /// 20 000 campaigns: the binomial standard deviation is 0.15 %; Welch and Satterthwaite's own error is below 1 % here.
    #[test]
    fn the_interval_of_scatter_and_certificate_together_covers() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
        let part = |standard, dof, kind| Part {
            name: String::new(),
            shared: "campaign",
            standard,
            dof,
            shape: Shape::Bell,
            kind,
            in_scatter: false,
        };
        for certificate in [0.02, 0.1, 0.3] {
            let hits = (0..20_000)
                .filter(|_| {
                    let pairs: Vec<f64> = (0..5).map(|_| 0.22 * normal()).collect();
                    let mean = pairs.iter().sum::<f64>() / 5.0;
                    let s = (pairs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 20.0).sqrt();
                    let budget = [part(s, 4.0, 'A'), part(certificate, f64::INFINITY, 'B')];
                    let (_, _, [low, high]) = combine(mean + certificate * normal(), &budget, 1);
                    (low..=high).contains(&0.0)
                })
                .count();
            let rate = hits as f64 / 20_000.0;
            assert!((rate - 0.95).abs() < 0.0115, "certificate {certificate}: {rate}");
        }
    }

    /// A uniform error alone: its interval holds the middle 95 % of it, and the value where that lies outside.
    #[test]
    fn an_error_to_one_side_gives_an_interval_to_one_side() {
        let part = Part {
            name: String::new(),
            shared: "campaign",
            standard: 1.0,
            dof: f64::INFINITY,
            shape: Shape::Between(-4.0, 0.0),
            kind: 'B',
            in_scatter: false,
        };
        let (_, _, [low, high]) = combine(10.0, &[part], 1);
        // The quantile of 20 000 uniform draws scatters by 4·√(0.025/20 000) = 0.005.
        assert!((low - 6.1).abs() < 0.02 && high == 10.0, "{low} {high}");
    }

    #[test]
    fn one_pair_alone_says_so_and_one_run_alone_has_no_interval() {
        let setup = DragSetup::of_the_paper();
        let alone = coefficient(Method::Fsm, vec![point(1, 0.5, 5.0)], &setup, None).unwrap();
        assert!(alone.interval_95.is_none() && (alone.value - 20.0).abs() < 1e-12);
        let pair = coefficient(Method::Fsm, vec![point(1, 0.5, 5.0), point(1, 0.3, 1.9)], &setup, None).unwrap();
        assert_eq!(pair.budget[0].shared, "run");
        assert!(pair.interval_95.is_some());
    }
}
