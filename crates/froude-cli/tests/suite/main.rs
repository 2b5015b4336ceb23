//! The program at its verbs, as people run it: one test program, so that it is linked once and all tests share one driven campaign.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, missing_docs)]

mod accelerated;
mod added_mass;
mod animation;
mod bad_input;
mod bench;
#[path = "../../../froude-rig/tests/board/mod.rs"]
mod board;
mod carriage;
mod cases;
mod cfd;
mod clocks;
mod convert;
mod decay;
mod documents;
mod drag_coefficient;
mod excited;
#[cfg(target_os = "linux")]
mod files;
mod first_time;
mod folders;
#[path = "../../../froude/tests/held/mod.rs"]
mod held;
mod hostile;
mod hull;
mod inference;
#[cfg(target_os = "linux")]
mod interrupted;
mod join;
mod joint;
mod limits;
mod logs;
mod nothing_read_wrongly;
mod one_operator;
mod oscillation;
mod records;
mod resume;
mod robot;
mod rotation;
mod same_bytes;
mod same_drag;
mod schema;
mod sidecars;
mod small_disk;
mod starters;
mod steady;
mod stories;
mod student;
#[path = "../../../froude-carriage/tests/student_tank/mod.rs"]
mod student_tank;
mod sway;
mod swim;
mod swim_3d;
mod swim_sweep;
mod tank;
#[cfg(unix)]
mod text;
mod verbs;
mod weights;
mod whole;
mod writing;
