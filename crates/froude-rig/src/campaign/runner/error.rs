//! Why a campaign stopped before its end.

use std::path::PathBuf;

use froude_control::fault::Fault;
use froude_control::status::Refusal;
use froude_records::RecordError;
use froude_records::run::RunStatus;

use crate::drive::RigError;

/// Why a campaign stopped before its end.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum RunnerError {
    /// The operator asked for it.
    #[error("stopped by the operator in {run}; run the campaign again to resume from there")]
    Stopped {
        /// The run.
        run: String,
    },
    /// The operator asked for it while being asked.
    #[error("stopped by the operator, who was asked: {prompt}; run the campaign again to resume from there")]
    StoppedWaiting {
        /// What was asked.
        prompt: String,
    },
    /// The operator does not go on.
    #[error("the operator did not confirm: {prompt}")]
    NotConfirmed {
        /// What was asked.
        prompt: String,
    },
    /// Another program on the line asked for a stop.
    #[error(
        "another program on the line (session {session:08x}) stopped the carriage in {run}. Find out who requested it, then run the campaign \
         again: it resumes from there"
    )]
    StoppedByAnother {
        /// The run.
        run: String,
        /// The other program's session.
        session: u32,
    },
    /// Another program on the line asked for a stop while nothing was to move.
    #[error(
        "another program on the line (session {session:08x}) asked for a stop between two runs, while nothing was to move. Find out who requested \
         it, then run the campaign again: it resumes from there"
    )]
    StoppedAtRest {
        /// The other program's session.
        session: u32,
    },
    /// A fault while nothing was to move: the operator was asked, or logs were read.
    #[error(
        "fault between two runs, while nothing was to move: {fault:?} (category {} stop). Remove the cause, then run the \
         campaign again: it resumes from there",
        fault.category() as u8
    )]
    FaultAtRest {
        /// The fault.
        fault: Fault,
    },
    /// The controller latched a fault.
    #[error(
        "fault in {run}: {fault:?} (category {} stop); the run is kept and marked. Remove the cause, then run the campaign \
         again: it resumes from there",
        fault.category() as u8
    )]
    Fault {
        /// The run.
        run: String,
        /// The fault.
        fault: Fault,
    },
    /// A fault before the run itself: in homing, or on the way to its start.
    #[error(
        "fault before {run}, in homing or on the way to its start: {fault:?} (category {} stop); nothing was recorded. Remove the \
         cause (a loop softer than its chain lets the motor swing: froude carriage tune), then run the campaign again",
        fault.category() as u8
    )]
    FaultBefore {
        /// The run.
        run: String,
        /// The fault.
        fault: Fault,
    },
    /// The controller refused a request.
    #[error("{run}: the controller refused to {what}: {refusal:?}")]
    Refused {
        /// The run.
        run: String,
        /// What was asked.
        what: &'static str,
        /// Why not.
        refusal: Refusal,
    },
    /// A request was neither carried out nor refused.
    #[error(
        "{run}: the controller neither carried out nor refused to {what}; the carriage was stopped. Run the campaign again"
    )]
    Unanswered {
        /// The run.
        run: String,
        /// What was asked.
        what: &'static str,
    },
    /// A move ended elsewhere.
    #[error(
        "{run}: the move to {target_m:.3} m ended at {at_m:.3} m without a fault: something else stopped the carriage. Run the campaign \
         again: it resumes from there"
    )]
    Elsewhere {
        /// The run.
        run: String,
        /// Where it was to end, m.
        target_m: f64,
        /// Where it ended, m.
        at_m: f64,
    },
    /// All was driven, and some of it not to its end.
    #[error(
        "runs that ended before their planned motion was done are marked cut: {}. The same command drives them again; where that ends alike, \
         change the campaign and name another folder with --out",
        runs.join("; ")
    )]
    Cut {
        /// What became of each.
        runs: Vec<String>,
    },
    /// A stop was asked for twice, and the carriage still moves.
    #[error(
        "{run}: the carriage does not come to rest, although a stop was asked for twice: use the emergency stop. The board stops by itself \
         when this program has ended"
    )]
    NotAtRest {
        /// The run.
        run: String,
    },
    /// Something took longer than it can.
    #[error("{run}: {what} did not end within {limit_s:.0} s; the carriage was stopped")]
    TooLong {
        /// The run.
        run: String,
        /// What.
        what: &'static str,
        /// The limit.
        limit_s: f64,
    },
    /// Recording failed; the carriage was stopped (category 1).
    #[error("the carriage was stopped because it can no longer be recorded: {0}")]
    Record(#[from] RecordError),
    /// What was recorded came too late to the disk; the carriage was stopped (category 1).
    #[error(
        "the carriage was stopped in {run} because the disk is {} s behind it; free the disk of other work, or record to another \
         one (--out)",
        PATIENCE_S
    )]
    Behind {
        /// The run.
        run: String,
    },
    /// The rig does not answer.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// The thread that ticks the rig did not start, or did not live.
    #[error("the thread that ticks the rig: {reason}; the board's own watchdog stops the carriage")]
    Thread {
        /// What happened.
        reason: String,
    },
    /// What lies of a run is for a person to sort out.
    #[error("{0}")]
    Files(#[source] RecordError),
    /// A folder.
    #[error("{}: {reason}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// What the system said.
        reason: String,
    },
}

impl RunnerError {
    pub(super) fn status(&self) -> RunStatus {
        match self {
            Self::Fault { .. } | Self::FaultAtRest { .. } => RunStatus::Faulted,
            _ => RunStatus::Interrupted,
        }
    }
}

/// How much of a real rig's telemetry may wait for a disk before the carriage is stopped, s.
pub(crate) const PATIENCE_S: f64 = 10.0;
