//! Values of a section: counts, words of a list, series.

use crate::error::{Place, RecordError};
use crate::nearest::suggestion;
use crate::section::{Section, Value};
use crate::units::Dimension;

/// Most values of one range of a plan: a million runs is a slip of the step.
pub const MOST_STEPS: f64 = 100_000.0;

/// A stop this part of a step beyond the last one is on it: the rounding of a step with a few digits.
pub const ON_A_STEP: f64 = 1e-6;

/// One of a few words, with the nearest known one in the message.
///
/// # Errors
///
/// [`RecordError::Value`] with its place where it is something else.
pub fn one_of<T: Copy>(
    s: &Section<'_>,
    key: &'static str,
    names: &[&'static str],
    values: &[T],
) -> Result<Option<T>, RecordError> {
    let Some(value) = s.get(key) else { return Ok(None) };
    let text = s.as_text(key, value)?;
    let found = names.iter().position(|name| *name == text).and_then(|at| values.get(at));
    let problem = || format!("is {text:?}; {}", suggestion(text, names.iter().copied()));
    found.copied().map(Some).ok_or_else(|| s.wrong(key, value, problem()))
}

/// A whole number from 1 to `most`.
///
/// # Errors
///
/// [`RecordError::Value`] with its place where it is something else.
pub fn count(s: &Section<'_>, key: &'static str, most: u64) -> Result<Option<usize>, RecordError> {
    let Some(n) = s.integer(key)? else { return Ok(None) };
    s.refuse(key, n == 0 || n > most, format!("is {n}; it must lie between 1 and {most}"))?;
    Ok(Some(n as usize))
}

/// Checks the product of a section's numbers against a limit: each may be small and the product large.
///
/// # Errors
///
/// The product exceeds `most`.
pub fn at_most(place: &Place, numbers: &[(&str, usize)], most: usize) -> Result<(), RecordError> {
    let product = product(numbers);
    if product <= most {
        return Ok(());
    }
    let others: Vec<String> = numbers.iter().skip(1).map(|(key, n)| format!(" × `{key}` ({n})")).collect();
    let (first, n) = numbers.first().copied().unwrap_or_default();
    let problem = format!("({n}){} is {product}; at most {most} are made", others.concat());
    Err(RecordError::value(place.clone(), first, problem))
}

/// Their product; the largest number where it is larger than that.
#[must_use]
pub fn product(numbers: &[(&str, usize)]) -> usize {
    numbers.iter().fold(1_usize, |product, (_, n)| product.saturating_mul(*n))
}

/// Most planned runs of a source: at two minutes a run two weeks in the tank.
pub const MOST_RUNS: usize = 10_000;

/// What they are, and why so many, in the message of [`plan_of`].
pub const OF_RUNS: [&str; 2] = ["runs", "two weeks in the tank"];

/// `configurations` of a block; one empty text where the body has only one and none to name.
///
/// # Errors
///
/// [`RecordError::Value`] with its place where it is something else.
pub fn configurations(s: &Section<'_>) -> Result<Vec<String>, RecordError> {
    let named = s.texts("configurations")?;
    Ok(if named.is_empty() { vec![String::new()] } else { named })
}

/// What one block of a plan asks for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Asks {
    /// Runs, observations or cases.
    pub count: usize,
    /// Samples of all its runs; 0 where none are simulated.
    pub samples: f64,
}

