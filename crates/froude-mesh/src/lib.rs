//! Surface meshes of submerged bodies: generated from their geometry, checked, measured.
//!
//! **Setting.** Closed surfaces of flat triangles and quadrilaterals; corners run counter-clockwise seen from the fluid, so that
//! normals point into it.
//! **Frame.** That of the body: the maker of the mesh states where its origin is. Bodies of sections lie along `x`.
//! **Units.** Metres.
//!
//! | module | what |
//! | --- | --- |
//! | [`mesh`] | vertices and panels, mirror images, motions |
//! | [`panel`] | area, centroid, normal, second moments of a panel |
//! | [`measure`] | volume, centre of buoyancy, inertia of the displaced water |
//! | [`files`] | STL, OBJ, PLY, WAMIT, Nemoh, Gmsh, Collada read; STL, OBJ, VTP written |
//! | [`check`] | closed, oriented, without slivers, copies and numbers that are none |
//! | [`parts`] | what hangs together; a part that is inside out, or inside another |
//! | [`crossing`] | panels through one another, or folded onto a neighbour |
//! | [`solids`] | solids that share edges; decks inside a hull |
//! | [`union`] | solids that overlap or touch made one, and its seam cleaned |
//! | [`repair`] | vertices merged, panels turned, what is superfluous taken out: each reported |
//! | [`plausible`] | doubts: drawn in millimetres, through the water's surface |
//! | [`refine`] | panels divided, warp taken out, facets rounded |
//! | [`sections`] | bodies of elliptic sections along a line: ellipsoids, capsules, cylinders, necks |
//! | [`robot`] | the modular snake robot: ends, links, necks at its joints |
//!
//! Not here: volume meshes, curved panels, holes closed.
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod check;
pub mod crossing;
pub mod files;
pub mod measure;
pub mod mesh;
pub mod panel;
pub mod parts;
pub mod plausible;
pub mod refine;
pub mod repair;
pub mod robot;
mod seam;
pub mod sections;
pub mod solids;
mod topology;
pub mod union;
pub mod vector;

pub use mesh::{Mesh, Panel};
pub use vector::Vec3;
