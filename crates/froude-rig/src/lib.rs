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
//! | [`carriage`] | what a campaign drives, and the runs that it asks for |
//! | [`campaign`] | a whole campaign: planned, checked, driven, recorded, resumed |
//! | [`closed_loop`], [`defaults`] | the controller on the twin, and its configuration for this rig |
//! | [`injection`] | what can be broken |
//! | [`decay`] | a body on springs, let go |
//! | [`swung`] | a servo that moves a body to and fro, and the log of motion and loads |
//! | [`excited_response`] | a section in waves, held and free |
//!
//! The twin runs the same `froude_control::Controller` as the carriage. It reads no clock; all chance comes from one seed.
//!
//! A tow of the wet body at 0.4 m/s, and what the force sensor states about it:
//!
//! ```
//! use froude_control::request::{Move, Request};
//! use froude_rig::{BodyState, ClosedLoop, Load, TwinConfig, defaults::control_config};
//!
//! let load = Load::mounted(BodyState::Wet);
//! let mut config = TwinConfig::loaded(load);
//! config.axes[0].start_m = 0.05; // near the switch that homing looks for
//! config.axes[1].start_m = 0.05;
//! let mut rig = ClosedLoop::new(&config, control_config(&[load; 2]), 1)?;
//! assert!(rig.home());
//! let profile = Move { target_m: 2.5, speed_m_s: 0.4, acceleration_m_s2: 0.6, jerk_m_s3: 6.0, is_shaped: true };
//! rig.request(Request::Move { axis: 0, profile });
//! while rig.step().status.axes[0].position_m < 1.5 {}
//! // D_d = 20 N s²/m², and a zero that may be wrong by 0.2 N.
//! assert!((rig.twin.force_n() - 20.0 * 0.4 * 0.4).abs() < 0.6);
//! # Ok::<(), froude_control::config::ConfigError>(())
//! ```
//!
//! Not here: drivers of the real carriage (yet), torque ripple, waves and wake, coupling of the two axes in [`twin`].
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod accelerated_tow;
pub mod amplifier;
pub mod campaign;
pub mod carriage;
pub mod closed_loop;
pub mod decay;
pub mod defaults;
pub mod drive;
pub mod encoder;
pub mod excited_response;
pub mod force_sensor;
pub mod injection;
pub mod load;
pub mod noise;
pub mod parameters;
pub mod plant;
pub mod propagator;
pub mod steady;
pub mod swung;
pub mod twin;
pub mod weight_tow;

pub use closed_loop::ClosedLoop;
pub use injection::{Injection, Scheduled};
pub use load::{BodyState, HungWeight, Load, Strut, TowedBody};
pub use parameters::AxisParameters;
pub use twin::{AxisTwin, Spread, Truth, Twin, TwinConfig};
