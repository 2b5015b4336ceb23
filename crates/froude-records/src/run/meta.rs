//! What is known about a run besides its columns.

use indexmap::IndexMap;

use crate::body_axis::BodyAxis;
use crate::hash::Fingerprint;
use crate::measured::Measured;
use crate::run::channel::Meaning;
use crate::run::declarations::{Declarations, Stated};
use crate::run::declared::Declared;

/// What a run is, on which rig, and how it ended.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RunMeta {
    /// Name of the campaign.
    pub campaign: String,
    /// SHA-256 of the campaign's file, hexadecimal; empty where it is not known (versions before runs carried it).
    pub campaign_sha256: String,
    /// Name of the run, unique in the campaign; also the stem of its files.
    pub id: String,
    /// What sort of experiment it belongs to, in the word by which methods know it: [`TOW`], or any other; empty where
    /// nobody said.
    pub method: String,
    /// What it is for there.
    pub role: Role,
    /// What hangs on the strut, and how.
    pub mounted: Mounted,
    /// Which of the campaign's configurations is mounted; empty where there is one, or nobody said.
    pub configuration: String,
    /// What it was done in, by name (`flow = "0.2 m/s"`).
    pub conditions: IndexMap<String, Measured>,
    /// Where a carriage drove it: how, and on which rig.
    pub carriage: CarriageFacts,
    /// Further constants by name, as a sidecar declares them (`drive_gain = "35.15 N/V"`).
    pub constants: IndexMap<String, Measured>,
    /// How it ended.
    pub status: RunStatus,
    /// Anything a person wants to add.
    pub note: String,
    /// Versions of program and board firmware by name.
    pub versions: IndexMap<String, String>,
    /// Board clock against host clock.
    pub clock: Option<ClockAlignment>,
    /// Nominal ticks per second.
    pub log_rate_hz: f64,
    /// When it began, in words (RFC 3339), e.g. `2026-11-21T10:57:34Z`.
    pub date: String,
    /// Host time of run time zero, ns since 1970; 0 where there is none. Log times in the file count from there.
    pub start_unix_ns: u64,
    /// What its channels are, by name; of a log without a word of it, what their names tell, when the whole log has been read.
    pub channels: IndexMap<String, Meaning>,
    /// What is stated of the channels beside their meaning, by the channel's name; those of which nothing is are not there.
    pub stated: IndexMap<String, Stated>,
    /// What is declared of the data beside the channels.
    pub declared: Declarations,
    /// Length and hash of the log, known when it has been finished; only a sidecar has it.
    pub log: Option<Fingerprint>,
}

impl RunMeta {
    /// Declared constants of the axis that moves.
    #[must_use]
    pub fn moving_axis(&self) -> Option<&AxisConstants> {
        self.carriage.rig.get(self.carriage.axis.name())
    }
}

/// The method of every run that the carriage drives.
pub const TOW: &str = "tow";

/// What hangs on the strut of a run, and how.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Mounted {
    /// Whether there is a body, and where.
    pub body: BodyState,
    /// Whether ballast makes the wheel load the same wet and dry.
    pub is_ballasted: bool,
    /// Known weight over the pulley, N, in a calibration.
    pub hung_weight_n: Option<f64>,
    /// The axis of the body that lies along the travel; `None` where nobody declared it.
    pub travel: Option<BodyAxis>,
}

/// How a carriage drove a run, and on which rig.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct CarriageFacts {
    /// ABBA block, from 1.
    pub set: Option<u32>,
    /// Wet/dry pair, from 1.
    pub pair: Option<u32>,
    /// Repeat at this speed, from 1.
    pub repeat: Option<u32>,
    /// The axis that moves.
    pub axis: Axis,
    /// Speed of the steady part, ≥ 0.
    pub target_speed_m_s: Option<f64>,
    /// Which way the steady part goes.
    pub direction: Option<Direction>,
    /// Declared constants of the axes by name (`y`, `x`).
    pub rig: IndexMap<String, AxisConstants>,
    /// Seed of the twin; `None` for a real rig.
    pub twin_seed: Option<u64>,
}

/// What a run is for in its experiment.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Role {
    /// Brings gears and grease to temperature; not used in fits.
    #[default]
    WarmUp,
    /// Nothing moves: sensor zero and noise.
    Still,
    /// A short open-loop jog: polarity, encoder.
    Jog,
    /// Sweep of friction over position and speed.
    Friction,
    /// A known weight over the pulley.
    Calibration,
    /// Excitation of the drive.
    Excitation,
    /// A profile without the body in the water.
    Dry,
    /// The same with it.
    Wet,
    /// Relay feedback.
    Relay,
    /// Frequency sweep.
    Sweep,
    /// The motion of a wet run in water, with the body off.
    Tare,
    /// A release.
    Decay,
    /// The test itself, of a tank method: the body in water, moved as the method asks.
    Test,
    /// The motion of a test with the body on, in air.
    DryAir,
    /// The body held fast in waves: what they exert on it.
    Held,
    /// The body free to move in waves.
    Free,
}

