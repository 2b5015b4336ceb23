//! What the board reports of a tick: raw counts where there are any, quantised references where there are none.
//!
//! A frame is 59 bytes on the wire, so that 3 Mbaud carry all 4000 of a second. Counts are not converted on the board: the
//! host knows the scales from the board's hello and can convert again when a calibration changes.
//!
//! | field | step | range |
//! | --- | --- | --- |
//! | reference position | 0.1 µm (an encoder count is 2.5 µm of chain) | ± 214 m |
//! | reference velocity | 10 nm/s | ± 21 m/s |
//! | reference acceleration | 1 mm/s² | ± 32 m/s² |
//!
//! Beyond its range a value saturates.

use froude_control::fault::Fault;
use froude_control::status::{Output, Phase};
use froude_control::tick::{AXES, AxisInput, Tick};

use crate::codec::{Reader, Wire, Writer};

/// Step of the reference position, m.
pub const POSITION_STEP_M: f64 = 1e-7;
/// Step of the reference velocity, m/s.
pub const VELOCITY_STEP_M_S: f64 = 1e-8;
/// Step of the reference acceleration, m/s².
pub const ACCELERATION_STEP_M_S2: f64 = 1e-3;

/// Bytes of the body: tick, time, fault, flags, and twenty for each axis.
pub const BODY_BYTES: usize = 4 + 4 + 1 + 1 + AXES * (4 + 1 + 2 + 2 + 4 + 4 + 2 + 1);

/// One axis at one tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AxisTelemetry {
    /// Hardware count of the decoder; wraps at 2³².
    pub encoder_count: u32,
    /// Low byte of the count of illegal transitions.
    pub encoder_errors: u8,
    /// Code sent to the DAC.
    pub command_counts: i16,
    /// Code read from the current's ADC.
    pub current_counts: i16,
    /// Reference position in [`POSITION_STEP_M`].
    pub reference_position: i32,
    /// Reference velocity in [`VELOCITY_STEP_M_S`].
    pub reference_velocity: i32,
    /// Reference acceleration in [`ACCELERATION_STEP_M_S2`].
    pub reference_acceleration: i16,
    /// What the axis is doing.
    pub phase: Phase,
    /// Its coordinate is known.
    pub is_homed: bool,
    /// The command was cut at the amplifier's range.
    pub is_saturated: bool,
    /// The amplifier is enabled.
    pub is_enabled: bool,
    /// The low end switch is open.
    pub is_low_end: bool,
    /// The high end switch is open.
    pub is_high_end: bool,
}

/// Both axes at one tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Telemetry {
    /// Tick since power-up; wraps at 2³² (12 days).
    pub tick: u32,
    /// When the inputs were latched, µs; wraps at 2³².
    pub latched_us: u32,
    /// The latched fault and its axis (`AXES`: of none).
    pub fault: Option<(Fault, u8)>,
    /// The emergency-stop chain is open.
    pub is_estop_open: bool,
    /// A frame came from the host since the tick before.
    pub is_host_heard: bool,
    /// Frames before this one did not fit in the board's ring.
    pub has_gap_before: bool,
    /// The tick before this one overran its period.
    pub is_after_overrun: bool,
    /// Which amplifiers are ready.
    pub are_amplifiers_ready: [bool; AXES],
    /// The axes.
    pub axes: [AxisTelemetry; AXES],
}

impl Telemetry {
    /// What is reported of a tick that was stepped, with the codes that the board read and wrote.
    #[must_use]
    pub fn of(tick: &Tick, output: &Output, command_counts: [i16; AXES], current_counts: [i16; AXES]) -> Self {
        let ([command_y, command_x], [current_y, current_x]) = (command_counts, current_counts);
        let [status_y, status_x] = &output.status.axes;
        let [enabled_y, enabled_x] = output.command.axes.map(|axis| axis.is_enabled);
        let [input_y, input_x] = &tick.axes;
        Self {
            tick: output.status.tick as u32,
            latched_us: tick.latched_us,
            fault: output.status.fault,
            is_estop_open: tick.is_estop_open,
            is_host_heard: tick.is_host_heard,
            has_gap_before: false,
            is_after_overrun: false,
            are_amplifiers_ready: [input_y.is_amplifier_ready, input_x.is_amplifier_ready],
            axes: [
                AxisTelemetry::of(input_y, status_y, enabled_y, command_y, current_y),
                AxisTelemetry::of(input_x, status_x, enabled_x, command_x, current_x),
            ],
        }
    }
}

