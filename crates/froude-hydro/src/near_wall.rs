//! Added mass of a sphere near a plane, or inside a shell.
//!
//! Yardsticks for walls, a rigid lid and a surface with φ = 0 in the panel method: what mirrors and several bodies
//! are checked against.
//!
//! **Setting.** A sphere of radius `a` in ideal fluid: above a plane, its centre `h` away, else unbounded; or at the
//! centre of a spherical shell of radius `b`, fluid between the two.
//! **Boundary.** [`Boundary::Rigid`]: no flow through it (tank wall, bed; a free surface at zero frequency).
//! [`Boundary::Pressureless`]: φ = 0 (a free surface at infinite frequency).
//! **Units.** A coefficient `[-]` is per displaced mass `4/3 πρa³`; ½ in unbounded fluid.
//!
//! | what | function | source |
//! |------|----------|--------|
//! | plane, any distance from 1.05 a | [`sphere_near_plane`]         | multipoles (our derivation) |
//! | plane, motion along its normal  | [`sphere_normal_to_plane`]    | images: Hicks 1880; Lamb 1932, §98 |
//! | plane, far away                 | [`sphere_far_from_plane`]     | Lamb 1932, §98, §99 |
//! | shell around the sphere         | [`sphere_in_shell`]           | Lamb 1932, §93; φ = 0 our derivation |
//!
//! Not here: rotation (a sphere's is free), corners, finite frequency.

/// What the fluid ends at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Boundary {
    /// No flow through it.
    Rigid,
    /// φ = 0 on it.
    Pressureless,
}

impl Boundary {
    /// Sign of the image's potential: +1 or −1.
    fn image(self) -> f64 {
        match self {
            Self::Rigid => 1.0,
            Self::Pressureless => -1.0,
        }
    }
}

/// How the sphere moves by the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Along the plane.
    Parallel,
    /// Towards it or away.
    Normal,
}

/// A distance or radius that leaves no room for the sphere, or too little for the formula.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error("{what} is {ratio} sphere radii; it must be a number of at least {least}")]
pub struct ClearanceError {
    /// Which length.
    pub what: &'static str,
    /// It, over the sphere's radius.
    pub ratio: f64,
    /// The smallest that is answered.
    pub least: f64,
}

fn checked(what: &'static str, length_m: f64, radius_m: f64, least: f64) -> Result<f64, ClearanceError> {
    let ratio = length_m / radius_m;
    if !(radius_m > 0.0 && ratio >= least) {
        return Err(ClearanceError { what, ratio, least });
    }
    Ok(ratio)
}

/// Added-mass coefficient of a sphere far from a plane \[-\], to leading order in `a/h`.
///
/// Along the plane `½ (1 ± 3/16 (a/h)³)`, square to it `½ (1 ± 3/8 (a/h)³)`; plus for a rigid plane. What is left out is
/// `½ · 3/256 (a/h)⁶` along and `½ · 3/64 (a/h)⁶` square to it, for either boundary: at `h = 2a` 1e-4 and 4e-4.
///
/// # Errors
///
/// [`ClearanceError`] when the distance is below the radius.
///
/// # Source
///
/// Lamb (1932), §98 (square) and §99 (along); Milne-Thomson, Theoretical Hydrodynamics, ch. 16. The next order is ours.
pub fn sphere_far_from_plane(
    boundary: Boundary,
    direction: Direction,
    radius_m: f64,
    distance_m: f64,
) -> Result<f64, ClearanceError> {
    let ratio = checked("distance of the sphere's centre from the plane", distance_m, radius_m, 1.0)?;
    let part = match direction {
        Direction::Parallel => 3.0 / 16.0,
        Direction::Normal => 3.0 / 8.0,
    };
    Ok(0.5 * (1.0 + boundary.image() * part / (ratio * ratio * ratio)))
}

/// Orders of multipoles kept by [`sphere_near_plane`].
const ORDERS: usize = 64;

