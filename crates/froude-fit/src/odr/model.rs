//! What is given: regressors as a function of inputs, and the observations.

use faer::Mat;

use crate::error::FitError;
use crate::problem::{size, unique};

/// Regressors as a function of uncertain inputs.
pub trait InputModel {
    /// Number of coefficients `p`.
    fn n_coefficients(&self) -> usize;

    /// Number of response components `c` of an observation.
    fn n_components(&self) -> usize;

    /// Number of uncertain inputs `m` of an observation.
    fn n_inputs(&self) -> usize;

    /// Regressors of an observation at these inputs: `c × p`, row by row.
    fn regressors(&self, observation: usize, inputs: &[f64], out: &mut [f64]);

    /// Derivatives of the regressors by the inputs: `m` blocks of `c × p`.
    ///
    /// By default from central differences, with steps of 6·10⁻⁶ of the
    /// input or of [`Self::input_scale`], whichever is larger: relative error near 10⁻¹⁰.
    fn derivatives(&self, observation: usize, inputs: &[f64], out: &mut [f64]) {
        let size = self.n_components() * self.n_coefficients();
        let mut moved = inputs.to_vec();
        let mut upper = vec![0.0; size];
        let mut lower = vec![0.0; size];
        for m in 0..self.n_inputs() {
            let step = 6e-6 * inputs[m].abs().max(self.input_scale(m));
            moved[m] = inputs[m] + step;
            let high = moved[m];
            self.regressors(observation, &moved, &mut upper);
            moved[m] = inputs[m] - step;
            let low = moved[m];
            self.regressors(observation, &moved, &mut lower);
            moved[m] = inputs[m];
            for k in 0..size {
                out[m * size + k] = (upper[k] - lower[k]) / (high - low);
            }
        }
    }

    /// A typical size of input `m`, for the default derivatives; 1 by default.
    fn input_scale(&self, _input: usize) -> f64 {
        1.0
    }
}

/// σ of a response component.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Sigma {
    /// Known beforehand, positive.
    Known(f64),
    /// To be estimated, one value for all observations.
    Estimated,
}

/// Observations with uncertain inputs.
#[derive(Debug, Clone)]
pub struct OdrProblem {
    /// Measured inputs, `n × m`.
    pub inputs: Mat<f64>,
    /// Their standard deviations, `n × m`; zero where an input is exact.
    pub input_standard: Mat<f64>,
    /// Measured responses, `n × c`.
    pub response: Mat<f64>,
    /// σ of each component.
    pub sigma: Vec<Sigma>,
    /// Names of the components.
    pub components: Vec<String>,
    /// Names of the coefficients.
    pub names: Vec<String>,
}

impl OdrProblem {
    pub(super) fn check<M: InputModel>(&self, model: &M) -> Result<(), FitError> {
        let n = self.response.nrows();
        let (p, c, m) = (model.n_coefficients(), model.n_components(), model.n_inputs());
        if n == 0 {
            return Err(FitError::NoRows);
        }
        if p == 0 {
            return Err(FitError::no_coefficients());
        }
        let of_model = "set by the model";
        let of_rows = "one per observation";
        size("names", self.names.len(), p, of_model)?;
        size("components", self.components.len(), c, of_model)?;
        size("sigma", self.sigma.len(), c, of_model)?;
        size("response columns", self.response.ncols(), c, of_model)?;
        size("input columns", self.inputs.ncols(), m, of_model)?;
        size("input_standard columns", self.input_standard.ncols(), m, of_model)?;
        size("inputs", self.inputs.nrows(), n, of_rows)?;
        size("input_standard", self.input_standard.nrows(), n, of_rows)?;
        unique(&self.names)?;
        for sigma in &self.sigma {
            if let Sigma::Known(value) = *sigma
                && !(value > 0.0 && value.is_finite())
            {
                return Err(FitError::option("a known σ", value, "positive and finite"));
            }
        }
        let mut out = vec![0.0; c * p];
        for i in 0..n {
            for k in 0..c {
                let value = self.response[(i, k)];
                if !value.is_finite() {
                    return Err(FitError::response_not_finite(i, value));
                }
            }
            for k in 0..m {
                let value = self.inputs[(i, k)];
                if !value.is_finite() {
                    return Err(FitError::option("an input", value, "finite"));
                }
                let value = self.input_standard[(i, k)];
                if !(value >= 0.0 && value.is_finite()) {
                    let must = "zero or positive, and finite";
                    return Err(FitError::option("the standard deviation of an input", value, must));
                }
            }
            model.regressors(i, &crate::dense::row(self.inputs.as_ref(), i), &mut out);
            if let Some(bad) = out.iter().position(|x| !x.is_finite()) {
                return Err(FitError::design_not_finite(i, &self.names[bad % p], out[bad]));
            }
        }
        Ok(())
    }
}
