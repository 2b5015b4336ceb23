//! Whether coefficients differ from zero by the wild cluster bootstrap, beside the intervals of the fit.
//!
//! With few or unequal clusters (configurations, tank days) the quantiles of Student's t
//! are not those of the cluster-robust t. The bootstrap takes them from the residuals:
//! see [`froude_fit::wild`] for method and source. Its intervals do not hold there, those of
//! CR3 with degrees of freedom of its own do.

use froude_fit as fit;
use froude_fit::wild::{WildOptions, wild_cluster};
use froude_records::finding::{Finding, Severity};

use crate::regression::ModelFit;

/// Seed of the resamples; the same campaign gives the same interval on any number of threads.
const SEED: u64 = 1;

/// The p value of every determined coefficient against zero, in words, or a finding that says why there is none.
///
/// # Errors
///
/// A finding: no clusters, fewer than five, a prior, Huber's loss, a law that is not linear.
///
/// # Source
///
/// Cameron, Gelbach & Miller (2008); Webb (2023); see [`froude_fit::wild`].
pub fn note(model: &ModelFit, resamples: usize) -> Result<String, Finding> {
    let refuse = |why: String| {
        Finding::new(Severity::Warning, "no-wild-bootstrap", format!("{}: no wild bootstrap: {why}", model.law.name))
    };
    if model.law.is_nonlinear() || model.specs.len() != model.law.coefficients.len() || model.in_variables {
        return Err(refuse("it needs a law that is linear in its coefficients, at known speed and angle".to_owned()));
    }
    if model.problem.cluster.is_none() {
        return Err(refuse("the source has no `group`, the column that says which rows belong together".to_owned()));
    }
    let options = WildOptions { resamples, seed: SEED, ..WildOptions::default() };
    let mut parts = Vec::new();
    let mut clusters = 0;
    for (j, spec) in model.specs.iter().enumerate() {
        if matches!(
            model.fit.coefficients[j].status,
            fit::Status::Undetermined | fit::Status::Fixed | fit::Status::Excluded
        ) {
            continue;
        }
        let result = wild_cluster(&model.problem, &model.options, j, &options).map_err(|e| refuse(e.to_string()))?;
        clusters = result.n_clusters;
        parts.push(format!("{} {:.4}", spec.name, result.p));
    }
    Ok(format!(
        "p against zero, of the scatter alone (without the budget), by {resamples} wild cluster resamples over {clusters} clusters, bounds left \
         out: {}",
        parts.join(", ")
    ))
}
