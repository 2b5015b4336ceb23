//! The joint fit of a forced oscillation: added mass, drag, buoyancies, masses and delay as the unknowns of one equation.
//!
//! Radius, density, flow, masses that no run in air looks for, and the gains of angle and force are declared errors; what is declared of buoyancies, of
//! other masses and of the delay is known beforehand. How it is solved: `joint`.

use std::ops::Range;

use froude_fit as ls;
use froude_fit::budget::Uncertain;
use froude_hydro::swing::{Medium, Pivot};
use froude_records::campaign::Identify;

use super::forces::{Drag, Factors, Values};
use super::setup::{OscillationRun, Setup};
use crate::error::TankError;
use crate::joint::{Enters, Equation, Input, JointFit, Problem, Run, Terms};
use crate::motion::Motion;

pub use crate::joint::DELAY;

/// Name of the added-mass coefficient.
pub const ADDED: &str = "C_A";
/// Start of the names of masses that runs in air determine.
pub const MASS: &str = "m";
/// Start of the names of net buoyancies.
pub const BUOYANCY: &str = "B_buoyancy";

/// Coefficients of all runs by one drag law.
pub type OscillationFit = JointFit;

/// Fits a drag law, added mass, buoyancy and delay to all runs together.
///
/// `motions` belongs to `runs`, one each. Bounds, fixed values, exclusions and priors of `identify` act by the coefficient's name.
///
/// # Errors
///
/// [`TankError`]: impossible declarations, a law that cannot be used, what the least squares refuse, a delay that runs away.
pub fn fit(
    runs: &[OscillationRun<'_>],
    motions: &[Motion],
    setup: &Setup,
    drag: &Drag,
    identify: &Identify,
) -> Result<OscillationFit, TankError> {
    setup.check()?;
    if !runs.iter().any(|run| run.medium == Medium::Water) {
        return Err(TankError::new("no run in water was given; a forced oscillation needs at least one"));
    }
    problem(runs, motions, setup, drag, identify).fit()
}

/// The force on the cell, and where its unknowns stand.
pub(super) struct Swing<'a> {
    runs: &'a [OscillationRun<'a>],
    motions: &'a [Motion],
    setup: &'a Setup,
    drag: &'a Drag,
    /// Where the buoyancy of each body stands, if it has one.
    pub(super) buoyancy: Vec<Option<usize>>,
    /// Where the mass of each body stands, if runs in air look for it.
    pub(super) mass: Vec<Option<usize>>,
    unknowns: usize,
    errs: Vec<Errs>,
}

impl Equation for Swing<'_> {
    fn terms(
        &self,
        run: usize,
        rows: Range<usize>,
        delay_s: f64,
        moved: Option<(usize, f64)>,
    ) -> Result<Terms, TankError> {
        let mut values = Values::of(self.setup);
        if let Some((k, by)) = moved {
            self.errs[k].shift(&mut values, by);
        }
        let body = self.runs[run].body;
        let mut out = Terms::zero(rows.len(), self.unknowns);
        let context = (self.setup, &values, self.drag);
        let factors = Factors::of(&self.runs[run], &self.motions[run], rows, delay_s, context)?;
        out.put(Some(0), 0.0, &factors.added);
        for (j, drag) in factors.drag.iter().enumerate() {
            out.put(Some(1 + j), 0.0, drag);
        }
        out.put(self.mass[body], values.mass_kg[body], &factors.mass);
        let declared = self.setup.bodies[body].buoyancy_n.map_or(0.0, |b| b.value);
        out.put(self.buoyancy[body], declared, &factors.buoyancy);
        Ok(out)
    }
}

