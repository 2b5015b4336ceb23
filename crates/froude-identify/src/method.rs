//! The one seam: whatever makes estimates of a source is a [`Method`].
//!
//! A source of a campaign names a table or runs, and for runs its methods. Each method reduces what it is given to observations, fits them by
//! the common regression with the common budget ([`crate::seam`]), or makes its estimates by a fit of its own; it gives [`Found`]: an [`Answer`]
//! for each name, and what it states about all of them. After it there is one comparison, one record, one page and one writer.

use std::fmt::Debug;
use std::path::{Path, PathBuf};

use froude_records::RecordError;
use froude_records::block::Section;
use froude_records::campaign::{Campaign, Source};
use froude_records::declare::Key;
use froude_records::estimate::Estimate;
use froude_records::finding::Finding;
use froude_records::text::counted;

use crate::answer::Answer;
use crate::error::IdentifyError;

/// A way from a source to estimates.
pub trait Method: Debug + Sync {
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
    ) -> Result<Found, MethodError>;

    /// The logs and sidecars that a source's plan would give, for the true coefficients of `[simulate]`; `None` where the method has no such twin.
    ///
    /// # Errors
    ///
    /// What the campaign does not declare.
    fn simulate(&self, _: &Campaign, _: &Source) -> Result<Option<Vec<Export>>, MethodError> {
        Ok(None)
    }

    /// What a source's plan takes and determines; `None` where the method forecasts nothing.
    ///
    /// # Errors
    ///
    /// What the campaign does not declare, and what the plan does not determine.
    fn plan(&self, _: &Campaign, _: &Source) -> Result<Option<Prospect>, MethodError> {
        Ok(None)
    }

    /// Keys of a source that belong to the rows of a table, to a free decay or to a computed flow, and that the method takes for its runs too.
    fn takes(&self) -> &'static [&'static str] {
        &[]
    }

    /// Which tables are logs for this method; `None` if it reads none.
    fn logs(&self) -> Option<Logs> {
        None
    }

    /// The keys of a source that are the method's own; `None` where it has none.
    fn declares(&self) -> Option<Declares> {
        None
    }

    /// Reads the sections of a source that are the method's own ([`Source::section`]), used or not.
    ///
    /// # Errors
    ///
    /// The first mistake in them, with its place.
    fn check(&self, _: &Source) -> Result<(), RecordError> {
        Ok(())
    }
}

/// The keys of a source that are a method's own.
#[derive(Debug, Clone, Copy)]
pub struct Declares {
    /// Its section, `[source.NAME]`.
    pub section: &'static str,
    /// The keys of the section.
    pub keys: &'static [Key],
    /// Those of `[[source.plan]]`, for its runs; empty where it plans none.
    pub plan: &'static [Key],
}

/// Tables that are logs of a method.
#[derive(Debug, Clone, Copy)]
pub struct Logs {
    /// What such a table is, in words.
    pub words: &'static str,
    /// What its sidecar names, by which it differs from a table of loads.
    pub told_by: &'static str,
    /// Whether a table is one, as its sidecar says.
    pub is_one: fn(&Path, Option<&Path>) -> Result<bool, RecordError>,
    /// Which of the method's names such a log allows.
    pub names: &'static [&'static str],
    /// Validates estimates against a log that none of them was fitted to; returns findings and a section of the page.
    pub hold_against: fn(&Source, &[&Estimate]) -> Result<(Vec<Finding>, Section), MethodError>,
}

/// Files that a method needs: those of any one of some roles.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Need {
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
    #[must_use]
    pub const fn of(roles: &'static [&'static str], channels: &'static [&'static str]) -> Self {
        Self { roles, channels, is_optional: false, is_observed: true }
    }
}

/// Whether files of a role hold observations of a method's name.
#[must_use]
pub fn observes(needs: &[Need], role: &str) -> bool {
    needs.iter().any(|need| need.is_observed && need.roles.contains(&role))
}

