//! From a log as it was read to channels that a method can use: what its sidecar declares of the data is done to them, in this order.
//!
//! | step        | module      | what                                                                                                   |
//! |-------------|-------------|--------------------------------------------------------------------------------------------------------|
//! | `read`      | –           | columns by unit and sign (done by the importer)                                                        |
//! | `times`     | [`times`]   | times of a calendar are counted from the first sample of the log                                        |
//! | `gap`       | [`stretches`] | gaps are marked                                                                                      |
//! | –           | [`froude_identify::wild`] | a sample orders of magnitude away from all others is refused                                            |
//! | `clock`, `delay`, `filter` | [`align`] | stamps of another clock, and late ones, as times of the log                               |
//! | `clipped`   | [`clipped`] | readings at the end of the range, or flat at an extreme, are marked                                    |
//! | `resampled` | [`align`]   | channels whose stamps moved, by a cubic spline at the rows of the log; rows without data are cut        |
//! | `cell`      | [`loads`]   | bridges of a load cell as loads, by its matrix                                                         |
//! | `frame`     | [`loads`]   | loads along the sensor's axes as loads along the body's, about its reference point                     |
//! | `segment`, `mark` | [`stretches`] | the declared test, and what is not to be used                                                  |
//!
//! Every step stands in [`TankLog::done`]; what a reader should know of it is a finding.
//!
//! Not here: windows of a method, which leave marks out themselves (all but those of [`stretches::MARK_UNAWARE`]).

pub mod align;
pub mod clipped;
pub mod loads;
pub mod resolution;
pub mod stretches;
pub mod times;

use crate::log::TankLog;
use froude_identify::method::MethodError;
use froude_identify::wild;
use froude_records::run::step::Step;

/// Does to a run what its sidecar declares.
///
/// # Errors
///
/// Clocks without a time in common, bridges or loads that a matrix or a rotation needs and the log lacks, marks that leave nothing.
pub fn condition(run: &mut TankLog, method: &str) -> Result<(), MethodError> {
    let read = run.told.iter().filter_map(|(name, told)| {
        let meaning = &run.log.channels.get(name)?.meaning;
        let frame = told.frame.as_deref().unwrap_or_else(|| meaning.frame.name());
        let words = format!(
            "column {}, times {}, frame {frame}, clock {}; in {} from here on",
            told.column, told.sign, meaning.clock, meaning.unit
        );
        Some(Step::new("read", name, words).with("factor", told.factor, "1").with("sign", told.sign, "1"))
    });
    run.done.extend(read.collect::<Vec<_>>());
    times::from_the_first_sample(run);
    run.findings.extend(stretches::astray(&run.log, &run.declared.marks));
    resolution::check(run);
    if let Some(what) = wild::sample(&run.log, &run.declared.marks) {
        let sidecar = run.log.path.with_extension("toml");
        let advice = format!("correct the sample, or exclude it ([[marks]] with from and to in {})", sidecar.display());
        return Err(MethodError::input(&run.log.path, format!("{what}; {advice}")));
    }
    let stamps = align::stamps(run, method);
    stretches::mark_gaps(run, method, !stamps.is_empty());
    clipped::mark(run, &stamps);
    align::resample(run, &stamps)?;
    loads::of_cell(run)?;
    loads::in_body(run)?;
    stretches::cut(run, method)
}

/// Refuses a log whose steps of time are far longer than those of the others.
///
/// # Errors
///
/// The first such log, with both numbers.
pub fn of_one_rig(runs: &[TankLog]) -> Result<(), MethodError> {
    let Some((k, what)) = wild::steps(&runs.iter().map(|run| &run.log).collect::<Vec<_>>()) else { return Ok(()) };
    let path = &runs[k].log.path;
    let sidecar = path.with_extension("toml");
    let advice = format!("correct the unit in {}, or remove the log from the folder", sidecar.display());
    Err(MethodError::input(path, format!("{what}; {advice}")))
}
