//! Many gaits of a robot: a grid of them, and what each comes to as a row of numbers.
//!
//! A gait without an answer is a row too: its status says why, and its figures are no numbers.
//!
//! **Units.** SI, angles in rad; each column's stands in [`COLUMNS`].

use crate::dynamics::Dynamics;
use crate::gait::{Course, Gait};
use crate::joints::Drives;
use crate::robot::Robot;
use crate::swim::{Status, Swim};

/// Values at even distances, both ends among them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Axis {
    /// The first.
    pub low: f64,
    /// The last.
    pub high: f64,
    /// How many, one at least.
    pub n: usize,
}

impl Axis {
    /// One value.
    #[must_use]
    pub fn one(value: f64) -> Self {
        Self { low: value, high: value, n: 1 }
    }

    /// Value k of `0..n`.
    #[must_use]
    pub fn at(&self, k: usize) -> f64 {
        if k == 0 {
            return self.low;
        }
        let part = k as f64 / (self.n - 1) as f64;
        // Both ends are met exactly.
        self.low * (1.0 - part) + self.high * part
    }
}

/// Gaits with every combination of four numbers.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    /// α, rad.
    pub amplitude: Axis,
    /// ω, rad/s.
    pub frequency: Axis,
    /// δ, rad.
    pub phase: Axis,
    /// γ, rad.
    pub turn: Axis,
    /// What all of them have.
    pub base: Gait,
}

impl Grid {
    /// The grid of one gait.
    #[must_use]
    pub fn of(gait: &Gait) -> Self {
        Self {
            amplitude: Axis::one(gait.amplitude),
            frequency: Axis::one(gait.frequency),
            phase: Axis::one(gait.phase),
            turn: Axis::one(gait.turn),
            base: gait.clone(),
        }
    }

    /// In the order in which they are counted, the last the fastest.
    #[must_use]
    pub fn axes(&self) -> [Axis; 4] {
        [self.amplitude, self.frequency, self.phase, self.turn]
    }

    /// How many gaits; `None` where they cannot be counted.
    #[must_use]
    pub fn gaits(&self) -> Option<usize> {
        self.axes().iter().try_fold(1_usize, |all, axis| all.checked_mul(axis.n))
    }

    /// Gait i.
    #[must_use]
    pub fn gait(&self, mut i: usize) -> Gait {
        let mut at = [0.0; 4];
        for (value, axis) in at.iter_mut().zip(self.axes()).rev() {
            *value = axis.at(i % axis.n);
            i /= axis.n;
        }
        self.with(at)
    }

    /// A gait with other numbers, in the order of the axes.
    #[must_use]
    pub fn with(&self, [amplitude, frequency, phase, turn]: [f64; 4]) -> Gait {
        Gait { amplitude, frequency, phase, turn, ..self.base.clone() }
    }
}

/// Names and units of the numbers of a [`Row`].
#[rustfmt::skip]
pub const COLUMNS: [(&str, &str); 26] = [
    ("amplitude", "rad"), ("frequency", "rad/s"), ("phase", "rad"), ("turn", "rad"), ("draw", "1"),
    ("speed", "m/s"), ("turn_rate", "rad/s"),
    ("power_net", "W"), ("power_pos", "W"), ("power_abs", "W"), ("power_loss", "W"), ("power_friction", "W"), ("power_electric", "W"),
    ("cot", "J/m"), ("cot_pos", "J/m"), ("cot_weight", "1"),
    ("torque_peak", "N m"), ("rate_peak", "rad/s"),
    ("residual", "1"), ("periods", "1"), ("floquet", "1"),
    ("extrapolated_loss_by_speed", "1"), ("extrapolated_loss_by_angle", "1"),
    ("unstable_speed", "m/s"), ("unstable_power_net", "W"), ("unstable_floquet", "1"),
];

/// What a gait comes to.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// In the order of [`COLUMNS`]; those of an answer are NaN where there is none, or where they do not apply.
    pub numbers: [f64; COLUMNS.len()],
    /// Whether there is one.
    pub status: Status,
}

