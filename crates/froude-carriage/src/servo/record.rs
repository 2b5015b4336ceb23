//! Models of an axis as estimates: coefficients with their covariance, and what they come to at the motor's shaft.
//!
//! The law gives the force of the drive at the chain, ideal gear, on the motion along y:
//!
//! | law                   | `drive_force` , N                                                                |
//! |-----------------------|-------------------------------------------------------------------------------|
//! | `servo_symmetric`     | `M v̇ + F_v v + F_c sgn v + offset`                                            |
//! | `servo_asymmetric`    | the same with `F_v_pos`, `F_c_pos` for v > 0 and `F_v_neg`, `F_c_neg` for v < 0 |
//! | `servo_over_position` | `F_c` a line between knots over the travel: no formula                         |
//! | `servo_two_mass`      | motor and load with a chain between them (MCD eq. 2 and 3): no formula          |
//!
//! Of an axis that turns, the law gives `drive_torque`, N m, over `angle_dot` and `angle_dot_dot`, with J in the place of M. Formulas of a load are part of the law.
//!
//! An error of the force per volt scales all coefficients of the chain alike, one of the sprocket's radius those of speed, acceleration and stretch
//! twice: they are type B, by the key of the rig, so that two records of one rig have them in common. Of a log without a rig the force
//! per volt is taken as exact, unless a campaign declares its error.

use froude_fit::faer::Mat;
use froude_fit::propagate::effective_dof;
use froude_records::estimate::{
    Clusters, Coefficient, Derived, Diagnostics, ErrorKind, Estimate, Frame, Interval, Law, Measured, MethodUsed, OWN,
    Range, SharedError, Signs, Status, TypeA,
};
use froude_records::number::finite;
use indexmap::IndexMap;

use crate::servo::coordinate::{Coordinate, STRIBECK_SPEED, is_inertia, is_place};
use crate::servo::load::Shape;
use crate::servo::motor::Drive;
use crate::servo::report::{RigidFit, ServoCoefficient};
use crate::servo::scale::{ForcePerVolt, combined, errors_of};
use crate::servo::two_mass::{CHAIN_PARAMETERS, FlexibleReport, radius_power};

/// Name of the law of two masses.
pub const TWO_MASS: &str = "servo_two_mass";

/// The load that the laws give.
const LOAD: &str = "drive_force";

/// What an interval of a log includes.
fn with_bias(pieces: &str) -> String {
    format!("{pieces}; with the bias that a disturbance can cause")
}

/// Intervals of blocks within one motion, which say nothing of another.
fn of_one_excitation() -> Interval {
    Interval { of: "excitation".to_owned(), ..Interval::default() }
}

/// Name of the law of a rigid model with this friction.
#[must_use]
pub fn law_of(friction: &str) -> String {
    format!("servo_{}", friction.replace(' ', "_"))
}

