//! The moment on the torque cell as known motions times unknown coefficients.
//!
//! | run          | moment of the rig on what is mounted, without its zero                                        |
//! |--------------|-----------------------------------------------------------------------------------------------|
//! | body         | J θ̈ + (λ₁ + t₁) θ̈ + (λ₂ + t₂) θ̇ + (λ₃ + t₃) θ̇\|θ̇\| + K sin θ                                  |
//! | body in air  | J θ̈ + K_air sin θ                                                                             |
//! | shaft alone  | J_shaft θ̈ + t₁ θ̈ + t₂ θ̇ + t₃ θ̇\|θ̇\|                                                          |
//!
//! t₁, t₂, t₃ are there where runs of the shaft alone are, K and K_air about a level axis only, J among the unknowns where runs in air are: declared, it is known
//! beforehand there. Gains of angle and torque, J and J_shaft are declared errors. How it is solved: `joint`.
//!
//! **Source.** USR eq. 7 (the fluid's torque).

use std::ops::Range;

use froude_fit as ls;
use froude_fit::budget::Uncertain;
use froude_hydro::swing::Pivot;
use froude_records::campaign::Identify;
use froude_rig::rotation::Mounted;

use super::setup::{RotationRun, Setup};
use crate::error::TankError;
use crate::joint::{DELAY, Enters, Equation, Input, JointFit, Problem, Run, Terms};
use crate::motion::Motion;

/// Names of the coefficients of the body.
pub const LAMBDAS: [&str; 3] = ["lambda_1", "lambda_2", "lambda_3"];
/// Names of those of the shaft.
pub const TARES: [&str; 3] = ["tare_1", "tare_2", "tare_3"];
/// Their units.
pub const UNITS: [&str; 3] = ["kg*m^2", "N*m*s", "N*m*s^2"];
/// Name of the inertia that runs in air determine.
pub const INERTIA: &str = "inertia";
/// Name of the restoring moment in water.
pub const RESTORING: &str = "restoring";
/// Name of the restoring moment in air.
pub const RESTORING_IN_AIR: &str = "restoring_air";
/// Name of the law.
pub const LAW: &str = "fluid_torque";

/// Coefficients of all runs.
pub type RotationFit = JointFit;

/// Fits λ₁, λ₂, λ₃ and what belongs to the rig to all runs together.
///
/// `motions` belongs to `runs`, one each. Bounds, fixed values, exclusions and priors of `identify` act by the coefficient's name.
///
/// # Errors
///
/// [`TankError`]: no run of the body in water, an inertia that nobody knows, what the least squares refuse, a delay that runs away.
pub fn fit(
    runs: &[RotationRun<'_>],
    motions: &[Motion],
    setup: &Setup,
    identify: &Identify,
) -> Result<RotationFit, TankError> {
    problem(runs, motions, setup, identify)?.fit()
}

/// The moment on the cell, and where its unknowns stand.
pub(super) struct Turning<'a> {
    runs: &'a [RotationRun<'a>],
    motions: &'a [Motion],
    setup: &'a Setup,
    tare: Option<usize>,
    inertia: Option<usize>,
    restoring: Option<usize>,
    restoring_in_air: Option<usize>,
    unknowns: usize,
    errs: Vec<Errs>,
}

impl Equation for Turning<'_> {
    fn terms(
        &self,
        run: usize,
        rows: Range<usize>,
        delay_s: f64,
        moved: Option<(usize, f64)>,
    ) -> Result<Terms, TankError> {
        let shift = |errs: Errs| moved.map_or(0.0, |(k, by)| if self.errs[k] == errs { by } else { 0.0 });
        let of = |known: Option<Uncertain>| known.map_or(0.0, |k| k.value);
        let gain = 1.0 + shift(Errs::Angle);
        let mut out = Terms::zero(rows.len(), self.unknowns);
        let mut motion: [Vec<f64>; 4] = Default::default();
        for t in &self.runs[run].time_s[rows] {
            let [angle, rate, second, _] = self.motions[run].angle.at(t - delay_s).map(|x| gain * x);
            for (column, x) in motion.iter_mut().zip([second, rate, rate * rate.abs(), angle.sin()]) {
                column.push(x);
            }
        }
        let [second, rate, square, sine] = &motion;
        let fluid = [second, rate, square];
        let inertia = of(self.setup.inertia_kg_m2) + shift(Errs::Inertia);
        match self.runs[run].mounted {
            Mounted::Body => {
                out.put(self.inertia, inertia, second);
                out.put(self.restoring, of(self.setup.restoring_n_m), sine);
                for (j, x) in fluid.into_iter().enumerate() {
                    out.put(Some(j), 0.0, x);
                    out.put(self.tare.map(|first| first + j), 0.0, x);
                }
            }
            Mounted::BodyInAir => {
                out.put(self.inertia, inertia, second);
                out.put(self.restoring_in_air, 0.0, sine);
            }
            Mounted::Shaft => {
                out.put(None, of(self.setup.tare_inertia_kg_m2) + shift(Errs::TareInertia), second);
                for (j, x) in fluid.into_iter().enumerate() {
                    out.put(self.tare.map(|first| first + j), 0.0, x);
                }
            }
        }
        Ok(out)
    }
}

