//! Errors in variables: what a law reads is uncertain from row to row.
//!
//! One error of the speed enters v and v|v| of both loads together, one of an acceleration only the terms that have it. The rows'
//! standard deviations come from the budget (entries of the motion, whose error no two rows share); the fit is an orthogonal distance regression.

use faer::Mat;
use froude_fit::odr::{InputModel, OdrFit, OdrProblem, Sigma, odr};
use froude_fit::{self as fit, FitError};
use froude_hydro::{Axis, DragModel, Setting};
use froude_records::campaign::{BudgetEntry, Shared};

use crate::dataset::Dataset;
use crate::law::{ForceLaw, Kind, REFERENCE_SPEED_M_S};

/// The velocity as a table of tows states it, which the drag models are fitted in.
const POLAR: [&str; 2] = ["speed", "angle"];

/// Step of the differences over the size of an input, which is 1 m/s and 1 rad of speed and angle: rounding and truncation both near 10⁻¹⁰.
const DIFFERENCE_STEP: f64 = 6e-6;

/// Whether an entry of the budget is an error that the regression in variables of this law takes care of.
#[must_use]
pub fn is_input_error(entry: &BudgetEntry, law: &ForceLaw, data: &Dataset) -> bool {
    let quantity = data.meant(&entry.quantity);
    let is_read = || !matches!(law.kind, Kind::Drag { .. }) && law.channels().contains(&quantity);
    entry.shared == Shared::Sample && (POLAR.contains(&quantity) || is_read())
}

/// What a law reads with errors of its own in each row.
#[derive(Debug, Clone, PartialEq)]
pub struct Inputs {
    /// Names of the channels.
    pub names: Vec<String>,
    /// Their standard deviations, a row per observation and a column per name, in SI.
    pub standard: Mat<f64>,
}

impl Inputs {
    /// Speed and angle, `rows × 2`: m/s and rad.
    #[must_use]
    pub fn polar(standard: Mat<f64>) -> Self {
        Self { names: POLAR.map(str::to_owned).to_vec(), standard }
    }

    /// From the budget; `None` without any.
    ///
    /// A relative entry is multiplied by |value| of the row; several entries of one quantity add as variances.
    ///
    /// # Source
    ///
    /// JCGM 100:2008 (GUM), 5.1.2.
    #[must_use]
    pub fn of_budget(law: &ForceLaw, data: &Dataset, budget: &[BudgetEntry]) -> Option<Self> {
        let entries: Vec<&BudgetEntry> = budget.iter().filter(|entry| is_input_error(entry, law, data)).collect();
        // Of a table of tows both, though one may be exact.
        let is_polar = |entry: &&&BudgetEntry| POLAR.contains(&data.meant(&entry.quantity));
        let mut names: Vec<String> =
            entries.iter().find(is_polar).map_or_else(Vec::new, |_| POLAR.map(str::to_owned).to_vec());
        for entry in &entries {
            let name = data.meant(&entry.quantity);
            if !names.iter().any(|other| other == name) {
                names.push(name.to_owned());
            }
        }
        let mut standard = Mat::zeros(data.rows, names.len());
        for entry in &entries {
            let name = data.meant(&entry.quantity);
            let Some(k) = names.iter().position(|other| other == name) else { continue };
            for i in 0..data.rows {
                let value = data.values(name).map_or(0.0, |v| v[i]);
                let own = if entry.relative { entry.standard * value.abs() } else { entry.standard };
                standard[(i, k)] = f64::hypot(standard[(i, k)], own);
            }
        }
        (!entries.is_empty()).then_some(Self { names, standard })
    }
}

/// A force law as a function of the uncertain inputs of one observation.
struct LawOfInputs<'a> {
    law: &'a ForceLaw,
    data: &'a Dataset,
    names: &'a [String],
    /// Size of each input, for the steps of differences.
    sizes: Vec<f64>,
    /// Of a drag model: what does not depend on the motion.
    drag: Option<Drag>,
}

