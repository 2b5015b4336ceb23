//! Spheres near planes and in shells, and the first modes of tanks.
//!
//! Capytaine 3.0 (direct method, limits of frequency, 3,136 panels) gives the same from 1.2 radii on, both boundaries, to
//! 7e-5 along and 1.6e-4 square to the plane; square to it the difference falls with the mesh.

use froude_hydro::near_wall::{
    Boundary, Direction, sphere_far_from_plane, sphere_in_shell, sphere_near_plane, sphere_normal_to_plane,
};
use froude_hydro::sloshing::{frequency_number, rectangular_tank_modes_rad_s};

use Boundary::{Pressureless, Rigid};
use Direction::{Normal, Parallel};

/// Apéry's constant, `Σ 1/i³`.
const ZETA_3: f64 = 1.202_056_903_159_594_2;

/// Far away only the first orders are left: the next is of order `q⁹`, times some 0.01.
#[test]
fn the_first_orders_are_those_of_lamb_and_the_next_ones_ours() {
    for ratio in [3.0, 5.0, 9.0] {
        let q = 1.0_f64 / ratio;
        for (boundary, sign) in [(Rigid, 1.0), (Pressureless, -1.0)] {
            let along = 0.5 * (1.0 + 3.0 / 16.0 * sign * q.powi(3) + 3.0 / 256.0 * (q.powi(6) + q.powi(8)));
            let found = sphere_near_plane(boundary, Parallel, 1.0, ratio).unwrap();
            assert!((found - along).abs() < 0.02 * q.powi(9), "{ratio} {boundary:?}: {}", (found - along) / q.powi(9));
            let lamb = sphere_far_from_plane(boundary, Parallel, 1.0, ratio).unwrap();
            assert!((found - lamb).abs() < 0.5 * 3.0 / 256.0 * 1.2 * q.powi(6));

            let square = 0.5 * (1.0 + 3.0 / 8.0 * sign * q.powi(3) + 3.0 / 64.0 * q.powi(6));
            let found = sphere_near_plane(boundary, Normal, 1.0, ratio).unwrap();
            assert!(
                (found - square).abs() < 0.05 * q.powi(8),
                "{ratio} {boundary:?}: {}",
                (found - square) / q.powi(8)
            );
            let lamb = sphere_far_from_plane(boundary, Normal, 1.0, ratio).unwrap();
            assert!((found - lamb).abs() < 0.5 * 3.0 / 64.0 * 1.2 * q.powi(6));
        }
    }
}

/// Two ways to one number: multipoles about the centre, and doublets at their image points.
#[test]
fn multipoles_and_images_agree() {
    for boundary in [Rigid, Pressureless] {
        for ratio in [1.05, 1.1, 1.3, 2.0, 4.0, 50.0] {
            let multipoles = sphere_near_plane(boundary, Normal, 0.2, 0.2 * ratio).unwrap();
            let images = sphere_normal_to_plane(boundary, 0.2, 0.2 * ratio).unwrap();
            assert!((multipoles - images).abs() < 1e-13, "{boundary:?} {ratio}: {:e}", multipoles - images);
        }
    }
}

/// At contact the images lie at 1/2, 2/3, 3/4 … with strengths `1/i³`.
#[test]
fn at_contact_the_sum_is_aperys_constant() {
    let rigid = sphere_normal_to_plane(Rigid, 1.0, 1.0).unwrap();
    assert!((rigid - 0.5 * (3.0 * ZETA_3 - 2.0)).abs() < 1e-13, "{rigid}");
    let pressureless = sphere_normal_to_plane(Pressureless, 1.0, 1.0).unwrap();
    assert!((pressureless - 0.5 * (2.25 * ZETA_3 - 2.0)).abs() < 1e-13, "{pressureless}");
    // Almost there: `h = cosh α`, strengths `(sinh α/sinh iα)³`, summed to the last bit.
    for clearance in [1e-4, 1e-6, 1e-9] {
        let alpha = f64::acosh(1.0 + clearance);
        let strengths = (1..400_000).rev().map(|i| (alpha.sinh() / (f64::from(i) * alpha).sinh()).powi(3));
        let expected = 1.5 * strengths.sum::<f64>() - 1.0;
        let error = sphere_normal_to_plane(Rigid, 1.0, 1.0 + clearance).unwrap() - expected;
        assert!(error.abs() < if clearance < 1e-6 { 1e-9 } else { 1e-13 }, "{clearance}: {error:e}");
    }
}

