//! A trajectory: a swimmer's way moment by moment, from the motion that repeats or from any pose.
//!
//! **Units.** SI.

use crate::drive::Servo;
use crate::driven::Driven;
use crate::gait::{Course, Shape};
use crate::joints::Drives;
use crate::moving::{Exact, Moving, Servoed};
use crate::path::{State, Swimmer};
use crate::period::Periodic;
use crate::planar::Motion;
use crate::robot::Robot;
use crate::swim::{SwimError, within};

/// Most numbers of a trajectory: 800 MB.
pub(crate) const MOST_NUMBERS: f64 = 1e8;

/// A moment of a trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment {
    /// s.
    pub time_s: f64,
    /// The state.
    pub state: State,
    /// What friction of the joints took, J.
    pub friction_j: f64,
    /// Centre of mass, m.
    pub centre_m: [f64; 2],
    /// Angles of the joints.
    pub shape: Shape,
    /// Torques of the motors, N m.
    pub torque_n_m: Vec<f64>,
    /// Powers: net, positive, of the drag, of friction in the joints, W.
    pub power_w: [f64; 4],
    /// Kinetic energy of body and water, J.
    pub energy_j: f64,
    /// Motions of the links.
    pub motions: Vec<Motion>,
}

/// Where a trajectory begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Begin {
    /// Centre of the head, m.
    pub place_m: [f64; 2],
    /// Heading of the head, rad.
    pub heading: f64,
    /// Its motion through the water.
    pub head: Motion,
}

impl Begin {
    /// With the motion that repeats, from the origin, so that its first period leads along x.
    #[must_use]
    pub fn with(periodic: &Periodic) -> Self {
        let [x, y] = periodic.way_m;
        Self { place_m: [0.0; 2], heading: -y.atan2(x), head: periodic.head }
    }
}

/// How it is cut into moments.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cut {
    /// Number of moments after the first.
    pub moments: usize,
    /// From one to the next, s.
    pub apart_s: f64,
    /// Steps between them.
    pub steps: usize,
}

/// A swimmer under way in a current, with servos or without; `joints`: φ and φ̇ of each where they do not begin as the course has them.
pub(crate) fn under_way<'a>(
    robot: &'a Robot,
    course: &'a dyn Course,
    drives: &'a Drives,
    current_m_s: [f64; 2],
    begin: &Begin,
    joints: &[[f64; 2]],
) -> Box<dyn Moving + 'a> {
    if drives.following.is_empty() {
        let mut swimmer = Swimmer::new(&robot.chain, course);
        swimmer.current_m_s = current_m_s;
        let state = State { place_m: begin.place_m, heading: begin.heading, head: begin.head, ..State::default() };
        return Box::new(Exact::new(swimmer, state));
    }
    let mut driven = Driven::new(&robot.chain, Servo::new(course, &drives.following, &drives.motor));
    driven.current_m_s = current_m_s;
    let j = robot.chain.joints();
    let mut wanted = Shape::straight(j);
    course.at(0.0, &mut wanted);
    let mut state = vec![0.0; driven.size()];
    state[..2].copy_from_slice(&begin.place_m);
    state[2] = begin.heading;
    state[3 + j..6 + j].copy_from_slice(&begin.head);
    for i in 0..j {
        let [angle, rate] = joints.get(i).copied().unwrap_or([wanted.angle[i], wanted.rate[i]]);
        (state[3 + i], state[6 + j + i]) = (angle, rate);
    }
    Box::new(Servoed::new(driven, state))
}

impl Robot {
    /// The trajectory of a course in a current; `joints`: φ and φ̇ of each where they do not begin as the course has them.
    ///
    /// # Errors
    ///
    /// [`SwimError`]: more numbers than a memory holds, an inertia that is not positive.
    pub fn trajectory(
        &self,
        course: &dyn Course,
        drives: &Drives,
        (begin, joints): (&Begin, &[[f64; 2]]),
        cut: Cut,
        current_m_s: [f64; 2],
    ) -> Result<Vec<Moment>, SwimError> {
        let n = self.chain.joints();
        let numbers = cut.moments as f64 * (8 * n + 26) as f64;
        if numbers > MOST_NUMBERS {
            return Err(SwimError::TooLong { moments: cut.moments, joints: n, numbers });
        }
        within(course, drives)?;
        let mut moving = under_way(self, course, drives, current_m_s, begin, joints);
        let h = cut.apart_s / cut.steps as f64;
        let mut out = Vec::new();
        for i in 0..=cut.moments {
            let time_s = i as f64 * cut.apart_s;
            let now = moving.first(time_s).ok_or(SwimError::Inertia)?;
            let (shape, torque_n_m) = (now.shape.clone(), now.torque_n_m.to_vec());
            let (power_w, motions) = (now.power_w, now.motions.to_vec());
            out.push(Moment {
                time_s,
                state: moving.state(),
                friction_j: moving.friction_j(),
                centre_m: moving.centre_m(),
                shape,
                torque_n_m,
                power_w,
                energy_j: moving.energy_j(),
                motions,
            });
            for k in 0..cut.steps {
                let time_s = (i * cut.steps + k) as f64 * h;
                moving.first(time_s).ok_or(SwimError::Inertia)?;
                moving.rest(time_s, h).ok_or(SwimError::Inertia)?;
            }
        }
        Ok(out)
    }
}
