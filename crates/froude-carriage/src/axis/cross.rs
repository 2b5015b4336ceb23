//! Rigid models of an axis on a log that they were not fitted to: the error that no interval of one excitation tells.
//!
//! Residuals of one log hold what this motion leaves over of friction that is not modelled; another motion leaves something else, and its coefficients differ by more
//! than either interval. The cross force error ‖F − F̂‖/‖F‖ takes F from the command of the other log by its own force per volt, and F̂ from its motion by the
//! coefficients of the first.
//!
//! Source: Janot, Gautier & Brunot 2019 (the measure).

use froude_identify::method::MethodError;
use froude_records::block::{Section, TableBuilder};
use froude_records::campaign::Source;
use froude_records::estimate::Estimate;
use froude_records::finding::{Finding, Severity};
use froude_records::number;

use super::{AxisModel, force_per_volt_n_v, friction_of, read_log};
use crate::servo::{Chain, Delay, ServoError};

/// The error of one model.
struct Cross {
    id: String,
    /// On the rows that it was fitted to.
    own: Option<f64>,
    /// On the rows of the other log.
    other: f64,
}

/// Rigid models held against the log of a source: a note for each in the record, and a section of the page. Estimates of other methods are left out.
///
/// # Errors
///
/// A log that cannot be read, has no force per volt, or moves too little for rows; no rigid model among the estimates.
pub(super) fn hold_against(source: &Source, estimates: &[&Estimate]) -> Result<(Vec<Finding>, Section), MethodError> {
    let (path, sidecar, name) = (source.input.path(), source.sidecar.as_deref(), &source.name);
    let (imported, log) = read_log(path, sidecar)?;
    let refused = |error: ServoError| MethodError::input(path, error.to_string());
    let rate_hz = log.evenly().map_err(refused)?.rate_hz;
    let force_per_volt_n_v = force_per_volt_n_v(path, sidecar)?;
    let mut found = Vec::new();
    for estimate in estimates {
        let model = AxisModel::ALL.into_iter().find(|model| model.name() == estimate.method.name);
        let Some(model) = model.filter(|model| AxisModel::OF_LOGS.contains(&model.name())) else { continue };
        let usual = Chain::of_log(force_per_volt_n_v, rate_hz, friction_of(model));
        let fitted = estimate.derived.get("delay").and_then(|delay| delay.value);
        let delay = Delay { at_s: fitted.unwrap_or(usual.delay.at_s), is_estimated: false, changes: Vec::new() };
        let chain = Chain { delay, ..usual };
        let rows = chain.rows(&log).map_err(refused)?;
        // Of a rig the friction may have no offset.
        let value = |label: &str| {
            let is_of =
                |(key, c): &(&String, &froude_records::estimate::Coefficient)| c.label.as_ref().unwrap_or(key) == label;
            estimate.coefficients.iter().find(is_of).and_then(|(_, c)| c.value).unwrap_or(0.0)
        };
        let values: Vec<f64> = rows.names.iter().map(|(label, _)| value(label)).collect();
        let own = estimate.diagnostics.relative_residual.values().next().copied();
        let other = rows.relative_error(&values);
        if !other.is_finite() {
            return Err(MethodError::input(
                path,
                "its command is zero all the time, so that a force error has no measure",
            ));
        }
        found.push(Cross { id: estimate.id.clone(), own, other });
    }
    if found.is_empty() {
        let what = "is the log of a servo, and none of the estimates is a rigid model of one: servo_symmetric or servo_asymmetric";
        return Err(MethodError::input(path, what));
    }
    let findings = found.iter().map(|cross| {
        let own = cross.own.map_or_else(String::new, |own| format!(", {} where it was fitted", number::percent(own)));
        let text = format!("{}: cross force error {} on {name}{own}", cross.id, number::percent(cross.other));
        Finding::new(Severity::Note, "cross-force-error", text)
    });
    let findings = imported.findings.into_iter().chain(findings).collect();
    let caption = format!("Force error ‖F − F̂‖/‖F‖ on {name}, which no model was fitted to. F is that of its command.");
    let t = TableBuilder::new("cross_force_errors", caption, &found);
    let table = t.build(vec![
        t.text("estimate", "estimate", |cross| cross.id.clone()),
        t.number("own", "where it was fitted", |cross| cross.own).percent(),
        t.number("cross", "cross force error", |cross| cross.other).percent(),
    ]);
    Ok((findings, Section::new(format!("{name}: validation against the fits"), [table.into()])))
}
