//! A law as a sequence of linear problems, and what is said where one has no solution.

use froude_fit as fit;
use froude_records::finding::{Finding, Severity};

use crate::dataset::{Dataset, unit_text};
use crate::error::IdentifyError;
use crate::law::{CoefficientSpec, ForceLaw, Kind};
use crate::regression::problem::{Offsets, logarithms, problem, start, step, weights};
use crate::regression::settings::Settings;

/// Iterations of the non-linear parts (power law, angle offset); both converge quadratically.
const MOST_ITERATIONS: usize = 50;
/// Relative change of the coefficients at which they stop.
const CONVERGED: f64 = 1e-12;

/// One law, the data it is fitted to, and what both fix before the first fit.
pub(crate) struct Job<'a> {
    law: &'a ForceLaw,
    data: &'a Dataset,
    settings: Settings<'a>,
    /// Measured loads, one load after the other.
    pub(crate) newtons: Vec<f64>,
    /// What is fitted: the loads, or the logarithms of their absolute values.
    measured: Vec<f64>,
    pub(crate) weight: Option<Vec<f64>>,
    setups: Offsets,
    groups: Offsets,
    /// Coefficients of the law, then the angle offset of each setup, then the offset of each group in each load.
    pub(crate) specs: Vec<CoefficientSpec>,
}

impl<'a> Job<'a> {
    pub(crate) fn new(law: &'a ForceLaw, data: &'a Dataset, settings: Settings<'a>) -> Result<Self, IdentifyError> {
        let newtons = law.measured(data)?;
        let measured = if law.in_logarithms() { logarithms(law, &newtons, data, settings)? } else { newtons.clone() };
        let setups = Offsets::of_setups(law, data, settings.identify);
        let mut specs = law.coefficients.clone();
        specs.extend(setups.names.iter().map(|s| CoefficientSpec {
            name: format!("angle_offset{}{s}", if s.is_empty() { "" } else { "_" }),
            unit: "rad".to_owned(),
        }));
        let groups = Offsets::of_groups(law, data, settings.identify);
        if settings.identify.group_offset && law.is_nonlinear() {
            return Err(IdentifyError::NoFit {
                source_name: settings.source_name.to_owned(),
                model: law.name.clone(),
                why: "group_offset = \"estimate\" needs a law that is linear in its coefficients".to_owned(),
            });
        }
        for load in &law.responses {
            specs.extend(
                groups.names.iter().map(|group| CoefficientSpec {
                    name: format!("offset_{load}_{group}"),
                    unit: unit_text(data, load),
                }),
            );
        }
        let weight = weights(law, data, settings.weight)?;
        Ok(Self { law, data, settings, newtons, measured, weight, setups, groups, specs })
    }

    /// The last linear problem and its fit. A non-linear law or an angle offset is linearised again until nothing changes.
    pub(crate) fn solve(
        &self,
        options: &fit::Options,
        findings: &mut Vec<Finding>,
    ) -> Result<(fit::Problem, fit::Fit), IdentifyError> {
        let fitted = |problem: &fit::Problem| fit::fit(problem, options).map_err(|e| self.refusal(e));
        let mut beta = start(self.law, self.data, &self.newtons, self.specs.len());
        let mut problem = match self.settings.condensed {
            Some(condensed) => condensed.problem.clone(),
            None => self.linear(&beta)?,
        };
        let mut fit = fitted(&problem)?;
        if !self.law.is_nonlinear() && self.setups.names.is_empty() {
            return Ok((problem, fit));
        }
        for _ in 0..MOST_ITERATIONS {
            let next = step(&fit);
            let change = next.iter().zip(&beta).map(|(a, b)| (a - b).abs() / (a.abs() + 1e-9)).fold(0.0, f64::max);
            beta = next;
            problem = self.linear(&beta)?;
            fit = fitted(&problem)?;
            if change < CONVERGED {
                return Ok((problem, fit));
            }
        }
        findings.push(self.not_converged(&format!("the iteration did not converge within {MOST_ITERATIONS} steps")));
        Ok((problem, fit))
    }

    /// The linear problem at `beta`.
    fn linear(&self, beta: &[f64]) -> Result<fit::Problem, IdentifyError> {
        problem(
            self.law,
            self.data,
            &self.specs,
            &self.measured,
            self.weight.clone(),
            (&self.setups, &self.groups),
            beta,
        )
    }

    pub(crate) fn not_converged(&self, what: &str) -> Finding {
        Finding::new(Severity::Warning, "not-converged", format!("model {}: {what}", self.law.name))
    }

    pub(crate) fn no_fit(&self, why: String) -> IdentifyError {
        IdentifyError::NoFit { source_name: self.settings.source_name.to_owned(), model: self.law.name.clone(), why }
    }

    /// What the fit refused, with source and law; numbers without bounds are those of the iteration.
    pub(crate) fn refusal(&self, source: fit::FitError) -> IdentifyError {
        match source {
            fit::FitError::NotFinite(_) if self.law.is_nonlinear() => {
                self.no_fit(ran_away(self.law, self.data, &self.newtons))
            }
            source => match no_value(self.law, self.data).filter(|_| matches!(source, fit::FitError::NotFinite(_))) {
                Some(why) => self.no_fit(why),
                None => IdentifyError::Fit {
                    source_name: self.settings.source_name.to_owned(),
                    model: self.law.name.clone(),
                    source: Box::new(source),
                },
            },
        }
    }
}

/// The first row in which a formula has no value, and what to do.
fn no_value(law: &ForceLaw, data: &Dataset) -> Option<String> {
    let Kind::Formulas(_) = &law.kind else { return None };
    let slopes = law.regressors(data, &[]).ok()?;
    let at = |row: usize| (0..slopes.ncols()).find(|&j| !slopes[(row, j)].is_finite()).map(|j| (row, j));
    let (row, j) = (0..slopes.nrows()).find_map(at)?;
    let load = law.responses.get(row / data.rows.max(1))?;
    let coefficient = &law.coefficients.get(j)?.name;
    let speed = data.values("speed").and_then(|speed| speed.get(row % data.rows.max(1)));
    let at_speed = speed.map_or_else(String::new, |speed| format!(", at {speed} m/s"));
    Some(format!(
        "in {}{at_speed} the factor of {coefficient} in {load} is {}: a root or logarithm of a negative number, a division by zero, or \
         CF_ITTC57 below Re = 1000; leave the row out with `keep`",
        data.row_name(row % data.rows.max(1)),
        slopes[(row, j)]
    ))
}

/// Why the iteration of a power law left all bounds.
fn ran_away(law: &ForceLaw, data: &Dataset, newtons: &[f64]) -> String {
    let Kind::PowerLaw { channel, .. } = &law.kind else {
        return "its iteration exceeds the range of floating point".to_owned();
    };
    let speeds = data.values(channel).unwrap_or_default();
    let moving = speeds.iter().filter(|v| **v != 0.0).count();
    let opposed = speeds.iter().zip(newtons).filter(|(v, f)| **v * **f < 0.0).count();
    let load = law.responses.first().map_or("the load", String::as_str);
    if 2 * opposed < moving {
        return format!(
            "{load} opposes {channel} in {opposed} of the {moving} rows that move, and a power law is a resistance: check the sign of \
             {load}, or leave this law out"
        );
    }
    format!(
        "its iteration diverges: exponent and factor of {load} are not determined by these rows; use speeds further apart, or a law with a given \
         exponent (quadratic)"
    )
}
