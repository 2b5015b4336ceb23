//! The carriage controller as a program: one application, the boards that it runs on, and their drivers.
//!
//! **Setting.** A timer interrupts 4000 times a second. Its handler latches time and encoders ([`tick`]); the main loop then steps the
//! controller, writes the commands and files telemetry, and serves the serial port until the next tick ([`application`]).
//! **Units.** SI; board time in µs, wrapping at 2³².
//!
//! | board | module | met hardware |
//! | --- | --- | --- |
//! | emulated Cortex-A8 (realview-pb-a8) with a rig of its own inside | [`realview`] | it is an emulator |
//! | BeagleBone Black | [`am335x`] | **no**: written from the manual, tested against register models |
//!
//! Drivers speak to registers through [`registers::Registers`], so that the same code runs against a model on the host.
#![no_std]

pub mod am335x;
pub mod application;
pub mod board;
pub mod demand;
pub mod realview;
pub mod registers;
pub mod rig;
pub mod scenario;
pub mod tick;

pub use application::Application;
pub use board::Board;
