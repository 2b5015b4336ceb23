//! Bodies whose added mass or drag has a closed form, or a classic correlation.
//!
//! These are the yardsticks of the workspace: panel results and fitted
//! coefficients are compared with them, never the other way round.
//!
//! **Setting.** One rigid body, unbounded fluid at rest far away; ideal for added
//! mass, viscous for the sphere's drag.
//! **Frame.** Body axes at the centroid, `x` along the axis of revolution.
//! **Units.** SI; a coefficient `[-]` is per mass (inertia) of displaced fluid.
//!
//! | body              | function                            | source               |
//! |-------------------|-------------------------------------|----------------------|
//! | prolate spheroid, end-on    | [`spheroid_axial_coefficient`]      | Lamb 1918, R&M 623 |
//! | prolate spheroid, broadside | [`spheroid_transverse_coefficient`] | Lamb 1918, R&M 623 |
//! | prolate spheroid, turning   | [`spheroid_rotary_coefficient`]     | Lamb 1918, R&M 623 |
//! | sphere, added mass          | [`sphere_added_mass_kg`]            | Lamb 1932, §92       |
//! | sphere, drag                | [`sphere_stokes_drag_n`], [`sphere_drag_coefficient`] | Stokes 1851; Schiller & Naumann 1933 |
//! | elliptic cylinder, per length | [`ellipse_added_mass_kg_m`]       | Lamb 1932, §71       |
//!
//! Not here: walls and free surface ([`near_wall`](crate::near_wall)), oblate bodies and those with three axes
//! ([`ellipsoid`](crate::ellipsoid)).

use core::f64::consts::PI;

/// A slenderness that no prolate spheroid has.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "slenderness {slenderness} is not that of a prolate spheroid; length over diameter must be \
     finite and at least 1"
)]
pub struct SlendernessError {
    /// What was given.
    pub slenderness: f64,
}

fn checked(slenderness: f64) -> Result<f64, SlendernessError> {
    if !(1.0..).contains(&slenderness) || slenderness.is_infinite() {
        return Err(SlendernessError { slenderness });
    }
    Ok(slenderness)
}

/// Lamb's `γ` (there also `α₀`) of a prolate spheroid: 2/3 (sphere) to 0 (needle).
fn lamb_gamma(slenderness: f64) -> f64 {
    let e2 = 1.0 - 1.0 / (slenderness * slenderness); // eccentricity squared
    let excess = if e2 < 0.05 {
        // (atanh e − e)/e³ = Σ e²ⁿ/(2n+3); the first dropped term is below 1e-17.
        (0..12).rev().fold(0.0, |sum, n| sum * e2 + 1.0 / f64::from(2 * n + 3))
    } else {
        let e = libm::sqrt(e2);
        (libm::log(slenderness * (1.0 + e)) - e) / (e * e2) // atanh e, exact for needles
    };
    2.0 * excess / (slenderness * slenderness)
}

/// Added-mass coefficient `k₁` of a prolate spheroid moving end-on.
///
/// The added mass is `k₁ · ρ · V` \[kg\], with `V` the spheroid's volume.
///
/// `slenderness` is length over diameter, `c/a ≥ 1` \[-\]. The result falls from
/// 1/2 (sphere) towards 0 (needle).
///
/// # Errors
///
/// [`SlendernessError`] when `slenderness` is below 1 or not finite: an oblate
/// body needs a different formula.
///
/// # Source
///
/// Lamb (1918), R&M 623, first formula of p. 128; `γ` there is `gamma` here.
/// Near the sphere that formula cancels, so it is summed from its series in
/// `e²` (our derivation).
///
/// # Example
///
/// A hull 1 m long and 0.2 m thick has an axial added mass of 5.9 % of its displaced mass:
///
/// ```
/// # use froude_hydro::closed_form::{SlendernessError, spheroid_axial_coefficient};
/// let k1 = spheroid_axial_coefficient(1.0 / 0.2)?;
/// assert!((k1 - 0.0591).abs() < 1e-4);
/// # Ok::<(), SlendernessError>(())
/// ```
pub fn spheroid_axial_coefficient(slenderness: f64) -> Result<f64, SlendernessError> {
    let gamma = lamb_gamma(checked(slenderness)?);
    Ok(gamma / (2.0 - gamma))
}

/// Added-mass coefficient `k₂` of a prolate spheroid moving broadside.
///
/// The added mass is `k₂ · ρ · V` \[kg\]; from 1/2 (sphere) towards 1 (needle).
///
/// # Errors
///
/// [`SlendernessError`] as for [`spheroid_axial_coefficient`].
///
/// # Source
///
/// Lamb (1918), R&M 623: `k₂ = β₀/(2 − β₀)` with `β₀ = 1 − γ/2`, so that
/// `k₂ = 1/(1 + 2k₁)`. Three printed values there are off by 0.001 to 0.002 (see the
/// tests).
///
/// # Example
///
/// ```
/// # use froude_hydro::closed_form::{SlendernessError, spheroid_transverse_coefficient};
/// assert!((spheroid_transverse_coefficient(5.0)? - 0.8943).abs() < 1e-3);
/// # Ok::<(), SlendernessError>(())
/// ```
pub fn spheroid_transverse_coefficient(slenderness: f64) -> Result<f64, SlendernessError> {
    let gamma = lamb_gamma(checked(slenderness)?);
    Ok((2.0 - gamma) / (2.0 + gamma))
}

