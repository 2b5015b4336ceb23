//! A swimmer under way: one step after the other, and what is seen at the beginning of each, whether its joints follow exactly or are driven.
//!
//! **Units.** SI.

use crate::drive::Servo;
use crate::driven::{Driven, Energy};
use crate::gait::Shape;
use crate::means::Means;
use crate::path::{State, Swimmer};
use crate::planar::Motion;

/// What is seen at a time.
#[derive(Debug, Clone, Copy)]
pub struct Instant<'a> {
    /// s.
    pub time_s: f64,
    /// Motions of the links.
    pub motions: &'a [Motion],
    /// Angles of the joints with two derivatives.
    pub shape: &'a Shape,
    /// Torques of the motors, N m.
    pub torque_n_m: &'a [f64],
    /// Powers: Σ τφ̇, Σ max(τφ̇, 0), of the drag, of friction in the joints, W.
    pub power_w: [f64; 4],
}

/// A swimmer under way.
pub trait Moving {
    /// Evaluates where it is.
    fn first(&mut self, time_s: f64) -> Option<Instant<'_>>;
    /// The rest of a step, after `first`.
    fn rest(&mut self, time_s: f64, h: f64) -> Option<()>;
    /// Place, motion and energies.
    fn state(&self) -> State;
    /// What friction of the joints took, J.
    fn friction_j(&self) -> f64;
    /// Centre of mass at the last `first`, m.
    fn centre_m(&self) -> [f64; 2];
    /// Kinetic energy of body and water at the last `first`, J.
    fn energy_j(&self) -> f64;
}

/// What so many steps come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage {
    /// Where it ended; energies from the beginning.
    pub end: State,
    /// What friction of the joints took, J.
    pub friction_j: f64,
    /// Way of the centre of mass, m.
    pub way_m: [f64; 2],
    /// Kinetic energy at the end less that at the beginning, J.
    pub gained_j: f64,
}

impl Passage {
    /// Its means over its time, s, where its integrals began at zero.
    pub(crate) fn means(&self, time_s: f64, turn: f64) -> Means {
        let end = &self.end;
        let energies_j = [end.work_j, end.positive_j, end.absolute_j, end.loss_j, self.friction_j];
        Means::of(time_s, self.way_m, turn, energies_j)
    }
}

/// Goes so many steps from time zero.
pub fn go(moving: &mut dyn Moving, h: f64, steps: usize, see: &mut dyn FnMut(&Instant<'_>)) -> Option<Passage> {
    moving.first(0.0)?;
    let (from, energy) = (moving.centre_m(), moving.energy_j());
    for i in 0..steps {
        let time_s = i as f64 * h;
        see(&moving.first(time_s)?);
        moving.rest(time_s, h)?;
    }
    moving.first(steps as f64 * h)?;
    let to = moving.centre_m();
    Some(Passage {
        end: moving.state(),
        friction_j: moving.friction_j(),
        way_m: [to[0] - from[0], to[1] - from[1]],
        gained_j: moving.energy_j() - energy,
    })
}

/// With joints that follow exactly.
#[derive(Debug, Clone)]
pub struct Exact<'a> {
    swimmer: Swimmer<'a>,
    state: State,
    rate: State,
}

impl<'a> Exact<'a> {
    /// From a state.
    #[must_use]
    pub fn new(swimmer: Swimmer<'a>, state: State) -> Self {
        Self { swimmer, state, rate: State::default() }
    }
}

impl Moving for Exact<'_> {
    fn first(&mut self, time_s: f64) -> Option<Instant<'_>> {
        self.rate = self.swimmer.rates(time_s, &self.state)?;
        let rate = &self.rate;
        Some(Instant {
            time_s,
            motions: self.swimmer.work.motions(),
            shape: &self.swimmer.shape,
            torque_n_m: &self.swimmer.work.answer,
            power_w: [rate.work_j, rate.positive_j, rate.loss_j, 0.0],
        })
    }

    fn rest(&mut self, time_s: f64, h: f64) -> Option<()> {
        self.state = self.swimmer.step_from(&self.rate, time_s, h, &self.state)?;
        Some(())
    }

    fn state(&self) -> State {
        self.state
    }

    fn friction_j(&self) -> f64 {
        0.0
    }

    fn centre_m(&self) -> [f64; 2] {
        self.swimmer.centre_m(&self.state)
    }

    fn energy_j(&self) -> f64 {
        self.swimmer.energy_j()
    }
}

/// With servos at its joints.
#[derive(Debug, Clone)]
pub struct Servoed<'a> {
    driven: Driven<'a, Servo<'a>>,
    state: Vec<f64>,
    shape: Shape,
}

impl<'a> Servoed<'a> {
    /// From a state ([`crate::driven`]).
    #[must_use]
    pub fn new(driven: Driven<'a, Servo<'a>>, state: Vec<f64>) -> Self {
        let shape = Shape::straight(driven.chain.joints());
        Self { driven, state, shape }
    }
}

impl Moving for Servoed<'_> {
    fn first(&mut self, time_s: f64) -> Option<Instant<'_>> {
        self.driven.first_rate(time_s, &self.state)?;
        let (j, shape) = (self.driven.chain.joints(), &mut self.shape);
        shape.angle.copy_from_slice(&self.state[3..3 + j]);
        shape.rate.copy_from_slice(&self.state[6 + j..6 + 2 * j]);
        shape.acceleration.copy_from_slice(&self.driven.work.answer);
        let power = |energy| self.driven.first_rate_of(energy);
        Some(Instant {
            time_s,
            motions: self.driven.work.motions(),
            shape: &self.shape,
            torque_n_m: &self.driven.torque,
            power_w: [Energy::Work, Energy::Positive, Energy::Loss, Energy::Friction].map(power),
        })
    }

    fn rest(&mut self, time_s: f64, h: f64) -> Option<()> {
        self.driven.rest_of_step(time_s, h, &mut self.state)
    }

    fn state(&self) -> State {
        let (s, j) = (&self.state, self.driven.chain.joints());
        let energy = |energy| s[self.driven.at(energy)];
        State {
            place_m: [s[0], s[1]],
            heading: s[2],
            head: [s[3 + j], s[4 + j], s[5 + j]],
            work_j: energy(Energy::Work),
            positive_j: energy(Energy::Positive),
            absolute_j: energy(Energy::Absolute),
            loss_j: energy(Energy::Loss),
        }
    }

    fn friction_j(&self) -> f64 {
        self.state[self.driven.at(Energy::Friction)]
    }

    fn centre_m(&self) -> [f64; 2] {
        self.driven.chain.centre_m([self.state[0], self.state[1]], self.state[2], &self.shape.angle)
    }

    fn energy_j(&self) -> f64 {
        self.driven.chain.energy_j(self.driven.work.motions())
    }
}
