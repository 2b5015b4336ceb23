//! The rig and its twin: tests of campaigns, plant and catalogue.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod campaign;
mod carriage_campaigns;
mod catalogue;
mod closed_loop;
#[path = "../../../froude-records/tests/common/mod.rs"]
mod common;
#[path = "../faults/mod.rs"]
mod faults;
mod pair;
mod plant;
mod twin;
