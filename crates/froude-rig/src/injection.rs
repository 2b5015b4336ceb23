//! What can be broken in the twin, and when.
//!
//! An [`Injection`] takes effect at a tick on an axis and stays.
//! [`crate::injection`].

use crate::amplifier::AmplifierFault;
use crate::encoder::EncoderFault;

/// One thing that breaks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Injection {
    /// The encoder or one of its lines fails.
    Encoder(EncoderFault),
    /// The counter jumps by so many counts.
    EncoderJump(i32),
    /// The amplifier fails.
    Amplifier(AmplifierFault),
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
