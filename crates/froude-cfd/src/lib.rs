//! CFD campaigns: bodies become volume meshes, settings become cases of OpenFOAM, and cases become forces with a numerical uncertainty.
//!
//! **Frame.** SNAME axes of the body: x forward, y to starboard, z down. The body stands still in the case, and the water comes towards it: at the angle α the body's velocity through the water is `U (cos α, −sin α, 0)`, the inflow its opposite.
//! **Units.** SI, radians.
//!
//! | module | content |
//! | --- | --- |
//! | [`again`] | settings that are computed again: from the inflow, on other grids, in other domains |
//! | [`block`] | blocks of cells whose sides may be bent onto each other |
//! | [`body`] | bodies by their dimensions: shape, lengths, grid |
//! | [`case`] | all that a case is: its file, and the hash that says which cases are the same |
//! | [`change`] | a plan over what a campaign's folder holds |
//! | [`collect`] | the table of results |
//! | [`cost`] | what cases cost, measured and assumed |
//! | [`dictionary`] | dictionaries of OpenFOAM, written |
//! | [`engine`] | what works through a campaign |
//! | [`evidence`] | files that a result stands on, by their checksums |
//! | [`family`] | families of similar O-grids, each finer by √2 |
//! | [`flow_field`] | pressure and velocity of a solved case, on its mesh |
//! | [`foam_case`] | a case's folder as OpenFOAM wants it, with its [start and boundary](foam_fields), its [schemes](foam_system), its [mesh](foam_mesh) |
//! | [`foam_solver`] | OpenFOAM as the solver of a campaign |
//! | [`forces`] | force files of cases that others computed, as a source |
//! | [`grid_error`] | how far a result is from that of infinitely many cells |
//! | [`history`] | forces and moments of each iteration, read |
//! | [`judge`] | converged, oscillating, diverged or failed: on forces, over a [`window`] |
//! | [`layers`] | layers from a wall outwards, each thicker than the one before |
//! | [`lock`] | one coordinator a campaign, one worker a case |
//! | [`matrix`] | the run matrix of a campaign as cases, with the case that each starts from |
//! | [`meridian`] | the meridian of a body of elliptic sections, and where a mesh cuts it |
//! | [`mesh_error`] | why there is no mesh |
//! | [`midplane`] | speeds in the plane z = 0 through the body |
//! | [`mirror`] | loads that the symmetry of body and motion leaves no mean of |
//! | [`numerical`] | what the mesh does to the forces of a campaign: their correction and what it leaves |
//! | [`o_grid`] | O-grids around bodies of elliptic sections |
//! | [`openfoam`] | where it is, which it is, running its programs |
//! | [`orphans`] | solvers that outlived their coordinator |
//! | [`oscillation`] | a body that swings, at rest or in a stream: added mass and damping of each period |
//! | [`outcome`] | what a case came to: its forces, how far they are known, and why it ended |
//! | [`over_angles`] | a number a load, known at some settings and wanted at all |
//! | [`poly_mesh`] | a volume mesh as OpenFOAM has it |
//! | [`poly_mesh_files`] | a mesh as the files of OpenFOAM, in a folder that its content names |
//! | [`process`] | processes by more than their number |
//! | [`quality`] | how good a mesh is, by the measures of `checkMesh` |
//! | [`result`] | results of attempts, and the one that counts |
//! | [`retry`] | cases that are to be computed again |
//! | [`section`] | what a campaign says of a computed flow |
//! | [`snappy`] | meshes of any closed surface by snappyHexMesh, with its [files](snappy_files) and [what came out](snappy_log) |
//! | [`solve`] | a whole case, from its folder to its outcome |
//! | [`solver_log`] | residuals, time of processors, errors, the largest speed, y+ |
//! | [`status`] | how far a campaign is |
//! | [`store`] | the folder of a campaign |
//! | [`store_error`] | why that cannot be worked with |
//! | [`study`] | settings on a family of grids and in several domains |
//! | [`suggest`] | which settings to compute next |
//! | [`surface_pressure`] | the pressure on the body's surface |
//! | [`surface`] | a closed surface as a body: its lengths, its symmetry |
//! | [`transient`] | a case in time |
//! | [`verb`] | `froude cfd` |
//! | [`warm`] | starting from another case's last fields, scaled |
//! | [`work`] | one case, done once |
//!
//! Not here: what the forces say of coefficients (`froude-identify`), potential flow (`froude-panel`).
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

// Settings to compute, and what a campaign says of them.
mod settings {
    pub mod again;
    pub mod case;
    pub(crate) mod keys;
    pub mod matrix;
    pub mod section;
    pub mod study;
    pub mod suggest;
}

// Volume meshes about bodies.
mod mesh {
    pub mod block;
    pub mod body;
    pub mod family;
    pub mod layers;
    pub mod meridian;
    pub mod mesh_error;
    pub mod o_grid;
    pub mod poly_mesh;
    pub mod poly_mesh_files;
    pub(crate) mod poly_mesh_read;
    pub mod quality;
    pub mod snappy;
    pub mod snappy_files;
    pub mod snappy_log;
    pub mod surface;
}

// Cases of OpenFOAM: written, solved, read.
mod foam {
    pub(crate) mod attempt;
    pub mod dictionary;
    pub(crate) mod foam_binary;
    pub mod foam_case;
    pub mod foam_error;
    pub mod foam_fields;
    pub mod foam_mesh;
    pub mod foam_solver;
    pub mod foam_system;
    pub mod history;
    pub mod openfoam;
    pub mod oscillation;
    pub mod solve;
    pub mod solver_log;
    pub mod transient;
    pub mod warm;
}

// Convergence, grid error and status of computed forces.
mod judging {
    pub mod grid_error;
    pub mod judge;
    pub mod mirror;
    pub mod numerical;
    pub mod outcome;
    pub mod over_angles;
    pub mod wall;
    pub mod window;
}

// Flow fields of solved cases.
mod fields {
    pub mod flow_field;
    pub mod midplane;
    pub mod surface_pressure;
}

// The folder of a campaign.
mod folder {
    pub mod change;
    pub mod collect;
    pub mod evidence;
    pub(crate) mod input;
    pub mod lock;
    pub mod result;
    pub mod retry;
    pub mod status;
    pub mod store;
    pub mod store_error;
}

// Who works through it.
mod workers {
    pub mod cost;
    pub mod engine;
    pub mod orphans;
    pub mod process;
    pub mod work;
}

// Force files of cases that others computed.
pub mod forces {
    //! Force files of OpenFOAM cases of others: read, joined and judged, as a source of `froude identify` ([`source`]).

    mod coefficients;
    mod convert;
    mod dat;
    mod files;
    mod gathered;
    pub mod inspect;
    mod judged;
    pub mod keys;
    mod page;
    mod pattern;
    mod settings;
    pub mod source;
}
pub mod verb;

pub use fields::*;
pub use foam::*;
pub use folder::*;
pub use judging::*;
pub use mesh::*;
pub use settings::*;
pub use workers::*;
