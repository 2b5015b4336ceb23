//! A motion that a swimmer leaves and the one that it settles into, said of the plane and of space.

use froude_records::number::significant;

use crate::dynamics::Dynamics;
use crate::means::Means;
use crate::period::Periodic;
use crate::swim::Swim;

/// A motion that turns by more in a period, rad, is a circle.
const CIRCLES: f64 = 1e-6;

/// A motion that repeats.
#[derive(Debug, Clone)]
pub(super) struct Repeating {
    /// Of a period.
    pub means: Means,
    /// Sizes of the Floquet multipliers, the largest first.
    pub multipliers: Vec<f64>,
    pub residual: f64,
    pub is_unstable: bool,
}

impl<C: Dynamics> From<&Periodic<C>> for Repeating {
    fn from(p: &Periodic<C>) -> Self {
        Self { means: p.means, multipliers: p.multipliers.clone(), residual: p.residual, is_unstable: p.is_unstable() }
    }
}

impl Repeating {
    fn grows(&self) -> String {
        let by = self.multipliers.first().copied().unwrap_or(f64::NAN);
        format!("a small deviation grows by a factor of {} from period to period", significant(by, 3))
    }

    /// Of an unstable motion that the figures are of; `was_followed` says whether another was looked for.
    fn stays(&self, was_followed: bool) -> String {
        let other = if was_followed {
            "no stable periodic motion was found"
        } else {
            "no other was looked for, because nothing rights the robot"
        };
        format!("unstable: {}; {other}, so all figures are for the unstable one", self.grows())
    }

    /// Of an unstable motion, and the settled one that the figures are of.
    fn leaves(&self, settled: &Self, period_s: f64) -> String {
        let (left, settled) = (&self.means, &settled.means);
        let into = if settled.turn.abs() > CIRCLES {
            let radius_m = settled.speed_m_s * period_s / (2.0 * (0.5 * settled.turn).sin().abs());
            // Only a motion without a turn of its own may leave to either side.
            let either = if left.turn.abs() <= CIRCLES { " or its mirror image" } else { "" };
            format!("a circle of {} m radius{either}", significant(radius_m, 3))
        } else {
            "another motion".to_owned()
        };
        format!(
            "unstable: the swimmer settles into {into}, at {} m/s and {} W, and all figures are those of this motion. The unstable motion has {} m/s and {} W; in it {}",
            significant(settled.speed_m_s, 4),
            significant(settled.net_w, 4),
            significant(left.speed_m_s, 4),
            significant(left.net_w, 4),
            self.grows()
        )
    }
}

/// How a gait's motion repeats.
#[derive(Debug)]
pub(super) struct Repeats {
    /// Net power over m g U.
    pub cost: f64,
    /// The motion that the figures are of.
    pub own: Repeating,
    /// The motion that the swimmer leaves.
    pub unstable: Option<Repeating>,
}

impl Repeats {
    pub(super) fn of<C: Dynamics>(swim: &Swim<C>) -> Self {
        let (own, unstable) = (Repeating::from(&swim.periodic), swim.unstable.as_deref().map(Repeating::from));
        Self { cost: swim.cost, own, unstable }
    }

    /// Of a motion that is left, or that stays unstable.
    pub(super) fn warning(&self, was_followed: bool, period_s: f64) -> Option<String> {
        match &self.unstable {
            Some(left) => Some(left.leaves(&self.own, period_s)),
            None => self.own.is_unstable.then(|| self.own.stays(was_followed)),
        }
    }
}
