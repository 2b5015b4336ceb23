//! Still runs as data: how the load cell was zeroed, the runs, and what a fit of one configuration found.

use super::spec::Point;

/// How the load cell was zeroed for the still runs of a configuration: once, before the first of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zeroing {
    /// Standard deviation of the change of the zero from one still run to the next, in the unit of the load.
    pub drift: f64,
}

/// A still run.
#[derive(Debug, Clone, PartialEq)]
pub struct StillRun {
    /// What it is.
    pub point: Point,
    /// Mean of the motion, rad or m.
    pub position: f64,
    /// Mean of the first load.
    pub load: f64,
    /// Duration, s.
    pub duration_s: f64,
}

/// Noise of the load at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Noise {
    /// Variance of a mean times its duration, in load² s.
    pub variance_times_s: f64,
    /// Variance of every mean from the resolution of the cell, where its noise does not average it out.
    pub of_resolution: f64,
    /// Time per independent reading, s: twice the integrated correlation time.
    pub correlated_s: f64,
    /// Degrees of freedom.
    pub dof: f64,
}

/// A constant as the still runs of one configuration determine it.
#[derive(Debug, Clone, PartialEq)]
pub struct StillFit {
    /// Index of the constant.
    pub constant: usize,
    /// Its value.
    pub value: f64,
    /// Its standard uncertainty from noise.
    pub noise: f64,
    /// Its standard uncertainty from the drift of the zero.
    pub drift: f64,
    /// Degrees of freedom of both.
    pub dof: f64,
    /// Indices of the gain constants, each with the derivative of the value.
    pub gain_sensitivities: Vec<(usize, f64)>,
    /// Zero of the load cell at the first run.
    pub zero: f64,
    /// Each run.
    pub runs: Vec<Fitted>,
    /// p-value of χ² of the residuals; `None` with two runs.
    pub p: Option<f64>,
}

/// A still run in a fit.
#[derive(Debug, Clone, PartialEq)]
pub struct Fitted {
    /// The run.
    pub run: StillRun,
    /// Factor of the constant in the equation at rest.
    pub factor: f64,
    /// Standard uncertainty of the mean load from noise.
    pub standard: f64,
    /// Residual of the mean load.
    pub residual: f64,
}

/// Least standard uncertainty, as a part of the value: that of runs without noise.
const MIN_RELATIVE: f64 = 1e-9;

impl StillFit {
    /// What a joint fit calls the prior of a constant from its still runs.
    #[must_use]
    pub fn name_of_prior(constant: &str) -> String {
        format!("{constant} from still runs")
    }

    /// From noise and drift.
    #[must_use]
    pub fn standard(&self) -> f64 {
        self.noise.hypot(self.drift).max(MIN_RELATIVE * self.value.abs()).max(f64::MIN_POSITIVE.sqrt())
    }
}
