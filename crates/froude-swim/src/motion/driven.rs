//! A swimmer whose joints are driven by torques, over time.
//!
//! **State**, one number after the other: pose of the head, φ (n − 1), motion of the head through the water in its own axes, φ̇ (n − 1), and the integrals of the powers ([`Energy`]).
//!
//! **Units.** SI.

use crate::chain::Chain;
use crate::drive::Drive;
use crate::dynamics::{Dynamics, StateOf};
use crate::engine::{Given, Joints};
use crate::state::{ENERGIES, Energy, Numbers, State, add};

/// A chain with its drive.
#[derive(Debug, Clone)]
pub struct Driven<'a, D, C: Dynamics = Chain> {
    /// Its links.
    pub chain: &'a C,
    /// What drives its joints.
    pub drive: D,
    /// Speed of the water over the ground, m/s.
    pub current_m_s: [f64; 3],
    /// Memory of the engine.
    pub work: C::Work,
    /// Torques of the motors at the last evaluation, N m.
    pub torque: Vec<f64>,
    /// The same less friction.
    net: Vec<f64>,
    stages: [Vec<f64>; 3],
}

impl<'a, D: Drive, C: Dynamics> Driven<'a, D, C> {
    /// In still water.
    #[must_use]
    pub fn new(chain: &'a C, drive: D) -> Self {
        let (work, torque) = (chain.work(), vec![0.0; chain.joints()]);
        let stages = [(); 3].map(|()| vec![0.0; Self::RATES + 2 * chain.joints() + ENERGIES]);
        Self { chain, drive, current_m_s: [0.0; 3], work, net: torque.clone(), torque, stages }
    }

    /// Where the angles stand in a state.
    pub const ANGLES: usize = C::Pose::LEN;
    /// Where the motion of the head stands, less the number of joints …
    pub const HEAD: usize = Self::ANGLES;
    /// … and the rates of the joints.
    pub const RATES: usize = Self::HEAD + C::Motion::LEN;

    /// Length of a state.
    #[must_use]
    pub fn size(&self) -> usize {
        self.stages[0].len()
    }

    /// Where an integral stands in a state.
    #[must_use]
    pub fn at(&self, energy: Energy) -> usize {
        Self::RATES + 2 * self.chain.joints() + energy as usize
    }

    /// A state of a head with nothing given or taken yet, and φ and φ̇ of the joints.
    #[must_use]
    pub fn state(&self, head: &StateOf<C>, angle: &[f64], rate: &[f64]) -> Vec<f64> {
        [head.pose.as_ref(), angle, head.head.as_ref(), rate, &[0.0; ENERGIES]].concat()
    }

    /// The head of a state.
    #[must_use]
    #[inline(always)]
    pub fn head_of(&self, state: &[f64]) -> StateOf<C> {
        let j = self.chain.joints();
        State {
            pose: C::Pose::first_of(state),
            head: C::Motion::first_of(&state[Self::HEAD + j..]),
            energy_j: <[f64; ENERGIES]>::first_of(&state[Self::RATES + 2 * j..]),
        }
    }

    /// Rates of a state; `None` where an inertia is not positive.
    pub fn rates(&mut self, time_s: f64, state: &[f64], rates: &mut [f64]) -> Option<()> {
        froude_lanes::run(Rates { driven: self, time_s, state, out: rates })
    }

    #[inline(always)]
    fn rates_here(&mut self, time_s: f64, state: &[f64], rates: &mut [f64]) -> Option<()> {
        let (j, State { pose, head, .. }) = (self.chain.joints(), self.head_of(state));
        let (head_at, rates_at) = (Self::HEAD + j, Self::RATES + j);
        let (angle, rate) = (&state[Self::ANGLES..head_at], &state[rates_at..rates_at + j]);
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
        let joints = Joints { angle, rate };
        let turned = self.chain.recursion(&mut self.work, (&pose, head), joints, Given::Torque(&self.net))?;
        let found = C::evaluated(&self.work);
        energy[Energy::Loss as usize] = found.loss_w;
        rates[..Self::ANGLES].copy_from_slice(C::pose_rate(&pose, head, self.current_m_s).as_ref());
        rates[Self::ANGLES..head_at].copy_from_slice(rate);
        rates[head_at..rates_at].copy_from_slice(turned.as_ref());
        rates[rates_at..rates_at + j].copy_from_slice(found.answer);
        rates[rates_at + j..].copy_from_slice(&energy);
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
        C::settle(&mut state[..Self::ANGLES]);
        Some(())
    }
}

/// Rates, compiled for what the processor has.
struct Rates<'k, 'a, D, C: Dynamics> {
    driven: &'k mut Driven<'a, D, C>,
    time_s: f64,
    state: &'k [f64],
    out: &'k mut [f64],
}

impl<D: Drive, C: Dynamics> froude_lanes::Kernel for Rates<'_, '_, D, C> {
    type Output = Option<()>;

    #[inline(always)]
    fn run<V: froude_lanes::Vectors>(self, _: V) -> Option<()> {
        self.driven.rates_here(self.time_s, self.state, self.out)
    }
}

/// The rest of a step, compiled for what the processor has.
struct Rest<'k, 'a, D, C: Dynamics> {
    driven: &'k mut Driven<'a, D, C>,
    time_s: f64,
    h: f64,
    state: &'k mut [f64],
    stages: &'k mut [Vec<f64>; 3],
}

impl<D: Drive, C: Dynamics> froude_lanes::Kernel for Rest<'_, '_, D, C> {
    type Output = Option<()>;

    #[inline(always)]
    fn run<V: froude_lanes::Vectors>(self, _: V) -> Option<()> {
        self.driven.rest_here(self.time_s, self.h, self.state, self.stages)
    }
}
