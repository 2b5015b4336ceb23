//! A trajectory: a swimmer's way moment by moment, from the motion that repeats or from any pose.
//!
//! **Units.** SI.

use crate::chain::Chain;
use crate::drive::Servo;
use crate::driven::Driven;
use crate::dynamics::{Dynamics, StateOf};
use crate::gait::{Course, Shape};
use crate::joints::Drives;
use crate::moving::{Exact, Moving, Servoed};
use crate::path::Swimmer;
use crate::robot::Robot;
use crate::state::Numbers;
use crate::swim::{Status, SwimError, within};

/// Most numbers of a trajectory: 800 MB.
const MOST_NUMBERS: f64 = 1e8;

/// A moment of a trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct Moment<C: Dynamics = Chain> {
    /// s.
    pub time_s: f64,
    /// The head, with the energies.
    pub state: StateOf<C>,
    /// Centre of mass, m.
    pub centre_m: [f64; 3],
    /// Angles of the joints.
    pub shape: Shape,
    /// Torques of the motors, N m.
    pub torque_n_m: Vec<f64>,
    /// Powers: net, positive, of the drag, of friction in the joints, W.
    pub power_w: [f64; 4],
    /// Kinetic energy of body and water, and potential energy of weight and buoyancy, J.
    pub energy_j: [f64; 2],
    /// Motions of the links.
    pub motions: Vec<C::Motion>,
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
pub(crate) fn under_way<'a, C: Dynamics>(
    chain: &'a C,
    course: &'a dyn Course,
    drives: &'a Drives,
    current_m_s: [f64; 3],
    begin: &StateOf<C>,
    joints: &[[f64; 2]],
) -> Box<dyn Moving<C> + 'a> {
    if drives.following.is_empty() {
        let swimmer = Swimmer { current_m_s, ..Swimmer::new(chain, course) };
        return Box::new(Exact::new(swimmer, *begin));
    }
    let mut driven = Driven::new(chain, Servo::new(course, &drives.following, &drives.motor));
    let mut shape = Shape::straight(chain.joints());
    course.at(0.0, &mut shape);
    for (i, [angle, rate]) in joints.iter().enumerate() {
        (shape.angle[i], shape.rate[i]) = (*angle, *rate);
    }
    driven.current_m_s = current_m_s;
    let state = driven.state(begin, &shape.angle, &shape.rate);
    Box::new(Servoed::new(driven, state))
}

impl<C: Dynamics> Robot<C> {
    /// The trajectory of a course in a current; `joints`: φ and φ̇ of each where they do not begin as the course has them.
    ///
    /// # Errors
    ///
    /// [`SwimError`]: more numbers than a memory holds, an inertia that is not positive.
    pub fn trajectory(
        &self,
        course: &dyn Course,
        drives: &Drives,
        (begin, joints): (&StateOf<C>, &[[f64; 2]]),
        cut: Cut,
        [x, y]: [f64; 2],
    ) -> Result<Vec<Moment<C>>, SwimError> {
        let n = self.chain.joints();
        let numbers = cut.moments as f64 * ((5 + C::Motion::LEN) * n + 26) as f64;
        if numbers > MOST_NUMBERS {
            let words = format!(
                "{} moments of {n} joints are {numbers:e} numbers; a trajectory has 1e8 at most: ask for fewer --periods",
                cut.moments
            );
            return Err(SwimError::of(Status::NotPeriodic, words));
        }
        within(course, drives)?;
        let mut moving = under_way(&self.chain, course, drives, [x, y, 0.0], begin, joints);
        let h = cut.apart_s / cut.steps as f64;
        let mut out = Vec::new();
        for i in 0..=cut.moments {
            let time_s = i as f64 * cut.apart_s;
            let now = moving.first(time_s).ok_or_else(SwimError::inertia)?;
            let (shape, torque_n_m) = (now.shape.clone(), now.torque_n_m.to_vec());
            let (power_w, motions) = (now.power_w, now.motions.to_vec());
            let (state, centre_m, energy_j) = (moving.state(), moving.centre_m(), moving.energy_j());
            out.push(Moment { time_s, state, centre_m, shape, torque_n_m, power_w, energy_j, motions });
            for k in 0..cut.steps {
                let time_s = (i * cut.steps + k) as f64 * h;
                moving.first(time_s).ok_or_else(SwimError::inertia)?;
                moving.rest(time_s, h).ok_or_else(SwimError::inertia)?;
            }
        }
        Ok(out)
    }
}