pub(super) fn problem<'a>(
    runs: &'a [OscillationRun<'a>],
    motions: &'a [Motion],
    setup: &'a Setup,
    drag: &'a Drag,
    identify: &'a Identify,
) -> Problem<'a, Swing<'a>> {
    let mut names = vec![(ADDED.to_owned(), "1".to_owned())];
    let mut start = vec![0.0];
    names.extend(drag.coefficients().map(|(name, unit)| (name.to_owned(), unit.to_owned())));
    start.resize(names.len(), 0.0);
    let mut priors = Vec::new();
    let mut look_for = |what: &str, name: String, unit: &str, known: Option<Uncertain>, start_at: f64| {
        let index = names.len();
        names.push((name, unit.to_owned()));
        start.push(start_at);
        if let Some(known) = known {
            priors.push((what.to_owned(), ls::Prior::new(index, known.value, known.standard)));
        }
        index
    };
    let is_there = |body: usize, medium: Medium| runs.iter().any(|run| run.body == body && run.medium == medium);
    let named = |what: &str, body: &str| if body.is_empty() { what.to_owned() } else { format!("{what}_{body}") };
    let mut buoyancy = Vec::new();
    for (i, body) in setup.bodies.iter().enumerate() {
        let is_unknown = setup.pivot == Pivot::Stream
            && is_there(i, Medium::Water)
            && body.buoyancy_n.is_none_or(|b| b.standard > 0.0);
        let what = of_body("buoyancy", &body.name);
        buoyancy.push(is_unknown.then(|| look_for(&what, named(BUOYANCY, &body.name), "N", body.buoyancy_n, 0.0)));
    }
    let mut mass = Vec::new();
    for (i, body) in setup.bodies.iter().enumerate() {
        let (what, known) = (of_body("mass", &body.name), body.mass_kg);
        mass.push(
            is_there(i, Medium::Air).then(|| look_for(&what, named(MASS, &body.name), "kg", Some(known), known.value)),
        );
    }
    let delay = match setup.delay_s {
        Some(delay) if delay.standard <= 0.0 => Err(delay.value),
        known => Ok(look_for(DELAY, DELAY.to_owned(), "s", known, known.map_or(0.0, |d| d.value))),
    };
    let errs = Errs::all(setup, runs);
    Problem {
        law: drag.law.name.clone(),
        runs: (runs.iter().zip(motions)).map(|(run, motion)| Run { id: run.id, load: run.force_n, motion }).collect(),
        inputs: errs.iter().map(|e| e.input(setup)).collect(),
        equation: Swing { runs, motions, setup, drag, buoyancy, mass, unknowns: names.len(), errs },
        bounded: 1..1 + drag.columns.len(),
        names,
        start,
        delay,
        priors,
        identify,
    }
}

fn of_body(what: &str, body: &str) -> String {
    if body.is_empty() { what.to_owned() } else { format!("{what} of {body}") }
}

/// A declared number that errs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Errs {
    Radius,
    Mass(usize),
    Density,
    Flow,
    Angle,
    Force,
}

impl Errs {
    /// Those with an uncertainty.
    fn all(setup: &Setup, runs: &[OscillationRun<'_>]) -> Vec<Self> {
        let bodies = 0..setup.bodies.len();
        let in_air = |b: usize| runs.iter().any(|run| run.body == b && run.medium == Medium::Air);
        let masses = bodies.filter(|&b| runs.iter().any(|run| run.body == b) && !in_air(b)).map(Self::Mass);
        [Self::Radius, Self::Density, Self::Flow, Self::Angle, Self::Force]
            .into_iter()
            .chain(masses)
            .filter(|errs| errs.input(setup).declared.standard > 0.0)
            .collect()
    }

    fn input(self, setup: &Setup) -> Input {
        let gain = |part: f64| Uncertain::new(1.0, part);
        let (name, declared, enters) = match self {
            Self::Radius => ("radius".to_owned(), setup.radius_m, Enters::Constant(setup.radius_m.value.abs())),
            // The force is linear in it: any step will do.
            Self::Mass(b) => (of_body("mass", &setup.bodies[b].name), setup.bodies[b].mass_kg, Enters::Constant(1.0)),
            Self::Density => ("density".to_owned(), setup.density_kg_m3, Enters::Constant(setup.density_kg_m3.value)),
            Self::Flow => ("speed of the stream".to_owned(), gain(setup.flow_relative), Enters::Constant(1.0)),
            Self::Angle => ("gain of the angle".to_owned(), gain(setup.angle_relative), Enters::Angle),
            Self::Force => ("gain of the force".to_owned(), gain(setup.force_relative), Enters::Load),
        };
        Input { name, declared, enters }
    }

    fn shift(self, values: &mut Values, by: f64) {
        match self {
            Self::Radius => values.radius_m += by,
            Self::Mass(b) => values.mass_kg[b] += by,
            Self::Density => values.density_kg_m3 += by,
            Self::Flow => values.flow_factor += by,
            Self::Angle => values.angle_factor += by,
            Self::Force => {}
        }
    }
}
