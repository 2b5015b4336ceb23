//! D_d from steady points: least squares, scatter by pairs, budget, interval.
//!
//! F = D_d v|v| through the origin, all points with one weight: friction repeats to a part of itself, so the scatter
//! hardly grows with speed. Type A is the delete-a-pair jackknife, since runs of one pair share mounts and the hour;
//! it has pairs − 1 degrees of freedom. Type B are errors that all pairs share. The interval is Welch and Satterthwaite's;
//! errors to one side (an efficiency that nobody declared) are drawn ([`froude_fit::budget`]).
//!
//! **Source.** Efron & Stein (1981), Ann. Stat. 9 (jackknife); JCGM 100:2008 (GUM).

use froude_fit::budget::{Combined, Kind, OUTSIDE_95, Part, Uncertain, combine, jackknife_of_one};

use super::run::{Ballast, DragSetup, Efficiency, UNDECLARED_EFFICIENCY, UNDECLARED_ROLLING};

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
        self.budget.push(part);
        let combined = combined(&self.budget, self.looks);
        self.type_b = combined.type_b;
        if self.standard.is_some() {
            self.standard = Some(combined.standard);
            self.dof = combined.dof;
            self.interval_95 = Some(combined.interval(self.value));
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
        let (u, dof) = jackknife_of_one(pairs.len(), |g| slope(points.iter().filter(|p| p.pair != pairs[g])))?;
        return Some((u, dof, "pair"));
    }
    let leave = |i: usize| slope(points.iter().enumerate().filter(|(k, _)| *k != i).map(|(_, p)| p));
    jackknife_of_one(points.len(), leave).map(|(u, dof)| (u, dof, "run"))
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
    let (standard, dof) = jackknife_of_one(pairs.len(), |g| fit(Some(pairs[g])))?;
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
        budget.push(Part::of_one(name.to_owned(), shared, Kind::A, standard, dof));
    }
    shared_errors(method, &points, measured, setup, &mut budget);
    let all = combined(&budget, setup.looks);
    let stated = found.map(|_| all);
    Some(Coefficient {
        method,
        value,
        standard: stated.map(|c| c.standard),
        type_a: stated.map(|c| c.type_a),
        type_b: all.type_b,
        dof: stated.map_or(f64::NAN, |c| c.dof),
        interval_95: stated.map(|c| c.interval(value)),
        looks: setup.looks,
        pairs: pairs(&points).len(),
        offset_n: offset(&points),
        budget,
        points,
    })
}

/// All parts together, the interval held over so many looks (Bonferroni).
fn combined(budget: &[Part], looks: usize) -> Combined {
    combine(budget, 0, OUTSIDE_95 / looks.max(1) as f64)
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
    let mut add = |part: Part| {
        if part.standard(0) > 0.0 {
            budget.push(part);
        }
    };
    let of_campaign =
        |name: &str, standard: f64, dof: f64| Part::of_one(name.to_owned(), "campaign", Kind::B, standard, dof);
    let in_scatter = |name: &str, standard: f64| Part {
        in_scatter: true,
        ..Part::of_one(name.to_owned(), "run", Kind::B, standard, f64::INFINITY)
    };
    let never = f64::INFINITY;
    let size = measured.abs();
    if method.is_sensorless() {
        match (setup.calibration, setup.efficiency) {
            (Some(c), _) => {
                let f = c.force_per_volt_n;
                add(of_campaign("newtons a volt, calibrated", size * f.relative(), f.dof));
            }
            (None, efficiency) => {
                add(of_campaign("K_T and amplifier gain, declared", size * setup.torque_constant_relative, never));
                add(match efficiency {
                    Efficiency::Declared(e) => of_campaign("gear efficiency, declared", size * e.relative(), e.dof),
                    Efficiency::Undeclared => {
                        let limits = UNDECLARED_EFFICIENCY.map(|e| measured * (e - 1.0));
                        Part::of_one_between("gear efficiency, not declared".to_owned(), "campaign", limits)
                    }
                });
            }
        }
        let drift = size * setup.torque_constant_drift_relative * each_alone(points, |p| p.speed_m_s.powi(2));
        add(in_scatter("drift of K_T from run to run, on the drag", drift));
        if let Ballast::Unballasted { unloaded_n, rolling } = setup.ballast {
            let per_newton = slope_of(points, |p| p.speed_m_s.signum());
            add(match rolling {
                Some(r) => {
                    let standard = per_newton * unloaded_n * r.standard;
                    of_campaign("rolling friction that buoyancy takes off", standard, r.dof)
                }
                None => {
                    let name = "rolling friction that buoyancy takes off, not declared";
                    let limits = UNDECLARED_ROLLING.map(|c| c * unloaded_n * per_newton);
                    Part::of_one_between(name.to_owned(), "campaign", limits)
                }
            });
        }
    } else {
        add(of_campaign("gain of the sensor", size * setup.sensor.gain_relative, never));
        let zero = each_alone(points, |p| p.standard_n);
        add(in_scatter("noise, zero of the sensor and its drift", zero));
    }
    // v² takes the sprocket's radius twice; newtons that are not calibrated, (n/R) K_T K_amp, once more in the same direction.
    let times = if method.is_sensorless() && setup.calibration.is_none() { 3.0 } else { 2.0 };
    add(of_campaign("length of an encoder count", times * size * setup.speed_scale_relative, never));
    if let Some(strut) = setup.strut_n_s2_m2 {
        add(of_campaign("drag of the strut", strut.standard, strut.dof));
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
