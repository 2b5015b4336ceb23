//! Digital twin of the towing carriage, and the drivers of the real one.
//!
//! | module | what |
//! | --- | --- |
//! | [`parameters`] | every constant of the two axes, with its origin |
//! | [`load`] | body, ballast, hung weight |
//! | [`plant`] | two masses, chain and friction, on an exact linear step ([`propagator`]) |
//! | [`amplifier`], [`encoder`], [`force_sensor`], [`noise`] | what stands between plant and controller |
//! | [`twin`] | all of it, tick by tick, from one seed |
//! | [`injection`] | what can be broken |
//! | [`drive`] | twin and real rig behind the same few calls |
//! | [`campaign`] | a whole campaign: planned, checked, driven, recorded, resumed |
//! | [`closed_loop`], [`defaults`] | the controller on the twin, and its configuration for this rig |
//! | [`injection`], [`catalogue`] | what can be broken, and what the controller must say then |
//! | [`planar`] | motion in the plane with rotation |
//!
//! The twin runs the same `froude_control::Controller` as the carriage. It reads no clock.
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod amplifier;
pub mod campaign;
pub mod catalogue;
pub mod closed_loop;
pub mod defaults;
pub mod drive;
pub mod encoder;
pub mod force_sensor;
pub mod injection;
pub mod load;
pub mod noise;
pub mod parameters;
pub mod planar;
pub mod plant;
pub mod propagator;
pub mod twin;

pub use catalogue::Catalogue;
pub use closed_loop::ClosedLoop;
pub use injection::{Injection, Scheduled};
pub use load::{HungWeight, Load, Mounting, Strut, TowedBody};
pub use parameters::AxisParameters;
pub use twin::{AxisTwin, Spread, Truth, Twin, TwinConfig};
