//! Section, plan and logs as a method of single observations takes them.

use froude_identify::declare::Values;
use froude_identify::method::MethodError;
use froude_records::RecordError;
use froude_records::campaign::{Campaign, Source};
use froude_records::run::Frame;
use froude_records::section::Section;
use indexmap::IndexMap;

use super::method::{Declared, Observed};
use super::reduced::Reduced;
use super::spec::{Point, Run, Unstated, values};
use crate::channel::Channel;
use crate::error::{TankError, undeclared};
use crate::log::TankLog;
use crate::logs;
use crate::steady::window::Told;

/// Reads the section of a method.
pub(super) fn section<M: Observed>(s: &Section<'_>) -> Result<Values, RecordError> {
    Values::read(s, M::SPEC.keys)
}

/// Reads section and plan of a source, so that an error in them is not passed over.
pub(super) fn check<M: Observed>(source: &Source) -> Result<(), RecordError> {
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

/// Reduces a run.
///
/// # Errors
///
/// As [`Observed::reduce`].
pub fn reduced<M: Observed>(method: &M, run: &Run<'_>) -> Result<Reduced<M::Found>, TankError> {
    let (observation, found) = method.reduce(run, &values(&method.constants()))?;
    let moves = method.moves(run, &observation, &found)?;
    Ok(Reduced { point: run.point.clone(), observation, found, moves })
}

/// A log as a run; nothing about it is taken for granted.
pub(super) fn run<'a, M: Observed>(method: &M, log: &'a TankLog) -> Result<Run<'a>, MethodError> {
    let meta = &log.log.meta;
    let refuse = |what: &str| MethodError::input(&log.log.path, what);
    logs::only_conditions(log, M::SPEC.conditions.iter().map(|condition| condition.name))?;
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
