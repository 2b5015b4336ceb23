//! Methods of which each run gives one observation, a row of a table: a speed and loads of the water on the body there.
//!
//! A method states its keys, conditions and channels ([`spec::Spec`]), how a log becomes an observation, and how its rig would log a planned run
//! ([`method::Observed`]). From these follow reading and checking, the run matrix, the twin ([`mod@twin`]), what a declared constant moves
//! ([`method::Observed::moves`]), the intervals to expect ([`mod@plan`]), and record, findings and page ([`source`]): the rows go the way of every table.
//!
//! **Setting.** Force laws of speed and angle, of runs that are steady or corrected for their acceleration. **Units.** SI; angles in radians.
//!
//! **Source.** JCGM 100:2008 (GUM), 5.2, for constants that all runs share.
//!
//! Not here: runs of many rows ([`crate::accelerated_tow`]), bodies that a motor drives ([`crate::driven`]).

pub mod linear;
pub mod method;
mod page;
pub mod plan;
pub mod read;
pub mod reduced;
pub mod rig;
pub mod settings;
pub mod source;
pub mod spec;
pub mod twin;
