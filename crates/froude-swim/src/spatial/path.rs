//! A swimmer in three dimensions whose joints follow a gait, over time.
//!
//! **State.** Place of the head's centre in the tank, how it lies, its motion through the water in its own axes, and the integrals of the powers: of the joints Σ τφ̇, its positive part, its size, and of the
//! drag. W − E_loss − Δ(E_kinetic + E_potential) is what the integration itself loses.
//!
//! **Frame.** A uniform steady current only carries the place along.
//! **Units.** SI.

use super::attitude::{LEVEL, Quaternion, rate, to_world, unit, world_from_body};
use super::chain::{Chain, Pose};
use super::engine::{Head, Workspace};
use super::vector::{Motion, parts};
use crate::engine::{Given, Joints};
use crate::gait::{Course, Shape};
use crate::path::powers_w;

/// A state; the same numbers are its rates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Centre of the head, m.
    pub place_m: [f64; 3],
    /// How it lies.
    pub attitude: Quaternion,
    /// Its motion through the water.
    pub head: Motion,
    /// ∫ Σ τφ̇ dt, J.
    pub work_j: f64,
    /// ∫ Σ max(τφ̇, 0) dt, J.
    pub positive_j: f64,
    /// ∫ Σ |τφ̇| dt, J.
    pub absolute_j: f64,
    /// ∫ of the power that drag takes, J.
    pub loss_j: f64,
}

impl Default for State {
    /// At rest at the origin, level.
    fn default() -> Self {
        Self {
            place_m: [0.0; 3],
            attitude: LEVEL,
            head: [0.0; 6],
            work_j: 0.0,
            positive_j: 0.0,
            absolute_j: 0.0,
            loss_j: 0.0,
        }
    }
}

impl State {
    /// The numbers of a state, one after the other.
    #[must_use]
    pub fn numbers(&self) -> [f64; 17] {
        let mut out = [0.0; 17];
        out[..3].copy_from_slice(&self.place_m);
        out[3..7].copy_from_slice(&self.attitude);
        out[7..13].copy_from_slice(&self.head);
        out[13..].copy_from_slice(&[self.work_j, self.positive_j, self.absolute_j, self.loss_j]);
        out
    }

    /// A state from its numbers.
    #[must_use]
    pub fn of(n: &[f64; 17]) -> Self {
        Self {
            place_m: [n[0], n[1], n[2]],
            attitude: [n[3], n[4], n[5], n[6]],
            head: [n[7], n[8], n[9], n[10], n[11], n[12]],
            work_j: n[13],
            positive_j: n[14],
            absolute_j: n[15],
            loss_j: n[16],
        }
    }

    /// self + h rate, off the unit sphere by what the step is off.
    #[must_use]
    pub fn moved(&self, h: f64, rate: &Self) -> Self {
        let (mut n, rate) = (self.numbers(), rate.numbers());
        for (n, rate) in n.iter_mut().zip(rate) {
            *n += h * rate;
        }
        Self::of(&n)
    }

    /// Where the head lies.
    #[must_use]
    pub fn pose(&self) -> Pose {
        Pose { place_m: self.place_m, world_from_link: world_from_body(self.attitude) }
    }
}

/// A swimmer with its gait.
#[derive(Debug, Clone)]
pub struct Swimmer<'a> {
    /// Its links.
    pub chain: &'a Chain,
    /// What its joints do.
    pub gait: &'a dyn Course,
    /// Speed of the water over the ground, m/s.
    pub current_m_s: [f64; 3],
    /// Memory of the engine.
    pub work: Workspace,
    /// Angles of the last evaluation.
    pub shape: Shape,
}

impl<'a> Swimmer<'a> {
    /// In still water.
    #[must_use]
    pub fn new(chain: &'a Chain, gait: &'a dyn Course) -> Self {
        let (work, shape) = (Workspace::new(chain), Shape::straight(chain.joints.len()));
        Self { chain, gait, current_m_s: [0.0; 3], work, shape }
    }

    /// Rates at a time, s; `None` where an inertia is not positive. Torques and motions of the links stand in `work`.
    pub fn rates(&mut self, time_s: f64, state: &State) -> Option<State> {
        self.gait.at(time_s, &mut self.shape);
        let joints = Joints { angle: &self.shape.angle, rate: &self.shape.rate };
        let world = world_from_body(state.attitude);
        let head = Head { motion: state.head, down: world[2] };
        let head = self.work.evaluate(self.chain, head, joints, Given::Acceleration(&self.shape.acceleration))?;
        let [net, positive, absolute] = powers_w(&self.work.answer, &self.shape.rate);
        let [turning, moving] = parts(state.head);
        let over_ground = to_world(&world, moving);
        Some(State {
            place_m: std::array::from_fn(|k| over_ground[k] + self.current_m_s[k]),
            attitude: rate(state.attitude, turning),
            head,
            work_j: net,
            positive_j: positive,
            absolute_j: absolute,
            loss_j: self.work.loss_w,
        })
    }

    /// One step of Runge and Kutta's fourth order, which ends on the unit sphere.
    pub fn step(&mut self, time_s: f64, h: f64, state: &State) -> Option<State> {
        let k1 = self.rates(time_s, state)?;
        let k2 = self.rates(time_s + 0.5 * h, &state.moved(0.5 * h, &k1))?;
        let k3 = self.rates(time_s + 0.5 * h, &state.moved(0.5 * h, &k2))?;
        let k4 = self.rates(time_s + h, &state.moved(h, &k3))?;
        let end = state.moved(h / 6.0, &k1).moved(h / 3.0, &k2).moved(h / 3.0, &k3).moved(h / 6.0, &k4);
        Some(State { attitude: unit(end.attitude), ..end })
    }

    /// Kinetic energy of body and water and potential energy of weight and buoyancy, at the state of the last evaluation, J.
    #[must_use]
    pub fn energy_j(&self, state: &State) -> [f64; 2] {
        [self.chain.kinetic_j(self.work.motions()), self.chain.potential_j(state.pose(), &self.shape.angle)]
    }

    /// Centre of mass of the body in the shape of the last evaluation, m.
    #[must_use]
    pub fn centre_m(&self, state: &State) -> [f64; 3] {
        self.chain.centre_m(state.pose(), &self.shape.angle)
    }
}
