//! What one swimmer asks of a chain of links, whether it swims in the plane or in three dimensions.
//!
//! | | plane ([`crate::chain::Chain`]) | space ([`crate::spatial::chain::Chain`]) |
//! | --- | --- | --- |
//! | pose of the head | x, y, heading | x, y, z, quaternion |
//! | motion | ω, u, v | p, q, r, u, v, w |
//! | engine | links four side by side ([`crate::engine`]) | link by link ([`crate::spatial::engine`]) |
//! | what repeats of the pose | nothing | roll and pitch, by weight and buoyancy |
//!
//! Gait, servo, recording, sweep and draws know nothing of which it is.

use std::fmt::Debug;

use crate::chain;
use crate::drag::LinkDrag;
use crate::engine::{Given, Joints};
use crate::gait::Course;
use crate::newton::Map;
use crate::robot_file::RobotFile;
use crate::state::{Numbers, State};

/// The state of a chain's head.
pub type StateOf<C> = State<<C as Dynamics>::Pose, <C as Dynamics>::Motion>;

/// What an evaluation leaves.
#[derive(Debug, Clone, Copy)]
pub struct Evaluated<'w, M> {
    /// Motions of the links.
    pub motions: &'w [M],
    /// Torque of each joint where its motion is prescribed, else its angular acceleration.
    pub answer: &'w [f64],
    /// Power that drag takes, W.
    pub loss_w: f64,
}

/// The drag of a link on its way.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dragged {
    /// Its velocity through the water in its own axes: along, to starboard, down, m/s.
    pub velocity_m_s: [f64; 3],
    /// Force of the water in the same axes, N.
    pub force_n: [f64; 3],
    /// Power that it takes from the link, W.
    pub power_w: f64,
}

/// A body rights itself when its buoyancy lies above its mass by this much, m.
pub const RIGHTS_ITSELF_M: f64 = 1e-5;

/// How weight and buoyancy hold a straight, level body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Balance {
    /// How far the mass lies below the buoyancy, by weight, m: what rights it.
    pub righting_m: f64,
    /// How far the mass lies ahead of the buoyancy, m: what brings its bow down.
    pub trim_m: f64,
    /// Mass less that of the water displaced, kg; zero where both are equal within the digits in which they are written.
    pub heavy_kg: f64,
}

/// A chain of links with its engine.
pub trait Dynamics: Clone + Debug + PartialEq + Send + Sync {
    /// Where the head is and how it lies.
    type Pose: Numbers;
    /// Motion of the head, or of a link.
    type Motion: Numbers;
    /// Memory of the engine.
    type Work: Clone + Debug;

    /// Whether the head may roll and pitch.
    const TILTS: bool;
    /// At rest at the origin, level, heading along x.
    const REST: StateOf<Self>;

    /// The chain of a robot file with these drags in the plane and these added masses, one of each module.
    fn built(file: &RobotFile, drags: &[LinkDrag], added: &[[[f64; 6]; 6]]) -> Self;

    /// What the plane sees of it.
    fn flat(&self) -> chain::Chain;

    /// Number of joints.
    fn joints(&self) -> usize;

    /// Memory for its evaluations.
    fn work(&self) -> Self::Work;

    /// Rate of the head's motion; the joints' part is in the memory. `None` where an inertia is not positive.
    fn evaluate(
        &self,
        work: &mut Self::Work,
        state: (&Self::Pose, Self::Motion),
        joints: Joints<'_>,
        given: Given<'_>,
    ) -> Option<Self::Motion>;

    /// The same as part of a kernel.
    fn recursion(
        &self,
        work: &mut Self::Work,
        state: (&Self::Pose, Self::Motion),
        joints: Joints<'_>,
        given: Given<'_>,
    ) -> Option<Self::Motion>;

    /// What the last evaluation left.
    fn evaluated(work: &Self::Work) -> Evaluated<'_, Self::Motion>;

    /// Rate of the pose of a head that moves in a current, m/s.
    fn pose_rate(pose: &Self::Pose, head: Self::Motion, current_m_s: [f64; 3]) -> Self::Pose;

    /// A pose that a step left beside those that there are, as one of them.
    fn settle(_: &mut [f64]) {}

    /// A place, m, with roll, pitch and heading, rad.
    fn pose(place_m: [f64; 3], angles: [f64; 3]) -> Self::Pose;

    /// The place of a pose, m.
    fn place_m(pose: &Self::Pose) -> [f64; 3];

    /// Roll, pitch and heading of the head, rad.
    fn angles(pose: &Self::Pose) -> [f64; 3];

    /// Roll, pitch and yaw rate, and speeds along, to starboard and down, of a motion.
    fn six(motion: &Self::Motion) -> [f64; 6];

    /// A motion from turn rate, rad/s, and speeds along and to starboard, m/s.
    fn level(motion: [f64; 3]) -> Self::Motion;

    /// Centre of mass, m.
    fn centre_m(&self, pose: &Self::Pose, angle: &[f64]) -> [f64; 3];

    /// Kinetic energy of body and water, and potential energy of weight and buoyancy, J.
    fn energy_j(&self, pose: &Self::Pose, angle: &[f64], motions: &[Self::Motion]) -> [f64; 2];

    /// The drag of a link in a motion.
    fn dragged(&self, link: usize, motion: Self::Motion) -> Dragged;

    /// How weight and buoyancy hold the straight, level chain; `None` in the plane, where they do nothing.
    fn balance(&self) -> Option<Balance>;

    /// Whether something keeps it upright, or upside down.
    fn is_righted(&self) -> bool {
        self.balance().is_none_or(|balance| balance.righting_m.abs() > RIGHTS_ITSELF_M)
    }

    /// The map over a period of joints that follow a course exactly, in so many steps; `None` where an inertia is not positive.
    fn map<'a>(&'a self, course: &'a dyn Course, steps: usize) -> Option<Box<dyn Map + 'a>>;
}
