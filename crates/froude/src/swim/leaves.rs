//! A motion that a swimmer leaves and the one that it settles into, said of the plane and of space.

use froude_records::number::significant;
use serde_json::{Value, json};

/// A motion that turns by more in a period, rad, is a circle.
const CIRCLES: f64 = 1e-6;

/// A motion that repeats.
pub(super) struct Repeating<'a> {
    pub speed_m_s: f64,
    pub net_w: f64,
    pub positive_w: f64,
    /// In a period, rad.
    pub turn: f64,
    /// Sizes of the Floquet multipliers, the largest first.
    pub multipliers: &'a [f64],
}

impl<'a> From<&'a froude_swim::period::Periodic> for Repeating<'a> {
    fn from(p: &'a froude_swim::period::Periodic) -> Self {
        Self {
            speed_m_s: p.speed_m_s,
            net_w: p.net_w,
            positive_w: p.positive_w,
            turn: p.turn,
            multipliers: &p.multipliers,
        }
    }
}

impl<'a> From<&'a froude_swim::spatial::period::Periodic> for Repeating<'a> {
    fn from(p: &'a froude_swim::spatial::period::Periodic) -> Self {
        Self {
            speed_m_s: p.speed_m_s,
            net_w: p.net_w,
            positive_w: p.positive_w,
            turn: p.turn,
            multipliers: &p.multipliers,
        }
    }
}

impl Repeating<'_> {
    fn grows(&self) -> String {
        let by = self.multipliers.first().copied().unwrap_or(f64::NAN);
        format!("a small deviation grows by a factor of {} from period to period", significant(by, 3))
    }

    /// Of an unstable motion that the figures are of; `was_followed` says whether another was looked for.
    pub fn stays(&self, was_followed: bool) -> String {
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
    pub fn leaves(&self, settled: &Self, period_s: f64) -> String {
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

    /// Rows of a table: quantity, value, unit.
    pub fn rows(&self) -> Vec<Vec<String>> {
        let row = |name: &str, value: f64, unit: &str| vec![name.to_owned(), significant(value, 4), unit.to_owned()];
        vec![
            row("speed of the unstable motion", self.speed_m_s, "m/s"),
            row("net power of the unstable motion", self.net_w, "W"),
        ]
    }

    /// The same for a program.
    pub fn as_json(&self) -> Value {
        json!({
            "speed_m_s": self.speed_m_s,
            "power_net_w": self.net_w,
            "power_positive_w": self.positive_w,
            "cost_of_transport_j_m": self.net_w / self.speed_m_s,
            "turn_per_period_rad": self.turn,
            "floquet_multipliers": self.multipliers,
        })
    }
}