impl Role {
    /// Each of them.
    pub const ALL: [Self; 16] = [
        Self::WarmUp,
        Self::Still,
        Self::Jog,
        Self::Friction,
        Self::Calibration,
        Self::Excitation,
        Self::Dry,
        Self::Wet,
        Self::Relay,
        Self::Sweep,
        Self::Tare,
        Self::Decay,
        Self::Test,
        Self::DryAir,
        Self::Held,
        Self::Free,
    ];
    pub(crate) const NAMES: [&'static str; 16] = [
        "warm_up",
        "still",
        "jog",
        "friction",
        "calibration",
        "excitation",
        "dry",
        "wet",
        "relay",
        "sweep",
        "tare",
        "decay",
        "test",
        "dry_air",
        "held",
        "free",
    ];

    /// As it stands in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

/// An axis of the carriage.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Axis {
    /// The long one, along the tank.
    #[default]
    Y,
    /// The short one, across it.
    X,
}

impl Axis {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Y, Self::X];
    /// Their names.
    pub const NAMES: [&'static str; 2] = ["y", "x"];

    /// As it stands in files and before the slash of channel names.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

/// Which way a run goes along its axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Direction {
    /// Towards larger positions.
    Forward,
    /// Towards smaller positions.
    Backward,
}

impl Direction {
    pub(crate) const ALL: [Self; 2] = [Self::Forward, Self::Backward];
    pub(crate) const NAMES: [&'static str; 2] = ["forward", "backward"];

    /// As it stands in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }

    /// +1 or −1.
    #[must_use]
    pub fn sign(self) -> f64 {
        match self {
            Self::Forward => 1.0,
            Self::Backward => -1.0,
        }
    }
}

/// What hangs on the strut.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum BodyState {
    /// No body.
    #[default]
    None,
    /// The body, out of the water.
    Dry,
    /// The body, in the water.
    Wet,
}

impl BodyState {
    pub(crate) const ALL: [Self; 3] = [Self::None, Self::Dry, Self::Wet];
    pub(crate) const NAMES: [&'static str; 3] = ["none", "dry", "wet"];

    /// As it stands in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

/// How a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum RunStatus {
    /// It has not ended: only while a recorder holds the file.
    #[default]
    Running,
    /// As planned: the whole motion was done.
    Complete,
    /// Before its plan, without a fault of the rig: Ctrl-C, power, kill, full disk.
    Interrupted,
    /// By a latched fault.
    Faulted,
    /// By the controller, without a fault, before its planned motion was done: an excitation that came to a soft limit, a jog that
    /// did not get as far as it should.
    Cut,
}

impl RunStatus {
    pub(crate) const ALL: [Self; 5] = [Self::Running, Self::Complete, Self::Interrupted, Self::Faulted, Self::Cut];
    pub(crate) const NAMES: [&'static str; 5] = ["running", "complete", "interrupted", "faulted", "cut"];

    /// As it stands in files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize]
    }
}

/// Declared constants of one axis: what turns counts and volts into metres and newtons.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AxisConstants {
    /// K_T, N m/A.
    pub torque_constant_n_m_a: Declared,
    /// K_amp, A/V.
    pub amplifier_a_v: Declared,
    /// n, motor turns per turn of the sprocket.
    pub gear_ratio: Declared,
    /// R, m.
    pub sprocket_radius_m: Declared,
    /// Counts per turn of the motor, after decoding.
    pub counts_per_revolution: f64,
    /// η forward (motor drives the load), 0 to 1; `None` where nobody declared or calibrated it.
    pub efficiency_forward: Option<Declared>,
    /// η backward (load drives the motor); `None` likewise.
    pub efficiency_backward: Option<Declared>,
    /// Whether the efficiencies come from a calibration with known weights.
    pub is_calibrated: bool,
}

/// Board clock against host clock: host = `host_at_zero_s` + (1 + `drift`)·board.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ClockAlignment {
    /// Host time at the record's time zero, s since the start of the campaign ([`RunMeta::start_unix_ns`]).
    pub host_at_zero_s: f64,
    /// Relative drift of the host clock against the board's, 1.
    pub drift: f64,
    /// Standard uncertainty of a host time computed from it, s.
    pub standard_uncertainty_s: f64,
}