/// A rigid model as an estimate of `source`; `friction` names its law, `gain` is what made volts into forces.
#[must_use]
pub fn rigid(source: &str, friction: &str, fit: &RigidFit, gain: &ForcePerVolt<'_>) -> Estimate {
    let method = law_of(friction);
    let axis = fit.shape.coordinate.names();
    // Delay and Stribeck's speed say when and where; they are no coefficients of the law.
    let kept: Vec<usize> = (0..fit.coefficients.len()).filter(|j| !is_place(&fit.coefficients[*j].name)).collect();
    let of_law: Vec<ServoCoefficient> = kept.iter().map(|j| fit.coefficients[*j].clone()).collect();
    let dof: Vec<f64> = kept.iter().map(|j| fit.dof[*j]).collect();
    let covariance = Mat::from_fn(kept.len(), kept.len(), |i, j| fit.covariance[(kept[i], kept[j])]);
    let places = fit.coefficients.iter().filter(|c| is_place(&c.name));
    let places = places.map(|c| (c.name.clone(), derived(c, "fitted with the law".to_owned())));
    let names: Vec<String> = of_law.iter().map(|c| in_formulas(&c.name)).collect();
    let coefficients = of_law.iter().zip(&names).zip(&dof).map(|((c, name), dof)| {
        let label = (*name != c.name).then(|| c.name.clone());
        let of_scatter = Coefficient { label, ..coefficient(c, *dof) };
        (name.clone(), combined(of_scatter, (c, *dof), &gain.scales, &radii))
    });
    let formula = formula(&names, &fit.shape);
    let mut constants = IndexMap::from([(gain.name.to_owned(), Measured::of(gain.n_v, gain.unit.as_str()))]);
    let fitted = fit.coefficient(STRIBECK_SPEED).map(|c| c.value);
    if let Some(speed) = fitted.or(fit.shape.stribeck_speed) {
        constants.insert(STRIBECK_SPEED.to_owned(), Measured::of(speed, axis.speed[1]));
    }
    let fewest = finite(dof.iter().copied().reduce(f64::min));
    let errors = errors_of(&gain.scales, &of_law, &radii);
    let pieces = if gain.drive.is_none() { with_bias(&fit.pieces) } else { fit.pieces.clone() };
    // Of a simulated speed the scatter is that of speeds, not of the load that the law gives.
    let (by, of, scatter) = if fit.shape.is_simulated {
        ("output error", axis.speed[0], None)
    } else {
        ("linear least squares", axis.drive, Some((axis.drive.to_owned(), Measured::of(fit.sigma_n, axis.load))))
    };
    let exact = errors.is_empty().then(|| gain.exact.to_owned());
    Estimate {
        id: format!("{source}/{method}"),
        source: source.to_owned(),
        method: MethodUsed::of(&method, format!("{by}; friction {friction}; {}", fit.preparation)),
        law: Law { constants, ..law_along(&method, formula, &fit.shape) },
        coefficients: coefficients.collect(),
        type_a: type_a(names, &covariance, &dof, format!("scatter of the residuals ({pieces})")),
        errors,
        sigma: scatter.into_iter().collect(),
        dof: IndexMap::from([(axis.drive.to_owned(), fewest)]),
        n_observations: fit.n_rows,
        clusters: fit.runs.map(|n| Clusters::of("run", n)),
        interval: if fit.runs.is_some() { Interval::default() } else { of_one_excitation() },
        derived: gain
            .drive
            .map_or_else(IndexMap::new, |drive| effective(fit, drive))
            .into_iter()
            .chain(places)
            .collect(),
        validity: validity(fit),
        diagnostics: Diagnostics {
            condition_number: fit.condition_number,
            relative_residual: IndexMap::from([(of.to_owned(), fit.relative_force_error)]),
            notes: exact.into_iter().chain(fit.findings.iter().cloned()).collect(),
            ..Diagnostics::default()
        },
        ..along(&fit.shape)
    }
}

/// The power with which the sprocket's radius goes into a coefficient of a rigid model: once into the force, and once more into a speed or an
/// acceleration.
fn radii(name: &str) -> f64 {
    if is_inertia(name) || name.starts_with("F_v") { -2.0 } else { -1.0 }
}

/// Two masses with a chain between them as an estimate of `source`; `drive` has the uncertainties that the report was made with.
#[must_use]
pub fn two_mass(source: &str, report: &FlexibleReport, drive: &Drive) -> Estimate {
    let method = TWO_MASS;
    let (own, made) = report.coefficients.split_at(CHAIN_PARAMETERS);
    let names: Vec<String> = own.iter().map(|c| c.name.clone()).collect();
    // The declared inputs are known, not estimated.
    let known = |j: usize, c: &ServoCoefficient| {
        let of_the_rig = c.value * drive.torque_relative.hypot(radius_power(&c.name) * drive.radius_relative);
        report.declared[(j, j)].max(0.0) + of_the_rig * of_the_rig
    };
    let coefficients = own.iter().enumerate().map(|(j, c)| {
        let (scatter, known) = (report.scatter[(j, j)].max(0.0), known(j, c));
        let dof = effective_dof(&[(scatter, report.dof[j]), (known, f64::INFINITY)]);
        let parts = Coefficient { type_a: Some(scatter.sqrt()), type_b: Some(known.sqrt()), ..coefficient(c, dof) };
        (c.name.clone(), parts)
    });
    let identity = (0..CHAIN_PARAMETERS).map(|i| (0..CHAIN_PARAMETERS).map(|j| f64::from(u8::from(i == j))).collect());
    let declared = SharedError {
        name: "declared efficiency, drag and delay, and the prior of the splits".to_owned(),
        quantity: "drive".to_owned(),
        kind: ErrorKind::B,
        covariance: rows_of(&report.declared),
        dof: None,
        limits: None,
        sensitivity: identity.collect(),
    };
    let derived = made.iter().map(|c| (c.name.clone(), derived(c, String::new())));
    Estimate {
        id: format!("{source}/{method}"),
        source: source.to_owned(),
        method: MethodUsed::of(method, "prediction error of the motor's position, two masses and a chain"),
        law: law(method, None),
        interval: of_one_excitation(),
        coefficients: coefficients.collect(),
        type_a: type_a(names, &report.scatter, &report.dof, "CR2 over stretches of the record".to_owned()),
        errors: [(format!("{OWN}drive"), declared)]
            .into_iter()
            .chain(errors_of(&drive.scales(), own, &radius_power))
            .collect(),
        n_observations: report.n_rows,
        derived: derived.collect(),
        diagnostics: Diagnostics { notes: report.findings.clone(), ..Diagnostics::default() },
        ..on_the_chain()
    }
}

