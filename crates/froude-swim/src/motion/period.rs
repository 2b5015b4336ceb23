//! The motion that repeats itself: a fixed point of the map over one period.
//!
//! Nothing in the water depends on where the swimmer is and where it heads; on roll and pitch it does by weight and buoyancy. What repeats are the head's own motion, its roll and pitch in three dimensions, and the joints' angles
//! and rates where servos drive them. Newton's method on the map of these numbers finds the motion (by Newton's method), and a multiplier beyond 1 is a gait that leaves its own path. Depth may change
//! from period to period: a swimmer that is too heavy sinks at a speed that repeats. Speed is
//! that of the centre of mass through the water from the beginning of a period, t = 0, to its end (chord), divided by the period: of a gait that turns it depends on where the
//! period begins, and it is nothing after a full turn.
//!
//! In the plane the map of joints that follow exactly goes four at a time ([`crate::head`]); all others go step by step.
//!
//! **Units.** SI. **Source.** Nayfeh & Balachandran (1995), *Applied Nonlinear Dynamics*, ch. 3 (stability of periodic solutions) and 6 (shooting).

use crate::chain::Chain;
use crate::drive::Servo;
use crate::driven::Driven;
use crate::dynamics::{Dynamics, StateOf};
use crate::gait::Shape;
use crate::head::COARSE;
use crate::means::Means;
use crate::moving::{Exact, Moving, Seeing, Servoed, go, of_head};
use crate::newton::{Fixed, Map, REPEATS, TRANSIENT};
use crate::path::Swimmer;
use crate::state::Numbers;
use crate::stepped::Stepped;

/// Periods in which a swimmer that leaves an unstable motion must come near another, in the plane …
const MOST_PERIODS: usize = 4000;
/// … and in three dimensions, some ten seconds of computing.
const MOST_PERIODS_OF_SPACE: usize = 1000;
/// Multipliers within this of one are one in three dimensions: what no weight brings back neither grows nor fades.
const ONE: f64 = 1e-4;

/// What a period of a gait does.
#[derive(Debug, Clone, PartialEq)]
pub struct Periodic<C: Dynamics = Chain> {
    /// The head at the beginning of a period that repeats, at the origin with no heading.
    pub start: StateOf<C>,
    /// Its means.
    pub means: Means,
    /// Way of the centre of mass in a period, m, in level axes in which the head begins along x; z is how much it sinks.
    pub way_m: [f64; 3],
    /// Least and largest roll and pitch of the head, rad.
    pub tilt: [[f64; 2]; 2],
    /// φ, rad, and φ̇, rad/s, of each joint at the beginning of a period, where servos drive them.
    pub joints: Vec<[f64; 2]>,
    /// Sizes of the Floquet multipliers, the largest first: as many as a head has numbers that repeat.
    pub multipliers: Vec<f64>,
    /// By how much the motion does not repeat, relative.
    pub residual: f64,
    /// Periods that were followed in the search and in measuring; those side by side count once.
    pub periods: usize,
}

impl<C: Dynamics> Periodic<C> {
    /// Whether a small deviation grows.
    #[must_use]
    pub fn is_unstable(&self) -> bool {
        self.multipliers[0] > if C::TILTS { 1.0 + ONE } else { 1.0 }
    }

    /// Where a trajectory with this motion begins, so that its first period leads along x.
    #[must_use]
    pub fn begin(&self) -> StateOf<C> {
        let [roll, pitch, _] = C::angles(&self.start.pose);
        let [x, y, _] = self.way_m;
        StateOf::<C> { pose: C::pose([0.0; 3], [roll, pitch, -y.atan2(x)]), ..self.start }
    }

    /// A period of `moving` from the numbers that repeat, of so many steps; as it is when the joints of so many are driven.
    fn measured(
        moving: &mut dyn Moving<C>,
        (period_s, steps): (f64, usize),
        found: &Fixed,
        periods: usize,
        see: &mut Seeing<'_, C>,
    ) -> Option<Self> {
        moving.begin(&found.at);
        let start = moving.state();
        let own = if C::TILTS { C::Motion::LEN + 2 } else { C::Motion::LEN };
        let j = (found.at.len() - own) / 2;
        let passage = go(moving, period_s / steps as f64, steps, see)?;
        Some(Self {
            start,
            means: passage.means(period_s),
            way_m: passage.way_m,
            tilt: passage.tilt,
            joints: (0..j).map(|i| [found.at[i], found.at[j + own + i]]).collect(),
            multipliers: found.multipliers(own),
            residual: found.residual,
            periods: periods + 1,
        })
    }
}

fn most_periods<C: Dynamics>() -> usize {
    if C::TILTS { MOST_PERIODS_OF_SPACE } else { MOST_PERIODS }
}

