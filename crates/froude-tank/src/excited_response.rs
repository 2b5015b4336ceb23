//! Excited response: added mass and damping of a section in heave, from a run in waves with the body held and one with it free.
//!
//! Held, the load cell shows the exciting force F of the wave; free, the body heaves by z. Both are fitted by harmonics of the wave's frequency and referred to the
//! wavemaker, so that two runs of the same wave stand on one clock, and
//!
//! (−ω²(m + A33) + iωB33 + C33) z = F,  A33 = (C33 − Re F/z)/ω² − m,  B33 = (Im F/z)/ω,
//!
//! with m and C33 declared, at each period of the wave for itself.
//!
//! **Setting.** Linear: the same wave in both runs, small motions, no other motion coupled to heave. The body is symmetric fore and aft.
//! **Frame.** Force and motion along one axis, either way up. **Units.** SI; phases in radians, x(t) = Re X e^{iωt}.
//!
//! | module            | what                                                    | source                       |
//! |-------------------|---------------------------------------------------------|------------------------------|
//! | [`section`]       | what a campaign declares and plans                      | –                            |
//! | [`setup`]         | runs, and what is declared                              | –                            |
//! | [`wave`]          | the wavemaker: start, stop, frequency, phase            | IEEE Std 1057                |
//! | [`response`]      | one signal per motion of the wavemaker, with its scatter | Priestley (1981), 6.1        |
//! | [`window`]        | the part to be used where nobody has declared one       | –                            |
//! | [`coefficients`]  | A33, B33 and their budget                               | Newman (1977), 6.17; GUM     |
//! | [`camera`]        | the clock of a camera against the accelerometers        | [`froude_signal::clock`]     |
//! | [`findings`]      | what is doubtful                                        | –                            |
//! | [`simulate`], [`mod@plan`] | the runs that a campaign would give, and their intervals | Fisher 1922           |
//! | [`record`], [`page`] | estimates, and what a page shows                     | –                            |
//!
//! B33 holds what guides and viscosity take out of the motion: it is not subtracted. Waves that the body scatters or radiates come back from wavemaker and beach; only
//! a window before that, declared, gives B33.
//!
//! Not here: sway and roll, which are coupled; drift forces; the memory of the free surface (A33 and B33 are those of the wave's frequency).

pub mod camera;
pub mod coefficients;
pub mod findings;
pub mod page;
pub mod plan;
pub mod record;
pub mod response;
pub mod section;
pub mod setup;
pub mod simulate;
pub mod source;
pub mod wave;
pub mod window;

pub use coefficients::{AtPeriod, fit};
pub use setup::{Setup, Shows, WaveRun};
