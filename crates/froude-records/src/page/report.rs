//! What a report is made from.
//!
//! The report computes no physics and fits nothing: everything it prints stands
//! in these records. All of them have public fields and a `Default`, so that a
//! caller fills in what it has and leaves the rest.
//!
//! **Units.** SI; angles in radians (printed in degrees). A force, a
//! coefficient or a width carries its unit as text in the field beside it.
//! **Missing numbers.** `None` is printed as "—". A NaN or an infinity is
//! treated like `None`; it is never printed as a number.

use indexmap::IndexMap;

use super::SourceSection;
use crate::block::Section;
use crate::comparison::Comparison;
use crate::estimate::{DataFile, Estimate};
use crate::finding::Finding;

/// A whole report, from the title to the hashes.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Report {
    /// Title on the first line, usually the campaign's name.
    pub title: String,
    /// Second line: body, facility, customer.
    pub subtitle: String,
    /// Date as text; the report reads no clock.
    pub date: Option<String>,
    /// Paragraphs of the method section.
    pub method: Vec<String>,
    /// What methods state about the runs that they reduced together, before the sections of their results.
    pub blocks: Vec<Section>,
    /// One section per source that was fitted.
    pub sources: Vec<SourceSection>,
    /// Published estimates shown beside the fitted ones; their `kind` is `published`.
    pub published: Vec<Estimate>,
    /// What the lints found, over the whole campaign.
    pub findings: Vec<Finding>,
    /// The files that the numbers came from.
    pub data: Vec<InputFile>,
    /// Program versions by name.
    pub versions: IndexMap<String, String>,
    /// What to cite, one entry per work.
    pub citations: Vec<String>,
    /// Sources side by side, when there is more than one; its findings are said below its tables.
    pub comparison: Option<Comparison>,
}

/// A file, its fingerprint, and what was taken from it.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct InputFile {
    /// Path as the campaign names it.
    pub path: String,
    /// SHA-256 of its bytes, hexadecimal.
    pub sha256: String,
    /// Rows in the file.
    pub n_rows: Option<usize>,
    /// Rows that entered a fit, after `keep` and after identical copies were dropped.
    pub n_used: Option<usize>,
    /// The source that reads it.
    pub source: Option<String>,
}

impl From<DataFile> for InputFile {
    fn from(file: DataFile) -> Self {
        Self { path: file.path, sha256: file.sha256, ..Self::default() }
    }
}
