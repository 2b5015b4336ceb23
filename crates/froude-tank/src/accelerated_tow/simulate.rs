//! The twin of a campaign's accelerated tows: the logs and sidecars that it would give for chosen true coefficients.
//!
//! What is declared with an uncertainty is drawn once for the campaign, about what is declared: masses, delay, the gains of force and motion. Each run
//! has a zero of its own.

use crate::names::ACCELERATED_TOW;
use froude_identify::dataset::Dataset;
use froude_identify::law::ForceLaw;
use froude_identify::method::{Export, MethodError};
use froude_identify::simulate::truth;
use froude_records::campaign::{Campaign, SensorSpec, Source, Truth};
use froude_records::run::Role;
use froude_rig::accelerated_tow::{AcceleratedTrace, accelerated};

use super::law::{Channels, data, names, with_acceleration};
use super::reduce::Mounted;
use super::rows::{TowRun, Way};
use super::section::{self, profile};
use super::setup::{Setup, declared, no_mass, setup_of};
use crate::declared::uncertain;
use crate::error::undeclared;
use crate::matrix::{Point, of_configurations};
use crate::sensors::{Senses, reading, seed_and_sensors};
use crate::twin::{Column, Draws, Logged, seed_of};

/// Standard deviation of the zero of a run, N.
const ZERO_N: f64 = 0.2;

/// What the twin has: force and position.
pub(super) fn senses() -> [Senses<'static>; 1] {
    [Senses::with_memory(["force", "position"])]
}

/// A run with its log.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulated {
    /// As it was planned.
    pub point: Point,
    /// Which body of the setup.
    pub body: usize,
    /// What was logged.
    pub trace: AcceleratedTrace,
}

impl Simulated {
    /// The log as the reduction takes it.
    #[must_use]
    pub fn view(&self) -> Mounted<'_> {
        let run = TowRun {
            id: &self.point.id,
            time_s: &self.trace.time_s,
            way: Way::Position(&self.trace.position_m),
            force_n: &self.trace.force_n,
            marks: &[],
        };
        Mounted { run, body: self.body, is_dry: self.is_dry() }
    }

    pub(super) fn is_dry(&self) -> bool {
        self.point.role == Role::DryAir
    }
}

/// What is true on the twin.
#[derive(Debug, Clone)]
pub struct Truths {
    /// The law with its term of the acceleration.
    pub law: ForceLaw,
    /// Its coefficients.
    pub values: Vec<f64>,
}

impl Truths {
    /// Of `[simulate]`: a drag law and its coefficients, and the added-mass coefficient of the axis beside them.
    ///
    /// # Errors
    ///
    /// No `[simulate]`, a record instead of coefficients, a coefficient that is not stated.
    pub fn of(campaign: &Campaign, source: &Source, setup: &Setup) -> Result<Self, MethodError> {
        let added = names(&setup.axis)[3].clone();
        let refuse = |what: String| undeclared("[simulate]", what);
        let mut own = campaign.clone();
        own.sources = vec![source.clone()];
        own.simulate.iter_mut().for_each(|simulate| simulate.stated.retain(|stated| stated.coefficient != added));
        let Some(Truth::Coefficients { values, .. }) = own.simulate.as_mut().map(|s| &mut s.truth) else {
            return Err(refuse(format!(
                "the twin of {ACCELERATED_TOW} needs seed, model, and the true coefficients of drag and {added} in [simulate.coefficients]"
            )));
        };
        let value = values
            .shift_remove(&added)
            .ok_or_else(|| refuse(format!("{added} is missing in [simulate.coefficients]; the truth needs it")))?;
        let row = row_of(setup, 0, 0.1, 0.1);
        let (drag, mut values) = truth(&own, &row)?;
        let law = with_acceleration(&drag, &row, &setup.axis)?;
        values.push(value);
        let at = |name: &str| drag.position(name).or_else(|| (name == added).then_some(values.len() - 1));
        let values = law.coefficients.iter().map(|c| at(&c.name).map_or(0.0, |j| values[j])).collect();
        Ok(Self { law, values })
    }

    /// Load of the water on a body along the axis, N.
    #[must_use]
    pub fn load_n(&self, setup: &Setup, body: usize, speed_m_s: f64, acceleration_m_s2: f64) -> f64 {
        let row = row_of(setup, body, speed_m_s, acceleration_m_s2);
        self.law.predict(&row, &self.values).map_or(f64::NAN, |f| f[0])
    }
}

fn row_of(setup: &Setup, body: usize, speed_m_s: f64, acceleration_m_s2: f64) -> Dataset {
    let of = &setup.bodies[body];
    let channels = Channels {
        run: vec![String::new()],
        configuration: vec![of.name.clone()],
        speed_m_s: vec![speed_m_s],
        acceleration_m_s2: vec![acceleration_m_s2],
        load_n: vec![0.0],
        volume_m3: vec![of.volume_m3],
        density_kg_m3: setup.density_kg_m3,
    };
    data(channels, &setup.axis)
}

/// Points of the drag, tabulated once for each body.
const GRID: usize = 2000;

/// Drag of a body between ± its largest speed, and the slope of the load over the acceleration.
struct Table {
    top_m_s: f64,
    drag_n: Vec<f64>,
    per_acceleration: f64,
}

