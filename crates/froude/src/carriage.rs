//! The towing carriage: driven and tuned.
//!
//! | module        | verb                      | what                                                       |
//! |---------------|---------------------------|------------------------------------------------------------|
//! | [`drive`]     | `froude run`              | pre-flight, then the campaign on the twin or the real rig      |
//! | [`scale`]     | `froude carriage calibrate --measured` | scale of the encoder from measured distances        |
//! | [`tune`]      | `froude carriage tune`, `resonance` | experiments on the loop: gains, margins, modes, shaper |
//!
//! Drag, the models of the axis and the calibration from runs are jobs like any other ([`crate::pipeline`]), by [`froude_carriage::source`],
//! [`froude_carriage::axis::source`] and [`froude_carriage::drag::calibration::source`].
//!
//! A folder of runs holds a copy of its campaign (`campaign.toml`), so it says by itself what body and rig it belongs to.

pub mod drive;
pub mod scale;
pub mod tune;
