//! Each run by itself: amplitude and phase of its loads at the frequency of its motion, and the coefficients that they alone give.
//!
//! With y = a cos θ, θ̇ = ω, and a load of the rig F cos(θ + ε), both taken at one time,
//!
//! F cos(θ + ε) = A v̇ + B v: A = −F cos ε/(a ω²), B = F sin ε/(a ω).
//!
//! It is no fit of the model but the classical analysis of such a run, and shows how the coefficients change with the frequency.
//!
//! **Source.** Lewandowski (2004), The Dynamics of Marine Craft (loads in phase and in quadrature).

use froude_signal::harmonic::Harmonics;

use crate::driven::run::Run;
use crate::motion::Motion;

/// Amplitude of a load, N or N m, its phase ahead of the motion, rad, and its factors of v̇ and v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ByItself {
    /// F.
    pub amplitude: f64,
    /// ε.
    pub ahead_rad: f64,
    /// A.
    pub of_acceleration: f64,
    /// B.
    pub of_velocity: f64,
}

/// Of a load of a run, the loads stamped `delay_s` behind the motion; `None` where no harmonic can be fitted.
#[must_use]
pub fn by_itself(run: &Run<'_>, motion: &Motion, load: usize, delay_s: f64) -> Option<ByItself> {
    let used = |values: &[f64]| motion.cycles.iter().flat_map(|rows| values[rows.clone()].to_vec()).collect::<Vec<_>>();
    let omega = motion.angle.omega_rad_s;
    let of_load = Harmonics::held(&used(run.time_s), &used(run.loads[load]), motion.angle.terms.len(), omega).ok()?;
    // Both phases from one time.
    let phase = |h: &Harmonics| h.phase_rad(1) + omega * h.origin_s;
    let turn = phase(&motion.angle) - phase(&of_load) + omega * delay_s;
    let ahead_rad = turn.sin().atan2(turn.cos());
    let (a, force) = (motion.angle.amplitude(1), of_load.amplitude(1));
    Some(ByItself {
        amplitude: force,
        ahead_rad,
        of_acceleration: -force * ahead_rad.cos() / (a * omega * omega),
        of_velocity: force * ahead_rad.sin() / (a * omega),
    })
}
