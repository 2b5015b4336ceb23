//! What a rotation gives: runs over time, and what is declared about body, rig and water.

use std::f64::consts::TAU;

use froude_fit::budget::Uncertain;
use froude_hydro::Link;
use froude_hydro::swing::Pivot;
use froude_rig::rotation::Mounted;

use crate::error::TankError;
use crate::motion::{Cycles, Logged, Motion, Sampled, motion};

/// One run: columns of one length, time increasing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotationRun<'a> {
    /// Name of the run, for messages.
    pub id: &'a str,
    /// What was on the shaft.
    pub mounted: Mounted,
    /// Time, s.
    pub time_s: &'a [f64],
    /// θ, rad.
    pub angle_rad: &'a [f64],
    /// Moment of the rig on the body about the axis, N m; its zero is free.
    pub torque_n_m: &'a [f64],
}

/// What is declared about rig, body and water.
#[derive(Debug, Clone, PartialEq)]
pub struct Setup {
    /// How the axis lies; about an upright one gravity does nothing.
    pub axis: Pivot,
    /// J of all that moves below the torque cell, kg m², as far as it is known beforehand.
    pub inertia_kg_m2: Option<Uncertain>,
    /// J of it without the body, kg m².
    pub tare_inertia_kg_m2: Option<Uncertain>,
    /// K of the restoring moment K sin θ in water, N m.
    pub restoring_n_m: Option<Uncertain>,
    /// Delay of the torque behind the angle, s, as far as it is known beforehand: with a standard uncertainty of 0 it is taken as it is.
    pub delay_s: Option<Uncertain>,
    /// Gain error of the angle, as part of it.
    pub angle_relative: f64,
    /// Gain error of the torque, as part of it.
    pub torque_relative: f64,
    /// Which cycles are used.
    pub cycles: Cycles,
    /// Harmonics of the angle.
    pub harmonics: usize,
    /// ρ, kg/m³, for what is derived from the λs.
    pub density_kg_m3: Option<Uncertain>,
    /// The body, if it is one link, for the same.
    pub link: Option<Link>,
}

impl Setup {
    /// An upright axis, an inertia, and nothing else that is known or errs.
    #[must_use]
    pub fn new(inertia_kg_m2: Option<Uncertain>) -> Self {
        Self {
            axis: Pivot::Upright,
            inertia_kg_m2,
            tare_inertia_kg_m2: None,
            restoring_n_m: None,
            delay_s: None,
            angle_relative: 0.0,
            torque_relative: 0.0,
            cycles: Cycles::default(),
            harmonics: 3,
            density_kg_m3: None,
            link: None,
        }
    }
}

/// The motion of every run.
///
/// # Errors
///
/// That of the first run whose motion cannot be used.
pub fn motions(runs: &[RotationRun<'_>], setup: &Setup) -> Result<Vec<Motion>, TankError> {
    runs.iter().map(|run| of_run(run, setup, Sampled::default())).collect()
}

/// The same without the cycles that a mark touches; `sampled` belongs to `runs`, one each.
///
/// # Errors
///
/// As [`motions`]: too few cycles without a mark, too.
pub fn motions_without(
    runs: &[RotationRun<'_>],
    setup: &Setup,
    sampled: &[Sampled<'_>],
) -> Result<Vec<Motion>, TankError> {
    runs.iter().zip(sampled).map(|(run, sampled)| of_run(run, setup, *sampled)).collect()
}

fn of_run(run: &RotationRun<'_>, setup: &Setup, sampled: Sampled<'_>) -> Result<Motion, TankError> {
    let RotationRun { id, time_s, angle_rad, torque_n_m, .. } = *run;
    let of = Logged { id, time_s, angle_rad, load: ("torque", "N m", torque_n_m), sampled };
    motion(&of, setup.cycles, setup.harmonics)
}

/// What is mounted, in words.
#[must_use]
pub(super) fn words(mounted: Mounted) -> &'static str {
    match mounted {
        Mounted::Body => "body",
        Mounted::BodyInAir => "body, in air",
        Mounted::Shaft => "shaft alone",
    }
}

/// Keulegan and Carpenter's number of the end of the link, u T/D = 2π α l/(2a); `None` where no link is declared.
#[must_use]
pub(super) fn tip_kc(setup: &Setup, amplitude_rad: f64) -> Option<f64> {
    setup.link.map(|link| TAU * amplitude_rad * link.half_length_m / (2.0 * link.major_semi_axis_m))
}
