//! Added mass from potential flow: of a body file, of the modular robot with any number of links, of a mesh.
//!
//! | module | what |
//! | --- | --- |
//! | [`family`] | similar meshes of a body, each finer than the one before |
//! | [`refine`] | finer and finer until the tolerance is met, with the cost stated beforehand |
//! | [`links`] | the robot with 1 to k links: the table, its least squares |
//! | [`body`] | one body or mesh: what is computed, in which frame |
//! | [`load`] | a body file or a mesh, read and checked |
//! | [`frame`] | axes and point of the result, and how a mesh lies |
//! | [`several`] | links of a chain, parts of a mesh: six rows and columns each |
//! | [`spectral`] | bodies of revolution to eight digits and more |
//! | [`limits`] | unbounded water, rigid lid, φ = 0: side by side, and which holds when |
//! | [`repair`] | a corrected mesh, as a new file |
//! | [`record`] | a matrix as an estimate |
//! | [`page`] | the report |

pub mod body;
mod cross_checks;
mod exports;
mod facets;
pub mod family;
pub mod frame;
pub mod limits;
pub mod links;
pub mod load;
pub mod page;
mod pressure;
pub mod record;
pub mod refine;
pub mod repair;
pub mod several;
pub mod spectral;
mod surroundings;
