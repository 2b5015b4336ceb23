//! Numbers that say where a test is valid.
//!
//! **Units.** SI in, dimensionless out.
//!
//! | number              | formula                      | function                 | source |
//! |---------------------|------------------------------|--------------------------|--------|
//! | Reynolds            | `U L / ν`                    | [`reynolds`]             | |
//! | Froude, length      | `U / √(gL)`                  | [`froude`]               | Froude 1874 |
//! | Froude, depth       | `U / √(gh)`                  | [`froude`] with the depth | |
//! | Keulegan–Carpenter  | `U_m T / D`                  | [`keulegan_carpenter`]   | Keulegan & Carpenter 1958 |
//! | blockage            | `A / section`                | [`blockage`]             | |
//! | friction line       | `0.075 / (log₁₀ Re − 2)²`    | [`friction_ittc57`]      | ITTC 1957 |
//! | laminar friction    | `1.328 / √Re`                | [`friction_laminar`]     | Blasius 1908 |

/// Acceleration of gravity used for Froude numbers, m/s².
pub const GRAVITY_M_S2: f64 = 9.80665;

/// Reynolds number `U L / ν` \[-\], of the speed's magnitude.
///
/// # Example
///
/// A link 0.18 m long at 0.4 m/s in fresh water of 15 degC:
///
/// ```
/// use froude_hydro::similarity::reynolds;
/// assert!((reynolds(0.4, 0.18, 1.1386e-6) - 63_236.0).abs() < 1.0);
/// ```
#[must_use]
pub fn reynolds(speed_m_s: f64, length_m: f64, kinematic_viscosity_m2_s: f64) -> f64 {
    speed_m_s.abs() * length_m / kinematic_viscosity_m2_s
}

/// Froude number `U / √(gL)` \[-\]; by depth when `length_m` is the water depth.
///
/// By submergence it tells when waves matter: below about 0.3 they do not.
#[must_use]
pub fn froude(speed_m_s: f64, length_m: f64) -> f64 {
    speed_m_s.abs() / libm::sqrt(GRAVITY_M_S2 * length_m)
}

/// Keulegan–Carpenter number `U_m T / D` \[-\] of an oscillation.
///
/// For a harmonic motion of amplitude `A` it is `2πA/D`.
#[must_use]
pub fn keulegan_carpenter(speed_amplitude_m_s: f64, period_s: f64, width_m: f64) -> f64 {
    speed_amplitude_m_s.abs() * period_s / width_m
}

/// Blockage: the body's frontal area over the area of the tank's section \[-\].
///
/// Above about 0.01 the measured drag of a bluff body is high by several times the
/// blockage (Maskell 1963 has `1 + 2.5..5 · C_D · A/S` for it).
#[must_use]
pub fn blockage(frontal_area_m2: f64, section_area_m2: f64) -> f64 {
    frontal_area_m2 / section_area_m2
}

/// A Reynolds number that the friction line does not cover.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("Reynolds number {reynolds} is below 1000, where the ITTC-57 line has no meaning")]
pub struct FrictionLineError {
    /// What was given.
    pub reynolds: f64,
}

/// ITTC-57 model-ship correlation line, `C_F = 0.075 / (log₁₀ Re − 2)²` \[-\].
///
/// On the wetted area; USR's `C_f` is on half of it, so `C_f = 2 C_F`. The flow is
/// turbulent on the line: below Re ≈ 5·10⁵ a smooth body may be laminar.
///
/// # Errors
///
/// [`FrictionLineError`] below Re = 1000 (the line is singular at 100) or for a
/// number that is not finite.
///
/// # Source
///
/// ITTC (1957), Proc. 8th ITTC Madrid.
///
/// # Example
///
/// ```
/// use froude_hydro::similarity::friction_ittc57;
/// assert!((friction_ittc57(1e7)? - 3.0e-3).abs() < 1e-15);
/// # Ok::<(), froude_hydro::similarity::FrictionLineError>(())
/// ```
pub fn friction_ittc57(reynolds: f64) -> Result<f64, FrictionLineError> {
    if !(1e3..).contains(&reynolds) || reynolds.is_infinite() {
        return Err(FrictionLineError { reynolds });
    }
    let x = libm::log10(reynolds) - 2.0;
    Ok(0.075 / (x * x))
}

/// Laminar friction of a flat plate, `C_F = 1.328 / √Re` \[-\], on the wetted area.
///
/// # Source
///
/// Blasius (1908).
#[must_use]
pub fn friction_laminar(reynolds: f64) -> f64 {
    1.328 / libm::sqrt(reynolds)
}
