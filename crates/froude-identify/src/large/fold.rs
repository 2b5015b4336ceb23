//! The fit of a long table: triangles of all rows, then what their residuals show.

use froude_fit as fit;
use froude_fit::faer::{Col, Mat};
use froude_fit::stream::{Accumulator, ClusterAccumulator, Factor, Shape, StreamError};

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::large::limits::MOST_CLUSTERS;
use crate::law::{ForceLaw, Kind};
use crate::regression::{Condensed, ModelFit};

/// The columns of `[X | y]` that one load of a law has, and their triangles so far.
pub(super) struct Fold<'a> {
    law: &'a ForceLaw,
    source: &'a str,
    loads: Vec<Load>,
}

struct Load {
    /// Coefficients that it has.
    columns: Vec<usize>,
    rows: Rows,
}

enum Rows {
    All(Accumulator),
    Clustered(ClusterAccumulator),
}

impl<'a> Fold<'a> {
    /// Of no rows.
    pub(super) fn new(law: &'a ForceLaw, source: &'a str, is_clustered: bool) -> Self {
        let load = |r: usize| {
            let columns = columns(law, r);
            let shape = Shape { regressors: columns.len(), responses: 1 };
            let rows = if is_clustered {
                Rows::Clustered(ClusterAccumulator::new(shape, MOST_CLUSTERS))
            } else {
                Rows::All(Accumulator::new(shape))
            };
            Load { columns, rows }
        };
        Self { law, source, loads: (0..law.responses.len()).map(load).collect() }
    }

    /// Takes in a chunk; `clusters` has the cluster of each row.
    pub(super) fn take(&mut self, data: &Dataset, clusters: &[u64]) -> Result<(), IdentifyError> {
        let design = self.law.regressors(data, &[])?;
        let measured = self.law.measured(data)?;
        let n = data.rows;
        for (r, load) in self.loads.iter_mut().enumerate() {
            let rows = r * n..(r + 1) * n;
            let regressors: Vec<&[f64]> = load.columns.iter().map(|&j| &design.col_as_slice(j)[rows.clone()]).collect();
            let response = &measured[rows.clone()];
            let taken = match &mut load.rows {
                Rows::All(all) => all.push(&regressors, &[response]),
                Rows::Clustered(all) => all.push(clusters, &regressors, &[response]),
            };
            taken.map_err(|error| refused(self.law, self.source, &load.columns, error))?;
        }
        Ok(())
    }

    /// All rows, condensed.
    pub(super) fn finish(self) -> Result<Condensed, IdentifyError> {
        let Self { law, source, loads } = self;
        let p = law.coefficients.len();
        let (mut rows, mut response, mut component, mut cluster) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let mut observations = Vec::new();
        let mut is_clustered = false;
        for (r, load) in loads.into_iter().enumerate() {
            let Load { columns, rows: all } = load;
            let mut n = 0;
            let mut put = |factor: &Factor, of: u64| {
                n += factor.rows();
                let width = columns.len() + 1;
                for i in 0..width {
                    let mut row = vec![0.0; p];
                    for (k, &j) in columns.iter().enumerate() {
                        row[j] = factor.entry(i, k);
                    }
                    rows.push(row);
                    response.push(factor.entry(i, width - 1));
                    component.push(r);
                    cluster.push(usize::try_from(of).unwrap_or(usize::MAX));
                }
            };
            match all {
                Rows::All(all) => put(&all.finish(), 0),
                Rows::Clustered(all) => {
                    is_clustered = true;
                    let all = all.finish().map_err(|error| refused(law, source, &columns, error))?;
                    all.iter().for_each(|(of, factor)| put(factor, of));
                }
            }
            observations.push(usize::try_from(n).unwrap_or(usize::MAX));
        }
        let problem = fit::Problem {
            design: Mat::from_fn(rows.len(), p, |i, j| rows[i][j]),
            response,
            weight: None,
            component,
            components: law.responses.clone(),
            cluster: is_clustered.then_some(cluster),
            names: law.coefficients.iter().map(|c| c.name.clone()).collect(),
        };
        Ok(Condensed { problem, observations })
    }
}

/// Coefficients of a load.
fn columns(law: &ForceLaw, r: usize) -> Vec<usize> {
    match &law.kind {
        Kind::Drag { model, .. } => {
            let is_of =
                |axis: froude_hydro::Axis| matches!((axis, r), (froude_hydro::Axis::X, 0) | (froude_hydro::Axis::Y, 1));
            let all = model.coefficients().iter().enumerate();
            all.filter(|(_, info)| is_of(info.axis)).map(|(j, _)| j).collect()
        }
        Kind::Formulas(formulas) => {
            let mut out: Vec<usize> =
                formulas[r].coefficients.iter().filter_map(|(name, _)| law.position(name)).collect();
            out.sort_unstable();
            out
        }
        Kind::PowerLaw { .. } => Vec::new(),
    }
}

/// What keeps rows from being folded in, in the words of the fit.
fn refused(law: &ForceLaw, source: &str, columns: &[usize], error: StreamError) -> IdentifyError {
    let why = match error {
        StreamError::NotFinite { row, column, value } => {
            let of = columns
                .get(column)
                .map_or_else(|| "the load".to_owned(), |&j| format!("the regressor of {}", law.coefficients[j].name));
            format!("{of} is {value} in observation {}", row + 1)
        }
        other => other.to_string(),
    };
    IdentifyError::NoFit { source_name: source.to_owned(), model: law.name.clone(), why }
}

