//! Force models, water and coefficients of bodies: tests against closed forms and published numbers.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used)]

mod common;
mod dissipation;
mod ellipsoid;
mod force_models;
mod nesting;
mod sloshing;
mod small_laws;
mod spheroids;
mod strip;
mod tabulated;
mod water;
