//! A motion that a swimmer leaves and the one that it settles into, said of the plane and of space.

use froude_records::number::significant;

use crate::{period, spatial};

/// A motion that turns by more in a period, rad, is a circle.
const CIRCLES: f64 = 1e-6;

/// A motion that repeats.
#[derive(Debug, Clone)]
pub(super) struct Repeating {
    pub speed_m_s: f64,
    pub net_w: f64,
    pub positive_w: f64,
    /// In a period, rad.
    pub turn: f64,
    /// Sizes of the Floquet multipliers, the largest first.
    pub multipliers: Vec<f64>,
}

impl From<&period::Periodic> for Repeating {
    fn from(p: &period::Periodic) -> Self {
        let (speed_m_s, net_w, positive_w, turn) = (p.speed_m_s, p.net_w, p.positive_w, p.turn);
        Self { speed_m_s, net_w, positive_w, turn, multipliers: p.multipliers.to_vec() }
    }
}

impl From<&spatial::period::Periodic> for Repeating {
    fn from(p: &spatial::period::Periodic) -> Self {
        let (speed_m_s, net_w, positive_w, turn) = (p.speed_m_s, p.net_w, p.positive_w, p.turn);
        Self { speed_m_s, net_w, positive_w, turn, multipliers: p.multipliers.to_vec() }
    }
}

impl Repeating {
    fn grows(&self) -> String {
        let by = self.multipliers.first().copied().unwrap_or(f64::NAN);
        format!("a small deviation grows by a factor of {} from period to period", significant(by, 3))
    }

    /// Of an unstable motion that the figures are of; `was_followed` says whether another was looked for.
    pub(super) fn stays(&self, was_followed: bool) -> String {
        let other = if was_followed {
            "no other that repeats each period was reached"
        } else {
            "no other was looked for, because nothing rights the robot"
        };
        format!(
            "unstable: {}, and the swimmer leaves this motion; {other}, and all figures are those of the unstable motion",
            self.grows()
        )
    }

    /// Of an unstable motion, and the settled one that the figures are of.
    pub(super) fn leaves(&self, settled: &Self, period_s: f64) -> String {
        let into = if settled.turn.abs() > CIRCLES {
            let radius_m = settled.speed_m_s * period_s / (2.0 * (0.5 * settled.turn).sin().abs());
            // Only a motion without a turn of its own may leave to either side.
            let either = if self.turn.abs() <= CIRCLES { " or its mirror image" } else { "" };
            format!("a circle of {} m radius{either}", significant(radius_m, 3))
        } else {
            "another motion".to_owned()
        };
        format!(
            "unstable: the swimmer settles into {into}, at {} m/s and {} W, and all figures are those of this motion; it leaves the motion at {} m/s and {} W, in which {}",
            significant(settled.speed_m_s, 4),
            significant(settled.net_w, 4),
            significant(self.speed_m_s, 4),
            significant(self.net_w, 4),
            self.grows()
        )
    }
}
