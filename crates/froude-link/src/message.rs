//! The two vocabularies: what the host says to the board and what the board says to the host.
//!
//! Hello keeps its place for all versions: kind, a magic number, the version. An end that reads another version than its own
//! learns that and nothing else. Everything that a host says, it says as one session ([`HostFrame`], [`crate::session`]).

use froude_control::config::Config;
use froude_control::request::Request;
use froude_control::tick::Tick;

use crate::VERSION;
use crate::codec::{Reader, Wire, Writer};
use crate::frame::{Body, BodyReader, Message};
use crate::session::NOBODY;
use crate::status::{Ack, BoardHello, Event, FaultReport, Health, LockStepReply, TimeReply, TurnedAway};
use crate::telemetry::Telemetry;

/// "FROU" in ASCII.
const MAGIC: u32 = u32::from_le_bytes(*b"FROU");

/// Host to board.
#[derive(Debug, Clone, Copy, PartialEq)]
#[allow(clippy::large_enum_variant)] // there is no heap to put the configuration on
pub enum ToBoard {
    /// The host is there, speaks this version and asks for the board. Answered by [`FromBoard::Hello`] with its session when it has
    /// the board, as often as it asks, and by [`FromBoard::TurnedAway`] when another session has it.
    Hello,
    /// The host speaks another version.
    ForeignHello {
        /// Its version.
        version: u16,
    },
    /// Do this. Answered by [`FromBoard::Ack`]; repeat with the same `id` when no answer comes. A stop is obeyed from every
    /// session, also from [`NOBODY`]; anything else only from the one that has the board.
    Request {
        /// Number by which the answer is known, not 0.
        id: u16,
        /// What to do.
        request: Request,
    },
    /// Be configured so. Only while both axes are disabled.
    Configure {
        /// Number by which the answer is known, not 0.
        id: u16,
        /// The configuration.
        config: Config,
    },
    /// The host is still there.
    Heartbeat,
    /// What time is it?
    TimeRequest {
        /// The host's clock, µs; given back unread.
        host_sent_us: u64,
    },
    /// Step the controller with these inputs instead of the board's own: for the test of the board against the host.
    LockStep {
        /// Number of the tick; a repetition is answered again and not stepped again.
        number: u32,
        /// The inputs.
        tick: Tick,
    },
}

/// A frame of a host: what it says, and which session it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HostFrame {
    /// The session, drawn when the host starts; [`NOBODY`] can stop and do nothing else.
    pub session: u32,
    /// What it says.
    pub says: ToBoard,
}

impl ToBoard {
    /// This, said by a session.
    #[must_use]
    pub const fn from_session(self, session: u32) -> HostFrame {
        HostFrame { session, says: self }
    }
}

/// Board to host.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FromBoard {
    /// Who the board is.
    Hello(BoardHello),
    /// The board speaks another version.
    ForeignHello {
        /// Its version.
        version: u16,
    },
    /// A tick.
    Telemetry(Telemetry),
    /// Something happened.
    Event(Event),
    /// A fault was latched.
    Fault(FaultReport),
    /// Answer to a request or a configuration.
    Ack(Ack),
    /// How board and link are.
    Health(Health),
    /// Answer to a clock request.
    TimeReply(TimeReply),
    /// Answer to a lock-step tick.
    LockStep(LockStepReply),
    /// A host that does not have the board was not heard.
    TurnedAway(TurnedAway),
}

fn put_hello(to: &mut Writer<'_>, version: u16) {
    MAGIC.put(to);
    version.put(to);
}

/// The version of a hello, if it is one of ours.
fn take_hello(from: &mut Reader<'_>) -> Option<u16> {
    (u32::take(from)? == MAGIC).then_some(())?;
    u16::take(from)
}

/// Swallows the rest of a hello that this version cannot read.
fn skip(from: &mut Reader<'_>) {
    while u8::take(from).is_some() {}
}

