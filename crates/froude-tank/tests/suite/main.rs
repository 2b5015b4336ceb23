//! Methods of the tank: tests on simulated runs.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, missing_docs)]

mod decay;
mod decay_limits;
mod decay_rates;
mod declared;
mod excited_response;
mod hanging;
mod hostile_sidecars;
mod oscillation;
mod rotation;
mod scenario;
mod sway;
mod toy;
mod weights;