impl Row {
    /// A robot with a gait; `draw` is the number of its coefficients, 0 of those that are estimated.
    #[must_use]
    pub fn of<C: Dynamics>(robot: &Robot<C>, drives: &Drives, step_s: Option<f64>, gait: &Gait, draw: usize) -> Self {
        let found = robot.swim(gait, drives, step_s);
        let asked = [gait.amplitude, gait.frequency, gait.phase, gait.turn, draw as f64];
        let mut numbers = [f64::NAN; COLUMNS.len()];
        numbers[..asked.len()].copy_from_slice(&asked);
        let status = found.as_ref().map_or_else(
            |error| error.status,
            |swim| {
                if swim.effort.needs.is_beyond { Status::Drives } else { Status::Periodic }
            },
        );
        if let Ok(swim) = &found {
            numbers[asked.len()..].copy_from_slice(&answer(swim, gait));
        }
        Self { numbers, status }
    }

    /// The number of a column; NaN of a name that there is not.
    #[must_use]
    pub fn get(&self, name: &str) -> f64 {
        COLUMNS.iter().position(|(own, _)| *own == name).map_or(f64::NAN, |j| self.numbers[j])
    }
}

fn answer<C: Dynamics>(swim: &Swim<C>, gait: &Gait) -> [f64; COLUMNS.len() - 5] {
    let (p, m) = (&swim.periodic, &swim.periodic.means);
    let unstable =
        swim.unstable.as_ref().map_or([f64::NAN; 3], |u| [u.means.speed_m_s, u.means.net_w, u.multipliers[0]]);
    let [by_speed, by_angle] = swim.effort.extrapolated.map(|share| share.unwrap_or(f64::NAN));
    [
        m.speed_m_s,
        m.turn / gait.period_s(),
        m.net_w,
        m.positive_w,
        m.absolute_w,
        m.loss_w,
        m.friction_w,
        swim.effort.electric_w.unwrap_or(f64::NAN),
        m.cost_j_m(),
        m.cost_positive_j_m(),
        swim.cost,
        swim.effort.needs.torque_n_m,
        swim.effort.needs.rate_rad_s,
        p.residual,
        p.periods as f64,
        // Of a body that nothing rights a multiplier of 1 is found by differences, on either side.
        if p.is_unstable() { p.multipliers[0] } else { p.multipliers[0].min(1.0) },
        by_speed,
        by_angle,
        unstable[0],
        unstable[1],
        unstable[2],
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::Envelope;

    #[test]
    fn a_grid_has_every_combination_once_and_meets_its_ends() {
        let mut grid = Grid::of(&Gait::wave(0.5, 1.4, 0.7, Envelope::Lateral));
        grid.amplitude = Axis { low: 0.1, high: 0.7, n: 7 };
        grid.turn = Axis { low: -0.1, high: 0.1, n: 3 };
        let gaits: Vec<Gait> = (0..grid.gaits().unwrap()).map(|i| grid.gait(i)).collect();
        assert_eq!(gaits.len(), 21);
        assert!(gaits.iter().all(|g| (g.frequency, g.phase) == (1.4, 0.7)));
        let mut pairs: Vec<[u64; 2]> = gaits.iter().map(|g| [g.amplitude.to_bits(), g.turn.to_bits()]).collect();
        pairs.sort_unstable();
        pairs.dedup();
        assert_eq!(pairs.len(), 21);
        assert_eq!((gaits[20].amplitude, gaits[20].turn, gaits[0].turn), (0.7, 0.1, -0.1));
        assert!((grid.amplitude.at(3) - 0.4).abs() < 1e-15);
    }

    #[test]
    fn statuses_stand_in_the_order_of_their_codes() {
        for (code, status) in Status::ALL.iter().enumerate() {
            assert_eq!(*status as usize, code);
        }
    }
}
