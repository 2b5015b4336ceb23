//! Faults and what is done about them.
//!
//! A fault is `Copy` and latched; the first one wins and is cleared only by name. Stop categories, in the words of IEC 60204-1
//! (as software stops: this is no safety function):
//!
//! | category | what | when |
//! | --- | --- | --- |
//! | 0 | torque off at once, the axis coasts | encoder or amplifier fault: closed-loop braking is impossible; e-stop, end switch |
//! | 1 | controlled stop, then torque off | host silence, following error, soft limit, overload, disk full |
//! | 2 | controlled stop, then hold | operator's stop (Ctrl-C), pause |
//!
//! A fault of one axis stops both, by its category. A controlled stop that cannot be followed becomes one of category 0.
//! After a fault of an encoder its axis must be homed again.

/// How an axis is brought to rest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum StopCategory {
    /// Torque off at once.
    Zero,
    /// Controlled stop, then torque off.
    One,
    /// Controlled stop, then hold position.
    Two,
}

/// Why the carriage was stopped. `u8` values are those of telemetry and logs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
#[non_exhaustive]
pub enum Fault {
    /// The emergency-stop chain is open.
    EmergencyStop = 1,
    /// An end switch is open where none should be.
    EndSwitch = 2,
    /// The amplifier is not ready although it was enabled.
    AmplifierNotReady = 3,
    /// Torque is commanded above breakaway, yet no count comes.
    EncoderStuck = 4,
    /// The count moved further than the axis can within a tick.
    EncoderJump = 5,
    /// The decoder saw both lines change at once, more often than allowed.
    EncoderIllegal = 6,
    /// Counts move against the commanded torque: encoder or motor polarity is reversed.
    Polarity = 7,
    /// Ticks came too late: the inputs are older than the watchdog allows.
    TickLate = 8,
    /// The measured current exceeds its limit, or does not follow the command.
    OverCurrent = 9,
    /// The motor's thermal model (I²t) is full.
    Overload = 10,
    /// The command is saturated longer than allowed.
    Saturated = 11,
    /// Reference and position are further apart than allowed.
    FollowingError = 12,
    /// The position is where it can no longer be stopped before the hard stop.
    SoftLimit = 13,
    /// The speed exceeds its limit.
    OverSpeed = 14,
    /// No valid frame came from the host within the watchdog's time.
    HostSilent = 15,
    /// The host asked for a stop because it can no longer record.
    RecorderFailed = 16,
    /// An input is not finite.
    NotFinite = 17,
    /// Homing did not find its mark within the travel.
    HomingFailed = 18,
}

impl Fault {
    /// How the carriage is stopped for this fault.
    #[must_use]
    pub const fn category(self) -> StopCategory {
        match self {
            Self::EmergencyStop
            | Self::EndSwitch
            | Self::AmplifierNotReady
            | Self::EncoderStuck
            | Self::EncoderJump
            | Self::EncoderIllegal
            | Self::Polarity
            | Self::OverCurrent
            | Self::NotFinite => StopCategory::Zero,
            Self::TickLate
            | Self::Overload
            | Self::Saturated
            | Self::FollowingError
            | Self::SoftLimit
            | Self::OverSpeed
            | Self::HostSilent
            | Self::RecorderFailed
            | Self::HomingFailed => StopCategory::One,
        }
    }
}
