//! What either method gives: three coefficients, their scatter, and what the declared numbers do to them.

use crate::decay::axis::Motion;
use froude_fit::budget::{Combined, Kind, OUTSIDE_95, Part, Uncertain, combine};
use froude_fit::distribution::coverage_factor;
use froude_fit::faer::Mat;
use froude_records::finding::Finding;

use super::run::{DecaySetup, Restoring};
use crate::findings::warning;
use crate::joint::{DeclaredError, part};

/// How the coefficients were got.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// Turning points and passages.
    Envelope,
    /// The whole motion.
    OutputError,
}

impl Method {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Envelope, Self::OutputError];

    /// As it stands in records and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Envelope => "decay_envelope",
            Self::OutputError => "decay_output_error",
        }
    }

    /// Peaks that a release must have: the envelope has three unknowns and a rest position of its own in four half cycles, the whole motion shows its period and its
    /// decrement from one.
    #[must_use]
    pub const fn fewest_peaks(self) -> usize {
        match self {
            Self::Envelope => 5,
            Self::OutputError => 2,
        }
    }

    /// What to do about fewer.
    pub(super) const fn of_few_peaks(self) -> &'static str {
        match self {
            Self::Envelope => {
                "release from further out, record longer, skip fewer, or use decay_output_error, which needs 2"
            }
            Self::OutputError => {
                "release from further out, record longer, skip fewer, or read the position with less noise"
            }
        }
    }

    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Envelope => "decrement of each half cycle against its speed amplitude, period from the passages",
            Self::OutputError => "equation of motion fitted to the whole of each release",
        }
    }
}

/// A half cycle as one row of the common regression F = D_I u + (8/3π) D_II u|u|.
#[derive(Debug, Clone, PartialEq)]
pub struct HalfCycle {
    /// Name of the run.
    pub run: String,
    /// Its number in the run, from 0.
    pub half_cycle: usize,
    /// Amplitude, mean of the two turning points, m or rad.
    pub amplitude: f64,
    /// u: amplitude of the speed, m/s or rad/s.
    pub speed_amplitude: f64,
    /// F: amplitude of the damping force of an equivalent linear damper, less its third order in the damping, N or N m.
    pub force_amplitude: f64,
    /// What the fit leaves of F, N or N m.
    pub residual: f64,
}

/// A release as it was used.
#[derive(Debug, Clone, PartialEq)]
pub struct RunSummary {
    /// Its name.
    pub id: String,
    /// Samples used.
    pub samples: usize,
    /// Half cycles used.
    pub half_cycles: usize,
    /// Time of the first sample used, s.
    pub from_s: f64,
    /// Position and speed there: fitted by the output error, read by the envelope.
    pub start: [f64; 2],
    /// Rest position q₀, m or rad.
    pub rest: f64,
    /// Mean period of its swings, s.
    pub period_s: f64,
    /// Added mass by this release alone: fitted by the output error where each has its own, else by its period, C (T/2π)² − M, kg or kg m²; undamped frequency, rad/s, per moving
    /// inertia.
    pub added: f64,
    /// Standard deviation of a sample's noise, from fourth differences, m or rad.
    pub noise: f64,
    /// Root mean square of what the fit leaves: of positions (output error) or of force amplitudes (envelope).
    pub residual_rms: f64,
    /// Its turning points: time, s, and distance from rest, m or rad.
    pub turns: Vec<[f64; 2]>,
    /// Positions of the samples used, as the fit has them; none by the envelope, which fits no motion.
    pub fitted: Vec<f64>,
}

/// Where the coefficients are supported by data.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Amplitudes of speed, m/s or rad/s.
    pub speed: [f64; 2],
    /// Amplitudes, m or rad; the Keulegan–Carpenter number 2πa/L is left to who knows the length.
    pub amplitude: [f64; 2],
    /// Undamped period 2π/ω_n, s.
    pub period_s: f64,
}

/// Type A: how far the coefficients scatter.
#[derive(Debug, Clone)]
pub struct Scatter {
    /// Covariance of the three.
    pub covariance: Mat<f64>,
    /// Degrees of freedom of each standard uncertainty.
    pub dof: [f64; 3],
    /// In words, e.g. `jackknife over 5 runs`.
    pub kind: String,
    /// Who shares the error: `run` or `sample`.
    pub shared: &'static str,
}

impl Scatter {
    /// The same where no interval is narrower than by another scatter.
    #[must_use]
    pub(super) fn at_least(mut self, other: &Self) -> Self {
        let half = |of: &Self, j: usize| coverage_factor(1.0 - OUTSIDE_95, of.dof[j]) * of.covariance[(j, j)].sqrt();
        let wider: Vec<usize> = (0..3).filter(|&j| half(other, j) > half(&self, j)).collect();
        // A correlation stays what it was.
        let by = |j: usize, own: &Self| {
            let ratio = (other.covariance[(j, j)] / own.covariance[(j, j)]).sqrt();
            if wider.contains(&j) { ratio } else { 1.0 }
        };
        let factors: [f64; 3] = std::array::from_fn(|j| by(j, &self));
        if wider.is_empty() || factors.iter().any(|factor| !factor.is_finite()) {
            return self;
        }
        self.covariance = Mat::from_fn(3, 3, |i, j| factors[i] * factors[j] * self.covariance[(i, j)]);
        for &j in &wider {
            self.dof[j] = other.dof[j];
        }
        self.kind += ", no less than that of their samples";
        self
    }
}

