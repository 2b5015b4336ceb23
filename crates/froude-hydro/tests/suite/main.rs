//! Force models, water and coefficients of bodies: tests against closed forms and published numbers.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod closed_forms;
mod common;
mod dissipation;
mod ellipsoid;
mod force_models;
mod near_wall;
mod nesting;
mod small_laws;
mod strip;
mod tabulated;
mod water;
