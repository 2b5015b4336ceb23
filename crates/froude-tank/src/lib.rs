//! The methods of the test tank: what a body's own motion in water shows about its added mass and damping.
//!
//! What a log's sidecar declares of its data is done to it first ([`conditioning`]). [`steady`] reduces raw tows to the rows of a table, [`accelerated_tow`] those that speed up and slow down, [`weight_tow`] those of a wagon that a weight pulls; [`oscillation`] fits a body that a motor swings in time, [`rotation`] one that it turns about its own centre ([`joint`] is the fit of both), [`excited_response`] a section in waves, held and free; [`decay`] reduces releases of a body on a spring to both, by the envelope of the motion and by output error.
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod accelerated_tow;
mod between_runs;
pub mod channel;
pub mod conditioning;
pub mod decay;
pub mod declared;
mod drawn;
pub mod driven;
mod error;
pub mod excited_response;
pub mod extremes;
mod findings;
mod fluid;
mod inverted;
pub mod joint;
pub mod log;
mod logs;
mod long_logs;
mod matrix;
pub mod method;
pub mod motion;
pub mod names;
mod noise;
pub mod observed;
pub mod oscillation;
mod plan;
mod recorded;
mod reference;
mod residual_spectrum;
pub mod rotation;
mod sensors;
pub mod steady;
pub mod sway;
mod twin;
pub mod weight_tow;

pub use error::TankError;
