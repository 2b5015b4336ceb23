//! What the board reports about itself besides telemetry: who it is, what happened, how the link is.

use froude_control::fault::{Fault, StopCategory};
use froude_control::status::{Phase, Refusal};
use froude_control::tick::{AXES, Command};

use crate::codec::{Reader, Wire, Writer, wire_code, wire_struct};

/// Kinds of board.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum BoardId {
    /// The emulated Cortex-A8 (realview-pb-a8).
    Realview = 1,
    /// BeagleBone Black (AM335x).
    Am335x = 2,
    /// A program on the host.
    Twin = 3,
}
wire_code!(BoardId { Realview, Am335x, Twin });

/// Who the board is and how its counts are read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoardHello {
    /// Kind of board.
    pub board: BoardId,
    /// Drawn anew at every power-up where the board can; a change means that it restarted.
    pub boot: u32,
    /// Baud rate of the line.
    pub baud: u32,
    /// Telemetry is sent every so many ticks.
    pub telemetry_every: u16,
    /// Tick, µs.
    pub tick_us: u32,
    /// Volts of a DAC count, per axis.
    pub command_v_per_count: [f64; AXES],
    /// Amperes of an ADC count, per axis.
    pub current_a_per_count: [f64; AXES],
    /// It has a configuration.
    pub is_configured: bool,
    /// The last stop of the processor was the hardware watchdog's.
    pub was_watchdog_reset: bool,
    /// The session that has the board; [`crate::session::NOBODY`] in the hello that the board says by itself when it starts.
    pub session: u32,
}
wire_struct!(BoardHello {
    board,
    boot,
    baud,
    telemetry_every,
    tick_us,
    command_v_per_count,
    current_a_per_count,
    is_configured,
    was_watchdog_reset,
    session,
});

/// What became of a request or a configuration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Carried out at the tick that the acknowledgement names.
    Accepted,
    /// The controller refused it.
    Refused(Refusal),
    /// The board has no configuration yet.
    NotConfigured,
    /// A configuration does not hold together.
    BadConfiguration,
    /// A configuration is only taken while both axes are disabled.
    NotNow,
}

impl Wire for Verdict {
    fn put(&self, to: &mut Writer<'_>) {
        match self {
            Self::Accepted => 0,
            Self::Refused(refusal) => *refusal as u8,
            Self::NotConfigured => 0x81,
            Self::BadConfiguration => 0x82,
            Self::NotNow => 0x83,
        }
        .put(to);
    }
    fn take(from: &mut Reader<'_>) -> Option<Self> {
        Some(match u8::take(from)? {
            0 => Self::Accepted,
            0x81 => Self::NotConfigured,
            0x82 => Self::BadConfiguration,
            0x83 => Self::NotNow,
            code => Self::Refused(Refusal::take(&mut Reader::new(&[code]))?),
        })
    }
}

/// Answer to a request or a configuration. A request repeated with the same `id` is answered again and not carried out again.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Ack {
    /// Whose request it was: the numbers of two hosts may be the same.
    pub session: u32,
    /// Number that the host gave.
    pub id: u16,
    /// Tick at which it was decided; wraps at 2³².
    pub tick: u32,
    /// What was decided.
    pub verdict: Verdict,
}
wire_struct!(Ack { session, id, tick, verdict });

/// A fault was latched.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FaultReport {
    /// Tick; wraps at 2³².
    pub tick: u32,
    /// When its inputs were latched, µs.
    pub latched_us: u32,
    /// Which.
    pub fault: Fault,
    /// Whose (`AXES`: of no axis).
    pub axis: u8,
    /// How the carriage is stopped.
    pub category: StopCategory,
}
wire_struct!(FaultReport { tick, latched_us, fault, axis, category });

/// Something happened at a tick.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Event {
    /// Tick; wraps at 2³².
    pub tick: u32,
    /// When its inputs were latched, µs.
    pub latched_us: u32,
    /// What.
    pub kind: EventKind,
}
wire_struct!(Event { tick, latched_us, kind });

