//! The weight-driven rig: a wagon on a rail, pulled by a hanging weight and filmed, with the body on a load cell below it.
//!
//! The mark's track is turned from pixels into metres by scale and lens; the speed is that of the last part of the way. Where the moving mass is
//! declared, the drag along the rail is what the weight leaves for it less friction and inertia ([`mod@balance`]), if half of the terminal speed is reached;
//! where it is not, the run must be shown to be steady, and the cell gives the drag. Any other run is left out. The rows go the way of every table.
//!
//! **Setting.** Straight rail, stiff string, friction that does not depend on the speed; drag between linear and quadratic.
//! **Units.** SI, and pixels; angles in radians.
//!
//! | module          | what                                            | source                    |
//! |-----------------|-------------------------------------------------|---------------------------|
//! | [`track`]       | pixels to metres, the moving part, its last part | –                        |
//! | [`mod@balance`] | the drag of a wagon that still accelerates      | USR eq. 16, Newton        |
//! | [`section`]     | what a campaign declares and plans              | –                         |
//! | [`reduce`]      | the observation of a run                        | –                         |
//! | [`simulate`]    | the runs that a campaign would give             | –                         |
//! | [`mod@plan`]    | run matrix, what is reached, intervals          | Fisher 1922               |
//!
//! Not here: tracking the mark in the film, distortion across the rail, two clocks (track and loads stand in one log).

pub mod balance;
pub mod page;
pub mod plan;
pub mod reduce;
pub mod section;
pub mod simulate;
pub mod source;
pub mod track;
