//! The facade as a program uses it: tests of several crates together.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, missing_docs)]

mod agreement;
mod cfd_numerical;
mod exports;
mod flips;
#[path = "../held/mod.rs"]
mod held;
mod observations;
mod page;
mod predict;
mod preflight;
mod resume;
mod sections;
mod validation;
