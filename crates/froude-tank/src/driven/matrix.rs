//! The run matrix of a plan: every configuration in every condition, with every amplitude at every frequency.

use froude_identify::declare::Values;
use froude_records::RecordError;
use froude_records::campaign::Source;
use froude_records::run::Role;
use froude_records::section::Section;
use froude_records::section_values::MOST_RUNS;
use froude_rig::swung::Swing;
use indexmap::IndexMap;

use super::method::MotorDriven;
use super::spec::Point;
use crate::declared::{Swings, configurations as configurations_of, runs_of};

/// Configurations of a plan.
pub(super) const CONFIGURATIONS: &str = "configurations";

/// One planned run.
#[derive(Debug, Clone, PartialEq)]
pub struct Planned {
    /// Its name.
    pub id: String,
    /// What it is.
    pub point: Point,
    /// How the body is moved.
    pub swing: Swing,
    /// Samples a second.
    pub rate_hz: f64,
    /// One factor \[-\] for each group of coefficients that vary from run to run; a missing factor is 1.
    pub of_drag: Vec<f64>,
}

/// One block of planned runs.
#[derive(Debug, Clone, PartialEq)]
pub struct Block {
    /// All runs but for their motions, in order.
    points: Vec<Point>,
    swings: Swings,
}

/// Reads a `[[source.plan]]`.
fn block<M: MotorDriven>(s: &Section<'_>) -> Result<Block, RecordError> {
    let spec = M::SPEC;
    let values = Values::read(s, spec.plan)?;
    values.at_most(MOST_RUNS)?;
    let has = |name: &str| spec.plan.iter().any(|key| key.name == name);
    let (key, roles) = spec.roles;
    let role = if has(key) { values.need(key, values.word(key, roles))? } else { Role::Test };
    let names = if has(CONFIGURATIONS) { configurations_of(&values) } else { vec![String::new()] };
    let point = |configuration: String| Point { role, configuration, conditions: IndexMap::new() };
    let mut points: Vec<Point> = names.into_iter().map(point).collect();
    for condition in spec.conditions.iter().filter(|condition| has(condition.name)) {
        let each = values.numbers(condition.name);
        let with = |point: &Point, value: f64| {
            let mut point = point.clone();
            point.conditions.insert(condition.name, value);
            point
        };
        points = points.iter().flat_map(|point| each.iter().map(move |value| with(point, *value))).collect();
    }
    Ok(Block { points, swings: Swings::of(&values)? })
}

/// The blocks of a source's plan.
///
/// # Errors
///
/// [`RecordError`] with its place.
pub fn plan<M: MotorDriven>(source: &Source) -> Result<Vec<Block>, RecordError> {
    runs_of(source, M::SPEC.name, block::<M>, |block| block.swings.asks(block.points.len()))
}

/// Every run of a plan, by its number.
#[must_use]
pub fn planned(blocks: &[Block]) -> Vec<Planned> {
    let mut out = Vec::new();
    for Block { points, swings } in blocks {
        for point in points {
            for swing in swings.each() {
                let id = format!("{:03}", out.len() + 1);
                out.push(Planned { id, point: point.clone(), swing, rate_hz: swings.rate_hz, of_drag: Vec::new() });
            }
        }
    }
    out
}

/// Configurations of planned runs, in order of first appearance.
#[must_use]
pub fn configurations(planned: &[Planned]) -> Vec<String> {
    froude_identify::dataset::distinct(&planned.iter().map(|run| run.point.configuration.clone()).collect::<Vec<_>>())
}
