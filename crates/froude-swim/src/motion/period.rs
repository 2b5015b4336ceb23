//! The motion that repeats itself: a fixed point of the map over one period.
//!
//! Nothing in the water depends on where the swimmer is and where it heads, so that the map of the head's own motion (ω, u, v) over a period has three
//! numbers. Newton's method on it finds the one that repeats; the eigenvalues of its derivative are the Floquet multipliers, and one beyond 1 is a gait that leaves its own path. Speed is
//! that of the centre of mass through the water from the beginning of a period, t = 0, to its end (chord), divided by the period: of a gait that turns it depends on where the
//! period begins, and it is nothing after a full turn.
//!
//! **Units.** SI. **Source.** Nayfeh & Balachandran (1995), *Applied Nonlinear Dynamics*, ch. 3 (stability of periodic solutions) and 6 (shooting).

use faer::Mat;
use faer::prelude::*;

use crate::chain::Chain;
use crate::head::{COARSE, HeadMap, SIDE_BY_SIDE};
use crate::means::Means;
use crate::moving::{Exact, Instant, Passage, go};
use crate::path::{State, Swimmer};
use crate::planar::Motion;
use crate::settled::settled;

/// Periods that a swimmer is let go before Newton's method.
pub(crate) const TRANSIENT: usize = 3;
/// Periods in which a swimmer that leaves an unstable motion must come near another.
pub(crate) const MOST_PERIODS: usize = 4000;
/// Steps of Newton's method.
pub(crate) const MOST_STEPS: usize = 30;
/// A motion repeats itself when each part is met to this, of the speed of a link length in a period.
pub(crate) const REPEATS: f64 = 1e-9;
/// Step of the differences of the map, of the same speed.
pub(crate) const STEP: f64 = 1e-5;

/// What a period of a gait does.
#[derive(Debug, Clone, PartialEq)]
pub struct Periodic {
    /// The motion of the head that repeats.
    pub head: Motion,
    /// Its means.
    pub means: Means,
    /// Way of the centre of mass in a period, m, in axes in which the head begins along x.
    pub way_m: [f64; 2],
    /// φ, rad, and φ̇, rad/s, of each joint at the beginning of a period, where servos drive them.
    pub joints: Vec<[f64; 2]>,
    /// Sizes of the Floquet multipliers, the three largest.
    pub multipliers: [f64; 3],
    /// By how much the motion does not repeat, relative.
    pub residual: f64,
    /// Periods that were followed in the search and in measuring; those side by side count once.
    pub periods: usize,
}

impl Periodic {
    /// Of the motion that was found, from a period of it.
    pub(crate) fn of(period_s: f64, head: Motion, joints: Vec<[f64; 2]>, passage: &Passage, map: &Repeats) -> Self {
        Self {
            head,
            joints,
            means: passage.means(period_s, passage.end.heading),
            way_m: passage.way_m,
            multipliers: map.multipliers(),
            residual: map.residual,
            periods: map.periods + 1,
        }
    }
}

/// How well a motion repeats, and the derivative of the map there.
pub(crate) struct Repeats {
    pub(crate) derivative: Mat<f64>,
    pub(crate) residual: f64,
    /// Periods that the search took.
    pub(crate) periods: usize,
}

impl Repeats {
    fn multipliers(&self) -> [f64; 3] {
        let mut sizes: Vec<f64> =
            self.derivative.eigenvalues().map_or_else(|_| Vec::new(), |all| all.iter().map(|s| s.norm()).collect());
        sizes.sort_by(|a, b| b.total_cmp(a));
        std::array::from_fn(|k| sizes.get(k).copied().unwrap_or(f64::NAN))
    }
}

