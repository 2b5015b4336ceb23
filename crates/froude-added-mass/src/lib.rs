//! Added mass from potential flow: of a body file, of the modular robot with any number of links, of a mesh.
//!
//! | module | what |
//! | --- | --- |
//! | [`source`] | the method: a mesh of a campaign, its estimates, page and exports |
//! | [`option_list`] | the flags of the verb, which are the keys of a campaign |
//! | [`options`] | what is asked for, as flags or keys of a campaign say it |
//! | [`body_file`] | a shape by its dimensions, in TOML |
//! | [`load`], [`shape`] | a body file or a mesh, read and checked; the meshes of a shape |
//! | [`body`] | one body or mesh: what is computed, in which frame |
//! | [`links`] | the robot with 1 to k links: the table, its least squares |
//! | [`several`] | links of a chain, parts of a mesh: six rows and columns each |
//! | [`frame`] | axes and point of the result, and how a mesh lies |
//! | [`spectral`] | bodies of revolution to eight digits and more |
//! | [`limits`] | unbounded water, rigid lid, φ = 0: side by side, and which holds when |
//! | [`repair`] | a corrected mesh, as a new file |
//! | [`record`] | a matrix as an estimate |
//! | [`files`] | WAMIT `.1`, NetCDF and CSV, for other programs |
//! | [`page`] | what the report and the terminal say |
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod body;
pub mod body_file;
mod cross_checks;
mod error;
mod exports;
mod facet_correction;
mod facets;
pub mod files;
pub mod frame;
pub mod limits;
pub mod links;
pub mod load;
pub mod option_list;
pub mod options;
pub mod outcome;
pub mod page;
mod place;
mod pressure;
pub mod record;
pub mod repair;
pub mod several;
pub mod shape;
pub mod source;
pub mod spectral;
mod surroundings;
mod uncertain;
pub mod verb;
pub mod water;

pub use error::AddedMassError;
