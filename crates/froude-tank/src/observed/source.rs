//! A method of single observations as a source of a campaign: a folder of logs, one run each, reduced to the rows of a table.

use froude_identify::declare::Values;
use froude_identify::method::{Declares, Found, MethodError, Need};
use froude_identify::reduce::reduce_table;
use froude_identify::source::identify_observations;
use froude_identify::uncertainty::SharedError;
use froude_records::RecordError;
use froude_records::campaign::{BudgetEntry, Campaign, Shared, Source};
use froude_records::estimate::ErrorKind;
use froude_records::run::{Frame, Role};
use froude_records::section::Section;
use froude_records::units::Dimension;
use indexmap::IndexMap;

use super::method::{ANGLE, Declared, Moves, Observed, Point, Run, Unstated, values};
use super::{plan, twin};
use crate::channel::Channel;
use crate::error::{TankError, undeclared};
use crate::log::TankLog;
use crate::logs::{self, Logs};
use crate::method::TankMethod;
use crate::steady::point::Point as Observation;
use crate::steady::row::{Row, table};
use crate::steady::walls::Walls;
use crate::steady::window::Told;

/// What runs alone need.
pub const NEEDS: &[Need] = &[Need::of(&["test"], &[])];

/// The method as it stands in the registry; `takes` has the keys of a source beside those of every source: its own section, `models`, `uncertainty`, `plan`.
#[must_use]
pub const fn method<M: Observed>(
    name: &'static [&'static str; 1],
    words: &'static [&'static str; 1],
    needs: &'static [Need],
    takes: &'static [&'static str],
) -> TankMethod {
    TankMethod {
        names: name,
        words,
        needs,
        runs: name[0],
        takes,
        identify: |campaign, source, _, progress| identified::<M>(campaign, source, progress),
        simulate: twin::files::<M>,
        plan: plan::prospect::<M>,
        declares: Declares { section: name[0], keys: M::SPEC.keys, plan: M::SPEC.plan },
        check: check::<M>,
    }
}

/// Reads the section of a method.
pub(super) fn section<M: Observed>(s: &Section<'_>) -> Result<Values, RecordError> {
    Values::read(s, M::SPEC.keys)
}

/// Reads section and plan of a source, so that an error in them is not passed over.
fn check<M: Observed>(source: &Source) -> Result<(), RecordError> {
    source.section(M::SPEC.name)?.map(|s| section::<M>(&s)).transpose()?;
    M::SPEC.planned().points(source, M::SPEC.name).map(drop)
}

/// The method as a source declares it; without a section of its own, as its defaults are.
pub(super) fn read<M: Observed>(campaign: &Campaign, source: &Source) -> Result<M, MethodError> {
    let spec = M::SPEC;
    let values = match source.section(spec.name)?.map(|s| section::<M>(&s)).transpose()? {
        Some(values) => values,
        None if spec.missing.is_empty() => Values::defaults(spec.name, spec.keys)?,
        None => return Err(undeclared(&source.place, spec.missing)),
    };
    M::read(&Declared { campaign, source, values: &values })
}

/// A run as it was reduced.
#[derive(Debug, Clone)]
pub struct Reduced<M: Observed> {
    /// What it is.
    pub point: Point,
    /// Its observation.
    pub observation: Observation,
    /// What the method found beside it.
    pub found: M::Found,
    /// What each of [`Observed::errors`] moves.
    pub moves: Vec<Moves>,
}

impl<M: Observed> Reduced<M> {
    /// Reduces a run.
    ///
    /// # Errors
    ///
    /// As [`Observed::reduce`].
    pub fn of(method: &M, run: &Run<'_>) -> Result<Self, TankError> {
        let (observation, found) = method.reduce(run, &values(&method.constants()))?;
        let moves = method.moves(run, &observation, &found)?;
        Ok(Self { point: run.point.clone(), observation, found, moves })
    }

    /// The place of a load.
    pub(super) fn load(&self, name: &str) -> Option<usize> {
        self.observation.loads.iter().position(|load| load.name == name)
    }
}

impl<M: Observed> From<Reduced<M>> for Row {
    /// A run of the twin as the row of a table.
    fn from(run: Reduced<M>) -> Self {
        Self {
            angle_rad: run.point.condition(ANGLE.name),
            run: run.point.id,
            configuration: run.point.configuration,
            temperature_k: None,
            point: run.observation,
        }
    }
}

