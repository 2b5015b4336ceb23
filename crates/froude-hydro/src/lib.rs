//! Force models of submerged bodies, their regressors, the fluid and closed-form bodies.
//!
//! One expression serves two masters: the simulator asks a [`DragModel`] for a
//! force, the fit asks it for a regressor, and the force *is* the regressor
//! times the coefficients. The crate knows no data and no file; it needs neither
//! `std` nor a heap.
//!
//! **Setting.** A body under water, moving steadily or slowly enough that the
//! force depends on the velocity of the moment.
//! **Frame.** Body axes at the reference point: `x` forward along the link, `y`
//! to starboard, `z` down (SNAME). Forces are those the fluid exerts on the body.
//! **Units.** SI and radians. Names end in their unit.
//!
//! | module              | what                                                         | source                         |
//! |---------------------|--------------------------------------------------------------|--------------------------------|
//! | [`geometry`]        | link, body, reference areas                                  | USR eq. 8–14                   |
//! | [`drag`]            | f1 to f6: force and regressor                                | USR eq. 9–14                   |
//! | [`dissipation`]     | velocities at which a law must not deliver power             | f·v ≤ 0                        |
//! | [`power_law`]       | F = k·Uⁿ                                                     | MCD (n = 2)                    |
//! | [`link_parameters`] | c_T, c_N, μ, λ₁, λ₂, λ₃ of one link                          | USR eq. 7, 8                   |
//! | [`fluid`]           | density and viscosity of fresh and sea water                 | UNESCO 1983, Sharqawy 2010     |
//! | [`similarity`]      | Re, Fr, KC, blockage, ITTC-57                                | ITTC                           |
//! | [`ellipsoid`]       | added mass of an ellipsoid with any three semi-axes          | Lamb 1932, Carlson 1995        |
//! | [`strip`]           | 6×6 of a slender body from its elliptic sections             | Newman 1977                    |
//! | [`swing`]           | a body swung about a pivot in a stream                       | USR eq. 5, 19                  |
//! | [`drag_curves`]     | C_D of sphere, cylinder, plate and spheroid over Re          | Brown & Lawler, Cheng, Hoerner |
//! | [`tabulated`]       | circular cylinders as printed                                | DNV-RP-C205                    |
//! | [`sloshing`]        | first modes of a tank                                        | Faltinsen & Timokha 2009       |
//!
//! USR is Kelasidi, Elgenes and Kilvær, "Fluid parameter identification for
//! underwater snake robots"; MCD is "A low cost, sensor-less drag force
//! estimation methodology via measuring of motor currents".
//!
//! Not here: time histories, multi-link dynamics, waves, 6×6 added mass of
//! arbitrary shapes.
#![no_std]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod dissipation;
pub mod drag;
pub mod drag_curves;
pub mod ellipsoid;
pub mod fluid;
pub mod geometry;
pub mod link_parameters;
pub mod power_law;
pub mod similarity;
pub mod sloshing;
pub mod strip;
pub mod swing;
pub mod tabulated;

pub use drag::{Axis, CoefficientInfo, CrossTerm, DragModel, Factor, MAX_COEFFICIENTS, Motion, Setting};
pub use geometry::{Body, Link, Neck, Robot};
