//! The link to the board: tests of frames, clock and session.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod any;
mod clock;
mod frames;
mod session;
