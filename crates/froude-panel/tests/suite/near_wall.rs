//! Added mass of a sphere near a plane, or inside a shell: reference solutions for mirror planes and for several bodies.
//!
//! **Setting.** A sphere of radius 1 in ideal fluid: its centre `h` from a plane, else unbounded; or at the centre of a spherical
//! shell of radius `b`, fluid between the two. Coefficients `[-]` are per displaced mass; ½ in unbounded fluid.
//!
//! Capytaine 3.0 (direct method, limits of frequency, 3,136 panels) gives the same from h = 1.2 on, both boundaries, to
//! 7e-5 along and 1.6e-4 square to the plane; square to it the difference falls with the mesh.

use froude_panel::mirror::Kind::{self, FreeSurface, Wall};

/// Apéry's constant, `Σ 1/i³`.
const ZETA_3: f64 = 1.202_056_903_159_594_2;

const BOUNDARIES: [Kind; 2] = [Wall, FreeSurface];

/// How the sphere moves by the plane.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Direction {
    /// Along the plane.
    Parallel,
    /// Towards it or away.
    Normal,
}

use Direction::{Normal, Parallel};

/// Sign of the image's potential at a wall or a free surface.
fn image(boundary: Kind) -> f64 {
    if boundary == Wall { 1.0 } else { -1.0 }
}

/// Far from a plane, to leading order in `1/h`: Lamb (1932), §98 (square) and §99 (along).
///
/// What is left out is `½ · 3/256 h⁻⁶` along and `½ · 3/64 h⁻⁶` square to it (our derivation), for either boundary.
pub fn far_from_plane(boundary: Kind, direction: Direction, h: f64) -> f64 {
    let part = if direction == Parallel { 3.0 / 16.0 } else { 3.0 / 8.0 };
    0.5 * (1.0 + image(boundary) * part / (h * h * h))
}

/// Orders of multipoles kept by [`near_plane`]: at h = 1.05 the last is below 2e-10 of the first, and enters squared.
const ORDERS: usize = 64;

/// Near a plane, at any distance from h = 1.05: absolute error below 1e-13.
///
/// Our derivation. With `d = 2h` and multipoles `Bₙ Pₙᵐ/rⁿ⁺¹` in the sphere (m = 0 square to the plane, 1 along
/// it) and in its image, seen from the sphere as `(n+l)!/((l−m)!(n+m)!) rⁿ/dⁿ⁺ˡ⁺¹ Pₙᵐ` (translation of solid
/// harmonics along their axis), the surface asks
///
/// ```text
/// (n+1) Bₙ − s n Σ_l (n+l)!/((l−m)!(n+m)!) B_l / dⁿ⁺ˡ⁺¹ = −[n = 1]      k = −(1 + 3 B₁)
/// ```
///
/// with `s` = ±1 for the boundary. Its first terms, `q = 1/h`:
/// `k = ½ (1 + 3/16 s q³ + 3/256 q⁶ + 3/256 q⁸ + …)` along, `½ (1 + 3/8 s q³ + 3/64 q⁶ + …)` square to the plane.
fn near_plane(boundary: Kind, direction: Direction, h: f64) -> f64 {
    let (inverse, m) = (0.5 / h, if direction == Parallel { 1.0 } else { 0.0 });
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
            let next = (source + image(boundary) * n * sum) / (n + 1.0);
            change = change.max((next - b[row]).abs());
            b[row] = next;
        }
        if change < 1e-17 {
            break;
        }
    }
    -(1.0 + 3.0 * b[0])
}