/// Reads the blocks of a plan. What they ask for is summed as they are read, so that the first one too many ends it before more is made.
///
/// # Errors
///
/// [`RecordError::Value`] with its place where it is something else.
pub fn plan_of<T>(
    sections: &[Section<'_>],
    [what, most_text]: [&str; 2],
    most: usize,
    read: impl Fn(&Section<'_>) -> Result<T, RecordError>,
    asks: impl Fn(&T) -> Asks,
) -> Result<Vec<T>, RecordError> {
    let mut out = Vec::new();
    let mut sum = Asks { count: 0, samples: 0.0 };
    for section in sections {
        let block = read(section)?;
        let own = asks(&block);
        sum = Asks { count: sum.count.saturating_add(own.count), samples: sum.samples + own.samples };
        let refuse = |found: String, most: String| {
            let problem =
                format!("asks for {found} up to this block; {most}: make lists shorter, or split the campaign");
            Err(RecordError::value(section.place(), "plan", problem))
        };
        if sum.count > most {
            return refuse(format!("{} {what}", sum.count), format!("at most {most} are made ({most_text})"));
        }
        if sum.samples > MOST_SAMPLES {
            let found = format!("{} runs with {:.0} samples", sum.count, sum.samples);
            return refuse(found, format!("at most {MOST_SAMPLES:.0} samples are simulated"));
        }
        out.push(block);
    }
    Ok(out)
}

/// Most samples of all runs of a plan: every run is simulated whole to say what to expect, at some 50 bytes a sample (measured: a forced oscillation).
pub const MOST_SAMPLES: f64 = 1e7;

/// One value, a list, or start, stop and step.
///
/// # Errors
///
/// [`RecordError::Value`] with its place where it is something else.
pub fn series<'a>(
    s: &Section<'a>,
    key: &'static str,
    value: &'a Value<'a>,
    dimension: Dimension,
) -> Result<Vec<f64>, RecordError> {
    if let Some(list) = value.get_ref().as_array() {
        if list.is_empty() {
            return Err(s.wrong(key, value, "is an empty list; write at least one quantity"));
        }
        return list.iter().map(|v| s.as_quantity_of(key, v, dimension)).collect();
    }
    if value.get_ref().as_table().is_none() {
        return Ok(vec![s.as_quantity_of(key, value, dimension)?]);
    }
    let range = s.as_section(key, value)?;
    range.only(&["start", "stop", "step"])?;
    let need = |end: &'static str| {
        let value = range.need(end, "a range needs start, stop and step")?;
        range.as_written(end, value, key, dimension)
    };
    let (start, stop, step) = (need("start")?, need("stop")?, need("step")?);
    let count = (stop.value_si - start.value_si) / step.value_si;
    if !(count.is_finite() && (0.0..=MOST_STEPS).contains(&count)) {
        return Err(s.wrong(key, value, "must go from start to stop in at most 100000 steps of the step's sign"));
    }
    let steps = (count + ON_A_STEP).floor();
    if count - steps > ON_A_STEP {
        // A stop that is not reached is a value that somebody asked for and would not get.
        let last = short(start.unit.from_si(start.value_si + steps * step.value_si));
        let [one, other] = steps_that_fit((stop.value_si - start.value_si) / step.unit.factor, count);
        let (first, unit) = (&start.unit, &step.unit);
        let problem = format!(
            "goes from {start} in steps of {step} to {last} {first} and does not reach {stop}; write step = \"{one} {unit}\" or \
             \"{other} {unit}\", or another stop"
        );
        return Err(s.wrong(key, value, problem));
    }
    // In the written unit 0.02 + 49·0.02 is exactly what a person means; converted once.
    let of = |k: usize| {
        let value = start.unit.from_si(start.value_si) + k as f64 * start.unit.from_si(step.value_si);
        start.unit.to_si((value * 1e12).round() / 1e12)
    };
    Ok((0..=steps as usize).map(of).collect())
}

/// Two steps that divide `way` (of either sign), next to where `count` of them would: short numbers, where there are any.
pub fn steps_that_fit(way: f64, count: f64) -> [f64; 2] {
    let near = |a: &f64, b: &f64| (a - count).abs().total_cmp(&(b - count).abs());
    let is_short = |n: &f64| {
        let step = way / n;
        format!("{step:.2e}").parse::<f64>().is_ok_and(|s| (s - step).abs() <= 1e-9 * step.abs())
    };
    let mut numbers: Vec<f64> = (1..=(4.0 * count + 4.0) as u32).map(f64::from).filter(is_short).collect();
    numbers.sort_by(near);
    numbers.extend([count.floor().max(1.0), count.floor().max(1.0) + 1.0]);
    numbers.dedup();
    [0, 1].map(|i| short(way / numbers[i]))
}

/// Ten digits: hides the rounding of a unit's factor.
#[must_use]
pub fn short(x: f64) -> f64 {
    format!("{x:.9e}").parse().unwrap_or(x)
}
