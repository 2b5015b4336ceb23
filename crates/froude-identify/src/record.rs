//! A fitted law as an estimate record.

use froude_fit as fit;
use froude_fit::budget::{Combined, Kind as Evaluation, Part};
use froude_fit::distribution::coverage_factor;
use froude_fit::faer::Mat;
use froude_records::estimate::{
    Clusters, Coefficient, Derived, Diagnostics, ErrorKind, Estimate, Interval, Law, Measured, MethodUsed, OWN,
    RunScatter, SharedError, Status, TypeA,
};
use froude_records::number::finite;
use indexmap::IndexMap;

use crate::dataset::{Dataset, unit_text};
use crate::error::IdentifyError;
use crate::law::{Kind, REFERENCE_SPEED_M_S, dimension_of, geometry_of};
use crate::named::primes;
use crate::regression::{ModelFit, Scatter};
use crate::seam::reduced::{self, Choice, Reduced};
use crate::selection::Recommendation;

/// Part of an uncertainty below which another is the rounding of numbers that cancel.
const ROUNDING: f64 = 1e-12;
/// Relative difference of two regressors that are one.
const SAME_REGRESSOR: f64 = 1e-9;

/// The record of one fitted model; `chosen` says why the data recommend it, where they do.
#[must_use]
pub fn estimate(model: &ModelFit, of: &Reduced, diagnostics: Diagnostics, chosen: Option<&Recommendation>) -> Estimate {
    let Reduced { data, stated, .. } = of;
    let mut constants = IndexMap::new();
    let mut refers_to = IndexMap::new();
    if let Some(d) = data.values("density") {
        let value = d.iter().sum::<f64>() / d.len() as f64;
        refers_to.insert("density".to_owned(), Measured::of(value, "kg/m^3"));
    }
    if let Some(nu) =
        data.values("kinematic_viscosity").filter(|_| model.law.channels().contains(&"kinematic_viscosity"))
    {
        let value = nu.iter().sum::<f64>() / nu.len() as f64;
        refers_to.insert("kinematic_viscosity".to_owned(), Measured::of(value, "m^2/s"));
    }
    match &model.law.kind {
        Kind::Drag { body, .. } => {
            constants.insert("v_ref".to_owned(), Measured::of(REFERENCE_SPEED_M_S, "m/s"));
            refers_to.extend(geometry_of(body));
        }
        Kind::PowerLaw { .. } => {
            constants.insert("U_ref".to_owned(), Measured::of(REFERENCE_SPEED_M_S, "m/s"));
        }
        Kind::Thruster { .. } => {}
        Kind::Formulas(_) => constants.extend(
            model
                .law
                .constants()
                .into_iter()
                .map(|(name, value, dim)| (name, Measured::of(value, dimension_of(dim).to_string()))),
        ),
    }
    constants.extend(stated.constants.clone());
    refers_to.extend(stated.refers_to.clone());
    let length = stated.refers_to.get("length").filter(|_| model.law.named.is_some());
    let (primes, speed) = length.map_or_else(Default::default, |length| primes(&model.law, data, length.value));
    refers_to.extend(speed.map(|speed| ("speed".to_owned(), Measured::of(speed, "m/s"))));
    let name = match of.choice {
        Choice::Selection => &model.law.name,
        Choice::Method(_) => &stated.method,
    };
    let coefficients = coefficients(model, &stated.labels);
    let type_a = type_a(model);
    let (dof, sigma) = scatter_by_load(model, data, type_a.as_ref());
    Estimate {
        id: format!("{}/{name}", of.source),
        source: of.source.clone(),
        kind: of.kind.name().to_owned(),
        method: MethodUsed::of(&stated.method, stated.words.clone().unwrap_or_else(|| method(model, data))),
        frame: stated.frame.clone(),
        point: stated.point.clone(),
        attitude: stated.attitude.clone(),
        law: law(model, data, constants),
        refers_to,
        clusters: clusters(model, data),
        dof,
        sigma,
        run_scatter: run_scatter(model, data),
        n_observations: data.observations(),
        derived: stated.derived.iter().chain(&primes).filter_map(|d| derived(d, &coefficients, of.looks)).collect(),
        coefficients,
        type_a,
        errors: errors(model),
        interval: Interval { looks: of.looks, ..Interval::default() },
        undetermined: combinations(model),
        validity: of.validity.clone(),
        diagnostics,
        recommended: chosen.is_some(),
        reason: chosen.map(|r| r.reason.clone()),
        ..Estimate::default()
    }
}

