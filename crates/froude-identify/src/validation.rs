//! Computed numbers beside measured ones, by ASME V&V 20.
//!
//! With the computed S and the measured D of one quantity, E = S − D = δ_model + δ_num + δ_input − δ_D. The error of the model therefore lies in
//! E ± k·u_val with u_val² = u_num² + u_input² + u_D², and is known no better. Where |E| exceeds 2 u_val it is E, in size and sign; where it
//! does not, the comparison is too coarse to see it. What was declared for the form of the model is no part of u_val: it is what E is to show.
//!
//! A coefficient is fitted to S, so that the scatter about the law, u_fit, belongs to u_val too; it is compared where S was fitted to no other angles than D.
//! A load is compared in each computed flow that lies in the range of the measured law: S is the computed load itself, D what the law gives there. A law
//! that states no range of speed is not compared. An error that both sides name by one key is counted on both, as if they were two.
//!
//! Source: ASME V&V 20-2009, 1-5 and 6-1.

use froude_fit::faer::Mat;
use froude_records::campaign::BudgetEntry;
use froude_records::comparison::Validation;
use froude_records::estimate::{ErrorKind, Estimate, Status, beside};

use crate::compare::Named;
use crate::dataset::{Dataset, unit_text};
use crate::error::IdentifyError;
use crate::law::ForceLaw;
use crate::regression::ModelFit;
use crate::result::SourceResult;
use crate::uncertainty::{Linearised, direction};

/// Start of the name of the column with the standard numerical uncertainty of a load, row by row.
pub const STD_NUMERICAL: &str = "std_numerical_";
/// The same of what is left of the iterations alone, which counts where the mesh's error is not known.
pub const STD_ITERATIVE: &str = "std_iterative_";
/// Angles no further apart are the same.
const SAME_ANGLE_RAD: f64 = 0.02;
/// Beyond the end of a range by rounding.
const ROUNDING: f64 = 1e-9;
/// Standard uncertainties within which E says nothing of the model.
const COVERAGE: f64 = 2.0;

/// A source of computed observations with the errors that its campaign declares.
#[derive(Debug, Clone, Copy)]
pub struct Simulation<'a> {
    /// What was fitted to it.
    pub result: &'a SourceResult,
    /// Its `[[source.uncertainty]]`.
    pub budget: &'a [BudgetEntry],
}

/// What a comparison with measurements came to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Validated {
    /// Coefficients, and loads over all flows.
    pub numbers: Vec<Validation>,
    /// Loads flow by flow.
    pub flows: Vec<ComparedFlow>,
    /// Ids of measured estimates that state no range of speed.
    pub without_range: Vec<String>,
}

/// A load in one flow.
#[derive(Debug, Clone, PartialEq)]
pub struct ComparedFlow {
    /// Id of the measured estimate.
    pub data: String,
    /// Name of the load.
    pub load: String,
    /// Its unit, and that of all numbers here.
    pub unit: String,
    /// Row of the computed observations.
    pub row: usize,
    /// S.
    pub computed: f64,
    /// D.
    pub measured: f64,
    /// Standard uncertainty of S from mesh and iterations.
    pub u_numerical: f64,
    /// From what went into the computation.
    pub u_input: f64,
    /// Standard uncertainty of D, where its record states one.
    pub u_data: Option<f64>,
    /// What was declared for the form of the model.
    pub declared_model_form: f64,
}

impl ComparedFlow {
    /// Standard uncertainty of everything in E but the error of the model.
    #[must_use]
    pub fn u_validation(&self) -> f64 {
        root_of_squares(&[self.u_numerical, self.u_input, self.u_data.unwrap_or(0.0)])
    }

    /// E = S − D.
    #[must_use]
    pub fn error(&self) -> f64 {
        self.computed - self.measured
    }
}

