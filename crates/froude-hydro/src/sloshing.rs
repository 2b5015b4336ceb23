//! First sloshing modes of a tank: above which frequency its walls and surface respond.
//!
//! Added mass of a body in a tank is that of a rigid lid well below these frequencies and that of φ = 0 well above them;
//! between, it depends on frequency and neither limit holds.
//!
//! **Setting.** Rectangular tank with upright walls, level bed, no body in it; small waves, ideal fluid.
//! **Units.** SI; circular frequency in rad/s.
//!
//! Not here: surface tension, baffles, other tanks, what the body changes.

use core::f64::consts::PI;

/// A tank or motion that is none.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{what} is {value}; it must be finite and above 0")]
pub struct TankError {
    /// Which quantity.
    pub what: &'static str,
    /// What was given.
    pub value: f64,
}

fn positive(what: &'static str, value: f64) -> Result<f64, TankError> {
    if value > 0.0 && value.is_finite() { Ok(value) } else { Err(TankError { what, value }) }
}

/// First sloshing modes of a rectangular tank, `[along its length, across its breadth]` \[rad/s\].
///
/// `ω² = g k tanh(k d)`, with `k = π/L` and `π/B` and `d` the depth of water.
///
/// # Errors
///
/// [`TankError`] when a length or gravity is not positive and finite.
///
/// # Source
///
/// Faltinsen and Timokha (2009), Sloshing, ch. 4, natural modes of a two-dimensional rectangular tank; Lamb (1932), §228.
///
/// # Example
///
/// A towing tank of 10 m × 2 m with 1 m of water swings to and fro in 6.5 s, across in 1.7 s:
///
/// ```
/// # use froude_hydro::sloshing::{TankError, rectangular_tank_modes_rad_s};
/// let [along, across] = rectangular_tank_modes_rad_s(10.0, 2.0, 1.0, 9.81)?.map(|w| std::f64::consts::TAU / w);
/// assert!((along - 6.49).abs() < 0.01 && (across - 1.67).abs() < 0.01);
/// # Ok::<(), TankError>(())
/// ```
pub fn rectangular_tank_modes_rad_s(
    length_m: f64,
    breadth_m: f64,
    depth_m: f64,
    gravity_m_s2: f64,
) -> Result<[f64; 2], TankError> {
    let depth = positive("depth of water", depth_m)?;
    let gravity = positive("gravity", gravity_m_s2)?;
    let mode = |side: f64| {
        let k = PI / side;
        libm::sqrt(gravity * k * libm::tanh(k * depth))
    };
    Ok([mode(positive("tank length", length_m)?), mode(positive("tank breadth", breadth_m)?)])
}
