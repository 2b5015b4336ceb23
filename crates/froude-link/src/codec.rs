//! Fixed layouts: little endian, floats as their bits, an enumeration as one byte.
//!
//! The structures of `froude-control` are taken apart field by field, so a field added there does not compile here until it has a
//! place on the wire (and the protocol a new version).

use froude_control::config::{AxisConfig, Config, Drive, Gains, Limits};
use froude_control::fault::{Fault, StopCategory};
use froude_control::request::{Excitation, Move, Request};
use froude_control::status::{Phase, Refusal};
use froude_control::tick::{AxisCommand, AxisInput, Command, Tick};

/// Writes into a slice; what does not fit is dropped and remembered.
pub struct Writer<'a> {
    bytes: &'a mut [u8],
    len: usize,
    fits: bool,
}

impl<'a> Writer<'a> {
    pub fn new(bytes: &'a mut [u8]) -> Self {
        Self { bytes, len: 0, fits: true }
    }

    pub fn bytes<const N: usize>(&mut self, value: [u8; N]) {
        for byte in value {
            match self.bytes.get_mut(self.len) {
                Some(place) => *place = byte,
                None => self.fits = false,
            }
            self.len = self.len.wrapping_add(1);
        }
    }

    /// What was written, or nothing if it did not fit.
    pub fn finish(self) -> Option<&'a [u8]> {
        let Self { bytes, len, fits } = self;
        if fits { bytes.get(..len) } else { None }
    }
}

/// Reads from a slice; past its end there is nothing.
pub struct Reader<'a> {
    bytes: &'a [u8],
}

impl<'a> Reader<'a> {
    pub const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes }
    }

    pub fn bytes<const N: usize>(&mut self) -> Option<[u8; N]> {
        let (first, rest) = self.bytes.split_first_chunk::<N>()?;
        self.bytes = rest;
        Some(*first)
    }

    pub const fn is_empty(&self) -> bool {
        self.bytes.is_empty()
    }
}

