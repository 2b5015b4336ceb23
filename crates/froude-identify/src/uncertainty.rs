//! Type B uncertainty (GUM, JCGM 100:2008): what the declared budget does to the coefficients.
//!
//! A budget entry is an error e of a measured quantity, of zero mean and given
//! standard deviation, that all rows of a sample, run, setup or campaign share.
//! To first order it moves the stacked responses by J·e and the coefficients by
//! S·J·e, with S = ∂β/∂y of the fit. A shared error does not average down.
//!
//! An entry whose groups hold one row each is already in the scatter of the
//! residuals (type A): it is listed, and not added a second time. For
//! `kind = "cfd"` there is no scatter, so it is added.

use faer::{Mat, MatRef};
use froude_fit as fit;
use froude_fit::budget::{Kind, Origin, Part, Shape, one_sided};
use froude_records::campaign::{BudgetEntry, Shared};
use froude_records::estimate::ErrorKind;
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::dataset::{Dataset, LOADS, labels};
use crate::error::IdentifyError;
use crate::law::ForceLaw;

/// The scatter itself as an input of the budget: no error that rows share.
pub const SCATTER: &str = "scatter of the observations";

/// An error of the loads that a source's method knows: `directions · e`, with `e` of the given covariance.
#[derive(Debug, Clone)]
pub struct SharedError {
    /// What it is, for the budget.
    pub name: String,
    /// Its name among all sources and campaigns: what has one key is one error. `None` where no other estimate can have it.
    pub key: Option<String>,
    /// How it was evaluated, by anything but scatter.
    pub kind: Kind,
    /// The quantity that errs.
    pub quantity: String,
    /// Who shares it: `run`, `setup`, `campaign`.
    pub shared: &'static str,
    /// What it moves, a load or another channel of the law, as the speed is one, and a column per component of `e`, a row per observation.
    pub directions: Vec<(String, Vec<Vec<f64>>)>,
    /// Covariance of `e`.
    pub covariance: Vec<Vec<f64>>,
    /// Degrees of freedom of that, infinite for a certificate.
    pub dof: f64,
    /// Limits of an `e` of one component that is uniform between them; else it is normal.
    pub limits: Option<[f64; 2]>,
    /// True where every observation has an `e` of its own, which the scatter shows already.
    pub is_of_each_row: bool,
}

impl SharedError {
    /// A normal error that goes into a load by a number in each row.
    ///
    /// Row i moves by `direction[i]`·e, e normal with standard uncertainty `standard`; their product is in N or N m. `dof` are the degrees of freedom of `standard`,
    /// infinite where it is known exactly.
    #[must_use]
    pub fn of_load(name: &str, load: &str, direction: &[f64], standard: f64, dof: f64) -> Self {
        Self {
            name: name.to_owned(),
            key: None,
            kind: Kind::B,
            quantity: load.to_owned(),
            shared: "campaign",
            directions: vec![(load.to_owned(), direction.iter().map(|d| vec![*d]).collect())],
            covariance: vec![vec![standard * standard]],
            dof,
            limits: None,
            is_of_each_row: false,
        }
    }

    /// An error between two limits that goes into a load by a number in each row.
    ///
    /// Row i moves by `direction[i]`·e with e uniform between `low` and `high`. The load is not corrected for the mean of e, so u² = mean² + (half-width)²/3.
    ///
    /// # Source
    ///
    /// JCGM 100:2008 (GUM), 4.3.7 (rectangular distribution) and F.2.4.5 (uncorrected mean).
    #[must_use]
    pub fn between(name: &str, load: &str, direction: &[f64], [low, high]: [f64; 2]) -> Self {
        let limits = Some([low, high]);
        Self { limits, ..Self::of_load(name, load, direction, one_sided(low, high), f64::INFINITY) }
    }

    /// The same error, which other sources may have too.
    #[must_use]
    pub fn known_as(self, key: Option<String>, quantity: &str) -> Self {
        Self { key, quantity: quantity.to_owned(), ..self }
    }

    /// The same error, evaluated otherwise.
    #[must_use]
    pub fn evaluated_as(self, kind: Kind) -> Self {
        Self { kind, ..self }
    }

    /// Standard uncertainties of a load, row by row and independent: part of the scatter.
    ///
    /// `standard` in N or N m, one per row.
    #[must_use]
    pub fn of_each_row(name: &str, load: &str, standard: &[f64]) -> Self {
        Self { shared: "run", is_of_each_row: true, ..Self::of_load(name, load, standard, 1.0, f64::INFINITY) }
    }
}

