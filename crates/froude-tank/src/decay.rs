//! Free decay: added mass and damping of one axis from releases.
//!
//! (M + A) q̈ + D_I q̇ + D_II q̇|q̇| + C (q − q₀) = 0: a body on springs or on its own hydrostatic stiffness is displaced, let go, and swings out; one
//! whose buoyancy exceeds its weight, at a radius from an axis, is driven back by B r sin(q − q₀) instead, C = B r. M and C are declared with their uncertainties; A, D_I and D_II are found, q₀ and the start of each release with them. Without M and C the
//! same fit gives the undamped frequency and both dampings per moving inertia.
//!
//! **Setting.** One axis moves, water at rest before each release, far from walls and waves of its own making.
//! **Frame.** Position along or about the axis; its zero and sign are free.
//! **Units.** SI; angles in radians.
//!
//! | module           | what                                                             | source                       |
//! |------------------|------------------------------------------------------------------|------------------------------|
//! | [`run`]          | a release, what is declared                                      | –                            |
//! | [`envelope`]     | period and decrement of each half cycle                          | Froude 1874, Himeno 1981     |
//! | [`output_error`] | the equation of motion fitted to the whole                       | Ljung 1999                   |
//! | [`motion`]       | the motion itself, with its derivatives                          | Hairer et al. 1993           |
//! | [`fit`]          | coefficients, scatter, what M and C do to them                   | Efron & Stein 1981, GUM      |
//! | [`rates`]        | what needs no inertia: frequency, damping ratio, decrement        | Froude 1874                  |
//! | [`record`]        | estimate, rows and line for the page                             | –                            |
//! | [`axis`]         | names and units of what an axis determines                       | –                            |
//! | [`section`]      | what a campaign declares and plans                               | –                            |
//! | [`releases`]     | those that a campaign plans, on the twin of its rig              | –                            |
//! | [`forecast`]     | the interval to expect of each coefficient                       | Ljung 1999, GUM              |
//! | [`plan`]         | run matrix, time, peaks and those intervals                      | –                            |
//!
//! Not here: the mass of springs (a third of it moves with the body: add it to M), two axes that swing together, waves that come back from the
//! walls, memory of the free surface (A and D_I are those of the one frequency), the Keulegan–Carpenter number.

pub mod axis;
mod envelope;
mod error;
mod findings;
pub mod fit;
pub mod forecast;
mod local;
pub mod motion;
mod output_error;
pub mod plan;
mod plausible;
mod pool;
pub mod rates;
pub mod record;
mod reduced;
pub mod releases;
pub mod run;
pub mod section;
pub mod source;
mod swings;

pub use crate::decay::reduced::FEWEST_RUNS;
pub use envelope::envelope;
pub use error::DecayError;
pub use fit::{DecayFit, HalfCycle, Method, Range, RunSummary, Scatter};
pub use output_error::output_error;
pub use run::{DecayRun, DecaySetup, DecayWindow, Known, Restoring};
