//! Steady towing, and bodies held in a stream: from raw series to one observation per run.
//!
//! A run is at rest, comes up to speed, stays there, and comes to rest. Its steady window is found by a stated rule ([`mod@window`]), its zero is that of
//! the still parts before and after, drawn as a straight line between them, and its mean counts the correlation of its samples ([`mod@point`]). The motion
//! in water with the body off (role `tare`) is subtracted at the same speed and angle ([`tare`]). The rows go the way of every table: the same laws,
//! budget and choice.
//!
//! **Setting.** Constant speed and attitude, one body; forces in the body's axes.
//! **Units.** SI; angles in radians.
//!
//! | module       | what                                           | source                                    |
//! |--------------|------------------------------------------------|-------------------------------------------|
//! | [`mod@window`]   | the steady window and the still parts          | –                                         |
//! | [`mod@point`] | means and zeros of one run                     | Sokal 1997; ITTC 7.5-02-02-02             |
//! | [`row`]      | observations as the rows of a table            | –                                         |
//! | [`section`]  | what a campaign declares and plans             | –                                         |
//! | [`tare`]     | rig without body, subtracted                   | JCGM 100:2008 (GUM), 5.2                  |
//! | [`walls`]    | blockage and clearance at the angle of a run   | USR eq. 14; ITTC 7.5-02-02-01             |
//! | [`simulate`] | the runs that a campaign would give            | –                                         |
//! | [`mod@plan`] | run matrix, time, travel, intervals to expect  | Fisher 1922                               |
//!
//! Not here: unsteady motion, waves, moments about another point than the sensor's.

pub mod page;
pub mod plan;
pub mod point;
pub mod row;
pub mod section;
pub mod simulate;
pub mod source;
pub mod tare;
pub mod walls;
pub mod window;

pub use point::{Load, Point, Run, point, point_told};
pub use row::Row;
pub use window::{Motion, Told, Window, window, window_told};
