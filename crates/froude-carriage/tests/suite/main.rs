//! Methods of the carriage: tests against closed forms and a simulated axis.
#![allow(clippy::expect_used, clippy::panic, clippy::unwrap_used, missing_docs)]

mod carriage;
mod joint;
mod one_plant;
mod own_logs;
mod rigid;
mod scatter;
#[path = "../scenario/mod.rs"]
mod scenario;
mod servo_logs;
#[path = "../student_tank/mod.rs"]
mod student_tank;
mod tuning;
mod vehicle;
