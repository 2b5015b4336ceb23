//! Swimmers in the plane and in space: tests against laws, closed forms and a second form of the equations.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod adaptive;
mod closed_form;
mod dense;
mod driven;
mod laws;
mod mamba;
mod one_swimmer;
mod robot_bytes;
mod spatial_forms;
mod spatial_laws;
mod spatial_period;
mod two_forms;
mod uncertain;
