//! A swimmer under way: one step after the other, and what is seen at the beginning of each, whether its joints follow exactly or are driven.
//!
//! **Units.** SI.

use std::f64::consts::TAU;

use crate::chain::Chain;
use crate::drive::Servo;
use crate::driven::Driven;
use crate::dynamics::{Dynamics, StateOf};
use crate::gait::Shape;
use crate::means::Means;
use crate::path::Swimmer;
use crate::state::{Energy, Numbers, State};

/// What is seen at a time.
#[derive(Debug, Clone, Copy)]
pub struct Instant<'a, M> {
    /// s.
    pub time_s: f64,
    /// Motions of the links.
    pub motions: &'a [M],
    /// Angles of the joints with two derivatives.
    pub shape: &'a Shape,
    /// Torques of the motors, N m.
    pub torque_n_m: &'a [f64],
    /// Powers: Σ τφ̇, Σ max(τφ̇, 0), of the drag, of friction in the joints, W.
    pub power_w: [f64; 4],
}

/// What sees the instants of a swimmer.
pub type Seeing<'s, C> = dyn FnMut(&Instant<'_, <C as Dynamics>::Motion>) + 's;

/// A swimmer under way.
pub trait Moving<C: Dynamics> {
    /// Evaluates where it is.
    fn first(&mut self, time_s: f64) -> Option<Instant<'_, C::Motion>>;
    /// The rest of a step, after `first`.
    fn rest(&mut self, time_s: f64, h: f64) -> Option<()>;
    /// Its head, with the energies.
    fn state(&self) -> StateOf<C>;
    /// Centre of mass at the last `first`, m.
    fn centre_m(&self) -> [f64; 3];
    /// Kinetic and potential energy at the last `first`, J.
    fn energy_j(&self) -> [f64; 2];
    /// Begins with numbers that may repeat after a period, at the origin with no heading: angles of driven joints, motion of the head, roll and pitch where there are any, rates of driven joints.
    fn begin(&mut self, numbers: &[f64]);
    /// These numbers where it is.
    fn numbers(&self) -> Vec<f64>;
}

/// What so many steps come to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Passage {
    /// Integrals of the powers at its end, J.
    pub energy_j: [f64; crate::state::ENERGIES],
    /// Way of the centre of mass, m.
    pub way_m: [f64; 3],
    /// By how much the head turns, rad.
    pub turn: f64,
    /// Least and largest roll and pitch of the head, rad; of a head that is turned over they lie about ±π.
    pub tilt: [[f64; 2]; 2],
    /// Kinetic and potential energy at the end less that at the beginning, J.
    pub gained_j: [f64; 2],
}

impl Passage {
    /// Its means over its time, s, where its integrals began at zero.
    pub(crate) fn means(&self, time_s: f64) -> Means {
        let [x, y, _] = self.way_m;
        let power = |energy: Energy| self.energy_j[energy as usize] / time_s;
        Means {
            speed_m_s: x.hypot(y) / time_s,
            turn: self.turn,
            net_w: power(Energy::Work),
            positive_w: power(Energy::Positive),
            absolute_w: power(Energy::Absolute),
            loss_w: power(Energy::Loss),
            friction_w: power(Energy::Friction),
            lifting_w: self.gained_j[1] / time_s,
        }
    }
}

/// Goes so many steps from time zero.
pub fn go<C: Dynamics>(moving: &mut dyn Moving<C>, h: f64, steps: usize, see: &mut Seeing<'_, C>) -> Option<Passage> {
    moving.first(0.0)?;
    let (from, energy) = (moving.centre_m(), moving.energy_j());
    let begin = C::angles(&moving.state().pose);
    let (mut lies, mut tilt) = (begin, [[f64::INFINITY, f64::NEG_INFINITY]; 2]);
    for i in 0..steps {
        for (tilt, angle) in tilt.iter_mut().zip(lies) {
            *tilt = [tilt[0].min(angle), tilt[1].max(angle)];
        }
        let time_s = i as f64 * h;
        see(&moving.first(time_s)?);
        moving.rest(time_s, h)?;
        let now = C::angles(&moving.state().pose);
        // Angles are known up to whole turns, and none is made in a step.
        lies = [0, 1, 2].map(|k| now[k] + TAU * ((lies[k] - now[k]) / TAU).round());
    }
    moving.first(steps as f64 * h)?;
    let (to, later) = (moving.centre_m(), moving.energy_j());
    Some(Passage {
        energy_j: moving.state().energy_j,
        way_m: [0, 1, 2].map(|k| to[k] - from[k]),
        turn: lies[2] - begin[2],
        tilt,
        gained_j: [0, 1].map(|k| later[k] - energy[k]),
    })
}

/// The head of numbers that repeat, at the origin with no heading.
fn head<C: Dynamics>(numbers: &[f64]) -> StateOf<C> {
    let motion = C::Motion::first_of(numbers);
    let (roll, pitch) = if C::TILTS { (numbers[C::Motion::LEN], numbers[C::Motion::LEN + 1]) } else { (0.0, 0.0) };
    State::new(C::pose([0.0; 3], [roll, pitch, 0.0]), motion)
}

