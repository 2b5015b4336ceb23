//! What the controller is given each tick, and what it gives back.

use crate::request::Request;

/// Axes of the carriage: 0 is the long axis `y`, 1 the short axis `x`.
pub const AXES: usize = 2;

/// Inputs of one axis, latched together at the tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AxisInput {
    /// Hardware count of the quadrature decoder; wraps at 2³².
    pub encoder_count: u32,
    /// Illegal transitions (both lines changed at once) that the decoder has seen since it started; wraps.
    pub encoder_errors: u32,
    /// Motor current that the amplifier reports, A.
    pub current_a: f64,
    /// The end switch at the low end of travel is open (pressed, or its wire broken).
    pub is_low_end: bool,
    /// The end switch at the high end of travel is open.
    pub is_high_end: bool,
    /// The amplifier says that it is ready.
    pub is_amplifier_ready: bool,
}

/// Everything that the controller learns at one tick. Time comes with the data.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Tick {
    /// Time at which the inputs were latched, µs of the board's own clock; wraps at 2³² (71.6 min).
    pub latched_us: u32,
    /// The axes' inputs.
    pub axes: [AxisInput; AXES],
    /// The emergency-stop chain is open. The drive is already cut by hardware.
    pub is_estop_open: bool,
    /// A valid frame came from the host since the last tick.
    pub is_host_heard: bool,
    /// A request that came with it.
    pub request: Option<Request>,
}

/// Output of one axis.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AxisCommand {
    /// Drive command v_c, V, always finite and within the amplifier's range.
    pub volts: f64,
    /// Whether the amplifier is enabled; a disabled axis has no torque and coasts.
    pub is_enabled: bool,
}

/// What goes to the amplifiers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Command {
    /// The axes' outputs.
    pub axes: [AxisCommand; AXES],
}
