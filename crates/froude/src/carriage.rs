//! The towing carriage: driven, calibrated, identified and tuned.
//!
//! | module        | verb                      | what                                                       |
//! |---------------|---------------------------|------------------------------------------------------------|
//! | [`drive`]     | `froude run`              | pre-flight, then the campaign on the twin or the real rig      |
//! | [`servo`]     | `froude carriage identify` | servo parameters from runs, or from anyone's servo log         |
//! | [`calibrate`] | `froude carriage calibrate` | force per volt from known weights, polarity                  |
//! | [`tune`]      | `froude carriage tune`, `resonance` | experiments on the loop: gains, margins, modes, shaper |
//!
//! Drag from runs is a job like any other ([`crate::pipeline`]), by [`froude_carriage::source`].
//!
//! A folder of runs holds a copy of its campaign (`campaign.toml`), so it says by itself what body and rig it belongs to.

pub mod calibrate;
pub mod drive;
pub mod servo;
pub mod tune;