/// What repeats of a head.
pub(crate) fn of_head<C: Dynamics>(state: &StateOf<C>) -> Vec<f64> {
    let [roll, pitch, _] = C::angles(&state.pose);
    let tilt: &[f64] = if C::TILTS { &[roll, pitch] } else { &[] };
    [state.head.as_ref(), tilt].concat()
}

/// With joints that follow exactly.
#[derive(Debug, Clone)]
pub struct Exact<'a, C: Dynamics = Chain> {
    swimmer: Swimmer<'a, C>,
    state: StateOf<C>,
    rate: StateOf<C>,
}

impl<'a, C: Dynamics> Exact<'a, C> {
    /// From a state.
    #[must_use]
    pub fn new(swimmer: Swimmer<'a, C>, state: StateOf<C>) -> Self {
        Self { swimmer, state, rate: C::REST }
    }
}

impl<C: Dynamics> Moving<C> for Exact<'_, C> {
    fn first(&mut self, time_s: f64) -> Option<Instant<'_, C::Motion>> {
        self.rate = self.swimmer.rates(time_s, &self.state)?;
        let found = C::evaluated(&self.swimmer.work);
        Some(Instant {
            time_s,
            motions: found.motions,
            shape: &self.swimmer.shape,
            torque_n_m: found.answer,
            power_w: POWERS.map(|power| self.rate.energy(power)),
        })
    }

    fn rest(&mut self, time_s: f64, h: f64) -> Option<()> {
        self.state = self.swimmer.step_from(&self.rate, time_s, h, &self.state)?;
        Some(())
    }

    fn state(&self) -> StateOf<C> {
        self.state
    }

    fn centre_m(&self) -> [f64; 3] {
        self.swimmer.centre_m(&self.state)
    }

    fn energy_j(&self) -> [f64; 2] {
        self.swimmer.energy_j(&self.state)
    }

    fn begin(&mut self, numbers: &[f64]) {
        self.state = head::<C>(numbers);
    }

    fn numbers(&self) -> Vec<f64> {
        of_head::<C>(&self.state)
    }
}

/// Powers in the order in which they are seen.
const POWERS: [Energy; 4] = [Energy::Work, Energy::Positive, Energy::Loss, Energy::Friction];

/// With servos at its joints.
#[derive(Debug, Clone)]
pub struct Servoed<'a, C: Dynamics = Chain> {
    driven: Driven<'a, Servo<'a>, C>,
    state: Vec<f64>,
    shape: Shape,
}

impl<'a, C: Dynamics> Servoed<'a, C> {
    /// From a state ([`crate::driven`]).
    #[must_use]
    pub fn new(driven: Driven<'a, Servo<'a>, C>, state: Vec<f64>) -> Self {
        let shape = Shape::straight(driven.chain.joints());
        Self { driven, state, shape }
    }

    /// Angles and rates of the joints.
    fn joints(&self) -> [&[f64]; 2] {
        let (j, at) = (self.driven.chain.joints(), [C::Pose::LEN, C::Pose::LEN + C::Motion::LEN]);
        [&self.state[at[0]..at[0] + j], &self.state[at[1] + j..at[1] + 2 * j]]
    }
}

impl<C: Dynamics> Moving<C> for Servoed<'_, C> {
    fn first(&mut self, time_s: f64) -> Option<Instant<'_, C::Motion>> {
        self.driven.first_rate(time_s, &self.state)?;
        let found = C::evaluated(&self.driven.work);
        let mut shape = std::mem::take(&mut self.shape);
        let [angle, rate] = self.joints();
        shape.angle.copy_from_slice(angle);
        shape.rate.copy_from_slice(rate);
        shape.acceleration.copy_from_slice(found.answer);
        self.shape = shape;
        Some(Instant {
            time_s,
            motions: C::evaluated(&self.driven.work).motions,
            shape: &self.shape,
            torque_n_m: &self.driven.torque,
            power_w: POWERS.map(|power| self.driven.first_rate_of(power)),
        })
    }

    fn rest(&mut self, time_s: f64, h: f64) -> Option<()> {
        self.driven.rest_of_step(time_s, h, &mut self.state)
    }

    fn state(&self) -> StateOf<C> {
        self.driven.head_of(&self.state)
    }

    fn centre_m(&self) -> [f64; 3] {
        self.driven.chain.centre_m(&self.state().pose, self.joints()[0])
    }

    fn energy_j(&self) -> [f64; 2] {
        let motions = C::evaluated(&self.driven.work).motions;
        self.driven.chain.energy_j(&self.state().pose, self.joints()[0], motions)
    }

    fn begin(&mut self, numbers: &[f64]) {
        let j = self.driven.chain.joints();
        let (angle, rest) = numbers.split_at(j);
        let (of_head, rate) = rest.split_at(rest.len() - j);
        self.state = self.driven.state(&head::<C>(of_head), angle, rate);
    }

    fn numbers(&self) -> Vec<f64> {
        let [angle, rate] = self.joints();
        [angle, &of_head::<C>(&self.state()), rate].concat()
    }
}
