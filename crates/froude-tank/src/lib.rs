//! The methods of the test tank: what a body's own motion in water shows about its added mass and damping.
//!
//! [`decay`] reduces releases of a body on a spring to both, by the envelope of the motion and by output error.
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod decay;
pub mod oscillation;
