//! Why a rotation gives no coefficients.

use crate::joint::JointError;
use crate::motion::MotionError;

/// Why a rotation gives no coefficients; each message states what to do.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RotationError {
    /// Nothing was given.
    #[error("no run with the body in water was given; a rotation needs at least one of the role test")]
    NoRuns,

    /// λ₁ is what is left of the inertia.
    #[error(
        "the inertia of the body is neither declared nor measured, and added inertia cannot be told from it: write [source.rotation] inertia = {{ value = \
         \"3.4e-3 kg m^2\", standard = \"1e-5 kg m^2\" }}, or turn the body in air (role = \"dry_air\")"
    )]
    NoInertia,

    /// The shaft's inertia is in its tare.
    #[error(
        "there are runs of the shaft alone (role = \"tare\"), and its own inertia is not declared: write [source.rotation] tare_inertia, of all that moves below the torque cell \
         without the body"
    )]
    NoTareInertia,

    /// A run whose motion cannot be used.
    #[error(transparent)]
    Motion(#[from] MotionError),

    /// The fit refused.
    #[error(transparent)]
    Joint(#[from] JointError),

    /// A plan that determines nothing.
    #[error(
        "the planned runs do not tell lambda_1, lambda_2 and lambda_3 apart; plan a second amplitude or frequency, and runs in water (role = \"test\")"
    )]
    Alike,
}
