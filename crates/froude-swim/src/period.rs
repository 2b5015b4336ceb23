//! The motion that repeats itself: a fixed point of the map over one period.
//!
//! Nothing in the water depends on where the swimmer is and where it heads, so that the map of the head's own motion (ω, u, v) over a period has three
//! numbers. Newton's method on it finds the one that repeats; the eigenvalues of its derivative are the Floquet multipliers, and one beyond 1 is a gait that leaves its own path. Speed is
//! that of the centre of mass through the water from the beginning of a period, t = 0, to its end (chord), divided by the period: of a gait that turns it depends on where the
//! period begins, and it is nothing after a full turn.
//!
//! **Units.** SI. **Source.** Nayfeh & Balachandran (1995), *Applied Nonlinear Dynamics*, 3.2 and 5.3.

use faer::Mat;
use faer::prelude::*;

use crate::path::{State, Swimmer};
use crate::planar::Motion;

/// Periods that a swimmer is let go before Newton's method.
const TRANSIENT: usize = 3;
/// Steps of Newton's method.
const MOST_STEPS: usize = 30;
/// A motion repeats itself when each part is met to this, of the speed of a link length in a period.
const REPEATS: f64 = 1e-9;
/// Step of the differences of the map, of the same speed.
const STEP: f64 = 1e-5;

/// What a period of a gait does.
#[derive(Debug, Clone, PartialEq)]
pub struct Periodic {
    /// The motion of the head that repeats.
    pub head: Motion,
    /// Speed through the water, m/s.
    pub speed_m_s: f64,
    /// Way of the centre of mass in a period, m, in axes in which the head begins along x.
    pub way_m: [f64; 2],
    /// Turn in a period, rad.
    pub turn: f64,
    /// Mean of Σ τφ̇, W.
    pub net_w: f64,
    /// Mean of Σ max(τφ̇, 0), W.
    pub positive_w: f64,
    /// Mean of Σ |τφ̇|, W.
    pub absolute_w: f64,
    /// Mean of what drag takes, W.
    pub loss_w: f64,
    /// Largest torque, N m.
    pub torque_n_m: f64,
    /// Sizes of the Floquet multipliers, the largest first.
    pub multipliers: [f64; 3],
    /// By how much the motion does not repeat, relative.
    pub residual: f64,
}

impl Swimmer<'_> {
    /// The periodic motion in `steps` steps a period; `None` where there is none within reach or an inertia is not positive.
    pub fn periodic(&mut self, steps: usize) -> Option<Periodic> {
        let steps = steps.max(1);
        let length: f64 = self.chain.links.iter().map(|link| 2.0 * link.half_length_m).sum::<f64>();
        let speed = length / self.chain.links.len() as f64 / self.gait.period_s();
        let scale = [speed / length, speed, speed];
        let mut head = [0.0; 3];
        for _ in 0..TRANSIENT {
            head = self.over(head, steps)?.end.head;
        }
        for _ in 0..MOST_STEPS {
            let here = self.over(head, steps)?;
            let away = [0, 1, 2].map(|k| here.end.head[k] - head[k]);
            if away.iter().any(|a| !a.is_finite()) {
                return None;
            }
            let residual = (0..3).map(|k| (away[k] / scale[k]).abs()).fold(0.0, f64::max);
            let derivative = self.derivative(head, &here.end.head, scale, steps)?;
            if residual < REPEATS {
                return Some(self.told(head, &here, &derivative, residual));
            }
            let left = Mat::from_fn(3, 3, |i, j| f64::from(u8::from(i == j)) - derivative[(i, j)]);
            let step = left.partial_piv_lu().solve(Mat::from_fn(3, 1, |i, _| away[i]));
            for k in 0..3 {
                head[k] += step[(k, 0)];
            }
        }
        None
    }

    fn told(&self, head: Motion, here: &Over, derivative: &Mat<f64>, residual: f64) -> Periodic {
        let period = self.gait.period_s();
        let mut multipliers = [f64::NAN; 3];
        if let Ok(found) = derivative.eigenvalues() {
            for (size, value) in multipliers.iter_mut().zip(found) {
                *size = value.norm();
            }
        }
        multipliers.sort_by(|a, b| b.total_cmp(a));
        Periodic {
            head,
            way_m: here.way_m,
            speed_m_s: here.way_m[0].hypot(here.way_m[1]) / period,
            turn: here.end.heading,
            net_w: here.end.work_j / period,
            positive_w: here.end.positive_j / period,
            absolute_w: here.end.absolute_j / period,
            loss_w: here.end.loss_j / period,
            torque_n_m: here.torque_n_m,
            multipliers,
            residual,
        }
    }

    /// One period from a motion of the head, heading along x.
    fn over(&mut self, head: Motion, steps: usize) -> Option<Over> {
        let h = self.gait.period_s() / steps as f64;
        let current = std::mem::take(&mut self.current_m_s);
        let mut state = State { head, ..State::default() };
        self.rates(0.0, &state)?;
        let from = self.centre_m(&state);
        let mut torque_n_m = 0.0_f64;
        for i in 0..steps {
            state = self.step(i as f64 * h, h, &state)?;
            torque_n_m = torque_n_m.max(self.largest_torque_n_m());
        }
        self.rates(0.0, &state)?;
        let to = self.centre_m(&state);
        self.current_m_s = current;
        Some(Over { end: state, way_m: [to[0] - from[0], to[1] - from[1]], torque_n_m })
    }

    /// ∂ of the map by the head's motion, by differences to one side.
    fn derivative(&mut self, head: Motion, end: &Motion, scale: Motion, steps: usize) -> Option<Mat<f64>> {
        let mut out = Mat::zeros(3, 3);
        for j in 0..3 {
            let h = STEP * scale[j];
            let mut moved = head;
            moved[j] += h;
            let there = self.over(moved, steps)?.end.head;
            for i in 0..3 {
                out[(i, j)] = (there[i] - end[i]) / h;
            }
        }
        Some(out)
    }
}

/// A period.
struct Over {
    end: State,
    way_m: [f64; 2],
    torque_n_m: f64,
}