impl AxisTelemetry {
    fn of(
        input: &AxisInput,
        status: &froude_control::status::AxisStatus,
        is_enabled: bool,
        command_counts: i16,
        current_counts: i16,
    ) -> Self {
        Self {
            encoder_count: input.encoder_count,
            encoder_errors: input.encoder_errors as u8,
            command_counts,
            current_counts,
            reference_position: nearest(status.reference_m * (1.0 / POSITION_STEP_M)),
            reference_velocity: nearest(status.reference_m_s * (1.0 / VELOCITY_STEP_M_S)),
            reference_acceleration: nearest(status.reference_m_s2 * (1.0 / ACCELERATION_STEP_M_S2))
                .clamp(i32::from(i16::MIN), i32::from(i16::MAX)) as i16,
            phase: status.phase,
            is_homed: status.is_homed,
            is_saturated: status.is_saturated,
            is_enabled,
            is_low_end: input.is_low_end,
            is_high_end: input.is_high_end,
        }
    }

    /// Reference position, m.
    #[must_use]
    pub fn reference_position_m(&self) -> f64 {
        f64::from(self.reference_position) * POSITION_STEP_M
    }

    /// Reference velocity, m/s.
    #[must_use]
    pub fn reference_velocity_m_s(&self) -> f64 {
        f64::from(self.reference_velocity) * VELOCITY_STEP_M_S
    }

    /// Reference acceleration, m/s².
    #[must_use]
    pub fn reference_acceleration_m_s2(&self) -> f64 {
        f64::from(self.reference_acceleration) * ACCELERATION_STEP_M_S2
    }
}

/// Nearest whole number, halves away from zero; saturates, and NaN is 0.
fn nearest(value: f64) -> i32 {
    (value + if value < 0.0 { -0.5 } else { 0.5 }) as i32
}

/// Bit k of a byte from the k-th flag.
fn pack(flags: [bool; 8]) -> u8 {
    flags.iter().rev().fold(0, |byte, &flag| byte << 1 | u8::from(flag))
}

fn bit(byte: u8, k: u8) -> bool {
    (byte >> (k & 7)) & 1 == 1
}

impl Wire for AxisTelemetry {
    fn put(&self, to: &mut Writer<'_>) {
        let phase = self.phase as u8;
        let flags = [
            bit(phase, 0),
            bit(phase, 1),
            bit(phase, 2),
            self.is_homed,
            self.is_saturated,
            self.is_enabled,
            self.is_low_end,
            self.is_high_end,
        ];
        self.encoder_count.put(to);
        self.encoder_errors.put(to);
        self.command_counts.put(to);
        self.current_counts.put(to);
        self.reference_position.put(to);
        self.reference_velocity.put(to);
        self.reference_acceleration.put(to);
        pack(flags).put(to);
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let mut axis = Self {
            encoder_count: Wire::take(from)?,
            encoder_errors: Wire::take(from)?,
            command_counts: Wire::take(from)?,
            current_counts: Wire::take(from)?,
            reference_position: Wire::take(from)?,
            reference_velocity: Wire::take(from)?,
            reference_acceleration: Wire::take(from)?,
            ..Self::default()
        };
        let flags = u8::take(from)?;
        axis.phase = Phase::take(&mut Reader::new(&[flags & 7]))?;
        axis.is_homed = bit(flags, 3);
        axis.is_saturated = bit(flags, 4);
        axis.is_enabled = bit(flags, 5);
        axis.is_low_end = bit(flags, 6);
        axis.is_high_end = bit(flags, 7);
        Some(axis)
    }
}

impl Wire for Telemetry {
    fn put(&self, to: &mut Writer<'_>) {
        let (code, axis) = self.fault.map_or((0, 0), |(fault, axis)| (fault as u8, axis));
        let [ready_y, ready_x] = self.are_amplifiers_ready;
        let flags = [
            bit(axis, 0),
            bit(axis, 1),
            self.is_estop_open,
            self.is_host_heard,
            self.has_gap_before,
            self.is_after_overrun,
            ready_y,
            ready_x,
        ];
        self.tick.put(to);
        self.latched_us.put(to);
        code.put(to);
        pack(flags).put(to);
        self.axes.put(to);
    }

    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let (tick, latched_us) = (u32::take(from)?, u32::take(from)?);
        let (code, flags) = (u8::take(from)?, u8::take(from)?);
        let fault = match code {
            0 => None,
            code => Some((Fault::take(&mut Reader::new(&[code]))?, flags & 3)),
        };
        Some(Self {
            tick,
            latched_us,
            fault,
            is_estop_open: bit(flags, 2),
            is_host_heard: bit(flags, 3),
            has_gap_before: bit(flags, 4),
            is_after_overrun: bit(flags, 5),
            are_amplifiers_ready: [bit(flags, 6), bit(flags, 7)],
            axes: Wire::take(from)?,
        })
    }
}
