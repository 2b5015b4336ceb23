//! Surface meshes of submerged bodies: generated from their geometry, checked, measured.
//!
//! **Setting.** Closed surfaces of flat triangles and quadrilaterals; corners run counter-clockwise seen from the fluid, so that
//! normals point into it.
//! **Frame.** That of the body: whoever makes the mesh says where its origin is. Bodies of sections lie along `x`.
//! **Units.** Metres.
//!
//! | module | what |
//! | --- | --- |
//! | [`mesh`] | vertices and panels, mirror images, motions |
//! | [`panel`] | area, centroid, normal, second moments of a panel |
//! | [`measure`] | volume, centre of buoyancy, inertia of the displaced water |
//! | [`check`] | closed, oriented, without slivers, copies and numbers that are none |
//! | [`sections`] | bodies of elliptic sections along a line: ellipsoids, capsules, cylinders, necks |
//! | [`robot`] | the modular snake robot: ends, links, necks at its joints |
//!
//! Not here: volume meshes, curved panels.
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod check;
pub mod files;
pub mod measure;
pub mod mesh;
pub mod panel;
pub mod robot;
pub mod sections;
pub mod vector;

pub use mesh::{Mesh, Panel};
pub use vector::Vec3;
