//! A TOML file that is kept as it was read, so that sections of it can be read later, by whoever owns them, with their places.

use std::fmt;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use toml::Spanned;
use toml::de::DeTable;

use crate::error::RecordError;
use crate::section::{Section, Source, parse};

type Table<'a> = Spanned<DeTable<'a>>;

/// A file's path and text.
type File = (PathBuf, String);

self_cell::self_cell!(
    struct Parsed {
        owner: File,
        #[covariant]
        dependent: Table,
    }
);

/// Text and values of a TOML file; a copy shares both.
#[derive(Clone)]
pub struct Document(Arc<Parsed>);

impl Document {
    /// Parses a text.
    ///
    /// # Errors
    ///
    /// [`RecordError::Syntax`] with its place.
    pub fn parse(path: &Path, text: &str) -> Result<Self, RecordError> {
        let file = (path.to_owned(), text.to_owned());
        Ok(Self(Arc::new(Parsed::try_new(file, |(path, text)| parse(Source { path, text }))?)))
    }

    /// The whole file, to be read.
    #[must_use]
    pub fn root(&self) -> Section<'_> {
        let (path, text) = self.0.borrow_owner();
        Section::new(Source { path, text }, "", self.0.borrow_dependent().get_ref(), 0)
    }
}

impl fmt::Debug for Document {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Document({:?})", self.0.borrow_owner().0)
    }
}

impl PartialEq for Document {
    /// By path and text: they decide what it holds.
    fn eq(&self, other: &Self) -> bool {
        self.0.borrow_owner() == other.0.borrow_owner()
    }
}
