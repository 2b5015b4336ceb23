//! From observations to coefficients: records, force models and fits together.
//!
//! The way of the data: a source's table or runs are **reduced** to observations
//! and handed over the **seam**; a **law** turns them into regressors, a
//! **regression** fits it with its budget, **selection** chooses among laws,
//! and a **record** carries the answer.
//! **Compare** sets records side by side; **simulate** goes the other way.
//!
//! **Frame.** Body axes, x forward, y to starboard, z down; loads of the fluid on the body.
//! **Units.** SI and radians.
//!
//! Not here: file formats (`froude-records`), formulas of drag (`froude-hydro`), algebra (`froude-fit`).
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod answer;
pub mod asked;
pub mod columns;
mod common;
pub mod compare;
pub mod data_files;
pub mod dataset;
pub mod diagnosis;
pub mod dissipation;
pub mod drag_coefficient;
pub mod eiv;
pub mod envelope;
mod error;
pub mod formula;
mod idle;
pub mod inspect;
pub mod lag;
pub mod large;
pub mod law;
pub mod lint;
pub mod method;
mod misfit;
mod motions;
mod named;
pub mod observations;
pub mod origins;
mod outlying;
pub mod page;
pub mod predict;
pub mod prediction;
pub mod record;
pub mod reduce;
pub mod regression;
mod result;
pub mod runs;
mod scatter_tests;
pub mod seam;
pub mod select;
pub mod selection;
pub mod simulate;
#[cfg(test)]
mod small_tables;
pub mod source;
pub mod table;
mod tare;
pub mod two_units;
pub mod uncertainty;
pub mod unevenness;
pub mod unexplained;
pub mod validation;
pub mod validity;
mod verdict;
pub mod wild;
mod zero;

pub use error::IdentifyError;
pub mod campaign_schema;
pub use froude_records::declare;
