//! Errors that two estimates have in common, and the uncertainty of a difference between them.
//!
//! A number is `y = f(β)` with x = ∂y/∂β. Its scatter has the variance xᵀAx, an error e of covariance C moves it by s·e with s = Sᵀx. Two
//! numbers that name one key have the same e: their difference goes with s_a − s_b, and what affects both alike cancels
//! (u²(a − b) = u_a² + u_b² − 2 cov(a, b), GUM 5.2.2).
//!
//! The expanded uncertainty of the difference is U² = U_a² + U_b² + U_c²: that of what only the first has, that of what only the second has
//! (ISO 13528:2022, 9.7), and that of the common errors in the difference. Each is the arm of its interval that points to the other value; of a source with several laws that its data do
//! not contradict, the arm of the envelope.

use std::collections::BTreeSet;

use froude_fit::budget::{Kind, OUTSIDE_95, Part, combine};
use froude_records::estimate::{Coefficient, Estimate, OWN, SharedError, Status, TypeA};
use froude_records::finding::{Finding, Severity};

use crate::compare::stated::Stated;

/// Relative difference of two covariances under one key that rounding does not make.
const DIFFERS: f64 = 1e-9;

/// A number that an estimate states or predicts.
#[derive(Debug, Clone)]
pub(crate) struct Number<'a> {
    estimate: &'a Estimate,
    /// ∂number/∂β, in the order of the covariance; empty where the number has an uncertainty without one.
    slopes: Vec<f64>,
    /// How far the laws that the data do not contradict reach beyond its interval, below and above.
    beyond: [f64; 2],
    /// The number with its uncertainty.
    pub stated: Stated,
}

impl<'a> Number<'a> {
    /// A coefficient, with the uncertainty that the record states.
    pub fn of_coefficient(estimate: &'a Estimate, name: &str) -> Self {
        let Coefficient { value, standard_uncertainty, effective_dof, interval_95, range_95, status, .. } =
            &estimate.coefficients[name];
        let names = estimate.type_a.as_ref().map_or(&[][..], |a| &a.names);
        let is_there = names.iter().any(|n| n == name);
        let slopes =
            if is_there { names.iter().map(|n| if n == name { 1.0 } else { 0.0 }).collect() } else { Vec::new() };
        // Several laws are left, and one of them gives the coefficient no interval.
        let has_no_range = estimate.not_contradicted.len() > 1 && interval_95.is_some() && range_95.is_none();
        let is_refused = estimate.without_interval().contains(&name) || (has_no_range && *status != Status::Fixed);
        let stated =
            Stated { value: *value, standard: *standard_uncertainty, dof: *effective_dof, is_refused, beyond: 0.0 };
        let ends = interval_95.zip(*range_95);
        let beyond = ends.map_or([0.0; 2], |(own, range)| [own[0] - range[0], range[1] - own[1]]);
        Self { estimate, slopes, beyond: [0.0; 2], stated }.reaching(beyond)
    }

    /// Sets how far the envelope reaches beyond the interval, below and above.
    fn reaching(mut self, beyond: [f64; 2]) -> Self {
        self.beyond = beyond.map(|x| x.max(0.0));
        self.stated.beyond = self.beyond[0].max(self.beyond[1]);
        self
    }

    /// This number with its interval widened to hold those of `others`, the same quantity by the other laws that are not contradicted.
    pub fn around(self, others: &[Self]) -> Self {
        // With all errors, and by the scatter alone: what a comparison removes as common must not hide a law.
        let reach = |is_meant: &dyn Fn(&str) -> bool| {
            let ends = |of: &Self| {
                let [below, above] = of.own_arms(is_meant);
                of.stated.value.map(|value| [value - below, value + above])
            };
            let [low, high] = ends(&self)?;
            let hull = others.iter().filter_map(ends).fold([low, high], |[a, b], [c, d]| [a.min(c), b.max(d)]);
            Some([low - hull[0], hull[1] - high])
        };
        let (Some(all), Some(scatter)) = (reach(&|_| true), reach(&|_| false)) else { return self };
        let beyond = [0, 1].map(|k| all[k].max(scatter[k]).max(self.beyond[k]));
        self.reaching(beyond)
    }

