//! What the reduction of a carriage's runs takes: the columns of each run and what is declared about the rig.

pub use froude_records::run::BodyState;

/// A stretch of samples, `first..end`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// First sample.
    pub first: usize,
    /// One past the last.
    pub end: usize,
}

impl Window {
    /// Number of samples.
    #[must_use]
    pub fn len(self) -> usize {
        self.end - self.first
    }

    /// Whether it holds no sample.
    #[must_use]
    pub fn is_empty(self) -> bool {
        self.end <= self.first
    }

    /// Its samples of a column.
    #[must_use]
    pub fn of(self, column: &[f64]) -> &[f64] {
        &column[self.first..self.end]
    }
}

/// What a run is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RunKind {
    /// A tow, wet or dry.
    Tow,
    /// Motion to identify the friction from, body not in the water.
    Friction,
    /// A known weight hangs over the pulley.
    Calibration,
}

/// Columns of one run and what is known about it; all columns have one length and one uniform step of time.
#[derive(Debug, Clone, Copy)]
pub struct DragRun<'a> {
    /// Name of the run, for messages.
    pub id: &'a str,
    /// Time, s.
    pub time_s: &'a [f64],
    /// Position along the chain, motor side, m.
    pub position_m: &'a [f64],
    /// Speed that was asked for, m/s, with its sign.
    pub reference_speed_m_s: &'a [f64],
    /// Drive command v_c, V, or the motor's current, A; positive drives towards +y.
    pub command_v: &'a [f64],
    /// Where its speed is held and has settled, if that is known by other means than the reference speed.
    pub held: Option<Window>,
    /// Force sensor, N, resistance to +y motion positive; its zero is not subtracted.
    pub force_n: Option<&'a [f64]>,
    /// What it is for.
    pub kind: RunKind,
    /// What hangs on the strut.
    pub body: BodyState,
    /// Speed of the steady part, m/s, ≥ 0.
    pub target_speed_m_s: f64,
    /// +1 or −1.
    pub direction: f64,
    /// Pair that the run belongs to. Runs of one pair (all speeds, out and back) share mounts and the hour of the
    /// day: they are one cluster of the scatter. A wet run is paired with the dry run of its pair, speed and direction.
    pub pair: u32,
    /// Whether ballast made the wheel load the same wet and dry.
    pub is_ballasted: bool,
    /// Known weight over the pulley, N, pulling towards −y.
    pub hung_weight_n: Option<f64>,
}

impl DragRun<'_> {
    /// Step of time, s.
    #[must_use]
    pub fn step_s(&self) -> f64 {
        let n = self.time_s.len();
        if n < 2 { f64::NAN } else { (self.time_s[n - 1] - self.time_s[0]) / (n - 1) as f64 }
    }

    /// Samples of so many seconds, rounded up; a run whose step is no time has more than any run is long.
    #[must_use]
    pub fn samples(&self, duration_s: f64) -> usize {
        (duration_s / self.step_s()).ceil().min(1e9) as usize
    }

    /// Whether two runs are the same tow: pair, speed, direction.
    #[must_use]
    pub fn is_partner_of(&self, other: &DragRun<'_>) -> bool {
        self.pair == other.pair && self.is_like(other)
    }

    /// Whether two runs have the same speed and direction.
    #[must_use]
    pub fn is_like(&self, other: &DragRun<'_>) -> bool {
        self.direction == other.direction
            && (self.target_speed_m_s - other.target_speed_m_s).abs() <= 1e-6 * (1.0 + self.target_speed_m_s)
    }
}
