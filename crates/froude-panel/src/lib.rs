//! Added mass of submerged bodies from potential flow.
//!
//! **Setting.** Rigid bodies, or chains of them, moving in an ideal fluid at rest far away: unbounded, or with mirror planes. Nothing here
//! depends on frequency.
//! **Frame.** That of the mesh; moments are about the origin that the caller names.
//! **Units.** SI. A matrix over ρ has m³ (forces from motion), m⁴ (coupling), m⁵ (moments from turning).
//!
//! | module | what | source |
//! | --- | --- | --- |
//! | [`influence`] | potential and solid angle of a flat panel | Hess & Smith 1967; Van Oosterom & Strackee 1983 |
//! | [`mirror`] | planes of the body, walls, free surface | images |
//! | [`problem`] | what moves, what stands, what mirrors; forces from potentials | Newman 1977, 4.13 |
//! | [`dense`] | the plain solver: every panel on every other, LU | Green's third identity |
//! | [`fast`] | near panels in closed form, far ones by expansion, iterations | Ying, Biros & Zorin 2004; Saad & Schultz 1986 |
//! | [`revolution`], [`elliptic`] | bodies of revolution in azimuthal modes, to nine digits | our derivation; Abramowitz & Stegun 17.6 |
//! | [`matrix`] | the 6 × 6 matrix, moved to another point, symmetric part | Newman 1977, 4.13 |
//! | [`convergence`] | error of a value from similar meshes | Richardson 1911; Roache 1994 |
//! | [`study`] | the matrices of similar meshes put together | |
//! | [`family`] | similar meshes of a body, each finer than the one before | |
//! | [`refine`] | finer and finer until the tolerance is met, with the cost stated beforehand | |
//! | [`tank`] | a body between walls, under both limits of the water surface | images |
//! | [`chain`] | all links of a robot, straight or bent; error of a diagonal form | our derivation |
//!
//! **Method.** Direct formulation. With the normal n into the fluid, G = 1/(4π|x − y|) and φ falling off far away, a point on a smooth
//! surface has ½φ(x) = ∫ φ ∂G/∂n_y dS − ∫ G ∂φ/∂n dS, that is (½ I − K) φ = −S ∂φ/∂n. Potentials are constant over a panel and the equation
//! holds at its centroid. One matrix serves all modes; A_ij = −ρ ∫ φ_j n_i dS. There are no irregular frequencies, and the spectrum of
//! ½ I − K lies between 0 and 1 with a condition of 2 to 3 for bodies without deep recesses.
//!
//! Not here: waves, viscosity, lift.
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod chain;
mod closed;
pub mod convergence;
pub mod dense;
pub mod elliptic;
mod expansion;
pub mod family;
pub mod fast;
mod frame;
mod gmres;
pub mod influence;
pub mod matrix;
pub mod mirror;
pub mod problem;
pub mod refine;
pub mod revolution;
pub mod study;
pub mod tank;
mod tree;

use problem::{Problem, Solution};

/// Pairs of an unknown with a panel or an image up to which the plain solver is as quick as the fast one, and free of its 3e-7.
pub const PLAIN_PAIRS: usize = 2_500_000;

/// Whether [`solve`] takes the plain solver.
#[must_use]
pub fn is_plain(problem: &Problem) -> bool {
    let n = problem.facets.len();
    (n * n) << problem.mirrors.len() <= PLAIN_PAIRS
}

/// Solves by the plain solver where it is quick, else by the fast one.
#[must_use]
pub fn solve(problem: &Problem) -> Solution {
    if is_plain(problem) { dense::solve(problem) } else { fast::solve(problem) }
}