    /// A number made from the coefficients; `slope` is its derivative by each.
    ///
    /// The standard uncertainty is that of the linear law of propagation, u² = xᵀAx + Σ sᵀCs with x = ∂value/∂β and s = Sᵀx, in the unit of the value; its
    /// effective degrees of freedom are Welch and Satterthwaite's.
    ///
    /// # Source
    ///
    /// JCGM 100:2008 (GUM), 5.2.2 and G.4.1.
    pub fn of_number(estimate: &'a Estimate, value: Option<f64>, slope: impl Fn(&str) -> f64) -> Self {
        let Some(scatter) = &estimate.type_a else {
            return Self { stated: Stated { value, ..Stated::default() }, ..Self::of_nothing(estimate) };
        };
        let slopes: Vec<f64> = scatter.names.iter().map(|name| slope(name)).collect();
        let stated = Stated { value, ..Stated::default() };
        let mut side = Self { estimate, slopes, beyond: [0.0; 2], stated };
        let all = combine(&side.parts(&|_| true), 0, OUTSIDE_95);
        side.stated.standard = Some(all.standard);
        side.stated.dof = Some(all.dof).filter(|d| d.is_finite());
        side.stated.is_refused = estimate.without_interval().into_iter().any(|name| slope(name) != 0.0);
        side
    }

    /// No number at all.
    pub fn of_nothing(estimate: &'a Estimate) -> Self {
        Self { estimate, slopes: Vec::new(), beyond: [0.0; 2], stated: Stated::default() }
    }

    /// What moves the number: its scatter, and the errors that `is_meant`.
    fn parts(&self, is_meant: &dyn Fn(&str) -> bool) -> Vec<Part> {
        let of = |kind, standard, dof| Part::of_one(String::new(), "campaign", kind, standard, dof);
        let Some(scatter) = self.estimate.type_a.as_ref().filter(|_| !self.slopes.is_empty()) else {
            let dof = self.stated.dof.unwrap_or(f64::INFINITY);
            return self.stated.standard.map(|u| of(Kind::A, u, dof)).into_iter().collect();
        };
        let (variance, dof) = of_scatter(scatter, &self.slopes);
        let errors = self.estimate.errors.iter().filter(|(key, _)| is_meant(key)).map(|(_, error)| {
            let along = self.along(error);
            part(error, &along)
        });
        std::iter::once(of(Kind::A, variance.sqrt(), dof)).chain(errors).collect()
    }

    /// s = Sᵀx: what an error does to the number.
    fn along(&self, error: &SharedError) -> Vec<f64> {
        let of = |k: usize| self.slopes.iter().zip(&error.sensitivity).map(|(x, row)| x * row[k]).sum();
        (0..error.covariance.len()).map(of).collect()
    }

    /// Its interval's arm towards smaller numbers and towards larger ones, from its own parts.
    fn own_arms(&self, is_meant: &dyn Fn(&str) -> bool) -> [f64; 2] {
        combine(&self.parts(is_meant), 0, self.outside()).arms
    }

    fn outside(&self) -> f64 {
        OUTSIDE_95 / self.estimate.interval.looks.max(1) as f64
    }
}

/// An error as a part of a number that it moves by s·e.
fn part(error: &SharedError, s: &[f64]) -> Part {
    let dof = error.dof.unwrap_or(f64::INFINITY);
    match (error.limits, s) {
        (Some([low, high]), [s]) => {
            let ends = [s * low, s * high];
            let limits = [ends[0].min(ends[1]), ends[0].max(ends[1])];
            Part::of_one_between(String::new(), "campaign", limits)
        }
        _ => Part::of_one(String::new(), "campaign", Kind::B, error.between(s, s).max(0.0).sqrt(), dof),
    }
}

/// Variance xᵀAx with its degrees of freedom: part i is x_i(Ax)_i, known with ν_i, taken as fully dependent.
fn of_scatter(scatter: &TypeA, x: &[f64]) -> (f64, f64) {
    let row = |line: &Vec<f64>| line.iter().zip(x).map(|(c, x)| c * x).sum::<f64>();
    let parts: Vec<f64> = scatter.matrix.iter().zip(x).map(|(line, x)| x * row(line)).collect();
    let variance = parts.iter().sum::<f64>().max(0.0);
    (variance, effective_dof(&parts, &scatter.dof).unwrap_or(f64::INFINITY))
}

