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
//!
//! | what | where |
//! | --- | --- |
//! | moves as closed forms of time, shaped for a mode | [`profile`], [`ramp`], [`shaper`] |
//! | counts | [`encoder`] |
//! | how far it goes without torque, and which moves are therefore refused | [`coast`], [`travel`] |
//! | rig, gains, limits | [`config`] |
//! | tick in, command out | [`tick`], [`request`], [`status`], [`Controller`] |
//!
//! # Example
//!
//! ```
//! use froude_control::Controller;
//! use froude_control::config::Config;
//! use froude_control::request::Request;
//! use froude_control::status::{Phase, Refusal};
//! use froude_control::tick::Tick;
//!
//! let mut controller = Controller::new(Config::PUBLISHED)?;
//! let mut tick = Tick { is_host_heard: true, ..Tick::default() };
//! tick.axes[0].is_amplifier_ready = true;
//! tick.request = Some(Request::Enable { axis: 0 });
//! let output = controller.step(&tick);
//! assert_eq!(output.status.axes[0].phase, Phase::Holding);
//!
//! tick.latched_us = 250;
//! tick.request = Some(Request::Enable { axis: 1 });
//! assert_eq!(controller.step(&tick).status.refusal, Some(Refusal::NotReady));
//! # Ok::<(), froude_control::config::ConfigError>(())
//! ```
//!
//! Not here: communication ([`tick`] says what must come in), and a reference that the host streams: moves are planned here.
#![no_std]
#![deny(clippy::indexing_slicing, clippy::arithmetic_side_effects)]

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
pub mod travel;

pub use controller::Controller;
pub use feedback::FULL_FRICTION_M_S;
pub use law::SPEED_FILTER_HZ;
