//! A carriage campaign: planned, checked before anything moves, driven, recorded, resumed.
//!
//! | module        | what                                                                        |
//! |---------------|-----------------------------------------------------------------------------|
//! | [`preflight`] | travel, coast, speed, command, current and heating of every run, before it moves |
//! | [`prepare`]   | a campaign read, planned and checked, or what speaks against it                 |
//! | [`drive`]     | what passed, driven into its own folder                                         |
//! | [`lock`]      | one drive at a time into a folder                                               |
//! | [`runner`]    | drives and records one run after the other; stops                              |
//! | [`pair`]      | whether a sidecar and its log belong together                                   |
//! | `resume`      | what lies of a run already, and putting aside what is not complete              |
//! | [`setup`]     | controller and twin from the campaign's `[rig]` section                            |
//! | [`stop`]      | Ctrl-C: once is a controlled stop, twice cuts the torque                        |
//!
//! **Threads.** The rig is ticked by a thread of its own (`rig_thread`), always; prompts, disk and terminal stand beside it, and what passes
//! between the two goes through one small hand-over (`hand_over`). Nothing that the one waits for stops the other.
//!
//! **Order.** Dry and wet runs stand in ABBA blocks (dry, wet, wet, dry), so that a drift that is linear in time falls out of
//! each pair's difference (MCD eq. 8); within a block the speeds come in a drawn order, so that it does not look like speed.

pub mod drive;
pub mod error;
mod hand_over;
pub mod lock;
mod order;
pub mod pair;
pub mod preflight;
pub mod prepare;
mod recording;
mod resume;
mod rig_thread;
pub mod runner;
pub mod setup;
pub mod stop;

/// What the hand-over and the stop are made of; their tests put primitives in its place whose schedules are explored.
mod sync {
    pub use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};
    pub use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError, TryLockError};
}
