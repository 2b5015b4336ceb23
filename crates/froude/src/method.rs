//! The list of all methods, and the one that a source asks for.

use froude_added_mass::source::AddedMass;
use froude_carriage::source::Carriage;
use froude_identify::method::{Found, Method, MethodError, Need};
use froude_identify::source::identify_source;
use froude_records::campaign::{Campaign, Input, Source};
use froude_records::nearest::meant;
use froude_tank::decay::source::FreeDecay;

use crate::Error;

/// Names of the methods that read runs of a method.
pub(crate) fn readers(runs: &str) -> Vec<&'static str> {
    METHODS.iter().filter(|method| method.runs() == runs).flat_map(|method| method.names()).copied().collect()
}

/// All methods that read runs; the first is that of runs whose source names none.
const METHODS: [&dyn Method; 2] = [&Carriage, &FreeDecay];

/// The rows of a table, fitted with every law that the campaign asks for.
struct Table;

impl Method for Table {
    fn names(&self) -> &'static [&'static str] {
        &["table"]
    }

    fn words(&self, _: &str) -> &'static str {
        "rows of a table"
    }

    fn needs(&self, _: &str) -> &'static [Need] {
        const { &[Need::of(&["table"], &[])] }
    }

    fn runs(&self) -> &'static str {
        ""
    }

    fn identify(
        &self,
        campaign: &Campaign,
        source: &Source,
        _: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Found, MethodError> {
        let mut result = identify_source(campaign, source, &|model| progress(&format!("fitting {model}")))?;
        let findings = std::mem::take(&mut result.findings);
        Ok(Found { results: vec![result], findings, ..Found::default() })
    }
}

/// The method of a source with the names that it is asked for.
///
/// # Errors
///
/// A name that no method answers to, one twice, or names of two methods: these need runs of two kinds, and so two sources.
pub(crate) fn of(source: &Source) -> Result<(&'static dyn Method, Vec<&'static str>), Error> {
    match source.input {
        Input::Runs { .. } => {}
        Input::Mesh(_) => return Ok((&AddedMass, AddedMass.names().to_vec())),
        _ => return Ok((&Table, vec!["table"])),
    }
    let refuse = |i: usize, what: String| {
        let place = source.method_places.get(i).map_or_else(String::new, ToString::to_string);
        Err(Error::Identify(froude_identify::IdentifyError::Campaign { place, what }))
    };
    if source.methods.is_empty() {
        return Ok((METHODS[0], METHODS[0].names().to_vec()));
    }
    let mut asked: Vec<(&'static dyn Method, &'static str)> = Vec::new();
    for (i, name) in source.methods.iter().enumerate() {
        let known = || METHODS.iter().flat_map(|method| method.names().iter().map(move |name| (*method, *name)));
        let Some((method, name)) = known().find(|(_, known)| known == name) else {
            let names = || known().map(|(_, name)| name);
            let all = names().collect::<Vec<_>>().join(", ");
            let advice = meant(name, names()).unwrap_or_else(|| format!("there are {all}"));
            return refuse(i, format!("method {name:?} is not known; {advice}"));
        };
        if asked.iter().any(|(_, other)| *other == name) {
            return refuse(i, format!("method {name:?} is named twice"));
        }
        if let Some((first, other)) = asked.first().filter(|(first, _)| first.names() != method.names()) {
            let kinds = [first.words(other), method.words(name)];
            return refuse(
                i,
                format!(
                    "{other:?} ({}) and {name:?} ({}) read runs of two kinds; give each a [[source]] of its own",
                    kinds[0], kinds[1]
                ),
            );
        }
        asked.push((method, name));
    }
    let method = asked[0].0;
    Ok((method, asked.into_iter().map(|(_, name)| name).collect()))
}
