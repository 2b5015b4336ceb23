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
//! | whether it lies as it was driven | [`check_pair`], [`Doubt`] |
//! | another program's log     | [`import_run`]; one that is too long to be held [`Ticks`], [`Extremes`], [`run_of_means`] |
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

/// Name of the file that says why a campaign stopped before all its pairs were driven.
pub const STOPPED_EARLY: &str = "stopped-early.txt";

/// What its line with the last run begins with.
pub const LAST_RUN: &str = "last run: ";

mod allowance;
pub mod cell;
pub(crate) mod channel;
pub mod clocks;
pub(crate) mod declarations;
mod declared_text;
mod doubt;
mod extremes;
mod file;
pub mod frames;
mod import;
mod layout;
mod log;
pub mod marks;
mod meta;
mod pair;
mod reader;
mod recorded;
mod recorder;
mod seal;
pub mod sensor;
pub(crate) mod sidecar;
pub mod step;
mod sync;
mod ticks;

pub use crate::run::doubt::{Doubt, DoubtKind};
pub use crate::run::pair::{Pair, check_names, check_pair};
pub use channel::{BOARD, Frame, LOG, Meaning};
pub use declarations::{Declarations, Stated, Told};
pub use extremes::{Extremes, Oscillating, Stay};
pub use import::{Averaged, ImportedRun, TimeSteps, import_run, is_servo_log, run_of_means, run_of_table};
pub use layout::{AxisSample, CarriageSample, ChannelSpec, Kind, Layout};
pub use log::{Channel, Event, EventKind, Gap, GapCause, RunLog};
pub use meta::{
    ACCELERATED_TOW, Axis, AxisConstants, BodyState, CarriageFacts, ClockAlignment, Declared, Direction,
    EXCITED_RESPONSE, FORCED_OSCILLATION, FREE_DECAY, Mounted, ROTATION, Role, RunMeta, RunStatus, STEADY, TOW,
    WEIGHT_TOW,
};
pub use reader::{Block, RunReader, read_run};
pub use recorded::recorded_run;
pub use recorder::{Packing, Recorder};
pub use seal::CampaignMark;
pub use sidecar::{
    AMPLIFIER, TORQUE_CONSTANT, declared, declared_value, parse_run_meta, positive_declared, read_run_meta,
    run_meta_text, write_run_meta,
};
pub use ticks::Ticks;
