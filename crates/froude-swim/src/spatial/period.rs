//! The motion that repeats itself in three dimensions.
//!
//! Nothing in the water depends on where the swimmer is and on its heading; on roll and pitch it does by weight and buoyancy. The map over a period has eight numbers, the head's motion, its roll and its
//! pitch, and the motion that repeats is a fixed point of it, by Newton's method with halved steps. Its depth may change from period to period: a swimmer that is too heavy sinks at a speed that repeats.
//!
//! Without a righting moment roll and pitch stay where they are, and their part of the map's derivative is one: the smallest step that does is taken then (by singular values), and a multiplier of 1 says so.
//!
//! **Units.** SI. **Source.** Nayfeh & Balachandran (1995), *Applied Nonlinear Dynamics*, ch. 3 (stability of periodic solutions) and 6 (shooting).

use faer::Mat;

use super::attitude::{angles, of_angles};
use super::path::{State, Swimmer};
use crate::means::Means;
use crate::settled::settled;

/// Numbers of the map.
pub const NUMBERS: usize = 8;
/// Periods that a swimmer is let go before Newton's method.
const TRANSIENT: usize = 5;
/// How many steps make one until the motion is nearly found.
const COARSE: usize = 4;
/// Steps of Newton's method …
const MOST_STEPS: usize = 40;
/// … each halved at most so often.
const MOST_HALVES: usize = 6;
/// A motion repeats itself when each part is met to this, of the speed of a link length in a period, or rad.
const REPEATS: f64 = 1e-9;
/// Step of the differences of the map.
const STEP: f64 = 1e-5;
/// Multipliers within this of one are one: what no weight brings back neither grows nor fades.
pub const ONE: f64 = 1e-4;
/// Periods in which a swimmer that leaves an unstable motion must come near another: ten seconds of computing.
const MOST_PERIODS: usize = 1000;
/// Singular values below this part of the largest are none.
const SINGULAR: f64 = 1e-7;

/// What a period of a gait does.
#[derive(Debug, Clone, PartialEq)]
pub struct Periodic {
    /// The state at the beginning of a period that repeats, at the origin with no heading.
    pub start: State,
    /// Its means.
    pub means: Means,
    /// Way of the centre of mass in a period, m, in level axes in which the head begins along x; z is how much it sinks.
    pub way_m: [f64; 3],
    /// Least and largest roll of the head, rad; of a head that is turned over they lie about ±π.
    pub roll: [f64; 2],
    /// Least and largest pitch of the head, rad.
    pub pitch: [f64; 2],
    /// Mean of what weight and buoyancy take by the change of depth, W.
    pub lifting_w: f64,
    /// Sizes of the Floquet multipliers, the largest first.
    pub multipliers: [f64; NUMBERS],
    /// By how much the motion does not repeat, relative.
    pub residual: f64,
}

/// A fixed point of the map.
struct Fixed {
    at: [f64; NUMBERS],
    derivative: Mat<f64>,
    residual: f64,
}

