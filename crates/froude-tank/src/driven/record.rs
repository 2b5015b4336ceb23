//! A joint fit with a motor-driven body as an estimate, and which of several laws is recommended.

use froude_fit::select::aicc;
use froude_records::campaign::{Campaign, Source};
use froude_records::estimate::{self, Clusters, Diagnostics, Estimate, Range};
use froude_records::run::Role;
use indexmap::IndexMap;

use super::derived::Derived;
use super::fitted::Fitted;
use super::method::MotorDriven;
use super::setup::Setup;
use super::spec::{Channel, Point};
use super::still_page;
use crate::joint::{JointFit, record};

/// Differences of AICc below this do not favour a law.
const ALIKE: f64 = 2.0;

/// AICc of every law, at one effective number of observations: that of the law with the smallest residual. Residuals of a wrong law repeat with the
/// motion and would count as correlation.
///
/// Its coefficients are those found and the zeros of each run; `None` where the observations are too few, or of several loads.
#[must_use]
pub fn criteria<M>(fits: &[(Setup<M>, JointFit)]) -> Vec<Option<f64>> {
    let left = |fit: &JointFit| fit.sigma.first().copied().unwrap_or(f64::NAN);
    let best = fits.iter().map(|(_, fit)| fit).min_by(|a, b| left(a).total_cmp(&left(b)));
    let n = best.map_or(0, |fit| fit.effective.round() as usize);
    let of = |(_, fit): &(Setup<M>, JointFit)| {
        let found = fit.unknowns.iter().filter(|u| u.value.is_some()).count() + fit.fitted.len();
        (fit.sigma.len() == 1).then(|| aicc(n, n as f64 * left(fit).powi(2), found as f64).ok()).flatten()
    };
    fits.iter().map(of).collect()
}

/// The law with the fewest coefficients among those whose criterion lies within 2 of the smallest.
#[must_use]
pub fn chosen<M: MotorDriven>(fits: &[(Setup<M>, JointFit)]) -> usize {
    let criteria = criteria(fits);
    let score = |i: usize| criteria[i].unwrap_or(f64::INFINITY);
    let least = (0..fits.len()).map(score).fold(f64::INFINITY, f64::min);
    let near = |i: &usize| score(*i) <= least + ALIKE;
    (0..fits.len()).filter(near).min_by_key(|&i| fits[i].0.method.coefficients().len()).unwrap_or(0)
}

/// The estimate of one law; `of` is how many laws it was chosen from, where it is the recommended one.
#[must_use]
pub fn estimate<M: MotorDriven>(
    fitted: &Fitted<'_, M>,
    (campaign, source): (&Campaign, &Source),
    of: Option<usize>,
) -> Estimate {
    let (spec, Fitted { fit, setup, derived, .. }) = (M::SPEC, fitted);
    let law = setup.method.law();
    let points: Vec<&Point> = fitted.runs.iter().map(|run| &run.point).collect();
    let coefficients = setup.method.coefficients();
    let is_wanted = |name: &str| coefficients.iter().any(|c| c.name == name && c.is_wanted);
    let dof = fit.parts[0].dof.first().copied().filter(|d| d.is_finite());
    let of_derived = |d: &Derived| {
        let number = estimate::Derived {
            formula: d.formula.to_owned(),
            value: Some(d.value),
            unit: d.unit.to_owned(),
            standard_uncertainty: Some(d.combined.standard),
            interval_95: Some(d.combined.interval(d.value)),
        };
        (d.name.to_owned(), number)
    };
    let reason = of.map(|laws| {
        if laws == 1 {
            spec.only_law.to_owned()
        } else {
            "fewest coefficients of the drag laws whose AICc, at the effective number of observations, lies within 2 of the smallest".to_owned()
        }
    });
    let mut notes = record::notes(fit, spec.loads);
    notes.extend(still_page::notes(setup));
    notes.extend(setup.method.notes(fitted));
    let names: Vec<&str> = fit.unknowns.iter().map(|u| u.name.as_str()).collect();
    let words = record::words(fit, setup.cycles, setup.harmonics, (&spec.motion, spec.loads), &setup.method.held());
    let named = if law == spec.law { String::new() } else { format!(" {law}") };
    Estimate {
        point: setup.method.reference_point(campaign),
        law: setup.method.law_of_record(setup),
        refers_to: setup.method.refers_to(setup, &points),
        n_observations: fit.samples,
        clusters: Some(Clusters::of(fit.by, fit.clusters)),
        dof: spec.loads.iter().map(|load: &Channel| (load.load.to_owned(), dof)).collect(),
        coefficients: record::coefficients(fit, &|name| !is_wanted(name)),
        derived: derived.iter().map(of_derived).collect(),
        type_a: Some(record::type_a(&names, &fit.parts, record::scatter_of(fit))),
        errors: record::errors(&fit.errors, campaign),
        validity: validity(fitted),
        diagnostics: Diagnostics { notes, ..Diagnostics::default() },
        recommended: of.is_some(),
        reason,
        ..record::about((campaign, source), [&format!("{}{named}", spec.name), spec.name], words)
    }
}

/// Where the coefficients are supported: conditions, amplitudes, periods, and the method's numbers.
fn validity<M: MotorDriven>(fitted: &Fitted<'_, M>) -> IndexMap<String, Range> {
    let spec = M::SPEC;
    let mut out: IndexMap<String, Range> = IndexMap::new();
    let mut take = |name: &str, value: f64, unit: &str| {
        out.entry(name.to_owned()).or_insert_with(|| Range::of([value; 2], unit)).include([value; 2]);
    };
    for (run, motion) in fitted.runs.iter().zip(fitted.motions).filter(|(run, _)| run.point.role == Role::Test) {
        for condition in spec.conditions {
            if let Some(value) = run.point.conditions.get(condition.name) {
                take(condition.name, *value, condition.unit);
            }
        }
        let amplitude = motion.angle.amplitude(1);
        take("amplitude", amplitude, spec.motion.unit);
        take("period", motion.angle.period_s(), "s");
        for number in fitted.setup.method.numbers(&run.point, fitted.setup, amplitude, motion.angle.omega_rad_s) {
            if let (Some([name, unit]), Some(value)) = (number.validity, number.value) {
                take(name, value, unit);
            }
        }
    }
    out
}