/// Square to a plane, up to contact: absolute error below 1e-13 there and from h = 1.000001 on, 1e-9 between.
///
/// Images of doublets on the axis: Hicks (1880), Phil. Trans. 171; Lamb (1932), §98. A doublet at distance `f` from the
/// centre has its image at `1/f`, times `−1/f³`; the plane turns it round (rigid) or not. With strengths `μᵢ` in the
/// sphere, `k = 3 Σμᵢ/U − 1` (Taylor 1928).
pub fn normal_to_plane(boundary: Kind, h: f64) -> f64 {
    // Strengths at contact fall as 1/i³ only: the rest of the sum is added as an integral (midpoint, error 1/i⁴).
    const IMAGES: u32 = 20_000;
    let (mut place, mut strength, mut sum) = (0.0_f64, 0.5_f64, 0.0);
    let mut i = 1;
    loop {
        sum += strength;
        if strength.abs() < 1e-18 || i == IMAGES {
            break;
        }
        place = 1.0 / (2.0 * h - place);
        strength *= image(boundary) * place * place * place;
        i += 1;
    }
    if i == IMAGES {
        let next = f64::from(IMAGES);
        sum += if boundary == Wall {
            0.5 * strength * next * (next / (next + 0.5)) * (next / (next + 0.5))
        } else {
            -0.5 * strength
        };
    }
    3.0 * sum - 1.0
}

/// At the centre of a spherical shell of radius `b`: `½ (b³ + 2)/(b³ − 1)` if it is rigid, `(b³ − 1)/(2b³ + 1)` with φ = 0 on it.
///
/// Lamb (1932), §93 (Stokes 1843) for the rigid shell. For φ = 0, with `φ = (Ar + B/r²) cos θ`: `φ(b) = 0` gives `A = −B/b³`,
/// `∂φ/∂r = cos θ` at 1 gives `B = −b³/(1 + 2b³)`, and `k = −φ(1)/cos θ` (our derivation).
pub fn in_shell(boundary: Kind, b: f64) -> f64 {
    let inside = 1.0 / (b * b * b);
    if boundary == Wall { 0.5 * (1.0 + 2.0 * inside) / (1.0 - inside) } else { (1.0 - inside) / (2.0 + inside) }
}

/// Far away only the first orders are left: the next is of order `q⁹`, times some 0.01.
#[test]
fn the_first_orders_are_those_of_lamb_and_the_next_ones_ours() {
    for h in [3.0, 5.0, 9.0] {
        let q = 1.0_f64 / h;
        for (boundary, sign) in [(Wall, 1.0), (FreeSurface, -1.0)] {
            let along = 0.5 * (1.0 + 3.0 / 16.0 * sign * q.powi(3) + 3.0 / 256.0 * (q.powi(6) + q.powi(8)));
            let found = near_plane(boundary, Parallel, h);
            assert!((found - along).abs() < 0.02 * q.powi(9), "{h} {boundary:?}: {}", (found - along) / q.powi(9));
            let lamb = far_from_plane(boundary, Parallel, h);
            assert!((found - lamb).abs() < 0.5 * 3.0 / 256.0 * 1.2 * q.powi(6));

            let square = 0.5 * (1.0 + 3.0 / 8.0 * sign * q.powi(3) + 3.0 / 64.0 * q.powi(6));
            let found = near_plane(boundary, Normal, h);
            assert!((found - square).abs() < 0.05 * q.powi(8), "{h} {boundary:?}: {}", (found - square) / q.powi(8));
            let lamb = far_from_plane(boundary, Normal, h);
            assert!((found - lamb).abs() < 0.5 * 3.0 / 64.0 * 1.2 * q.powi(6));
        }
    }
}

/// Two ways to one number: multipoles about the centre, and doublets at their image points.
#[test]
fn multipoles_and_images_agree() {
    for boundary in BOUNDARIES {
        for h in [1.05, 1.1, 1.3, 2.0, 4.0, 50.0] {
            let (multipoles, images) = (near_plane(boundary, Normal, h), normal_to_plane(boundary, h));
            assert!((multipoles - images).abs() < 1e-13, "{boundary:?} {h}: {:e}", multipoles - images);
        }
    }
}

