//! Where the numbers that a fit takes from records come from.
//!
//! A prior, a known coefficient and a tare are evidence beside the observations only if they were not made of them. The data of each such record,
//! and the data that it inherited in the same way, are listed in the new record as [`INHERITED`], so that a loop through several campaigns is found:
//! a fitted file among them is counted twice, and the job is rejected. Files are the same if their SHA-256 is, unless two
//! different parts of one were read (`sheet` or `part` of their sidecars).

use std::path::Path;

use froude_records::campaign::{Campaign, Source};
use froude_records::estimate::{DataFile, Estimate, EstimateFile};
use froude_records::json::read_estimates;

use crate::IdentifyError;
use crate::answer::Answer;
use crate::compare::observations;
use crate::data_files::{DataFiles, INHERITED, is_same_data};

/// A record that numbers are taken from.
struct Taken<'a> {
    /// `prior`, `known` or `tare`, as the campaign calls it.
    key: &'static str,
    path: &'a Path,
    select: Option<&'a str>,
    /// The coefficient; `None` for all of them.
    entry: Option<&'a str>,
    /// The source that a tare is of.
    source: Option<&'a str>,
}

impl Taken<'_> {
    /// The estimates that the numbers may be of: the named one, or the recommended ones, or all that have the entry.
    fn estimates<'a>(&self, file: &'a EstimateFile) -> Vec<&'a Estimate> {
        let has = |e: &&Estimate| self.entry.is_none_or(|entry| e.coefficients.contains_key(entry));
        let named = |e: &&Estimate| self.select.is_none_or(|id| id == e.id);
        let all: Vec<&Estimate> = file.estimates.iter().filter(named).filter(has).collect();
        let recommended: Vec<&Estimate> = all.iter().copied().filter(|e| e.recommended).collect();
        if recommended.is_empty() { all } else { recommended }
    }

    /// Observations behind the numbers, those that their record inherited among them.
    fn data<'a>(&self, file: &'a EstimateFile) -> Vec<&'a DataFile> {
        let own = self.estimates(file).into_iter().flat_map(|estimate| observations(file, estimate));
        own.chain(file.data.values().filter(|data| data.role.as_deref() == Some(INHERITED))).collect()
    }
}

/// Every record that the sources and `[identify]` of a campaign take numbers from.
fn taken<'a>(campaign: &'a Campaign, sources: &[&'a Source]) -> Vec<Taken<'a>> {
    let identify = &campaign.identify;
    let priors = identify.prior.iter().map(|prior| ("prior", prior));
    let known = identify.known.iter().map(|known| ("known", known));
    let of_identify = priors.chain(known).filter_map(|(key, spec)| {
        let from = spec.record.as_ref()?;
        Some(Taken { key, path: &from.path, select: from.select.as_deref(), entry: Some(&from.entry), source: None })
    });
    let tares = sources.iter().filter_map(|source| {
        let tare = source.tare.as_ref()?;
        let (path, select) = (tare.record.as_path(), tare.select.as_deref());
        Some(Taken { key: "tare", path, select, entry: None, source: Some(&source.name) })
    });
    of_identify.chain(tares).collect()
}

/// The records that a campaign reads.
pub fn records(campaign: &Campaign) -> impl Iterator<Item = &Path> {
    let sources: Vec<&Source> = campaign.sources.iter().collect();
    taken(campaign, &sources).into_iter().map(|taken| taken.path)
}

/// Lists the records and their data among the files of the job.
///
/// # Errors
///
/// [`IdentifyError::Refused`] where a file that is fitted is among the data of a record; a record that cannot be read.
pub fn inherit(campaign: &Campaign, fitted: &[Answer], files: &mut DataFiles<'_>) -> Result<(), IdentifyError> {
    let sources: Vec<&Source> = campaign.sources.iter().filter(|source| !source.is_validation).collect();
    for taken in taken(campaign, &sources) {
        let record = read_estimates(taken.path)?;
        let data = taken.data(&record);
        let of_source = |e: &&Estimate| taken.source.is_none_or(|name| name == e.source);
        let keys = fitted.iter().flat_map(Answer::estimates).filter(of_source).flat_map(|e| &e.data);
        let observed = keys.filter_map(|key| files.get(key));
        if let Some(twice) = observed.into_iter().find(|file| data.iter().any(|data| is_same_data(data, file))) {
            let (campaign, key, record) = (campaign.path.display(), taken.key, taken.path.display());
            return Err(IdentifyError::Refused(format!(
                "{campaign}: {key}: {record} was itself fitted to {}, which this job fits again: the same data would count twice, and the \
                 interval would be too narrow. Take the {key} from a record of other data",
                twice.path
            )));
        }
        files.key(taken.path, "record")?;
        for file in data {
            files.inherit(file);
        }
    }
    Ok(())
}
