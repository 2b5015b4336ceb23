//! The list of all methods, and the one that a source asks for.

use std::path::Path;

use froude_added_mass::source::AddedMass;
use froude_carriage::axis::source::Servo;
use froude_carriage::drag::calibration::source::KnownWeights;
use froude_carriage::source::Carriage;
use froude_carriage::tuning::source::{Resonance, Tuning};
use froude_identify::IdentifyError;
use froude_identify::method::Method;
use froude_identify::table::Table;
use froude_records::campaign::{self, Campaign, Input, Source};
use froude_records::nearest::meant;
use froude_records::run::is_servo_log;
use froude_rig::carriage::declared;

use crate::Error;
use crate::pipeline::job::Purpose;
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
    let campaign = campaign::read_campaign(path)?;
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
        METHODS.iter().try_for_each(|method| method.check(source))?;
        Computed.check(source)?;
    }
    declared(campaign)?;
    Ok(())
}

/// The methods of a source, each with the names that it is asked for; `purpose` is what is asked of a source that names none.
///
/// # Errors
///
/// A sidecar that cannot be read; a name that no method answers to, one twice, or names of methods that read runs of two kinds, and so need two
/// sources.
pub(crate) fn of(source: &Source, purpose: Option<Purpose>) -> Result<Vec<Asked>, Error> {
    match &source.input {
        Input::Runs { .. } if source.methods.is_empty() => {
            let method: &dyn Method = match purpose {
                Some(Purpose::Servo) => &Servo,
                Some(Purpose::Calibration) => &KnownWeights,
                Some(Purpose::Tuning) => &Tuning,
                Some(Purpose::Resonance) => &Resonance,
                None => &Carriage,
            };
            Ok(vec![(method, method.names().to_vec())])
        }
        Input::Runs { .. } => named(source),
        Input::Table(_) if is_of_a_servo(source, purpose)? => of_log(source),
        Input::Table(_) if !source.methods.is_empty() => Err(refused(
            source,
            0,
            "`method` says how runs are reduced, but the source names no runs; of tables only the log of a servo takes it, whose sidecar names time, position \
             and command"
                .to_owned(),
        )),
        Input::Mesh(_) => Ok(vec![(&AddedMass, AddedMass.names().to_vec())]),
        Input::Cases(_) => Ok(vec![(&Computed, Computed.names().to_vec())]),
        _ => Ok(vec![(&Table, vec!["table"])]),
    }
}

/// Whether a source is the log of a servo.
///
/// # Errors
///
/// A sidecar that cannot be read.
pub(crate) fn is_of_a_servo(source: &Source, purpose: Option<Purpose>) -> Result<bool, Error> {
    let Input::Table(log) = &source.input else { return Ok(false) };
    Ok(purpose == Some(Purpose::Servo) || is_servo_log(log, source.sidecar.as_deref())?)
}

/// What is wrong with the name at `i` in `method`, with its place.
fn refused(source: &Source, i: usize, what: String) -> Error {
    let place = source.method_places.get(i).map_or_else(String::new, ToString::to_string);
    Error::Identify(IdentifyError::Campaign { place, what })
}

/// The models of a servo's log: those that are named, else all that need no rig.
fn of_log(source: &Source) -> Result<Vec<Asked>, Error> {
    let mut asked = Vec::new();
    for (i, name) in source.methods.iter().enumerate() {
        let Some(known) = Servo::OF_LOGS.into_iter().find(|known| known == name) else {
            let all = Servo::OF_LOGS.join(", ");
            let advice = meant(name, Servo::OF_LOGS).unwrap_or_else(|| format!("expected {all}"));
            return Err(refused(source, i, format!("method {name:?} is not one for the log of a servo; {advice}")));
        };
        if asked.contains(&known) {
            return Err(refused(source, i, format!("method {name:?} is named twice")));
        }
        asked.push(known);
    }
    Ok(vec![(&Servo, if asked.is_empty() { Servo::OF_LOGS.to_vec() } else { asked })])
}

/// Whether a source is fitted by laws, which `models` name.
///
/// # Errors
///
/// As [`of`].
pub(crate) fn takes_laws(source: &Source, purpose: Option<Purpose>) -> Result<bool, Error> {
    if matches!(source.input, Input::Record { .. }) {
        return Ok(false);
    }
    Ok(of(source, purpose)?.iter().any(|(method, _)| method.names() == Table.names()))
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