impl Table {
    fn of(truth: &Truths, setup: &Setup, body: usize, top_m_s: f64) -> Self {
        let at = |g: usize| top_m_s * (2.0 * g as f64 / GRID as f64 - 1.0);
        Self {
            top_m_s,
            drag_n: (0..=GRID).map(|g| truth.load_n(setup, body, at(g), 0.0)).collect(),
            per_acceleration: truth.load_n(setup, body, 0.0, 1.0) - truth.load_n(setup, body, 0.0, 0.0),
        }
    }

    fn load_n(&self, speed_m_s: f64, acceleration_m_s2: f64) -> f64 {
        let place = (0.5 * GRID as f64 * (speed_m_s / self.top_m_s + 1.0)).clamp(0.0, GRID as f64 - 1e-9);
        let (g, part) = (place as usize, place.fract());
        (1.0 - part) * self.drag_n[g] + part * self.drag_n[g + 1] + self.per_acceleration * acceleration_m_s2
    }
}

/// A source's planned runs, what is declared of them, and the truth.
#[derive(Debug, Clone)]
pub struct Twin {
    /// The runs.
    pub points: Vec<Point>,
    /// What is declared.
    pub setup: Setup,
    /// What is true.
    pub truth: Truths,
}

impl Twin {
    /// Of a campaign.
    ///
    /// # Errors
    ///
    /// What the campaign does not declare.
    pub fn of(campaign: &Campaign, source: &Source) -> Result<Self, MethodError> {
        Self::with(campaign, source, section::plan(source)?)
    }

    /// Of the given runs.
    ///
    /// # Errors
    ///
    /// As [`Self::of`].
    pub fn with(campaign: &Campaign, source: &Source, points: Vec<Point>) -> Result<Self, MethodError> {
        let setup = setup_of(campaign, source, &declared(source)?, &of_configurations(points.iter()))?;
        let truth = Truths::of(campaign, source, &setup)?;
        Ok(Self { points, setup, truth })
    }

    /// The logs of all planned runs; the same seed gives the same logs. `sensors` are `position` and `force`. `None` where the mass of a body is not declared.
    #[must_use]
    pub fn simulated(&self, sensors: &[SensorSpec], seed: u64) -> Option<Vec<Simulated>> {
        self.drawn((sensors, seed), Draws::of(seed))
    }

    /// The same without errors of sensors and of what is declared.
    pub(super) fn exactly(&self) -> Option<Vec<Simulated>> {
        self.drawn((&[], 0), Draws::none())
    }

    fn drawn(&self, (sensors, seed): (&[SensorSpec], u64), mut draws: Draws) -> Option<Vec<Simulated>> {
        let Self { points, setup, truth } = self;
        let delay_s = draws.about(uncertain(setup.delay_s));
        let [force, motion] = [setup.force_relative, setup.motion_relative].map(|part| draws.gain(part));
        let masses: Vec<f64> =
            (setup.bodies.iter()).map(|body| body.mass_kg.map(|m| draws.about(uncertain(m)))).collect::<Option<_>>()?;
        let top = points.iter().fold(0.0_f64, |m, point| m.max(point.condition("speed").abs()));
        let tables: Vec<Table> = (0..setup.bodies.len()).map(|b| Table::of(truth, setup, b, 1.01 * top)).collect();
        let mut out = Vec::new();
        for (i, point) in points.iter().enumerate() {
            let readings = [
                reading(sensors, &["position"], 0.0, motion),
                reading(sensors, &["force"], ZERO_N * draws.normal(), force),
            ];
            let body = setup.bodies.iter().position(|b| b.name == point.configuration).unwrap_or(0);
            let is_dry = point.role == Role::DryAir;
            let load = |v: f64, a: f64| if is_dry { 0.0 } else { tables[body].load_n(v, a) };
            let (rate_hz, seed) = (point.condition("rate"), seed_of(seed, i));
            let trace = accelerated(profile(point), rate_hz, masses[body], delay_s, readings, &load, seed);
            out.push(Simulated { point: point.clone(), body, trace });
        }
        Some(out)
    }
}

/// The files of all planned runs of a source: a log and its sidecar each.
///
/// # Errors
///
/// What the campaign does not declare.
pub fn files(campaign: &Campaign, source: &Source) -> Result<Vec<Export>, MethodError> {
    let twin = Twin::of(campaign, source)?;
    let (seed, sensors) = seed_and_sensors(campaign, &senses())?;
    let runs = twin.simulated(sensors, seed).ok_or_else(|| no_mass(source, &twin.setup))?;
    Ok(runs.iter().flat_map(files_of).collect())
}

fn files_of(run: &Simulated) -> [Export; 2] {
    let column = |described, places, values| Column { described, places, values };
    let logged = Logged {
        id: &run.point.id,
        said: "A run of the twin.",
        method: ACCELERATED_TOW,
        role: run.point.role,
        configuration: &run.point.configuration,
        conditions: &[],
        time: ("time", &run.trace.time_s),
        columns: &[
            column(["x", "position", "m", "body", ""], 8, &run.trace.position_m),
            column(["force", "force", "N", "body", "   # of the rig on the body"], 6, &run.trace.force_n),
        ],
    };
    logged.files()
}
