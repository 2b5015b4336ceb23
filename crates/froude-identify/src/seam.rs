//! The seam: what a method hands over is [`Reduced`], and whatever is fitted to rows passes [`fit`].
//!
//! A method knows how its runs or its table become observations, which laws they are to be fitted with, what they weigh, where their scatter
//! comes from, and which errors they share. It contains no regression, budget, interval or record: these are here, once. What it states about the
//! results (which of several is the best, whether they agree) it says afterwards.

use froude_fit::budget::Kind;
use froude_records::campaign::{BudgetEntry, Identify, SourceKind};
use froude_records::estimate::{Attitude, Frame, Measured, Range, ReferencePoint};
use froude_records::finding::{Finding, Severity};
use indexmap::IndexMap;

use crate::dataset::Dataset;
use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::regression::{ModelFit, Scatter, Settings, Weight, regress};
use crate::selection::{Recommendation, Score, leave_one_out, nested_tests, range_block, recommend};
use crate::source::{NotFitted, ReadFile, SourceResult};
use crate::uncertainty::SharedError;
use crate::{bootstrap, diagnosis, record, uncertainty};

/// Observations of one method, and how they are to be fitted.
#[derive(Debug, Clone)]
pub struct Reduced {
    /// Name of the source.
    pub source: String,
    /// Its kind.
    pub kind: SourceKind,
    /// The observations.
    pub data: Dataset,
    /// Rows, or runs, that were read.
    pub n_read: usize,
    /// The laws, each fitted to all of them.
    pub laws: Vec<ForceLaw>,
    /// Which of the laws is recommended.
    pub choice: Choice,
    /// What the observations weigh.
    pub weight: Weight,
    /// Where their scatter comes from.
    pub scatter: Scatter,
    /// Declared errors of the channels.
    pub budget: Vec<BudgetEntry>,
    /// Key of the campaign that declares them; empty where none does.
    pub campaign: String,
    /// Errors that observations share, of subtracted tares and of the method itself.
    pub errors: Vec<SharedError>,
    /// Looks that an interval pays for (Bonferroni), 1 or more.
    pub looks: usize,
    /// What the record states beside the fit.
    pub stated: Stated,
    /// Ranges of the observations.
    pub validity: IndexMap<String, Range>,
    /// What was found on the way.
    pub findings: Vec<Finding>,
    /// Files that were read.
    pub files: Vec<ReadFile>,
}

impl Reduced {
    /// Observations of which nothing more is known: weights of their `std_*` columns, scatter of their residuals, no errors, the law chosen by
    /// the data.
    #[must_use]
    pub fn new(source: &str, kind: SourceKind, method: &str, data: Dataset, laws: Vec<ForceLaw>) -> Self {
        Self {
            source: source.to_owned(),
            kind,
            n_read: data.rows,
            data,
            laws,
            choice: Choice::Selection,
            weight: Weight::Std,
            scatter: Scatter::Classical,
            budget: Vec::new(),
            campaign: String::new(),
            errors: Vec::new(),
            looks: 1,
            stated: Stated { method: method.to_owned(), frame: Frame::body(), ..Stated::default() },
            validity: IndexMap::new(),
            findings: Vec::new(),
            files: Vec::new(),
        }
    }

    /// How its laws are regressed.
    pub(crate) fn settings<'a>(&'a self, identify: &'a Identify) -> Settings<'a> {
        Settings {
            source_name: &self.source,
            kind: self.kind,
            identify,
            weight: self.weight,
            scatter: &self.scatter,
            budget: &self.budget,
            campaign: &self.campaign,
            shared_errors: &self.errors,
            looks: self.looks,
            condensed: None,
        }
    }
}

/// Who says which law is recommended.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Choice {
    /// The data, among all laws; each estimate is called after its law.
    Selection,
    /// The method, which has one law, in words; the estimate is called after the method, and whether it is better than those of other methods is
    /// for these to say.
    Method(String),
}

