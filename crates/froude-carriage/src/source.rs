//! Runs as a source of a campaign: each method that reduces them gives its observations, its fit and its estimate.

use froude_identify::method::{Found, Method, MethodError, Need, lacking};
use froude_identify::source::{ReadFile, SourceResult};
use froude_records::campaign::{Campaign, Fluid, Identify, Input, Source};
use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};
use froude_records::run::{Role, RunLog, TOW};

use froude_rig::carriage::LogsRig;

use crate::drag::coefficient::Coefficient;
use crate::drag::point::Method as CarriageMethod;
use crate::reduction::page::sections;
use crate::reduction::{Reduction, reduce};
use crate::runs::{Runs, read};

/// The five methods of the towing carriage: one reduction, one setup.
#[derive(Debug)]
pub struct Carriage;

/// Their names.
const NAMES: [&str; 5] = {
    let [a, b, c, d, e] = CarriageMethod::ALL;
    [a.name(), b.name(), c.name(), d.name(), e.name()]
};

fn method_of(name: &str) -> Option<CarriageMethod> {
    CarriageMethod::ALL.into_iter().find(|method| method.name() == name)
}

impl Method for Carriage {
    fn names(&self) -> &'static [&'static str] {
        &NAMES
    }

    fn words(&self, name: &str) -> &'static str {
        method_of(name).map_or("", CarriageMethod::words)
    }

    fn needs(&self, name: &str) -> &'static [Need] {
        method_of(name).map_or(&[], needs)
    }

    fn runs(&self) -> &'static str {
        TOW
    }

    fn identify(
        &self,
        campaign: &Campaign,
        source: &Source,
        asked: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Found, MethodError> {
        let methods: Vec<CarriageMethod> = asked.iter().filter_map(|name| method_of(name)).collect();
        let mut found = identify(campaign, source, &methods, progress)?;
        if LogsRig::declared(campaign)?.is_none() {
            found.findings.extend(passed_over(campaign, source));
        }
        Ok(found)
    }
}

/// Motion and command of a run.
pub(crate) const DRIVEN: &[&str] = &["position", "reference_velocity", "command"];
/// What calibrates all that read the motor's current; without it the gear's declared efficiency does.
const WEIGHTS: Need = Need { is_optional: true, is_observed: false, ..Need::of(&["calibration"], DRIVEN) };

const WET: Need = Need::of(&["wet"], DRIVEN);
const FRICTION: Need = Need::of(&["dry", "friction"], DRIVEN);
const SENSED: [Need; 1] = [Need::of(&["wet"], &["position", "reference_velocity", "force"])];
const PAIRED: [Need; 3] = [WET, Need::of(&["dry"], DRIVEN), WEIGHTS];
const MODELLED: [Need; 3] = [WET, FRICTION, WEIGHTS];
const FLEXIBLE: [Need; 4] = [WET, FRICTION, Need::of(&["excitation"], DRIVEN), WEIGHTS];

/// The runs that a method needs.
const fn needs(method: CarriageMethod) -> &'static [Need] {
    match method {
        CarriageMethod::Fsm => &SENSED,
        CarriageMethod::Mcd => &PAIRED,
        CarriageMethod::MbdpConstant | CarriageMethod::MbdpMapped => &MODELLED,
        CarriageMethod::MbdpFlexible => &FLEXIBLE,
    }
}

/// Roles of all runs that one of the methods needs.
fn roles() -> Vec<Role> {
    let is_needed = |role: &Role| {
        CarriageMethod::ALL.into_iter().any(|method| needs(method).iter().any(|need| need.roles.contains(&role.name())))
    };
    Role::ALL.into_iter().filter(is_needed).collect()
}

/// What is needed and the runs do not have, in words.
pub(crate) fn lacking_in(needs: &[Need], runs: &Runs) -> Option<String> {
    let files = |role: &str| {
        let of_role = runs.logs.iter().filter(|log| log.meta.role.name() == role);
        of_role
            .map(|log| -> Box<dyn Fn(&str) -> bool> {
                Box::new(|channel| log.channels.keys().any(|name| name.rsplit('/').next() == Some(channel)))
            })
            .collect()
    };
    let lacking = lacking(needs, files);
    (!lacking.is_empty()).then(|| lacking.join("; "))
}