/// What all models of an axis have in common.
fn on_the_chain() -> Estimate {
    Estimate {
        kind: "towing".to_owned(),
        frame: Frame { words: "y along the travel of the carriage".to_owned(), ..Frame::chain() },
        signs: Signs(
            "force of the drive on the carriage at the chain, ideal gear; speed of the carriage along y".to_owned(),
        ),
        ..Estimate::default()
    }
}

/// The frame of a model of one coordinate.
fn along(shape: &Shape) -> Estimate {
    match shape.coordinate {
        Coordinate::Linear if shape.is_simulated => Estimate {
            frame: Frame { words: "y along the motion of the vehicle or axis".to_owned(), ..Frame::chain() },
            signs: Signs(
                "force of the drive along the motion; positive in the direction of positive speeds".to_owned(),
            ),
            ..on_the_chain()
        },
        Coordinate::Linear => on_the_chain(),
        Coordinate::Rotary => Estimate {
            kind: "towing".to_owned(),
            frame: Frame { name: "joint".to_owned(), words: "rotation about the axis".to_owned(), ..Frame::default() },
            signs: Signs(
                "torque of the drive on the axis, ideal gear; positive in the direction of the angle".to_owned(),
            ),
            ..Estimate::default()
        },
    }
}

fn law_along(name: &str, formula: Option<String>, shape: &Shape) -> Law {
    let axis = shape.coordinate.names();
    let read = shape.loads.iter().flat_map(|load| &load.channels).filter(|name| *name != axis.speed[0]);
    let read = read.map(|name| [name.as_str(), axis.position[1]]);
    let inputs = [axis.speed, axis.acceleration].into_iter().chain(read).map(|[name, unit]| (name, unit));
    Law::of(name, inputs).giving(axis.drive, axis.load, formula)
}

fn law(name: &str, formula: Option<String>) -> Law {
    Law::of(name, [("v_y", "m/s"), ("v_y_dot", "m/s^2")]).giving(LOAD, "N", formula)
}

/// A name as a formula can have it: a sign becomes a word.
pub(crate) fn in_formulas(name: &str) -> String {
    match name.strip_suffix(['+', '-']) {
        Some(stem) => format!("{stem}_{}", if name.ends_with('+') { "pos" } else { "neg" }),
        None => name.to_owned(),
    }
}

/// The law over speed and acceleration; `None` with a term that no formula gives, as a map over position.
fn formula(names: &[String], shape: &Shape) -> Option<String> {
    let axis = shape.coordinate.names();
    let (v, a) = (axis.speed[0], axis.acceleration[0]);
    let is_of_load =
        |name: &&String| shape.loads.iter().flat_map(|load| &load.coefficients).any(|(own, _)| own == *name);
    let of = |name: &String| {
        Some(match name.as_str() {
            "M" | "J" => format!("{name}*{a}"),
            "F_v" => format!("F_v*{v}"),
            "F_c" => format!("F_c*sign({v})"),
            "F_v_pos" => format!("0.5*F_v_pos*({v} + abs({v}))"),
            "F_v_neg" => format!("0.5*F_v_neg*({v} - abs({v}))"),
            "F_c_pos" => format!("0.5*F_c_pos*(sign({v}) + 1)"),
            "F_c_neg" => format!("0.5*F_c_neg*(sign({v}) - 1)"),
            "F_s" => format!("F_s*sign({v})*exp(-({v}/v_s)^2)"),
            "offset" => "offset".to_owned(),
            _ => return None,
        })
    };
    let own = names.iter().filter(|name| !is_of_load(name)).map(of).collect::<Option<Vec<_>>>()?;
    let terms = own.into_iter().chain(shape.loads.iter().map(|load| load.text.clone()));
    (!shape.is_tabled).then(|| terms.collect::<Vec<_>>().join(" + "))
}

