//! What the methods read of their sections of a campaign alike: constants, cycles, frequencies, plans.

use std::f64::consts::TAU;

use froude_fit::budget::Uncertain;
use froude_identify::method::MethodError;
use froude_records::RecordError;
use froude_records::campaign::{BudgetEntry, Source};
use froude_records::run::{Declared, declared, declared_value};
use froude_records::section::{Section, Value, found};
use froude_records::section_values::{Asks, MOST_RUNS, OF_RUNS, count, plan_of, series};
use froude_records::units::Dimension;
use froude_rig::swung::Swing;
use indexmap::IndexMap;

use crate::error::undeclared;
use crate::motion::Cycles;

/// N/m.
pub(crate) const STIFFNESS: Dimension = Dimension::new(0, 1, -2);
/// kg m².
pub(crate) const INERTIA: Dimension = Dimension::new(2, 1, 0);
/// Most periods of a run.
const MOST_PERIODS: u64 = 100_000;

/// A section of a source, which the method needs; `write` states what to write where there is none.
pub(crate) fn needed<T>(
    source: &Source,
    name: &'static str,
    read: fn(&Section<'_>) -> Result<T, RecordError>,
    write: &str,
) -> Result<T, MethodError> {
    let read = source.section(name)?.map(|s| read(&s)).transpose()?;
    read.ok_or_else(|| undeclared(&source.place, write))
}

/// Reads section and plan of a method, so that an error in them is not passed over.
pub(crate) fn check<T, P>(
    source: &Source,
    name: &'static str,
    read: fn(&Section<'_>) -> Result<T, RecordError>,
    plan: fn(&Source) -> Result<P, RecordError>,
) -> Result<(), RecordError> {
    source.section(name)?.map(|s| read(&s)).transpose()?;
    plan(source).map(drop)
}

/// The plan of a source, where its blocks have the form of a method.
pub(crate) fn runs_of<T>(
    source: &Source,
    method: &str,
    read: fn(&Section<'_>) -> Result<T, RecordError>,
    asks: impl Fn(&T) -> Asks,
) -> Result<Vec<T>, RecordError> {
    plan_of(&source.blocks(method)?, OF_RUNS, MOST_RUNS, read, asks)
}

/// As a budget takes it.
pub(crate) fn uncertain(declared: Declared) -> Uncertain {
    Uncertain::new(declared.value, declared.standard_uncertainty)
}

/// The gain error that an entry of the budget states; `zero` is why it has no part that is absolute.
pub(crate) fn gain(entry: &BudgetEntry, zero: &str) -> Result<f64, MethodError> {
    let what = || {
        format!(
            "the uncertainty of {} is a gain that all runs share: write it as a percentage ({zero}, and noise shows in the scatter)",
            entry.quantity
        )
    };
    entry.relative.then_some(entry.standard).ok_or_else(|| undeclared(&entry.place, what()))
}

/// A declared constant that must be larger than zero.
pub(crate) fn above_zero(
    s: &Section<'_>,
    key: &'static str,
    dimension: Dimension,
) -> Result<Option<Declared>, RecordError> {
    match (declared(s, key, dimension)?, s.get(key)) {
        (Some(number), Some(value)) if number.value <= 0.0 => Err(s.wrong(key, value, "must be larger than zero")),
        (number, _) => Ok(number),
    }
}

/// A number that each configuration has, or all have alike.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct ByConfiguration {
    /// Of all that are not named.
    pub all: Option<Declared>,
    /// By configuration.
    pub named: IndexMap<String, Declared>,
}

impl ByConfiguration {
    /// Reads one number for all, or a table with one for each configuration.
    pub(crate) fn read(s: &Section<'_>, key: &'static str, dimension: Dimension) -> Result<Self, RecordError> {
        let mut out = Self::default();
        let Some(value) = s.get(key) else { return Ok(out) };
        let table = value.get_ref().as_table().map(|_| s.as_section(key, value)).transpose()?;
        let Some(table) = table.filter(|table| table.get("value").is_none()) else {
            return Ok(Self { all: declared(s, key, dimension)?, ..out });
        };
        for (configuration, _, value) in table.entries() {
            let number = declared_value(&table, configuration, value, dimension)?;
            out.named.insert(configuration.to_owned(), number);
        }
        Ok(out)
    }

    /// That of a configuration.
    #[must_use]
    pub fn of(&self, configuration: &str) -> Option<Declared> {
        self.named.get(configuration).copied().or(self.all)
    }
}

/// `cycles`: whole ones left out, used, and fewest.
pub(crate) fn cycles(s: &Section<'_>) -> Result<Cycles, RecordError> {
    let mut out = Cycles::default();
    let Some(cycles) = s.section("cycles")? else { return Ok(out) };
    cycles.only(&["skip", "used", "fewest"])?;
    let number = |key: &'static str| Ok::<_, RecordError>(cycles.integer(key)?.map(|n| n as usize));
    out.used = number("used")?;
    out.skip = number("skip")?.unwrap_or(out.skip);
    out.fewest = number("fewest")?.unwrap_or(out.fewest);
    Ok(out)
}

/// How a motor moves a body in the runs of one block of a plan: every amplitude at every frequency.
#[derive(Debug, Clone, PartialEq)]
pub struct Swings {
    /// Amplitudes of the angle.
    pub amplitude_rad: Vec<f64>,
    /// Angular frequencies.
    pub omega_rad_s: Vec<f64>,
    /// Periods of each run, start-up included.
    pub periods: f64,
    /// Time at rest before each.
    pub still_s: f64,
    /// Samples a second.
    pub rate_hz: f64,
    /// How often each is run.
    pub repeats: usize,
}

impl Swings {
    /// Reads `amplitude`, `frequency`, `periods`, `still`, `rate` and `repeats`; `like` is an amplitude in messages.
    pub(crate) fn read(s: &Section<'_>, like: &str) -> Result<Self, RecordError> {
        let need = |key: &'static str, example: &str| {
            s.get(key).ok_or_else(|| s.missing(key, &format!("write {example}, a list, or {{ start, stop, step }}")))
        };
        let amplitude = need("amplitude", &format!("\"{like}\""))?;
        let frequency = need("frequency", "\"0.2 Hz\" or \"70 deg/s\"")?;
        let out = Self {
            amplitude_rad: series(s, "amplitude", amplitude, Dimension::ANGLE)?,
            omega_rad_s: angular(s, frequency)?,
            periods: count(s, "periods", MOST_PERIODS)?.unwrap_or(7) as f64,
            still_s: s.quantity("still", Dimension::TIME)?.unwrap_or(1.0),
            rate_hz: s.positive("rate", Dimension::ANGULAR_SPEED)?.unwrap_or(100.0),
            repeats: count(s, "repeats", MOST_RUNS as u64)?.unwrap_or(1),
        };
        for (key, value, numbers) in
            [("amplitude", amplitude, &out.amplitude_rad), ("frequency", frequency, &out.omega_rad_s)]
        {
            if numbers.iter().any(|x| *x <= 0.0) {
                return Err(s.wrong(key, value, format!("is {}; all must be larger than zero", found(value))));
            }
        }
        Ok(out)
    }

    /// Every amplitude at every frequency, as often as each is run.
    pub(crate) fn each(&self) -> impl Iterator<Item = Swing> + '_ {
        let (still_s, periods) = (self.still_s, self.periods);
        let swing = move |amplitude_rad, omega_rad_s| Swing { amplitude_rad, omega_rad_s, still_s, periods };
        let of_amplitude = move |a: f64| self.omega_rad_s.iter().map(move |w| swing(a, *w));
        let all = self.amplitude_rad.iter().copied().flat_map(of_amplitude);
        all.flat_map(|swing| std::iter::repeat_n(swing, self.repeats))
    }

    /// What they ask for, `times` over: the periods of each, with still water before and behind them.
    pub(crate) fn asks(&self, times: usize) -> Asks {
        let count = times * self.amplitude_rad.len() * self.omega_rad_s.len() * self.repeats;
        // Every frequency stands in an equal part of the runs.
        let sum_s = self.omega_rad_s.iter().map(|w| TAU * self.periods / w).sum::<f64>();
        let mean_s = sum_s / self.omega_rad_s.len().max(1) as f64;
        Asks { count, samples: count as f64 * (mean_s + 2.0 * self.still_s) * self.rate_hz }
    }
}

