//! Accelerated tows: drag and added mass along one axis from runs in which a body is brought up to speed and back to rest.
//!
//! The load cell between rig and body shows f_m = m a − f along the travel, with f = −C_A ρ V a − f_D(v) the load of the water. Motion and force are
//! weighted over short windows φ that overlap; the acceleration is never differentiated, since ∫ φ a dt = −∫ φ′ v dt = ∫ φ″ x dt for a window that ends
//! in zeros ([`rows`]). Each window is a row of a table with speed, acceleration and load; the rows go the way of every table, with one law that has a
//! term of the acceleration, and a scatter that counts their correlation.
//!
//! **Setting.** Straight tow along one body axis, water at rest, no memory of the wake: C_A is that of the motion driven.
//! **Units.** SI. **Signs.** `force` is that of the rig on the body, position and speed are along the body axis.
//!
//! | module       | what                                            | source                                         |
//! |--------------|-------------------------------------------------|------------------------------------------------|
//! | [`rows`]     | weighted means of motion and force, zeros       | Shinbrot 1957 (modulating functions); USR eq. 16 |
//! | [`law`]      | a drag law with a term of the acceleration      | USR eq. 15 and 16                              |
//! | [`section`]    | what a campaign declares and plans            | –                                              |
//! | [`setup`]      | body, rig and water as they are declared      | –                                              |
//! | [`mod@reduce`] | mass, delay, what declared errors do          | JCGM 100:2008 (GUM), 5.2                       |
//! | `lag`        | a lag of the force that nobody declared         | –                                              |
//! | [`simulate`] | the runs that a campaign would give             | –                                              |
//! | [`mod@plan`] | run matrix, time, travel, intervals to expect   | Fisher 1922                                    |
//!
//! Not here: two axes at once, moments, waves that the tow makes.

mod lag;
pub mod law;
pub mod page;
pub mod plan;
pub mod reduce;
pub mod rows;
pub mod section;
pub mod setup;
pub mod simulate;
pub mod source;
