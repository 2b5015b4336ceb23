//! A swimmer whose joints follow a gait, over time: where the head goes and what the joints do.
//!
//! **State.** Place and heading of the head's centre in the tank, its motion through the water in its own axes, and the integrals of the powers: of the joints Σ τφ̇, its positive part,
//! its size, and of the drag. Work and loss are integrated as states, so that W − E_loss − ΔE_kinetic is what the integration itself loses.
//!
//! **Frame.** A uniform steady current only carries the place along.

use crate::chain::Chain;
use crate::engine::{Given, Joints, Workspace};
use crate::gait::{Course, Shape};
use crate::planar::Motion;

/// A state; the same numbers are its rates.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct State {
    /// Centre of the head, m.
    pub place_m: [f64; 2],
    /// Its heading, rad.
    pub heading: f64,
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

impl State {
    /// The numbers of a state, one after the other.
    #[must_use]
    pub fn numbers(&self) -> [f64; 10] {
        let ([x, y], [w, u, v]) = (self.place_m, self.head);
        [x, y, self.heading, w, u, v, self.work_j, self.positive_j, self.absolute_j, self.loss_j]
    }

    /// A state from its numbers.
    #[must_use]
    pub fn of(n: &[f64; 10]) -> Self {
        Self {
            place_m: [n[0], n[1]],
            heading: n[2],
            head: [n[3], n[4], n[5]],
            work_j: n[6],
            positive_j: n[7],
            absolute_j: n[8],
            loss_j: n[9],
        }
    }

    /// self + h rate.
    #[must_use]
    pub fn moved(&self, h: f64, rate: &Self) -> Self {
        let (mut n, rate) = (self.numbers(), rate.numbers());
        for (n, rate) in n.iter_mut().zip(rate) {
            *n += h * rate;
        }
        Self::of(&n)
    }
}

/// Net, positive and absolute power of joints with these torques and rates, W.
pub(crate) fn powers_w(torque_n_m: &[f64], rate_rad_s: &[f64]) -> [f64; 3] {
    let of = |[net, positive, absolute]: [f64; 3], power: f64| {
        [net + power, positive + power.max(0.0), absolute + power.abs()]
    };
    torque_n_m.iter().zip(rate_rad_s).map(|(torque, rate)| torque * rate).fold([0.0; 3], of)
}

/// A swimmer with its gait.
#[derive(Debug, Clone)]
pub struct Swimmer<'a> {
    /// Its links.
    pub chain: &'a Chain,
    /// What its joints do.
    pub gait: &'a dyn Course,
    /// Speed of the water over the ground, m/s.
    pub current_m_s: [f64; 2],
    /// Memory of the engine.
    pub work: Workspace,
    /// Angles of the last evaluation.
    pub shape: Shape,
}

impl<'a> Swimmer<'a> {
    /// In still water.
    #[must_use]
    pub fn new(chain: &'a Chain, gait: &'a dyn Course) -> Self {
        let (work, shape) = (Workspace::new(chain), Shape::straight(chain.joints()));
        Self { chain, gait, current_m_s: [0.0; 2], work, shape }
    }

    /// Rates at a time, s; `None` where an inertia is not positive. Torques and motions of the links stand in `work`.
    pub fn rates(&mut self, time_s: f64, state: &State) -> Option<State> {
        self.gait.at(time_s, &mut self.shape);
        let joints = Joints { angle: &self.shape.angle, rate: &self.shape.rate };
        let head = self.work.evaluate(state.head, joints, Given::Acceleration(&self.shape.acceleration))?;
        let [net, positive, absolute] = powers_w(&self.work.answer, &self.shape.rate);
        let (s, c) = state.heading.sin_cos();
        let [w, u, v] = state.head;
        Some(State {
            place_m: [c * u - s * v + self.current_m_s[0], s * u + c * v + self.current_m_s[1]],
            heading: w,
            head,
            work_j: net,
            positive_j: positive,
            absolute_j: absolute,
            loss_j: self.work.loss_w,
        })
    }

    /// One step of Runge and Kutta's fourth order.
    pub fn step(&mut self, time_s: f64, h: f64, state: &State) -> Option<State> {
        let k1 = self.rates(time_s, state)?;
        self.step_from(&k1, time_s, h, state)
    }

    /// The same with the rates at its beginning.
    pub fn step_from(&mut self, k1: &State, time_s: f64, h: f64, state: &State) -> Option<State> {
        let k2 = self.rates(time_s + 0.5 * h, &state.moved(0.5 * h, k1))?;
        let k3 = self.rates(time_s + 0.5 * h, &state.moved(0.5 * h, &k2))?;
        let k4 = self.rates(time_s + h, &state.moved(h, &k3))?;
        Some(state.moved(h / 6.0, k1).moved(h / 3.0, &k2).moved(h / 3.0, &k3).moved(h / 6.0, &k4))
    }

    /// Kinetic energy of body and water at the last evaluation, J.
    #[must_use]
    pub fn energy_j(&self) -> f64 {
        self.chain.energy_j(self.work.motions())
    }

    /// Centre of mass of the body in the shape of the last evaluation, m.
    #[must_use]
    pub fn centre_m(&self, state: &State) -> [f64; 2] {
        self.chain.centre_m(state.place_m, state.heading, &self.shape.angle)
    }
}
