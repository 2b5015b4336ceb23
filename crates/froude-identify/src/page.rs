//! The section of a page on one fitted source, in the blocks of [`froude_records::page`].
//!
//! | module           | what                                                              |
//! |------------------|-------------------------------------------------------------------|
//! | [`method`]       | what every page says of the method, sentence by sentence          |
//! | `error_models`   | what fits of logarithms assume, and what the residuals support    |
//! | `facts`          | the head of the section                                           |
//! | `points`         | observations beside the prediction                                |
//! | `curves`         | lines of the law with their bands; `settings` finds their places  |
//! | `budget`         | inputs of the uncertainty of each coefficient                     |
//! | `selection`      | the contest of the laws                                           |
//!
//! Not here: how a page looks (`froude-report`).

pub mod against;
mod budget;
pub mod campaign;
mod curves;
mod error_models;
mod facts;
pub mod method;
mod named;
mod points;
mod selection;
mod settings;
mod steps;
#[cfg(test)]
mod tests;
pub mod told;
pub mod validation;

use froude_records::page::SourceSection;

use crate::IdentifyError;
use crate::answer::{Answer, Made};
use crate::result::SourceResult;

/// Everything that a page says about one source.
///
/// # Errors
///
/// A channel that the recommended law needs and the data lack: not after a fit.
pub fn section(answer: &Answer) -> Result<SourceSection, IdentifyError> {
    match answer {
        Answer::Fitted(source) => fitted(source),
        Answer::Made(made) => Ok(self::made(made)),
    }
}

/// An estimate that a method made itself: it knows what goes into it.
fn made(made: &Made) -> SourceSection {
    let Made { name, estimate, .. } = made;
    let fact = |name: &str, value: String| (name.to_owned(), value);
    let facts = if estimate.n_observations == 0 {
        // Nothing was observed: the notes state how it was computed.
        estimate.diagnostics.notes.iter().map(|note| fact("Computation", note.clone())).collect()
    } else {
        vec![
            fact("Rows", estimate.n_observations.to_string()),
            fact("Covariance", estimate.covariance_kind().to_owned()),
        ]
    };
    SourceSection {
        name: name.clone(),
        kind: estimate.kind.clone(),
        facts,
        estimates: vec![estimate.clone()],
        budget: budget::of_estimate(estimate),
        recommendation: estimate.method.words.clone(),
        ..SourceSection::default()
    }
}

fn fitted(source: &SourceResult) -> Result<SourceSection, IdentifyError> {
    let chosen = source.recommendation.as_ref().map(|r| r.index);
    let mut out = SourceSection {
        name: source.name.clone(),
        kind: source.kind.name().to_owned(),
        facts: facts::of(source),
        estimates: source.estimates.clone(),
        selection: selection::rows(source),
        not_fitted: source.not_fitted.iter().map(|n| (n.model.clone(), n.why.clone())).collect(),
        tests: source.tests.clone(),
        recommendation: source.recommendation.as_ref().map_or_else(String::new, |r| r.reason.clone()),
        sample_of: source.data.sample.as_ref().map(|all| all.rows),
        ..SourceSection::default()
    };
    if let Some(model) = chosen.and_then(|i| source.models.get(i)) {
        out.points = points::of(model, &source.data)?;
        // Where the fit was made elsewhere, the estimate knows what goes into it.
        let is_fitted = model.combined.iter().any(Option::is_some);
        out.budget = if is_fitted {
            budget::of_fit(model)
        } else {
            source.estimates.first().map(budget::of_estimate).unwrap_or_default()
        };
        out.curves = curves::of(source, model, &source.data)?;
    }
    Ok(out)
}