/// At contact the images lie at 1/2, 2/3, 3/4 … with strengths `1/i³`.
#[test]
fn at_contact_the_sum_is_aperys_constant() {
    let rigid = normal_to_plane(Wall, 1.0);
    assert!((rigid - 0.5 * (3.0 * ZETA_3 - 2.0)).abs() < 1e-13, "{rigid}");
    let pressureless = normal_to_plane(FreeSurface, 1.0);
    assert!((pressureless - 0.5 * (2.25 * ZETA_3 - 2.0)).abs() < 1e-13, "{pressureless}");
    // Almost there: `h = cosh α`, strengths `(sinh α/sinh iα)³`, summed to the last bit.
    for clearance in [1e-4, 1e-6, 1e-9] {
        let alpha = f64::acosh(1.0 + clearance);
        let strengths = (1..400_000).rev().map(|i| (alpha.sinh() / (f64::from(i) * alpha).sinh()).powi(3));
        let expected = 1.5 * strengths.sum::<f64>() - 1.0;
        let error = normal_to_plane(Wall, 1.0 + clearance) - expected;
        assert!(error.abs() < if clearance < 1e-6 { 1e-9 } else { 1e-13 }, "{clearance}: {error:e}");
    }
}

/// A wall crowds the fluid, a pressureless surface gives way (Kelvin's least energy): more than ½, less than ½,
/// and ever more so nearer by.
#[test]
fn walls_add_and_pressureless_surfaces_take_away() {
    for direction in [Parallel, Normal] {
        let mut last = (1.0, 0.0);
        for h in [1.05, 1.2, 1.5, 2.0, 3.0, 10.0] {
            let (wall, surface) = (near_plane(Wall, direction, h), near_plane(FreeSurface, direction, h));
            assert!(0.5 < wall && wall < last.0 && last.1 < surface && surface < 0.5, "{h}");
            last = (wall, surface);
        }
    }
}

#[test]
fn a_shell_of_twice_the_radius_gives_ten_fourteenths_and_seven_seventeenths() {
    assert!((in_shell(Wall, 2.0) - 10.0 / 14.0).abs() < 1e-15);
    assert!((in_shell(FreeSurface, 2.0) - 7.0 / 17.0).abs() < 1e-15);
    for boundary in BOUNDARIES {
        assert!((in_shell(boundary, 1e6) - 0.5).abs() < 1e-15);
    }
}

/// The definition, by finite differences: `φ = f(r) cos θ` with `(r² f′)′ = 2f`, `f′(a) = 1`, and `f′(b) = 0` or `f(b) = 0`;
/// `k = −f(a)/a`. Second order in the spacing, 4000 intervals: 1e-6.
#[test]
fn shells_solve_laplaces_equation() {
    for (boundary, outer) in [(Wall, 1.3_f64), (Wall, 2.5), (FreeSurface, 1.3), (FreeSurface, 2.5)] {
        let n = 4000;
        let step = (outer - 1.0) / f64::from(n);
        // Shooting with f(1) = 0 and f(1) = 1, both linear: f = u + c v, with f′(1) = 1.
        let shoot = |value: f64, slope: f64| {
            let (mut f, mut flux, mut r) = (value, slope, 1.0_f64);
            for _ in 0..n {
                let middle = r + 0.5 * step;
                let f_middle = f + 0.5 * step * flux / (r * r);
                let flux_middle = flux + step * f;
                f += step * flux_middle / (middle * middle);
                flux += 2.0 * step * f_middle;
                r += step;
            }
            [f, flux / (r * r)]
        };
        let (u, v) = (shoot(0.0, 1.0), shoot(1.0, 0.0));
        let end = usize::from(boundary == Wall);
        let k = u[end] / v[end];
        let closed = in_shell(boundary, outer);
        assert!((k / closed - 1.0).abs() < 1e-6, "{boundary:?} {outer}: {k} {closed}");
    }
}
