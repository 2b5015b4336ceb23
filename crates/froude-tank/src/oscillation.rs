//! Forced oscillation: added mass, drag, buoyancy and the delay between motion and force, from runs of a body that a motor swings.
//!
//! The body hangs at a radius r from a pivot and is swung by an angle φ(t) in a stream of speed U, with a load cell between rod and body. The cell
//! shows the force of the rig on the body, across it,
//!
//! f_m = m a − f_A − f_D − B sin φ,  f_A = −C_A ρ V v̇_y,  f_D = f_D(v_x, v_y; C),
//!
//! and C_A, the drag coefficients, the net buoyancy B of each configuration and the delay of the force behind the angle are fitted together in time,
//! over whole and broken periods. The angle is fitted first, by harmonics; velocity and acceleration are its derivatives.
//!
//! **Setting.** One body, rigid rod, water at rest or an even stream; the pivot lies along the stream, or upright ([`Pivot`]).
//! **Frame.** Body axes, x along the stream at rest, y across; φ > 0 moves the body towards +y. Loads of the fluid on the body.
//! **Units.** SI; angles in radians.
//!
//! | module        | what                                                        | source                                |
//! |---------------|-------------------------------------------------------------|---------------------------------------|
//! | [`section`]   | what a campaign declares and plans                          | –                                     |
//! | [`setup`]     | runs, and what is declared                                  | USR, Table 4                          |
//! | [`crate::motion`] | harmonics of the angle, cycles                              | IEEE Std 1057                         |
//! | [`froude_hydro::swing`] | velocity and acceleration of the body through the water | USR eq. 5 and 19 (consistent form) |
//! | [`forces`]    | the regressors of the equation above                        | USR eq. 16, 17 and 20                 |
//! | [`mod@fit`]   | coefficients, their scatter, what declared errors do        | Bell & McCaffrey 2002, GUM            |
//! | [`computed`]  | the runs that a computation of the flow gives               | –                                     |
//! | [`simulate`]  | the runs that a campaign would give                         | –                                     |
//! | [`mod@forecast`] | the intervals to expect of a plan                           | Fisher 1922                           |
//! | [`plan`]      | run matrix, time, intervals, for a person                   | –                                     |
//! | [`record`]    | estimate and findings                                       | –                                     |
//!
//! Over whole periods drag is orthogonal to acceleration, whatever the law: that two drag laws then give one C_A (USR, Table 13) is an identity and
//! no evidence for either.
//!
//! Not here: moments, two axes at once, the memory of the free surface (C_A is that of the frequencies driven), rods that bend.

pub mod computed;
pub mod findings;
pub mod fit;
pub mod forces;
pub mod forecast;
pub mod page;
pub mod plan;
pub mod record;
pub mod section;
pub mod setup;
pub mod simulate;
pub mod source;

pub use crate::motion::{Cycles, Motion};
pub use fit::{OscillationFit, fit};
pub use forces::Drag;
pub use froude_hydro::swing::{Medium, Pivot};
pub use setup::{Body, OscillationRun, Setup, motions, motions_without};
