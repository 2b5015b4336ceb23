//! Which force model the data support, and why.
//!
//! Candidates are the models whose coefficients are all determined. The simplest law
//! that they support is found first. Recommended is the largest one that contains it and
//! that the data do not contradict (AICc at most 10 above the smallest: beyond that a
//! model has essentially no support, Burnham and Anderson 2002, § 2.6), or that is not
//! clearly less likely (AICc at most 6 above). Nothing within it chose it, so that its intervals hold
//! whichever of the laws within it is true; those of a law that the scatter has chosen do not.
//!
//! The simplest law stands beside it as a formula: the one with the fewest
//! coefficients among those whose AICc lies within 2 of the smallest (smaller
//! differences are no evidence), unless an F test rejects it inside the best one
//! at 1 % in some load.
//!
//! Models are compared load by load, over every load that some candidate explains.
//! A model that says nothing of a load says that it is zero, and has the AICc of
//! that: so a law of three loads and one of f_x alone stand side by side. The
//! reason is written with its numbers.

use froude_fit as fit;
use froude_hydro::{DragModel, Setting};
use froude_records::campaign::RangeBlock;
use froude_records::comparison::NestedTest;
use froude_records::text::counted;

use crate::dataset::{Dataset, labels};
use crate::law::{ForceLaw, Kind, REFERENCE_SPEED_M_S};
use crate::regression::ModelFit;

/// Level below which an F test rejects the simpler model.
const REJECTED_BELOW: f64 = 0.01;
/// A law that does not contain the chosen one is preferred to it, where it is larger or linear, up to this difference of AICc: that it is true is less than one in twenty as likely
/// beyond. Up to it the chosen law may be chosen by the scatter alone, and its intervals would not hold.
const RIVAL_WITHIN: f64 = 6.0;
/// AICc differences beyond this leave a model essentially no support.
const NO_SUPPORT_ABOVE: f64 = 10.0;
/// AICc differences below this are no evidence.
pub(crate) const NO_EVIDENCE_BELOW: f64 = 2.0;

/// Prediction of left-out observations by one model, by component.
#[derive(Debug, Clone, PartialEq)]
pub struct Score {
    /// RMSE by load component, in the load's unit.
    pub rmse: Vec<(String, f64)>,
    /// Why there is none.
    pub note: Option<String>,
}

/// A range block: fitted inside, predicted outside.
#[derive(Debug, Clone, PartialEq)]
pub struct BlockScore {
    /// The block in words.
    pub block: String,
    /// Model.
    pub model: String,
    /// RMSE outside by component, and the same relative to the outside loads' RMS.
    pub rmse: Vec<(String, f64, f64)>,
    /// Largest |predicted/measured − 1| among the outside rows whose load is at least half the largest.
    pub worst_ratio: Vec<(String, f64)>,
    /// Coefficients refitted inside, beside those of all rows: (name, all, inside).
    pub moved: Vec<(String, f64, f64)>,
}

/// What the selection says.
#[derive(Debug, Clone, PartialEq)]
pub struct Recommendation {
    /// Index of the recommended model, whose numbers and intervals count.
    pub index: usize,
    /// Index of a smaller model that the data support as well: a formula of the recommended one.
    pub formula: Option<usize>,
    /// Why, with numbers.
    pub reason: String,
}

impl Recommendation {
    /// The simplest model that the data support.
    #[must_use]
    pub fn simplest(&self) -> usize {
        self.formula.unwrap_or(self.index)
    }
}

/// AICc of a fit in the units of its loads; a fit in logarithms is carried over by its Jacobian.
///
/// With weights w the likelihood has a factor ∏√w. Fits of loads and of their logarithms weigh the same `std_*` column
/// differently, and would not be comparable without it.
///
/// n ln(RSS/n) + 2K + 2K(K+1)/(n − K − 1) per load, summed over the loads; K counts σ. The Jacobian adds 2 Σ ln|F|, F in N or N m. Only differences
/// between models of the same rows have a meaning; below 2 they are no evidence. `None` for an exact fit, a robust loss, or n ≤ K + 1.
///
/// # Source
///
/// Hurvich & Tsai (1989), Biometrika 76; Burnham & Anderson (2002), section 2.6.
#[must_use]
pub fn aicc(model: &ModelFit, data: &Dataset) -> Option<f64> {
    model.law.responses.iter().map(|load| aicc_of(model, data, load)).sum()
}

