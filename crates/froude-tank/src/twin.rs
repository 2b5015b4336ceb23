//! What the twins of runs have in common: draws in the order in which they are asked for, logs and sidecars.

use froude_fit::budget::Uncertain;
use froude_identify::method::{Export, MethodError};
use froude_records::campaign::{Campaign, Truth};
use indexmap::IndexMap;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

use crate::error::undeclared;

/// Draws that a seed determines, each after the last.
#[derive(Debug)]
pub(crate) struct Draws(Pcg64Mcg);

impl Draws {
    pub(crate) fn of(seed: u64) -> Self {
        Self(Pcg64Mcg::seed_from_u64(seed))
    }

    /// Of the standard normal distribution.
    pub(crate) fn normal(&mut self) -> f64 {
        self.0.sample(StandardNormal)
    }

    /// Draws from N(value, standard²).
    pub(crate) fn about(&mut self, known: Uncertain) -> f64 {
        known.value + known.standard * self.normal()
    }

    /// Draws a gain from N(1, part²).
    pub(crate) fn gain(&mut self, part: f64) -> f64 {
        1.0 + part * self.normal()
    }
}

/// The seed of a run; `run` counts from 0.
pub(crate) fn seed_of(seed: u64, run: usize) -> u64 {
    seed.wrapping_mul(0x9E37_79B9_7F4A_7C15).wrapping_add(run as u64 + 1)
}

/// The log and the sidecar of a run, by its name.
pub(crate) fn pair(id: &str, log: String, sidecar: String) -> [Export; 2] {
    [("csv", log), ("toml", sidecar)]
        .map(|(end, text)| Export { name: format!("{id}.{end}"), content: text.into_bytes() })
}

/// A log: the time and columns, each to so many places.
pub(crate) fn csv(head: &str, time_s: &[f64], columns: &[(&[f64], usize)]) -> String {
    let mut out = format!("{head}\n");
    for (i, t) in time_s.iter().enumerate() {
        out += &format!("{t:.6}");
        for (column, places) in columns {
            out += &format!(",{:.places$}", column[i]);
        }
        out.push('\n');
    }
    out
}

/// A sidecar: what the run is, its configuration and conditions, and its columns.
pub(crate) struct Sidecar<'a> {
    /// The comment at its head.
    pub said: &'a str,
    pub method: &'a str,
    pub role: &'a str,
    /// Empty where nothing is stated.
    pub configuration: &'a str,
    /// Lines of `[conditions]`.
    pub conditions: &'a [String],
    /// The column of the time.
    pub time: &'a str,
    /// Column, channel, unit, frame, and what stands behind.
    pub columns: &'a [[&'a str; 5]],
    /// Columns are filled up to this.
    pub width: usize,
}

impl Sidecar<'_> {
    pub(crate) fn text(&self) -> String {
        let Self { said, method, role, configuration, time, width, .. } = self;
        let mut out = format!("# {said}\nschema = 1\nmethod = \"{method}\"\nrole = \"{role}\"\n");
        if !configuration.is_empty() {
            out += &format!("\n[mounted]\nconfiguration = {configuration:?}\n");
        }
        if !self.conditions.is_empty() {
            out += &format!("\n[conditions]\n{}\n", self.conditions.join("\n"));
        }
        out += &format!("\n[columns]\n{time:width$} = {{ name = \"time\", unit = \"s\" }}\n");
        for [column, name, unit, frame, behind] in self.columns {
            out += &format!(
                "{column:width$} = {{ name = \"{name}\", unit = \"{unit}\", sign = 1, frame = \"{frame}\", clock = \"log\" }}{behind}\n"
            );
        }
        out
    }
}

/// The true coefficients of `[simulate]`; `instead` states that a record is not enough.
pub(crate) fn truths(campaign: &Campaign, instead: String) -> Result<(&str, &IndexMap<String, f64>), MethodError> {
    let place = || campaign.path.display();
    match campaign.simulate.as_ref().map(|simulate| &simulate.truth) {
        Some(Truth::Coefficients { model, values }) => Ok((model.as_str(), values)),
        Some(_) => Err(undeclared(place(), instead)),
        None => Err(undeclared(place(), "a twin needs [simulate]: seed, model, and the true coefficients")),
    }
}

/// One of them.
pub(crate) fn true_value(values: &IndexMap<String, f64>, name: &str) -> Result<f64, MethodError> {
    let missing = || undeclared("[simulate.coefficients]", format!("{name} is missing; the truth needs it"));
    values.get(name).copied().ok_or_else(missing)
}
