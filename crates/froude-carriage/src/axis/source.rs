//! An axis as a source: its models from runs of a carriage, or from anyone's log of a servo.

use std::path::Path;

use froude_identify::answer::Made;
use froude_identify::method::{Found, Method, MethodError, Need};
use froude_records::RecordError;
use froude_records::campaign::{Campaign, Input, Source};
use froude_records::finding::{Finding, Severity};
use froude_records::run::TOW;
use froude_records::table::sidecar_of;

use super::page::sections;
use super::{AxisModel, AxisModels, KINDS, force_per_volt_n_v, long, of_runs, of_table};
use crate::runs::read;
use crate::source::lacking_in;

/// The models of an axis.
pub struct Servo;

/// Their names.
const NAMES: [&str; 4] = {
    let [a, b, c, d] = AxisModel::ALL;
    [a.name(), b.name(), c.name(), d.name()]
};

impl Servo {
    /// What a log tells that no rig is known of.
    pub const OF_LOGS: [&'static str; 2] = [AxisModel::Symmetric.name(), AxisModel::Asymmetric.name()];
}

fn named(name: &str) -> Option<AxisModel> {
    AxisModel::ALL.into_iter().find(|model| model.name() == name)
}

/// What moves slowly enough for a rigid axis.
const SLOW: &[&str] = &["position", "reference_velocity", "command"];
const RIGID: [Need; 1] = [Need::of(&["friction", "dry"], SLOW)];
const OF_LOG: [Need; 2] = [RIGID[0], Need { is_optional: true, ..Need::of(&["table"], &["position", "command"]) }];
const EXCITED: [Need; 1] = [Need::of(&["excitation"], &["position", "command"])];

const fn needs(model: AxisModel) -> &'static [Need] {
    match model {
        AxisModel::Symmetric | AxisModel::Asymmetric => &OF_LOG,
        AxisModel::OverPosition => &RIGID,
        AxisModel::TwoMass => &EXCITED,
    }
}

impl Method for Servo {
    fn names(&self) -> &'static [&'static str] {
        &NAMES
    }

    fn words(&self, name: &str) -> &'static str {
        named(name).map_or("", AxisModel::words)
    }

    fn needs(&self, name: &str) -> &'static [Need] {
        named(name).map_or(&[], needs)
    }

    fn runs(&self) -> &'static str {
        TOW
    }

    fn identify(
        &self,
        _: &Campaign,
        source: &Source,
        asked: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Found, MethodError> {
        let asked: Vec<AxisModel> = asked.iter().filter_map(|name| named(name)).collect();
        match &source.input {
            Input::Runs { paths, campaign } => {
                progress("reading the runs");
                let runs = read(paths, &KINDS, campaign.as_deref())?;
                progress("identifying the axis");
                let name = if source.name.is_empty() { runs.own_name("servo") } else { source.name.clone() };
                let axis = of_runs(&runs, &asked, &name)?;
                let mut found = found(axis, source, &asked, |model| lacking_in(needs(model), &runs))?;
                found.beside = Some(runs.results("servo"));
                found.is_part = runs.beside > 0;
                Ok(found)
            }
            input if long::is_long(input.path()) => {
                progress("identifying the axis from a long log");
                let (path, sidecar) = (input.path(), source.sidecar.as_deref());
                let gain_n_v = force_per_volt_n_v(path, sidecar)?;
                long::of_table(path, sidecar, (&source.name, source.kind.name()), gain_n_v, &asked)
            }
            input => {
                progress("identifying the axis");
                let axis = of_table(input.path(), source.sidecar.as_deref(), &source.name)?;
                found(axis, source, &asked, |_| None)
            }
        }
    }
}

/// An answer for each model, in the order asked for; `lacking` says what the runs do not have for one that somebody named.
fn found(
    mut axis: AxisModels,
    source: &Source,
    asked: &[AxisModel],
    lacking: impl Fn(AxisModel) -> Option<String>,
) -> Result<Found, MethodError> {
    let (summary, blocks) = sections(&axis);
    let mut findings = std::mem::take(&mut axis.findings);
    let mut out = Vec::new();
    for &model in asked {
        match axis.estimates.iter().position(|(estimate, _)| estimate.method.name == model.name()) {
            Some(i) => {
                let (mut estimate, files) = axis.estimates.swap_remove(i);
                source.kind.name().clone_into(&mut estimate.kind);
                out.push(Made { name: format!("{}, {}", estimate.source, model.name()), estimate, files }.into());
            }
            // Whoever names no model gets those that the runs allow; a fit that failed has said so.
            None if source.methods.is_empty() => {}
            None => findings.extend(lacking(model).map(|why| {
                let text = format!("{} ({}): {why}", model.name(), model.words());
                Finding::new(Severity::Warning, "not-fitted", text)
            })),
        }
    }
    if out.is_empty() {
        let why: String = findings.iter().map(|finding| format!("; {}", finding.message)).collect();
        return Err(MethodError::input(
            source.input.path(),
            format!("none of the models asked for can be identified from these runs{why}"),
        ));
    }
    Ok(Found { results: out, summary: Some(summary), blocks, findings, ..Found::default() })
}

/// Channels that make a log one of a servo.
const OF_SERVO: [&str; 3] = ["time", "position", "command"];

/// Whether the sidecar of a table says that it is the log of a servo: time, position and command of an axis, and no load on a body.
///
/// # Errors
///
/// A sidecar that cannot be read.
pub fn is_servo_log(table: &Path, sidecar: Option<&Path>) -> Result<bool, RecordError> {
    let Some(sidecar) = sidecar_of(table, sidecar)? else { return Ok(false) };
    let has = |name: &str| sidecar.columns.values().any(|column| column.name.trim_start_matches("y/") == name);
    Ok(OF_SERVO.into_iter().all(has))
}