/// A value with a fixed layout.
pub trait Wire: Sized {
    fn put(&self, to: &mut Writer<'_>);
    fn take(from: &mut Reader<'_>) -> Option<Self>;
}

macro_rules! wire_number {
    ($($number:ty),*) => {$(
        impl Wire for $number {
            fn put(&self, to: &mut Writer<'_>) {
                to.bytes(self.to_le_bytes());
            }
            fn take(from: &mut Reader<'_>) -> Option<Self> {
                from.bytes().map(<$number>::from_le_bytes)
            }
        }
    )*};
}
wire_number!(u8, u16, u32, u64, i16, i32, i64);

impl Wire for f64 {
    fn put(&self, to: &mut Writer<'_>) {
        self.to_bits().put(to);
    }
    fn take(from: &mut Reader<'_>) -> Option<Self> {
        u64::take(from).map(Self::from_bits)
    }
}

impl Wire for bool {
    fn put(&self, to: &mut Writer<'_>) {
        u8::from(*self).put(to);
    }
    fn take(from: &mut Reader<'_>) -> Option<Self> {
        match u8::take(from)? {
            0 => Some(false),
            1 => Some(true),
            _ => None,
        }
    }
}

/// An axis is one byte; an axis that does not fit is one that does not exist.
impl Wire for usize {
    fn put(&self, to: &mut Writer<'_>) {
        u8::try_from(*self).unwrap_or(u8::MAX).put(to);
    }
    fn take(from: &mut Reader<'_>) -> Option<Self> {
        u8::take(from).map(Self::from)
    }
}

impl<T: Wire> Wire for Option<T> {
    fn put(&self, to: &mut Writer<'_>) {
        self.is_some().put(to);
        if let Some(value) = self {
            value.put(to);
        }
    }
    fn take(from: &mut Reader<'_>) -> Option<Self> {
        if bool::take(from)? { T::take(from).map(Some) } else { Some(None) }
    }
}

/// One value per axis.
impl<T: Wire> Wire for [T; 2] {
    fn put(&self, to: &mut Writer<'_>) {
        let [y, x] = self;
        y.put(to);
        x.put(to);
    }
    fn take(from: &mut Reader<'_>) -> Option<Self> {
        Some([T::take(from)?, T::take(from)?])
    }
}

/// A structure, field after field.
macro_rules! wire_struct {
    ($name:ident { $($field:ident),* $(,)? }) => {
        impl $crate::codec::Wire for $name {
            fn put(&self, to: &mut $crate::codec::Writer<'_>) {
                let Self { $($field),* } = self;
                $($crate::codec::Wire::put($field, to);)*
            }
            fn take(from: &mut $crate::codec::Reader<'_>) -> Option<Self> {
                Some(Self { $($field: $crate::codec::Wire::take(from)?),* })
            }
        }
    };
}
pub(crate) use wire_struct;

/// An enumeration without fields whose bytes are its discriminants.
macro_rules! wire_code {
    ($name:ident { $($variant:ident),* $(,)? }) => {
        impl $crate::codec::Wire for $name {
            fn put(&self, to: &mut $crate::codec::Writer<'_>) {
                (*self as u8).put(to);
            }
            fn take(from: &mut $crate::codec::Reader<'_>) -> Option<Self> {
                let code = u8::take(from)?;
                $(if code == $name::$variant as u8 {
                    return Some($name::$variant);
                })*
                None
            }
        }
    };
}
pub(crate) use wire_code;

wire_code!(Fault {
    EmergencyStop,
    EndSwitch,
    AmplifierNotReady,
    EncoderStuck,
    EncoderJump,
    EncoderIllegal,
    Polarity,
    TickLate,
    OverCurrent,
    Overload,
    Saturated,
    FollowingError,
    SoftLimit,
    OverSpeed,
    HostSilent,
    RecorderFailed,
    NotFinite,
    HomingFailed,
});
wire_code!(Refusal {
    Faulted,
    Disabled,
    NotHomed,
    Busy,
    OutOfRange,
    BeyondTravel,
    NoSuchAxis,
    NotCleared,
    NotReady,
    EndSwitchOpen
});
wire_code!(Phase { Disabled, Holding, Moving, Homing, Exciting, Stopping, Coasting });
wire_code!(StopCategory { Zero, One, Two });

wire_struct!(Move { target_m, speed_m_s, acceleration_m_s2, jerk_m_s3, is_shaped });
wire_struct!(Gains { proportional_v_rad, derivative_v_s_rad, integral_v_rad_s, derivative_filter_hz });
wire_struct!(Drive {
    inertia_kg_m2,
    coast_inertia_kg_m2,
    viscous_n_m_s_rad,
    viscous_lower_n_m_s_rad,
    coulomb_n_m,
    coulomb_lower_n_m,
    held_band,
    drag_n_s2_m2,
    torque_constant_n_m_a,
    amplifier_a_v,
    gear_ratio,
    sprocket_radius_m,
    counts_per_revolution,
    encoder_sign,
});
wire_struct!(Limits {
    hard_low_m,
    hard_high_m,
    low_switch_m,
    high_switch_m,
    speed_m_s,
    unhomed_speed_m_s,
    acceleration_m_s2,
    command_v,
    current_a,
    continuous_current_a,
    thermal_time_s,
    following_error_m,
    saturation_s,
    encoder_errors_per_s,
    polarity_m,
    stuck_s,
});
wire_struct!(AxisConfig { gains, drive, limits, mode_hz, mode_damping, is_robust_shaper });
wire_struct!(Config { axes, tick_us, late_us, host_silence_us });
wire_struct!(AxisInput { encoder_count, encoder_errors, current_a, is_low_end, is_high_end, is_amplifier_ready });
wire_struct!(Tick { latched_us, axes, is_estop_open, is_host_heard, request });
wire_struct!(AxisCommand { volts, is_enabled });
wire_struct!(Command { axes });

impl Wire for Excitation {
    fn put(&self, to: &mut Writer<'_>) {
        match self {
            Self::Pulses { volts, period_s, duty, duration_s } => {
                1_u8.put(to);
                [*volts, *period_s].put(to);
                [*duty, *duration_s].put(to);
            }
            Self::Relay { volts, hysteresis_m, duration_s } => {
                2_u8.put(to);
                [*volts, *hysteresis_m].put(to);
                duration_s.put(to);
            }
            Self::Sweep { volts, from_hz, to_hz, duration_s, speed_m_s } => {
                3_u8.put(to);
                volts.put(to);
                [*from_hz, *to_hz].put(to);
                [*duration_s, *speed_m_s].put(to);
            }
            Self::Jog { volts, distance_m, duration_s } => {
                4_u8.put(to);
                [*volts, *distance_m].put(to);
                duration_s.put(to);
            }
        }
    }
    fn take(from: &mut Reader<'_>) -> Option<Self> {
        let kind = u8::take(from)?;
        let mut next = || f64::take(from);
        Some(match kind {
            1 => Self::Pulses { volts: next()?, period_s: next()?, duty: next()?, duration_s: next()? },
            2 => Self::Relay { volts: next()?, hysteresis_m: next()?, duration_s: next()? },
            3 => Self::Sweep {
                volts: next()?,
                from_hz: next()?,
                to_hz: next()?,
                duration_s: next()?,
                speed_m_s: next()?,
            },
            4 => Self::Jog { volts: next()?, distance_m: next()?, duration_s: next()? },
            _ => return None,
        })
    }
}

impl Wire for Request {
    fn put(&self, to: &mut Writer<'_>) {
        match self {
            Self::Enable { axis } => {
                1_u8.put(to);
                axis.put(to);
            }
            Self::Disable { axis } => {
                2_u8.put(to);
                axis.put(to);
            }
            Self::Home { axis } => {
                3_u8.put(to);
                axis.put(to);
            }
            Self::Move { axis, profile } => {
                4_u8.put(to);
                axis.put(to);
                profile.put(to);
            }
            Self::Excite { axis, excitation } => {
                5_u8.put(to);
                axis.put(to);
                excitation.put(to);
            }
            Self::Stop(category) => {
                6_u8.put(to);
                category.put(to);
            }
            Self::RecorderFailed => 7_u8.put(to),
            Self::Clear(fault) => {
                8_u8.put(to);
                fault.put(to);
            }
        }
    }
    fn take(from: &mut Reader<'_>) -> Option<Self> {
        Some(match u8::take(from)? {
            1 => Self::Enable { axis: Wire::take(from)? },
            2 => Self::Disable { axis: Wire::take(from)? },
            3 => Self::Home { axis: Wire::take(from)? },
            4 => Self::Move { axis: Wire::take(from)?, profile: Wire::take(from)? },
            5 => Self::Excite { axis: Wire::take(from)?, excitation: Wire::take(from)? },
            6 => Self::Stop(Wire::take(from)?),
            7 => Self::RecorderFailed,
            8 => Self::Clear(Wire::take(from)?),
            _ => return None,
        })
    }
}

#[cfg(test)]
mod tests {
    extern crate std;
    use super::{Fault, Phase, Reader, Refusal, Wire};
    use std::format;
    use std::vec::Vec;

    /// `Name = code,` of an enumeration, out of its source: it may grow there without the compiler telling us here.
    fn codes(source: &str, enumeration: &str) -> Vec<(std::string::String, u8)> {
        let body = source.split(&format!("pub enum {enumeration} {{")).nth(1).unwrap().split("\n}").next().unwrap();
        let lines = body.lines().filter_map(|line| line.trim().trim_end_matches(',').split_once(" = "));
        lines.map(|(name, code)| (name.into(), code.parse().unwrap())).collect()
    }

    #[test]
    fn every_code_of_control_has_its_place_on_the_wire() {
        let faults = codes(include_str!("../../froude-control/src/fault.rs"), "Fault");
        let status = include_str!("../../froude-control/src/status.rs");
        let (refusals, phases) = (codes(status, "Refusal"), codes(status, "Phase"));
        assert!(faults.len() >= 18 && refusals.len() >= 10 && phases.len() >= 7);
        for (name, code) in faults {
            assert_eq!(format!("{:?}", Fault::take(&mut Reader::new(&[code])).unwrap()), name);
        }
        for (name, code) in refusals {
            assert_eq!(format!("{:?}", Refusal::take(&mut Reader::new(&[code])).unwrap()), name);
        }
        for (name, code) in phases {
            assert_eq!(format!("{:?}", Phase::take(&mut Reader::new(&[code])).unwrap()), name);
        }
    }
}
