//! A method of single observations as a source of a campaign: a folder of logs, one run each, reduced to the rows of a table.

use froude_identify::method::{Declares, Found, MethodError, Need};
use froude_identify::reduce::reduce_table;
use froude_identify::source::identify_observations;
use froude_identify::uncertainty::SharedError;
use froude_records::campaign::{BudgetEntry, Campaign, Shared, Source};
use froude_records::estimate::ErrorKind;
use froude_records::run::Role;
use froude_records::units::Dimension;
use indexmap::IndexMap;

use super::method::Observed;
use super::read::{check, read, reduced, run};
use super::reduced::Reduced;
use super::{plan, twin};
use crate::error::{TankError, undeclared};
use crate::log::TankLog;
use crate::logs::{self, Logs, Wanted};
use crate::method::TankMethod;
use crate::steady::row::{Row, table};
use crate::steady::walls::Walls;

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

fn identified<M: Observed>(
    campaign: &Campaign,
    source: &Source,
    progress: &dyn Fn(&str),
) -> Result<Found, MethodError> {
    let spec = M::SPEC;
    let method = read::<M>(campaign, source)?;
    progress("reading the runs");
    let Logs { runs: logs, mut files, mut findings } =
        logs::read(source.input.path(), &Wanted::of(spec.name, spec.roles, spec.reads), progress)?;
    let method = method.beside(&logs)?;
    progress("reducing the runs");
    let (mut rows, mut observed, mut others) = (Vec::new(), Vec::new(), Vec::new());
    let mut first: Option<TankError> = None;
    for log in logs.iter().filter(|log| log.log.meta.role != Role::Still) {
        let run = run(&method, log)?;
        match reduced(&method, &run) {
            Ok(found) => {
                logs::add_step(&mut files, log, method.step(log, &found));
                findings.extend(method.about_run(log, &run, &found));
                if found.point.role == Role::Test {
                    rows.push(Row::of(log, found.observation.clone())?);
                    observed.push(found);
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
    let own = with_scales(with_speeds(source, &method, &observed), &logs);
    let mut observations = reduce_table(campaign, &own, &table(source.input.path(), &rows), files)?;
    errors.extend(shared(&method, &observed, &observations.data.loads()));
    if !errors.is_empty() && observations.data.rows != rows.len() {
        let names: Vec<&str> = errors.iter().map(|error| error.name.as_str()).collect();
        let what = format!(
            "`keep` and errors that all runs share ({}) cannot be combined: move unwanted logs out of the folder",
            names.join(", ")
        );
        return Err(undeclared(&source.place, what));
    }
    observations.shared_errors.extend(errors);
    observations.data.stated = stated(&observed);
    let mut result = identify_observations(campaign, &own, observations, spec.name, &|model| {
        progress(&format!("fitting {model}"));
    })?;
    findings.append(&mut result.findings);
    let blocks = vec![method.section(&observed, &rows, &logs)];
    Ok(Found { results: vec![result.into()], blocks, findings, ..Found::default() })
}

/// Loads that no sensor read in any run.
fn stated<F>(reduced: &[Reduced<F>]) -> Vec<String> {
    let loads = reduced.iter().flat_map(|run| &run.observation.loads);
    let (read, stated): (Vec<_>, Vec<_>) = loads.partition(|load| load.is_read());
    let mut names: Vec<String> = stated.iter().map(|load| load.name.clone()).collect();
    names.sort();
    names.dedup();
    names.retain(|name| read.iter().all(|load| load.name != *name));
    names
}

/// The source with the errors of its speeds in its budget: each run has one of its own.
#[must_use]
pub fn with_speeds<M: Observed>(source: &Source, method: &M, reduced: &[Reduced<M::Found>]) -> Source {
    let square = |run: &Reduced<M::Found>| (method.speed_standard_m_s(&run.found) / run.observation.speed_m_s).powi(2);
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

/// The source with the errors of the constants that scale its channels: the same for all runs.
fn with_scales(mut source: Source, logs: &[TankLog]) -> Source {
    let mut errors: IndexMap<(&str, &str), f64> = IndexMap::new();
    for (channel, told) in logs.iter().flat_map(|log| &log.told) {
        let quantity = if channel.ends_with("position") { "speed" } else { channel.as_str() };
        for (constant, part) in &told.scale_errors {
            let known = errors.entry((quantity, constant)).or_default();
            // The effect of a constant is found by differences, to ten digits.
            *known = known.max((1e9 * part).round() / 1e9);
        }
    }
    let entry = |((quantity, constant), standard): ((&str, &str), f64)| BudgetEntry {
        quantity: quantity.to_owned(),
        standard,
        relative: true,
        shared: Shared::Campaign,
        dof: None,
        name: Some(format!("{constant}, which scales {quantity}")),
        kind: ErrorKind::B,
        dimension: Dimension::ONE,
        place: source.place.clone(),
    };
    let entries: Vec<BudgetEntry> = errors.into_iter().map(entry).collect();
    source.uncertainty.extend(entries);
    source
}

/// What all runs have in common, as the rows take it: what it moves each load by, and the speed.
#[must_use]
pub fn shared<M: Observed>(method: &M, reduced: &[Reduced<M::Found>], loads: &[&str]) -> Vec<SharedError> {
    let one = |(k, name): (usize, &&str)| -> Option<SharedError> {
        let rows = |of: &dyn Fn(&Reduced<M::Found>) -> f64| reduced.iter().map(|run| vec![of(run)]).collect();
        let of_load = |load: &&str| {
            let moved = |run: &Reduced<M::Found>| run.load(load).map_or(0.0, |l| run.moves[k].loads_n[l]);
            ((*load).to_owned(), rows(&moved))
        };
        let speed = ("speed".to_owned(), rows(&|run| run.moves[k].speed_m_s));
        let directions: Vec<(String, Vec<Vec<f64>>)> = loads.iter().map(of_load).chain([speed]).collect();
        let is_there = directions.iter().any(|(_, rows)| rows.iter().any(|row| row[0] != 0.0));
        // In standard uncertainties.
        is_there.then(|| SharedError { directions, ..SharedError::of_load(name, name, &[], 1.0, f64::INFINITY) })
    };
    method.errors().iter().enumerate().filter_map(one).collect()
}
