//! Drag coefficients that bodies have.
//!
//! **Setting.** A lint, not a law: a fitted `C_D` on the *frontal* (projected) area
//! far outside the table of known bodies is nearly always a unit or an area slip.
//!
//! | body, on frontal area                    | `C_D`         |
//! |------------------------------------------|---------------|
//! | streamlined body of revolution           | 0.04 .. 0.06  |
//! | ellipsoid 2:1, turbulent                 | 0.07 .. 0.2   |
//! | sphere, sub-critical                     | 0.47          |
//! | short cylinder, axis across (l/d = 1)    | 0.6           |
//! | long cylinder across, sub-critical       | 1.2           |
//! | flat plate across, long                  | 2.0           |
//! | long square prism, half tube             | 2.0 .. 2.3    |
//!
//! Source: Hoerner (1965), Fluid-Dynamic Drag, ch. 3. Below Re ≈ 10³ friction raises
//! all of them: a sphere has 1.09 at Re = 100.

/// Lowest `C_D` on frontal area of a body at Re above 10⁴ \[-\] (Hoerner 1965).
pub const LOWEST_FRONTAL_DRAG_COEFFICIENT: f64 = 0.04;
/// Highest one \[-\] (Hoerner 1965: half tube, hollow side upstream).
pub const HIGHEST_FRONTAL_DRAG_COEFFICIENT: f64 = 2.3;

/// What is to be thought of a `C_D`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Verdict {
    /// Bodies like that exist.
    Plausible,
    /// Below any body on its frontal area.
    TooSmall,
    /// Above any body on its frontal area.
    TooLarge,
    /// The drag drives the body, or is not a number.
    NotResisting,
}

/// Drag coefficient `F / (½ρAU²)` \[-\] of a resistance.
#[must_use]
pub fn drag_coefficient(resistance_n: f64, density_kg_m3: f64, area_m2: f64, speed_m_s: f64) -> f64 {
    resistance_n / (0.5 * density_kg_m3 * area_m2 * speed_m_s * speed_m_s)
}

/// Judges a drag coefficient on frontal area at high Reynolds number.
///
/// # Example
///
/// MCD prints `D_d = 0.0878` for a cylinder of 0.2 m by 0.2 m in water:
///
/// ```
/// use froude_hydro::plausibility::{Verdict, frontal_drag_coefficient};
/// let c_d = 0.0878 / (0.5 * 1000.0 * 0.04);
/// assert_eq!(frontal_drag_coefficient(c_d), Verdict::TooSmall);
/// ```
#[must_use]
pub fn frontal_drag_coefficient(c_d: f64) -> Verdict {
    if c_d.is_nan() || c_d <= 0.0 {
        Verdict::NotResisting
    } else if c_d < LOWEST_FRONTAL_DRAG_COEFFICIENT {
        Verdict::TooSmall
    } else if c_d > HIGHEST_FRONTAL_DRAG_COEFFICIENT {
        Verdict::TooLarge
    } else {
        Verdict::Plausible
    }
}
