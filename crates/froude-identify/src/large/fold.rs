//! The fit of a long table: triangles of all rows, then what their residuals show.

use froude_fit as fit;
use froude_fit::faer::{Col, Mat};
use froude_fit::stream::{ClusterAccumulator, Factor, Shape, StreamError};

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::large::limits::MOST_CLUSTERS;
use crate::law::{ForceLaw, Kind};
use crate::regression::{Condensed, ModelFit};

/// Squares of larger regressors would overflow.
const LARGEST: f64 = 1e150;

/// Triangles of `[X | y]` so far, one per load. X has the columns of all laws, because each law is tested against the terms of the others.
pub(super) struct Fold<'a> {
    source: &'a str,
    laws: Vec<&'a ForceLaw>,
    /// Why a law is left out.
    failed: Vec<Option<IdentifyError>>,
    loads: Vec<Load>,
    is_clustered: bool,
    /// Rows so far.
    n: usize,
}

struct Load {
    name: String,
    /// Law, coefficient, and place of the load among those of the law.
    columns: Vec<(usize, usize, usize)>,
    rows: ClusterAccumulator,
}

impl<'a> Fold<'a> {
    /// Of no rows.
    pub(super) fn new(laws: Vec<&'a ForceLaw>, source: &'a str, is_clustered: bool) -> Self {
        let mut loads: Vec<(String, Vec<(usize, usize, usize)>)> = Vec::new();
        for (l, law) in laws.iter().enumerate() {
            for (r, name) in law.responses.iter().enumerate() {
                let own = columns(law, r).into_iter().map(|j| (l, j, r));
                match loads.iter_mut().find(|(other, _)| other == name) {
                    Some((_, columns)) => columns.extend(own),
                    None => loads.push((name.clone(), own.collect())),
                }
            }
        }
        let load = |(name, columns): (String, Vec<(usize, usize, usize)>)| {
            let shape = Shape { regressors: columns.len(), responses: 1 };
            Load { name, columns, rows: ClusterAccumulator::new(shape, MOST_CLUSTERS) }
        };
        let failed = laws.iter().map(|_| None).collect();
        Self { source, failed, loads: loads.into_iter().map(load).collect(), laws, is_clustered, n: 0 }
    }

    /// Takes in a chunk; `clusters` has the cluster of each row, and all are of one where there are none.
    pub(super) fn take(&mut self, data: &Dataset, clusters: &[u64]) {
        let n = data.rows;
        let designs: Vec<Mat<f64>> = (0..self.laws.len()).map(|l| self.design(l, data)).collect();
        for load in &mut self.loads {
            let of = |&(l, j, r): &(usize, usize, usize)| &designs[l].col_as_slice(j)[r * n..(r + 1) * n];
            let regressors: Vec<&[f64]> = load.columns.iter().map(of).collect();
            let Some(response) = data.values(&load.name) else { continue };
            let Err(error) = load.rows.push(clusters, &regressors, &[response]) else { continue };
            let why = match error {
                StreamError::NotFinite { row, value, .. } => format!("the load is {value} in observation {}", row + 1),
                other => other.to_string(),
            };
            for (failed, law) in self.failed.iter_mut().zip(&self.laws) {
                if failed.is_none() && law.responses.contains(&load.name) {
                    *failed = Some(no_fit(law, self.source, why.clone()));
                }
            }
        }
        self.n += n;
    }

    /// Regressors of a law; zero once the law has failed.
    fn design(&mut self, l: usize, data: &Dataset) -> Mat<f64> {
        let law = self.laws[l];
        let p = law.coefficients.len();
        let nothing = || Mat::zeros(law.responses.len() * data.rows, p);
        if self.failed[l].is_some() {
            return nothing();
        }
        let found = law.regressors(data, &[]).and_then(|design| {
            let bad = |j: &usize| design.col_as_slice(*j).iter().position(|x| x.is_nan() || x.abs() > LARGEST);
            let Some((j, i)) = (0..p).find_map(|j| Some((j, bad(&j)?))) else { return Ok(design) };
            let of = &law.coefficients[j].name;
            let row = self.n + i % data.rows + 1;
            let why = format!("the regressor of {of} is {} in observation {row}", design[(i, j)]);
            Err(no_fit(law, self.source, why))
        });
        found.unwrap_or_else(|error| {
            self.failed[l] = Some(error);
            nothing()
        })
    }

