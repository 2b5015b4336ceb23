//! What the host may ask of the controller.

use crate::fault::{Fault, StopCategory};

/// A move from rest to rest along one axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Where it ends, m.
    pub target_m: f64,
    /// Largest speed, m/s (> 0).
    pub speed_m_s: f64,
    /// Largest acceleration, m/s² (> 0).
    pub acceleration_m_s2: f64,
    /// Largest jerk, m/s³; 0 means a trapezoid of speed.
    pub jerk_m_s3: f64,
    /// Shape the reference for the axis's configured mode.
    pub is_shaped: bool,
}

/// Open-loop or test excitation of one axis, always inside the soft limits.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Excitation {
    /// Square pulses of ± `volts`, `period_s` long of which `duty` is on (the paper: 60 %, 1 s).
    Pulses {
        /// Amplitude, V.
        volts: f64,
        /// Period, s.
        period_s: f64,
        /// Part of the period that is on, 0 to 1.
        duty: f64,
        /// How long, s.
        duration_s: f64,
    },
    /// Relay feedback about the present position: ± `volts` by the sign of the error, with hysteresis.
    Relay {
        /// Amplitude, V.
        volts: f64,
        /// Half width of the hysteresis, m.
        hysteresis_m: f64,
        /// How long, s.
        duration_s: f64,
    },
    /// A sine added to the drive command while the loop tracks a constant speed, its frequency rising exponentially.
    Sweep {
        /// Amplitude, V.
        volts: f64,
        /// First frequency, Hz.
        from_hz: f64,
        /// Last frequency, Hz.
        to_hz: f64,
        /// Length, s.
        duration_s: f64,
        /// Speed of the reference below it, m/s; signed.
        speed_m_s: f64,
    },
    /// Constant drive command for a short jog with the loop open (polarity and encoder check).
    Jog {
        /// Command, V; signed.
        volts: f64,
        /// It ends when the axis has moved this far, m, or at `duration_s`.
        distance_m: f64,
        /// Longest time, s.
        duration_s: f64,
    },
}

/// A request to the controller; it takes effect at the tick that carries it, or is refused (see [`crate::status::Refusal`]).
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Request {
    /// Enable an axis: it holds where it stands.
    Enable {
        /// Axis.
        axis: usize,
    },
    /// Take the torque off an axis at rest.
    Disable {
        /// Axis.
        axis: usize,
    },
    /// Find the low end switch and set the coordinate there; until then speed is capped and moves are refused.
    Home {
        /// Axis.
        axis: usize,
    },
    /// Move from rest to rest.
    Move {
        /// Axis.
        axis: usize,
        /// The profile.
        profile: Move,
    },
    /// Excite an axis.
    Excite {
        /// Axis.
        axis: usize,
        /// The signal.
        excitation: Excitation,
    },
    /// Stop both axes.
    Stop(StopCategory),
    /// Stop because the host can no longer record (latches [`Fault::RecorderFailed`]).
    RecorderFailed,
    /// Clear this latched fault; the axis stays disabled and, after an encoder fault, must be homed again.
    Clear(Fault),
}
