//! A run: one log, channels over time with what they mean, of a method, in a role, with something mounted.
//!
//! **Setting.** One rig, one movement (or one still wait) of it, tick by tick of one clock.
//! **Frame.** Axis `y` is along the tank, `x` across; positions on the chain, motor side. `force` is what the water
//! exerts against +y motion: positive for a resistance when the carriage moves forward.
//! **Units.** Every channel names its own; the columns of a run are SI.
//!
//! | what                      | where          |
//! |---------------------------|----------------|
//! | a run in memory           | [`RunLog`]     |
//! | what is known about it    | [`RunMeta`]; as text [`read_run_meta`], [`write_run_meta`] |
//! | which columns, which topics | [`Layout`] |
//! | what a column's numbers are | [`Meaning`] |
//! | recording (MCAP)          | [`Recorder`]   |
//! | reading, whole or streamed | [`read_run`], [`RunReader`] |
//! | whether log and sidecar belong to the same run | [`contradiction`], [`difference`], [`Doubt`] |
//! | another program's log     | [`import_run`] |
//! | what is declared of its data | [`mod@sensor`], [`mod@clocks`], [`mod@frames`], [`mod@cell`], [`mod@marks`] |
//! | what was done to it       | [`mod@step`] |
//!
//! **On disk.** `ID.mcap`: topics `/axis/y`, `/axis/x`, `/force`, `/truth/…`, one message a tick (ROS 2 definitions, CDR bytes),
//! `/events` (`rcl_interfaces/msg/Log`), and metadata records `froude_run` (at the beginning) and
//! `froude_run_end` with the entries of the sidecar `ID.toml`. Foxglove,
//! PlotJuggler and the MCAP tools open it as it is. Log time is the board's: start of the run plus tick over log rate; the
//! sequence number of a message is its tick.
//!
//! **Log and sidecar are tied.** Both name run and campaign (with the SHA-256 of its file); the sidecar of a finished log has the
//! log's length and SHA-256, and a checksum of itself. A reader says what does not fit ([`RunLog::doubts`]).
//!
//! Not here: any physics. Filters are `froude-signal`'s, drag is `froude-carriage`'s.

/// Name of the campaign's copy in a folder of runs.
pub const CAMPAIGN_COPY: &str = "campaign.toml";

mod allowance;
pub mod cell;
pub(crate) mod channel;
pub mod clock_jumps;
pub mod clocks;
pub(crate) mod declarations;
pub(crate) mod declared;
mod declared_text;
mod doubt;
mod file;
pub mod frames;
mod import;
pub(crate) mod join;
mod layout;
mod log;
pub(crate) mod log_times;
pub mod marks;
pub(crate) mod meta;
mod reader;
mod recorder;
mod seal;
pub mod sensor;
pub(crate) mod sidecar;
pub mod stamps;
pub mod step;
mod sync;

pub use crate::run::doubt::{Doubt, DoubtKind};
pub use channel::{BOARD, Frame, LOG, Meaning};
pub use declarations::{Declarations, Stated, Told};
pub use declared::{Declared, declared, declared_value};
pub use import::{ImportedRun, channel_name, import_run, is_servo_log, run_of, run_of_table};
pub use layout::{AxisSample, CarriageSample, ChannelSpec, Kind, Layout};
pub use log::{Channel, Event, EventKind, Gap, GapCause, RunLog};
pub use log_times::{EVEN, LogTimes, Missing, TimeSteps, gap, steps_finding, time_column};
pub use meta::{
    Axis, AxisConstants, BodyState, CarriageFacts, ClockAlignment, Direction, Mounted, Role, RunMeta, RunStatus, TOW,
};
pub use reader::{Block, RunReader, head_of, read_run};
pub use recorder::{Packing, Recorder};
pub use seal::{CampaignMark, contradiction, difference};
pub use sidecar::{AMPLIFIER, TORQUE_CONSTANT, parse_run_meta, read_run_meta, run_meta_text, write_run_meta};
pub use stamps::median;
