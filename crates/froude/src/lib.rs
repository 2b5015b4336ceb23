//! Froude: hydrodynamic coefficients that can be trusted.
//!
//! The facade that a Rust user depends on: the rooms under their short names, and the pipeline that the program `froude` runs.
//!
//! ```no_run
//! use froude::pipeline::{Job, identify};
//! let done = identify(&Job::new("campaign.toml"), &|_| {})?;
//! println!("{}", done.file.estimates[0].id);
//! # Ok::<(), froude::Error>(())
//! ```
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub use froude_cfd as cfd;
pub use froude_control as control;
pub use froude_fit as fit;
pub use froude_hydro as hydro;
pub use froude_identify as identify;
pub use froude_mesh as mesh;
pub use froude_panel as panel;
pub use froude_records as records;
pub use froude_report as report;
pub use froude_rig as rig;
pub use froude_swim as swim;
pub use {error::Error, method::campaign_schema};

/// The methods that make estimates of sources, by what they are measured with.
pub mod methods {
    pub use {froude_added_mass as added_mass, froude_carriage as carriage, froude_tank as tank};
}

pub mod carriage;
pub mod demo;
mod error;
pub mod inspect;
mod method;
pub mod pipeline;
pub mod plan;
mod registry;
pub mod results;
pub mod swing;
pub mod twin;

/// What most programs need.
pub mod prelude {
    pub use crate::pipeline::{Identified, Input, Job, identify};
    pub use crate::records::estimate::{Coefficient, Estimate, EstimateFile, Status};
    pub use crate::records::finding::{Finding, Severity};
}