/// Added mass and damping of one axis.
#[derive(Debug, Clone)]
pub struct DecayFit {
    /// How.
    pub method: Method,
    /// Which axis.
    pub axis: Motion,
    /// Names of the three, e.g. `A33`, `D_z_I`, `D_z_II`; `omega_z`, `d_z_I`, `d_z_II` per moving inertia.
    pub names: [String; 3],
    /// Added mass, linear and quadratic damping; undamped frequency and both dampings per moving inertia. Units in [`Self::units`].
    pub values: [f64; 3],
    /// Type A; `None` where nothing shows it.
    pub type_a: Option<Scatter>,
    /// M as declared.
    pub inertia: Uncertain,
    /// What drives the body back, as declared.
    pub restoring: Restoring,
    /// Declared errors of M and of the restoring force, with their sensitivities.
    pub errors: Vec<DeclaredError>,
    /// Where the coefficients hold.
    pub range: Range,
    /// Half cycles as rows.
    pub rows: Vec<HalfCycle>,
    /// The releases, in the order given, those left out missing (each with a finding).
    pub runs: Vec<RunSummary>,
    /// What is doubtful.
    pub findings: Vec<Finding>,
}

/// Exact sensitivities of the coefficients to M and C: A = C/ω² − M, and the motion gives damping only as a ratio to C.
pub(super) fn declared(setup: &DecaySetup, [added, linear, quadratic]: [f64; 3]) -> Vec<DeclaredError> {
    let c = setup.restoring.stiffness();
    let by_stiffness = [(setup.inertia.value + added) / c, linear / c, quadratic / c];
    let of = |name: &str, known: Uncertain, by: [f64; 3]| DeclaredError {
        name: name.to_owned(),
        standard: known.standard,
        dof: known.dof,
        value: Some(known.value),
        sensitivity: by.to_vec(),
    };
    let restoring = setup.restoring.parts().into_iter().map(|(name, u, by)| of(name, u, by_stiffness.map(|d| d * by)));
    let inertia = (!setup.restoring.is_per_inertia()).then(|| of("dry inertia", setup.inertia, [-1.0, 0.0, 0.0]));
    inertia.into_iter().chain(restoring).collect()
}

impl DecayFit {
    /// Units of the coefficients.
    #[must_use]
    pub const fn units(&self) -> [&'static str; 3] {
        if self.restoring.is_per_inertia() { self.axis.rate_units() } else { self.axis.decay_units() }
    }

    /// The budget: scatter (where known), dry inertia, and what is declared of the restoring force.
    #[must_use]
    pub fn budget(&self) -> Vec<Part> {
        let scatter = self.type_a.iter().map(|a| {
            let dof = a.dof.to_vec();
            Part { shared: a.shared, dof, ..part(&a.kind, Kind::A, a.covariance.clone(), 0.0) }
        });
        scatter.chain(self.errors.iter().map(DeclaredError::part)).collect()
    }

    /// Uncertainty of coefficient `j` (0 added mass, 1 linear, 2 quadratic); `None` without a type A or such a coefficient.
    #[must_use]
    pub fn combined(&self, j: usize) -> Option<Combined> {
        (self.type_a.is_some() && j < 3).then(|| combine(&self.budget(), j, OUTSIDE_95))
    }

    /// Two methods read one motion: where they differ by more than the intervals of both, its law or its start is not the declared one.
    #[must_use]
    pub fn disagrees_with(&self, other: &Self) -> Option<Finding> {
        let apart = |j: usize| {
            let ([low, high], [other_low, other_high]) = (self.interval_95(j)?, other.interval_95(j)?);
            let text = || format!("{} {:.4} and {:.4}", self.names[j], self.values[j], other.values[j]);
            (high < other_low || other_high < low).then(text)
        };
        let apart: Vec<String> = (0..3).filter_map(apart).collect();
        (!apart.is_empty()).then(|| {
            let text = format!(
                "{} and {} differ by more than both intervals allow: {}; look where the body is free (free_from), and at friction, drift and \
                 a second mode",
                self.method.name(),
                other.method.name(),
                apart.join(", ")
            );
            warning("methods-disagree", text)
        })
    }

    /// 95 % interval of coefficient `j`.
    #[must_use]
    pub fn interval_95(&self, j: usize) -> Option<[f64; 2]> {
        self.combined(j).map(|c| c.interval(self.values[j]))
    }
}
