//! Bodies whose added mass has a closed form, and laws that hold for any body.

use core::f64::consts::PI;
use froude_hydro::ellipsoid::ellipsoid_added_mass;
use froude_mesh::Mesh;
use froude_mesh::measure::Measure;
use froude_mesh::sections::{Resolution, SectionBody};
use froude_panel::convergence::converged;
use froude_panel::dense::solve;
use froude_panel::mirror::{Mirror, positive_part};
use froude_panel::problem::Problem;

const OCTANT: [Mirror; 3] = [Mirror::body(0), Mirror::body(1), Mirror::body(2)];

fn mesh(body: &SectionBody, m: usize) -> Mesh {
    body.mesh(Resolution { along: m, around: 8 * m }).unwrap().mesh
}

/// Sphere and spheroids: extrapolated values within their uncertainty of Lamb's, and second order.
#[test]
fn spheroids_converge_to_lamb_with_the_second_order() {
    for slenderness in [1.0, 2.0, 6.0] {
        let axes = [slenderness, 1.0, 1.0];
        let body = SectionBody::ellipsoid(axes, 2);
        let volume = 4.0 / 3.0 * PI * slenderness;
        let exact = ellipsoid_added_mass(axes).unwrap();
        let levels = [6, 8, 10];
        let values = levels.map(|m| {
            solve(&Problem::rigid(&positive_part(&mesh(&body, m), &OCTANT).unwrap(), &OCTANT)).added_mass(0).matrix
        });
        for (k, exact) in [0, 1, 4].map(|k| (k, exact[k])) {
            let floor = 1e-12 * volume * slenderness * slenderness;
            let c = converged(&levels.map(|m| 1.0 / m as f64), &[0, 1, 2].map(|l| values[l][k][k]), floor);
            assert!(c.fine.holds(exact) && c.extrapolated.holds(exact), "{slenderness} {k}: {c:?} {exact}");
            // The sphere's rotation is zero: its error falls with the fourth power.
            assert!(exact == 0.0 || (c.order.unwrap() - 2.0).abs() < 0.15, "{slenderness} {k}: {c:?}");
        }
    }
}

#[test]
fn mirrors_of_the_body_change_nothing_but_the_work() {
    let whole = mesh(&SectionBody::ellipsoid([3.0, 1.0, 2.0], 2), 2);
    let all = solve(&Problem::rigid(&whole, &[])).added_mass(0).matrix;
    for mirrors in [&OCTANT[..1], &OCTANT[1..], &OCTANT[..]] {
        let part = solve(&Problem::rigid(&positive_part(&whole, mirrors).unwrap(), mirrors)).added_mass(0).matrix;
        for i in 0..6 {
            for j in 0..6 {
                let size = (all[i][i] * all[j][j]).sqrt();
                assert!((all[i][j] - part[i][j]).abs() < 1e-12 * size, "{i} {j}: {} {}", all[i][j], part[i][j]);
            }
        }
    }
}

#[test]
fn a_mesh_with_a_panel_across_the_plane_is_refused() {
    let body = SectionBody::capsule(1.0, 0.5, 0.5, 0.5, [1, 3]);
    let odd = body.mesh(Resolution { along: 1, around: 8 }).unwrap().mesh;
    let why = positive_part(&odd, &OCTANT).unwrap_err();
    assert_eq!(why.axis, 0);
    assert!((why.low_m + 0.5).abs() < 1e-12 && (why.high_m - 0.5).abs() < 1e-12, "{why}");
}

/// Σ_j K_ij = −½ for a closed surface of flat panels: the potential of a constant.
#[test]
fn the_solid_angles_of_a_closed_surface_add_up() {
    let whole = mesh(&SectionBody::flat_cylinder(2.0, 0.5, 0.8, [2, 4]), 2);
    let facets = froude_mesh::panel::facets(&whole);
    for target in &facets {
        let sum: f64 = facets.iter().map(|f| froude_panel::influence::near(f, target.centroid).dipole).sum();
        assert!((sum / (4.0 * PI) + 0.5).abs() < 1e-13, "{sum}");
    }
}

/// The matrix of a body that is elsewhere in its frame is the one moved there.
#[test]
fn a_body_off_the_origin_has_the_matrix_moved_by_the_parallel_axes() {
    let here = mesh(&SectionBody::ellipsoid([3.0, 1.0, 2.0], 2), 1);
    let d = [0.7, -0.4, 1.1];
    let there = here.mapped(|v| [v[0] + d[0], v[1] + d[1], v[2] + d[2]]);
    let moved = solve(&Problem::rigid(&here, &[])).added_mass(0).about(d.map(|x| -x)).matrix;
    let direct = solve(&Problem::rigid(&there, &[])).added_mass(0).matrix;
    let size = |i: usize| direct[i][i].sqrt();
    for i in 0..6 {
        for j in 0..6 {
            assert!((moved[i][j] - direct[i][j]).abs() < 1e-12 * size(i) * size(j), "{i} {j}");
        }
    }
    assert!(Measure::of(&there).centroid_m.iter().zip(d).all(|(a, b)| (a - b).abs() < 1e-12));
}
