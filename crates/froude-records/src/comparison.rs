//! Estimates side by side, as a record holds them and as pages and tables show them.
//!
//! Coefficients are compared with those of the same model; loads are predicted over the common range. E_n is the normalised difference
//! (first − second)/U, U the expanded (95 %) uncertainty of the difference. Where there is none, a note says why.

use serde::{Deserialize, Serialize};

use crate::finding::Finding;
use crate::number::{fixed, p_equation};

/// Estimates side by side.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Comparison {
    /// Whether the estimates whose loads are predicted agree, pair by pair; without loads all that share a coefficient.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub verdicts: Vec<Verdict>,
    /// Coefficient by coefficient, pair by pair; same model and same name only.
    pub coefficients: Vec<CoefficientComparison>,
    /// Whole coefficient vectors with their covariances, pair by pair.
    pub joint: Vec<JointComparison>,
    /// Predicted loads over the common range: the first source beside each of the others.
    pub loads: Vec<LoadComparison>,
    /// Computed numbers beside measured ones: the comparison error E = S − D and what its uncertainty is made of.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub validation: Vec<Validation>,
    /// Which coverage factor the expanded uncertainties of the loads have, a sentence per source.
    pub coverage: Vec<String>,
    /// What was found on the way: contradictions, missing ranges. It stands among the findings of the record.
    #[serde(skip)]
    pub findings: Vec<Finding>,
}

/// Whether two estimates agree: all E_n of their forces and of their coefficients at most 1, and p of the vector at least 0.05.
///
/// Each number alone exceeds its bound in 5 % of the pairs that measure the same; that one of several does is more frequent.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Verdict {
    /// Id of the first estimate.
    pub first: String,
    /// Id of the second.
    pub second: String,
    /// Whether they agree within their uncertainties.
    pub agree: bool,
    /// The force with the largest |E_n|; null where no force has one.
    pub load: Option<LargestLoad>,
    /// The coefficient with the largest |E_n|; null where none is stated by both, as in two different laws.
    pub coefficient: Option<LargestCoefficient>,
    /// Chance of a larger χ² if both measure the same; null where there is no χ².
    pub p: Option<f64>,
}

impl Verdict {
    /// In words, with the numbers that it rests on; without a full stop.
    #[must_use]
    pub fn words(&self) -> String {
        let load = self.load.as_ref().map(|l| {
            let links = l.n_links.map_or_else(String::new, |n| format!(", {n} links"));
            let at = format!("{} m/s, {}°{links}", fixed(l.speed_m_s, 3), fixed(l.angle_rad.to_degrees(), 1));
            format!("largest E_n of the forces {} ({} at {at})", signed(l.e_n), l.component)
        });
        let coefficient = self
            .coefficient
            .as_ref()
            .map(|c| format!("largest E_n of the coefficients {} ({})", signed(c.e_n), c.coefficient));
        let joint = self.p.map(|p| format!("all coefficients together {}", p_equation(p)));
        let numbers: Vec<String> = [load, coefficient, joint].into_iter().flatten().collect();
        let verdict =
            if self.agree { "agree within their uncertainties" } else { "differ by more than their uncertainties" };
        format!("{} and {} {verdict}: {}", self.first, self.second, numbers.join("; "))
    }
}

fn signed(e_n: f64) -> String {
    let text = fixed(e_n, 2);
    if e_n > 0.0 { format!("+{text}") } else { text }
}

/// The predicted force on which two estimates differ most.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LargestLoad {
    /// Load component.
    pub component: String,
    /// Links of the configuration; null for a body without links.
    pub n_links: Option<f64>,
    /// Speed.
    pub speed_m_s: f64,
    /// Angle `atan2(−v_y, v_x)`.
    pub angle_rad: f64,
    /// Normalised difference.
    pub e_n: f64,
}

/// The coefficient on which two estimates differ most.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LargestCoefficient {
    /// Its label, or its name where it has none.
    pub coefficient: String,
    /// Normalised difference.
    pub e_n: f64,
}

/// A number as one estimate states it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Side {
    /// Id of the estimate.
    pub source: String,
    /// Its value; null when undetermined or not predicted.
    pub value: Option<f64>,
    /// Its standard uncertainty, in the unit of the value; null when none is stated.
    pub standard_uncertainty: Option<f64>,
    /// Effective degrees of freedom of it; null when the record states no finite ones.
    pub effective_dof: Option<f64>,
    /// Coverage factor k of the 95 % uncertainty U = k·u.
    pub coverage_factor: Option<f64>,
    /// Expanded (95 %) uncertainty U = k·u. The interval of a coefficient that reaches further to one side, or pays for looks, is in its estimate:
    /// E_n takes the arm that points to the other value.
    pub expanded_uncertainty: Option<f64>,
}

/// A coefficient in two estimates.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct CoefficientComparison {
    /// The model that both values belong to.
    pub model: String,
    /// Name of the coefficient.
    pub coefficient: String,
    /// What a paper or a trade calls it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// Its unit.
    pub unit: String,
    /// One side.
    pub first: Side,
    /// The other side.
    pub second: Side,
    /// Normalised difference; null where a side states no uncertainty, or both rest on the same data.
    pub e_n: Option<f64>,
    /// Why there is none; empty where there is.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub note: String,
}

/// χ² of the difference of two coefficient vectors.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct JointComparison {
    /// The model that both vectors belong to.
    pub model: String,
    /// Id of the first estimate.
    pub first: String,
    /// Id of the second.
    pub second: String,
    /// The statistic; null when it cannot be formed.
    pub chi_squared: Option<f64>,
    /// Its degrees of freedom: coefficients that both estimate.
    pub dof: Option<usize>,
    /// Chance of a larger statistic if both measure the same.
    pub p: Option<f64>,
    /// Why there is no statistic; empty where there is.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub note: String,
}

