//! The list of all methods, and the one that a source asks for.

use std::path::Path;

use froude_added_mass::source::AddedMass;
use froude_carriage::source::Carriage;
use froude_identify::IdentifyError;
use froude_identify::method::{Logs, Method};
use froude_identify::table::Table;
use froude_records::campaign::{Campaign, Input, Source};
use froude_records::campaign_file;
use froude_records::nearest::meant;
use froude_rig::carriage::{declared, keys::CARRIAGE, keys::RIG};

use crate::Error;
use crate::registry::METHODS;
use froude_cfd::verb::Computed;

/// A method with the names that it is asked for.
pub(crate) type Asked = (&'static dyn Method, Vec<&'static str>);

/// Reads a campaign, and every section in it that belongs to a method or to the carriage, used or not.
///
/// # Errors
///
/// Whatever the readers find.
pub fn read_campaign(path: &Path) -> Result<Campaign, Error> {
    let campaign = campaign_file::read_campaign(path)?;
    check_sections(&campaign)?;
    Ok(campaign)
}

/// Reads the sections of a campaign that belong to methods and to the carriage.
///
/// # Errors
///
/// The first mistake in them, with its place.
pub fn check_sections(campaign: &Campaign) -> Result<(), Error> {
    for source in &campaign.sources {
        let names = METHODS.iter().flat_map(|method| method.names());
        // What a method that nobody knows would take is not known; its name is refused where it is asked for.
        if source.methods.iter().all(|name| names.clone().any(|known| known == name)) {
            let is_asked =
                |method: &&&dyn Method| method.names().iter().any(|name| source.methods.iter().any(|m| m == name));
            let taken = METHODS.iter().filter(is_asked).flat_map(|method| method.takes());
            source.takes(&taken.copied().collect::<Vec<_>>())?;
        }
        METHODS.iter().chain(&[&AddedMass as &dyn Method, &Computed]).try_for_each(|method| method.check(source))?;
    }
    declared(campaign)?;
    Ok(())
}

/// JSON Schema of a campaign, for editors.
#[must_use]
pub fn campaign_schema() -> serde_json::Value {
    let others: [(&dyn Method, _); 2] = [(&AddedMass, "mesh"), (&Computed, "cases")];
    froude_identify::campaign_schema::campaign_schema(&METHODS, &others, &[("rig", RIG), ("carriage", CARRIAGE)])
}

/// The methods of a source, each with the names that it is asked for; `instead` is used where a source names no method.
///
/// # Errors
///
/// A sidecar that cannot be read; a name that no method answers to, one twice, or names of methods that read runs of two kinds, and so need two
/// sources.
pub(crate) fn of(source: &Source, instead: Option<&'static dyn Method>) -> Result<Vec<Asked>, Error> {
    if let Some((method, logs)) = of_logs(source, instead)? {
        return of_log(source, method, &logs);
    }
    match &source.input {
        Input::Runs { .. } if source.methods.is_empty() => {
            let method = instead.unwrap_or(&Carriage);
            Ok(vec![(method, method.names().to_vec())])
        }
        Input::Runs { .. } => named(source),
        Input::Table(_) if !source.methods.is_empty() => Err(refused(
            source,
            0,
            format!(
                "`method` says how runs are reduced, but the source names no runs; among tables it applies only to {}",
                known_logs()
            ),
        )),
        Input::Mesh(_) => Ok(vec![(&AddedMass, AddedMass.names().to_vec())]),
        Input::Cases(_) => Ok(vec![(&Computed, Computed.names().to_vec())]),
        _ => Ok(vec![(&Table, vec!["table"])]),
    }
}