fn identified<M: Observed>(
    campaign: &Campaign,
    source: &Source,
    progress: &dyn Fn(&str),
) -> Result<Found, MethodError> {
    let spec = M::SPEC;
    let method = read::<M>(campaign, source)?;
    progress("reading the runs");
    let Logs { runs: logs, mut files, mut findings } =
        logs::read(source.input.path(), spec.name, spec.roles, spec.reads, progress)?;
    let method = method.beside(&logs)?;
    progress("reducing the runs");
    let (mut rows, mut reduced, mut others) = (Vec::new(), Vec::new(), Vec::new());
    let mut first: Option<TankError> = None;
    for log in logs.iter().filter(|log| log.log.meta.role != Role::Still) {
        let run = run(&method, log)?;
        match Reduced::of(&method, &run) {
            Ok(found) => {
                logs::add_step(&mut files, log, method.step(log, &found));
                findings.extend(method.about_run(log, &run, &found));
                if found.point.role == Role::Test {
                    rows.push(Row::of(log, found.observation.clone())?);
                    reduced.push(found);
                } else {
                    others.push(found);
                }
            }
            Err(error) => {
                findings.push(logs::left_out(&error));
                first.get_or_insert(error);
            }
        }
    }
    if rows.is_empty() {
        return Err(logs::no_run(source, first));
    }
    let (mut errors, found) = method.corrected(&mut rows, &others, &source.name).map_err(MethodError::refused)?;
    findings.extend(found);
    let walls = Walls::of(campaign);
    findings.extend(rows.iter().filter_map(|row| walls.and_then(|walls| walls.finding(row))));
    let own = with_speeds(source, &method, &reduced);
    let mut observations = reduce_table(campaign, &own, &table(source.input.path(), &rows), files)?;
    errors.extend(shared(&method, &reduced, &observations.data.loads()));
    if !errors.is_empty() && observations.data.rows != rows.len() {
        let names: Vec<&str> = errors.iter().map(|error| error.name.as_str()).collect();
        let what = format!(
            "`keep` and errors that all runs share ({}) do not go together: leave the logs that are not meant out of the folder",
            names.join(", ")
        );
        return Err(undeclared(&source.place, what));
    }
    observations.shared_errors.extend(errors);
    let mut result = identify_observations(campaign, &own, observations, spec.name, &|model| {
        progress(&format!("fitting {model}"));
    })?;
    findings.append(&mut result.findings);
    let blocks = vec![method.section(&reduced, &rows, &logs)];
    Ok(Found { results: vec![result.into()], blocks, findings, ..Found::default() })
}

/// A log as a run; nothing about it is taken for granted.
fn run<'a, M: Observed>(method: &M, log: &'a TankLog) -> Result<Run<'a>, MethodError> {
    let meta = &log.log.meta;
    let refuse = |what: &str| MethodError::input(&log.log.path, what);
    let mut conditions = IndexMap::new();
    for condition in M::SPEC.conditions {
        let value = match (logs::condition(log, condition.name, condition.dimension)?, condition.otherwise) {
            (Some(stated), _) => Some(stated),
            (None, Unstated::Is(value)) => Some(value),
            (None, Unstated::Refused(what)) => return Err(refuse(what)),
            (None, Unstated::Nothing) => None,
        };
        conditions.extend(value.map(|value| (condition.name, value)));
    }
    let values = |channel: &'static Channel| {
        let name = channel.name;
        let found = logs::channel(log, name, channel.dimension, M::SPEC.guessed, channel.along)?;
        if M::SPEC.loads.contains(&name) && found.meaning.frame != Frame::Body {
            let what = format!(
                "{name} is along the axes of {:?}; loads are taken along those of the body: declare how the cell lies in [frames.cell] and write frame = \"cell\", or frame = \"body\" where it is mounted with the body",
                found.meaning.frame.name()
            );
            return Err(refuse(&what));
        }
        Ok((name, found.values.as_slice()))
    };
    let takes = method.takes(log).map_err(|what| refuse(&what))?;
    Ok(Run {
        point: Point { id: meta.id.clone(), role: meta.role, configuration: meta.configuration.clone(), conditions },
        time_s: &log.log.time_s,
        channels: takes.into_iter().map(values).collect::<Result<_, MethodError>>()?,
        told: Told { marks: &log.declared.marks, segments: &log.declared.segments },
    })
}

/// The source with the errors of its speeds in its budget: each run has one of its own.
#[must_use]
pub fn with_speeds<M: Observed>(source: &Source, method: &M, reduced: &[Reduced<M>]) -> Source {
    let square = |run: &Reduced<M>| (method.speed_standard_m_s(&run.found) / run.observation.speed_m_s).powi(2);
    let standard = (reduced.iter().map(square).sum::<f64>() / reduced.len() as f64).sqrt();
    let mut own = source.clone();
    if standard > 0.0 {
        own.uncertainty.push(BudgetEntry {
            quantity: "speed".to_owned(),
            standard,
            relative: true,
            shared: Shared::Sample,
            dof: None,
            name: Some(M::SPEC.speed_error.to_owned()),
            kind: ErrorKind::B,
            dimension: Dimension::ONE,
            place: source.place.clone(),
        });
    }
    own
}

/// What all runs have in common, as the rows take it.
///
/// A speed that is wrong by δU moves a load against its law by −2 f δU/U, as quadratic drag does.
#[must_use]
pub fn shared<M: Observed>(method: &M, reduced: &[Reduced<M>], loads: &[&str]) -> Vec<SharedError> {
    let one = |(k, name): (usize, &&str)| -> Option<SharedError> {
        let of_load = |load: &&str| {
            let row = |run: &Reduced<M>| {
                let (point, moves) = (&run.observation, &run.moves[k]);
                let own = run.load(load).map_or((0.0, 0.0), |l| (point.loads[l].value, moves.loads_n[l]));
                vec![own.1 - 2.0 * own.0 * moves.speed_m_s / point.speed_m_s]
            };
            ((*load).to_owned(), reduced.iter().map(row).collect::<Vec<_>>())
        };
        let directions: Vec<(String, Vec<Vec<f64>>)> = loads.iter().map(of_load).collect();
        let is_there = directions.iter().any(|(_, rows)| rows.iter().any(|row| row[0] != 0.0));
        // In standard uncertainties.
        is_there.then(|| SharedError { directions, ..SharedError::of_load(name, name, &[], 1.0, f64::INFINITY) })
    };
    method.errors().iter().enumerate().filter_map(one).collect()
}