/// Every coefficient that the computed source and a measured one have in a common law, and every load that the computation and a measured source's law give.
///
/// That law is the recommended one of the measured source; where none is, as of published sets, the one with most coefficients, which follows its observations best.
///
/// # Errors
///
/// A quantity of the budget that is no channel of the observations.
pub fn validate(simulation: Simulation<'_>, measured: &[Named<'_>]) -> Result<Validated, IdentifyError> {
    let mut out = Validated::default();
    let result = simulation.result;
    for computed in &result.estimates {
        let is_alike = |named: &&Named<'_>| {
            named.estimate.law.name == computed.law.name && is_of_its_angles(computed, named.estimate)
        };
        let of_law = measured.iter().filter(is_alike);
        out.numbers.extend(of_law.flat_map(|named| coefficients(computed, named.estimate)));
    }
    let recommended = result.estimates.iter().position(|estimate| estimate.recommended).unwrap_or(0);
    let (Some(computed), Some(model)) = (result.estimates.get(recommended), result.models.get(recommended)) else {
        return Ok(out);
    };
    for named in laws(measured) {
        let data = named.estimate;
        if !data.validity.contains_key("speed") {
            out.without_range.push(data.id.clone());
            continue;
        }
        let flows = loads(simulation, model, &named)?;
        for load in &model.law.responses {
            let own: Vec<&ComparedFlow> = flows.iter().filter(|flow| flow.load == *load).collect();
            out.numbers.extend(over_flows(computed, &own));
        }
        out.flows.extend(flows);
    }
    Ok(out)
}

/// One estimate of each measured source.
fn laws<'a>(measured: &[Named<'a>]) -> Vec<Named<'a>> {
    let mut out: Vec<Named<'a>> = Vec::new();
    let rank = |named: &Named<'_>| (named.estimate.recommended, named.estimate.coefficients.len());
    for named in measured {
        let is_of_source =
            |seen: &&mut Named<'a>| seen.file == named.file && seen.estimate.source == named.estimate.source;
        match out.iter_mut().find(is_of_source) {
            Some(seen) if rank(named) > rank(seen) => *seen = *named,
            Some(_) => {}
            None => out.push(*named),
        }
    }
    out
}

/// Standard uncertainties of what S is made of.
#[derive(Debug, Clone, Copy, Default)]
struct Parts {
    numerical: f64,
    input: f64,
    model_form: f64,
}

impl Parts {
    fn add(&mut self, kind: ErrorKind, square: f64) {
        let part = match kind {
            ErrorKind::Numerical => &mut self.numerical,
            ErrorKind::B | ErrorKind::Input => &mut self.input,
            ErrorKind::ModelForm => &mut self.model_form,
        };
        *part = part.hypot(square.max(0.0).sqrt());
    }
}

fn coefficients(computed: &Estimate, data: &Estimate) -> Vec<Validation> {
    let Some(scatter) = &computed.type_a else { return Vec::new() };
    let of = |(j, name): (usize, &String)| {
        let (own, other) = (computed.coefficients.get(name)?, data.coefficients.get(name)?);
        let (s, d) = (own.value?, other.value?);
        let is_held = [own, other].into_iter().all(|c| c.status == Status::Fixed);
        if own.nuisance || is_held || own.unit != other.unit {
            return None;
        }
        let mut parts = Parts::default();
        for error in computed.errors.values() {
            let row = error.sensitivity.get(j)?;
            parts.add(error.kind, error.between(row, row));
        }
        let u_fit = scatter.matrix.get(j)?.get(j)?.max(0.0).sqrt();
        // The spread over the other laws of the measured source counts as measurement uncertainty.
        let ends = other.interval_95.zip(other.range_95);
        let open = ends.map_or(0.0, |(own, all)| (own[0] - all[0]).max(all[1] - own[1]).max(0.0) / COVERAGE);
        let u_data = other.standard_uncertainty.map(|u| u + open);
        Some(Validation {
            simulation: computed.id.clone(),
            data: data.id.clone(),
            quantity: name.clone(),
            unit: own.unit.clone(),
            computed: s,
            measured: d,
            error: s - d,
            u_numerical: parts.numerical,
            u_input: parts.input,
            u_fit,
            u_data,
            u_validation: root_of_squares(&[parts.numerical, parts.input, u_fit, u_data.unwrap_or(0.0)]),
            declared_model_form: parts.model_form,
            ..Validation::default()
        })
    };
    scatter.names.iter().enumerate().filter_map(of).collect()
}