/// A load predicted by two estimates at one place of their common range.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LoadComparison {
    /// Load component.
    pub component: String,
    /// Unit of both predictions.
    pub unit: String,
    /// Links of the configuration; null for a body without links.
    pub n_links: Option<f64>,
    /// Speed.
    pub speed_m_s: f64,
    /// Angle `atan2(−v_y, v_x)`.
    pub angle_rad: f64,
    /// One side.
    pub first: Side,
    /// The other side.
    pub second: Side,
    /// Normalised difference; null where a side states no uncertainty, or both rest on the same data.
    pub e_n: Option<f64>,
    /// Why there is none; empty where there is.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub note: String,
}

/// A computed number S beside a measured one D, by ASME V&V 20: E = S − D, and the standard uncertainty of everything in E but the error of the model.
///
/// The error of the model lies in E ± k·u_validation. Numbers are in `unit`. A load is compared in every computed flow that the measured law covers; its numbers are then roots of mean squares over these flows.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Validation {
    /// Id of the estimate that was computed.
    pub simulation: String,
    /// Id of the one that was measured.
    pub data: String,
    /// Name of the coefficient, or of the load.
    pub quantity: String,
    /// Unit of all numbers.
    pub unit: String,
    /// Flows that a load was compared in; null for a coefficient.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub flows: Option<usize>,
    /// S.
    pub computed: f64,
    /// D.
    pub measured: f64,
    /// E = S − D.
    pub error: f64,
    /// The factor by which the computed loads lie above the measured ones, Σ S·D / Σ D²; null for a coefficient.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ratio: Option<f64>,
    /// Standard uncertainty of S from mesh and iterations.
    pub u_numerical: f64,
    /// From what went into the computation.
    pub u_input: f64,
    /// From the scatter about the law, of a coefficient.
    pub u_fit: f64,
    /// Standard uncertainty of D; null where the record states none, and then `u_validation` is too small.
    pub u_data: Option<f64>,
    /// The root of the sum of their squares.
    pub u_validation: f64,
    /// Standard uncertainty that was declared for the form of the model; E shows what it is.
    pub declared_model_form: f64,
    /// Flows in which |E| > 2 u_validation; null for a coefficient.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub beyond: Option<usize>,
}

impl Validation {
    /// Whether the error of the model is beyond what everything else explains: |E| > 2 u_validation, of a load in more than a twentieth of its flows.
    #[must_use]
    pub fn is_beyond(&self) -> bool {
        match (self.beyond, self.flows) {
            (Some(beyond), Some(flows)) => 20 * beyond > flows,
            _ => self.error.abs() > 2.0 * self.u_validation,
        }
    }
}

/// An F test of a law beside the terms that another one would add to it, both fitted to the same observations.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct AddedTerms {
    /// The law.
    pub law: String,
    /// The law that has the terms.
    pub of: String,
    /// Load component.
    pub component: String,
    /// The statistic.
    pub f: f64,
    /// Degrees of freedom of numerator and denominator: terms, residual.
    pub dof: [f64; 2],
    /// Probability of a larger statistic if the law is true.
    pub p: f64,
}

impl Comparison {
    /// True where nothing could be set side by side.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.coefficients.is_empty() && self.joint.is_empty() && self.loads.is_empty()
    }

    /// Ids of the estimates whose loads are predicted, the one that all others are compared with first.
    #[must_use]
    pub fn load_sources(&self) -> Vec<&str> {
        let mut out: Vec<&str> = Vec::new();
        for row in &self.loads {
            for source in [&row.first.source, &row.second.source] {
                if !out.contains(&source.as_str()) {
                    out.push(source);
                }
            }
        }
        out
    }
}

/// Which coverage factor the expanded uncertainties of one estimate have, in words.
#[must_use]
pub fn coverage_note<'a>(id: &str, stated: impl IntoIterator<Item = &'a Side>) -> String {
    let own: Vec<&Side> =
        stated.into_iter().filter(|s| s.value.is_some() && s.standard_uncertainty.is_some()).collect();
    // A load that is zero for any coefficients has no uncertainty to cover.
    let own = if own.iter().any(|s| s.standard_uncertainty > Some(0.0)) {
        own.into_iter().filter(|s| s.standard_uncertainty > Some(0.0)).collect()
    } else {
        own
    };
    if own.is_empty() {
        return format!("{id}: no uncertainty stated");
    }
    // One cluster decides the others.
    let own: Vec<&Side> = own.into_iter().filter(|s| s.coverage_factor.is_some()).collect();
    if own.is_empty() {
        return format!("{id}: no interval stated");
    }
    let range = |of: &dyn Fn(&Side) -> Option<f64>, places: usize| {
        let span = |x: f64| format!("{x:.places$}");
        let low = own.iter().filter_map(|s| of(s)).fold(f64::INFINITY, f64::min);
        let high = own.iter().filter_map(|s| of(s)).fold(f64::NEG_INFINITY, f64::max);
        if span(low) == span(high) { span(low) } else { format!("{} to {}", span(low), span(high)) }
    };
    let factor = range(&|s| s.coverage_factor, 2);
    if own.iter().all(|s| s.effective_dof.is_none()) {
        return format!("{id}: k = {factor} (normal), its record states no degrees of freedom");
    }
    let some = if own.iter().any(|s| s.effective_dof.is_none()) { ", where its record states them" } else { "" };
    format!("{id}: k = {factor} (Student's t, effective degrees of freedom {}{some})", range(&|s| s.effective_dof, 1))
}
