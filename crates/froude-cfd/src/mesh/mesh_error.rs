//! Why there is no mesh.

/// Why a body has no mesh.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum MeshError {
    /// A number that no mesh has.
    #[error("{quantity} is {found}; it must be {expected}")]
    Number {
        /// Which, in words.
        quantity: &'static str,
        /// What was given.
        found: f64,
        /// What it must be.
        expected: String,
    },
    /// Sections that enclose no body.
    #[error("the body at x = {x_m} m: {problem}")]
    Body {
        /// Where.
        x_m: f64,
        /// What is wrong, and what to do.
        problem: &'static str,
    },
    /// Cells turned inside out.
    #[error(
        "the rays of the O-grid cross at {place}: the body is too concave there; write mesh = \"coarse\" or {{ surface_cell, first_layer }}, which snappyHexMesh cuts cubes for, or mesh a smooth stand-in"
    )]
    Crossing {
        /// Where.
        place: String,
    },
    /// Cells that no solver likes.
    #[error("{measure} of the mesh is {found:.1} at {place}, and {limit:.0} is the limit: {advice}")]
    Poor {
        /// What was measured.
        measure: &'static str,
        /// What was found.
        found: f64,
        /// The largest that is taken.
        limit: f64,
        /// Where.
        place: String,
        /// What to do.
        advice: &'static str,
    },
    /// Layers that most of the wall does not have.
    #[error(
        "layers cover {} % of the body's area, but at least {} % is required, because the friction is not resolved without layers; write mesh = {{ surface_cell, first_layer, layers }} with smaller cubes or fewer layers",
        (100.0 * .coverage).round(), (100.0 * .needed).round()
    )]
    Layers {
        /// Part of the area that has layers.
        coverage: f64,
        /// The least that is taken.
        needed: f64,
    },
    /// A body that is not within its box of water.
    #[error("the body is not in the water: {problem}")]
    Outside {
        /// How it lies.
        problem: String,
    },
    /// A program of OpenFOAM that made no mesh.
    #[error("{program} made no mesh: {problem}; its log is {log}")]
    Program {
        /// The program.
        program: &'static str,
        /// What it came to.
        problem: String,
        /// Where it says more.
        log: String,
    },
    /// OpenFOAM is not there, or was ended.
    #[error(transparent)]
    OpenFoam(#[from] crate::openfoam::OpenFoamError),
    /// The folder cannot be written.
    #[error(transparent)]
    Write(#[from] froude_records::RecordError),
}

/// As many cells as a machine of 64 GiB solves.
const MOST_CELLS: usize = 50_000_000;
/// Most cells one way.
const MOST_ONE_WAY: usize = 10_000;

/// Checks how many cells there are each way: what they are called, how many, how many it takes.
///
/// # Errors
///
/// [`MeshError::Number`].
pub fn check_counts(counts: &[(&'static str, usize, usize)]) -> Result<(), MeshError> {
    for &(quantity, found, least) in counts {
        if !(least..=MOST_ONE_WAY).contains(&found) {
            let expected = format!("from {least} to {MOST_ONE_WAY}");
            return Err(MeshError::Number { quantity, found: found as f64, expected });
        }
    }
    let cells = counts.iter().fold(1_usize, |product, &(_, found, _)| product.saturating_mul(found));
    if cells > MOST_CELLS {
        let expected = format!("{MOST_CELLS} at most");
        return Err(MeshError::Number { quantity: "the number of cells", found: cells as f64, expected });
    }
    Ok(())
}

/// Checks that a length is above 0 and finite.
///
/// # Errors
///
/// [`MeshError::Number`].
pub fn check_length(quantity: &'static str, found: f64) -> Result<(), MeshError> {
    if found > 0.0 && found.is_finite() {
        return Ok(());
    }
    Err(MeshError::Number { quantity, found, expected: "above 0 and finite, in metres".to_owned() })
}