fn loads(simulation: Simulation<'_>, model: &ModelFit, named: &Named<'_>) -> Result<Vec<ComparedFlow>, IdentifyError> {
    let (data, measured) = (&simulation.result.data, named.estimate);
    let rows: Vec<usize> = (0..data.rows).filter(|&row| is_covered(measured, data, row)).collect();
    // A law that reads what the table does not have gives nothing there.
    let Some(prediction) = Prediction::of(measured, data) else { return Ok(Vec::new()) };
    let others: Vec<Prediction> =
        beside(&named.record.estimates, measured).into_iter().filter_map(|e| Prediction::of(e, data)).collect();
    let fit = Linearised {
        law: &model.law,
        data,
        coefficients: model.law_coefficients(),
        sensitivity: model.fit.sensitivity(),
    };
    let errors: Vec<(ErrorKind, Vec<f64>)> = (simulation.budget.iter())
        .map(|entry| Ok((entry.kind, direction(fit, entry)?)))
        .collect::<Result<_, IdentifyError>>()?;
    let mut out = Vec::new();
    for (response, load) in model.law.responses.iter().enumerate() {
        let (Some(values), Some(of_data)) = (data.values(load), prediction.response(load)) else { continue };
        let of = |prefix: &str| data.values(&format!("{prefix}{load}"));
        let own = of(STD_NUMERICAL).or_else(|| of(STD_ITERATIVE));
        out.extend(rows.iter().map(|&row| {
            let mut parts = Parts::default();
            for (kind, moved) in &errors {
                parts.add(*kind, moved[response * data.rows + row].powi(2));
            }
            parts.add(ErrorKind::Numerical, own.map_or(0.0, |own| own[row].powi(2)));
            let (d, u_data) = prediction.at(of_data * data.rows + row);
            let of_others = others.iter().filter_map(|other| Some((other, other.response(load)?)));
            let of_others = of_others.map(|(other, r)| other.at(r * data.rows + row));
            // The spread over the other laws of the measured source counts as measurement uncertainty.
            let u_data = u_data
                .map(|own| of_others.map(|(x, u)| (x - d).abs() / COVERAGE + u.unwrap_or(0.0)).fold(own, f64::max));
            ComparedFlow {
                data: measured.id.clone(),
                load: load.clone(),
                unit: unit_text(data, load),
                row,
                computed: values[row],
                measured: d,
                u_numerical: parts.numerical,
                u_input: parts.input,
                u_data,
                declared_model_form: parts.model_form,
            }
        }));
    }
    Ok(out)
}

/// A load over all flows that it was compared in.
fn over_flows(computed: &Estimate, flows: &[&ComparedFlow]) -> Option<Validation> {
    // A load that symmetry makes zero on both sides compares nothing.
    let flows: Vec<&ComparedFlow> =
        flows.iter().copied().filter(|flow| flow.computed != 0.0 || flow.measured != 0.0).collect();
    let first = flows.first()?;
    let root_of_mean = |of: &dyn Fn(&ComparedFlow) -> f64| {
        (flows.iter().map(|flow| of(flow).powi(2)).sum::<f64>() / flows.len() as f64).sqrt()
    };
    let sum = |of: &dyn Fn(&ComparedFlow) -> f64| flows.iter().map(|flow| of(flow)).sum::<f64>();
    let has_data = flows.iter().all(|flow| flow.u_data.is_some());
    let is_beyond = |flow: &&&ComparedFlow| flow.error().abs() > COVERAGE * flow.u_validation();
    Some(Validation {
        simulation: computed.id.clone(),
        data: first.data.clone(),
        quantity: first.load.clone(),
        unit: first.unit.clone(),
        flows: Some(flows.len()),
        computed: root_of_mean(&|flow| flow.computed),
        measured: root_of_mean(&|flow| flow.measured),
        error: root_of_mean(&ComparedFlow::error),
        ratio: Some(sum(&|flow| flow.computed * flow.measured) / sum(&|flow| flow.measured.powi(2)))
            .filter(|ratio| ratio.is_finite()),
        u_numerical: root_of_mean(&|flow| flow.u_numerical),
        u_input: root_of_mean(&|flow| flow.u_input),
        u_fit: 0.0,
        u_data: has_data.then(|| root_of_mean(&|flow| flow.u_data.unwrap_or(0.0))),
        u_validation: root_of_mean(&ComparedFlow::u_validation),
        declared_model_form: root_of_mean(&|flow| flow.declared_model_form),
        beyond: Some(flows.iter().filter(is_beyond).count()),
    })
}

