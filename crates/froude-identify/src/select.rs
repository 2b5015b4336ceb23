//! Which estimate of a record is meant.

use std::path::Path;

use froude_records::estimate::{Estimate, EstimateFile};

use crate::error::IdentifyError;

/// The estimate named `source/model`, or the only recommended one.
///
/// # Errors
///
/// No such estimate, or several recommended ones and no name.
pub fn one_estimate<'a>(
    file: &'a EstimateFile,
    select: Option<&str>,
    path: &Path,
) -> Result<&'a Estimate, IdentifyError> {
    let ids = || file.estimates.iter().map(|e| e.id.as_str()).collect::<Vec<_>>().join(", ");
    let complaint = |what: String| IdentifyError::Campaign { place: path.display().to_string(), what };
    if let Some(id) = select {
        return file
            .estimates
            .iter()
            .find(|e| e.id == id)
            .ok_or_else(|| complaint(format!("no estimate {id:?}; it has {}", ids())));
    }
    let recommended: Vec<&Estimate> = file.estimates.iter().filter(|e| e.recommended).collect();
    match (recommended.as_slice(), file.estimates.as_slice()) {
        ([one], _) => Ok(one),
        (_, [one]) => Ok(one),
        _ => Err(complaint(format!("several estimates; name one with select = \"source/model\": {}", ids()))),
    }
}
