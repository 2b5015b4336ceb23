//! A drag at one speed by one method, and the slope over points.

use froude_fit::series::Mean;

use super::run::{DragRun, Window};
use super::steady::{mean_speed, reach};

/// A steady force.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// The (wet) run.
    pub run: String,
    /// Mean speed over the window, m/s, signed.
    pub speed_m_s: f64,
    /// Resistance, N, with the sign of the speed.
    pub force_n: f64,
    /// Standard uncertainty of that from within the window, N; run-to-run changes are not in it.
    pub standard_n: f64,
    /// Number of independent samples in the window.
    pub effective_n: f64,
    /// Pair (cluster).
    pub pair: u32,
    /// Positions of the window, m, low and high.
    pub position_m: [f64; 2],
    /// Change of the force over the window, N, where it is more than chance.
    pub trend_n: Option<f64>,
}

impl Point {
    /// Of a mean over a window of a run, each of whose units is so many newtons.
    #[must_use]
    pub fn of(run: &DragRun<'_>, window: Window, mean: &Mean, unit_n: f64) -> Self {
        Self {
            run: run.id.to_owned(),
            speed_m_s: mean_speed(run, window),
            force_n: unit_n * mean.value,
            standard_n: unit_n * mean.standard,
            effective_n: mean.effective_n,
            pair: run.pair,
            position_m: reach(window.of(run.position_m)),
            trend_n: mean.has_trend().then_some(unit_n * mean.trend),
        }
    }
}

/// How the force was got.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Method {
    /// Force sensor.
    Fsm,
    /// Motor current difference, eq. 8.
    Mcd,
    /// Model based, eq. 9, one Coulomb and one viscous number.
    MbdpConstant,
    /// Model based, friction mapped over position.
    MbdpMapped,
    /// Model based, two masses and a chain, friction mapped.
    MbdpFlexible,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 5] = [Self::Fsm, Self::Mcd, Self::MbdpConstant, Self::MbdpMapped, Self::MbdpFlexible];

    /// As it stands in records and tables.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Fsm => "fsm",
            Self::Mcd => "mcd",
            Self::MbdpConstant => "mbdp_constant",
            Self::MbdpMapped => "mbdp_mapped",
            Self::MbdpFlexible => "mbdp_flexible",
        }
    }

    /// In words.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::Fsm => "force sensor, zeroed at rest before and after",
            Self::Mcd => "motor current difference of wet and dry runs, paired by position",
            Self::MbdpConstant => "motor current minus constant Coulomb and viscous friction",
            Self::MbdpMapped => "motor current minus friction mapped over position",
            Self::MbdpFlexible => "motor current minus two-mass model with friction mapped over position",
        }
    }

    /// Whether the force comes from the motor's current.
    #[must_use]
    pub const fn is_sensorless(self) -> bool {
        !matches!(self, Self::Fsm)
    }
}

/// Slope through the origin over v|v|; `None` without a moving point.
#[must_use]
pub fn slope<'a>(points: impl IntoIterator<Item = &'a Point>) -> Option<f64> {
    let (mut xx, mut xy) = (0.0, 0.0);
    for p in points {
        let x = p.speed_m_s * p.speed_m_s.abs();
        xx += x * x;
        xy += x * p.force_n;
    }
    (xx > 0.0).then(|| xy / xx)
}

/// Distinct pairs, in order of appearance.
#[must_use]
pub fn pairs(points: &[Point]) -> Vec<u32> {
    let mut out: Vec<u32> = Vec::new();
    for p in points {
        if !out.contains(&p.pair) {
            out.push(p.pair);
        }
    }
    out
}
