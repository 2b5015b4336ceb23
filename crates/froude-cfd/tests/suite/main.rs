//! Computed flow: tests against closed forms, OpenFOAM and a solver that misbehaves.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod campaign;
mod common;
#[path = "../../examples/known_flows/cylinder_mesh.rs"]
mod cylinder_mesh;
#[cfg(target_os = "linux")]
mod foam_campaign;
mod forces;
#[cfg(unix)]
mod kills;
mod o_grid;
mod oscillation;
#[path = "../../examples/known_flows/plate_mesh.rs"]
mod plate_mesh;
mod snappy;
mod solve;
#[path = "../stub/mod.rs"]
mod stub;
mod two_dimensions;
