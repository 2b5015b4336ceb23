//! The methods of the towing carriage: what its runs show about the drag, the drive and the position loop.
//!
//! [`drag`] reduces towed runs to D_d by a force sensor, by differences of the motor's current and by a model of the drive. [`servo`] identifies that
//! model, rigid and as two masses with a chain between them. [`tuning`] measures the frequency response of an axis and chooses its gains.
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

// The records that tests identify name this crate as those outside do.
#[cfg(test)]
extern crate self as froude_carriage;

pub mod axis;
pub mod drag;
#[cfg(test)]
#[path = "../tests/flexible_axis/mod.rs"]
mod flexible_axis;
pub mod forecast;
pub mod live;
pub mod reduction;
pub mod runs;
#[cfg(test)]
#[path = "../tests/scenario/mod.rs"]
mod scenario;
pub mod servo;
pub mod source;
pub mod tuning;
pub mod two_masses;
