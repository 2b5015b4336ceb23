//! A chain in three dimensions: six motions a link, joints that yaw or pitch, weight and buoyancy. What swims is the one swimmer of both spaces ([`crate::dynamics`]).
//!
//! | module        | content                                                            |
//! |---------------|--------------------------------------------------------------------|
//! | [`vector`]    | motion, load and inertia of six numbers, and what a joint turns     |
//! | [`attitude`]  | how a body lies, as a unit quaternion                              |
//! | [`drag`]      | drag of a link by strips, across it in two directions              |
//! | [`chain`]     | links with inertia, weight and buoyancy, and the joints between them |
//! | [`engine`]    | accelerations and joint torques in O(n)                            |
//!
//! **Frame.** Tank: x and y level, z down. Link axes at the link's centre: x forward along it, y to starboard, z down where it lies level.
//! **Units.** SI.
//!
//! It is the swimmer of the plane ([`crate::engine`]) where nothing leaves the plane: all joints yaw, and surge, sway and yaw of a link couple with heave, roll and pitch neither by added mass (A13, A14, A15,
//! A23, A24, A25, A36, A46, A56 are zero), nor by centres of mass and of buoyancy that lie above or below it, and weight and buoyancy are in balance. A26 and A35 may be there: they couple within the plane, and within its other half.
//!
//! Not here: a free surface, walls, the added mass of links on one another, `usr` (its load is printed for the plane only).

pub mod attitude;
pub mod chain;
pub mod drag;
pub mod engine;
mod in_space;
pub mod vector;