/// The method whose log a table is: the one asked for, by the job or by name, or else the one that its sidecar indicates; `None` for any other source.
///
/// # Errors
///
/// A sidecar that cannot be read.
pub(crate) fn of_logs(
    source: &Source,
    asked: Option<&'static dyn Method>,
) -> Result<Option<(&'static dyn Method, Logs)>, Error> {
    let Input::Table(log) = &source.input else { return Ok(None) };
    let with_logs = |method: &'static dyn Method| Some((method, method.logs()?));
    let is_named = |(_, logs): &(_, Logs)| source.methods.iter().any(|own| logs.names.contains(&own.as_str()));
    let named = || METHODS.into_iter().filter_map(with_logs).find(is_named);
    if let Some(found) = asked.and_then(with_logs).or_else(named) {
        return Ok(Some(found));
    }
    for (method, logs) in METHODS.into_iter().filter_map(with_logs) {
        if (logs.is_one)(log, source.sidecar.as_deref())? {
            return Ok(Some((method, logs)));
        }
    }
    Ok(None)
}

/// In words: which tables are logs, and how they are recognised.
fn known_logs() -> String {
    let of = |logs: Logs| format!("{}, whose sidecar names {}", logs.words, logs.told_by);
    METHODS.iter().filter_map(|method| method.logs()).map(of).collect::<Vec<_>>().join(" or ")
}

/// What is wrong with the name at `i` in `method`, with its place.
fn refused(source: &Source, i: usize, what: String) -> Error {
    let place = source.method_places.get(i).map_or_else(String::new, ToString::to_string);
    Error::Identify(IdentifyError::Campaign { place, what })
}

/// A log by the names that its source asks for, or else by all that it allows.
fn of_log(source: &Source, method: &'static dyn Method, logs: &Logs) -> Result<Vec<Asked>, Error> {
    let mut asked = Vec::new();
    for (i, name) in source.methods.iter().enumerate() {
        let Some(known) = logs.names.iter().copied().find(|known| known == name) else {
            let all = logs.names.join(", ");
            let advice = meant(name, logs.names.iter().copied()).unwrap_or_else(|| format!("expected {all}"));
            return Err(refused(source, i, format!("method {name:?} is not one for {}; {advice}", logs.words)));
        };
        if asked.contains(&known) {
            return Err(refused(source, i, format!("method {name:?} is named twice")));
        }
        asked.push(known);
    }
    Ok(vec![(method, if asked.is_empty() { logs.names.to_vec() } else { asked })])
}

/// Whether a source is fitted by laws, which `models` name.
///
/// # Errors
///
/// As [`of`].
pub(crate) fn takes_laws(source: &Source, instead: Option<&'static dyn Method>) -> Result<bool, Error> {
    if matches!(source.input, Input::Record { .. }) {
        return Ok(false);
    }
    Ok(of(source, instead)?.iter().any(|(method, _)| method.names() == Table.names()))
}

/// The methods that a source of runs names, in the order of their first names.
fn named(source: &Source) -> Result<Vec<Asked>, Error> {
    let refuse = |i: usize, what: String| Err(refused(source, i, what));
    let mut out: Vec<Asked> = Vec::new();
    for (i, name) in source.methods.iter().enumerate() {
        let known = || METHODS.iter().flat_map(|method| method.names().iter().map(move |name| (*method, *name)));
        let Some((method, name)) = known().find(|(_, known)| known == name) else {
            let names = || known().map(|(_, name)| name);
            let all = names().collect::<Vec<_>>().join(", ");
            let advice = meant(name, names()).unwrap_or_else(|| format!("there are {all}"));
            return refuse(i, format!("method {name:?} is not known; {advice}"));
        };
        if out.iter().any(|(_, names)| names.contains(&name)) {
            return refuse(i, format!("method {name:?} is named twice"));
        }
        if let Some((first, names)) = out.first().filter(|(first, _)| first.runs() != method.runs()) {
            let other = names[0];
            let kinds = [first.words(other), method.words(name)];
            return refuse(
                i,
                format!(
                    "{other:?} ({}) and {name:?} ({}) read runs of two kinds; give each a [[source]] of its own",
                    kinds[0], kinds[1]
                ),
            );
        }
        match out.iter_mut().find(|(known, _)| known.names() == method.names()) {
            Some((_, names)) => names.push(name),
            None => out.push((method, vec![name])),
        }
    }
    Ok(out)
}
