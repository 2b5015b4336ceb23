//! Why there is no mesh.

use std::fmt::Display;

/// Why a body has no mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// What no mesh can be made of, or what was made and no solver likes.
    #[error("{0}")]
    Refused(String),
    /// Cells turned inside out.
    #[error(
        "the rays of the O-grid cross at {place}: the body is too concave there; write mesh = \"coarse\" or {{ surface_cell, first_layer }}, which snappyHexMesh cuts cubes for, or mesh a smooth stand-in"
    )]
    Crossing {
        /// Where.
        place: String,
    },
    /// OpenFOAM is not installed, or was ended.
    #[error(transparent)]
    OpenFoam(#[from] crate::openfoam::OpenFoamError),
    /// The folder cannot be written.
    #[error(transparent)]
    Write(#[from] froude_records::RecordError),
}

impl MeshError {
    /// A number that no mesh has.
    pub fn number(quantity: &str, found: f64, expected: impl Display) -> Self {
        Self::Refused(format!("{quantity} is {found}; it must be {expected}"))
    }
}

/// As many cells as a machine of 64 GiB solves.
const MOST_CELLS: usize = 50_000_000;
/// Most cells one way.
const MOST_ONE_WAY: usize = 10_000;

/// Checks how many cells there are each way: what they are called, how many, how many it takes.
///
/// # Errors
///
/// [`MeshError::Refused`].
pub fn check_counts(counts: &[(&'static str, usize, usize)]) -> Result<(), MeshError> {
    for &(quantity, found, least) in counts {
        if !(least..=MOST_ONE_WAY).contains(&found) {
            let expected = format!("from {least} to {MOST_ONE_WAY}");
            return Err(MeshError::number(quantity, found as f64, expected));
        }
    }
    let cells = counts.iter().fold(1_usize, |product, &(_, found, _)| product.saturating_mul(found));
    if cells > MOST_CELLS {
        let expected = format!("{MOST_CELLS} at most");
        return Err(MeshError::number("the number of cells", cells as f64, expected));
    }
    Ok(())
}

/// Checks that a length is above 0 and finite.
///
/// # Errors
///
/// [`MeshError::Refused`].
pub fn check_length(quantity: &'static str, found: f64) -> Result<(), MeshError> {
    if found > 0.0 && found.is_finite() {
        return Ok(());
    }
    Err(MeshError::number(quantity, found, "above 0 and finite, in metres"))
}
