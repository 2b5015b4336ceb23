//! Identification from tables: tests of choices, physics and what is advised.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, missing_docs)]

mod advice;
mod choices;
mod declare;
mod drag_coefficient;
mod drift;
mod form_factor;
mod idle;
mod in_time;
mod named_laws;
mod physics;
mod seam;