impl Message for HostFrame {
    fn kind(&self) -> u8 {
        match self.says {
            ToBoard::Hello | ToBoard::ForeignHello { .. } => 0x80,
            ToBoard::Request { .. } => 0x81,
            ToBoard::Configure { .. } => 0x82,
            ToBoard::Heartbeat => 0x83,
            ToBoard::TimeRequest { .. } => 0x84,
            ToBoard::LockStep { .. } => 0x85,
        }
    }

    fn write_body(&self, Body(to): &mut Body<'_, '_>) {
        match &self.says {
            ToBoard::Hello => put_hello(to, VERSION),
            ToBoard::ForeignHello { version } => return put_hello(to, *version),
            _ => {}
        }
        self.session.put(to);
        match &self.says {
            ToBoard::Hello | ToBoard::ForeignHello { .. } | ToBoard::Heartbeat => {}
            ToBoard::Request { id, request } => {
                id.put(to);
                request.put(to);
            }
            ToBoard::Configure { id, config } => {
                id.put(to);
                config.put(to);
            }
            ToBoard::TimeRequest { host_sent_us } => host_sent_us.put(to),
            ToBoard::LockStep { number, tick } => {
                number.put(to);
                tick.put(to);
            }
        }
    }

    fn read_body(kind: u8, BodyReader(from): &mut BodyReader<'_, '_>) -> Option<Self> {
        if kind == 0x80 {
            let version = take_hello(from)?;
            if version != VERSION {
                skip(from);
                return Some(ToBoard::ForeignHello { version }.from_session(NOBODY));
            }
        }
        let session = Wire::take(from)?;
        let says = match kind {
            0x80 => ToBoard::Hello,
            0x81 => ToBoard::Request { id: Wire::take(from)?, request: Wire::take(from)? },
            0x82 => ToBoard::Configure { id: Wire::take(from)?, config: Wire::take(from)? },
            0x83 => ToBoard::Heartbeat,
            0x84 => ToBoard::TimeRequest { host_sent_us: Wire::take(from)? },
            0x85 => ToBoard::LockStep { number: Wire::take(from)?, tick: Wire::take(from)? },
            _ => return None,
        };
        Some(says.from_session(session))
    }
}

impl Message for FromBoard {
    fn kind(&self) -> u8 {
        match self {
            Self::Hello(_) | Self::ForeignHello { .. } => 0x01,
            Self::Telemetry(_) => 0x02,
            Self::Event(_) => 0x03,
            Self::Fault(_) => 0x04,
            Self::Ack(_) => 0x05,
            Self::Health(_) => 0x06,
            Self::TimeReply(_) => 0x07,
            Self::LockStep(_) => 0x08,
            Self::TurnedAway(_) => 0x09,
        }
    }

    fn write_body(&self, Body(to): &mut Body<'_, '_>) {
        match self {
            Self::Hello(hello) => {
                put_hello(to, VERSION);
                hello.put(to);
            }
            Self::ForeignHello { version } => put_hello(to, *version),
            Self::Telemetry(telemetry) => telemetry.put(to),
            Self::Event(event) => event.put(to),
            Self::Fault(report) => report.put(to),
            Self::Ack(ack) => ack.put(to),
            Self::Health(health) => health.put(to),
            Self::TimeReply(reply) => reply.put(to),
            Self::LockStep(reply) => reply.put(to),
            Self::TurnedAway(turned_away) => turned_away.put(to),
        }
    }

    fn read_body(kind: u8, BodyReader(from): &mut BodyReader<'_, '_>) -> Option<Self> {
        Some(match kind {
            0x01 => match take_hello(from)? {
                VERSION => Self::Hello(Wire::take(from)?),
                version => {
                    skip(from);
                    Self::ForeignHello { version }
                }
            },
            0x02 => Self::Telemetry(Wire::take(from)?),
            0x03 => Self::Event(Wire::take(from)?),
            0x04 => Self::Fault(Wire::take(from)?),
            0x05 => Self::Ack(Wire::take(from)?),
            0x06 => Self::Health(Wire::take(from)?),
            0x07 => Self::TimeReply(Wire::take(from)?),
            0x08 => Self::LockStep(Wire::take(from)?),
            0x09 => Self::TurnedAway(Wire::take(from)?),
            _ => return None,
        })
    }
}
