//! Why a refinement gives no matrix, or ended above the tolerance.

use froude_mesh::sections::SectionError;

use crate::chain::ChainError;
use crate::mirror::Across;
use crate::tank::TankError;

/// Why there is no matrix at all.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum RefineError {
    /// The dimensions give no body.
    #[error(transparent)]
    Sections(#[from] SectionError),
    /// The chain cannot be bent so.
    #[error(transparent)]
    Chain(#[from] ChainError),
    /// Panels lie across a mirror plane.
    #[error(transparent)]
    Across(#[from] Across),
    /// The body does not fit into the tank.
    #[error(transparent)]
    Tank(#[from] TankError),
    /// The coarsest mesh has more panels than are allowed.
    #[error(
        "the coarsest mesh has {coarsest} panels, and {most} are allowed; write --most-panels {third}, because the numerical uncertainty needs \
         three meshes, or {coarsest} for a value without"
    )]
    TooFine {
        /// Its panels.
        coarsest: usize,
        /// Those of the third.
        third: usize,
        /// How many are allowed.
        most: usize,
    },
    /// Not even the coarsest mesh fits into the memory.
    #[error(transparent)]
    Memory(NoMemory),
    /// The equations were not solved.
    #[error(
        "the equations of {panels} panels were not solved: after {iterations} iterations the residual is {residual:.1e} of the right-hand side; \
         panels that nearly touch others make them nearly singular; give such places finer panels, or a gap of a panel's size"
    )]
    Unsolved {
        /// Panels.
        panels: usize,
        /// Iterations.
        iterations: usize,
        /// Norm of what is left over that of the right-hand side.
        residual: f64,
    },
    /// A family without a member.
    #[error("the body has no mesh")]
    NoMesh,
}

/// A mesh that does not fit into the memory.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "{panels} panels would take {} of memory and {} may be used; some {fits} panels would fit",
    size_text(*.needed_bytes), size_text(*.free_bytes)
)]
pub struct NoMemory {
    /// Its panels.
    pub panels: usize,
    /// What it would take.
    pub needed_bytes: f64,
    /// What may be used.
    pub free_bytes: f64,
    /// Panels that would fit.
    pub fits: usize,
}

/// Bytes as a person says them.
pub(crate) fn size_text(bytes: f64) -> String {
    let (size, unit) = [(1e9, "GB"), (1e6, "MB")].into_iter().find(|(size, _)| bytes >= *size).unwrap_or((1e3, "kB"));
    let number = bytes / size;
    let digits = usize::from(number < 9.95);
    format!("{number:.digits$} {unit}")
}

/// Why the refinement ended above the tolerance.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Stop {
    /// The next mesh has more panels than are allowed.
    #[error("the next mesh has {panels} panels, and {most} are allowed (--most-panels)")]
    Panels {
        /// Its panels.
        panels: usize,
        /// How many are allowed.
        most: usize,
    },
    /// The next mesh does not fit into the memory.
    #[error(transparent)]
    Memory(NoMemory),
    /// It was the finest that is made.
    #[error("no finer mesh is made")]
    Finest,
}