/// What the residuals of all rows state about a model.
pub(super) struct Residuals {
    /// What gives the leverage of a row, where it follows from the row alone.
    hat: Option<Hat>,
    loads: Vec<OfLoad>,
}

#[derive(Default)]
struct OfLoad {
    last: Option<f64>,
    steps: f64,
    squares: f64,
    leverage: f64,
}

impl Residuals {
    pub(super) fn new(model: &ModelFit) -> Self {
        let loads = model.law.responses.iter().map(|_| OfLoad::default()).collect();
        Self { hat: Hat::of(model), loads }
    }

    /// Takes in a chunk.
    pub(super) fn take(&mut self, model: &ModelFit, data: &Dataset) -> Result<(), IdentifyError> {
        let rows = of_rows(model, data, self.hat.as_ref())?;
        let n = data.rows;
        for (r, load) in self.loads.iter_mut().enumerate() {
            for i in r * n..(r + 1) * n {
                let residual = rows.residuals[i];
                if let Some(last) = load.last {
                    load.steps += (residual - last).powi(2);
                }
                load.squares += residual * residual;
                load.last = Some(residual);
                load.leverage = load.leverage.max(rows.leverage[i]);
            }
        }
        Ok(())
    }

    /// Puts them into the model, with the fit of a sample's rows; the largest leverage of all rows.
    pub(super) fn into_model(self, model: &mut ModelFit, sample: &Dataset) -> Result<Option<f64>, IdentifyError> {
        let rows = of_rows(model, sample, self.hat.as_ref())?;
        let has_leverage = self.hat.is_some();
        model.fit.fitted = rows.fitted;
        model.fit.residuals = rows.residuals;
        model.fit.leverage = rows.leverage;
        for (component, load) in model.fit.components.iter_mut().zip(&self.loads) {
            // Residuals of rounding alone have no order.
            component.durbin_watson = component.aicc.is_some().then(|| load.steps / load.squares);
        }
        Ok(has_leverage.then(|| self.loads.iter().fold(0.0, |m, load| f64::max(m, load.leverage))))
    }
}

/// The leverage of a row `x` of load `c`: `xᵀ M x/σ_c²`, `M = (Σ XᵀX/σ²)⁻¹ = S diag(σ²) Sᵀ` with `S = ∂β/∂y`.
struct Hat {
    inverse: Mat<f64>,
    /// σ² of each load where loads share a coefficient; else 1, since it cancels.
    variance: Vec<f64>,
}

impl Hat {
    /// Of a fit without priors whose coefficients are all determined.
    fn of(model: &ModelFit) -> Option<Self> {
        let of: Vec<Vec<usize>> = (0..model.law.responses.len()).map(|r| columns(&model.law, r)).collect();
        let is_shared = (0..model.specs.len()).any(|j| of.iter().filter(|columns| columns.contains(&j)).count() > 1);
        let is_undetermined = model.fit.coefficients.iter().any(|c| c.status == fit::Status::Undetermined);
        if is_undetermined || !model.options.priors.is_empty() {
            return None;
        }
        let variance =
            |c: &fit::ComponentSummary| if is_shared { Some(c.sigma?.powi(2)).filter(|v| *v > 0.0) } else { Some(1.0) };
        let variance: Vec<f64> = model.fit.components.iter().map(variance).collect::<Option<_>>()?;
        let s = &model.fit.sensitivity;
        let scaled = Mat::from_fn(s.nrows(), s.ncols(), |j, i| s[(j, i)] * variance[model.problem.component[i]]);
        Some(Self { inverse: &scaled * s.transpose(), variance })
    }
}

/// Fit of some rows.
struct OfRows {
    fitted: Vec<f64>,
    residuals: Vec<f64>,
    leverage: Vec<f64>,
}

fn of_rows(model: &ModelFit, data: &Dataset, hat: Option<&Hat>) -> Result<OfRows, IdentifyError> {
    let design = model.law.regressors(data, &[])?;
    let fitted = &design * Col::from_fn(model.coefficients.len(), |j| model.coefficients[j]);
    let fitted: Vec<f64> = fitted.iter().copied().collect();
    let measured = model.law.measured(data)?;
    let residuals = measured.iter().zip(&fitted).map(|(y, f)| y - f).collect();
    let n = data.rows;
    let mut leverage = vec![if hat.is_some() { 0.0 } else { f64::NAN }; fitted.len()];
    if let Some(Hat { inverse, variance }) = hat {
        for r in 0..model.law.responses.len() {
            let columns = columns(&model.law, r);
            for (a, &j) in columns.iter().enumerate() {
                for &k in &columns[a..] {
                    let factor = if j == k { 1.0 } else { 2.0 } * inverse[(j, k)] / variance[r];
                    let (x, y) = (design.col_as_slice(j), design.col_as_slice(k));
                    for i in r * n..(r + 1) * n {
                        leverage[i] += factor * x[i] * y[i];
                    }
                }
            }
        }
    }
    Ok(OfRows { fitted, residuals, leverage })
}
