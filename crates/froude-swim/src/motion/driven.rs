//! A swimmer whose joints are driven by torques, over time.
//!
//! **State**, one number after the other: place and heading of the head (3), φ (n − 1), motion of the head through the water in its own axes (3), φ̇ (n − 1), and the integrals of the powers
//! ([`Energy`]).
//!
//! **Units.** SI.

use crate::chain::Chain;
use crate::drive::Drive;
use crate::engine::{Given, Joints, Workspace};

/// Integrals of a state, in their order, J: Σ τφ̇ of the motors, what drag takes, Σ max(τφ̇, 0), Σ |τφ̇|, and what friction of the joints takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Energy {
    /// Σ τφ̇.
    Work,
    /// Of drag.
    Loss,
    /// Σ max(τφ̇, 0).
    Positive,
    /// Σ |τφ̇|.
    Absolute,
    /// Of the joints.
    Friction,
}

/// Number of integrals.
const ENERGIES: usize = 5;

/// A chain with its drive.
#[derive(Debug, Clone)]
pub struct Driven<'a, D> {
    /// Its links.
    pub chain: &'a Chain,
    /// What drives its joints.
    pub drive: D,
    /// Speed of the water over the ground, m/s.
    pub current_m_s: [f64; 2],
    /// Memory of the engine.
    pub work: Workspace,
    /// Torques of the motors at the last evaluation, N m.
    pub torque: Vec<f64>,
    /// The same less friction.
    net: Vec<f64>,
    stages: [Vec<f64>; 3],
}

impl<'a, D: Drive> Driven<'a, D> {
    /// In still water.
    #[must_use]
    pub fn new(chain: &'a Chain, drive: D) -> Self {
        let (work, torque) = (Workspace::new(chain), vec![0.0; chain.joints()]);
        let stages = [(); 3].map(|()| vec![0.0; 2 * chain.joints() + 6 + ENERGIES]);
        Self { chain, drive, current_m_s: [0.0; 2], work, net: torque.clone(), torque, stages }
    }

    /// Length of a state.
    #[must_use]
    pub fn size(&self) -> usize {
        2 * self.chain.joints() + 6 + ENERGIES
    }

    /// Where an integral stands in a state.
    #[must_use]
    pub fn at(&self, energy: Energy) -> usize {
        2 * self.chain.joints() + 6 + energy as usize
    }

    /// Rates of a state; `None` where an inertia is not positive.
    pub fn rates(&mut self, time_s: f64, state: &[f64], rates: &mut [f64]) -> Option<()> {
        froude_lanes::run(Rates { driven: self, time_s, state, out: rates })
    }

    #[inline(always)]
    fn rates_here(&mut self, time_s: f64, state: &[f64], rates: &mut [f64]) -> Option<()> {
        let j = self.chain.joints();
        let (angle, rate) = (&state[3..3 + j], &state[6 + j..6 + 2 * j]);
        let head = [state[3 + j], state[4 + j], state[5 + j]];
        self.drive.torque(time_s, angle, rate, &mut self.torque);
        let mut energy = [0.0; ENERGIES];
        for i in 0..j {
            let (torque, rate) = (self.torque[i], rate[i]);
            let friction = self.drive.friction_n_m(i, rate);
            self.net[i] = torque - friction;
            let power = torque * rate;
            energy[Energy::Work as usize] += power;
            energy[Energy::Positive as usize] += power.max(0.0);
            energy[Energy::Absolute as usize] += power.abs();
            energy[Energy::Friction as usize] += friction * rate;
        }
        let turned = self.work.recursion(head, Joints { angle, rate }, Given::Torque(&self.net))?;
        energy[Energy::Loss as usize] = self.work.loss_w;
        let (s, c) = state[2].sin_cos();
        let [w, u, v] = head;
        rates[0] = c * u - s * v + self.current_m_s[0];
        rates[1] = s * u + c * v + self.current_m_s[1];
        rates[2] = w;
        rates[3..3 + j].copy_from_slice(rate);
        rates[3 + j..6 + j].copy_from_slice(&turned);
        rates[6 + j..6 + 2 * j].copy_from_slice(&self.work.answer);
        rates[6 + 2 * j..].copy_from_slice(&energy);
        Some(())
    }

    /// One step of Runge and Kutta's fourth order, in place; `None` where an inertia is not positive, and the state stays.
    pub fn step(&mut self, time_s: f64, h: f64, state: &mut [f64]) -> Option<()> {
        self.first_rate(time_s, state)?;
        self.rest_of_step(time_s, h, state)
    }

    /// The rate at the beginning of a step, which is kept for it.
    pub fn first_rate(&mut self, time_s: f64, state: &[f64]) -> Option<()> {
        let mut rate = std::mem::take(&mut self.stages[1]);
        let found = self.rates(time_s, state, &mut rate);
        self.stages[1] = rate;
        found
    }

    /// A power at the last [`Driven::first_rate`], W.
    #[must_use]
    pub fn first_rate_of(&self, energy: Energy) -> f64 {
        self.stages[1][self.at(energy)]
    }

    /// A step from its first rate.
    pub fn rest_of_step(&mut self, time_s: f64, h: f64, state: &mut [f64]) -> Option<()> {
        let mut stages = std::mem::take(&mut self.stages);
        let found = froude_lanes::run(Rest { driven: self, time_s, h, state, stages: &mut stages });
        self.stages = stages;
        found
    }

    /// A step by the weighed mean of its four rates, which is gathered in the first of the three; the first of the four stands in the second.
    #[inline(always)]
    fn rest_here(
        &mut self,
        time_s: f64,
        h: f64,
        state: &mut [f64],
        [mean, rate, there]: &mut [Vec<f64>; 3],
    ) -> Option<()> {
        mean.fill(0.0);
        add(mean, 1.0 / 6.0, rate);
        for (part, weight) in [(0.5, 2.0), (0.5, 2.0), (1.0, 1.0)] {
            there.copy_from_slice(state);
            add(there, part * h, rate);
            self.rates_here(time_s + part * h, there, rate)?;
            add(mean, weight / 6.0, rate);
        }
        add(state, h, mean);
        Some(())
    }
}

/// Rates, compiled for what the processor has.
struct Rates<'k, 'a, D> {
    driven: &'k mut Driven<'a, D>,
    time_s: f64,
    state: &'k [f64],
    out: &'k mut [f64],
}

impl<D: Drive> froude_lanes::Kernel for Rates<'_, '_, D> {
    type Output = Option<()>;

    #[inline(always)]
    fn run<V: froude_lanes::Vectors>(self, _: V) -> Option<()> {
        self.driven.rates_here(self.time_s, self.state, self.out)
    }
}

/// The rest of a step, compiled for what the processor has.
struct Rest<'k, 'a, D> {
    driven: &'k mut Driven<'a, D>,
    time_s: f64,
    h: f64,
    state: &'k mut [f64],
    stages: &'k mut [Vec<f64>; 3],
}

impl<D: Drive> froude_lanes::Kernel for Rest<'_, '_, D> {
    type Output = Option<()>;

    #[inline(always)]
    fn run<V: froude_lanes::Vectors>(self, _: V) -> Option<()> {
        self.driven.rest_here(self.time_s, self.h, self.state, self.stages)
    }
}

/// to += by · of.
#[inline(always)]
fn add(to: &mut [f64], by: f64, of: &[f64]) {
    for (to, of) in to.iter_mut().zip(of) {
        *to += by * of;
    }
}