fn coefficient(c: &ServoCoefficient, dof: f64) -> Coefficient {
    Coefficient {
        nuisance: c.name == "offset",
        standard_uncertainty: finite(Some(c.block_std)),
        type_a: finite(Some(c.block_std)),
        interval_95: interval(c),
        effective_dof: finite(Some(dof)),
        ..Coefficient::of(Some(c.value), c.unit.as_ref(), Status::Free)
    }
}

fn derived(c: &ServoCoefficient, formula: String) -> Derived {
    let standard_uncertainty = finite(Some(c.block_std));
    Derived { standard_uncertainty, interval_95: interval(c), ..Derived::of(formula, Some(c.value), c.unit.as_ref()) }
}

fn interval(c: &ServoCoefficient) -> Option<[f64; 2]> {
    Some(c.interval).filter(|ends| ends.iter().all(|x| x.is_finite()))
}

/// J_eff, B_eff and C_eff, where the drive is declared. The radius that made a force of a torque makes it one again, and speeds rates: only K_T and
/// the amplifier err in them.
fn effective(fit: &RigidFit, drive: &Drive) -> IndexMap<String, Derived> {
    let ratio = drive.motor.m_rad();
    let of = |c: ServoCoefficient| {
        let (from, power) = match c.name.as_str() {
            "J_eff" => ("M", 2),
            "B_eff" => ("F_v", 2),
            _ => ("F_c", 1),
        };
        let dof = fit.coefficients.iter().zip(&fit.dof).find(|(own, _)| own.name == from).map(|(_, dof)| *dof);
        let [torque_alone, _] = drive.scales();
        let dof = dof.unwrap_or(f64::INFINITY);
        let whole = combined(coefficient(&c, dof), (&c, dof), &[torque_alone], &|_| 1.0);
        let number = Derived {
            standard_uncertainty: whole.standard_uncertainty,
            interval_95: whole.interval_95,
            ..derived(&c, format!("{from}*({ratio:e} m/rad)^{power}"))
        };
        (c.name.clone(), number)
    };
    crate::servo::report::effective(fit, &drive.motor).into_iter().map(of).collect()
}

/// Range of the speeds and accelerations of the rows, from those of the columns of the regression; a column of one direction is 0 in the other.
fn validity(fit: &RigidFit) -> IndexMap<String, Range> {
    let mut out: IndexMap<String, Range> = IndexMap::new();
    let axis = fit.shape.coordinate.names();
    for (c, ends) in fit.coefficients.iter().zip(&fit.ranges) {
        let [key, unit] = match c.name.as_str() {
            "M" | "J" => axis.acceleration,
            "F_v" | "F_v+" | "F_v-" => axis.speed,
            _ => continue,
        };
        if ends[0] <= ends[1] {
            out.entry(key.to_owned()).or_insert_with(|| Range::of(*ends, unit)).include(*ends);
        }
    }
    out
}

/// Scatter as a record holds it; `None` where it is not finite.
fn type_a(names: Vec<String>, covariance: &Mat<f64>, dof: &[f64], kind: String) -> Option<TypeA> {
    let matrix = rows_of(covariance);
    let is_finite = matrix.iter().flatten().all(|x| x.is_finite());
    is_finite.then(|| TypeA::of(names, matrix, dof, kind))
}

fn rows_of(m: &Mat<f64>) -> Vec<Vec<f64>> {
    (0..m.nrows()).map(|i| (0..m.ncols()).map(|j| m[(i, j)]).collect()).collect()
}
