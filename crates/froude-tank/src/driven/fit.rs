//! The joint fit of a method with a motor-driven body: which coefficients and constants are looked for, what is known of them, and what errs.

use std::ops::Range;

use froude_fit as ls;
use froude_fit::budget::Uncertain;
use froude_records::campaign::Identify;
use froude_records::run::Role;

use super::method::MotorDriven;
use super::run::Run;
use super::setup::Setup;
use super::spec::{Enters, Factor, Point};
use super::still_run::StillFit;
use crate::error::TankError;
use crate::joint::{self, Equation, Input, JointFit, Known, Problem, Terms};
use crate::motion::{Logged, Motion, Sampled, motion};

/// The motion of every run, without the cycles that a mark touches; `sampled` belongs to `runs`, one each, and is empty where nothing is known of the samples.
///
/// # Errors
///
/// That of the first run whose motion cannot be used.
pub fn motions<M: MotorDriven>(
    runs: &[Run<'_>],
    setup: &Setup<M>,
    sampled: &[Sampled<'_>],
) -> Result<Vec<Motion>, TankError> {
    let spec = M::SPEC;
    let one = |(i, run): (usize, &Run<'_>)| {
        let loads = spec.loads.iter().zip(&run.loads).map(|(load, values)| (load.name, load.unit, *values)).collect();
        let sampled = sampled.get(i).copied().unwrap_or_default();
        let motion_of = (spec.motion.name, spec.motion.unit, run.motion);
        let logged = Logged { id: run.id, time_s: run.time_s, motion: motion_of, loads, sampled };
        motion(&logged, setup.cycles, setup.harmonics)
    };
    runs.iter().enumerate().map(one).collect()
}

/// Runs as the joint fit takes them.
pub(super) fn views<'a>(runs: &'a [Run<'a>], motions: &'a [Motion]) -> Vec<joint::Run<'a>> {
    let one = |(run, motion): (&'a Run<'a>, &'a Motion)| joint::Run { id: run.id, loads: run.loads.clone(), motion };
    runs.iter().zip(motions).map(one).collect()
}

/// Fits coefficients, constants and delay to all runs together.
///
/// `motions` belongs to `runs`, one each. Bounds, fixed values, exclusions and priors of `identify` act by the coefficient's name.
///
/// # Errors
///
/// [`TankError`]: no run in water, a constant that is neither declared nor determined by the runs, a failed least-squares fit, a delay that does not converge.
pub fn fit<M: MotorDriven>(
    runs: &[Run<'_>],
    motions: &[Motion],
    setup: &Setup<M>,
    identify: &Identify,
) -> Result<JointFit, TankError> {
    problem(runs, motions, setup, identify)?.fit()
}

/// The equation of a method for some runs, and where its unknowns stand.
pub(super) struct Driven<'a, M> {
    runs: &'a [Run<'a>],
    motions: &'a [Motion],
    setup: &'a Setup<M>,
    /// Unknown of each coefficient, and of each constant.
    coefficients: Vec<Option<usize>>,
    constants: Vec<Option<usize>>,
    unknowns: usize,
    /// Constant of each declared error.
    errs: Vec<usize>,
}

impl<M: MotorDriven> Equation for Driven<'_, M> {
    fn terms(
        &self,
        run: usize,
        rows: Range<usize>,
        delay_s: f64,
        moved: Option<(usize, f64)>,
    ) -> Result<Vec<Terms>, TankError> {
        let mut values = self.setup.values();
        let mut gain = 1.0;
        if let Some((k, by)) = moved {
            let constant = self.errs[k];
            values[constant] += by;
            if self.setup.constants[constant].enters == Enters::Motion {
                gain += by;
            }
        }
        let at = |t: &f64| {
            let [place, rate, second, _] = self.motions[run].angle.at(t - delay_s);
            [place, rate, second].map(|x| gain * x)
        };
        let motion: Vec<[f64; 3]> = self.runs[run].time_s[rows].iter().map(at).collect();
        let mut out = vec![Terms::zero(motion.len(), self.unknowns); M::SPEC.loads.len()];
        let mut add = |load: usize, factor: Factor, term: &[f64]| match factor {
            // A coefficient without runs of its role counts as zero.
            Factor::Coefficient(j) => out[load].put(self.coefficients[j], 0.0, term),
            Factor::Constant(k) => out[load].put(self.constants[k], values[k], term),
        };
        self.setup.method.terms(&self.runs[run].point, &values, &motion, &mut add)?;
        Ok(out)
    }
}

