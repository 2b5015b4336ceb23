//! Added mass of an ellipsoid with any three semi-axes.
//!
//! Prolate, oblate, flat or a needle, axes in any order: one expression serves all. It is the yardstick of panel
//! results on bodies without an axis of revolution.
//!
//! **Setting.** One rigid ellipsoid, unbounded ideal fluid at rest far away.
//! **Frame.** The principal axes at the centre; semi-axis 1 along `x`, 2 along `y`, 3 along `z`. The 6 × 6 matrix is
//! diagonal there: an ellipsoid has three planes of symmetry.
//! **Units.** SI; an added mass over ρ has m³, an added inertia over ρ m⁵.
//!
//! **Method.** Lamb's α₀, β₀, γ₀ (1932, §114) are Carlson's R_D; with `x, y, z` the squared semi-axes and `Δ² = (x+t)(y+t)(z+t)`,
//!
//! ```text
//! D_x = ∫ dt / ((x+t) Δ)         α₀ = abc D_x = ⅔ abc R_D(y, z, x)
//! J_x = ∫ dt / ((y+t)(z+t) Δ)    γ₀ − β₀ = abc (y − z) J_x
//! K_x = ∫ t dt / ((y+t)(z+t) Δ)  2 − (y + z) abc J_x = α₀ + 2 abc K_x        (all over t from 0 to ∞)
//! ```
//!
//! so that Lamb's quotients lose their differences and every term left is positive:
//!
//! ```text
//! k₁ = α₀/(2 − α₀) = α₀/(β₀ + γ₀)
//! A₄₄/ρ = V/5 · (b² − c²)² · abc J_x / (α₀ + 2 abc K_x)
//! ```
//!
//! Duplication (Carlson 1995, Numerical Algorithms 10, 13–26) carries over to J and K (our derivation): with
//! `λ = √(xy) + √(yz) + √(zx)` and primes for arguments `(x+λ)/4` …,
//!
//! ```text
//! D_x = ¼ D_x′ + 2 / (√x (x+λ))
//! J_x = J_x′/16 + 2 (y + √(yz) + z + λ) / ((√y+√z) √(yz) (y+λ)(z+λ))
//! K_x = ¼ K_x′ + λ J_x′/16 + 2 √x / ((y+λ)(z+λ))
//! ```
//!
//! Arguments draw together four times a step; the last step is Carlson's series about their mean.
//!
//! Not here: walls, free surface, bodies that are cut.

use core::f64::consts::PI;

/// Semi-axes that no ellipsoid of ours has.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "semi-axes {:?} m are not those of an ellipsoid; all three must be finite and above 0, and the longest at most \
     1e12 times the shortest",
    semi_axes_m
)]
pub struct EllipsoidError {
    /// What was given.
    pub semi_axes_m: [f64; 3],
}

/// Longest over shortest semi-axis: as far as the tests go.
const MAX_RATIO: f64 = 1e12;

/// Spread of the arguments, as part of their mean, at which the series takes over. The first dropped term, of order
/// 8, is below 1e-17.
const SPREAD: f64 = 0.01;

/// Volume of an ellipsoid, `4/3 π abc` \[m³\].
#[must_use]
pub fn ellipsoid_volume_m3(semi_axes_m: [f64; 3]) -> f64 {
    let [a, b, c] = semi_axes_m;
    4.0 / 3.0 * PI * a * b * c
}

/// Diagonal of an ellipsoid's added mass over ρ about its centre: surge, sway, heave \[m³\], roll, pitch, yaw \[m⁵\].
///
/// All other elements are 0. Relative error below 1e-13, equal and nearly equal axes included, for semi-axes up to
/// 1e12 apart (as long as their fifth power is a number).
///
/// # Errors
///
/// [`EllipsoidError`] when a semi-axis is not positive and finite, or they lie further apart.
///
/// # Source
///
/// Lamb (1932), §114, and §115 for turning,
/// `A₄₄/ρ = V/5 · (b²−c²)²(γ₀−β₀) / (2(b²−c²) + (b²+c²)(β₀−γ₀))`, in the form of the module's head.
///
/// # Example
///
/// A thin disc has 2/π of the mass of the sphere of fluid of its radius, `8/3 ρ a³`:
///
/// ```
/// # use froude_hydro::ellipsoid::{EllipsoidError, ellipsoid_added_mass};
/// let heave_m3 = ellipsoid_added_mass([1.0, 1.0, 1e-9])?[2];
/// assert!((heave_m3 - 8.0 / 3.0).abs() < 1e-8);
/// # Ok::<(), EllipsoidError>(())
/// ```
pub fn ellipsoid_added_mass(semi_axes_m: [f64; 3]) -> Result<[f64; 6], EllipsoidError> {
    let (axes, unit_m) = scaled(semi_axes_m)?;
    let integrals = Integrals::of(axes.map(|a| a * a));
    let volume = ellipsoid_volume_m3(axes);
    let cube_m3 = unit_m * unit_m * unit_m;
    let mut over_density = [0.0; 6];
    for i in 0..3 {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        let [own, next, after] = [i, j, k].map(|axis| integrals.d[axis]);
        over_density[i] = cube_m3 * volume * own / (next + after);
        let difference = (axes[j] - axes[k]) * (axes[j] + axes[k]);
        let turning = integrals.j[i] / (own + 2.0 * integrals.k[i]);
        over_density[3 + i] = cube_m3 * (unit_m * unit_m) * volume / 5.0 * difference * difference * turning;
    }
    Ok(over_density)
}

