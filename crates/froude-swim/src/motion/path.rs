//! A swimmer whose joints follow a gait exactly, over time: where the head goes and what the joints do.
//!
//! **Frame.** A uniform steady current only carries the place along.

use crate::chain::Chain;
use crate::dynamics::{Dynamics, StateOf};
use crate::engine::{Given, Joints};
use crate::gait::{Course, Shape};
use crate::state::State;

/// A swimmer with its gait.
#[derive(Debug, Clone)]
pub struct Swimmer<'a, C: Dynamics = Chain> {
    /// Its links.
    pub chain: &'a C,
    /// What its joints do.
    pub gait: &'a dyn Course,
    /// Speed of the water over the ground, m/s.
    pub current_m_s: [f64; 3],
    /// Memory of the engine.
    pub work: C::Work,
    /// Angles of the last evaluation.
    pub shape: Shape,
}

impl<'a, C: Dynamics> Swimmer<'a, C> {
    /// In still water.
    #[must_use]
    pub fn new(chain: &'a C, gait: &'a dyn Course) -> Self {
        let (work, shape) = (chain.work(), Shape::straight(chain.joints()));
        Self { chain, gait, current_m_s: [0.0; 3], work, shape }
    }

    /// Rates at a time, s; `None` where an inertia is not positive. Torques and motions of the links stand in `work`.
    pub fn rates(&mut self, time_s: f64, state: &StateOf<C>) -> Option<StateOf<C>> {
        self.gait.at(time_s, &mut self.shape);
        let joints = Joints { angle: &self.shape.angle, rate: &self.shape.rate };
        let given = Given::Acceleration(&self.shape.acceleration);
        let head = self.chain.evaluate(&mut self.work, (&state.pose, state.head), joints, given)?;
        let found = C::evaluated(&self.work);
        let of = |[net, positive, absolute]: [f64; 3], power: f64| {
            [net + power, positive + power.max(0.0), absolute + power.abs()]
        };
        let powers = found.answer.iter().zip(&self.shape.rate).map(|(torque, rate)| torque * rate);
        let [net, positive, absolute] = powers.fold([0.0; 3], of);
        Some(State {
            pose: C::pose_rate(&state.pose, state.head, self.current_m_s),
            head,
            energy_j: [net, found.loss_w, positive, absolute, 0.0],
        })
    }

    /// One step of Runge and Kutta's fourth order.
    pub fn step(&mut self, time_s: f64, h: f64, state: &StateOf<C>) -> Option<StateOf<C>> {
        let k1 = self.rates(time_s, state)?;
        self.step_from(&k1, time_s, h, state)
    }

    /// The same with the rates at its beginning.
    pub fn step_from(&mut self, k1: &StateOf<C>, time_s: f64, h: f64, state: &StateOf<C>) -> Option<StateOf<C>> {
        let k2 = self.rates(time_s + 0.5 * h, &state.moved(0.5 * h, k1))?;
        let k3 = self.rates(time_s + 0.5 * h, &state.moved(0.5 * h, &k2))?;
        let k4 = self.rates(time_s + h, &state.moved(h, &k3))?;
        let mut end = state.moved(h / 6.0, k1).moved(h / 3.0, &k2).moved(h / 3.0, &k3).moved(h / 6.0, &k4);
        C::settle(end.pose.as_mut());
        Some(end)
    }

    /// Kinetic energy of body and water and potential energy of weight and buoyancy, at the state of the last evaluation, J.
    #[must_use]
    pub fn energy_j(&self, state: &StateOf<C>) -> [f64; 2] {
        self.chain.energy_j(&state.pose, &self.shape.angle, C::evaluated(&self.work).motions)
    }

    /// Centre of mass of the body in the shape of the last evaluation, m.
    #[must_use]
    pub fn centre_m(&self, state: &StateOf<C>) -> [f64; 3] {
        self.chain.centre_m(&state.pose, &self.shape.angle)
    }
}