pub(super) fn problem<'a, M: MotorDriven>(
    runs: &'a [Run<'a>],
    motions: &'a [Motion],
    setup: &'a Setup<M>,
    identify: &'a Identify,
) -> Result<Problem<'a, Driven<'a, M>>, TankError> {
    let points: Vec<&Point> = runs.iter().map(|run| &run.point).collect();
    if !points.iter().any(|point| point.role == Role::Test) {
        let what =
            format!("no run with the body in water was given; {} needs at least one of the role test", M::SPEC.called);
        return Err(TankError::new(what));
    }
    setup.check(&points)?;
    setup.method.check_runs(&points)?;
    let (mut names, mut start, mut priors) = (Vec::new(), Vec::new(), Vec::new());
    let mut look_for = |name: &str, unit: &str, known: Option<(&str, Uncertain)>| {
        let index = names.len();
        names.push((name.to_owned(), unit.to_owned()));
        start.push(known.map_or(0.0, |(_, known)| known.value));
        let prior = |known: Uncertain| ls::Prior::new(index, known.value, known.standard);
        priors.extend(known.map(|(of, known)| Known::declared(of.to_owned(), prior(known))));
        index
    };
    let (mut bounded, mut varying) = (Vec::new(), Vec::<Vec<usize>>::new());
    let mut coefficients = Vec::new();
    for coefficient in setup.method.coefficients() {
        let is_there = points.iter().any(|point| point.role == coefficient.role);
        let index = is_there.then(|| look_for(&coefficient.name, &coefficient.unit, None));
        bounded.extend(index.filter(|_| coefficient.is_bounded));
        if let Some((index, group)) = index.zip(coefficient.varies) {
            varying.resize(varying.len().max(group + 1), Vec::new());
            varying[group].push(index);
        }
        coefficients.push(index);
    }
    let mut constants = vec![None; setup.constants.len()];
    // The delay is the last.
    let is_delay = |k: &usize| setup.constants[*k].enters == Enters::Delay;
    let (delays, others): (Vec<usize>, Vec<usize>) = (0..constants.len()).partition(is_delay);
    for k in others.into_iter().chain(delays) {
        let constant = &setup.constants[k];
        let unknown = constant.looked_for(points.iter().copied());
        let known = constant.known.map(|known| (constant.name.as_str(), known));
        constants[k] = unknown.map(|unknown| look_for(&unknown.name, unknown.unit, known));
    }
    let delay = setup.enters(|enters| enters == Enters::Delay);
    let held = delay.and_then(|k| setup.constants[k].known).map_or(0.0, |known| known.value);
    let input = |k: &usize| {
        let constant = &setup.constants[*k];
        let declared = constant.known.filter(|known| known.standard > 0.0)?;
        let enters = match constant.enters {
            Enters::Equation(size) => joint::Enters::Constant(size),
            Enters::Factor => joint::Enters::Constant(1.0),
            Enters::Motion => joint::Enters::Motion,
            Enters::Load(load) => joint::Enters::Load(load),
            Enters::Delay | Enters::Derived => return None,
        };
        let matters = constants[*k].is_none() && constant.matters(points.iter().copied());
        matters.then(|| (*k, Input { name: constant.name.clone(), declared, enters }))
    };
    let (errs, inputs): (Vec<usize>, _) = (0..constants.len()).filter_map(|k| input(&k)).unzip();
    let place = |constant: usize| errs.iter().position(|k| *k == constant);
    priors.extend(setup.still_fits.iter().filter_map(|fit| {
        let prior = ls::Prior::new(constants[fit.constant]?, fit.value, fit.standard());
        let of_inputs = fit.gain_sensitivities.iter().filter_map(|(constant, by)| Some((place(*constant)?, *by)));
        let name = StillFit::name_of_prior(&setup.constants[fit.constant].name);
        Some(Known { name, prior, dof: fit.dof, sensitivities: of_inputs.collect() })
    }));
    Ok(Problem {
        law: setup.method.law().to_owned(),
        runs: views(runs, motions),
        inputs,
        delay: delay.and_then(|k| constants[k]).ok_or(held),
        equation: Driven { runs, motions, setup, coefficients, constants, unknowns: names.len(), errs },
        bounded,
        varying,
        names,
        start,
        priors,
        identify,
    })
}