/// Degrees of freedom of a sum of fully dependent parts of a variance; null where no touched part states any.
///
/// √(2/ν)·u² = Σ w_i·√(2/ν_i). Parts of opposite sign can carry the sum outside the ν_i: it is cut there.
fn effective_dof(parts: &[f64], dof: &[Option<f64>]) -> Option<f64> {
    let total: f64 = parts.iter().sum();
    let touched: Vec<(f64, Option<f64>)> =
        parts.iter().copied().zip(dof.iter().map(|d| d.filter(|d| *d > 0.0))).filter(|(w, _)| *w != 0.0).collect();
    let all = || touched.iter().map(|(_, d)| d.unwrap_or(f64::INFINITY));
    let (least, most) = (all().fold(f64::INFINITY, f64::min), all().fold(0.0, f64::max));
    if !least.is_finite() || total <= 0.0 {
        return None;
    }
    let root: f64 = touched.iter().map(|(w, d)| w / total * d.map_or(0.0, |d| d.sqrt().recip())).sum();
    let nu = if root > 0.0 { root.powi(-2) } else { f64::INFINITY };
    Some(nu.max(least).min(most)).filter(|d| d.is_finite())
}

/// What two estimates have in common.
#[derive(Debug, Clone)]
pub(crate) struct Common<'a> {
    sources: [&'a str; 2],
    /// Keys, and the error as each of the two states it.
    errors: Vec<(&'a str, [&'a SharedError; 2])>,
    /// Covariance between coefficients needs their names.
    names: [&'a [String]; 2],
    /// Keys under which the two state different errors.
    contradicted: Vec<&'a str>,
}

impl<'a> Common<'a> {
    /// The errors that both know by one key.
    pub fn of(a: &'a Estimate, b: &'a Estimate) -> Self {
        let (mut errors, mut contradicted) = (Vec::new(), Vec::new());
        for (key, of_a) in a.errors.iter().filter(|(key, _)| !key.starts_with(OWN)) {
            let Some(of_b) = b.errors.get(key) else { continue };
            if is_same(&of_a.covariance, &of_b.covariance) {
                errors.push((key.as_str(), [of_a, of_b]));
            } else {
                contradicted.push(key.as_str());
            }
        }
        let names = [a, b].map(|e| e.type_a.as_ref().map_or(&[][..], |scatter| scatter.names.as_slice()));
        Self { sources: [&a.source, &b.source], errors, names, contradicted }
    }

    /// Whether there is nothing that both know.
    pub fn is_empty(&self) -> bool {
        self.errors.is_empty()
    }

    /// Fewest effective degrees of freedom that one of the coefficients has in what is its own.
    ///
    /// For the denominator of F(m, ν) of the joint χ²; infinite where no record states any. Dimensionless.
    ///
    /// # Source
    ///
    /// JCGM 100:2008 (GUM), G.4.1.
    pub fn least_dof(&self, estimates: [&Estimate; 2], names: &[&String]) -> f64 {
        let alone = |key: &str| !self.is_common(key);
        let dof = |(estimate, name): (&Estimate, &String)| {
            combine(&Number::of_coefficient(estimate, name).parts(&alone), 0, OUTSIDE_95).dof
        };
        let all = estimates.into_iter().flat_map(|estimate| names.iter().map(move |name| (estimate, *name)));
        all.map(dof).fold(f64::INFINITY, f64::min)
    }

    fn is_common(&self, key: &str) -> bool {
        self.errors.iter().any(|(k, _)| *k == key)
    }

