//! Identification of a servo axis from its own command and encoder: inertia, friction, flexibility.
//!
//! **Setting.** One axis along a line, driven by a motor in current mode; the command is what the drive receives, the
//! force at the chain is `force_per_volt_n_v` times it. No force sensor. Models of rising detail:
//!
//! | model                 | module           | equation                                                             |
//! |-----------------------|------------------|----------------------------------------------------------------------|
//! | rigid, a speed alone  | [`simulated`]     | the same without dry friction                                         |
//! | rigid, the chain      | [`chain`], [`friction`] | `M q̈ + F_v q̇ + F_c sgn q̇ + offset = g u`, asymmetric, Stribeck, over position |
//! | two masses and a chain | [`two_mass`]    | MCD eq. 2a, 2b from motor-side signals                                |
//!
//! A record of hours goes through [`long`] a chunk at a time.
//!
//! Every coefficient comes with the classical standard deviation, which needs white residuals, and beside it
//! two that do not ([`interval`]). Residuals of a servo are never white: the interval of the report is that of the blocks.
//!
//! **Frame.** Position along the chain, motor side. **Units.** SI; motor-side values by [`motor::MotorSide`].
//! **Sign.** Forces on the axis; friction coefficients are positive when they resist.
//!
//! Not here: drag of the body (sensor, current difference and model based), files.

pub mod chain;
mod cluster;
pub mod coordinate;
mod error;
mod excitation;
pub mod flexible;
pub mod friction;
mod gauss_newton;
pub mod held_out;
pub mod interval;
pub mod load;
pub mod log;
pub mod long;
pub mod motion;
pub mod motor;
pub mod record;
mod regression;
pub mod report;
pub(crate) mod rows;
pub mod scale;
pub mod settle;
pub mod simulated;
pub mod two_mass;

pub use crate::servo::two_mass::{FlexibleOptions, FlexibleReport, Gear};
pub use chain::{Chain, Delay};
pub use coordinate::Coordinate;
pub use error::ServoError;
pub use friction::Friction;
pub use log::ServoLog;
pub use long::LongServo;
pub use motor::MotorSide;
pub use report::{RigidFit, ServoCoefficient, ServoReport};
pub use settle::{identify_logs, identify_servo};
pub use simulated::{SpeedLog, identify_speeds};
pub use two_mass::identify_flexible;
