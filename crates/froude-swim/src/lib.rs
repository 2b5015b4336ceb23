//! Swimming of a chain of links: its dynamics in water with the drag and added mass that were identified.
//!
//! | module          | content                                                              |
//! |-----------------|----------------------------------------------------------------------|
//! | [`planar`]      | motion, load and inertia in the plane                                |
//! | [`drag`]        | drag of a link, by strips or lumped at its centre                    |
//! | [`shares`]        | the drag law of a whole robot, shared out among its modules          |
//! | [`chain`]       | links with their inertia in water                                    |
//! | [`blueprint`]     | a robot for any coefficients of its records                          |
//! | [`draws`]         | coefficients drawn from their covariance                             |
//! | [`sensitivity`]   | what speed and cost owe to each coefficient                          |
//! | [`engine`]      | accelerations and joint torques in O(n)                              |
//! | [`dynamics`]      | what one swimmer asks of a chain, in the plane or in space           |
//! | [`state`]         | its state, and what its joints and the water have taken              |
//! | [`driven`]        | a swimmer with torques at its joints over time                       |
//! | [`drive`]         | servos, motors and friction of the joints                            |
//! | [`joints`]          | what joints allow, and what drives them                              |
//! | [`stability`]       | how long a step may be                                               |
//! | [`front`]         | gaits that no other beats in both of two objectives                  |
//! | [`gait`]        | joint angles over time                                               |
//! | [`course`]        | joint angles that were recorded, or grow from straight               |
//! | [`head`]          | the head's motion over a period of a gait in the plane, four at a time |
//! | [`path`]          | a swimmer with a gait over time, its work and loss                   |
//! | [`period`]        | the motion that repeats, its speed, powers and stability             |
//! | [`moving`]          | a swimmer under way, step by step                                    |
//! | [`robot`]         | a chain from a robot file and the records that it names              |
//! | [`robot_file`]    | a robot file (TOML) or a URDF with its sidecar, as it is written     |
//! | [`gait_file`], [`motor_file`] | a gait and a motor (TOML), as they are written               |
//! | [`swim`]          | what a gait comes to                                                 |
//! | [`sweep`]         | many gaits, a row of numbers each                                    |
//! | [`spatial`]       | a chain in three dimensions, with weight and buoyancy                |
//! | [`means`]           | speed, powers and needs of a motion over a time                      |
//! | [`trajectory`]      | the way of a swimmer, moment by moment                               |
//! | [`track`]           | what a recording of joint angles comes to                            |
//! | [`verb`]          | `froude swim` and `froude robot inspect`                              |
//! | [`seen`]            | what links lose and joints need on their way                         |

// What a kernel calls must become part of it, or it is compiled plainly (froude-lanes).
#![allow(clippy::inline_always)]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

// The robot: its links, joints and drives.
mod body {
    pub(crate) mod added;
    pub mod blueprint;
    pub mod chain;
    pub mod drag;
    pub(crate) mod drag_lanes;
    pub mod drive;
    pub mod joints;
    pub(crate) mod losses;
    pub mod motor_file;
    pub mod planar;
    pub mod robot;
    pub mod robot_file;
    pub mod shares;
}

// How it moves.
mod motion {
    pub mod course;
    pub mod driven;
    pub mod dynamics;
    pub mod engine;
    pub mod gait;
    pub mod gait_file;
    pub mod head;
    mod in_plane;
    pub mod moving;
    pub(crate) mod newton;
    pub mod path;
    pub mod period;
    pub(crate) mod settled;
    pub(crate) mod sine;
    pub mod stability;
    pub mod state;
    pub(crate) mod stepped;
    pub mod trajectory;
}

// What that comes to.
mod answers {
    pub mod draws;
    pub mod front;
    pub mod means;
    pub mod seen;
    pub mod sensitivity;
    pub mod sweep;
    pub mod swim;
    pub mod track;
}

pub mod spatial;
pub mod verb;

pub use answers::*;
pub use body::*;
pub use motion::*;