/// Frequencies as angular ones: a number of Hz counts periods, any other unit of the kind counts radians.
fn angular<'a>(s: &Section<'a>, value: &'a Value<'a>) -> Result<Vec<f64>, RecordError> {
    let is_hertz = |v: &Value<'_>| v.get_ref().as_str().is_some_and(|text| text.trim_end().ends_with("Hz"));
    let bare = |v: &Value<'_>| v.get_ref().as_str().is_some_and(|text| text.contains("1/s") || text.contains("s^-1"));
    let parts: Vec<&Value<'_>> = match (value.get_ref().as_array(), value.get_ref().as_table()) {
        (Some(list), _) => list.iter().collect(),
        (_, Some(table)) => table.values().collect(),
        _ => vec![value],
    };
    if parts.iter().any(|v| bare(v)) {
        return Err(s.wrong(
            "frequency",
            value,
            "is in 1/s, which says neither periods nor radians; write Hz, or rad/s",
        ));
    }
    let hertz = parts.iter().filter(|v| is_hertz(v)).count();
    if hertz > 0 && hertz < parts.len() {
        return Err(s.wrong("frequency", value, "is partly in Hz and partly an angular frequency; write one of them"));
    }
    let factor = if hertz > 0 { TAU } else { 1.0 };
    Ok(series(s, "frequency", value, Dimension::ANGULAR_SPEED)?.into_iter().map(|x| factor * x).collect())
}