/// States in each record of a source which laws the data do not contradict, and the range of each coefficient: the envelope of its intervals in all of these laws that contain it.
///
/// A law contains a coefficient of another one where one of the same name has the same regressors. What a law holds at a value has no part in the range; where one of them has no interval for
/// another reason there is no range.
///
/// # Errors
///
/// A channel that one of the laws reads and the data lack.
pub(crate) fn with_ranges(
    estimates: &mut [Estimate],
    models: &[ModelFit],
    data: &Dataset,
    not_contradicted: &[usize],
) -> Result<(), IdentifyError> {
    let ids: Vec<String> = not_contradicted.iter().map(|i| estimates[*i].id.clone()).collect();
    let mut terms: Vec<(usize, &str, Vec<(&String, Vec<f64>)>)> = Vec::new();
    for &i in not_contradicted {
        let law = &models[i].law;
        let slopes = law.regressors(data, models[i].law_coefficients())?;
        for (j, c) in law.coefficients.iter().enumerate() {
            let of = |r: usize| (0..data.rows).map(|k| slopes[(r * data.rows + k, j)]).collect::<Vec<f64>>();
            let by_load = law.responses.iter().enumerate().map(|(r, load)| (load, of(r)));
            terms.push((i, &c.name, by_load.filter(|(_, x)| x.iter().any(|x| *x != 0.0)).collect()));
        }
    }
    let is_held = |c: &Coefficient| matches!(c.status, Status::Fixed | Status::Excluded);
    let close = |(x, y): (&f64, &f64)| (x - y).abs() <= SAME_REGRESSOR * x.abs();
    let same = |a: &[(&String, Vec<f64>)], b: &[(&String, Vec<f64>)]| {
        a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.0 == b.0 && a.1.iter().zip(&b.1).all(close))
    };
    let mut ranges = Vec::new();
    for (i, name, own) in &terms {
        let alike = terms.iter().filter(|(_, other, columns)| other == name && same(own, columns));
        let alike = alike.map(|(k, ..)| &estimates[*k].coefficients[*name]).filter(|c| !is_held(c));
        let hull = |a: [f64; 2], b: [f64; 2]| [a[0].min(b[0]), a[1].max(b[1])];
        let range = alike.map(|c| c.interval_95).reduce(|a, b| a.zip(b).map(|(a, b)| hull(a, b)));
        ranges.push((*i, (*name).to_owned(), range.flatten()));
    }
    for (i, name, range) in ranges {
        let c = &mut estimates[i].coefficients[&name];
        c.range_95 = range.filter(|_| !is_held(c));
    }
    for estimate in estimates {
        estimate.not_contradicted.clone_from(&ids);
    }
    Ok(())
}

/// Degrees of freedom and σ of each load. Replicates hold more than the residuals of the rows, and rows that are correlated are worth fewer: they have degrees of
/// freedom, and no σ of a row.
fn scatter_by_load(
    model: &ModelFit,
    data: &Dataset,
    type_a: Option<&TypeA>,
) -> (IndexMap<String, Option<f64>>, IndexMap<String, Measured>) {
    let loads = &model.fit.components;
    if let Scatter::Replicates { .. } | Scatter::Serial(_) = model.scatter {
        let fewest = type_a.and_then(|a| a.dof.iter().copied().flatten().reduce(f64::min));
        return (loads.iter().map(|c| (c.name.clone(), fewest)).collect(), IndexMap::new());
    }
    let in_logarithms = model.law.in_logarithms();
    // What a single row scatters by about the law at what was read, errors of that included: the σ of the regression in variables is without them.
    // Loads share the coefficients of a law evenly, as far as is known here.
    let of_each = model.law.coefficients.len() as f64 / loads.len().max(1) as f64;
    let of_residuals = (data.rows as f64 - of_each).max(1.0);
    let of_rows = |r: usize, c: &fit::ComponentSummary| {
        if model.in_variables {
            Some((c.rss / of_residuals).sqrt()).filter(|s| s.is_finite())
        } else {
            model.sigma_of_rows(r)
        }
    };
    let dof = |c: &fit::ComponentSummary| if model.in_variables { of_residuals } else { c.dof };
    let sigma = |(r, c): (usize, &fit::ComponentSummary)| {
        let unit = if in_logarithms { "1".to_owned() } else { unit_text(data, &c.name) };
        of_rows(r, c).map(|value| (c.name.clone(), Measured::of(value, unit)))
    };
    let dof = loads.iter().map(|c| (c.name.clone(), Some(dof(c)))).collect();
    (dof, loads.iter().enumerate().filter_map(sigma).collect())
}

