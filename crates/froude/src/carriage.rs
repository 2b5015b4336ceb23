//! The towing carriage: driven, known, and read for drag.
//!
//! | module        | verb                      | what                                                       |
//! |---------------|---------------------------|------------------------------------------------------------|
//! | [`drive`]     | `froude run`              | pre-flight, then the campaign on the twin or the real rig      |
//! | [`drag`]      | `froude carriage drag`    | D_d and C_D by force sensor, motor current and model            |
//! | [`servo`]     | `froude carriage identify` | servo parameters from runs, or from anyone's servo log         |
//! | [`calibrate`] | `froude carriage calibrate` | newtons a volt from known weights, polarity                  |
//! | [`tune`]      | `froude carriage tune`, `resonance` | experiments on the loop: gains, margins, modes, shaper |
//! | [`runs`]      |                           | runs as these take them                                        |
//! | `source`      | `froude identify`         | runs as a source of a campaign, method by method               |
//!
//! A folder of runs holds a copy of its campaign (`campaign.toml`), so it says by itself what body and rig it belongs to.

pub mod calibrate;
pub mod drag;
pub mod drive;
pub mod runs;
pub mod servo;
pub(crate) mod set;
pub(crate) mod source;
pub mod tune;
pub(crate) mod whole;
