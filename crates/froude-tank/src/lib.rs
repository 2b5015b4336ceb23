//! The methods of the test tank: what a body's own motion in water shows about its added mass and damping.
//!
//! [`steady`] reduces raw tows to the rows of a table, [`weight_tow`] those of a wagon that a weight pulls; [`oscillation`] fits a body that a motor swings in time; [`decay`] reduces releases of a body on a spring to both, by the envelope of the motion and by output error.
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod decay;
mod logs;
mod long_logs;
pub mod oscillation;
pub mod steady;
pub mod weight_tow;
