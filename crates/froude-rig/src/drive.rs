//! A rig that can be driven: the twin or the real one behind the same few calls.
//!
//! [`Rig::tick`] hands over one request, if there is one, and gives back what the rig was at the end of the tick. Everything
//! that a campaign does is made of these ticks, so the campaign's code does not know which rig it drives.

use froude_control::fault::Fault;
use froude_control::request::Request;
use froude_control::status::{Phase, Refusal};
use froude_control::tick::AXES;

use crate::load::Load;
use crate::twin::Truth;

/// One axis at one tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct AxisSample {
    /// Unwrapped count since power-up.
    pub count: i64,
    /// Position, m.
    pub position_m: f64,
    /// Reference position, m.
    pub reference_m: f64,
    /// Reference speed, m/s.
    pub reference_m_s: f64,
    /// Reference acceleration, m/s².
    pub reference_m_s2: f64,
    /// Drive command v_c, V.
    pub command_v: f64,
    /// Motor current that the amplifier reports, A.
    pub current_a: f64,
    /// What the axis is doing.
    pub phase: Phase,
    /// Whether its coordinate is known.
    pub is_homed: bool,
}

/// The rig at one tick.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Sample {
    /// Ticks of the board since it began; ticks that were lost on the way are counted, so numbers may be missing.
    pub tick: u64,
    /// The axes.
    pub axes: [AxisSample; AXES],
    /// Force sensor on y, N, resistance to +y motion positive; `None` where there is none.
    pub force_n: Option<f64>,
    /// Latched fault and its axis.
    pub fault: Option<(Fault, u8)>,
    /// Why the last request was refused.
    pub refusal: Option<Refusal>,
    /// What another host on the line came to.
    pub stranger: Option<Stranger>,
    /// What no sensor shows; only a twin knows.
    pub truth: Option<[Truth; AXES]>,
}

/// What another host on the line came to; the number is its session.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stranger {
    /// It asked the board for something and was turned away; reported once of each session.
    TurnedAway(u32),
    /// It asked for a stop, which the board obeys whoever asks.
    Stopped(u32),
}

/// Why a rig cannot be driven on.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RigError {
    /// The board sent nothing for too long.
    #[error(
        "the board at {port} has sent no valid frame for {silent_s:.1} s; its own watchdog stops the carriage. Check power and \
         cable, then run again: the campaign resumes where it stopped"
    )]
    Silent {
        /// The port.
        port: String,
        /// How long.
        silent_s: f64,
    },
    /// The port failed.
    #[error("{port}: {reason}; the board's own watchdog stops the carriage")]
    Port {
        /// The port.
        port: String,
        /// What the system said.
        reason: String,
    },
    /// The board speaks another version.
    #[error(
        "the board at {port} speaks version {board} of the protocol, this program {ours}; flash the matching firmware"
    )]
    Version {
        /// The port.
        port: String,
        /// The board's.
        board: String,
        /// Ours.
        ours: String,
    },
    /// Another program has the port.
    #[error(
        "{port} is in use by another program, and only one may drive a board; end that one (`fuser {port}` names it), then run again"
    )]
    InUse {
        /// The port.
        port: String,
    },
    /// Another session has the board and lives.
    #[error(
        "the board at {port} is being driven by another program (session {holder:08x}), which is alive; nothing was asked of it but \
         whether it is free. End that program, then run again"
    )]
    Held {
        /// The port.
        port: String,
        /// Who has it.
        holder: u32,
    },
    /// Another session took the board over.
    #[error(
        "the board at {port} is driven by another program now (session {holder:08x}): this one was silent for longer than the board \
         waits (suspended?), and the board had stopped the carriage before. End that program, then run again: the campaign resumes where it \
         stopped"
    )]
    TakenOver {
        /// The port.
        port: String,
        /// Who has it.
        holder: u32,
    },
    /// The board does not know this session any more, nor any other.
    #[error(
        "the board at {port} has restarted: the torque is off, and the axes are no longer homed. Check its supply and what its hardware \
         watchdog may have seen, then run again: the campaign resumes where it stopped"
    )]
    Restarted {
        /// The port.
        port: String,
    },
    /// The controller does not accept the configuration.
    #[error("the controller does not accept the configuration: {0}")]
    Config(froude_control::config::ConfigError),
}

/// A tick of the board on the host's clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HostClock {
    /// When it was, s since 1970.
    pub unix_s: f64,
    /// How much faster the host's clock runs than the board's.
    pub drift: f64,
    /// Standard uncertainty of `unix_s` against the host's clock, s.
    pub standard_uncertainty_s: f64,
}

/// Something that can be driven.
pub trait Rig {
    /// One tick. Blocks until the board has sent it, or simulates it.
    ///
    /// # Errors
    ///
    /// [`RigError`] when the rig can no longer be talked to.
    fn tick(&mut self, request: Option<Request>) -> Result<Sample, RigError>;

    /// Samples per second: those of the controller's ticks that the line carries.
    fn rate_hz(&self) -> f64;

    /// When a tick was on the host's clock; `None` where the two clocks are one, or before they have been compared.
    fn host_clock(&self, _tick: u64) -> Option<HostClock> {
        None
    }

    /// Ticks of the controller from one sample to the next; more than one where the line is too slow for all.
    fn ticks_per_sample(&self) -> u64 {
        1
    }

    /// Whether its time passes by itself: a real rig has to be listened to whatever else happens; a twin's passes only when it is ticked.
    fn is_real_time(&self) -> bool {
        false
    }

    /// Begins a run with what the operator has mounted. Nothing to do on a real rig.
    fn begin_run(&mut self, load: &Load, run_number: u64);

    /// Begins what is recorded of the run, at rest where it starts. Nothing to do on a real rig.
    fn begin_recording(&mut self) {}

    /// What it is, for the record: `twin`, or the firmware's name and version.
    fn version(&self) -> String;
}

pub mod port;
pub mod serial;
pub mod twin;