/// Semi-axes over a power of two near the longest, and that unit: nothing is rounded, so differences stay exact.
fn scaled(semi_axes_m: [f64; 3]) -> Result<([f64; 3], f64), EllipsoidError> {
    let (shortest, longest) =
        semi_axes_m.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &a| (low.min(a), high.max(a)));
    let is_number = semi_axes_m.iter().all(|a| a.is_finite() && *a > 0.0);
    if !is_number || shortest * MAX_RATIO < longest {
        return Err(EllipsoidError { semi_axes_m });
    }
    let unit_m = libm::ldexp(1.0, libm::frexp(longest).1);
    Ok((semi_axes_m.map(|a| a / unit_m), unit_m))
}

/// D, J and K of the three axes, as in the module's head.
#[derive(Clone, Copy)]
struct Integrals {
    d: [f64; 3],
    j: [f64; 3],
    k: [f64; 3],
}

impl Integrals {
    /// From the squared semi-axes. Four to eight steps, up to 1e12 between the axes.
    fn of(squares: [f64; 3]) -> Self {
        let mean = squares.iter().sum::<f64>() / 3.0;
        let spread = squares.iter().fold(0.0_f64, |most, s| most.max((s - mean).abs()));
        if spread <= SPREAD * mean {
            return Self::of_near(squares);
        }
        let [r, s, t] = squares.map(libm::sqrt);
        let lambda = r * s + s * t + t * r;
        let last = Self::of(squares.map(|q| 0.25 * (q + lambda)));
        let mut this = last;
        for i in 0..3 {
            let [x, y, z] = [i, (i + 1) % 3, (i + 2) % 3].map(|axis| squares[axis]);
            let [r, s, t] = [x, y, z].map(libm::sqrt);
            let sides = (y + lambda) * (z + lambda);
            this.d[i] = 0.25 * last.d[i] + 2.0 / (r * (x + lambda));
            this.j[i] = last.j[i] / 16.0 + 2.0 * (y + s * t + z + lambda) / ((s + t) * (s * t) * sides);
            this.k[i] = 0.25 * last.k[i] + lambda / 16.0 * last.j[i] + 2.0 * r / sides;
        }
        this
    }

    /// The same for arguments within [`SPREAD`] of their mean.
    fn of_near(squares: [f64; 3]) -> Self {
        let mut this = Self { d: [0.0; 3], j: [0.0; 3], k: [0.0; 3] };
        for i in 0..3 {
            let own = [i, (i + 1) % 3, (i + 2) % 3].map(|axis| squares[axis]);
            // ∫ t^(a′−1) Π (t + z_i)^(−b_i) dt = B(a, a′) R₋ₐ(b; z), a + a′ = Σ b (Carlson 1977).
            this.d[i] = 2.0 / 3.0 * carlson_r(3, [3, 1, 1], own);
            this.j[i] = 2.0 / 5.0 * carlson_r(5, [1, 3, 3], own);
            this.k[i] = 4.0 / 15.0 * carlson_r(3, [1, 3, 3], own);
        }
        this
    }
}

/// Carlson's `R₋ₐ(b; z)` for nearly equal `z`, by its series about their mean; `a` and `b` in halves.
///
/// `R₋ₐ = A⁻ᵃ Σ (a)_N/(c)_N T_N`, with A the mean of `z` weighted by `b`, `c = Σ b` and
/// `N T_N = Σ_k T_(N−k) Σ_i b_i (1 − z_i/A)^k` (Carlson 1995, with power sums for his symmetric functions).
fn carlson_r(a_halves: u8, b_halves: [u8; 3], z: [f64; 3]) -> f64 {
    const ORDER: usize = 7;
    let (a, b) = (0.5 * f64::from(a_halves), b_halves.map(|b| 0.5 * f64::from(b)));
    let c: f64 = b.iter().sum();
    let mean = b.iter().zip(z).map(|(b, z)| b * z).sum::<f64>() / c;
    let deviation = z.map(|z| (mean - z) / mean);
    let mut power = b;
    let mut sums = [0.0; ORDER + 1];
    let mut t = [0.0; ORDER + 1];
    t[0] = 1.0;
    let (mut factor, mut series) = (1.0, 1.0);
    for n in 1..=ORDER {
        for i in 0..3 {
            power[i] *= deviation[i];
        }
        sums[n] = power.iter().sum();
        t[n] = (1..=n).map(|k| sums[k] * t[n - k]).sum::<f64>() / n as f64;
        let before = (n - 1) as f64;
        factor *= (a + before) / (c + before);
        series += factor * t[n];
    }
    series / libm::pow(mean, a)
}