pub(super) fn problem<'a>(
    runs: &'a [RotationRun<'a>],
    motions: &'a [Motion],
    setup: &'a Setup,
    identify: &'a Identify,
) -> Result<Problem<'a, Turning<'a>>, TankError> {
    let is_there = |mounted: Mounted| runs.iter().any(|run| run.mounted == mounted);
    let (in_air, shaft_alone) = (is_there(Mounted::BodyInAir), is_there(Mounted::Shaft));
    if !is_there(Mounted::Body) {
        return Err(TankError::new(
            "no run with the body in water was given; a rotation needs at least one of the role test",
        ));
    }
    if setup.inertia_kg_m2.is_none() && !in_air {
        return Err(no_inertia());
    }
    if shaft_alone && setup.tare_inertia_kg_m2.is_none() {
        return Err(TankError::new(
            "there are runs of the shaft alone (role = \"tare\"), and its own inertia is not declared: write [source.rotation] tare_inertia, of all that moves below the torque cell \
             without the body",
        ));
    }
    let mut names: Vec<(String, String)> = Vec::new();
    let (mut start, mut priors) = (Vec::new(), Vec::new());
    let mut look_for = |name: &str, unit: &str, known: Option<Uncertain>| {
        let index = names.len();
        names.push((name.to_owned(), unit.to_owned()));
        start.push(known.map_or(0.0, |k| k.value));
        if let Some(known) = known {
            priors.push((name.to_owned(), ls::Prior::new(index, known.value, known.standard)));
        }
        index
    };
    let mut three = |names: [&str; 3]| {
        let first = look_for(names[0], UNITS[0], None);
        look_for(names[1], UNITS[1], None);
        look_for(names[2], UNITS[2], None);
        first
    };
    three(LAMBDAS);
    let tare = shaft_alone.then(|| three(TARES));
    let inertia = in_air.then(|| look_for(INERTIA, UNITS[0], setup.inertia_kg_m2));
    let is_level = setup.axis == Pivot::Stream;
    let is_uncertain = setup.restoring_n_m.is_none_or(|k| k.standard > 0.0);
    let restoring = (is_level && is_uncertain).then(|| look_for(RESTORING, "N*m", setup.restoring_n_m));
    let restoring_in_air = (is_level && in_air).then(|| look_for(RESTORING_IN_AIR, "N*m", None));
    let delay = match setup.delay_s {
        Some(delay) if delay.standard <= 0.0 => Err(delay.value),
        known => Ok(look_for(DELAY, "s", known)),
    };
    let errs = Errs::all(setup, in_air, shaft_alone);
    Ok(Problem {
        law: LAW.to_owned(),
        runs: (runs.iter().zip(motions))
            .map(|(run, motion)| Run { id: run.id, load: run.torque_n_m, motion })
            .collect(),
        inputs: errs.iter().map(|e| e.input(setup)).collect(),
        equation: Turning {
            runs,
            motions,
            setup,
            tare,
            inertia,
            restoring,
            restoring_in_air,
            unknowns: names.len(),
            errs,
        },
        // Damping resists; an added inertia that comes out negative is a finding, not a bound.
        bounded: 1..3,
        names,
        start,
        delay,
        priors,
        identify,
    })
}

pub(super) fn no_inertia() -> TankError {
    TankError::new(
        "the inertia of the body is neither declared nor measured, and added inertia cannot be told from it: write [source.rotation] inertia = { value = \
         \"3.4e-3 kg m^2\", standard = \"1e-5 kg m^2\" }, or turn the body in air (role = \"dry_air\")",
    )
}

/// A declared number that errs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Errs {
    Inertia,
    TareInertia,
    Angle,
    Torque,
}

impl Errs {
    /// Those with an uncertainty.
    fn all(setup: &Setup, in_air: bool, shaft_alone: bool) -> Vec<Self> {
        let is_there = |errs: &Self| match errs {
            Self::Inertia => !in_air,
            Self::TareInertia => shaft_alone,
            Self::Angle | Self::Torque => true,
        };
        let all = [Self::Inertia, Self::TareInertia, Self::Angle, Self::Torque];
        all.into_iter().filter(is_there).filter(|errs| errs.input(setup).declared.standard > 0.0).collect()
    }

    fn input(self, setup: &Setup) -> Input {
        let known = |known: Option<Uncertain>| known.unwrap_or(Uncertain::new(0.0, 0.0));
        let gain = |part: f64| Uncertain::new(1.0, part);
        let (name, declared, enters) = match self {
            // The moment is linear in both: any step will do.
            Self::Inertia => (INERTIA, known(setup.inertia_kg_m2), Enters::Constant(1.0)),
            Self::TareInertia => ("inertia of the shaft", known(setup.tare_inertia_kg_m2), Enters::Constant(1.0)),
            Self::Angle => ("gain of the angle", gain(setup.angle_relative), Enters::Angle),
            Self::Torque => ("gain of the torque", gain(setup.torque_relative), Enters::Load),
        };
        Input { name: name.to_owned(), declared, enters }
    }
}
