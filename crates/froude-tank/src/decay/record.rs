//! A decay test as the record, the rows and the findings that every source gives.

use std::f64::consts::PI;

use froude_records::campaign::{BoundsSpec, Campaign, Identify, Source};
use froude_records::estimate::{
    Clusters, Diagnostics, Estimate, Law, Measured, Range as Stated, ReferencePoint, Status,
};
use froude_records::finding::Finding;
use froude_records::texts::Texts;
use froude_records::units::{Dimension, Unit};
use indexmap::IndexMap;

use super::fit::{DecayFit, HalfCycle};
use super::run::{Known, Restoring};
use crate::findings::warning;
use crate::joint::DeclaredError;
use crate::joint::record::{about, by_part, errors, type_a};
use froude_identify::IdentifyError;
use froude_identify::dataset::Dataset;
use froude_identify::law::ForceLaw;
use froude_identify::record::coefficient;
use froude_identify::regression::{ModelFit, Settings, regress};
use froude_identify::selection::{Recommendation, leave_one_out};
use froude_identify::source::SourceResult;

/// The law of a record per moving inertia: q̈ = −ω² (q − q₀) − d_I q̇ − d_II q̇|q̇|, which gives no load.
const RATES: &str = "linear_quadratic_per_inertia";

/// The law of the record.
pub(super) const LAW: &str = "added_mass_linear_quadratic";

/// Load and velocity along or about the axis, by its letters.
fn channels(fit: &DecayFit) -> (String, String) {
    let letters = fit.axis.letters();
    let (load, velocity) = match letters.strip_prefix('r') {
        Some(axis) => (format!("m_{axis}"), format!("w_{axis}")),
        None => (format!("f_{letters}"), format!("v_{letters}")),
    };
    // Per moving inertia the load is an acceleration.
    if fit.restoring.is_per_inertia() { (format!("{velocity}_dot"), velocity) } else { (load, velocity) }
}

/// Everything about a source that one method found.
///
/// # Errors
///
/// Numbers that leave what a computer holds.
pub fn result(
    fit: &DecayFit,
    campaign: &Campaign,
    source: &Source,
    is_recommended: bool,
) -> Result<SourceResult, IdentifyError> {
    let data = rows(fit);
    let model = drawn(fit, &data, source)?;
    let estimate = estimate(fit, campaign, source, is_recommended);
    Ok(SourceResult {
        name: format!("{}, {}", source.name, fit.method.name()),
        kind: source.kind,
        n_read: fit.rows.len(),
        not_fitted: Vec::new(),
        tests: Vec::new(),
        scores: vec![leave_one_out(&model, &data)],
        blocks: Vec::new(),
        recommendation: Some(Recommendation {
            index: 0,
            not_contradicted: Vec::new(),
            reason: fit.method.words().to_owned(),
        }),
        validity: estimate.validity.clone(),
        findings: fit.findings.iter().cloned().chain(as_exact(fit)).collect(),
        files: Vec::new(),
        models: vec![model],
        estimates: vec![estimate],
        data,
    })
}

/// What nobody declared an uncertainty of counts as exact.
fn as_exact(fit: &DecayFit) -> Vec<Finding> {
    let restoring = fit.restoring.parts().into_iter().map(|(name, number, _)| (name, number));
    let inertia = (!fit.restoring.is_per_inertia()).then_some(("inertia", fit.inertia));
    let known = match fit.restoring {
        Restoring::PerInertia { known, .. } => known.map(Known::named),
        _ => None,
    };
    let all = inertia.into_iter().chain(restoring).chain(known);
    let exact = all.filter(|(_, number)| number.standard == 0.0);
    let said = |(name, _)| {
        let text = format!(
            "the {name} is declared without a standard uncertainty and counts as exact: write {name} = {{ value = …, standard = \"0.5 %\" }}"
        );
        warning("declared-as-exact", text)
    };
    exact.map(said).collect()
}

/// Half cycles as observations: amplitude of the damping force over that of the speed.
fn rows(fit: &DecayFit) -> Dataset {
    let (load, velocity) = channels(fit);
    let of = |value: &dyn Fn(&HalfCycle) -> f64| fit.rows.iter().map(value).collect::<Vec<f64>>();
    let n = fit.rows.len();
    let mut data = Dataset {
        rows: n,
        configuration: Texts::repeated("", n),
        setup: Texts::repeated("", n),
        run: fit.rows.iter().map(|row| row.run.clone()).collect(),
        line: (1..=n).collect(),
        ..Dataset::default()
    };
    let is_rotation = fit.axis.is_rotation();
    let [position, speed, force, acceleration] = if is_rotation {
        [Dimension::ANGLE, Dimension::ANGULAR_SPEED, Dimension::MOMENT, Dimension::ANGULAR_ACCELERATION]
    } else {
        [Dimension::LENGTH, Dimension::SPEED, Dimension::FORCE, Dimension::ACCELERATION]
    };
    let force = if fit.restoring.is_per_inertia() { acceleration } else { force };
    data.put("amplitude", of(&|row| row.amplitude), position);
    data.put(&velocity, of(&|row| row.speed_amplitude), speed);
    data.put(&load, of(&|row| -row.force_amplitude), force);
    data
}

