//! Rotation: the fluid torque on a body that a motor turns to and fro about its own centre, in water at rest.
//!
//! A torque cell between shaft and body shows the moment of the rig on the body about the axis,
//!
//! m_m = J θ̈ − m_F + K sin θ,  m_F = −λ₁ θ̈ − λ₂ θ̇ − λ₃ θ̇|θ̇|,
//!
//! and λ₁, λ₂, λ₃ and the delay of the torque behind the angle are fitted together in time (`joint`). J θ̈ and λ₁ θ̈ look alike: J is declared, or found by the
//! same motion in air (role `dry_air`). What the water does to the shaft is found from runs without the body (role `tare`), with λs of its own.
//!
//! **Setting.** One rigid body, its centre on the axis, water at rest; small corrections of the flow that a body in rotation drags along are left out.
//! **Frame.** The body's z axis lies along the axis of rotation; θ and the moment are positive the same way round. **Units.** SI; angles in radians.
//!
//! | module           | what                                                       | source                     |
//! |------------------|------------------------------------------------------------|----------------------------|
//! | [`section`]      | what a campaign declares and plans                         | –                          |
//! | [`setup`]        | runs, and what is declared                                 | USR eq. 7                  |
//! | [`mod@fit`]      | the equation above and its unknowns                        | USR eq. 7                  |
//! | [`mod@derive`]   | C_A, C_M, C_f and C_D from the λs, and the law behind λ₃   | USR eq. 8, strip theory    |
//! | [`findings`]     | what is doubtful                                           | –                          |
//! | [`simulate`]     | the runs that a campaign would give                        | –                          |
//! | [`mod@forecast`], [`plan`] | the intervals to expect of a plan                | Fisher 1922                |
//! | [`page`], [`record`], [`source`] | report, estimate, campaign                 | –                          |
//!
//! Not here: turning without end (the water turns with the body), a body away from its axis (see [`crate::oscillation`]), a stream, shafts that twist,
//! roll damping of a hull with a free surface.

pub mod derive;
pub mod findings;
pub mod fit;
pub mod forecast;
pub mod page;
pub mod plan;
pub mod record;
pub mod section;
pub mod setup;
pub mod simulate;
pub mod source;

pub use crate::motion::{Cycles, Motion};
pub use derive::{Derived, LawBehind, derived, law_behind};
pub use fit::{RotationFit, fit};
pub use froude_hydro::swing::Pivot as Axis;
pub use froude_rig::rotation::Mounted;
pub use setup::{RotationRun, Setup, motions, motions_without};