/// What a record states that no fit tells.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Stated {
    /// Name of the method: `table`, `mcd`, ….
    pub method: String,
    /// How the numbers were made, in words; `None` for those of the regression.
    pub words: Option<String>,
    /// Axes of the coefficients.
    pub frame: Frame,
    /// The point that moments are about.
    pub point: ReferencePoint,
    /// How the body was held.
    pub attitude: Option<Attitude>,
    /// What the coefficients refer to, beside the mean density and the geometry in the law.
    pub refers_to: IndexMap<String, Measured>,
    /// Constants of the method, beside those of the law.
    pub constants: IndexMap<String, Measured>,
    /// Names that papers give to coefficients.
    pub labels: IndexMap<String, String>,
    /// Numbers made from coefficients, outside the covariance.
    pub derived: Vec<Derived>,
}

/// A number that is a coefficient times an exact factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Derived {
    /// Its name.
    pub name: String,
    /// How it is made, in symbols of the record.
    pub formula: String,
    /// The coefficient.
    pub of: String,
    /// The factor, above zero.
    pub factor: f64,
    /// SI unit text of the product.
    pub unit: String,
}

/// Fits every law, compares and chooses, and makes the records; `progress` receives each law before it is fitted.
///
/// Observations and coefficients are in SI; the formulas are those of [`regress`] and [`recommend`].
///
/// # Errors
///
/// See [`IdentifyError`]; a law that cannot be fitted costs its own row, unless it is the last.
pub fn fit(reduced: Reduced, identify: &Identify, progress: &dyn Fn(&str)) -> Result<SourceResult, IdentifyError> {
    let fitted = reduced.laws.iter().map(|law| {
        progress(&law.name);
        regress(law, &reduced.data, reduced.settings(identify)).map_err(|error| (law.name.clone(), error))
    });
    let fitted = fitted.collect();
    conclude(reduced, identify, fitted, progress)
}

/// Compares the laws that could be fitted, chooses and makes the records.
pub(crate) fn conclude(
    mut reduced: Reduced,
    identify: &Identify,
    fitted: Vec<Result<ModelFit, (String, IdentifyError)>>,
    progress: &dyn Fn(&str),
) -> Result<SourceResult, IdentifyError> {
    let mut findings = std::mem::take(&mut reduced.findings);
    let (data, settings) = (&reduced.data, reduced.settings(identify));
    let (mut models, mut failed) = (Vec::new(), Vec::new());
    for result in fitted {
        match result {
            Ok(model) => {
                findings.extend(model.findings.iter().cloned());
                models.push(model);
            }
            Err(named) => failed.push(named),
        }
    }
    if models.is_empty() {
        return Err(nothing_fitted(failed, &findings));
    }
    let not_fitted: Vec<NotFitted> =
        failed.into_iter().map(|(model, error)| NotFitted { model, why: without_place(&error) }).collect();
    findings.extend(not_fitted.iter().map(|n| {
        let text = format!("model {} could not be fitted and is left out: {}", n.model, n.why);
        Finding::new(Severity::Warning, "not-fitted", text)
    }));
    let tests = nested_tests(&models, data);
    let scores: Vec<Score> = models.iter().map(|m| leave_one_out(m, data)).collect();
    let blocks = identify
        .cross_validation
        .iter()
        .flat_map(|block| models.iter().filter_map(|m| range_block(m, data, block)))
        .collect();
    let recommendation = match &reduced.choice {
        Choice::Selection => recommend(&models, data, &tests),
        Choice::Method(words) => Some(Recommendation { index: 0, reason: words.clone() }),
    };
    let by_data = recommendation.as_ref().filter(|_| reduced.choice == Choice::Selection);
    let mut estimates = Vec::new();
    for (i, model) in models.iter().enumerate() {
        let mut diagnostics = diagnosis::diagnostics(model, data, &scores[i])?;
        let chosen = by_data.filter(|r| r.index == i);
        if let Some(draws) = identify.monte_carlo.filter(|_| chosen.is_some()) {
            progress(&format!("{} by {draws} Monte Carlo draws", model.law.name));
            diagnostics.notes.extend(monte_carlo_note(model, data, settings, draws));
        }
        if let Some(resamples) = identify.wild_bootstrap.filter(|_| chosen.is_some()) {
            progress(&format!("{} by {resamples} wild cluster resamples", model.law.name));
            match bootstrap::note(model, resamples) {
                Ok(note) => diagnostics.notes.push(note),
                Err(finding) => findings.push(finding),
            }
        }
        estimates.push(record::estimate(model, &reduced, diagnostics, chosen));
    }
    Ok(SourceResult {
        findings: findings.into_iter().map(|f| f.of_source(&reduced.source)).collect(),
        name: reduced.source,
        kind: reduced.kind,
        data: reduced.data,
        n_read: reduced.n_read,
        models,
        not_fitted,
        estimates,
        tests,
        scores,
        blocks,
        recommendation,
        validity: reduced.validity,
        files: reduced.files,
    })
}