/// What is needed and not there, in words; `files` gives, for each file of a role, whether it has a channel.
pub fn lacking<'a>(needs: &[Need], files: impl Fn(&str) -> Vec<Box<dyn Fn(&str) -> bool + 'a>>) -> Vec<String> {
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

/// What a method found in a source.
#[derive(Default)]
pub struct Found {
    /// An answer for each name that was asked for.
    pub results: Vec<Answer>,
    /// What it states about all of them together, on the terminal and at the head of the page; the results alone where there is nothing.
    pub summary: Option<Section>,
    /// What else belongs on the page.
    pub blocks: Vec<Section>,
    /// Files for other programs, which lie beside the record.
    pub exports: Vec<Export>,
    /// What is doubtful about the runs, or about the results together.
    pub findings: Vec<Finding>,
    /// Where results go when no folder was named, of a source that no campaign names.
    pub beside: Option<PathBuf>,
    /// True where more lies there than was named: such a result takes the place of no other.
    pub is_part: bool,
}

/// What the plan of a source takes and determines.
#[derive(Debug, Clone, PartialEq)]
pub struct Prospect {
    /// Name of the source.
    pub source: String,
    /// Its runs.
    pub runs: usize,
    /// Their time on the log, s.
    pub duration_s: f64,
    /// Run matrix and intervals to expect.
    pub section: Section,
}

/// A file for another program.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Export {
    /// Its name in the folder of the results; where several sources have one of that name, the source's stands before it.
    pub name: String,
    /// What it holds.
    pub content: Vec<u8>,
}

/// Why a method gives no estimates; each message states what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MethodError {
    /// A file could not be read or written, or says something impossible.
    #[error(transparent)]
    Record(#[from] RecordError),

    /// The fit refused.
    #[error(transparent)]
    Identify(#[from] IdentifyError),

    /// A file or a folder that the method has no use for as it is.
    #[error("{}: {what}", .path.display())]
    Input {
        /// The file or the folder.
        path: PathBuf,
        /// What was found, what was expected and what to do.
        what: String,
    },

    /// A folder whose files cannot be listed.
    #[error("{}: the folder cannot be read: {source}", .path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        source: std::io::Error,
    },

    /// A declaration that the method needs and the campaign lacks.
    #[error("{}{what}", if .place.is_empty() { String::new() } else { format!("{}: ", .place) })]
    Undeclared {
        /// Where it belongs; empty where no file can have it.
        place: String,
        /// What is missing and what to write.
        what: String,
    },

    /// Runs that are no set: one is there twice, is another campaign's, or lies beside the sidecar of another.
    #[error("{first}{}", if *.more == 0 { String::new() } else { format!(" ({} more)", .more) })]
    NoSet {
        /// What is wrong with the first, and what to do.
        first: String,
        /// How many more there are.
        more: usize,
    },

    /// A run whose log is gone, or was set aside.
    #[error("{why}")]
    NoLog {
        /// Where it was, and what to do.
        why: String,
    },

    /// Runs of another method than the one that reads.
    #[error("{}: {found}, and runs of the method {wanted} are read here", .folder.display())]
    OfAnotherMethod {
        /// Where they lie.
        folder: PathBuf,
        /// How many of what.
        found: String,
        /// The method that they are of.
        method: String,
        /// Whether they are logs of other programs, which say no method.
        is_imported: bool,
        /// The method that is read here.
        wanted: String,
    },

    /// What the method's own reduction refused.
    #[error(transparent)]
    Refused(Box<dyn std::error::Error + Send + Sync>),
}

impl MethodError {
    /// A file or a folder, and what is wrong with it.
    pub fn input(path: impl Into<PathBuf>, what: impl Into<String>) -> Self {
        Self::Input { path: path.into(), what: what.into() }
    }

    /// What a method's own reduction refused.
    pub fn refused(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::Refused(Box::new(error))
    }

    /// True where the input is at fault, false where the machine is.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Record(e) | Self::Identify(IdentifyError::Record(e)) => !e.is_output(),
            _ => true,
        }
    }
}