/// The law of amplitudes, F = D_I u + (8/3π) D_II u|u|, with the coefficients held at those found: for points, line and residuals of the page.
fn drawn(fit: &DecayFit, data: &Dataset, source: &Source) -> Result<ModelFit, IdentifyError> {
    let (load, velocity) = channels(fit);
    let [_, linear, quadratic] = &fit.names;
    let text = format!("-{linear}*{velocity} - {}*{quadratic}*{velocity}*abs({velocity})", 8.0 / (3.0 * PI));
    let law = ForceLaw::formulas("damping of amplitudes", &IndexMap::from([(load, text)]), data)?;
    let fixed = [(linear.clone(), fit.values[1]), (quadratic.clone(), fit.values[2])].into_iter().collect();
    let identify = Identify { fixed, bounds: BoundsSpec::default(), ..Identify::default() };
    regress(&law, data, Settings::new(&source.name, source.kind, &identify))
}

fn estimate(fit: &DecayFit, campaign: &Campaign, source: &Source, recommended: bool) -> Estimate {
    let (load, velocity) = channels(fit);
    let [added, linear, quadratic] = &fit.names;
    let units = fit.units();
    let coefficients = (0..3).map(|j| {
        let found = coefficient(Some(fit.values[j]), units[j], Status::Free, fit.combined(j));
        (fit.names[j].clone(), found)
    });
    let [force, speed, acceleration] = if fit.axis.is_rotation() {
        [Dimension::MOMENT, Dimension::ANGULAR_SPEED, Dimension::ANGULAR_ACCELERATION]
    } else {
        [Dimension::FORCE, Dimension::SPEED, Dimension::ACCELERATION]
    }
    .map(|dimension| Unit::si(dimension).text);
    let formula = format!("-{added}*{velocity}_dot - {linear}*{velocity} - {quadratic}*{velocity}*abs({velocity})");
    let named: Vec<(&str, &str)> = fit.names.iter().map(String::as_str).zip(units).collect();
    let budget = fit.budget();
    let notes = by_part(&budget, &named, 3);
    let is_rotation = fit.axis.is_rotation();
    let [inertia, stiffness] = if is_rotation { ["kg*m^2", "N*m"] } else { ["kg", "N/m"] };
    let constants = [
        ("inertia", Measured::of(fit.inertia.value, inertia)),
        ("stiffness", Measured::of(fit.restoring.stiffness(), stiffness)),
    ];
    let law = if fit.restoring.is_per_inertia() {
        Law::of(RATES, [(velocity, speed)])
    } else {
        let inputs = [(velocity.clone(), speed), (format!("{velocity}_dot"), acceleration)];
        let law = Law::of(LAW, inputs).giving(&load, force, Some(formula));
        Law { constants: constants.into_iter().map(|(name, of)| (name.to_owned(), of)).collect(), ..law }
    };
    let names = fit.names.each_ref().map(String::as_str);
    let type_a = fit.type_a.as_ref().map(|a| type_a(&names, &budget, a.kind.clone()));
    let declared: Vec<DeclaredError> = fit.errors.iter().filter(|error| error.standard > 0.0).cloned().collect();
    let method = fit.method.name();
    let about = about((campaign, source), [method, method], fit.method.words().to_owned());
    Estimate {
        // A rotation is about its own axis, wherever the body's reference point is.
        point: if is_rotation {
            ReferencePoint { words: "the axis that it turned about".to_owned(), stated: false }
        } else {
            about.point.clone()
        },
        law,
        derived: fit.derived(),
        n_observations: fit.rows.len(),
        clusters: Some(Clusters::of("run", fit.runs.len())),
        dof: type_a.iter().map(|a| (load.clone(), a.dof[1])).collect(),
        coefficients: coefficients.collect(),
        errors: type_a.as_ref().map(|_| errors(&declared, campaign)).unwrap_or_default(),
        type_a,
        validity: IndexMap::from([
            ("speed".to_owned(), Stated::of(fit.range.speed, if fit.axis.is_rotation() { "rad/s" } else { "m/s" })),
            ("amplitude".to_owned(), Stated::of(fit.range.amplitude, fit.axis.position_unit())),
            ("period".to_owned(), Stated::of([fit.range.period_s; 2], "s")),
        ]),
        diagnostics: Diagnostics { notes, ..Diagnostics::default() },
        recommended,
        reason: recommended.then(|| fit.method.words().to_owned()),
        ..about
    }
}