    /// All rows, condensed, for each law.
    pub(super) fn finish(self) -> Vec<Result<Condensed, IdentifyError>> {
        let Self { source, laws, mut failed, loads, is_clustered, .. } = self;
        let mut all: Vec<Triangles> = Vec::new();
        for Load { name, columns, rows } in loads {
            let width = columns.len() + 1;
            match rows.finish() {
                Ok(factors) => {
                    let observations = factors.values().map(Factor::rows).sum();
                    let row = |(cluster, factor): (&u64, &Factor), i| {
                        (*cluster, (0..width).map(|k| factor.entry(i, k)).collect())
                    };
                    let of = factors.iter().flat_map(|of| (0..width).map(move |i| row(of, i))).collect();
                    all.push(Triangles { name, columns, of, observations });
                }
                Err(error) => {
                    let gives = |(_, law): &(usize, &&ForceLaw)| law.responses.contains(&name);
                    for (l, law) in laws.iter().enumerate().filter(gives) {
                        failed[l].get_or_insert_with(|| no_fit(law, source, error.to_string()));
                    }
                }
            }
        }
        let is_left: Vec<bool> = failed.iter().map(Option::is_none).collect();
        let condensed = |(l, failed): (usize, Option<IdentifyError>)| match failed {
            Some(error) => Err(error),
            None => Ok(condensed(l, &laws, &is_left, &all, is_clustered)),
        };
        failed.into_iter().enumerate().map(condensed).collect()
    }
}

/// All rows of a load as those of triangles.
struct Triangles {
    name: String,
    columns: Vec<(usize, usize, usize)>,
    /// Cluster, columns and load of each row.
    of: Vec<(u64, Vec<f64>)>,
    observations: u64,
}

/// The rows of one law, with the columns of the others on them.
fn condensed(l: usize, laws: &[&ForceLaw], is_left: &[bool], all: &[Triangles], is_clustered: bool) -> Condensed {
    let law = laws[l];
    let of_law: Vec<&Triangles> =
        law.responses.iter().filter_map(|load| all.iter().find(|triangles| triangles.name == *load)).collect();
    let rows: Vec<(usize, &Triangles, &(u64, Vec<f64>))> =
        of_law.iter().enumerate().flat_map(|(r, t)| t.of.iter().map(move |row| (r, *t, row))).collect();
    let design = |of: usize| {
        let mut out = Mat::zeros(rows.len(), laws[of].coefficients.len());
        for (i, (_, triangles, (_, row))) in rows.iter().enumerate() {
            for (k, (other, j, _)) in triangles.columns.iter().enumerate() {
                if *other == of {
                    out[(i, *j)] = row[k];
                }
            }
        }
        out
    };
    let cluster = |(_, _, (of, _)): &(usize, &Triangles, &(u64, Vec<f64>))| usize::try_from(*of).unwrap_or(usize::MAX);
    let problem = fit::Problem {
        design: design(l),
        response: rows.iter().map(|(_, t, (_, row))| row[t.columns.len()]).collect(),
        weight: None,
        component: rows.iter().map(|(r, ..)| *r).collect(),
        components: law.responses.clone(),
        cluster: is_clustered.then(|| rows.iter().map(cluster).collect()),
        names: law.coefficients.iter().map(|c| c.name.clone()).collect(),
    };
    let others = (0..laws.len()).filter(|other| *other != l && is_left[*other]);
    Condensed {
        problem,
        observations: of_law.iter().map(|t| usize::try_from(t.observations).unwrap_or(usize::MAX)).collect(),
        beside: others.map(|other| (laws[other].name.clone(), design(other))).collect(),
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
        Kind::PowerLaw { .. } | Kind::Thruster { .. } => Vec::new(),
    }
}

fn no_fit(law: &ForceLaw, source: &str, why: String) -> IdentifyError {
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
        let s = model.fit.sensitivity();
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
