//! Drag of a towed body from a carriage: force sensor, motor current difference, model of the servo.
//!
//! A run is a trapezoid along the tank, logged as columns. Its steady part gives a mean force with a realistic
//! uncertainty; the means over speeds and repeats give `D_d` of F = D_d v|v|, with a budget and an interval.
//!
//! **Setting.** One axis, stiff tracking, body mounted wet or above the water; wet and dry runs come in pairs.
//! **Frame.** Position along the chain, motor side. A force is the resistance that opposes motion along +y:
//! positive for v > 0, negative for v < 0.
//! **Units.** SI; the drive command is in volts.
//!
//! | module            | what                                                            | source                    |
//! |-------------------|-----------------------------------------------------------------|---------------------------|
//! | [`run`]           | columns of one run, what is declared about the rig              | –                         |
//! | [`steady`]        | the steady window, its mean and effective number of samples     | Sokal 1997                |
//! | [`fsm`]           | force sensor, zero from still windows                           | MCD, method 1             |
//! | [`mcd`]           | motor current difference, paired by position                    | MCD eq. 8                 |
//! | [`mbdp`]          | model of the servo: constant, mapped and flexible               | MCD eq. 2, 9              |
//! | [`friction`]      | friction over position and speed from dry runs                  | –                         |
//! | `observed`        | what each method makes of the runs, and how its points scatter  | –                         |
//! | [`coefficient`]   | D_d by the common fit                                           | GUM, JCGM 101             |
//! | [`detectability`] | the smallest drag that still and dry repeats can see            | –                         |
//! | [`calibration`]   | force per volt from a known weight; encoder scale; jog          | –                         |
//! | [`tracking`]      | how closely the reference was followed                          | MCD Table III             |
//! | [`added_mass`]    | what the ramps say                                              | –                         |
//! | [`online`]        | D_d while the campaign runs, and when to stop                   | Bonferroni                |
//! | [`report`]        | all of it side by side                                          | –                         |
//!
//! MCD is "A low cost, sensor-less drag force estimation methodology via measuring of motor currents". It prints no
//! uncertainty, leaves out the gear's efficiency and does not ask whether the dry carriage rolls under the wet load.
//!
//! Not here: identification of the servo from excitations (`servo`), files of runs (`froude-records`), waves and blockage.

pub mod added_mass;
pub mod calibration;
pub mod coefficient;
pub mod detectability;
pub mod differences;
mod error;
mod errors;
pub mod friction;
pub mod fsm;
pub mod mbdp;
pub mod mcd;
mod observed;
pub mod online;
pub mod point;
pub(crate) mod record;
pub mod report;
pub mod run;
pub mod setup;
pub mod steady;
pub mod tracking;

pub use crate::drag::setup::DragSetup;
pub use error::DragError;
pub use report::{DragReport, drag_report};
pub use run::{BodyState, DragRun, RunKind};