/// A fit as the propagation sees it.
#[derive(Debug, Clone, Copy)]
pub struct Linearised<'a> {
    /// The law that was fitted.
    pub law: &'a ForceLaw,
    /// Its observations.
    pub data: &'a Dataset,
    /// Coefficients (undetermined ones at zero).
    pub coefficients: &'a [f64],
    /// ∂β/∂y, `p × (responses·rows)`.
    pub sensitivity: MatRef<'a, f64>,
}

impl<'a> Linearised<'a> {
    /// About the coefficients of a fit, whose law's come first.
    pub(crate) fn about(law: &'a ForceLaw, data: &'a Dataset, coefficients: &'a [f64], fitted: &'a fit::Fit) -> Self {
        Self { law, data, coefficients: &coefficients[..law.coefficients.len()], sensitivity: fitted.sensitivity() }
    }
}

/// The contribution of every entry of the budget and of every shared error. `campaign` is the key of the campaign that declares the budget;
/// empty where none does.
///
/// Entry by entry C_B = Σ_g (S·J)_g (S·J)_gᵀ over the groups g of rows that share one error, with S = ∂β/∂y of the fit and J = −∂(Xβ)/∂q per standard uncertainty of
/// the quantity q; entries of the covariance have the product of the units of two coefficients.
///
/// # Errors
///
/// A quantity that is no channel of the observations.
///
/// # Source
///
/// JCGM 100:2008 (GUM), 5.1.2, 5.2.2 and F.1.2.
pub fn contributions(
    fit: Linearised<'_>,
    budget: &[BudgetEntry],
    campaign: &str,
    shared_errors: &[SharedError],
    scatter_is_noise: bool,
) -> Result<Vec<Part>, IdentifyError> {
    let mut out = Vec::new();
    for entry in budget {
        let direction = direction(fit, entry)?;
        let groups = groups(fit.data, entry.shared);
        let n_groups = groups.iter().copied().max().map_or(0, |m| m + 1);
        let single = n_groups == fit.data.rows && fit.data.rows > 1;
        let p = fit.sensitivity.nrows();
        let n = fit.data.rows;
        let mut moved = Mat::<f64>::zeros(p, n_groups);
        for row in 0..direction.len() {
            if direction[row] != 0.0 {
                let g = groups[row % n];
                for j in 0..p {
                    moved[(j, g)] += fit.sensitivity[(j, row)] * direction[row];
                }
            }
        }
        let covariance = &moved * moved.transpose();
        out.push(Part {
            origin: origin(entry, campaign, &moved),
            name: in_words(entry),
            shared: entry.shared.name(),
            kind: match entry.kind {
                ErrorKind::B => Kind::B,
                ErrorKind::Numerical => Kind::Numerical,
                ErrorKind::Input => Kind::Input,
                ErrorKind::ModelForm => Kind::ModelForm,
            },
            covariance,
            dof: vec![entry.dof.unwrap_or(f64::INFINITY); p],
            shape: Shape::Normal,
            in_scatter: single && scatter_is_noise,
        });
    }
    for error in shared_errors {
        out.push(shared_error(fit, error)?);
    }
    Ok(out)
}

/// Largest number of groups that errors are cleared of.
const MOST_GROUPS: usize = 50;
/// Largest number of rows for which [`directions`] are computed.
const MOST_ROWS: usize = 10_000;

/// Effect of each declared shared error on the responses: one column per error over all rows, scaled to one standard uncertainty. Errors of single rows have no column; above [`MOST_ROWS`] rows there are none.
///
/// # Errors
///
/// A quantity that is no channel of the observations.
pub(crate) fn directions(
    fit: Linearised<'_>,
    budget: &[BudgetEntry],
    shared_errors: &[SharedError],
) -> Result<Mat<f64>, IdentifyError> {
    let (n, loads) = (fit.data.rows, &fit.law.responses);
    let mut columns: Vec<Vec<f64>> = Vec::new();
    if n > MOST_ROWS || fit.data.sample.is_some() {
        return Ok(Mat::zeros(n * loads.len(), 0));
    }
    // A law of a load takes a gain of it; the error of the measured load would take every residual.
    let is_gain = |entry: &&BudgetEntry| entry.relative && loads.contains(&entry.quantity);
    for entry in budget.iter().filter(|entry| !is_gain(entry)) {
        let direction = direction(fit, entry)?;
        let groups = groups(fit.data, entry.shared);
        let count = groups.iter().max().map_or(0, |most| most + 1);
        let of_group =
            |g: usize| direction.iter().enumerate().map(|(i, d)| if groups[i % n] == g { *d } else { 0.0 }).collect();
        columns.extend((0..count).filter(|_| count < n && count <= MOST_GROUPS).map(of_group));
    }
    for error in shared_errors.iter().filter(|error| !error.is_of_each_row) {
        for k in 0..error.covariance.len() {
            let mut column = vec![0.0; n * loads.len()];
            for (channel, rows) in &error.directions {
                let of = |i: usize| rows.get(i).and_then(|row| row.get(k)).copied().unwrap_or(0.0);
                let moved = moved_by(fit, channel, &|i| of(i) * error.covariance[k][k].sqrt())?;
                column.iter_mut().zip(moved).for_each(|(sum, by)| *sum += by);
            }
            columns.push(column);
        }
    }
    columns.retain(|column| column.iter().any(|x| *x != 0.0));
    Ok(Mat::from_fn(n * loads.len(), columns.len(), |i, k| columns[k][i]))
}

