//! What the twins of runs have in common: draws in the order in which they are asked for, logs and sidecars.

use froude_fit::budget::Uncertain;
use froude_identify::method::{Export, MethodError};
use froude_records::campaign::{Campaign, Truth};
use froude_records::run::Role;
use indexmap::IndexMap;
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;

use crate::channel::Channel;
use crate::error::undeclared;

/// Random draws in sequence from a seed; without a seed, of a twin without errors, all are zero.
#[derive(Debug)]
pub(crate) struct Draws(Option<Pcg64Mcg>);

impl Draws {
    pub(crate) fn of(seed: u64) -> Self {
        Self(Some(Pcg64Mcg::seed_from_u64(seed)))
    }

    pub(crate) const fn none() -> Self {
        Self(None)
    }

    /// Of the standard normal distribution.
    pub(crate) fn normal(&mut self) -> f64 {
        self.0.as_mut().map_or(0.0, |draws| draws.sample(StandardNormal))
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

/// A column of a log.
pub(crate) struct Column<'a> {
    /// Its head, channel, unit, frame, and what stands behind them in the sidecar.
    pub described: [&'a str; 5],
    /// Decimal places.
    pub places: usize,
    pub values: &'a [f64],
}

impl<'a> Column<'a> {
    pub(crate) fn of(channel: &Channel, values: &'a [f64]) -> Self {
        let (head, frame, comment, places) = channel.column;
        Self { described: [head, channel.name, channel.unit, frame, comment], places, values }
    }
}

/// A run with its log.
pub(crate) struct Logged<'a> {
    /// Its name.
    pub id: &'a str,
    /// The comment at the head of its sidecar.
    pub said: &'a str,
    pub method: &'a str,
    pub role: Role,
    /// Empty where nothing is stated.
    pub configuration: &'a str,
    /// Lines of `[conditions]`.
    pub conditions: &'a [String],
    /// Head of the time, and the times, s.
    pub time: (&'a str, &'a [f64]),
    pub columns: &'a [Column<'a>],
}

impl Logged<'_> {
    /// The log and the sidecar.
    pub(crate) fn files(&self) -> [Export; 2] {
        [("csv", self.log()), ("toml", self.sidecar())]
            .map(|(end, text)| Export { name: format!("{}.{end}", self.id), content: text.into_bytes() })
    }

    fn heads(&self) -> Vec<&str> {
        std::iter::once(self.time.0).chain(self.columns.iter().map(|column| column.described[0])).collect()
    }

    fn log(&self) -> String {
        let mut out = format!("{}\n", self.heads().join(","));
        for (i, t) in self.time.1.iter().enumerate() {
            out += &format!("{t:.6}");
            for Column { places, values, .. } in self.columns {
                out += &format!(",{:.places$}", values[i]);
            }
            out.push('\n');
        }
        out
    }

    fn sidecar(&self) -> String {
        let Self { said, method, configuration, .. } = self;
        let role = self.role.name();
        let width = self.heads().iter().map(|head| head.len()).max().unwrap_or(0);
        let mut out = format!("# {said}\nschema = 1\nmethod = \"{method}\"\nrole = \"{role}\"\n");
        if !configuration.is_empty() {
            out += &format!("\n[mounted]\nconfiguration = {configuration:?}\n");
        }
        if !self.conditions.is_empty() {
            out += &format!("\n[conditions]\n{}\n", self.conditions.join("\n"));
        }
        out += &format!("\n[columns]\n{:width$} = {{ name = \"time\", unit = \"s\" }}\n", self.time.0);
        for Column { described: [head, name, unit, frame, comment], .. } in self.columns {
            out += &format!(
                "{head:width$} = {{ name = \"{name}\", unit = \"{unit}\", sign = 1, frame = \"{frame}\", clock = \"log\" }}{comment}\n"
            );
        }
        out
    }
}

/// The model of `[simulate]` and its true coefficients, for the twin of a method.
pub(crate) fn truths<'c>(
    campaign: &'c Campaign,
    method: &str,
) -> Result<(&'c str, &'c IndexMap<String, f64>), MethodError> {
    let what = match campaign.simulate.as_ref().map(|simulate| &simulate.truth) {
        Some(Truth::Coefficients { model, values }) => return Ok((model, values)),
        Some(_) => format!(
            "the twin of {method} takes its truth from [simulate] model and [simulate.coefficients]; a record is not enough"
        ),
        None => "a twin needs [simulate]: seed, model, and the true coefficients".to_owned(),
    };
    Err(undeclared(campaign.path.display(), what))
}

/// True coefficients in the order of `names`.
pub(crate) fn true_values<const N: usize>(
    values: &IndexMap<String, f64>,
    names: [&str; N],
) -> Result<[f64; N], MethodError> {
    let mut out = [0.0; N];
    for (out, name) in out.iter_mut().zip(names) {
        let missing = || format!("{name} is missing; the truth needs {}", names.join(", "));
        *out = *values.get(name).ok_or_else(|| undeclared("[simulate.coefficients]", missing()))?;
    }
    Ok(out)
}
