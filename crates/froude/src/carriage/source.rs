//! Runs as a source of a campaign: each method that reduces them gives its observations, its fit and its estimate.

use std::path::Path;

use froude_identify::carriage::coefficient::{Coefficient, Method as CarriageMethod};
use froude_identify::source::{ReadFile, SourceResult};
use froude_records::campaign::{Campaign, Source};
use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};

use super::drag::{KINDS, Reduction, reduce};
use super::runs::{Runs, read};
use crate::Error;
use crate::method::Method;

/// The five methods of the towing carriage: one reduction, one setup.
pub(crate) struct Carriage;

/// Their names.
const NAMES: [&str; 5] = {
    let [a, b, c, d, e] = CarriageMethod::ALL;
    [a.name(), b.name(), c.name(), d.name(), e.name()]
};

fn named(name: &str) -> Option<CarriageMethod> {
    CarriageMethod::ALL.into_iter().find(|method| method.name() == name)
}

impl Method for Carriage {
    fn names(&self) -> &'static [&'static str] {
        &NAMES
    }

    fn words(&self, name: &str) -> &'static str {
        named(name).map_or("", CarriageMethod::words)
    }

    fn observes(&self, name: &str, role: &str) -> bool {
        named(name).is_some_and(|method| is_read_by(method, role))
    }

    fn identify(
        &self,
        _: &Campaign,
        source: &Source,
        asked: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Vec<SourceResult>, Error> {
        let methods: Vec<CarriageMethod> = asked.iter().filter_map(|name| named(name)).collect();
        identify(source, source.input.path(), &methods, progress)
    }
}

/// Whether a method takes its observations from runs of a kind; the calibration is an error under its own key.
pub(super) fn is_read_by(method: CarriageMethod, role: &str) -> bool {
    match method {
        CarriageMethod::Fsm => role == "wet",
        CarriageMethod::Mcd => matches!(role, "wet" | "dry"),
        CarriageMethod::MbdpConstant | CarriageMethod::MbdpMapped => matches!(role, "wet" | "dry" | "friction"),
        CarriageMethod::MbdpFlexible => matches!(role, "wet" | "dry" | "friction" | "excitation"),
    }
}

/// Reduces the runs of a source: a result for each method, in the order asked for.
fn identify(
    source: &Source,
    folder: &Path,
    methods: &[CarriageMethod],
    progress: &dyn Fn(&str),
) -> Result<Vec<SourceResult>, Error> {
    progress("reading the runs");
    let Reduction { runs, mut report, .. } = reduce(read(&[folder.to_owned()], &KINDS, None)?, methods)?;
    let files = files_of(&runs);
    let mut out = Vec::new();
    let fitted = std::mem::take(&mut report.coefficients).into_iter().zip(std::mem::take(&mut report.estimates));
    let mut fitted: Vec<(Coefficient, Estimate)> = fitted.collect();
    for &method in methods {
        let Some(i) = fitted.iter().position(|(coefficient, _)| coefficient.method == method) else {
            // Whoever names no method gets those that the runs allow.
            if !source.methods.is_empty() {
                let text = format!("{}: these runs do not give what it needs ({})", method.name(), method.words());
                report.findings.push(Finding::new(Severity::Warning, "not-fitted", text));
            }
            continue;
        };
        let (coefficient, estimate) = fitted.swap_remove(i);
        out.push(SourceResult { files: files.clone(), ..result(source, coefficient, estimate, runs.logs.len()) });
    }
    if runs.campaign.is_none() {
        report.findings.push(Finding::new(
            Severity::Warning,
            "no-campaign-of-runs",
            format!(
                "{}: no copy of their campaign lies with the runs: fresh water at 20 degC is taken, no area, and of the rig what the runs say",
                folder.display()
            ),
        ));
    }
    let Some(first) = out.first_mut() else {
        let why: String = report.findings.iter().map(|finding| format!("; {}", finding.message)).collect();
        return Err(Error::Nothing(format!(
            "{}: none of the methods asked for can use these runs{why}",
            folder.display()
        )));
    };
    first.findings = report.findings.into_iter().map(|finding| finding.of_source(&source.name)).collect();
    Ok(out)
}

/// The logs of runs, each in the role of its kind.
pub(super) fn files_of(runs: &Runs) -> Vec<ReadFile> {
    runs.logs.iter().map(|log| ReadFile::new(log.path.clone(), log.meta.kind.name())).collect()
}

/// A result of the report under the name of the source.
fn result(source: &Source, coefficient: Coefficient, estimate: Estimate, n_read: usize) -> SourceResult {
    let Coefficient { method, result, .. } = coefficient;
    let estimate = Estimate {
        id: format!("{}/{}", source.name, method.name()),
        source: source.name.clone(),
        kind: source.kind.name().to_owned(),
        ..estimate
    };
    SourceResult {
        name: format!("{}, {}", source.name, method.name()),
        kind: source.kind,
        n_read,
        estimates: vec![estimate],
        ..result
    }
}
