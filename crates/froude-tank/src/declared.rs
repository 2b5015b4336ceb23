//! What the methods read of their sections of a campaign alike: constants, cycles, frequencies, plans.

use froude_fit::budget::Uncertain;
use froude_identify::declare::{Key, Kind, Range, Values, optional, required, usual};
use froude_identify::method::MethodError;
use froude_records::RecordError;
use froude_records::campaign::{BudgetEntry, Source};
use froude_records::run::Declared;
use froude_records::section::Section;
use froude_records::section_values::{Asks, MOST_RUNS, OF_RUNS, plan_of};
use froude_records::units::Dimension;

use crate::error::undeclared;
use crate::motion::Cycles;

/// N/m.
pub(crate) const STIFFNESS: Dimension = Dimension::new(0, 1, -2);
/// kg m².
pub(crate) const INERTIA: Dimension = Dimension::new(2, 1, 0);

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
    read: impl Fn(&Section<'_>) -> Result<T, RecordError>,
    asks: impl Fn(&T) -> Asks,
) -> Result<Vec<T>, RecordError> {
    plan_of(&source.blocks(method)?, OF_RUNS, MOST_RUNS, read, asks)
}

/// As a budget takes it.
#[must_use]
pub fn uncertain(declared: Declared) -> Uncertain {
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

/// Which cycles are used.
pub const CYCLES: Key = usual(
    "cycles",
    Kind::Table(&[
        usual("skip", Kind::Whole, "1", "left out after the motion has begun"),
        optional("used", Kind::Whole, "all", "used after those"),
        usual("fewest", Kind::Whole, "5", "fewest that are accepted"),
    ]),
    "{ skip = 1, fewest = 5 }",
    "`skip`: whole cycles left out at the start of the motion; `used`: cycles used after those (else all, with the incomplete one at the end); `fewest`: fewest whole cycles accepted",
);
/// Harmonics of the angle.
pub const HARMONICS: Key = usual("harmonics", Kind::Count(20), "3", "number of harmonics fitted to the motion");

/// Of the values of [`CYCLES`].
pub(crate) fn cycles(values: &Values) -> Result<Cycles, RecordError> {
    let cycles = values.need("cycles", values.table("cycles"))?;
    let number = |key: &str| cycles.need(key, cycles.count(key));
    Ok(Cycles { skip: number("skip")?, used: cycles.count("used"), fewest: number("fewest")? })
}

/// Frequencies of a motion.
pub const FREQUENCY: Key = required(
    "frequency",
    Kind::Frequency,
    "write \"0.2 Hz\" or \"70 deg/s\", a list, or { start, stop, step }",
    "in Hz, or as an angular frequency in deg/s or rad/s",
)
.within(Range::Positive);
/// Length of a run.
pub const PERIODS: Key = usual("periods", Kind::Count(100_000), "7", "periods in each run, start-up included");
/// Time at rest before a run.
pub const STILL: Key = usual("still", Kind::Quantity(Dimension::TIME), "1 s", "time at rest before each run")
    .within(Range::NotNegative("a time that passes is not"));
/// Rate of the log.
pub const RATE: Key = usual("rate", Kind::Quantity(Dimension::ANGULAR_SPEED), "100 Hz", "sampling rate of the log")
    .within(Range::Positive);
/// Repeats of a run.
pub const REPEATS: Key = usual("repeats", Kind::Count(MOST_RUNS as u64), "1", "number of times each run is made");

/// Configurations of a block of a plan; one empty text where the body has only one and none to name.
pub(crate) fn configurations(values: &Values) -> Vec<String> {
    match values.texts("configurations") {
        [] => vec![String::new()],
        named => named.to_vec(),
    }
}

/// Amplitudes of a motion; `advice` is what to write.
#[must_use]
pub const fn amplitude(dimension: Dimension, advice: &'static str, doc: &'static str) -> Key {
    required("amplitude", Kind::Axis(dimension), advice, doc).within(Range::Positive)
}