/// Scatter of rows that are runs, by load.
fn run_scatter(model: &ModelFit, data: &Dataset) -> IndexMap<String, RunScatter> {
    let sizes = model.run_scatter(data).unwrap_or_default();
    let of = |(load, [constant, part, dof]): (&fit::ComponentSummary, [f64; 3])| {
        let constant = Measured::of(constant, unit_text(data, &load.name));
        (load.name.clone(), RunScatter { constant, part, dof: finite(Some(dof)) })
    };
    model.fit.components.iter().zip(sizes).map(of).collect()
}

/// A coefficient times a factor; each arm of the interval in quadrature with that of the factor, which pays for the looks too.
fn derived(
    d: &reduced::Derived,
    coefficients: &IndexMap<String, Coefficient>,
    looks: usize,
) -> Option<(String, Derived)> {
    let c = coefficients.get(&d.of)?;
    let value = c.value.map(|x| x * d.factor);
    let of_factor = value.map_or(0.0, |x| (x * d.factor_relative).abs());
    let k = coverage_factor(1.0 - 0.05 / looks.max(1) as f64, f64::INFINITY);
    let widened = |end: f64| match value {
        Some(x) if of_factor > 0.0 => x + (end - x).hypot(k * of_factor).copysign(end - x),
        _ => end,
    };
    let number = Derived {
        standard_uncertainty: c.standard_uncertainty.map(|u| (u * d.factor).hypot(of_factor)),
        interval_95: c.interval_95.map(|ends| ends.map(|x| widened(x * d.factor))),
        ..Derived::of(&d.formula, value, &d.unit)
    };
    Some((d.name.clone(), number))
}

fn method(model: &ModelFit, data: &Dataset) -> String {
    let is_weighted = model.is_weighted();
    let base = if model.law.in_logarithms() {
        if is_weighted { "least squares of logarithms" } else { "least squares of logarithms (equal relative errors)" }
    } else if model.law.is_nonlinear() {
        if is_weighted {
            "non-linear least squares (Gauss–Newton)"
        } else {
            "non-linear least squares (Gauss–Newton, equal absolute errors)"
        }
    } else {
        "linear least squares by orthogonal factorisation"
    };
    let mut out = base.to_owned();
    if model.in_variables {
        "orthogonal distance regression: what the law reads is uncertain too (σ by restricted maximum likelihood)"
            .clone_into(&mut out);
    }
    if model.options.bounds.iter().any(|b| b.lower == 0.0) {
        out += ", non-negative";
    }
    if !model.options.inequalities.is_empty() {
        out += ", under the constraint that it delivers no power";
    }
    if !model.options.priors.is_empty() {
        out += ", with published values as prior";
    }
    if model.is_weighted() {
        let has_std = model.law.responses.iter().any(|load| data.values(&format!("std_{load}")).is_some());
        out += if has_std { ", weighted by the table's standard deviations" } else { ", weighted by the fitted loads" };
    }
    if model.specs.len() > model.law.coefficients.len() {
        out += ", with an angle offset per setup";
    }
    out
}

