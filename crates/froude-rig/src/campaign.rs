//! A carriage campaign: planned, checked before anything moves, driven, recorded, resumed.
//!
//! | module        | what                                                                        |
//! |---------------|-----------------------------------------------------------------------------|
//! | [`plan`]      | from the schedule to runs in order, with the operator's steps in between       |
//! | [`preflight`] | travel, coast, speed, command, current and heating of every run, before it moves |
//! | [`runner`]    | drives and records one run after the other; stops                              |
//! | `resume`      | what lies of a run already, and putting aside what is not complete              |
//! | [`setup`]     | controller and twin from the campaign's `[rig]` section                            |
//! | [`stop`]      | Ctrl-C: once is a controlled stop, twice cuts the torque                        |
//!
//! **Order.** Dry and wet runs stand in ABBA blocks (dry, wet, wet, dry), so that a drift that is linear in time falls out of
//! each pair's difference (MCD eq. 8); within a block the speeds come in a drawn order, so that it does not look like speed.

pub mod plan;
pub mod preflight;
mod resume;
pub mod runner;
pub mod setup;
pub mod stop;
