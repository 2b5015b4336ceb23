//! Whether the data contradict a law: what the terms of another law would add to it.
//!
//! To the columns X of a law those Z of another one are added, cleared of what X has already; of m independent ones the coefficients γ are zero where the first law is
//! true. F = γᵀC⁻¹γ/m is compared with F(m, ν): C is the covariance of γ from the scatter of the larger fit and from every declared error, ν the fewest degrees of freedom of γ.
//! Of a law inside of another one this is the F test of its restrictions; of two laws of which none contains the other each is tested by itself. At rows of one σ, without
//! declared errors, F is exact for linear laws; a power law is taken by its slopes at the fitted coefficients.
//!
//! A law without a load says that the load is zero, which the terms of another one test in the same way.
//!
//! Where C is estimated as a whole, from clusters or from rows in time, F is that of Hotelling's T², (ν − m + 1)/(ν m) γᵀC⁻¹γ with ν − m + 1 degrees of freedom. Rows whose scatter replicates
//! tell are not tested.
//!
//! # Source
//!
//! Hotelling (1931), Ann. Math. Stat. 2, 360; Mizon & Richard (1986), Econometrica 54, 657 (encompassing); Davidson & MacKinnon (2004), Econometric Theory and Methods, 15.3; Wald (1943).

use froude_fit as fit;
use froude_fit::budget::Part;
use froude_fit::faer::linalg::solvers::Solve as _;
use froude_fit::faer::{Mat, MatRef};
use froude_records::campaign::{BudgetEntry, Shared, SourceKind};
use froude_records::comparison::AddedTerms;

use crate::dataset::Dataset;
use crate::law::{ForceLaw, Kind};
use crate::regression::known;
use crate::regression::runs::between_runs;
use crate::regression::uncertain::serial;
use crate::regression::{ModelFit, Scatter, Settings};
use crate::uncertainty::{Linearised, contributions};

/// Relative residual below which a fit is exact up to rounding.
const EXACT: f64 = 1e-9;

/// F tests of every law against the terms of every other, load by load.
#[must_use]
pub fn added_terms(models: &[ModelFit], data: &Dataset, settings: Settings<'_>) -> Vec<AddedTerms> {
    let mut out = Vec::new();
    for law in models {
        for other in models.iter().filter(|other| other.law.name != law.law.name && !is_one_mean(&law.law, &other.law))
        {
            for load in &other.law.responses {
                out.extend(added(law, other, load, data, settings));
            }
        }
    }
    out
}

/// Whether two laws differ in the errors that they assume and not in the load: a power law in the load's unit and in logarithms.
fn is_one_mean(a: &ForceLaw, b: &ForceLaw) -> bool {
    match (&a.kind, &b.kind) {
        (Kind::PowerLaw { channel, .. }, Kind::PowerLaw { channel: other, .. }) => {
            channel == other && a.responses == b.responses
        }
        _ => false,
    }
}

/// The terms of `other` in one load, beside those of `law`; `None` where it has no further ones, or they leave no degrees of freedom.
fn added(law: &ModelFit, other: &ModelFit, load: &str, data: &Dataset, settings: Settings<'_>) -> Option<AddedTerms> {
    let Widened { gamma, covariance, dof, .. } = widened(law, other, load, data, settings)?;
    tested(law, other, load, &gamma, &covariance, dof)
}

/// A law with the terms of another one in a load.
#[derive(Debug)]
pub(crate) struct Widened {
    /// The fit of both.
    pub(crate) fitted: fit::Fit,
    /// Parts of the other law's columns along the new directions, which are orthonormal by the weights: directions × columns.
    pub(crate) along: Mat<f64>,
    /// Coefficients of the new directions.
    pub(crate) gamma: Vec<f64>,
    /// Their covariance.
    pub(crate) covariance: Mat<f64>,
    /// Their fewest degrees of freedom.
    pub(crate) dof: f64,
}

