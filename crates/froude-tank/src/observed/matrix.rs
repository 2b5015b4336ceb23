//! The run matrix of a plan: every configuration in all combinations of the planned conditions.

use froude_identify::declare::Values;
use froude_records::RecordError;
use froude_records::campaign::Source;
use froude_records::run::Role;
use froude_records::section::Section;
use froude_records::section_values::{Asks, MOST_RUNS};
use indexmap::IndexMap;

use super::method::{Observed, Point};
use crate::declared::{configurations, runs_of};

/// The runs of one `[[source.plan]]`, without names.
fn block<M: Observed>(s: &Section<'_>) -> Result<Vec<Point>, RecordError> {
    let spec = M::SPEC;
    let values = Values::read(s, spec.plan)?;
    values.at_most(MOST_RUNS)?;
    let has = |name: &str| spec.plan.iter().any(|key| key.name == name);
    let names = if has("configurations") { configurations(&values) } else { vec![String::new()] };
    let point =
        |configuration| Point { id: String::new(), role: Role::Test, configuration, conditions: IndexMap::new() };
    let mut points: Vec<Point> = names.into_iter().map(point).collect();
    for condition in spec.conditions.iter().filter(|condition| has(condition.name)) {
        let each = values.numbers(condition.name);
        let with = |point: &Point, value: &f64| {
            let mut point = point.clone();
            point.conditions.insert(condition.name, *value);
            point
        };
        points = points.iter().flat_map(|point| each.iter().map(move |value| with(point, value))).collect();
    }
    let repeats = if has("repeats") { values.need("repeats", values.count("repeats"))? } else { 1 };
    Ok(points.into_iter().flat_map(|point| std::iter::repeat_n(point, repeats)).collect())
}

/// The runs that a source plans, by their number.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn plan<M: Observed>(source: &Source) -> Result<Vec<Point>, RecordError> {
    let asks = |points: &Vec<Point>| Asks { count: points.len(), samples: 0.0 };
    let points = runs_of(source, M::SPEC.name, block::<M>, asks)?.into_iter().flatten();
    Ok(points.enumerate().map(|(i, point)| Point { id: format!("{:03}", i + 1), ..point }).collect())
}