/// Added-inertia coefficient `k′` of a prolate spheroid turning end over end.
///
/// The added inertia is `k′ · ρV(c² + a²)/5` \[kg m²\], with `c`, `a` the semi-axes;
/// from 0 (sphere) towards 1 (needle).
///
/// # Errors
///
/// [`SlendernessError`] as for [`spheroid_axial_coefficient`].
///
/// # Source
///
/// Lamb (1918), R&M 623: `k′ = e⁴(β₀−γ) / ((2−e²)(2e² − (2−e²)(β₀−γ)))`. Near the
/// sphere `β₀ − γ = 6 Σ e²ⁿ/((2n+1)(2n+3))`, n from 1 (our derivation).
///
/// # Example
///
/// ```
/// # use froude_hydro::closed_form::{SlendernessError, spheroid_rotary_coefficient};
/// assert!((spheroid_rotary_coefficient(2.51)? - 0.367).abs() < 1e-3);
/// # Ok::<(), SlendernessError>(())
/// ```
pub fn spheroid_rotary_coefficient(slenderness: f64) -> Result<f64, SlendernessError> {
    let slenderness = checked(slenderness)?;
    let e2 = 1.0 - 1.0 / (slenderness * slenderness);
    // d = (β₀ − γ)/e², 2/5 for the sphere.
    let d = if e2 < 0.05 {
        6.0 * (1..13).rev().fold(0.0, |sum, n| sum * e2 + 1.0 / (f64::from(2 * n + 1) * f64::from(2 * n + 3)))
    } else {
        (1.0 - 1.5 * lamb_gamma(slenderness)) / e2
    };
    let q = 2.0 - e2;
    Ok(e2 * e2 * d / (q * (2.0 - q * d)))
}

/// Added mass of a sphere, `½ρV` \[kg\] (Lamb 1932, §92).
#[must_use]
pub fn sphere_added_mass_kg(density_kg_m3: f64, radius_m: f64) -> f64 {
    2.0 / 3.0 * PI * density_kg_m3 * radius_m * radius_m * radius_m
}

/// Drag of a sphere in creeping flow, `6πμRU` \[N\], opposing the motion.
///
/// Valid for Re (on the diameter) well below 1; low by 5 % at Re = 0.3 (Oseen:
/// factor `1 + 3Re/16`).
///
/// # Source
///
/// Stokes (1851).
#[must_use]
pub fn sphere_stokes_drag_n(dynamic_viscosity_pa_s: f64, radius_m: f64, speed_m_s: f64) -> f64 {
    6.0 * PI * dynamic_viscosity_pa_s * radius_m * speed_m_s
}

/// A Reynolds number that the sphere's drag correlation does not cover.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("Reynolds number {reynolds} is outside 0 to 800 (above 0), the range of Schiller and Naumann")]
pub struct SphereRangeError {
    /// What was given.
    pub reynolds: f64,
}

/// Drag coefficient of a sphere, `C_D = 24/Re (1 + 0.15 Re^0.687)` \[-\].
///
/// On `πR²`, Re on the diameter, `0 < Re ≤ 800`; within 5 % of measurements.
///
/// # Errors
///
/// [`SphereRangeError`] outside that range.
///
/// # Source
///
/// Schiller and Naumann (1933); Clift, Grace and Weber (1978), Table 5.1.
///
/// # Example
///
/// ```
/// # use froude_hydro::closed_form::{SphereRangeError, sphere_drag_coefficient};
/// assert!((sphere_drag_coefficient(100.0)? - 1.09).abs() < 0.01);
/// # Ok::<(), SphereRangeError>(())
/// ```
pub fn sphere_drag_coefficient(reynolds: f64) -> Result<f64, SphereRangeError> {
    if !(reynolds > 0.0 && reynolds <= 800.0) {
        return Err(SphereRangeError { reynolds });
    }
    Ok(24.0 / reynolds * (1.0 + 0.15 * libm::pow(reynolds, 0.687)))
}

/// Added mass per length of an elliptic cylinder moving across, `ρπc²` \[kg/m\].
///
/// `c` is the semi-axis *normal* to the motion: the area it sweeps counts, not its
/// thickness. A link in sway has `c = a`, the vertical one.
///
/// # Source
///
/// Lamb (1932), §71.
#[must_use]
pub fn ellipse_added_mass_kg_m(density_kg_m3: f64, semi_axis_across_motion_m: f64) -> f64 {
    density_kg_m3 * PI * semi_axis_across_motion_m * semi_axis_across_motion_m
}