/// `law` with the terms of `other` in one load; `None` as for [`added`].
pub(crate) fn widened(
    law: &ModelFit,
    other: &ModelFit,
    load: &str,
    data: &Dataset,
    settings: Settings<'_>,
) -> Option<Widened> {
    let (problem, mut of_other) = beside(law, other, load, data)?;
    // What the campaign excludes is no term of either law.
    for &j in &other.options.excluded {
        of_other.col_as_slice_mut(j).fill(0.0);
    }
    let free = fit::complement(&problem, &law.options, &of_other)?;
    let (p, m) = (problem.n_coefficients(), free.ncols());
    let weight = |i: usize| problem.weight.as_ref().map_or(1.0, |w| w[i]);
    let along = Mat::from_fn(m, of_other.ncols(), |k, j| {
        (0..free.nrows()).map(|i| free[(i, k)] * weight(i) * of_other[(i, j)]).sum()
    });
    drop(of_other);
    let mut names = problem.names.clone();
    names.extend((0..m).map(|k| format!("added {k}")));
    let design =
        Mat::from_fn(problem.n_rows(), p + m, |i, j| if j < p { problem.design[(i, j)] } else { free[(i, j - p)] });
    // Columns of a long table are not kept twice.
    drop(free);
    let mut larger = problem;
    (larger.design, larger.names) = (design, names);
    let mut options = law.options.unconstrained();
    if p == 0 {
        let observations = other.law.responses.iter().position(|own| own == load);
        let observations = observations.and_then(|r| other.options.observations.get(r).copied()).into_iter().collect();
        options = fit::Options { covariance: options.covariance, observations, ..fit::Options::default() };
    }
    let fitted = fit::fit(&larger, &options).ok()?;
    let gamma: Vec<f64> = fitted.coefficients[p..].iter().map(|c| c.value).collect::<Option<_>>()?;
    let dof =
        fitted.coefficients[p..].iter().map(|c| c.dof).try_fold(f64::INFINITY, |least, dof| Some(least.min(dof?)))?;
    let fewest = |part: Part| {
        let fewest = part.dof[p..].iter().copied().fold(f64::INFINITY, f64::min);
        (part.covariance, fewest)
    };
    let (scatter, dof) = match &law.scatter {
        Scatter::Runs if law.whitened.is_none() && !law.in_variables => {
            match between_runs(&law.law, data, &larger, &fitted) {
                Some(runs) => fewest(runs.part),
                None => (fitted.covariance.clone(), dof),
            }
        }
        Scatter::Runs | Scatter::Classical | Scatter::Hc3 | Scatter::Cluster => (fitted.covariance.clone(), dof),
        Scatter::Serial(errors) => fewest(serial(data, &larger, &fitted, errors)?),
        // Replicates have the coefficients of their own law alone.
        Scatter::Replicates { .. } => return None,
    };
    let mut covariance = Mat::from_fn(m, m, |a, b| scatter[(p + a, p + b)]);
    for part in declared([law, other], load, data, settings, (&larger, &fitted))? {
        covariance += Mat::from_fn(m, m, |a, b| part.covariance[(p + a, p + b)]);
    }
    Some(Widened { fitted, along, gamma, covariance, dof })
}