/// A drag model at every observation, its geometric factors computed once.
struct Drag {
    model: DragModel,
    settings: Vec<Setting>,
    factors: Vec<Vec<f64>>,
}

impl Drag {
    fn new(model: DragModel, settings: Vec<Setting>) -> Self {
        let of = |s: &Setting| model.coefficients().iter().map(|c| c.factor.value(s)).collect();
        Self { factors: settings.iter().map(of).collect(), model, settings }
    }

    fn regressors(&self, i: usize, inputs: &[f64], out: &mut [f64]) {
        let coefficients = self.model.coefficients();
        let (sin, cos) = inputs[1].sin_cos();
        let velocity = [inputs[0] * cos, -inputs[0] * sin];
        out.fill(0.0);
        for (j, (info, factor)) in coefficients.iter().zip(&self.factors[i]).enumerate() {
            let c = match info.axis {
                Axis::X => 0,
                Axis::Y => 1,
            };
            out[c * coefficients.len() + j] = factor * info.motion.value(info.axis, &self.settings[i], velocity);
        }
    }
}

impl LawOfInputs<'_> {
    /// Whether the first inputs are speed and angle, at whose broadside laws may jump.
    fn is_polar(&self) -> bool {
        self.names.get(..2).is_some_and(|names| names == POLAR)
    }
}

impl InputModel for LawOfInputs<'_> {
    fn n_coefficients(&self) -> usize {
        self.law.coefficients.len()
    }

    fn n_components(&self) -> usize {
        self.law.responses.len()
    }

    fn n_inputs(&self) -> usize {
        self.names.len()
    }

    fn regressors(&self, observation: usize, inputs: &[f64], out: &mut [f64]) {
        if let Some(drag) = &self.drag {
            drag.regressors(observation, inputs, out);
            return;
        }
        let mut one = self.data.subset(&[observation]);
        for (name, value) in self.names.iter().zip(inputs) {
            let now = one.values(name).map_or(0.0, |v| v[0]);
            one = one.shifted(name, &[value - now]);
        }
        match self.law.regressors(&one, &[]) {
            Ok(x) => {
                for c in 0..x.nrows() {
                    for j in 0..x.ncols() {
                        out[c * x.ncols() + j] = x[(c, j)];
                    }
                }
            }
            // The channels were there when the law was made; NaN is refused by the regression.
            Err(_) => out.fill(f64::NAN),
        }
    }

    /// Central differences; at broadside one-sided ones of the same order, on the row's own side, since the
    /// cross terms as printed jump where v_x turns its sign.
    fn derivatives(&self, observation: usize, inputs: &[f64], out: &mut [f64]) {
        let size = self.n_components() * self.n_coefficients();
        let goes_back = |inputs: &[f64]| self.is_polar() && inputs[0] * inputs[1].cos() < 0.0;
        let mut x = vec![0.0; size];
        for m in 0..self.n_inputs() {
            let step = DIFFERENCE_STEP * inputs[m].abs().max(self.sizes[m]);
            let at = |k: f64| {
                let mut moved = inputs.to_vec();
                moved[m] += k * step;
                moved
            };
            let stays = |k: f64| goes_back(&at(k)) == goes_back(inputs);
            // Weights of f(z + k·step), divided by step: exact for quadratics.
            let stencil: [(f64, f64); 3] = match (stays(1.0), stays(-1.0)) {
                (true, false) => [(0.0, -1.5), (1.0, 2.0), (2.0, -0.5)],
                (false, true) => [(0.0, 1.5), (-1.0, -2.0), (-2.0, 0.5)],
                _ => [(1.0, 0.5), (-1.0, -0.5), (0.0, 0.0)],
            };
            let of_input = &mut out[m * size..(m + 1) * size];
            of_input.fill(0.0);
            for (k, weight) in stencil.into_iter().filter(|(_, weight)| *weight != 0.0) {
                self.regressors(observation, &at(k), &mut x);
                for (slope, x) in of_input.iter_mut().zip(&x) {
                    *slope += weight * x / step;
                }
            }
        }
    }
}