/// Why an error came about, without the source and the model that it names: where it is shown, they stand beside it.
fn without_place(error: &IdentifyError) -> String {
    match error {
        IdentifyError::Fit { source, .. } => source.to_string(),
        IdentifyError::NoFit { why, .. } => why.clone(),
        IdentifyError::Campaign { what, .. } => what.clone(),
        other => other.to_string(),
    }
}

/// The error of a source without any fit: what each model says once, and what was found in the data before.
fn nothing_fitted(failed: Vec<(String, IdentifyError)>, findings: &[Finding]) -> IdentifyError {
    let mut reasons: Vec<IdentifyError> = Vec::new();
    for (_, error) in failed {
        if !reasons.iter().any(|r| without_place(r) == without_place(&error)) {
            reasons.push(error);
        }
    }
    let found: Vec<String> =
        findings.iter().filter(|f| f.severity == Severity::Error).map(|f| f.message.clone()).collect();
    match <[IdentifyError; 1]>::try_from(reasons) {
        Ok([only]) if found.is_empty() => only,
        Ok([only]) => IdentifyError::NothingFitted { reasons: vec![only], found },
        Err(reasons) => IdentifyError::NothingFitted { reasons, found },
    }
}

/// Type B uncertainties by Monte Carlo beside the linear ones: where they differ, the propagation is not linear.
fn monte_carlo_note(model: &ModelFit, data: &Dataset, settings: Settings<'_>, draws: usize) -> Option<String> {
    /// Seed of the draws; the same campaign gives the same note.
    const SEED: u64 = 1;
    // Entries that are part of the scatter are not drawn: the linear figure does not hold them either.
    let (shared, drawn): (Vec<_>, Vec<_>) = settings
        .budget
        .iter()
        .zip(model.budget.iter().filter(|part| part.kind == Kind::B))
        .filter(|(_, part)| !part.in_scatter)
        .map(|(entry, part)| (entry.clone(), part))
        .unzip();
    if shared.is_empty() {
        return None;
    }
    let bare = Settings { budget: &[], shared_errors: &[], ..settings };
    let covariance = uncertainty::monte_carlo(data, &shared, draws, SEED, |moved| {
        regress(&model.law, moved, bare)
            .ok()
            .map(|m| m.fit.coefficients.iter().map(|c| c.unconstrained.unwrap_or(0.0)).collect())
    })?;
    let parts: Vec<String> = model
        .specs
        .iter()
        .enumerate()
        .filter_map(|(j, s)| {
            model.combined[j]?;
            let linear: f64 = drawn.iter().map(|part| part.covariance[(j, j)]).sum();
            Some(format!("{} {:.2e} ({:.2e})", s.name, covariance[(j, j)].max(0.0).sqrt(), linear.max(0.0).sqrt()))
        })
        .collect();
    Some(format!("type B by {draws} Monte Carlo draws (linear in parentheses): {}", parts.join(", ")))
}
