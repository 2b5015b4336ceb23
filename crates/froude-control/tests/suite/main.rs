//! Laws of the motion control, each on a page.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::large_types_passed_by_value)]

mod any_bits;
mod coasting;
mod configuration;
mod counting;
mod driving;
mod excitation;
mod faults;
mod profiles;
mod rig;
mod shaping;
mod travel;
