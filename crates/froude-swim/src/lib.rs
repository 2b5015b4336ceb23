//! Swimming of a chain of links: its dynamics in water with the drag and added mass that were identified.
//!
//! | module          | content                                                              |
//! |-----------------|----------------------------------------------------------------------|
//! | [`planar`]      | motion, load and inertia in the plane                                |
//! | [`drag`]        | drag of a link, by strips or lumped at its centre                    |
//! | [`shares`]        | the drag law of a whole robot, shared out among its modules          |
//! | [`chain`]       | links with their inertia in water                                    |
//! | [`engine`]      | accelerations and joint torques in O(n)                              |
//! | [`closed_form`] | the same in absolute angles, dense: the reference                    |
//! | [`driven`]        | a swimmer with torques at its joints over time                       |
//! | [`adaptive`]      | a path to a stated accuracy                                          |
//! | [`gait`]        | joint angles over time                                               |
//! | [`path`]          | a swimmer with a gait over time, its work and loss                   |
//! | [`period`]        | the motion that repeats, its speed, powers and stability             |
//! | [`robot`]         | a chain from a robot file and the records that it names              |
//! | [`swim`]          | what a gait comes to                                                 |

#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod adaptive;
pub mod chain;
pub mod closed_form;
pub mod drag;
pub mod driven;
pub mod engine;
pub mod gait;
pub mod path;
pub mod period;
pub mod planar;
pub mod robot;
pub mod shares;
pub mod swim;