/// What an entry is called in a budget.
pub(crate) fn in_words(entry: &BudgetEntry) -> String {
    entry.name.clone().map_or_else(|| entry.quantity.clone(), |name| format!("{name} ({})", entry.quantity))
}

/// An entry that all sources of a campaign share, as one error of unit size.
fn origin(entry: &BudgetEntry, campaign: &str, moved: &Mat<f64>) -> Option<Origin> {
    let key = common_key(entry, campaign).filter(|_| moved.ncols() == 1)?;
    Some(Origin {
        key,
        quantity: entry.quantity.clone(),
        covariance: Mat::identity(1, 1),
        sensitivity: moved.clone(),
        limits: None,
    })
}

/// Key of an entry that all sources of a campaign share: those that give it one name mean one instrument. `None` of any other.
#[must_use]
pub fn common_key(entry: &BudgetEntry, campaign: &str) -> Option<String> {
    let is_common = entry.shared == Shared::Campaign && !campaign.is_empty();
    entry.name.as_ref().filter(|_| is_common).map(|name| {
        let relative = if entry.relative { " relative" } else { "" };
        format!("{campaign}/{name}/{}{relative} {:e}", entry.quantity, entry.standard)
    })
}

/// ∂(stacked response error)/∂e times the entry's standard deviation, per stacked row.
///
/// A load errs by itself. A wrong motion or density makes the fit use X(q + e) for X(q):
/// the response is then wrong by −∂(Xβ)/∂q·e, taken by central differences.
pub(crate) fn direction(fit: Linearised<'_>, entry: &BudgetEntry) -> Result<Vec<f64>, IdentifyError> {
    let quantity = fit.data.meant(&entry.quantity);
    let values = fit.data.values(quantity).ok_or_else(|| IdentifyError::Campaign {
        place: "[[source.uncertainty]]".to_owned(),
        what: format!(
            "quantity = {quantity:?} is not a column of the table; it has {}",
            fit.data.channels.keys().cloned().collect::<Vec<_>>().join(", ")
        ),
    })?;
    if quantity == "temperature" {
        return Err(IdentifyError::Campaign {
            place: "[[source.uncertainty]]".to_owned(),
            what: "quantity = \"temperature\" acts through the density; state the uncertainty of density instead"
                .to_owned(),
        });
    }
    moved_by(fit, quantity, &|i| if entry.relative { entry.standard * values[i] } else { entry.standard })
}

/// What an error of a channel, of its own size in each row, does to the residuals of all responses; nothing where the observations have no such channel.
///
/// # Errors
///
/// A law that cannot be evaluated.
fn moved_by(fit: Linearised<'_>, quantity: &str, standard: &dyn Fn(usize) -> f64) -> Result<Vec<f64>, IdentifyError> {
    let n = fit.data.rows;
    let mut out = vec![0.0; n * fit.law.responses.len()];
    if let Some(r) = fit.law.responses.iter().position(|name| name == quantity) {
        for i in 0..n {
            out[r * n + i] = standard(i);
        }
        as_logarithms(fit, &mut out, &fit.law.measured(fit.data)?);
        return Ok(out);
    }
    // A load of another law moves nothing of this one.
    let Some(values) = fit.data.values(quantity).filter(|_| !LOADS.contains(&quantity)) else { return Ok(out) };
    let scale = values.iter().fold(0.0_f64, |m, v| m.max(v.abs())).max(1e-3);
    let step = 1e-5 * scale;
    let (above, below) = (fit.data.shifted(quantity, &vec![step; n]), fit.data.shifted(quantity, &vec![-step; n]));
    let up = fit.law.predict(&above, fit.coefficients)?;
    let down = fit.law.predict(&below, fit.coefficients)?;
    let here = fit.law.predict(fit.data, fit.coefficients)?;
    for row in 0..out.len() {
        let i = row % n;
        // The cross terms turn their sign with v_x: at broadside the difference is taken on the row's own side.
        let side = |d: &Dataset| d.velocity_m_s(i)[0] < 0.0;
        let slope = match (side(&above) == side(fit.data), side(&below) == side(fit.data)) {
            (true, false) => (up[row] - here[row]) / step,
            (false, true) => (here[row] - down[row]) / step,
            _ => (up[row] - down[row]) / (2.0 * step),
        };
        out[row] = -slope * standard(i);
    }
    as_logarithms(fit, &mut out, &here);
    Ok(out)
}

