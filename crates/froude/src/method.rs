//! The one seam: whatever makes estimates of a source is a [`Method`], and [`METHODS`] is the list of them.
//!
//! A source of a campaign names a table or runs, and for runs its methods. Each method reduces what it is given to observations, fits them by
//! the common regression with the common budget, and gives [`Found`]: for each answer data, fits, estimates and files, and what it says of all
//! of them. After it there is one comparison, one record, one page and one writer ([`crate::pipeline`]).

use std::path::PathBuf;

use froude_identify::source::{SourceResult, identify_source};
use froude_records::campaign::{Campaign, Input, Source};
use froude_records::finding::Finding;
use froude_records::nearest::meant;
use froude_records::page::DocumentSection;
use froude_records::text::counted;

use crate::Error;
use crate::carriage::source::Carriage;
use crate::decay::FreeDecay;

/// A way from a source to estimates.
pub(crate) trait Method: Sync {
    /// Names that a campaign may ask for, in the order of their results; several where they share one reduction.
    fn names(&self) -> &'static [&'static str];

    /// What each of them does, in words.
    fn words(&self, name: &str) -> &'static str;

    /// What one of them needs.
    fn needs(&self, name: &str) -> &'static [Need];

    /// The method that runs must be of, as they say it themselves; empty where no runs are read.
    fn runs(&self) -> &'static str;

    /// Reduces and fits a source by the names asked for.
    ///
    /// # Errors
    ///
    /// What cannot be read, or gives none of them.
    fn identify(
        &self,
        campaign: &Campaign,
        source: &Source,
        asked: &[&'static str],
        progress: &dyn Fn(&str),
    ) -> Result<Found, Error>;
}

/// Files that a method needs: those of any one of some roles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Need {
    /// `table`, or roles of runs.
    pub roles: &'static [&'static str],
    /// Channels without which such a run is of no use to it, an axis' without the axis.
    pub channels: &'static [&'static str],
    /// Whether it can do without.
    pub is_optional: bool,
    /// Whether it takes observations from them; what it reads besides is an error under its own key.
    pub is_observed: bool,
}

impl Need {
    /// Observations, which must be there.
    pub const fn of(roles: &'static [&'static str], channels: &'static [&'static str]) -> Self {
        Self { roles, channels, is_optional: false, is_observed: true }
    }
}

/// Whether files of a role hold observations of a method's name.
pub(crate) fn observes(needs: &[Need], role: &str) -> bool {
    needs.iter().any(|need| need.is_observed && need.roles.contains(&role))
}

/// What is needed and not there, in words; `files` gives, for each file of a role, whether it has a channel.
pub(crate) fn lacking<'a>(needs: &[Need], files: impl Fn(&str) -> Vec<Box<dyn Fn(&str) -> bool + 'a>>) -> Vec<String> {
    let of = |need: &Need| {
        let there: Vec<_> = need.roles.iter().flat_map(|role| files(role)).collect();
        if there.iter().any(|has| need.channels.iter().all(|channel| has(channel))) {
            return None;
        }
        let roles = need.roles.join(" or ");
        if there.is_empty() {
            return Some(format!("there are no runs of the role {roles}"));
        }
        let missing = need.channels.iter().filter(|channel| !there.iter().any(|has| has(channel)));
        let missing: Vec<&str> = missing.copied().collect();
        let missing = if missing.is_empty() { need.channels.join(" with ") } else { missing.join(", ") };
        Some(format!(
            "none of the {} of the role {roles} has the channel {missing}",
            counted(there.len(), "run", "runs")
        ))
    };
    needs.iter().filter(|need| !need.is_optional).filter_map(of).collect()
}

/// Names of the methods that read runs of a method.
pub(crate) fn readers(runs: &str) -> Vec<&'static str> {
    METHODS.iter().filter(|method| method.runs() == runs).flat_map(|method| method.names()).copied().collect()
}

/// What a method found in a source.
#[derive(Default)]
pub(crate) struct Found {
    /// A result for each name that was asked for.
    pub results: Vec<SourceResult>,
    /// What it says of all of them together, on the terminal and at the head of the page; the results alone where there is nothing.
    pub summary: Option<DocumentSection>,
    /// What else belongs on the page.
    pub blocks: Vec<DocumentSection>,
    /// What is doubtful about the runs, or about the results together.
    pub findings: Vec<Finding>,
    /// Where results go that nobody named a folder for, of a source that no campaign names.
    pub beside: Option<PathBuf>,
    /// True where more lies there than was named: such a result takes the place of no other.
    pub is_part: bool,
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
    ) -> Result<Found, Error> {
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
    if !matches!(source.input, Input::Runs { .. }) {
        return Ok((&Table, vec!["table"]));
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
