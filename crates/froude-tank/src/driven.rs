//! Methods with a motor-driven body: a motor moves the body to and fro while load cells between motor and body measure the loads of the rig on it.
//!
//! A method states what differs: its [`spec::Spec`] (keys, roles, channels, words), how its section is read, and its equation ([`method::MotorDriven::terms`]) as known motions
//! times coefficients and declared constants. The rest is derived from that for all of them:
//!
//! | module                     | what                                                              |
//! |----------------------------|-------------------------------------------------------------------|
//! | [`spec`], [`method`]       | what a method states, and what it does itself                     |
//! | [`read`], [`setup`]        | keys, budget entries and constants of a campaign, for each law    |
//! | [`matrix`]                 | run matrix                                                        |
//! | [`mod@fit`]                | unknowns, priors and declared errors of the joint fit ([`crate::joint`]) |
//! | [`twin`]                   | truth, draws, logs and sidecars                                   |
//! | [`still_run`], [`still_fit`] | a constant from still runs                                      |
//! | [`lag`]                    | a delay that the runs show and nobody declared                    |
//! | [`mod@forecast`], [`plan`] | the intervals to expect                                           |
//! | [`derived`]                | sums of coefficients with their uncertainty                       |
//! | [`record`], [`page`], [`source`] | estimate, report, campaign                                  |
//!
//! One rule for constants: if one is an unknown, its declared value is a prior; any other with a standard uncertainty is a declared error, and the equation is
//! evaluated with the constant moved. Gains are always errors: as unknowns they would learn from the data and move every interval.

pub mod derived;
pub mod fit;
pub mod fitted;
pub mod forecast;
pub mod lag;
pub mod matrix;
pub mod method;
pub mod page;
pub mod plan;
pub mod read;
pub mod record;
pub mod run;
pub mod setup;
pub mod source;
pub mod spec;
pub mod still_fit;
mod still_page;
pub mod still_run;
pub mod twin;