/// What happened.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EventKind {
    /// An axis began to do something else.
    Phase {
        /// Axis.
        axis: u8,
        /// What it does now.
        phase: Phase,
    },
    /// A latched fault was cleared.
    Cleared(Fault),
    /// A tick took longer than its period; so many ticks were skipped.
    Overrun(u16),
    /// The host says other things than this version knows.
    VersionMismatch(u16),
}

impl Wire for EventKind {
    fn put(&self, to: &mut Writer<'_>) {
        match self {
            Self::Phase { axis, phase } => {
                1_u8.put(to);
                axis.put(to);
                phase.put(to);
            }
            Self::Cleared(fault) => {
                2_u8.put(to);
                fault.put(to);
            }
            Self::Overrun(ticks) => {
                3_u8.put(to);
                ticks.put(to);
            }
            Self::VersionMismatch(version) => {
                4_u8.put(to);
                version.put(to);
            }
        }
    }
    fn take(from: &mut Reader<'_>) -> Option<Self> {
        Some(match u8::take(from)? {
            1 => Self::Phase { axis: Wire::take(from)?, phase: Wire::take(from)? },
            2 => Self::Cleared(Wire::take(from)?),
            3 => Self::Overrun(Wire::take(from)?),
            4 => Self::VersionMismatch(Wire::take(from)?),
            _ => return None,
        })
    }
}

/// How board and link are, once a second and on every hello.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Health {
    /// Tick; wraps at 2³².
    pub tick: u32,
    /// Telemetry frames that did not fit in the ring.
    pub telemetry_lost: u32,
    /// Ticks that took longer than their period.
    pub overruns: u32,
    /// Longest time from the tick to its command, µs.
    pub worst_step_us: u32,
    /// Bytes that the serial port could not keep.
    pub port_overflows: u32,
    /// Pieces on the line that were no frame.
    pub corrupt: u32,
    /// Frames of the host that never came.
    pub lost: u32,
    /// Frames of the host that came late.
    pub late: u32,
    /// Frames of the host that came again.
    pub duplicates: u32,
}
wire_struct!(Health { tick, telemetry_lost, overruns, worst_step_us, port_overflows, corrupt, lost, late, duplicates });

/// Answer to a clock request.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TimeReply {
    /// Who asked: the stamps of two hosts do not belong together.
    pub session: u32,
    /// The host's own stamp, given back.
    pub host_sent_us: u64,
    /// When the request had arrived, µs of the board; wraps.
    pub board_received_us: u32,
    /// When this answer was written, µs of the board; wraps.
    pub board_sent_us: u32,
}
wire_struct!(TimeReply { session, host_sent_us, board_received_us, board_sent_us });

/// Answer to a lock-step tick: what the controller commanded, to the last bit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LockStepReply {
    /// Whose tick it was.
    pub session: u32,
    /// Number of the tick that it answers.
    pub number: u32,
    /// The commands.
    pub command: Command,
    /// Reference positions, m.
    pub reference_m: [f64; AXES],
    /// Positions, m.
    pub position_m: [f64; AXES],
    /// What the axes do.
    pub phases: [Phase; AXES],
    /// The latched fault.
    pub fault: Option<Fault>,
    /// Why the tick's request was refused.
    pub refusal: Option<Refusal>,
}
wire_struct!(LockStepReply { session, number, command, reference_m, position_m, phases, fault, refusal });

/// A host asked for something that only the session that has the board may ask for. Said at most a hundred times a second,
/// about the last one that asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TurnedAway {
    /// Who asked.
    pub session: u32,
    /// The session that has the board; [`crate::session::NOBODY`] when nobody has: a hello takes it then.
    pub holder: u32,
    /// Frames heard from it so far; wraps. When they become more, it lives.
    pub holder_frames: u32,
    /// Silent for so long more, it loses the board, µs.
    pub free_in_us: u32,
}
wire_struct!(TurnedAway { session, holder, holder_frames, free_in_us });
