//! Runs as a source of a campaign: each method that reduces them gives its observations, its fit and its estimate.

use froude_identify::carriage::coefficient::{Coefficient, Method as CarriageMethod};
use froude_identify::source::{ReadFile, SourceResult};
use froude_records::campaign::{Campaign, Input, Source};
use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};

use super::drag::{KINDS, Reduction, reduce, sections};
use super::runs::{Runs, read};
use crate::Error;
use crate::method::{Found, Method};

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
    ) -> Result<Found, Error> {
        let methods: Vec<CarriageMethod> = asked.iter().filter_map(|name| named(name)).collect();
        identify(source, &methods, progress)
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
fn identify(source: &Source, methods: &[CarriageMethod], progress: &dyn Fn(&str)) -> Result<Found, Error> {
    let Input::Runs { paths, campaign } = &source.input else { return Ok(Found::default()) };
    progress("reading the runs");
    let runs = read(paths, &KINDS, campaign.as_deref())?;
    progress("reducing the runs");
    let mut reduction = reduce(runs, methods)?;
    let (summary, blocks) = sections(&reduction);
    let Reduction { runs, report, .. } = &mut reduction;
    let files = files_of(runs);
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
    let folder = source.input.path().display();
    if runs.campaign.is_none() {
        report.findings.push(Finding::new(
            Severity::Warning,
            "no-campaign-of-runs",
            format!(
                "{folder}: no copy of their campaign lies with the runs: fresh water at 20 degC is taken, no area, and of the rig what the runs say"
            ),
        ));
    }
    if out.is_empty() {
        let why: String = report.findings.iter().map(|finding| format!("; {}", finding.message)).collect();
        return Err(Error::Nothing(format!("{folder}: none of the methods asked for can use these runs{why}")));
    }
    Ok(Found {
        results: out,
        summary: Some(summary),
        blocks,
        findings: std::mem::take(&mut report.findings),
        beside: Some(runs.results("drag")),
        is_part: runs.beside > 0,
    })
}

/// The logs of runs, each in its role.
pub(super) fn files_of(runs: &Runs) -> Vec<ReadFile> {
    runs.logs.iter().map(|log| ReadFile::new(log.path.clone(), log.meta.role.name())).collect()
}

/// A result of the report under the name of the source.
fn result(source: &Source, coefficient: Coefficient, estimate: Estimate, n_read: usize) -> SourceResult {
    let Coefficient { method, result, .. } = coefficient;
    // Runs that no campaign names are called as their own campaign calls them.
    let name = if source.name.is_empty() { estimate.source.clone() } else { source.name.clone() };
    let estimate = Estimate {
        id: format!("{name}/{}", method.name()),
        source: name.clone(),
        kind: source.kind.name().to_owned(),
        ..estimate
    };
    SourceResult {
        name: format!("{name}, {}", method.name()),
        kind: source.kind,
        n_read,
        estimates: vec![estimate],
        ..result
    }
}
