//! What the controller reports about itself each tick.

use crate::fault::Fault;
use crate::tick::{AXES, Command};

/// What an axis is doing. `u8` values are those of telemetry and logs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u8)]
pub enum Phase {
    /// No torque. The state after power-up and after every category 0 or 1 stop.
    #[default]
    Disabled = 0,
    /// Holding a position.
    Holding = 1,
    /// Following a profile.
    Moving = 2,
    /// Looking for the end switch.
    Homing = 3,
    /// Excitation.
    Exciting = 4,
    /// Controlled stop.
    Stopping = 5,
    /// Torque is off and the axis still moves.
    Coasting = 6,
}

/// Why a request was not carried out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
#[non_exhaustive]
pub enum Refusal {
    /// A fault is latched.
    Faulted = 1,
    /// The axis is disabled.
    Disabled = 2,
    /// The axis has not been homed.
    NotHomed = 3,
    /// The axis is not at rest.
    Busy = 4,
    /// A number is not finite or not in its range.
    OutOfRange = 5,
    /// The profile would leave the travel, coast included.
    BeyondTravel = 6,
    /// There is no such axis.
    NoSuchAxis = 7,
    /// The named fault is not the latched one, or its cause persists.
    NotCleared = 8,
    /// The amplifier is not ready.
    NotReady = 9,
    /// An end switch is open although the axis is homed: its wire is broken, or the axis stands on it and must be homed.
    EndSwitchOpen = 10,
}

/// State of one axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AxisStatus {
    /// What it is doing.
    pub phase: Phase,
    /// Whether its coordinate is known.
    pub is_homed: bool,
    /// Unwrapped count since power-up.
    pub count: i64,
    /// Position, m (relative to power-up until homed).
    pub position_m: f64,
    /// Reference position, m.
    pub reference_m: f64,
    /// Reference speed, m/s.
    pub reference_m_s: f64,
    /// Reference acceleration, m/s².
    pub reference_m_s2: f64,
    /// The command was cut at the amplifier's range.
    pub is_saturated: bool,
}

/// State of the controller.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Status {
    /// Ticks since power-up.
    pub tick: u64,
    /// The axes.
    pub axes: [AxisStatus; AXES],
    /// The latched fault and its axis (`AXES` when it belongs to none).
    pub fault: Option<(Fault, u8)>,
    /// Why this tick's request was refused.
    pub refusal: Option<Refusal>,
}

/// What one tick gives.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Output {
    /// For the amplifiers.
    pub command: Command,
    /// For telemetry.
    pub status: Status,
}
