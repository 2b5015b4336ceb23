//! What can be broken in the twin, and when.
//!
//! An [`Injection`] takes effect at a tick on an axis and stays.
//! [`crate::injection`].

/// One thing that breaks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Injection {
    /// Both encoder lines die.
    EncoderSilent,
    /// One encoder line dies: the count toggles.
    EncoderStuck,
    /// The counter jumps by so many counts.
    EncoderJump(i32),
    /// Illegal transitions, so many a second.
    EncoderFlips(u32),
    /// The encoder counts the other way.
    EncoderReversed,
    /// The amplifier switches itself off and is no longer ready.
    AmplifierOff,
    /// The amplifier gives its peak current while enabled.
    CurrentRunaway,
    /// The emergency-stop chain opens; hardware cuts the drive.
    EmergencyStop,
    /// The low end switch or its wire opens.
    LowEndSwitch,
    /// The high one.
    HighEndSwitch,
    /// This tick comes so many microseconds late.
    TickLate(u32),
    /// The host says nothing more.
    HostSilent,
    /// The current monitor reads NaN.
    NotFiniteCurrent,
    /// Friction of the load grows by so many newtons.
    FrictionJam(f64),
    /// K_T falls to this part of itself.
    TorqueLoss(f64),
    /// The chain breaks.
    ChainBreak,
}

/// An injection with its place and time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scheduled {
    /// Tick from which it acts ([`crate::Twin::ticks`]).
    pub tick: u64,
    /// Axis; those that belong to none ignore it.
    pub axis: usize,
    /// What.
    pub injection: Injection,
}
