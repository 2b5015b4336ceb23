//! What is asked of observations, and the rows as they go into the fit.

use froude_records::campaign::{Campaign, Source};

use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::lint::counts::Counts;
use crate::reduce::Observations;
use crate::regression::Scatter;
use crate::result::SourceResult;
use crate::seam::{Choice, Reduced};
use crate::source::handed::{TABLE, no_budget, of_table};
use crate::source::models::check_budget;
use crate::{columns, diagnosis, lint, named, validity, zero};

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

/// What is wrong with one of many models belongs to that model; the report shows the recommended one's.
pub(crate) fn with_recommended(mut result: SourceResult, campaign: &Campaign) -> SourceResult {
    if let Some(i) = result.recommendation.as_ref().map(|r| r.index) {
        let found = diagnosis::findings(&result.models[i], &result.data, campaign, &result.estimates[i].diagnostics);
        result.findings.extend(found.into_iter().map(|f| f.of_source(&result.name)));
    }
    result
}

/// Prepares the rows and the requested laws for the fit; `counts` covers all rows, of which `observations` may be a sample.
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
    findings.extend(named::findings(&laws, &data));
    let beside_zero = if method == TABLE { zero::laws(source, &data) } else { Vec::new() };
    let out = of_table(campaign, source, method, data, laws);
    Ok(Reduced { beside_zero, n_read, scatter, choice, errors: shared_errors, validity, findings, files, ..out })
}
