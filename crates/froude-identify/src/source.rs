//! One source from its table to its estimates: reduce, lint, and the laws that its channels allow.

pub(crate) mod asked;
mod constants;
pub(crate) mod handed;
pub(crate) mod models;

use froude_records::campaign::{Campaign, Input, Source};
use froude_records::finding::{Finding, Severity};

use crate::error::IdentifyError;
use crate::large;
use crate::lint::counts::Counts;
use crate::motions;
use crate::reduce::{Observations, reduce};
use crate::seam::{Choice, fit};
use crate::source::asked::{reduced, with_recommended};
use crate::source::handed::{TABLE, merges_motions, scatter};

pub use crate::result::{NotFitted, ReadFile, SourceResult};
pub use crate::source::asked::Asked;
pub use crate::source::models::{asked_models, check_budget, laws};

/// Identifies one source that has a table; `progress` receives each model before it is fitted.
///
/// Everything is in SI after [`crate::reduce::reduce`]; the formulas are those of [`crate::seam::fit`].
///
/// # Errors
///
/// See [`IdentifyError`].
pub fn identify_source(
    campaign: &Campaign,
    source: &Source,
    progress: &dyn Fn(&str),
) -> Result<SourceResult, IdentifyError> {
    if let Input::Table(path) = &source.input
        && large::is_long(campaign, source, path)
        && let Some(result) = large::identify_source(campaign, source, large::SAMPLE, progress)?
    {
        return Ok(result);
    }
    identify_observations(campaign, source, reduce(campaign, source)?, TABLE, progress)
}

/// The same of observations that a method called `method` has reduced to the rows of a table.
///
/// # Errors
///
/// See [`IdentifyError`].
pub fn identify_observations(
    campaign: &Campaign,
    source: &Source,
    mut observations: Observations,
    method: &str,
    progress: &dyn Fn(&str),
) -> Result<SourceResult, IdentifyError> {
    let mut findings = Vec::new();
    if campaign.identify.group_offset && observations.data.group.is_none() {
        return Err(IdentifyError::Campaign {
            place: format!("source {:?}", source.name),
            what: "group_offset = \"estimate\" needs groups: write group = \"COLUMN\", the column that says which rows share an offset".to_owned(),
        });
    }
    let laws = laws(campaign, source, &observations.data)?;
    if merges_motions(campaign, source) {
        findings.extend(motions::merge(&mut observations.data, &laws));
    }
    let scatter = scatter(campaign, source, method, &observations.data, &mut findings)?;
    let observations = Observations { findings: [observations.findings, findings].concat(), ..observations };
    identify_laws(
        campaign,
        source,
        observations,
        Asked { method, laws, scatter, choice: Choice::Selection, has_budget: false },
        progress,
    )
}

/// The same with laws, scatter and choice that the method states.
///
/// # Errors
///
/// See [`IdentifyError`].
pub fn identify_laws(
    campaign: &Campaign,
    source: &Source,
    observations: Observations,
    asked: Asked<'_>,
    progress: &dyn Fn(&str),
) -> Result<SourceResult, IdentifyError> {
    let counts = Counts::of(&observations.data);
    let reduced = reduced(campaign, source, observations, &counts, asked)?;
    Ok(with_recommended(fit(reduced, &campaign.identify, progress)?, campaign))
}

/// A finding that a published source carries no data.
#[must_use]
pub fn published_note(source: &Source) -> Finding {
    Finding::new(Severity::Note, "published", "a published record: it is compared, not fitted".to_owned())
        .of_source(&source.name)
}
