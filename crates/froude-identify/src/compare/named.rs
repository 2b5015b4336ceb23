//! Estimates with the records that they come from.

use froude_records::estimate::{Estimate, EstimateFile};

/// An estimate with the record that it comes from.
#[derive(Debug, Clone, Copy)]
pub struct Named<'a> {
    /// The file, as the user named it.
    pub file: &'a str,
    /// The record in it, with the fingerprints of its data.
    pub record: &'a EstimateFile,
    /// The estimate.
    pub estimate: &'a Estimate,
}

/// All estimates of some files.
#[must_use]
pub fn named<'a>(files: &'a [(String, EstimateFile)]) -> Vec<Named<'a>> {
    files
        .iter()
        .flat_map(|(file, record)| record.estimates.iter().map(move |estimate| Named { file, record, estimate }))
        .collect()
}