/// The part of one load in [`aicc`]; `None` also where the model does not explain it.
#[must_use]
pub fn aicc_of(model: &ModelFit, data: &Dataset, load: &str) -> Option<f64> {
    let r = model.law.responses.iter().position(|response| response == load)?;
    let n = data.rows;
    let of_weights: f64 = model.problem.weight.iter().flat_map(|w| &w[r * n..(r + 1) * n]).map(|w| w.ln()).sum();
    let base = model.fit.components[r].aicc? - of_weights;
    if !model.law.in_logarithms() {
        return Some(base);
    }
    let jacobian: f64 = data.values(load)?.iter().map(|f| f.abs().ln()).sum();
    Some(base + 2.0 * jacobian)
}

/// AICc of the statement that a load is zero, with the weights of its `std_*` column where the others have them.
fn aicc_of_nothing(data: &Dataset, load: &str, is_weighted: bool) -> Option<f64> {
    if let Some(all) = &data.sample {
        return fit::select::aicc(all.rows, *all.squares.get(load)?, 0.0).ok().filter(|x| x.is_finite());
    }
    let f = data.values(load)?;
    let mut weight = vec![1.0; f.len()];
    if let Some(std) = data.values(&format!("std_{load}")).filter(|_| is_weighted) {
        weight = std.iter().map(|s| 1.0 / (s * s)).collect();
        let mean = weight.iter().sum::<f64>() / weight.len() as f64;
        for w in &mut weight {
            *w /= mean;
        }
    }
    let rss: f64 = f.iter().zip(&weight).map(|(f, w)| w * f * f).sum();
    let of_weights: f64 = weight.iter().map(|w| w.ln()).sum();
    Some(fit::select::aicc(f.len(), rss, 0.0).ok()? - of_weights).filter(|x| x.is_finite())
}

/// F tests of every nested pair among the fitted models.
///
/// F = (RSS_simple − RSS_general)/m / (RSS_general/ν), compared with F(m, ν): m restrictions, ν degrees of freedom of the general model. Both fits are without
/// bounds. The restrictions of f1 to f6 are those of [`DragModel::restrictions_in`].
#[must_use]
pub fn nested_tests(models: &[ModelFit], data: &Dataset) -> Vec<NestedTest> {
    let mut out = Vec::new();
    for general in models {
        for simple in models {
            let Some(rows) = restrictions(&simple.law, &general.law, data) else { continue };
            let p = general.specs.len();
            let constraints: Vec<fit::Constraint> = rows
                .into_iter()
                .map(|mut row| {
                    row.resize(p, 0.0);
                    fit::Constraint { row, value: 0.0 }
                })
                .collect();
            let Ok(tests) = fit::select::nested_tests(&general.problem, &general.options, &constraints) else {
                continue;
            };
            for test in tests {
                if let Some(t) = test.score.as_ref() {
                    out.push(NestedTest {
                        simple: simple.law.name.clone(),
                        general: general.law.name.clone(),
                        component: test.component.clone(),
                        f: t.f,
                        dof: t.dof,
                        p: t.p,
                    });
                }
            }
        }
    }
    out
}

/// Restrictions R·β = 0 under which `general` becomes `simple`.
fn restrictions(simple: &ForceLaw, general: &ForceLaw, data: &Dataset) -> Option<Vec<Vec<f64>>> {
    if simple.name == general.name {
        return None;
    }
    match (&simple.kind, &general.kind) {
        (Kind::Drag { model: a, .. }, Kind::Drag { model: b, body, cross_term }) => {
            let setting = Setting {
                body: *body,
                n_links: 1.0,
                density_kg_m3: data.values("density").and_then(|d| d.first().copied()).unwrap_or(1000.0),
                v_ref_m_s: REFERENCE_SPEED_M_S,
                cross_term: *cross_term,
            };
            drag_restrictions(*a, *b, &setting)
        }
        (Kind::Formulas(_), Kind::Formulas(_)) => {
            // Nested by dropped terms: every coefficient of the simple law is one of the general's,
            // with the same regressor.
            if simple.responses != general.responses || simple.coefficients.len() >= general.coefficients.len() {
                return None;
            }
            let x = simple.regressors(data, &[]).ok()?;
            let y = general.regressors(data, &[]).ok()?;
            for (j, c) in simple.coefficients.iter().enumerate() {
                let k = general.position(&c.name)?;
                let same = (0..x.nrows()).all(|i| (x[(i, j)] - y[(i, k)]).abs() <= 1e-9 * x[(i, j)].abs());
                if !same {
                    return None;
                }
            }
            Some(
                general
                    .coefficients
                    .iter()
                    .enumerate()
                    .filter(|(_, c)| simple.position(&c.name).is_none())
                    .map(|(k, _)| {
                        let mut row = vec![0.0; general.coefficients.len()];
                        row[k] = 1.0;
                        row
                    })
                    .collect(),
            )
        }
        _ => None,
    }
}