/// What declared errors do to the coefficients of the larger problem.
fn declared(
    [law, other]: [&ModelFit; 2],
    load: &str,
    data: &Dataset,
    settings: Settings<'_>,
    (larger, fitted): (&fit::Problem, &fit::Fit),
) -> Option<Vec<Part>> {
    // What is read in chunks has no declared errors.
    if data.sample.is_some() {
        return Some(Vec::new());
    }
    let is_measured = settings.kind != SourceKind::Cfd;
    let parts = |of: &ModelFit, sensitivity: MatRef<'_, f64>, budget: &[BudgetEntry]| {
        let at = Linearised { law: &of.law, data, coefficients: of.law_coefficients(), sensitivity };
        contributions(at, budget, settings.campaign, settings.shared_errors, is_measured).ok()
    };
    let mut out = if !law.law.responses.iter().any(|own| own == load) {
        let first = other.law.responses.iter().position(|own| own == load)? * data.rows;
        let by_row = Mat::from_fn(other.law.responses.len() * data.rows, fitted.sensitivity_by_row.ncols(), |i, j| {
            if (first..first + data.rows).contains(&i) { fitted.sensitivity_by_row[(i - first, j)] } else { 0.0 }
        });
        parts(other, by_row.transpose(), settings.budget)?
    } else if let Some(whitened) = &law.whitened {
        // Errors shared by runs and setups are already in the row covariance.
        let is_of_all = |entry: &&BudgetEntry| entry.shared == Shared::Campaign;
        let budget: Vec<BudgetEntry> = settings.budget.iter().filter(is_of_all).cloned().collect();
        parts(law, whitened.of_rows(fitted.sensitivity()).transpose(), &budget)?
    } else {
        let known = known::parts(&law.law, settings, larger, fitted);
        [parts(law, fitted.sensitivity(), settings.budget)?, known].concat()
    };
    out.retain(|part| !part.in_scatter);
    Some(out)
}

/// F of numbers that are zero where a law is true.
fn tested(
    law: &ModelFit,
    other: &ModelFit,
    load: &str,
    gamma: &[f64],
    covariance: &Mat<f64>,
    dof: f64,
) -> Option<AddedTerms> {
    let m = gamma.len();
    // A covariance estimated as a whole matrix, and not only a σ: Hotelling's T².
    let is_whole = matches!(law.scatter, Scatter::Cluster | Scatter::Serial(_));
    let (factor, dof) = if is_whole { ((dof - m as f64 + 1.0) / dof, dof - m as f64 + 1.0) } else { (1.0, dof) };
    if dof < 1.0 {
        return None;
    }
    let at = Mat::from_fn(m, 1, |i, _| gamma[i]);
    let solved = covariance.llt(fit::faer::Side::Lower).ok()?.solve(&at);
    let f = (0..m).map(|i| gamma[i] * solved[(i, 0)]).sum::<f64>() * factor / m as f64;
    f.is_finite().then(|| AddedTerms {
        law: law.law.name.clone(),
        of: other.law.name.clone(),
        component: load.to_owned(),
        f,
        dof: [m as f64, dof],
        p: fit::distribution::f_upper(f, m as f64, dof),
    })
}