fn coefficients(model: &ModelFit, labels: &IndexMap<String, String>) -> IndexMap<String, Coefficient> {
    model
        .specs
        .iter()
        .enumerate()
        .map(|(j, spec)| {
            let fitted = &model.fit.coefficients[j];
            let is_refused = model.is_refused(j);
            let combined = model.combined[j];
            // The interval is the unconstrained one, widened by the budget, cut by the bounds.
            // That of a known coefficient is its own.
            let centre = fitted.unconstrained.or(fitted.value.filter(|_| fitted.status == fit::Status::Fixed));
            let interval_95 = match (combined, centre) {
                (Some(c), Some(u)) => {
                    let [low, high] = c.interval(u);
                    let bound = model.options.bounds.get(j).copied().unwrap_or(fit::Bound::FREE);
                    let within = |x: f64| x.max(bound.lower).min(bound.upper);
                    Some([within(low), within(high)])
                }
                _ => None,
            };
            let is_contradicted = model.contradicted_bound(j).is_some();
            let status = match status(fitted.status) {
                _ if is_contradicted => Status::BoundContradicted,
                Status::BoundContradicted => Status::AtBound,
                other => other,
            };
            let interval_95 = interval_95.filter(|_| !is_contradicted && !is_refused && !model.is_moved_out(j));
            let of_record = Coefficient {
                label: labels.get(&spec.name).cloned(),
                nuisance: j >= model.law.coefficients.len(),
                unconstrained: apart(fitted.unconstrained, fitted.value, combined.map(|c| c.standard)),
                interval_95,
                ..coefficient(fitted.value.map(|_| model.coefficients[j]), &spec.unit, status, combined)
            };
            (spec.name.clone(), of_record)
        })
        .collect()
}

/// A coefficient as a record has it, with the interval about its value.
#[must_use]
pub fn coefficient(value: Option<f64>, unit: &str, status: Status, combined: Option<Combined>) -> Coefficient {
    Coefficient {
        standard_uncertainty: combined.map(|c| c.standard),
        type_a: combined.map(|c| c.type_a),
        type_b: combined.map(|c| if c.type_b > ROUNDING * c.standard { c.type_b } else { 0.0 }),
        interval_95: value.zip(combined).map(|(value, c)| c.interval(value)),
        effective_dof: finite(combined.map(|c| c.dof)),
        ..Coefficient::of(value, unit, status)
    }
}

/// What became of a coefficient in a fit, as a record says it.
#[must_use]
pub fn status(found: fit::Status) -> Status {
    match found {
        fit::Status::Free => Status::Free,
        fit::Status::AtBound => Status::AtBound,
        fit::Status::Fixed => Status::Fixed,
        fit::Status::Excluded => Status::Excluded,
        fit::Status::Prior => Status::Prior,
        fit::Status::Undetermined => Status::Undetermined,
        fit::Status::BoundContradicted => Status::BoundContradicted,
    }
}

/// An estimate without bounds where it is another than the one within them, by more than rounding.
fn apart(unconstrained: Option<f64>, value: Option<f64>, standard: Option<f64>) -> Option<f64> {
    let (u, v) = (unconstrained?, value?);
    ((u - v).abs() > 1e-9 * standard?).then_some(u)
}

/// The law with the motion that it reads and the loads that it gives.
fn law(model: &ModelFit, data: &Dataset, constants: IndexMap<String, Measured>) -> Law {
    let inputs = model.law.channels().into_iter().map(|name| (name, unit_text(data, name)));
    let giving = |law: Law, (i, load): (usize, &String)| {
        // A text may call its load by a ship theorist's letter.
        let formula = model.law.texts.get_index(i).map(|(_, text)| text.clone());
        law.giving(load, unit_text(data, load), formula)
    };
    let law = Law { constants, ..Law::of(&model.law.name, inputs) };
    model.law.responses.iter().enumerate().fold(law, giving)
}

/// The independent groups behind a scatter that counts them.
fn clusters(model: &ModelFit, data: &Dataset) -> Option<Clusters> {
    match &model.scatter {
        Scatter::Classical | Scatter::Runs | Scatter::Hc3 | Scatter::Serial(_) => None,
        Scatter::Cluster => data.group.as_ref().map(|_| Clusters::of(data.grouped_by.word(), data.clusters())),
        Scatter::Replicates { sets, .. } => sets.first().map(|set| Clusters::of(set.left_out, set.without.len())),
    }
}

/// The coefficients that have an uncertainty.
fn known(model: &ModelFit) -> Vec<usize> {
    (0..model.specs.len()).filter(|&j| model.combined[j].is_some()).collect()
}