fn drag_restrictions(simple: DragModel, general: DragModel, setting: &Setting) -> Option<Vec<Vec<f64>>> {
    simple.restrictions_in(general, setting).map(|r| r.rows().map(<[f64]>::to_vec).collect())
}

/// Leave-one-configuration-out score of a model.
///
/// The root mean square of measured less predicted, per load, in N or N m: each configuration is predicted by a fit to the others. The note says why there is no score.
#[must_use]
pub fn leave_one_out(model: &ModelFit, data: &Dataset) -> Score {
    if model.law.is_nonlinear() {
        return Score {
            rmse: Vec::new(),
            note: Some("not possible: the law is not linear in its coefficients".to_owned()),
        };
    }
    if let Some(all) = &data.sample {
        let note = match all.configurations.len() {
            few @ ..3 => {
                format!(
                    "not possible: leaving one configuration out needs at least three configurations; the table has {few}"
                )
            }
            _ => "not scored: no configuration is left out of a table that is read in chunks".to_owned(),
        };
        return Score { rmse: Vec::new(), note: Some(note) };
    }
    let groups = labels(&data.configuration);
    let n = data.rows;
    let stacked: Vec<usize> = (0..model.problem.response.len()).map(|row| groups[row % n]).collect();
    let names = data.configurations();
    match fit::select::leave_one_group_out(&model.problem, &model.options, &stacked) {
        Ok(scores) => {
            let mut out = Score { rmse: Vec::new(), note: None };
            for score in scores {
                match score.score {
                    fit::select::Score::Scored(s) => out.rmse.push((score.component, s.rmse)),
                    fit::select::Score::NotScorable { reason } => {
                        out.note = Some(if names.len() < 3 {
                            format!(
                                "not possible: leaving one configuration out needs at least three configurations; the table has {}",
                                names.len()
                            )
                        } else {
                            format!("{}: not possible: {reason}", score.component)
                        });
                    }
                }
            }
            out
        }
        Err(reason) => Score { rmse: Vec::new(), note: Some(format!("not possible: {reason}")) },
    }
}

/// Fits inside a declared range, predicts outside.
///
/// Per load the root mean square error outside the range in N or N m, the same over the root mean square of the load, and the largest relative error among loads above half of the
/// largest. `None` for a law that is not linear, for an unknown column, or where nothing lies inside or outside.
#[must_use]
pub fn range_block(model: &ModelFit, data: &Dataset, block: &RangeBlock) -> Option<BlockScore> {
    // The problem of a non-linear law holds its last linear step, not the loads.
    if model.law.is_nonlinear() {
        return None;
    }
    let values = data.values(data.meant(&block.column))?;
    let inside = |i: usize| values[i] >= block.low - 1e-12 && values[i] <= block.high + 1e-12;
    let n = data.rows;
    let train: Vec<bool> = (0..model.problem.response.len()).map(|row| inside(row % n)).collect();
    let result = fit::select::range_block(&model.problem, &model.options, &train).ok()?;
    let mut rmse = Vec::new();
    let mut worst = Vec::new();
    for (r, name) in model.law.responses.iter().enumerate() {
        let outside: Vec<usize> = (0..n).filter(|&i| !inside(i)).map(|i| r * n + i).collect();
        if outside.is_empty() {
            return None;
        }
        let measured: Vec<f64> = outside.iter().map(|&row| model.problem.response[row]).collect();
        let predicted: Option<Vec<f64>> = outside.iter().map(|&row| result.predicted[row]).collect();
        let predicted = predicted?;
        let count = measured.len() as f64;
        let error = (measured.iter().zip(&predicted).map(|(m, p)| (m - p).powi(2)).sum::<f64>() / count).sqrt();
        let size = (measured.iter().map(|m| m * m).sum::<f64>() / count).sqrt();
        rmse.push((name.clone(), error, error / size));
        let largest = measured.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        let ratio = measured
            .iter()
            .zip(&predicted)
            .filter(|(m, _)| m.abs() >= 0.5 * largest)
            .map(|(m, p)| p / m - 1.0)
            .fold(0.0, |worst: f64, x| if x.abs() > worst.abs() { x } else { worst });
        worst.push((name.clone(), ratio));
    }
    Some(BlockScore {
        block: format!("fitted to {} in [{:.4}, {:.4}]", block.column, block.low, block.high),
        model: model.law.name.clone(),
        rmse,
        worst_ratio: worst,
        moved: model
            .specs
            .iter()
            .zip(&model.coefficients)
            .zip(&result.refit.coefficients)
            .filter_map(|((s, all), inside)| inside.value.map(|x| (s.name.clone(), *all, x)))
            .collect(),
    })
}

