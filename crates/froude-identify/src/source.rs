//! One source from its table to its estimates: reduce, lint, and the laws that its channels allow.

pub(crate) mod handed;
pub(crate) mod models;

use froude_records::campaign::{Campaign, Input, Source};
use froude_records::finding::{Finding, Severity};

use crate::error::IdentifyError;
use crate::large;
use crate::law::ForceLaw;
use crate::lint::counts::Counts;
use crate::reduce::{Observations, reduce};
use crate::regression::Scatter;
use crate::seam::{Choice, Reduced, fit};
use crate::source::handed::{TABLE, merges_motions, no_budget, of_table, scatter};
use crate::{columns, diagnosis, lint, motions, validity, zero};

pub use crate::result::{NotFitted, ReadFile, SourceResult};
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

/// What is asked of observations.
#[derive(Debug, Clone)]
pub struct Asked<'a> {
    /// Name of the method that made them.
    pub method: &'a str,
    /// The laws that are fitted.
    pub laws: Vec<ForceLaw>,
    /// Where their scatter comes from.
    pub scatter: Scatter,
    /// Which of the laws is recommended.
    pub choice: Choice,
    /// Whether the method states errors of its instruments itself.
    pub has_budget: bool,
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

/// What is wrong with one of many models belongs to that model; the report shows the recommended one's.
pub(crate) fn with_recommended(mut result: SourceResult, campaign: &Campaign) -> SourceResult {
    if let Some(i) = result.recommendation.as_ref().map(|r| r.index) {
        let found = diagnosis::findings(&result.models[i], &result.data, campaign, &result.estimates[i].diagnostics);
        result.findings.extend(found.into_iter().map(|f| f.of_source(&result.name)));
    }
    result
}

/// The rows with the laws that are asked for; `counts` are those of all rows, of which the observations may be few.
pub(crate) fn reduced(
    campaign: &Campaign,
    source: &Source,
    observations: Observations,
    counts: &Counts,
    asked: Asked<'_>,
) -> Result<Reduced, IdentifyError> {
    let Observations { data, n_read, mut findings, shared_errors, files } = observations;
    let (mut validity, found) = validity::ranges(&data, campaign);
    findings.extend(found);
    let Asked { method, laws, scatter, choice, has_budget } = asked;
    validity.extend(validity::of_laws(&data, &laws));
    findings.extend(lint::of_counted(counts, &data, campaign, &laws));
    findings.extend(no_budget(campaign, source, &shared_errors).filter(|_| !has_budget));
    check_budget(source, &data)?;
    findings.extend(columns::unused(&data, campaign, source, &laws));
    let beside_zero = if method == TABLE { zero::laws(source, &data) } else { Vec::new() };
    let out = of_table(campaign, source, method, data, laws);
    Ok(Reduced { beside_zero, n_read, scatter, choice, errors: shared_errors, validity, findings, files, ..out })
}

/// A finding that a published source carries no data.
#[must_use]
pub fn published_note(source: &Source) -> Finding {
    Finding::new(Severity::Note, "published", "a published record: it is compared, not fitted".to_owned())
        .of_source(&source.name)
}