/// Least distance over radius there; the last multipole is then below 2e-10 of the first,
/// and counts by its square.
const LEAST_DISTANCE: f64 = 1.05;

/// Added-mass coefficient of a sphere near a plane \[-\], at any distance from 1.05 radii.
///
/// Absolute error below 1e-13. `distance_m` is from the centre to the plane.
///
/// # Errors
///
/// [`ClearanceError`] when the distance is below 1.05 radii: the series then needs more terms than are kept. Motion
/// square to the plane is answered up to contact by [`sphere_normal_to_plane`].
///
/// # Source
///
/// Our derivation. With `a = 1`, `d = 2h` and multipoles `Bₙ Pₙᵐ/rⁿ⁺¹` in the sphere (m = 0 square to the plane, 1 along
/// it) and in its image, seen from the sphere as `(n+l)!/((l−m)!(n+m)!) rⁿ/dⁿ⁺ˡ⁺¹ Pₙᵐ` (translation of solid
/// harmonics along their axis), the surface asks
///
/// ```text
/// (n+1) Bₙ − s n Σ_l (n+l)!/((l−m)!(n+m)!) B_l / dⁿ⁺ˡ⁺¹ = −[n = 1]      k = −(1 + 3 B₁)
/// ```
///
/// with `s` = ±1 for the boundary. Its first terms, `q = a/h`:
/// `k = ½ (1 + 3/16 s q³ + 3/256 q⁶ + 3/256 q⁸ + …)` along, `½ (1 + 3/8 s q³ + 3/64 q⁶ + …)` square to the plane.
///
/// # Example
///
/// One diameter under a rigid lid a sphere has 2.4 % more added mass than in open water:
///
/// ```
/// # use froude_hydro::near_wall::{Boundary, ClearanceError, Direction, sphere_near_plane};
/// let k = sphere_near_plane(Boundary::Rigid, Direction::Parallel, 0.1, 0.2)?;
/// assert!((k / 0.5 - 1.0237).abs() < 1e-4);
/// # Ok::<(), ClearanceError>(())
/// ```
pub fn sphere_near_plane(
    boundary: Boundary,
    direction: Direction,
    radius_m: f64,
    distance_m: f64,
) -> Result<f64, ClearanceError> {
    let ratio = checked("distance of the sphere's centre from the plane", distance_m, radius_m, LEAST_DISTANCE)?;
    let (inverse, m) = (0.5 / ratio, if direction == Direction::Parallel { 1.0 } else { 0.0 });
    let mut b = [0.0; ORDERS];
    b[0] = -0.5;
    // Gauss–Seidel: 26 sweeps at the least distance, 10 at two radii; the cap is never met.
    for _ in 0..200 {
        let mut change = 0.0_f64;
        // First factor of a row, l = 1: (n+1)!/((1−m)!(n+m)!) d^−(n+2).
        let mut first = 0.0;
        for row in 0..ORDERS {
            let n = (row + 1) as f64;
            first = match row {
                0 => (2.0 - m) * inverse * inverse * inverse,
                _ => first * inverse * (n + 1.0) / (n + m),
            };
            let (mut factor, mut sum) = (first, 0.0);
            for (column, value) in b.iter().enumerate() {
                let l = (column + 1) as f64;
                sum += factor * value;
                factor *= inverse * (n + l + 1.0) / (l + 1.0 - m);
            }
            let source = if row == 0 { -1.0 } else { 0.0 };
            let next = (source + boundary.image() * n * sum) / (n + 1.0);
            change = change.max((next - b[row]).abs());
            b[row] = next;
        }
        if change < 1e-17 {
            break;
        }
    }
    Ok(-(1.0 + 3.0 * b[0]))
}