/// Fits a linear law whose inputs are uncertain.
///
/// Minimises Σ (y_i − f(q_i + e_i; β))²/σ² + Σ e_iᵀC_i⁻¹e_i with q the inputs; loads are in N or N m.
///
/// # Errors
///
/// What the regression refuses.
///
/// # Source
///
/// Boggs & Rogers (1990), Orthogonal distance regression, Contemporary Mathematics 112.
pub fn regress(law: &ForceLaw, data: &Dataset, inputs: Inputs, sigma: Sigma) -> Result<OdrFit, FitError> {
    let Inputs { names, standard } = inputs;
    let n = data.rows;
    let value = |name: &str, i: usize| data.values(name).map_or(0.0, |v| v[i]);
    let responses = law.measured(data).unwrap_or_default();
    let drag = match &law.kind {
        Kind::Drag { model, body, cross_term } => {
            let settings = (0..n).map(|i| Setting {
                body: *body,
                n_links: value("n_links", i),
                density_kg_m3: value("density", i),
                v_ref_m_s: REFERENCE_SPEED_M_S,
                cross_term: *cross_term,
            });
            Some(Drag::new(*model, settings.collect()))
        }
        _ => None,
    };
    let c = law.responses.len();
    if responses.len() != n * c {
        return Err(FitError::NoRows);
    }
    let problem = OdrProblem {
        inputs: Mat::from_fn(n, names.len(), |i, k| value(&names[k], i)),
        input_standard: standard,
        response: Mat::from_fn(n, c, |i, r| responses[r * n + i]),
        sigma: vec![sigma; c],
        components: law.responses.clone(),
        names: law.coefficients.iter().map(|c| c.name.clone()).collect(),
    };
    let largest = |name: &String| data.values(name).map_or(0.0, |v| v.iter().fold(0.0, |m: f64, x| m.max(x.abs())));
    let size = |name: &String| match largest(name) {
        _ if POLAR.contains(&name.as_str()) => 1.0,
        0.0 => 1.0,
        largest => largest,
    };
    let sizes = names.iter().map(size).collect();
    odr(&LawOfInputs { law, data, names: &names, sizes, drag }, &problem, 0.95)
}

/// Puts the result in the place of the ordinary fit's coefficients; its design, leverages and AICc stay.
///
/// A model is chosen by ordinary least squares (AICc and F tests); errors in variables are then fitted to all.
pub fn replace(fitted: &mut fit::Fit, design: &Mat<f64>, response: &[f64], result: OdrFit) {
    let beta: Vec<f64> = result.coefficients.iter().map(|c| c.value.unwrap_or(0.0)).collect();
    for i in 0..response.len() {
        fitted.fitted[i] = (0..beta.len()).map(|j| design[(i, j)] * beta[j]).sum();
        fitted.residuals[i] = response[i] - fitted.fitted[i];
    }
    let n = response.len() / fitted.components.len().max(1);
    for (c, (summary, sigma)) in fitted.components.iter_mut().zip(&result.sigma).enumerate() {
        let rows = c * n..(c + 1) * n;
        let squares = |v: &[f64]| v[rows.clone()].iter().map(|x| x * x).sum::<f64>();
        summary.sigma = Some(sigma.sigma);
        if sigma.dof.is_finite() {
            summary.dof = sigma.dof;
        }
        summary.rss = squares(&fitted.residuals);
        summary.relative_residual = (summary.rss / squares(response)).sqrt();
        summary.durbin_watson = fit::diagnostics::durbin_watson(&fitted.residuals[rows]);
    }
    fitted.sensitivity_by_row = result.sensitivity.transpose().to_owned();
    fitted.covariance = result.covariance;
    fitted.coefficients = result.coefficients;
    fitted.report = result.report;
}
