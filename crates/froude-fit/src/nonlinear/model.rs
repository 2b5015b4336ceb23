//! What is minimised: a model, its parameters, and when the search ends.

use crate::nonlinear::error::NonlinearError;

/// One parameter of a model.
#[derive(Debug, Clone, PartialEq)]
pub struct Parameter {
    /// Its name, for errors.
    pub name: String,
    /// Where it starts.
    pub start: f64,
    /// A natural step of it, positive: a change that a plot of the model would show.
    pub scale: f64,
    /// Lower bound; −∞ where free. Equal bounds fix the parameter.
    pub lower: f64,
    /// Upper bound; ∞ where free.
    pub upper: f64,
    /// The run that it moves alone; `None` for a parameter of all runs.
    pub run: Option<usize>,
}

impl Parameter {
    /// A free parameter of all runs.
    #[must_use]
    pub fn new(name: impl Into<String>, start: f64, scale: f64) -> Self {
        Self { name: name.into(), start, scale, lower: f64::NEG_INFINITY, upper: f64::INFINITY, run: None }
    }

    /// The same between two bounds, both allowed. Differences stay inside, too.
    #[must_use]
    pub fn within(self, lower: f64, upper: f64) -> Self {
        Self { lower, upper, ..self }
    }

    /// The same as a nuisance of one run: it moves the residuals of that run only.
    #[must_use]
    pub fn of_run(self, run: usize) -> Self {
        Self { run: Some(run), ..self }
    }
}

/// A model with its data. Weighted residuals of the parameters, as a function, are one of a single run.
pub trait Model {
    /// How many runs there are.
    fn runs(&self) -> usize;

    /// Weighted residuals of a run, measured less modelled, at all parameters in order; as many each time.
    ///
    /// `None` where the model is impossible: a step there counts as one that does not help.
    fn residuals(&self, run: usize, theta: &[f64]) -> Option<Vec<f64>>;

    /// `∂residual/∂θ` of a run: a column per parameter, in order; those of other runs' own parameters are not read, and may be empty.
    ///
    /// `None`: central differences are taken.
    fn derivatives(&self, _run: usize, _theta: &[f64]) -> Option<Vec<Vec<f64>>> {
        None
    }
}

/// How the minimum is looked for.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Step of the differences, as part of a parameter's scale. 1e-4 suits smooth models; a simulation with kinks, as at reversals, wants 1e-3.
    pub difference: f64,
    /// Converged when a full step would move the model by less than this part of its standard deviation (the relative offset): parameters are
    /// then off by about this part of their standard uncertainties. Or when a step lowered the sum of squares by no more than such a step
    /// would: what kinks make of a simulation lets no full step become small.
    pub offset: f64,
    /// Converged, too, when no parameter would move by more than this part of its scale: data without noise have no offset.
    pub step: f64,
    /// Most trial steps.
    pub iterations: usize,
}

impl Default for Settings {
    fn default() -> Self {
        Self { difference: 1e-4, offset: 1e-6, step: 1e-10, iterations: 500 }
    }
}

impl Settings {
    pub(crate) fn check(&self) -> Result<(), NonlinearError> {
        let positive = [("difference", self.difference), ("offset", self.offset), ("step", self.step)];
        match positive.into_iter().find(|(_, value)| !(value.is_finite() && *value > 0.0)) {
            Some((setting, value)) => {
                Err(NonlinearError(format!("{setting} is {value}; it must be positive and finite")))
            }
            None => Ok(()),
        }
    }
}