/// Added-mass coefficient of a sphere moving square to a plane \[-\], up to contact.
///
/// At contact `½ (3 ζ(3) − 2) = 0.8031` for a rigid plane, `½ (9/4 ζ(3) − 2) = 0.3523` for φ = 0. Absolute error below 1e-13
/// there and from 1.000001 radii on, 1e-9 between.
///
/// # Errors
///
/// [`ClearanceError`] when the distance is below the radius.
///
/// # Source
///
/// Images of doublets on the axis: Hicks (1880), Phil. Trans. 171; Lamb (1932), §98. A doublet at distance `f` from the
/// centre has its image at `a²/f`, times `−(a/f)³`; the plane turns it round (rigid) or not. With strengths `μᵢ` in the
/// sphere, `k = 3 Σμᵢ/(a³U) − 1` (Taylor 1928).
///
/// # Example
///
/// ```
/// # use froude_hydro::near_wall::{Boundary, ClearanceError, sphere_normal_to_plane};
/// assert!((sphere_normal_to_plane(Boundary::Rigid, 1.0, 1.0)? - 0.8031).abs() < 1e-4);
/// # Ok::<(), ClearanceError>(())
/// ```
pub fn sphere_normal_to_plane(boundary: Boundary, radius_m: f64, distance_m: f64) -> Result<f64, ClearanceError> {
    let ratio = checked("distance of the sphere's centre from the plane", distance_m, radius_m, 1.0)?;
    // Strengths at contact fall as 1/i³ only: the rest of the sum is added as an integral (midpoint, error 1/i⁴).
    const IMAGES: u32 = 20_000;
    let (mut place, mut strength, mut sum) = (0.0_f64, 0.5_f64, 0.0);
    let mut i = 1;
    loop {
        sum += strength;
        if strength.abs() < 1e-18 || i == IMAGES {
            break;
        }
        place = 1.0 / (2.0 * ratio - place);
        strength *= boundary.image() * place * place * place;
        i += 1;
    }
    if i == IMAGES {
        let next = f64::from(IMAGES);
        sum += match boundary {
            Boundary::Rigid => 0.5 * strength * next * (next / (next + 0.5)) * (next / (next + 0.5)),
            Boundary::Pressureless => -0.5 * strength,
        };
    }
    Ok(3.0 * sum - 1.0)
}

/// Added-mass coefficient of a sphere at the centre of a spherical shell \[-\].
///
/// Rigid shell `½ (b³ + 2a³)/(b³ − a³)`; shell with φ = 0 `(b³ − a³)/(2b³ + a³)`.
///
/// # Errors
///
/// [`ClearanceError`] when the shell is not larger than the sphere.
///
/// # Source
///
/// Lamb (1932), §93 (Stokes 1843) for the rigid shell. For φ = 0, with `φ = (Ar + B/r²) cos θ`: `φ(b) = 0` gives `A = −B/b³`,
/// `∂φ/∂r = cos θ` at `a` gives `B = −a³b³/(a³ + 2b³)`, and `k = −φ(a)/(a cos θ)` (our derivation).
///
/// # Example
///
/// ```
/// # use froude_hydro::near_wall::{Boundary, ClearanceError, sphere_in_shell};
/// assert!((sphere_in_shell(Boundary::Rigid, 1.0, 2.0)? - 0.714286).abs() < 1e-6);
/// # Ok::<(), ClearanceError>(())
/// ```
pub fn sphere_in_shell(boundary: Boundary, radius_m: f64, shell_radius_m: f64) -> Result<f64, ClearanceError> {
    let ratio = checked("shell radius", shell_radius_m, radius_m, 1.0)?;
    let inside = 1.0 / (ratio * ratio * ratio);
    if inside >= 1.0 {
        return Err(ClearanceError { what: "shell radius", ratio, least: 1.0 });
    }
    Ok(match boundary {
        Boundary::Rigid => 0.5 * (1.0 + 2.0 * inside) / (1.0 - inside),
        Boundary::Pressureless => (1.0 - inside) / (2.0 + inside),
    })
}