/// The problem of a law, and the columns of another one for a load on its rows. A law without that load says that it is zero: its problem is that load alone. `None` where nothing is left of the
/// load.
fn beside(law: &ModelFit, other: &ModelFit, load: &str, data: &Dataset) -> Option<(fit::Problem, Mat<f64>)> {
    let n = data.rows;
    let of_other = other.law.responses.iter().position(|own| own == load)?;
    let Some(of_law) = law.law.responses.iter().position(|own| own == load) else {
        let rows: Vec<usize> =
            (0..other.problem.n_rows()).filter(|i| other.problem.component[*i] == of_other).collect();
        let of = other.problem.rows(&rows);
        let response = if data.sample.is_some() { of.response } else { data.values(load)?.to_vec() };
        let columns = if data.sample.is_some() {
            of.design
        } else {
            let slopes = other.law.regressors(data, other.law_coefficients()).ok()?;
            Mat::from_fn(n, slopes.ncols(), |i, j| slopes[(of_other * n + i, j)])
        };
        let (component, components) = (vec![0; rows.len()], vec![load.to_owned()]);
        let design = Mat::zeros(rows.len(), 0);
        let (weight, cluster) = (of.weight, of.cluster);
        return Some((
            fit::Problem { design, response, weight, component, components, cluster, names: Vec::new() },
            columns,
        ));
    };
    let component = law.fit.components.iter().find(|component| component.name == load)?;
    if component.relative_residual < EXACT {
        return None;
    }
    let is_of_load = |row: usize| law.problem.component[row] == of_law;
    if data.sample.is_some() {
        let (_, columns) = law.beside.iter().find(|(name, _)| *name == other.law.name)?;
        let of = |i: usize, j: usize| if is_of_load(i) { columns[(i, j)] } else { 0.0 };
        return Some((law.problem.clone(), Mat::from_fn(columns.nrows(), columns.ncols(), of)));
    }
    let mut columns = {
        let slopes = other.law.regressors(data, other.law_coefficients()).ok()?;
        // d ln|F| = dF/F.
        let force =
            if law.law.in_logarithms() { law.law.predict(data, law.law_coefficients()).ok()? } else { Vec::new() };
        Mat::from_fn(law.problem.n_rows(), slopes.ncols(), |i, j| {
            let slope = slopes[(of_other * n + i % n, j)];
            if is_of_load(i) { slope / force.get(i).copied().unwrap_or(1.0) } else { 0.0 }
        })
    };
    let problem = match &law.whitened {
        Some(whitened) => {
            whitened.whiten(&mut columns);
            whitened.problem.clone()
        }
        None => law.problem.clone(),
    };
    Some((problem, columns))
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use froude_records::campaign_file::read_campaign;
    use froude_records::comparison::AddedTerms;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    use crate::result::SourceResult;
    use crate::small_tables::identified;
    use crate::source::identify_source;

    /// The default laws of a table of so many speeds, with more keys of the campaign.
    fn found(n: u32, truth: impl Fn(f64) -> f64, sigma: f64, seed: u128, keys: &str) -> SourceResult {
        let mut rng = Pcg64::new(seed, 0);
        let mut rows = String::new();
        for i in 0..n {
            let u = 0.2 + 1.4 * f64::from(i) / f64::from(n - 1);
            let z: f64 = StandardNormal.sample(&mut rng);
            let _ = writeln!(rows, "{u},{}", -truth(u) + sigma * z);
        }
        identified(&rows, keys)
    }

    fn test<'a>(of: &'a SourceResult, law: &str, other: &str) -> &'a AddedTerms {
        of.tests.iter().find(|t| t.law == law && t.of == other).unwrap()
    }

    /// For one added term, F is t² of that term in the larger law. The smaller law adds nothing to the larger, so that pair is not tested.
    #[test]
    fn f_of_one_term_is_t_squared() {
        let found = found(12, |u| 2.0 * u + 9.0 * u * u, 0.3, 1, "");
        let larger = found.estimates.iter().find(|e| e.law.name == "linear_quadratic").unwrap();
        let linear = &larger.coefficients["D_x_I"];
        let t = linear.value.unwrap() / linear.standard_uncertainty.unwrap();
        let of = test(&found, "quadratic", "linear_quadratic");
        assert!((of.f / (t * t) - 1.0).abs() < 1e-9 && of.dof == [1.0, 10.0], "{of:?} {t}");
        assert!((of.p / froude_fit::distribution::t_two_sided(t, 10.0) - 1.0).abs() < 1e-9, "{of:?}");
        assert!(!found.tests.iter().any(|t| t.law == "linear_quadratic" && t.of == "quadratic"));
        // A power law and a polynomial each have two terms that the other lacks.
        assert_eq!(test(&found, "power_law", "linear_quadratic").dof, [2.0, 8.0]);
        assert_eq!(test(&found, "linear_quadratic", "power_law").dof, [2.0, 8.0]);
    }

    /// A power law by loads and by logarithms has one mean: neither has a term that the other lacks.
    #[test]
    fn error_models_of_one_law_do_not_contradict_each_other() {
        let models = "[identify]\nmodels = [\"quadratic\", \"power_law\", \"power_law_log\"]\n";
        let found = found(12, |u| 12.0 * u.powf(1.8), 0.4, 5, models);
        let is_power = |name: &str| name.starts_with("power_law");
        assert!(found.tests.iter().any(|t| t.law == "power_law_log" && t.of == "quadratic"), "{:?}", found.tests);
        assert!(!found.tests.iter().any(|t| is_power(&t.law) && is_power(&t.of)), "{:?}", found.tests);
    }

    /// An excluded coefficient is no term that could contradict a law without it.
    #[test]
    fn an_excluded_term_contradicts_nothing() {
        let models = "[identify]\nmodels = [\"quadratic\", \"linear_quadratic\"]\n";
        let truth = |u: f64| 2.0 * u + 9.0 * u * u;
        assert!(test(&found(12, truth, 0.1, 3, models), "quadratic", "linear_quadratic").p < 1e-6);
        let excluded = found(12, truth, 0.1, 3, &format!("{models}exclude = [\"D_x_I\"]\n"));
        assert!(excluded.tests.is_empty(), "{:?}", excluded.tests);
    }

    /// A zero error contradicts the quadratic law, and does not where it is declared.
    #[test]
    fn a_declared_zero_error_does_not_contradict_a_law() {
        let zero =
            "[[source.uncertainty]]\nname = \"zero\"\nquantity = \"f_x\"\nstandard = \"1 N\"\nshared = \"campaign\"\n";
        let p = |keys: &str| {
            let found = found(16, |u| 9.0 * u * u + 1.0, 0.1, 2, keys);
            test(&found, "quadratic", "linear_quadratic").p
        };
        assert!(p("") < 1e-6 && p(zero) > 0.05, "{} {}", p(""), p(zero));
    }

    /// The true law is contradicted in 0.5 % of tables at most, of few rows and of many: 600 each, and three standard deviations of the count.
    #[test]
    fn a_true_law_is_rarely_contradicted() {
        let truths: [(&str, fn(f64) -> f64); 3] = [
            ("quadratic", |u| 12.0 * u * u),
            ("linear_quadratic", |u| 3.0 * u + 9.0 * u * u),
            ("power_law", |u| 12.0 * u.powf(1.8)),
        ];
        for n in [5, 16] {
            for (law, truth) in truths {
                let is_left = |seed: u128| {
                    let found = found(n, truth, 0.4, 100 + seed, "");
                    let left = found.recommendation.unwrap().not_contradicted;
                    left.iter().any(|i| found.models[*i].law.name == law)
                };
                let contradicted = (0..600).filter(|seed| !is_left(*seed)).count();
                assert!(contradicted <= 8, "{law}, {n} rows: {contradicted} of 600");
            }
        }
    }

    /// Days with a gain of their own, taken as clusters: the covariance of three terms by four days is known poorly, and a true law is not contradicted for it.
    #[test]
    fn few_clusters_contradict_no_true_law() {
        let folder = tempfile::tempdir().unwrap();
        let campaign = "schema = 1\nname = \"a\"\n[[source]]\nname = \"t\"\nkind = \"towing\"\ntable = \"t.csv\"\ngroup = \"day\"\n[identify]\ncovariance = \"cluster\"\n\
            models = [\"quadratic\", \"long\"]\n[[identify.model]]\nname = \"long\"\nf_x = \"A*u + B*u*abs(u) + C*u^3 + D*u^3*abs(u)\"\n";
        std::fs::write(folder.path().join("c.toml"), campaign).unwrap();
        let is_contradicted = |seed: u128| {
            let mut rng = Pcg64::new(seed, 4);
            let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let mut text = "speed [m/s],day,f_x [N]\n".to_owned();
            for day in 0..4 {
                let gain = 1.0 + 0.03 * normal();
                for i in 0..10 {
                    let u = 0.2 + 0.15 * f64::from(i);
                    let _ = writeln!(text, "{u},day {day},{}", -12.0 * gain * u * u + 0.1 * normal());
                }
            }
            std::fs::write(folder.path().join("t.csv"), text).unwrap();
            let campaign = read_campaign(&folder.path().join("c.toml")).unwrap();
            let found = identify_source(&campaign, &campaign.sources[0], &|_| {}).unwrap();
            let quadratic = found.models.iter().position(|m| m.law.name == "quadratic").unwrap();
            !found.recommendation.unwrap().not_contradicted.contains(&quadratic)
        };
        let contradicted = (0..400).filter(|seed| is_contradicted(*seed)).count();
        assert!(contradicted <= 6, "{contradicted} of 400");
    }
}