/// Errors of loads as errors of their logarithms, where the fit compares these: d ln|F| = dF/F, at the measured load
/// where the load errs, at the predicted one where the motion does.
fn as_logarithms(fit: Linearised<'_>, errors: &mut [f64], loads: &[f64]) {
    if fit.law.in_logarithms() {
        // A load that was not measured has no logarithm, and no error.
        for (error, load) in errors.iter_mut().zip(loads) {
            *error = if *load == 0.0 { 0.0 } else { *error / load };
        }
    }
}

/// Group of every row that shares the error.
pub(crate) fn groups(data: &Dataset, shared: Shared) -> Vec<usize> {
    match shared {
        Shared::Sample => (0..data.rows).collect(),
        Shared::Run => {
            if data.run.iter().all(String::is_empty) {
                (0..data.rows).collect()
            } else {
                labels(&data.run)
            }
        }
        Shared::Setup => {
            if data.setup.iter().all(String::is_empty) {
                labels(&data.configuration)
            } else {
                labels(&data.setup)
            }
        }
        Shared::Campaign => vec![0; data.rows],
    }
}

/// S·D·C·Dᵀ·Sᵀ, the sum over the rows inside where each row has an error of its own.
fn shared_error(fit: Linearised<'_>, error: &SharedError) -> Result<Part, IdentifyError> {
    let (p, n, q) = (fit.sensitivity.nrows(), fit.data.rows, error.covariance.len());
    let per_unit: Vec<Vec<f64>> =
        error.directions.iter().map(|(channel, _)| moved_by(fit, channel, &|_| 1.0)).collect::<Result<_, _>>()?;
    let c = Mat::from_fn(q, q, |a, b| error.covariance[a][b]);
    let mut moved = Mat::<f64>::zeros(p, q);
    let mut covariance = Mat::<f64>::zeros(p, p);
    for i in 0..n {
        for ((_, rows), per_unit) in error.directions.iter().zip(&per_unit) {
            for (k, d) in rows.get(i).into_iter().flatten().enumerate() {
                for at in (i..per_unit.len()).step_by(n).filter(|at| per_unit[*at] != 0.0) {
                    for j in 0..p {
                        moved[(j, k)] += fit.sensitivity[(j, at)] * d * per_unit[at];
                    }
                }
            }
        }
        if error.is_of_each_row {
            covariance += &moved * &c * moved.transpose();
            moved.fill(0.0);
        }
    }
    if !error.is_of_each_row {
        covariance = &moved * &c * moved.transpose();
    }
    let limits_of = |j: usize, [low, high]: [f64; 2]| {
        let ends = [moved[(j, 0)] * low, moved[(j, 0)] * high];
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    };
    Ok(Part {
        name: error.name.clone(),
        shared: error.shared,
        kind: error.kind,
        covariance,
        dof: vec![error.dof; p],
        shape: error
            .limits
            .map_or(Shape::Normal, |limits| Shape::Between((0..p).map(|j| limits_of(j, limits)).collect())),
        in_scatter: error.is_of_each_row,
        origin: error.key.as_ref().map(|key| Origin {
            key: key.clone(),
            quantity: error.quantity.clone(),
            covariance: c,
            sensitivity: moved,
            limits: error.limits,
        }),
    })
}

/// The scatter of the observations as the first part of the budget.
///
/// Type A: the covariance of the fit, in the product of the units of two coefficients.
///
/// # Source
///
/// JCGM 100:2008 (GUM), 2.3.2.
#[must_use]
pub fn scatter(fit: &fit::Fit) -> Part {
    let dof = fit.coefficients.iter().map(|c| c.dof.unwrap_or(f64::INFINITY)).collect();
    Part::scatter(SCATTER.to_owned(), "sample", fit.covariance.clone(), dof)
}

/// Two-sided 95 % quantile of Student's t.
///
/// k = t(0.975, `dof`), dimensionless; 1.96 for infinite `dof`.
///
/// # Source
///
/// JCGM 100:2008 (GUM), G.3.
#[must_use]
pub fn coverage_factor(dof: f64) -> f64 {
    froude_fit::distribution::coverage_factor(0.95, dof)
}

/// A generator for seeded draws elsewhere in the crate.
#[must_use]
pub fn generator(seed: u64) -> Pcg64 {
    Pcg64::seed_from_u64(seed)
}
