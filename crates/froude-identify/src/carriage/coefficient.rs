//! D_d from steady points: least squares, scatter by pairs, budget, interval.
//!
//! F = D_d v|v| through the origin, all points with one weight: friction repeats to a part of itself, so the scatter
//! hardly grows with speed. Type A is the delete-a-pair jackknife, since runs of one pair share mounts and the hour;
//! it has pairs − 1 degrees of freedom. Type B are errors that all pairs share. The interval is Welch and Satterthwaite's;
//! errors to one side (an efficiency that nobody declared) are drawn ([`froude_fit::budget`]).
//!
//! **Source.** Efron & Stein (1981), Ann. Stat. 9 (jackknife); JCGM 100:2008 (GUM).

use froude_fit::budget::{Kind, Part, Uncertain, jackknife_of_one};
use froude_records::campaign::{Identify, SourceKind};
use froude_records::units::Dimension;
use indexmap::IndexMap;

use super::run::{Ballast, DragSetup, Efficiency, UNDECLARED_EFFICIENCY, UNDECLARED_ROLLING};
use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::regression::{ModelFit, Settings, regress};
use crate::uncertainty::SharedError;

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
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Fsm, Self::Mcd, Self::MbdpConstant, Self::MbdpMapped, Self::MbdpFlexible];

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
#[derive(Debug, Clone)]
pub struct Coefficient {
    /// How.
    pub method: Method,
    /// The fit.
    pub model: ModelFit,
    /// The observations that were fitted, a row per point.
    pub data: Dataset,
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

/// D_d of points already in newtons: the common regression on f_x = −D v_x|v_x|, all rows with one weight. The scatter is replaced by `type_a`
/// where the method has more to shake than its points; `more` are errors that only it knows.
///
/// `None` without a moving point.
///
/// # Errors
///
/// Numbers that leave what a computer holds.
pub fn coefficient(
    method: Method,
    mut points: Vec<Point>,
    setup: &DragSetup,
    type_a: Option<TypeA>,
    more: Vec<SharedError>,
) -> Result<Option<Coefficient>, IdentifyError> {
    restore_buoyancy(method, &mut points, setup);
    let Some(measured) = slope(&points) else { return Ok(None) };
    let found = match type_a {
        Some(TypeA { standard, dof, name }) => Some((standard, dof, "pair", name)),
        None => scatter(&points).map(|(u, dof, shared)| {
            let name = if shared == "pair" { "scatter between pairs" } else { "scatter of the runs about the law" };
            (u, dof, shared, name)
        }),
    };
    let given =
        found.map(|(standard, dof, shared, name)| Part::of_one(name.to_owned(), shared, Kind::A, standard, dof));
    let mut errors = shared_errors(method, &points, measured, setup);
    errors.extend(more);
    let data = observations(&points, setup);
    let law = ForceLaw::formulas(LAW, &IndexMap::from([(setup.load().to_owned(), formula(setup))]), &data)?;
    let model = regress(
        &law,
        &data,
        Settings {
            source_name: &setup.name,
            kind: SourceKind::Towing,
            identify: &Identify::default(),
            budget: &[],
            campaign: "",
            shared_errors: &errors,
            scatter: given.as_ref(),
            looks: setup.looks,
        },
    )?;
    let value = model.coefficients[0];
    let stated = model.combined[0].filter(|_| given.is_some());
    // Without pairs or runs to leave out nothing tells the scatter: residuals of one mount are not asked.
    let counts = |part: &&Part| match part.kind {
        Kind::A => given.is_some(),
        Kind::B => part.standard(0) > 0.0,
    };
    let budget: Vec<Part> = model.budget.iter().filter(counts).cloned().collect();
    let declared = |part: &&Part| part.kind == Kind::B && !part.in_scatter;
    Ok(Some(Coefficient {
        method,
        value,
        standard: stated.map(|c| c.standard),
        type_a: stated.map(|c| c.type_a),
        type_b: budget.iter().filter(declared).map(|part| part.covariance[(0, 0)]).sum::<f64>().sqrt(),
        dof: stated.map_or(f64::NAN, |c| c.dof),
        interval_95: stated.map(|c| c.interval(value)),
        looks: setup.looks,
        pairs: pairs(&points).len(),
        offset_n: offset(&points),
        budget,
        points,
        model,
        data,
    }))
}

/// The law: that of a table's `quadratic` along one axis.
const LAW: &str = "quadratic";

/// Its coefficient, which the paper calls D_d.
pub(super) fn name(setup: &DragSetup) -> String {
    format!("D_{}_II", setup.axis())
}

fn formula(setup: &DragSetup) -> String {
    let axis = setup.axis();
    format!("-{}*v_{axis}*abs(v_{axis})", name(setup))
}

/// The points as observations, the drag of the strut taken off: loads of the fluid on the body, against the motion.
fn observations(points: &[Point], setup: &DragSetup) -> Dataset {
    let strut = setup.strut_n_s2_m2.map_or(0.0, |s| s.value);
    let speed: Vec<f64> = points.iter().map(|p| p.speed_m_s).collect();
    let load = points.iter().map(|p| strut * p.speed_m_s * p.speed_m_s.abs() - p.force_n).collect();
    let texts = |of: &dyn Fn(&Point) -> String| points.iter().map(of).collect::<Vec<_>>();
    let mut data = Dataset {
        rows: points.len(),
        configuration: vec![String::new(); points.len()],
        setup: vec![String::new(); points.len()],
        run: texts(&|p| p.run.clone()),
        group: Some(texts(&|p| p.pair.to_string())),
        line: (1..=points.len()).collect(),
        ..Dataset::default()
    };
    data.put(setup.velocity(), speed, Dimension::SPEED);
    data.put("density", vec![setup.density_kg_m3; points.len()], Dimension::DENSITY);
    data.put(setup.load(), load, Dimension::FORCE);
    data
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
fn shared_errors(method: Method, points: &[Point], measured: f64, setup: &DragSetup) -> Vec<SharedError> {
    // An error of the resistance is one of the load with the other sign.
    let by = |of: &dyn Fn(&Point) -> f64| points.iter().map(|p| -of(p)).collect::<Vec<f64>>();
    let of_force = by(&|p| p.force_n);
    let of = |name: &str, direction: &[f64], standard: f64, dof: f64| {
        SharedError::of_load(name, setup.load(), direction, standard, dof)
    };
    let never = f64::INFINITY;
    let mut out = Vec::new();
    if method.is_sensorless() {
        match (setup.calibration, setup.efficiency) {
            (Some(c), _) => {
                let f = c.force_per_volt_n;
                let error = of("newtons a volt, calibrated", &of_force, f.relative(), f.dof);
                out.push(error.known_as(setup.keys.calibration.clone(), "force_per_volt"));
            }
            (None, efficiency) => {
                let error = of("K_T and amplifier gain, declared", &of_force, setup.torque_constant_relative, never);
                out.push(error.known_as(setup.keys.of_rig("torque_constant"), "torque_constant"));
                out.push(match efficiency {
                    Efficiency::Declared(e) => of("gear efficiency, declared", &of_force, e.relative(), e.dof)
                        .known_as(
                            setup.keys.of_rig(&format!("efficiency {:e} {:e}", e.value, e.standard)),
                            "efficiency",
                        ),
                    Efficiency::Undeclared => {
                        let limits = UNDECLARED_EFFICIENCY.map(|e| e - 1.0);
                        SharedError::between("gear efficiency, not declared", setup.load(), &of_force, limits)
                            .known_as(setup.keys.of_rig("efficiency, not declared"), "efficiency")
                    }
                });
            }
        }
        let drift = by(&|p| setup.torque_constant_drift_relative * measured * p.speed_m_s.powi(2));
        out.push(SharedError::of_each_row("drift of K_T from run to run, on the drag", setup.load(), &drift));
        if let Ballast::Unballasted { unloaded_n, rolling } = setup.ballast {
            let of_load = by(&|p| unloaded_n * p.speed_m_s.signum());
            out.push(match rolling {
                Some(r) => of("rolling friction that buoyancy takes off", &of_load, r.standard, r.dof),
                None => {
                    let name = "rolling friction that buoyancy takes off, not declared";
                    SharedError::between(name, setup.load(), &of_load, UNDECLARED_ROLLING)
                }
            });
        }
    } else {
        let error = of("gain of the sensor", &of_force, setup.sensor.gain_relative, never);
        out.push(error.known_as(setup.keys.sensor.clone(), "sensor_gain"));
        let zero = by(&|p| p.standard_n);
        out.push(SharedError::of_each_row("noise, zero of the sensor and its drift", setup.load(), &zero));
    }
    // v² takes the sprocket's radius twice; newtons that are not calibrated, (n/R) K_T K_amp, once more in the same direction.
    let times = if method.is_sensorless() && setup.calibration.is_none() { 3.0 } else { 2.0 };
    // A radius that is taken too large makes the speed too large, and the drag too small.
    let of_length: Vec<f64> = points.iter().map(|p| times * p.force_n).collect();
    let error = of("length of an encoder count", &of_length, setup.speed_scale_relative, never);
    out.push(error.known_as(setup.keys.of_rig("sprocket_radius"), "sprocket_radius"));
    if let Some(strut) = setup.strut_n_s2_m2 {
        // What is taken off too much is missing in the drag.
        let of_strut: Vec<f64> = points.iter().map(|p| p.speed_m_s * p.speed_m_s.abs()).collect();
        let key = setup.keys.rig.as_ref().map(|_| format!("strut/{:e} {:e}", strut.value, strut.standard));
        out.push(of("drag of the strut", &of_strut, strut.standard, strut.dof).known_as(key, "strut_drag"));
    }
    out
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
        let of = |points: Vec<Point>| coefficient(Method::Fsm, points, &setup, None, vec![]).unwrap().unwrap();
        let alone = of(vec![point(1, 0.5, 5.0)]);
        assert!(alone.interval_95.is_none() && (alone.value - 20.0).abs() < 1e-12);
        let pair = of(vec![point(1, 0.5, 5.0), point(1, 0.3, 1.9)]);
        assert_eq!(pair.budget[0].shared, "run");
        assert!(pair.interval_95.is_some());
    }
}
