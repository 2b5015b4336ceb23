//! The run matrix of a plan: every configuration in all combinations of its axes, as often as each is repeated.

use froude_identify::declare::{IfMissing, Key, Kind, Values};
use froude_records::RecordError;
use froude_records::campaign::Source;
use froude_records::run::Role;
use froude_records::section::Section;
use froude_records::section_values::{Asks, MOST_RUNS};
use indexmap::IndexMap;

use crate::declared::{configurations, runs_of};

/// Configurations of a plan.
pub(crate) const CONFIGURATIONS: &str = "configurations";

/// What one run is.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Its name.
    pub id: String,
    /// What is mounted, and in what.
    pub role: Role,
    /// The configuration; empty where there is one without a name.
    pub configuration: String,
    /// Its conditions, and of a planned run all numbers of the plan, by name, SI; counts are numbers too.
    pub conditions: IndexMap<&'static str, f64>,
}

impl Point {
    /// A condition; 0 where it has none of this name.
    #[must_use]
    pub fn condition(&self, name: &str) -> f64 {
        self.conditions.get(name).copied().unwrap_or(0.0)
    }
}

/// How a method plans.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Plan {
    /// The keys of a block; their order is that of the loops, the last one the innermost.
    pub keys: &'static [Key],
    /// The key that states the role of a run, with the role of each of its words; without it all are of the first role.
    pub roles: (&'static str, &'static [Role]),
    /// How many runs a point is, and how long each lasts, s.
    pub asks: fn(&Point) -> (usize, f64),
    /// Checks the keys of a block against each other.
    pub check: fn(&Values) -> Result<(), RecordError>,
}

impl Plan {
    /// One run per point, of the role test.
    pub(crate) const fn of(keys: &'static [Key], lasts_s: fn(&Point) -> (usize, f64)) -> Self {
        Self { keys, roles: ("", &[Role::Test]), asks: lasts_s, check: |_| Ok(()) }
    }

    /// The runs that a source plans for a method, by their number.
    pub(crate) fn points(self, source: &Source, method: &str) -> Result<Vec<Point>, RecordError> {
        let asks = |points: &Vec<Point>| {
            points.iter().map(|point| ((self.asks)(point), point.condition("rate"))).fold(
                Asks { count: 0, samples: 0.0 },
                |sum, ((count, lasts_s), rate_hz)| Asks {
                    count: sum.count + count,
                    samples: sum.samples + count as f64 * lasts_s * rate_hz,
                },
            )
        };
        let points = runs_of(source, method, |s| self.block(s), asks)?.into_iter().flatten();
        Ok(points.enumerate().map(|(i, point)| Point { id: format!("{:03}", i + 1), ..point }).collect())
    }

    /// The runs of one `[[source.plan]]`, without names.
    fn block(self, s: &Section<'_>) -> Result<Vec<Point>, RecordError> {
        let values = Values::read(s, self.keys)?;
        values.at_most(MOST_RUNS)?;
        (self.check)(&values)?;
        let (role, mut repeats) = (self.roles.1[0], 1);
        let mut points =
            vec![Point { id: String::new(), role, configuration: String::new(), conditions: IndexMap::new() }];
        for key in self.keys {
            let name = key.name;
            match key.kind {
                Kind::Texts if name == CONFIGURATIONS => {
                    let each = configurations(&values);
                    points = with_each(&points, &each, |point, own| point.configuration.clone_from(own));
                }
                Kind::Text if name == "configuration" => {
                    for point in &mut points {
                        values.text(name).unwrap_or_default().clone_into(&mut point.configuration);
                    }
                }
                Kind::Word(_) if name == self.roles.0 => {
                    let role = values.need(name, values.word(name, self.roles.1))?;
                    for point in &mut points {
                        point.role = role;
                    }
                }
                Kind::Count(_) if name == "repeats" => repeats = values.need(name, values.count(name))?,
                // Of two axes that exclude each other one is missing, which `check` sees to.
                Kind::Axis(_) | Kind::Frequency
                    if matches!(key.default, IfMissing::Nothing(_)) && !values.is_stated(name) => {}
                Kind::Axis(_) | Kind::Frequency => {
                    let put = |point: &mut Point, value: &f64| point.conditions.extend([(name, *value)]);
                    points = with_each(&points, &values.numbers(name), put);
                }
                Kind::Count(_) | Kind::Whole | Kind::Quantity(_) | Kind::Number => {
                    let is_count = matches!(key.kind, Kind::Count(_) | Kind::Whole);
                    let number =
                        if is_count { values.count(name).map(|count| count as f64) } else { values.number(name) };
                    for point in &mut points {
                        point.conditions.extend(number.map(|number| (name, number)));
                    }
                }
                _ => {}
            }
        }
        Ok(with_each(&points, &vec![(); repeats], |_, ()| ()))
    }
}

/// Each point with each of the values.
fn with_each<T>(points: &[Point], each: &[T], put: impl Fn(&mut Point, &T)) -> Vec<Point> {
    let with = |point: &Point, value: &T| {
        let mut point = point.clone();
        put(&mut point, value);
        point
    };
    points.iter().flat_map(|point| each.iter().map(|value| with(point, value)).collect::<Vec<_>>()).collect()
}

/// Configurations of planned runs, in order of first appearance.
pub(crate) fn of_configurations<'p>(points: impl Iterator<Item = &'p Point>) -> Vec<String> {
    froude_identify::dataset::distinct(&points.map(|point| point.configuration.clone()).collect::<Vec<_>>())
}