impl Swimmer<'_> {
    /// The periodic motion in `steps` steps a period; `None` where there is none within reach or an inertia is not positive.
    #[must_use]
    pub fn periodic(&self, steps: usize) -> Option<Periodic> {
        self.periodic_seen(steps, &mut |_| ())
    }

    /// The same, seen at the beginning of each step of a period.
    pub fn periodic_seen(&self, steps: usize, see: &mut dyn FnMut(&Instant<'_>)) -> Option<Periodic> {
        let steps = steps.max(1).next_multiple_of(COARSE);
        let period = self.gait.period_s();
        let scale = scale(self.chain, period);
        let map = HeadMap::new(self.chain, self.gait, period, steps)?;
        // Steps four times as long lead to where the exact ones begin; where they diverge, they were too long.
        let mut head = [0.0; 3];
        for _ in 0..TRANSIENT {
            [head, ..] = map.over(&[head; SIDE_BY_SIDE], COARSE);
        }
        let mut periods = TRANSIENT;
        let coarse = newton(&map, head, scale, (COARSE, 1e3 * REPEATS), &mut periods);
        let start = coarse.map_or([0.0; 3], |found| found.head);
        self.at(&map, start, [steps, periods], see)
    }

    /// The motion that an unstable one settles into, seen as in [`Swimmer::periodic_seen`]; `None` where it settles into none that repeats each period.
    pub fn settled_seen(
        &self,
        unstable: &Periodic,
        steps: usize,
        see: &mut dyn FnMut(&Instant<'_>),
    ) -> Option<Periodic> {
        let steps = steps.max(1).next_multiple_of(COARSE);
        let period = self.gait.period_s();
        let scale = scale(self.chain, period);
        let map = HeadMap::new(self.chain, self.gait, period, steps)?;
        let over = |z: &[f64]| Some(map.over(&[[z[0], z[1], z[2]]; SIDE_BY_SIDE], COARSE)[0].to_vec());
        let near = settled(&unstable.head, &scale, MOST_PERIODS, over)?;
        let found = self.at(&map, [near[0], near[1], near[2]], [steps, 0], see)?;
        (found.multipliers[0] <= 1.0).then_some(found)
    }

    /// The motion that repeats next to `head`, in `steps` after `periods` that led there.
    fn at(
        &self,
        map: &HeadMap,
        head: Motion,
        [steps, mut periods]: [usize; 2],
        see: &mut dyn FnMut(&Instant<'_>),
    ) -> Option<Periodic> {
        let period = self.gait.period_s();
        let found = newton(map, head, scale(self.chain, period), (1, REPEATS), &mut periods)?;
        let swimmer = Swimmer { current_m_s: [0.0; 2], ..self.clone() };
        let mut moving = Exact::new(swimmer, State { head: found.head, ..State::default() });
        let passage = go(&mut moving, period / steps as f64, steps, see)?;
        Some(Periodic::of(period, found.head, Vec::new(), &passage, &found.repeats))
    }
}

/// Speeds of a head by which its motions are measured: a link length in a period.
pub(crate) fn scale(chain: &Chain, period_s: f64) -> Motion {
    let length: f64 = chain.links.iter().map(|link| 2.0 * link.half_length_m).sum::<f64>();
    let speed = length / chain.links.len() as f64 / period_s;
    [speed / length, speed, speed]
}

/// A fixed point of the map.
struct Fixed {
    head: Motion,
    repeats: Repeats,
}

/// Newton's method on the map, in one step of so many, until it repeats to a part of `scale`; it counts the periods.
fn newton(
    map: &HeadMap,
    mut head: Motion,
    scale: Motion,
    (one_of, within): (usize, f64),
    periods: &mut usize,
) -> Option<Fixed> {
    for _ in 0..MOST_STEPS {
        *periods += 1;
        let (end, derivative) = differentiated(map, head, scale, one_of);
        let away = [0, 1, 2].map(|k| end[k] - head[k]);
        if away.iter().any(|a| !a.is_finite()) {
            return None;
        }
        let residual = (0..3).map(|k| (away[k] / scale[k]).abs()).fold(0.0, f64::max);
        if residual < within {
            return Some(Fixed { head, repeats: Repeats { derivative, residual, periods: *periods } });
        }
        let left = Mat::from_fn(3, 3, |i, j| f64::from(u8::from(i == j)) - derivative[(i, j)]);
        let step = left.partial_piv_lu().solve(Mat::from_fn(3, 1, |i, _| away[i]));
        for k in 0..3 {
            head[k] += step[(k, 0)];
        }
    }
    None
}

/// The end of a period, with its derivative by the head's motion: differences to one side.
fn differentiated(map: &HeadMap, head: Motion, scale: Motion, one_of: usize) -> (Motion, Mat<f64>) {
    let mut starts = [head; SIDE_BY_SIDE];
    for j in 0..3 {
        starts[j + 1][j] += STEP * scale[j];
    }
    let [end, moved @ ..] = map.over(&starts, one_of);
    (end, Mat::from_fn(3, 3, |i, j| (moved[j][i] - end[i]) / (STEP * scale[j])))
}
