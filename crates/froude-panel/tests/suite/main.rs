//! The panel method: tests against closed forms, laws and another program.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, missing_docs)]

mod chain;
mod closed_forms;
mod fast;
mod foreign;
mod frames;
mod laws;
mod near_wall;
mod revolution;
mod robot;
mod unions;
mod walls;