/// A wall crowds the fluid, a pressureless surface gives way (Kelvin's least energy): more than ½, less than ½,
/// and ever more so nearer by.
#[test]
fn walls_add_and_pressureless_surfaces_take_away() {
    for direction in [Parallel, Normal] {
        let mut last = (1.0, 0.0);
        for ratio in [1.05, 1.2, 1.5, 2.0, 3.0, 10.0] {
            let wall = sphere_near_plane(Rigid, direction, 1.0, ratio).unwrap();
            let surface = sphere_near_plane(Pressureless, direction, 1.0, ratio).unwrap();
            assert!(0.5 < wall && wall < last.0 && last.1 < surface && surface < 0.5, "{ratio}");
            last = (wall, surface);
        }
    }
}

#[test]
fn a_shell_of_twice_the_radius_gives_ten_fourteenths_and_seven_seventeenths() {
    assert!((sphere_in_shell(Rigid, 0.5, 1.0).unwrap() - 10.0 / 14.0).abs() < 1e-15);
    assert!((sphere_in_shell(Pressureless, 0.5, 1.0).unwrap() - 7.0 / 17.0).abs() < 1e-15);
    for boundary in [Rigid, Pressureless] {
        assert!((sphere_in_shell(boundary, 1.0, 1e6).unwrap() - 0.5).abs() < 1e-15);
    }
}

/// The definition, by finite differences: `φ = f(r) cos θ` with `(r² f′)′ = 2f`, `f′(a) = 1`, and `f′(b) = 0` or `f(b) = 0`;
/// `k = −f(a)/a`. Second order in the spacing, 4000 intervals: 1e-6.
#[test]
fn shells_solve_laplaces_equation() {
    for (boundary, outer) in [(Rigid, 1.3_f64), (Rigid, 2.5), (Pressureless, 1.3), (Pressureless, 2.5)] {
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
        let end = usize::from(boundary == Rigid);
        let k = u[end] / v[end];
        let closed = sphere_in_shell(boundary, 1.0, outer).unwrap();
        assert!((k / closed - 1.0).abs() < 1e-6, "{boundary:?} {outer}: {k} {closed}");
    }
}

#[test]
fn too_little_room_is_refused_in_words() {
    assert_eq!(
        sphere_near_plane(Rigid, Parallel, 0.5, 0.51).unwrap_err().to_string(),
        "distance of the sphere's centre from the plane is 1.02 sphere radii; it must be a number of at least 1.05"
    );
    assert!(sphere_in_shell(Rigid, 1.0, 1.0).is_err());
    assert!(sphere_normal_to_plane(Rigid, 1.0, 0.9).is_err());
    assert!(sphere_far_from_plane(Rigid, Parallel, 1.0, f64::NAN).is_err());
    assert!(sphere_near_plane(Rigid, Parallel, 0.0, 1.0).is_err());
}

/// Deep: `ω² = πg/L`; shallow: a wave of `√(gd)` runs the length twice in a period.
#[test]
fn tank_modes_have_their_deep_and_shallow_limits() {
    let g = 9.80665;
    let [along, across] = rectangular_tank_modes_rad_s(4.0, 1.0, 40.0, g).unwrap();
    assert!((along / (std::f64::consts::PI * g / 4.0).sqrt() - 1.0).abs() < 1e-15);
    assert!((across / along - 2.0).abs() < 1e-15);
    let [along, _] = rectangular_tank_modes_rad_s(4.0, 1.0, 0.004, g).unwrap();
    let twice_the_length_s = 8.0 / (g * 0.004_f64).sqrt();
    // tanh x = x (1 − x²/3): half of that in ω.
    let left = (std::f64::consts::PI * 0.001).powi(2) / 6.0;
    assert!((std::f64::consts::TAU / along / twice_the_length_s - 1.0 - left).abs() < 1e-9);
}

#[test]
fn a_tank_without_water_is_refused() {
    let error = rectangular_tank_modes_rad_s(4.0, 1.0, 0.0, 9.81).unwrap_err();
    assert_eq!(error.to_string(), "depth of water is 0; it must be finite and above 0");
    assert!(frequency_number(f64::NAN, 1.0, 9.81).is_err());
}
