//! Why a forced oscillation gives no coefficients.

use froude_identify::IdentifyError;

use crate::joint::JointError;
use crate::motion::MotionError;

/// Why a forced oscillation gives no coefficients; each message states what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum OscillationError {
    /// Nothing was given.
    #[error("no run in water was given; a forced oscillation needs at least one")]
    NoRuns,

    /// A declared number that cannot be.
    #[error("{what} is {value}; it must be {must}")]
    Declared {
        /// What was declared.
        what: String,
        /// Its value.
        value: f64,
        /// What it must be.
        must: &'static str,
    },

    /// A run whose motion cannot be used.
    #[error(transparent)]
    Motion(#[from] MotionError),

    /// A law that this method cannot use.
    #[error("model {model} {why}")]
    Law {
        /// Its name.
        model: String,
        /// Why.
        why: String,
    },

    /// A law that cannot be computed at the motion.
    #[error(transparent)]
    Identify(#[from] IdentifyError),

    /// The fit refused.
    #[error(transparent)]
    Joint(#[from] JointError),
}