impl<C: Dynamics> Swimmer<'_, C> {
    /// The periodic motion in `steps` steps a period; `None` if none is found, or if an inertia is not positive.
    #[must_use]
    pub fn periodic(&self, steps: usize) -> Option<Periodic<C>> {
        self.periodic_seen(steps, &mut |_| ())
    }

    /// The same, seen at the beginning of each step of a period.
    pub fn periodic_seen(&self, steps: usize, see: &mut Seeing<'_, C>) -> Option<Periodic<C>> {
        self.sought(steps, see, |map| {
            // Steps four times as long lead to where the exact ones begin; where they diverge, they were too long.
            let mut begin = vec![0.0; map.form().size.len()];
            for _ in 0..TRANSIENT {
                begin = map.over(&begin, COARSE)?;
            }
            let coarse = Fixed::near(map, begin.clone(), (COARSE, 1e3 * REPEATS));
            let near = coarse.map_or_else(|| vec![0.0; begin.len()], |found| found.at);
            Some((Fixed::near(map, near, (1, REPEATS))?, TRANSIENT))
        })
    }

    /// The motion that an unstable one settles into, seen as in [`Swimmer::periodic_seen`]; `None` where it settles into none that repeats each period.
    pub fn settled_seen(&self, unstable: &Periodic<C>, steps: usize, see: &mut Seeing<'_, C>) -> Option<Periodic<C>> {
        let start = of_head::<C>(&unstable.start);
        let found =
            self.sought(steps, see, |map| Some((Fixed::settled(map, &start, COARSE, most_periods::<C>())?, 0)))?;
        (!found.is_unstable()).then_some(found)
    }

    /// A period of the motion that `search` finds, which says too how many periods it followed beside those of the map.
    fn sought(
        &self,
        steps: usize,
        see: &mut Seeing<'_, C>,
        search: impl FnOnce(&mut dyn Map) -> Option<(Fixed, usize)>,
    ) -> Option<Periodic<C>> {
        let steps = steps.max(1).next_multiple_of(COARSE);
        let mut map = self.chain.map(self.gait, steps)?;
        let (found, beside) = search(map.as_mut())?;
        let swimmer = Swimmer { current_m_s: [0.0; 3], ..self.clone() };
        let mut moving = Exact::new(swimmer, C::REST);
        Periodic::measured(&mut moving, (self.gait.period_s(), steps), &found, map.periods() + beside, see)
    }
}

impl<'a, C: Dynamics> Driven<'a, Servo<'a>, C> {
    /// The periodic motion in `steps` steps a period, sought from a motion of the head with the joints where they shall be; seen at the beginning of each step of a period.
    ///
    /// `None` if none is found, or if an inertia is not positive.
    pub fn periodic_seen(&self, head: &StateOf<C>, steps: usize, see: &mut Seeing<'_, C>) -> Option<Periodic<C>> {
        let mut wanted = Shape::straight(self.chain.joints());
        self.drive.course().at(0.0, &mut wanted);
        let begin = [&wanted.angle[..], &of_head::<C>(head), &wanted.rate].concat();
        self.sought(steps, see, |map| {
            let mut near = begin;
            for _ in 0..TRANSIENT {
                near = map.over(&near, 1)?;
            }
            Fixed::near(map, near, (1, REPEATS))
        })
    }

    /// The motion that an unstable one settles into; as [`Swimmer::settled_seen`].
    pub fn settled_seen(&self, unstable: &Periodic<C>, steps: usize, see: &mut Seeing<'_, C>) -> Option<Periodic<C>> {
        let joints = |k: usize| unstable.joints.iter().map(move |joint| joint[k]);
        let head = of_head::<C>(&unstable.start);
        let start: Vec<f64> = joints(0).chain(head).chain(joints(1)).collect();
        let found = self.sought(steps, see, |map| Fixed::settled(map, &start, 1, most_periods::<C>()))?;
        (!found.is_unstable()).then_some(found)
    }

    fn sought(
        &self,
        steps: usize,
        see: &mut Seeing<'_, C>,
        search: impl FnOnce(&mut dyn Map) -> Option<Fixed>,
    ) -> Option<Periodic<C>> {
        let mut driven = self.clone();
        driven.current_m_s = [0.0; 3];
        let (course, j) = (driven.drive.course(), driven.chain.joints());
        let period_s = course.period_s();
        let rates = (0..j).map(|i| course.extremes(i, j)[1].max(1.0 / period_s));
        let mut map = Stepped::<C>::new(Servoed::new(driven.clone(), Vec::new()), driven.chain, (period_s, steps));
        map.add_joints(rates);
        let found = search(&mut map)?;
        let mut moving = Servoed::new(driven, Vec::new());
        Periodic::measured(&mut moving, (period_s, steps), &found, map.periods(), see)
    }
}
