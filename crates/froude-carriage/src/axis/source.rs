//! An axis as a source: its models from runs of a carriage, or from anyone's log of a servo.

use froude_identify::IdentifyError;
use froude_identify::answer::Made;
use froude_identify::method::{Found, Logs, Method, MethodError, Need};
use froude_identify::uncertainty::common_key;
use froude_records::Place;
use froude_records::campaign::{Campaign, Shared, Source};
use froude_records::estimate::OWN;
use froude_records::run::{TOW, is_servo_log};
use froude_records::units::Dimension;

use super::cross::hold_against;
use super::declared::SERVO;
use super::page::sections;
use super::{AxisModel, AxisModels, KINDS, force_per_volt_n_v, long, of_runs, of_table};
use crate::servo::scale::{Errs, ForcePerVolt, Scale};
use crate::source::{DRIVEN, lacking_in, named, not_fitted, nothing_fitted, runs_of};

/// The models of an axis.
#[derive(Debug)]
pub struct Servo;

/// Their names.
const NAMES: [&str; 4] = {
    let [a, b, c, d] = AxisModel::ALL;
    [a.name(), b.name(), c.name(), d.name()]
};

impl Servo {
    /// Refuses what a source asks of the log of a servo and no fit would take; what [`super::any::AnyServo`] declares it reads itself.
    ///
    /// # Errors
    ///
    /// No force per volt; a key or a budget that a log does not have.
    pub fn check_log(source: &Source) -> Result<(), MethodError> {
        if source.methods.iter().any(|method| method == SERVO) {
            return super::any::declared(source).map(drop);
        }
        declared_gain(source, "").map(drop)
    }
}

fn model_of(name: &str) -> Option<AxisModel> {
    AxisModel::ALL.into_iter().find(|model| model.name() == name)
}

/// What moves slowly enough for a rigid axis.
const RIGID: [Need; 1] = [Need::of(&["friction", "dry"], DRIVEN)];
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
        model_of(name).map_or("", AxisModel::words)
    }

    fn needs(&self, name: &str) -> &'static [Need] {
        model_of(name).map_or(&[], needs)
    }

    fn runs(&self) -> &'static str {
        TOW
    }

    fn logs(&self) -> Option<Logs> {
        let told_by = "time, position and command";
        let names = &AxisModel::OF_LOGS;
        Some(Logs { words: "the log of a servo", told_by, is_one: is_servo_log, names, hold_against })
    }

    fn identify(
        &self,
        campaign: &Campaign,
        source: &Source,
        asked: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Found, MethodError> {
        let asked: Vec<AxisModel> = asked.iter().filter_map(|name| model_of(name)).collect();
        if let Some(runs) = runs_of(campaign, source, &KINDS, progress)? {
            progress("identifying the axis");
            let axis = of_runs(&runs, &asked, &named(source, &runs, "servo"))?;
            let found = found(axis, source, &asked, |model| lacking_in(needs(model), &runs))?;
            return Ok(Found { beside: Some(runs.results("servo")), is_part: runs.beside > 0, ..found });
        }
        let (path, sidecar) = (source.input.path(), source.sidecar.as_deref());
        let gain = declared_gain(source, &campaign.key)?;
        if long::is_long(path) {
            progress("identifying the axis from a long log");
            return long::of_table(path, sidecar, (&source.name, source.kind.name()), &gain, &asked);
        }
        progress("identifying the axis");
        found(of_table(path, sidecar, &source.name, &asked, &gain)?, source, &asked, |_| None)
    }
}

/// The constant of a sidecar that is the force per volt, and its name in a budget.
const DRIVE_GAIN: &str = "drive_gain";

/// The force per volt of a log, with the error that the campaign declares of it.
///
/// # Errors
///
/// A sidecar without it; what is asked of rows of a table, which a log does not have; an error of anything else.
fn declared_gain(source: &Source, campaign: &str) -> Result<ForcePerVolt<'static>, MethodError> {
    let n_v = force_per_volt_n_v(source.input.path(), source.sidecar.as_deref())?;
    let refused = |place: &Place, what: String| {
        Err(MethodError::from(IdentifyError::Campaign { place: place.to_string(), what }))
    };
    let of_rows = [
        ("keep", source.keep.is_some()),
        ("group", source.group.is_some()),
        ("actuator", !source.actuator.is_empty()),
        ("tare", source.tare.is_some()),
        ("models", !source.models.is_empty()),
    ];
    if let Some((key, _)) = of_rows.into_iter().find(|(_, is_given)| *is_given) {
        let instead = match key {
            "keep" => "filters need all of its rows: cut the log itself",
            "models" => "name its models by `method`: servo_symmetric, servo_asymmetric",
            _ => "leave it out",
        };
        return refused(
            &source.place,
            format!("`{key}` is for a table of loads, and this is the log of a servo; {instead}"),
        );
    }
    let entry = match source.uncertainty.as_slice() {
        [] => return Ok(ForcePerVolt::of_log(n_v, None)),
        [entry] if entry.quantity == DRIVE_GAIN => entry,
        several => {
            let other = several.iter().find(|entry| entry.quantity != DRIVE_GAIN);
            let what = match other {
                Some(entry) => format!(
                    "quantity = {:?} is not known of the log of a servo; expected {DRIVE_GAIN:?}, its force per volt",
                    entry.quantity
                ),
                None => format!("{DRIVE_GAIN:?} has {} entries; write one, with their sum of squares", several.len()),
            };
            return refused(other.or(several.last()).map_or(&source.place, |entry| &entry.place), what);
        }
    };
    if entry.shared == Shared::Sample {
        let what = "the force per volt of a log is one number: its error is shared; expected shared = \"setup\" or \"campaign\"";
        return refused(&entry.place, what.to_owned());
    }
    if !entry.relative && Some(entry.dimension) != Dimension::FORCE.checked_div(Dimension::VOLTAGE) {
        return refused(
            &entry.place,
            "the standard uncertainty of the force per volt is in per cent or in N/V".to_owned(),
        );
    }
    let relative = if entry.relative { entry.standard } else { entry.standard / n_v.abs() };
    let key = common_key(entry, campaign).unwrap_or_else(|| format!("{OWN}{DRIVE_GAIN}"));
    let name = entry.name.clone().unwrap_or_else(|| "force per volt, declared".to_owned());
    let quantity = DRIVE_GAIN.to_owned();
    Ok(ForcePerVolt::of_log(n_v, Some(Scale { key, name, quantity, relative, dof: entry.dof, errs: Errs::Factor })))
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
            None => findings.extend(lacking(model).map(|why| not_fitted(model.name(), model.words(), &why))),
        }
    }
    if out.is_empty() {
        let what = "none of the requested models can be identified from these runs";
        return Err(nothing_fitted(source, what, &findings));
    }
    Ok(Found { results: out, summary: Some(summary), blocks, findings, ..Found::default() })
}
