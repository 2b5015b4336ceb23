//! Messages between host and carriage controller: what a serial line carries, and what is left of it after noise.
//!
//! Both ends use this crate: the host with `std`, the board without a heap. Nothing here reads a clock or a port; bytes come in,
//! messages go out, and everything that went wrong on the way is counted.
//!
//! **Setting.** A serial line, 8N1, that drops, repeats, delays and corrupts bytes; two ends with clocks of their own.
//! **Units.** SI; telemetry carries raw counts and quantised references whose steps are constants of [`telemetry`]. Board time is
//! in µs and wraps at 2³².
//!
//! | layer | module | what |
//! | --- | --- | --- |
//! | messages | [`message`], [`telemetry`], [`status`] | what is said, with fixed layouts, little endian, floats as their bits |
//! | frames | [`frame`] | kind, sequence number, body, CRC-32 (ISO-HDLC), COBS, a zero between frames |
//! | operator | [`session`] | which of several hosts has the board |
//! | order | [`sequence`] | lost, repeated and late frames, counted exactly within a window of 64 |
//! | line | [`budget`] | what a baud rate can carry, and the rule by which telemetry is decimated |
//! | board | [`ring`] | telemetry waits at least 100 ms for the line; what does not fit is counted |
//! | time | [`clock`] | offset and drift of the board's clock, with their uncertainty |
//!
//! A corrupted frame is never repaired. One flipped bit is always caught by CRC-32 unless it hits one of the one or two bytes that
//! COBS adds; then the frame falls apart in several places and is caught like noise: all but one in 2³².
//!
//! Not here: encryption, authentication, routing. Whoever reaches the serial line can drive the carriage: the session number that
//! every frame of a host carries keeps two honest programs apart and authenticates nobody.
#![no_std]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod budget;
pub mod clock;
mod codec;
pub mod frame;
pub mod message;
pub mod ring;
pub mod sequence;
pub mod session;
pub mod status;
pub mod telemetry;

pub use frame::{FrameReader, FrameWriter, Received};
pub use message::{FromBoard, HostFrame, ToBoard};
pub use telemetry::Telemetry;

/// Version of the protocol. Ends with different versions greet each other and say nothing else.
///
/// | version | what is new |
/// | --- | --- |
/// | 1 | |
/// | 2 | a session number in every frame of a host and in every answer to one; hosts that are turned away |
pub const VERSION: u16 = 2;