/// Reduces the runs of a source: a result for each method, in the order asked for.
fn identify(
    campaign: &Campaign,
    source: &Source,
    methods: &[CarriageMethod],
    progress: &dyn Fn(&str),
) -> Result<Found, MethodError> {
    let Some(runs) = runs_of(campaign, source, &roles(), progress)? else { return Ok(Found::default()) };
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
                let why = lacking_in(needs(method), runs);
                let why = why.unwrap_or_else(|| "their windows give no point for it".to_owned());
                report.findings.push(not_fitted(method.name(), method.words(), &why));
            }
            continue;
        };
        let (coefficient, estimate) = fitted.swap_remove(i);
        let result = result(source, coefficient, estimate, runs.logs.len());
        out.push(SourceResult { files: files.clone(), ..result }.into());
    }
    let folder = source.input.path().display();
    if runs.campaign.is_none() {
        report.findings.push(Finding::new(
            Severity::Warning,
            "no-campaign-of-runs",
            format!(
                "{folder}: no copy of their campaign lies with the runs: fresh water at 20 degC is assumed, no area, and the rig as the runs state it"
            ),
        ));
    }
    if out.is_empty() {
        return Err(nothing_fitted(source, "none of the requested methods can use these runs", &report.findings));
    }
    Ok(Found {
        results: out,
        summary: Some(summary),
        blocks,
        findings: std::mem::take(&mut report.findings),
        beside: Some(runs.results("drag")),
        is_part: runs.beside > 0,
        ..Found::default()
    })
}

/// The runs of a source of a campaign in these roles; `None` of any other source.
pub(crate) fn runs_of(
    of: &Campaign,
    source: &Source,
    roles: &[Role],
    progress: &dyn Fn(&str),
) -> Result<Option<Runs>, MethodError> {
    let Input::Runs { paths, campaign } = &source.input else { return Ok(None) };
    progress("reading the runs");
    // Logs of other programs may have the campaign that names them.
    let own = LogsRig::declared(of)?.map(|_| of.path.as_path());
    Ok(Some(read(paths, roles, campaign.as_deref().or(own))?))
}

/// The finding that a requested method gave no result.
pub(crate) fn not_fitted(name: &str, words: &str, why: &str) -> Finding {
    Finding::new(Severity::Warning, "not-fitted", format!("{name} ({words}): {why}"))
}

/// The error that no method gave a result, with all findings.
pub(crate) fn nothing_fitted(source: &Source, what: &str, findings: &[Finding]) -> MethodError {
    let why: String = findings.iter().map(|finding| format!("; {}", finding.message)).collect();
    MethodError::input(source.input.path(), format!("{what}{why}"))
}

/// What a campaign declares beside runs, which know their own: it is not used for them, and that is said.
fn passed_over(campaign: &Campaign, source: &Source) -> Option<Finding> {
    let of_tables =
        Identify { user_models: Vec::new(), models: Vec::new(), model_places: Vec::new(), ..campaign.identify.clone() };
    let is_there = [("[fluid]", campaign.fluid != Fluid::default()), ("[identify]", of_tables != Identify::default())];
    let sections: Vec<&str> = is_there.into_iter().filter(|(_, is)| *is).map(|(section, _)| section).collect();
    (!sections.is_empty()).then(|| {
        let text = format!(
            "{} of this campaign {} not used for the runs in {}: water, rig and plan are those of the campaign that they were driven by, and the \
             methods determine how they are fitted",
            sections.join(" and "),
            if sections.len() == 1 { "is" } else { "are" },
            source.input.path().display()
        );
        Finding::new(Severity::Note, "runs-know-their-own", text)
    })
}

/// What results of a source are called after: its own name, or `what` of the runs' campaign.
pub(crate) fn named(source: &Source, runs: &Runs, what: &str) -> String {
    if source.name.is_empty() { runs.own_name(what) } else { source.name.clone() }
}

/// The logs of runs, each in its role, and what says of logs of other programs what they are.
#[must_use]
pub fn files_of(runs: &Runs) -> Vec<ReadFile> {
    let declared = runs.declared_by.iter().map(|path| ReadFile::new(path.clone(), "sidecar"));
    runs.logs.iter().map(file_of).chain(declared).collect()
}

/// The log of a run in its role.
#[must_use]
pub fn file_of(log: &RunLog) -> ReadFile {
    ReadFile::new(log.path.clone(), log.meta.role.name())
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
