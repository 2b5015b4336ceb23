//! Why releases give no coefficients.

use crate::error::TankError;

/// Why releases give no coefficients; each message states what to do.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DecayError {
    /// A release that is left out where there are others.
    #[error("run {run:?}: {why}")]
    Release {
        /// The release.
        run: String,
        /// What it lacks.
        why: String,
        /// Peaks that it has, where they are too few.
        peaks: Option<usize>,
    },
    /// What all of them lack, or one that is damaged.
    #[error(transparent)]
    Refused(#[from] TankError),
}

impl DecayError {
    pub(super) fn of_release(run: &str, why: impl Into<String>) -> Self {
        Self::Release { run: run.to_owned(), why: why.into(), peaks: None }
    }

    /// What least squares refuse of the motion.
    pub(super) fn of_fit(why: &str) -> Self {
        TankError::new(format!("output error: {why}")).into()
    }

    /// Half cycles that do not determine something.
    pub(super) fn undetermined(what: &str) -> Self {
        let why = format!("the half cycles do not determine {what}; release from amplitudes that differ more");
        TankError::new(why).into()
    }
}