/// Whether a computed law was fitted to no angles beyond those of a measured one: laws that are wrong in their form have other coefficients over another range.
fn is_of_its_angles(computed: &Estimate, data: &Estimate) -> bool {
    match (computed.validity.get("angle"), data.validity.get("angle")) {
        (Some(own), Some(other)) => own.low >= other.low - SAME_ANGLE_RAD && own.high <= other.high + SAME_ANGLE_RAD,
        (Some(own), None) => own.low.abs().max(own.high.abs()) <= SAME_ANGLE_RAD,
        (None, _) => true,
    }
}

/// Whether a flow lies in the ranges that an estimate states; one that it states none of is covered.
fn is_covered(estimate: &Estimate, data: &Dataset, row: usize) -> bool {
    ["speed", "angle", "n_links", "v_x", "v_y", "v_z"].iter().all(|name| {
        match (estimate.validity.get(*name), data.values(name)) {
            (Some(range), Some(values)) => {
                let margin = ROUNDING * range.low.abs().max(range.high.abs());
                (range.low - margin..=range.high + margin).contains(&values[row])
            }
            _ => true,
        }
    })
}

/// Loads that an estimate's law gives in the flows of a data set, with their standard uncertainties.
struct Prediction {
    responses: Vec<String>,
    force: Vec<f64>,
    /// Of every response and row; empty where the record states no covariance.
    standard: Vec<f64>,
}

impl Prediction {
    fn of(estimate: &Estimate, data: &Dataset) -> Option<Self> {
        let law = ForceLaw::of_estimate(estimate, data).ok()?;
        let values = law.values_of(estimate).ok()?;
        let force = law.predict(data, &values).ok()?;
        let standard = match estimate.covariance() {
            None => Vec::new(),
            Some(covariance) => {
                let slopes = law.regressors(data, &values).ok()?;
                let places: Vec<Option<usize>> = covariance.names.iter().map(|name| law.position(name)).collect();
                (0..force.len()).map(|row| variance(&slopes, row, &places, &covariance.matrix).sqrt()).collect()
            }
        };
        Some(Self { responses: law.responses, force, standard })
    }

    fn response(&self, load: &str) -> Option<usize> {
        self.responses.iter().position(|name| name == load)
    }

    fn at(&self, row: usize) -> (f64, Option<f64>) {
        (self.force[row], self.standard.get(row).copied())
    }
}

/// xᵀCx of one row x of the regressors, in the order of the covariance.
fn variance(slopes: &Mat<f64>, row: usize, places: &[Option<usize>], covariance: &[Vec<f64>]) -> f64 {
    let x: Vec<f64> = places.iter().map(|place| place.map_or(0.0, |j| slopes[(row, j)])).collect();
    let along = |line: &Vec<f64>| line.iter().zip(&x).map(|(c, x)| c * x).sum::<f64>();
    covariance.iter().zip(&x).map(|(line, x)| x * along(line)).sum::<f64>().max(0.0)
}

fn root_of_squares(parts: &[f64]) -> f64 {
    parts.iter().map(|u| u * u).sum::<f64>().sqrt()
}