fn square(of: &Mat<f64>, there: &[usize]) -> Vec<Vec<f64>> {
    there.iter().map(|&a| there.iter().map(|&b| of[(a, b)]).collect()).collect()
}

/// Covariance from the scatter over the coefficients that have an uncertainty.
fn type_a(model: &ModelFit) -> Option<TypeA> {
    let there = known(model);
    let scatter = model.budget.iter().find(|part| part.kind == Evaluation::A)?;
    (!there.is_empty()).then(|| {
        let names = there.iter().map(|&j| model.specs[j].name.clone()).collect();
        let dof: Vec<f64> = there.iter().map(|&j| scatter.dof[j]).collect();
        TypeA::of(names, square(&scatter.covariance, &there), &dof, &model.covariance_kind)
    })
}

/// All other errors that are added, by key. One that no other estimate can have is written by what it does to the coefficients, under a key of its own.
fn errors(model: &ModelFit) -> IndexMap<String, SharedError> {
    let there = known(model);
    let is_felt = |part: &&Part| there.iter().any(|&j| part.covariance[(j, j)] > 0.0);
    let added = model.budget.iter().filter(|part| part.kind.is_type_b() && !part.in_scatter).filter(is_felt);
    let mut out: IndexMap<String, SharedError> = IndexMap::new();
    for part in added {
        let (key, error) = match &part.origin {
            Some(origin) => {
                let q = origin.covariance.nrows();
                let row = |j: usize| (0..q).map(|k| origin.sensitivity[(j, k)]).collect();
                let error = SharedError {
                    name: part.name.clone(),
                    quantity: origin.quantity.clone(),
                    kind: evaluated(part),
                    covariance: square(&origin.covariance, &(0..q).collect::<Vec<_>>()),
                    dof: finite(part.dof.first().copied()),
                    limits: origin.limits,
                    sensitivity: there.iter().map(|&j| row(j)).collect(),
                };
                (origin.key.clone(), error)
            }
            None => (format!("{OWN}{}", part.name), alone(part, &there)),
        };
        let mut unique = key.clone();
        for k in 2.. {
            if !out.contains_key(&unique) {
                break;
            }
            unique = format!("{OWN}{}, {k}", key.trim_start_matches(OWN));
        }
        out.insert(unique, error);
    }
    out
}

/// An error of one estimate alone: what it does to the coefficients, the coefficients being the error's components.
fn alone(part: &Part, there: &[usize]) -> SharedError {
    let one = |a: usize, b: usize| if a == b { 1.0 } else { 0.0 };
    let limits = match (&part.shape, there) {
        (fit::budget::Shape::Between(limits), [j]) => Some(limits[*j]),
        _ => None,
    };
    SharedError {
        name: part.name.clone(),
        quantity: String::new(),
        kind: evaluated(part),
        covariance: square(&part.covariance, there),
        dof: finite(part.dof.first().copied()),
        limits,
        sensitivity: there.iter().map(|&a| there.iter().map(|&b| one(a, b)).collect()).collect(),
    }
}

/// How a part of type B was evaluated, as the record says it.
fn evaluated(part: &Part) -> ErrorKind {
    match part.kind {
        Evaluation::A | Evaluation::B => ErrorKind::B,
        Evaluation::Numerical => ErrorKind::Numerical,
        Evaluation::Input => ErrorKind::Input,
        Evaluation::ModelForm => ErrorKind::ModelForm,
    }
}

/// The determined combinations of undetermined coefficients, named by their physical factors where these explain them.
#[must_use]
pub fn combinations(model: &ModelFit) -> Vec<String> {
    let symbols = model.law.factor_symbols();
    model
        .fit
        .undetermined
        .iter()
        .map(|combination| {
            let terms: Vec<String> = combination
                .weights
                .iter()
                .map(|&(j, w)| {
                    let name = &model.specs[j].name;
                    match &symbols {
                        Some(symbols) => format!("{}*{name}", symbols[j]),
                        None => format!("{w:.6}*{name}"),
                    }
                })
                .collect();
            terms.join(" + ").replace("+ -", "- ")
        })
        .collect()
}