impl Swimmer<'_> {
    /// The periodic motion in `steps` steps a period; `None` where there is none within reach or an inertia is not positive.
    pub fn periodic(&mut self, steps: usize) -> Option<Periodic> {
        let steps = steps.max(1).next_multiple_of(COARSE);
        let scale = self.scale();
        let mut at = [0.0; NUMBERS];
        for _ in 0..TRANSIENT {
            at = self.map(&at, steps / COARSE)?;
        }
        // Steps four times as long lead to where the exact ones begin.
        let near = self.newton(at, &scale, steps / COARSE, 1e3 * REPEATS).map_or(at, |found| found.at);
        let found = self.newton(near, &scale, steps, REPEATS)?;
        self.told(&found, steps)
    }

    /// The motion that an unstable one settles into; `None` where it settles into none that repeats each period.
    pub fn settled(&mut self, unstable: &Periodic, steps: usize) -> Option<Periodic> {
        let steps = steps.max(1).next_multiple_of(COARSE);
        let scale = self.scale();
        let [roll, pitch, _] = angles(unstable.start.attitude);
        let [p, q, r, u, v, w] = unstable.start.head;
        let near = settled(&[p, q, r, u, v, w, roll, pitch], &scale, MOST_PERIODS, |z| {
            let at: [f64; NUMBERS] = z.try_into().ok()?;
            let mut end = self.map(&at, steps / COARSE)?;
            // Roll is known up to a whole turn.
            let rolled: f64 = end[6] - at[6];
            end[6] = at[6] + rolled.sin().atan2(rolled.cos());
            Some(end.to_vec())
        })?;
        let found = self.newton(near.try_into().ok()?, &scale, steps, REPEATS)?;
        self.told(&found, steps).filter(|found| found.multipliers[0] <= 1.0 + ONE)
    }

    /// Sizes of the numbers of the map.
    fn scale(&self) -> [f64; NUMBERS] {
        let length: f64 = self.chain.links.iter().map(|link| 2.0 * link.half_length_m).sum();
        let speed = length / self.chain.links.len() as f64 / self.gait.period_s();
        let turn = speed / length;
        [turn, turn, turn, speed, speed, speed, 1.0, 1.0]
    }

    /// The numbers at the end of a period from those at its beginning.
    fn map(&mut self, at: &[f64; NUMBERS], steps: usize) -> Option<[f64; NUMBERS]> {
        let h = self.gait.period_s() / steps as f64;
        let mut state = state(at);
        for i in 0..steps {
            state = self.step(i as f64 * h, h, &state)?;
        }
        let [roll, pitch, _] = angles(state.attitude);
        let [p, q, r, u, v, w] = state.head;
        let end = [p, q, r, u, v, w, roll, pitch];
        end.iter().all(|x| x.is_finite()).then_some(end)
    }

    fn newton(&mut self, mut at: [f64; NUMBERS], scale: &[f64; NUMBERS], steps: usize, within: f64) -> Option<Fixed> {
        let away = |at: &[f64; NUMBERS], end: &[f64; NUMBERS]| -> [f64; NUMBERS] {
            std::array::from_fn(|k| {
                let way = end[k] - at[k];
                // Roll is known up to a whole turn.
                let way = if k == 6 { way.sin().atan2(way.cos()) } else { way };
                way / scale[k]
            })
        };
        let size = |away: &[f64; NUMBERS]| away.iter().fold(0.0_f64, |m, a| m.max(a.abs()));
        let mut end = self.map(&at, steps)?;
        for _ in 0..MOST_STEPS {
            let off = away(&at, &end);
            let mut derivative = Mat::<f64>::zeros(NUMBERS, NUMBERS);
            for j in 0..NUMBERS {
                let mut moved = at;
                moved[j] += STEP * scale[j];
                let moved_end = self.map(&moved, steps)?;
                let change = away(&end, &moved_end);
                for i in 0..NUMBERS {
                    derivative[(i, j)] = change[i] / STEP;
                }
            }
            if size(&off) < within {
                return Some(Fixed { at, derivative, residual: size(&off) });
            }
            let step = smallest(&derivative, &off)?;
            let mut part = 1.0;
            let better = (0..MOST_HALVES).find_map(|_| {
                let next: [f64; NUMBERS] = std::array::from_fn(|k| at[k] + part * step[k] * scale[k]);
                part *= 0.5;
                let next_end = self.map(&next, steps)?;
                (size(&away(&next, &next_end)) < size(&off)).then_some((next, next_end))
            });
            (at, end) = better?;
        }
        None
    }

    fn told(&mut self, found: &Fixed, steps: usize) -> Option<Periodic> {
        let period = self.gait.period_s();
        let h = period / steps as f64;
        let current = std::mem::take(&mut self.current_m_s);
        let start = state(&found.at);
        let mut here = start;
        self.rates(0.0, &here)?;
        let (from, [_, high]) = (self.centre_m(&here), self.energy_j(&here));
        let (mut turn, mut heading) = (0.0, 0.0);
        let (mut roll, mut pitch) = ([f64::INFINITY, f64::NEG_INFINITY], [f64::INFINITY, f64::NEG_INFINITY]);
        let [mut rolled, ..] = angles(here.attitude);
        for i in 0..steps {
            let [x, y, _] = angles(here.attitude);
            rolled += (x - rolled).sin().atan2((x - rolled).cos());
            roll = [roll[0].min(rolled), roll[1].max(rolled)];
            pitch = [pitch[0].min(y), pitch[1].max(y)];
            here = self.step(i as f64 * h, h, &here)?;
            let [_, _, now] = angles(here.attitude);
            let step: f64 = now - heading;
            turn += step.sin().atan2(step.cos());
            heading = now;
        }
        self.rates(period, &here)?;
        let (to, [_, low]) = (self.centre_m(&here), self.energy_j(&here));
        self.current_m_s = current;
        let way_m: [f64; 3] = std::array::from_fn(|k| to[k] - from[k]);
        let mut multipliers = [f64::NAN; NUMBERS];
        if let Ok(values) = found.derivative.eigenvalues() {
            for (size, value) in multipliers.iter_mut().zip(values) {
                *size = value.norm();
            }
        }
        multipliers.sort_by(|a, b| b.total_cmp(a));
        Some(Periodic {
            start,
            means: Means::of(
                period,
                [way_m[0], way_m[1]],
                turn,
                [here.work_j, here.positive_j, here.absolute_j, here.loss_j, 0.0],
            ),
            way_m,
            roll,
            pitch,
            lifting_w: (low - high) / period,
            multipliers,
            residual: found.residual,
        })
    }
}

/// The state with no heading at the origin.
fn state(at: &[f64; NUMBERS]) -> State {
    let [p, q, r, u, v, w, roll, pitch] = *at;
    State { attitude: of_angles([roll, pitch, 0.0]), head: [p, q, r, u, v, w], ..State::default() }
}

/// The smallest step s with (1 − D) s = off, as near as it goes.
fn smallest(derivative: &Mat<f64>, off: &[f64; NUMBERS]) -> Option<[f64; NUMBERS]> {
    let left = Mat::from_fn(NUMBERS, NUMBERS, |i, j| f64::from(u8::from(i == j)) - derivative[(i, j)]);
    let svd = left.svd().ok()?;
    let values: Vec<f64> = svd.S().column_vector().iter().copied().collect();
    let largest = values.iter().fold(0.0_f64, |m, s| m.max(*s));
    let mut out = [0.0; NUMBERS];
    for (k, value) in values.iter().enumerate().filter(|(_, value)| **value > SINGULAR * largest) {
        let along: f64 = (0..NUMBERS).map(|i| svd.U()[(i, k)] * off[i]).sum::<f64>() / value;
        for (j, out) in out.iter_mut().enumerate() {
            *out += along * svd.V()[(j, k)];
        }
    }
    Some(out)
}
