//! What a gait comes to in three dimensions: speed, powers, cost, attitude and stability, and the way moment by moment.
//!
//! The quantities are those of [`crate::swim`]; the speed is level, and what sinks or rises stands beside it.
//!
//! **Units.** SI.

use super::attitude::{angles, of_angles};
use super::path::{State, Swimmer};
use super::period::{ONE, Periodic};
use super::robot::{RIGHTS_ITSELF_M, SpatialRobot};
use super::vector::dot;
use crate::gait::{Course, Shape};
use crate::joints::Drives;
use crate::losses::{Loss, Losses};
use crate::means::Effort;
use crate::seen::Needs;
use crate::swim::{BALANCED, STILL, Swim, SwimError, within};
use crate::trajectory::{Cut, MOST_NUMBERS};

/// A moment of a trajectory.
#[derive(Debug, Clone, PartialEq)]
pub struct SpatialMoment {
    /// s.
    pub time_s: f64,
    /// The state.
    pub state: State,
    /// Centre of mass, m.
    pub centre_m: [f64; 3],
    /// Roll, pitch and heading of the head, rad.
    pub angles: [f64; 3],
    /// Angles of the joints.
    pub shape: Shape,
    /// Torques, N m.
    pub torque_n_m: Vec<f64>,
    /// Powers: net, positive, of the drag, W.
    pub power_w: [f64; 3],
    /// Kinetic energy of body and water, and potential energy of weight and buoyancy, J.
    pub energy_j: [f64; 2],
}

impl SpatialRobot {
    /// Swims a gait of joints that follow it exactly to the motion that repeats, in steps of `step_s` at most where it is given.
    ///
    /// # Errors
    ///
    /// [`SwimError`]: joints beyond their limits, no motion that repeats, an inertia that is not positive, a step that is not stable.
    pub fn swim(&self, gait: &dyn Course, drives: &Drives, step_s: Option<f64>) -> Result<Swim<Periodic>, SwimError> {
        within(gait, drives)?;
        let mut swimmer = Swimmer::new(&self.chain, gait);
        if swimmer.rates(0.0, &State::default()).is_none() {
            return Err(SwimError::Inertia);
        }
        let (steps, _) = self.plane.steps(gait, drives, step_s)?;
        let restless = || SwimError::Restless { righting_mm: 1e3 * self.righting_m };
        let mut periodic = swimmer.periodic(steps).ok_or_else(restless)?;
        let mut unstable = None;
        // What nothing rights comes to no rest in roll and pitch.
        if periodic.multipliers[0] > 1.0 + ONE
            && self.righting_m.abs() > RIGHTS_ITSELF_M
            && let Some(settled) = swimmer.settled(&periodic, steps)
        {
            unstable = Some(Box::new(std::mem::replace(&mut periodic, settled)));
        }
        let means = periodic.means;
        let length: f64 = self.chain.links.iter().map(|link| 2.0 * link.half_length_m).sum();
        if means.speed_m_s * gait.period_s() < STILL * length {
            return Err(SwimError::Still { speed_m_s: means.speed_m_s });
        }
        let given = means.loss_w + periodic.lifting_w;
        // What is no number is not balanced either.
        let is_balanced = (given - means.net_w).abs() <= BALANCED * means.net_w.abs().max(means.loss_w);
        if !is_balanced {
            return Err(restless());
        }
        let (losses, needs) = self.seen(&mut swimmer, &periodic, steps, drives).ok_or(SwimError::Inertia)?;
        let weight_n: f64 = self.chain.links.iter().map(|link| link.weight_n).sum();
        Ok(Swim {
            cost: means.net_w / (weight_n * means.speed_m_s),
            effort: Effort {
                electric_w: drives.motor.electric_w(means.positive_w, means.absolute_w - means.positive_w),
                needs,
                steps,
                stiffness: None,
                extrapolated: losses.extrapolated(self.plane.speed_m_s, self.plane.angle_rad),
                along: losses.along(),
                median_angle_rad: losses.median_angle_rad(),
                gain_w: None,
            },
            periodic,
            unstable,
        })
    }

    /// What links lose and joints need over the period, at each step.
    fn seen(
        &self,
        swimmer: &mut Swimmer<'_>,
        periodic: &Periodic,
        steps: usize,
        drives: &Drives,
    ) -> Option<(Losses, Needs)> {
        let h = swimmer.gait.period_s() / steps as f64;
        let (mut losses, mut needs, mut state) = (Losses::default(), Needs::default(), periodic.start);
        for i in 0..steps {
            swimmer.rates(i as f64 * h, &state)?;
            for (link, motion) in self.chain.links.iter().zip(swimmer.work.motions()) {
                let [.., u, v, w] = *motion;
                let load = link.drag.load(link.half_length_m, *motion);
                losses.0.push(Loss {
                    speed_m_s: (u * u + v * v + w * w).sqrt(),
                    angle_rad: v.hypot(w).atan2(u.abs()),
                    power_w: (-dot(load, *motion)).max(0.0),
                    along_w: -load[3] * u,
                });
            }
            for (joint, (torque, rate)) in swimmer.work.answer.iter().zip(&swimmer.shape.rate).enumerate() {
                needs.see(drives, joint, *torque, *rate);
            }
            state = swimmer.step(i as f64 * h, h, &state)?;
        }
        Some((losses, needs))
    }

    /// The trajectory of a course from a state, in a current.
    ///
    /// # Errors
    ///
    /// [`SwimError`]: more numbers than a memory holds, an inertia that is not positive.
    pub fn trajectory(
        &self,
        course: &dyn Course,
        start: &State,
        cut: Cut,
        current_m_s: [f64; 3],
    ) -> Result<Vec<SpatialMoment>, SwimError> {
        let joints = self.chain.joints.len();
        let numbers = cut.moments as f64 * (5 * joints + 34) as f64;
        if numbers > MOST_NUMBERS {
            return Err(SwimError::TooLong { moments: cut.moments, joints, numbers });
        }
        let mut swimmer = Swimmer::new(&self.chain, course);
        swimmer.current_m_s = current_m_s;
        let h = cut.apart_s / cut.steps as f64;
        let (mut state, mut out) = (*start, Vec::with_capacity(cut.moments + 1));
        for i in 0..=cut.moments {
            let time_s = i as f64 * cut.apart_s;
            let rates = swimmer.rates(time_s, &state).ok_or(SwimError::Inertia)?;
            out.push(SpatialMoment {
                time_s,
                state,
                centre_m: swimmer.centre_m(&state),
                angles: angles(state.attitude),
                shape: swimmer.shape.clone(),
                torque_n_m: swimmer.work.answer.clone(),
                power_w: [rates.work_j, rates.positive_j, rates.loss_j],
                energy_j: swimmer.energy_j(&state),
            });
            for k in 0..cut.steps {
                let time_s = (i * cut.steps + k) as f64 * h;
                state = swimmer.step(time_s, h, &state).ok_or(SwimError::Inertia)?;
            }
        }
        Ok(out)
    }
}

impl Periodic {
    /// Where a trajectory with this motion begins, so that its first period leads along x.
    #[must_use]
    pub fn begin(&self) -> State {
        let [roll, pitch, heading] = angles(self.start.attitude);
        let [x, y, _] = self.way_m;
        State { attitude: of_angles([roll, pitch, heading - y.atan2(x)]), ..self.start }
    }
}
