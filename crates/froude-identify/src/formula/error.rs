//! What can be wrong with a formula, stated with the place or the part.

/// Why a formula cannot be used, in words; characters count from 1.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct FormulaError(pub(super) String);

impl FormulaError {
    pub(super) fn not_linear(term: &str) -> Self {
        Self(format!("the formula is not linear in its coefficients: {term}"))
    }

    pub(super) fn not_finite(part: &str) -> Self {
        Self(format!("{part} is not a finite number"))
    }
}
