//! Whether two estimates come from the same observations.

use std::collections::BTreeMap;
use std::path::Path;

use froude_records::estimate::{DataFile, Estimate, EstimateFile, Status};
use froude_records::finding::{Finding, Severity};

use crate::compare::named::Named;
use crate::data_files::{INHERITED, is_same_data};

/// What is read as something else than observations: it is the same error under its own key, or no error at all.
const NOT_OBSERVED: [&str; 4] = ["campaign", "sidecar", "record", INHERITED];

/// Runs with known weights: observations of a calibration, and of nothing else.
const CALIBRATION: &str = "calibration";

/// Whether a file holds observations of an estimate; an old record does not say what it read a file as.
fn is_observed(estimate: &Estimate, data: &DataFile) -> bool {
    let is_table = |path: &str| {
        Path::new(path).extension().is_none_or(|e| !e.eq_ignore_ascii_case("toml") && !e.eq_ignore_ascii_case("json"))
    };
    !data.sha256.is_empty()
        && data.role.as_deref().map_or_else(
            || is_table(&data.path),
            |role| !NOT_OBSERVED.contains(&role) && (role != CALIBRATION || estimate.method.name == CALIBRATION),
        )
}

/// The files that the observations of an estimate came from.
pub(crate) fn data_of<'a>(file: &'a EstimateFile, estimate: &'a Estimate) -> impl Iterator<Item = &'a DataFile> {
    estimate.data.iter().filter_map(|key| file.data.get(key))
}

/// By fingerprint.
type Files<'a> = BTreeMap<&'a str, Vec<&'a DataFile>>;

fn by_fingerprint<'a>(files: impl Iterator<Item = &'a DataFile>) -> Files<'a> {
    let mut out = Files::new();
    files.for_each(|file| out.entry(file.sha256.as_str()).or_default().push(file));
    out
}

/// The observations of an estimate among files.
fn observed<'a>(estimate: &Estimate, files: impl Iterator<Item = &'a DataFile>) -> Files<'a> {
    by_fingerprint(files.filter(|data| is_observed(estimate, data)))
}

/// Whether any data are in both; different sheets of one workbook are different data.
fn share(a: &Files<'_>, b: &Files<'_>) -> bool {
    let is_in = |(sha, files): (&&str, &Vec<&DataFile>)| {
        b.get(sha).is_some_and(|others| files.iter().any(|x| others.iter().any(|y| is_same_data(x, y))))
    };
    a.iter().any(is_in)
}

/// The files that hold observations of an estimate; of an old record, which does not say whose they are, all of them.
#[must_use]
pub fn observations<'a>(file: &'a EstimateFile, estimate: &'a Estimate) -> Vec<&'a DataFile> {
    let own: Vec<_> = data_of(file, estimate).filter(|data| is_observed(estimate, data)).collect();
    if own.is_empty() { file.data.values().filter(|data| is_observed(estimate, data)).collect() } else { own }
}

/// Where an estimate comes from, as far as its record shows.
pub(super) struct Origin<'a> {
    /// Its tables or runs.
    tables: Files<'a>,
    /// Those behind its priors.
    inherited: Files<'a>,
    /// Whether these are its own, and not those of all estimates of its record.
    is_exact: bool,
    /// Whether all estimates of the record are of this one's source.
    is_alone: bool,
}

/// The origin of each estimate.
pub(super) fn origins<'a>(all: &[Named<'a>]) -> Vec<Origin<'a>> {
    let of = |n: &Named<'a>| {
        let own = observed(n.estimate, data_of(n.record, n.estimate));
        // What is behind a known coefficient or a tare is an error with a key of its own.
        let has_prior = n.estimate.coefficients.values().any(|c| c.status == Status::Prior);
        let is_inherited = |data: &&DataFile| has_prior && data.role.as_deref() == Some(INHERITED);
        let inherited = by_fingerprint(n.record.data.values().filter(is_inherited));
        let is_exact = !own.is_empty();
        let first = n.record.estimates.first().map(|e| &e.source);
        let is_alone = || n.record.estimates.iter().all(|e| Some(&e.source) == first);
        if is_exact {
            Origin { tables: own, inherited, is_exact, is_alone: true }
        } else {
            Origin { tables: observed(n.estimate, n.record.data.values()), inherited, is_exact, is_alone: is_alone() }
        }
    };
    all.iter().map(of).collect()
}

/// True for two models of one source in one record, which are not independent.
pub(super) fn is_one_source(a: &Named<'_>, b: &Named<'_>) -> bool {
    std::ptr::eq(a.record, b.record) && a.estimate.source == b.estimate.source
}

/// True for two methods, of two sources that each have an estimate of the same law by the other's method too.
pub(super) fn has_likes(all: &[Named<'_>], a: &Named<'_>, b: &Named<'_>) -> bool {
    let has = |source: &Named<'_>, method: &str| {
        all.iter().any(|n| {
            is_one_source(n, source)
                && n.estimate.law.name == source.estimate.law.name
                && n.estimate.method.name == method
        })
    };
    let [of_a, of_b] = [a, b].map(|n| n.estimate.method.name.as_str());
    // In this order: most pairs are of one method, and nothing is searched for them.
    of_a != of_b && has(a, of_b) && has(b, of_a)
}

/// True where both records name their tables and none of them is the same.
pub(super) fn have_other_tables([a, b]: [&Origin<'_>; 2]) -> bool {
    !a.tables.is_empty() && !b.tables.is_empty() && !share(&a.tables, &b.tables)
}

/// True where two estimates come from the same observations, as far as their records show.
///
/// A record says which files each estimate came from. An old one names its tables, but not which source read which: there a shared table counts where that is plain (one table, or
/// one source), and else if the sources have the same name or the same observations (number and ranges). Without
/// fingerprints only an equal fit is known to be the same.
pub(super) fn same_data([a, b]: [&Named<'_>; 2], [first, second]: [&Origin<'_>; 2]) -> bool {
    let (x, y) = (a.estimate, b.estimate);
    if is_one_source(a, b) || x == y {
        return true;
    }
    let values = |e: &Estimate| e.coefficients.iter().map(|(n, c)| (n.clone(), c.value)).collect::<Vec<_>>();
    let same_observations = x.n_observations > 0 && x.n_observations == y.n_observations && x.validity == y.validity;
    if same_observations && x.law.name == y.law.name && x.sigma == y.sigma && values(x) == values(y) {
        return true;
    }
    if first.is_exact && second.is_exact {
        // A prior that was fitted to the other's rows, too.
        let is_taken = |own: &Origin<'_>, other: &Origin<'_>| share(&own.tables, &other.inherited);
        return share(&first.tables, &second.tables) || is_taken(first, second) || is_taken(second, first);
    }
    if std::ptr::eq(a.record, b.record) {
        // Fitted sources read tables; a published one beside them does not.
        return first.tables.len() == 1 && x.n_observations > 0 && y.n_observations > 0;
    }
    let is_plain = |own: &Origin<'_>| own.tables.len() == 1 || own.is_alone;
    share(&first.tables, &second.tables)
        && ((is_plain(first) && is_plain(second)) || x.source == y.source || same_observations)
}

pub(super) fn same_data_finding(a: &Named<'_>, b: &Named<'_>) -> Finding {
    Finding::new(
        Severity::Warning,
        "same-data",
        format!(
            "{} ({}) and {} ({}) come from the same data: their agreement is no evidence, and E_n and χ², which assume \
             independent measurements, are not given",
            a.estimate.source, a.file, b.estimate.source, b.file
        ),
    )
}
