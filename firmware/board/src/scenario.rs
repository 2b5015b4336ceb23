//! A story that leads the controller through its states: the same ticks on every machine, for cost and for bit equality.
//!
//! Five chapters of 6 s. In each both axes are enabled, homed and moved (shaped, and with limited jerk), a request comes at the
//! wrong moment, a move is stopped half way, an axis is excited (each kind of signal in turn), moved back, and then something
//! breaks: an encoder jumps, the emergency stop opens, a tick is late, the host falls silent, an amplifier fails.

use froude_control::fault::{Fault, StopCategory};
use froude_control::request::{Excitation, Move, Request};
use froude_control::status::Output;
use froude_control::tick::Tick;

use crate::rig::Rig;

/// Ticks of a chapter.
pub const CHAPTER: u32 = 24_000;
/// Ticks of the whole story.
pub const TICKS: u32 = 5 * CHAPTER;

/// The tick of a chapter at which something breaks.
const BREAK: u32 = 16_500;

/// The story so far.
#[derive(Debug, Clone, Copy)]
pub struct Scenario {
    rig: Rig,
    number: u32,
    latched_us: u32,
    slip: u32,
    /// FNV-1a over the bits of every command and reference.
    pub hash: u64,
}

impl Default for Scenario {
    fn default() -> Self {
        // The clock wraps within the first second, the encoder's jump is still to come.
        Self {
            rig: Rig::default(),
            number: 0,
            latched_us: 0_u32.wrapping_sub(500_000),
            slip: 0,
            hash: 0xcbf2_9ce4_8422_2325,
        }
    }
}

impl Scenario {
    /// Number of the tick that comes next.
    #[must_use]
    pub const fn number(&self) -> u32 {
        self.number
    }

    /// The next tick's inputs.
    #[must_use]
    pub fn tick(&mut self) -> Tick {
        let (chapter, at) = (self.number / CHAPTER, self.number % CHAPTER);
        let is_broken = at >= BREAK;
        if at == BREAK && chapter == 0 {
            self.slip = self.slip.wrapping_add(5_000);
        }
        self.latched_us = self.latched_us.wrapping_add(if at == BREAK && chapter == 2 { 3_000 } else { 250 });
        let [mut y, x] = self.rig.axes.map(|axis| axis.input());
        y.encoder_count = y.encoder_count.wrapping_add(self.slip);
        y.is_amplifier_ready = !(is_broken && chapter == 4);
        Tick {
            latched_us: self.latched_us,
            axes: [y, x],
            is_estop_open: is_broken && chapter == 1 && at < BREAK + 400,
            is_host_heard: !(is_broken && chapter == 3) && at % 40 == 0,
            request: request(chapter, at),
        }
    }

    /// What the controller made of it.
    pub fn follow(&mut self, output: &Output) {
        self.rig.step(&output.command);
        let commands = output.command.axes.iter().map(|axis| axis.volts.to_bits() ^ u64::from(axis.is_enabled));
        let references = output.status.axes.iter().map(|axis| axis.reference_m.to_bits());
        for word in commands.chain(references) {
            self.hash = (self.hash ^ word).wrapping_mul(0x0100_0000_01b3);
        }
        self.number = self.number.wrapping_add(1);
    }
}

fn request(chapter: u32, at: u32) -> Option<Request> {
    let go = |axis, target_m, jerk_m_s3| {
        let profile = Move { target_m, speed_m_s: 0.4, acceleration_m_s2: 0.9, jerk_m_s3, is_shaped: true };
        Some(Request::Move { axis, profile })
    };
    match at {
        0 => match chapter {
            1 => Some(Request::Clear(Fault::EncoderJump)),
            2 => Some(Request::Clear(Fault::EmergencyStop)),
            3 => Some(Request::Clear(Fault::TickLate)),
            4 => Some(Request::Clear(Fault::HostSilent)),
            _ => None,
        },
        10 => Some(Request::Enable { axis: 0 }),
        12 => Some(Request::Enable { axis: 1 }),
        20 => Some(Request::Home { axis: 0 }),
        22 => Some(Request::Home { axis: 1 }),
        6_800 => go(0, 0.25, 0.0),
        6_804 => go(1, 0.2, 8.0),
        7_800 => go(0, 0.1, 0.0), // at the wrong moment
        8_200 => Some(Request::Stop(StopCategory::Two)),
        10_800 => Some(Request::Excite { axis: 0, excitation: excitation(chapter) }),
        11_200 => go(1, 0.05, 0.0),
        13_800 => go(0, 0.03, 20.0),
        16_200 => go(1, 0.09, 8.0), // under way when something breaks
        _ => None,
    }
}

const fn excitation(chapter: u32) -> Excitation {
    match chapter % 4 {
        0 => Excitation::Pulses { volts: 1.2, period_s: 0.2, duty: 0.6, duration_s: 0.5 },
        1 => Excitation::Relay { volts: 1.0, hysteresis_m: 1e-4, duration_s: 0.5 },
        2 => Excitation::Sweep { volts: 0.5, from_hz: 2.0, to_hz: 60.0, duration_s: 0.5, speed_m_s: 0.05 },
        _ => Excitation::Jog { volts: 0.8, distance_m: 0.005, duration_s: 0.5 },
    }
}