    /// Expanded (95 %) uncertainty of a difference, towards zero.
    ///
    /// U = √(U_a² + U_b² + U_c²) and what the envelopes of laws add to both arms, each the arm of its 95 % interval that points to the other value; in the unit of the numbers. `difference` is a − b, of which
    /// only the sign is read.
    ///
    /// # Source
    ///
    /// JCGM 100:2008 (GUM), 5.2.2 (common errors); ISO 13528:2022, 9.7 (E_n).
    pub fn expanded_difference(&self, [a, b]: [&Number<'_>; 2], difference: f64) -> f64 {
        // The first is larger: its lower arm and the other's upper one point to each other.
        let [of_a, of_b] = if difference > 0.0 { [0, 1] } else { [1, 0] };
        let alone = |key: &str| !self.is_common(key);
        let common: Vec<Part> = self
            .errors
            .iter()
            .map(|(_, [x, y])| {
                let s: Vec<f64> = a.along(x).iter().zip(b.along(y)).map(|(a, b)| a - b).collect();
                part(x, &s)
            })
            .collect();
        let outside = a.outside().min(b.outside());
        let together = if common.is_empty() { 0.0 } else { combine(&common, 0, outside).arms[of_a] };
        // Which law is true is no chance: what other laws add is added as it is.
        let beyond = a.beyond[of_a] + b.beyond[of_b];
        a.own_arms(&alone)[of_a].hypot(b.own_arms(&alone)[of_b]).hypot(together) + beyond
    }

    /// Covariance between a coefficient of the first and one of the second.
    ///
    /// Σ S_a C S_bᵀ over the errors with one key, in the product of the units of both; 0 where the records have no error in common.
    ///
    /// # Source
    ///
    /// JCGM 100:2008 (GUM), 5.2.2 and F.1.2.
    pub fn covariance(&self, [first, second]: [&str; 2]) -> f64 {
        let row = |side: usize, name: &str| self.names[side].iter().position(|n| n == name);
        let (Some(i), Some(j)) = (row(0, first), row(1, second)) else { return 0.0 };
        self.errors.iter().map(|(_, [x, y])| x.between(&x.sensitivity[i], &y.sensitivity[j])).sum()
    }
}

/// What two sources have in common, over all of their estimates: what is taken out, and what only looks so.
pub(crate) fn findings(all: &[Common<'_>]) -> Vec<Finding> {
    let Some([a, b]) = all.first().map(|common| common.sources) else { return Vec::new() };
    let names: BTreeSet<&str> = all.iter().flat_map(|c| &c.errors).map(|(_, [x, _])| x.name.as_str()).collect();
    let contradicted: BTreeSet<&str> = all.iter().flat_map(|c| &c.contradicted).copied().collect();
    let list = |names: BTreeSet<&str>| names.into_iter().collect::<Vec<_>>().join("; ");
    let mut out = Vec::new();
    if !names.is_empty() {
        let text = format!(
            "{a} and {b} have errors in common, by their keys: {}; what affects both alike is removed from E_n and χ²",
            list(names)
        );
        out.push(Finding::new(Severity::Note, "errors-in-common", text));
    }
    if !contradicted.is_empty() {
        let text = format!(
            "{a} and {b} state different uncertainties of what they call the same error ({}): it is not removed, and E_n and χ² \
             cannot be trusted; reduce both with one declaration",
            list(contradicted)
        );
        out.push(Finding::new(Severity::Warning, "errors-contradict", text));
    }
    out
}

fn is_same(a: &[Vec<f64>], b: &[Vec<f64>]) -> bool {
    let close = |x: &f64, y: &f64| (x - y).abs() <= DIFFERS * x.abs().max(y.abs());
    a.len() == b.len() && a.iter().zip(b).all(|(p, q)| p.len() == q.len() && p.iter().zip(q).all(|(x, y)| close(x, y)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn degrees_of_freedom_of_a_sum_lie_between_those_of_its_parts() {
        let of = |parts: &[f64], dof: &[Option<f64>]| effective_dof(parts, dof);
        assert_eq!(of(&[2.0, 1.0], &[Some(9.0), Some(9.0)]).map(|d| (d * 1e9).round() / 1e9), Some(9.0));
        // 1/√ν = ½/√4 + ½/√16 = 3/8.
        assert!((of(&[1.0, 1.0], &[Some(4.0), Some(16.0)]).unwrap() - 64.0 / 9.0).abs() < 1e-12);
        // Opposite parts would leave the range.
        assert_eq!(of(&[3.0, -2.0], &[Some(4.0), Some(16.0)]), Some(4.0));
        // What has no part in the load has no say.
        assert_eq!(of(&[1.0, 0.0], &[Some(4.0), Some(1.0)]), Some(4.0));
        assert_eq!(of(&[1.0, 1.0], &[None, None]), None);
    }
}