/// A p-value in words; below 1e-9 its digits say nothing.
fn p_value(p: f64) -> String {
    if p < 1e-9 { "p < 1e-9".to_owned() } else { format!("p = {p:.1e}") }
}

/// The models that the data support.
///
/// The formula is, of the determined models whose summed AICc lies within 2 of the smallest, the one with the fewest coefficients, unless an F test at 1 % rejects it inside the
/// leading model. Recommended is, of those that contain it (within 10) or are not clearly less likely (6 above it) and have an interval for each coefficient, the one with the most loads and
/// coefficients; of several the linear one. `None` without a determined model.
///
/// # Source
///
/// Burnham & Anderson (2002), section 2.6 (differences of AICc).
#[must_use]
pub fn recommend(models: &[ModelFit], data: &Dataset, tests: &[NestedTest]) -> Option<Recommendation> {
    let determined = |m: &ModelFit| m.fit.coefficients.iter().all(|c| c.status != fit::Status::Undetermined);
    let loads = loads_of(models.iter().filter(|m| determined(m)));
    let explains = |m: &ModelFit, load: &str| m.law.responses.iter().any(|r| r == load);
    let is_weighted = models.iter().any(|m| m.problem.weight.is_some());
    let part = |m: &ModelFit, load: &str| {
        if explains(m, load) { aicc_of(m, data, load) } else { aicc_of_nothing(data, load, is_weighted) }
    };
    let score: Vec<Option<f64>> = models
        .iter()
        .map(|m| if determined(m) { loads.iter().map(|load| part(m, load)).sum() } else { None })
        .collect();
    let most = |filter: &dyn Fn(&ModelFit) -> bool| {
        (0..models.len())
            .filter(|&i| filter(&models[i]))
            .min_by_key(|&i| std::cmp::Reverse(models[i].law.responses.len()))
    };
    let (best, best_aicc) = score
        .iter()
        .enumerate()
        .filter_map(|(i, s)| s.map(|s| (i, s)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .or_else(|| most(&determined).map(|i| (i, f64::NAN)))
        .or_else(|| (!models.is_empty()).then_some((0, f64::NAN)))?;
    let size = |m: &ModelFit| m.law.coefficients.len();
    let behind = |i: usize| score[i].map(|s| s - best_aicc);
    let chosen = (0..models.len())
        .filter(|&i| {
            let is_rejected = tests
                .iter()
                .any(|t| t.simple == models[i].law.name && t.general == models[best].law.name && t.p < REJECTED_BELOW);
            i == best || (behind(i).is_some_and(|d| d < NO_EVIDENCE_BELOW) && !is_rejected)
        })
        .min_by(|&a, &b| {
            let key = |i: usize| (size(&models[i]), behind(i).unwrap_or(0.0));
            key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal)
        })
        .unwrap_or(best);
    let name = &models[chosen].law.name;
    let mut reason = if models.len() == 1 {
        format!("{name} is the only model asked for")
    } else if best_aicc.is_nan() {
        format!("{name} is the first determined model; none has an AICc (exact fit, robust loss, or too few rows)")
    } else if chosen == best {
        let runner = (0..models.len())
            .filter(|&i| i != best)
            .filter_map(|i| behind(i).map(|d| (i, d)))
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let next = runner.map_or_else(String::new, |(i, d)| format!(" ({} is {d:.1} behind)", models[i].law.name));
        format!("{name} has the smallest AICc{next}")
    } else {
        format!(
            "{name}: {} has the smallest AICc, but {name} is only {:.1} behind, which is no evidence against it, and has {} instead of {}",
            models[best].law.name,
            behind(chosen).unwrap_or(0.0),
            counted(size(&models[chosen]), "coefficient", "coefficients"),
            size(&models[best])
        )
    };
    let rejected: Vec<String> = tests
        .iter()
        .filter(|t| t.general == *name && t.p < REJECTED_BELOW)
        .map(|t| format!("{} in {} ({})", t.simple, t.component, p_value(t.p)))
        .collect();
    if !rejected.is_empty() {
        reason += &format!("; F tests reject {}", rejected.join(", "));
    }
    if models.iter().any(|m| m.in_variables) {
        reason += "; judged by ordinary least squares, before errors of the regressors are fitted";
    }
    let out: Vec<String> = models.iter().filter(|m| !determined(m)).map(|m| m.law.name.clone()).collect();
    if !out.is_empty() {
        reason += &format!("; {} not in the running, the data do not determine all coefficients", out.join(", "));
    }
    reason += &load_by_load(models, data, &loads);
    let rank = |i: &usize| {
        let m = &models[*i];
        (std::cmp::Reverse(m.law.responses.len()), std::cmp::Reverse(size(m)), m.law.is_nonlinear())
    };
    // What is held has no interval, and needs none.
    let is_held =
        |m: &ModelFit, j: usize| matches!(m.fit.coefficients[j].status, fit::Status::Fixed | fit::Status::Excluded);
    let has_intervals =
        |m: &ModelFit| (0..m.specs.len()).all(|j| is_held(m, j) || (m.combined[j].is_some() && !m.is_refused(j)));
    // One that contains the chosen law says no less; one that does not has to be as likely.
    let contains = |i: usize| {
        restrictions(&models[chosen].law, &models[i].law, data).is_some()
            || adds_loads(&models[chosen].law, &models[i].law)
    };
    let is_rival = |i: usize| {
        let (Some(own), Some(of_chosen)) = (behind(i).filter(|d| d.is_finite()), behind(chosen)) else { return false };
        let most = if contains(i) { NO_SUPPORT_ABOVE } else { of_chosen + RIVAL_WITHIN };
        own <= most && determined(&models[i]) && has_intervals(&models[i])
    };
    let full = (0..models.len()).filter(|&i| i == chosen || is_rival(i)).min_by_key(rank).unwrap_or(chosen);
    if full == chosen || rank(&full) == rank(&chosen) {
        return Some(Recommendation { index: chosen, formula: None, reason });
    }
    let larger = &models[full].law.name;
    let why = if contains(full) {
        format!(
            "{larger} is the largest law that these data determine and do not contradict: its intervals hold whichever law within it is true"
        )
    } else {
        format!(
            "{larger} is not clearly less likely than {name}, which is no part of it: its intervals hold if it is true, or a law within it"
        )
    };
    let reason = format!("{why}. Formula: {reason}");
    Some(Recommendation { index: full, formula: Some(chosen), reason })
}

/// Whether a law has the formulas of another one and further loads.
fn adds_loads(simple: &ForceLaw, general: &ForceLaw) -> bool {
    let of = |law: &ForceLaw, load: &String| law.texts.get(load).cloned();
    simple.responses.len() < general.responses.len()
        && simple.responses.iter().all(|load| of(simple, load).is_some() && of(simple, load) == of(general, load))
}

/// Every load that one of the models explains, in the order of the axes; user-written ones after them.
fn loads_of<'a>(models: impl Iterator<Item = &'a ModelFit>) -> Vec<String> {
    let mut out: Vec<String> = Vec::new();
    for load in models.flat_map(|m| &m.law.responses) {
        if !out.contains(load) {
            out.push(load.clone());
        }
    }
    out.sort_by_key(|load| crate::dataset::LOADS.iter().position(|l| l == load).unwrap_or(usize::MAX));
    out
}

/// What is best in each load, where not all models explain the same ones.
fn load_by_load(models: &[ModelFit], data: &Dataset, loads: &[String]) -> String {
    if models.iter().all(|m| m.law.responses.len() == loads.len()) {
        return String::new();
    }
    let best: Vec<String> = loads
        .iter()
        .map(|load| {
            let mut ranked: Vec<(f64, &str)> =
                models.iter().filter_map(|m| Some((aicc_of(m, data, load)?, m.law.name.as_str()))).collect();
            ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
            match ranked.as_slice() {
                [(first, name), (second, next), ..] => {
                    format!("{name} for {load} ({next} is {:.1} behind)", second - first)
                }
                [(_, name)] => format!("{name} for {load} (no other explains it)"),
                [] => format!("none for {load}"),
            }
        })
        .collect();
    format!(
        "; the laws do not all explain the same responses (one that a law leaves out is predicted as zero); for single responses the smallest AICc is that of: {}",
        best.join(", ")
    )
}
