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
//! | [`axes`]            | heading, towing, body velocity                               | USR eq. 5, 6                   |
//! | [`geometry`]        | link, body, reference areas                                  | USR eq. 8–14                   |
//! | [`drag`]            | f1 to f6: force, regressor, nesting                          | USR eq. 9–14                   |
//! | [`dissipation`]     | power the fluid delivers, grid search, constraint rows       | f·v ≤ 0                        |
//! | [`power_law`]       | F = k·Uⁿ                                                     | MCD (n = 2)                    |
//! | [`link_parameters`] | c_T, c_N, μ, λ₁, λ₂, λ₃ of one link                          | USR eq. 7, 8                   |
//! | [`added_mass`]      | added mass ↔ coefficient, signed force balance, oscillation  | USR eq. 15–24                  |
//! | [`fluid`]           | density and viscosity of fresh and sea water                 | UNESCO 1983, Sharqawy 2010     |
//! | [`similarity`]      | Re, Fr, KC, blockage, ITTC-57                                | ITTC                           |
//! | [`prime`]           | prime ↔ SI scaling of derivatives                            | SNAME 1950                     |
//! | [`closed_form`]     | sphere, prolate spheroid, elliptic cylinder                  | Lamb, Stokes, Schiller–Naumann |
//! | [`ellipsoid`]       | added mass of an ellipsoid with any three semi-axes          | Lamb 1932, Carlson 1995        |
//! | [`strip`]           | 6×6 of a slender body from its elliptic sections             | Newman 1977                    |
//! | [`swing`]           | a body swung about a pivot in a stream                       | USR eq. 5, 19                  |
//! | [`tabulated`]       | plates, prisms, cylinders as printed                         | DNV-RP-C205                    |
//! | [`near_wall`]       | sphere near a plane, in a shell; rigid or φ = 0              | Lamb 1932, our derivation      |
//! | [`sloshing`]        | first modes of a tank, frequency number                      | Faltinsen & Timokha 2009       |
//! | [`plausibility`]    | drag coefficients that bodies have                           | Hoerner 1965                   |
//!
//! USR is Kelasidi, Elgenes and Kilvær, "Fluid parameter identification for
//! underwater snake robots"; MCD is "A low cost, sensor-less drag force
//! estimation methodology via measuring of motor currents".
//!
//! Not here: time histories, multi-link dynamics, waves, 6×6 added mass of
//! arbitrary shapes.
#![no_std]
#![cfg_attr(test, allow(clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod added_mass;
pub mod axes;
pub mod closed_form;
pub mod dissipation;
pub mod drag;
pub mod ellipsoid;
pub mod fluid;
pub mod geometry;
pub mod link_parameters;
pub mod near_wall;
pub mod plausibility;
pub mod power_law;
pub mod prime;
pub mod similarity;
pub mod sloshing;
pub mod strip;
pub mod swing;
pub mod tabulated;

pub use drag::{Axis, CoefficientInfo, CrossTerm, DragModel, Factor, MAX_COEFFICIENTS, Motion, Restrictions, Setting};
pub use geometry::{Body, GeometryError, Link, Neck, Robot};
