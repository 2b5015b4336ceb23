//! Motion control of a two-axis towing carriage, one tick at a time.
//!
//! The same [`Controller::step`] runs on the carriage's processor, in the simulated rig and in the replay of a log: it reads
//! no clock, allocates nothing and cannot panic, so a recorded log of ticks replays to the same commands, bit for bit.
//!
//! **Setting.** Two axes, each a DC motor in current mode with a gearbox, a sprocket and a chain; an incremental encoder on the motor.
//! **Frame.** Axis coordinate along the chain, y = Rθ/n: `position_m` is the motor's angle seen at the chain.
//! **Units.** SI; the drive command is in volts, τ_m = K_T K_amp v_c.
//!
//! This is **not a safety function** (no performance level, no SIL): emergency stop and end switches cut the drive in hardware;
//! this code only reads them. See [`fault`] for the stop categories.
#![no_std]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod axis;
pub mod coast;
pub mod config;
mod controller;
pub mod encoder;
mod excite;
pub mod fault;
mod feedback;
mod homing;
mod law;
mod monitor;
pub mod profile;
pub mod ramp;
pub mod request;
pub mod shaper;
pub mod status;
pub mod tick;
mod travel;

pub use controller::Controller;
