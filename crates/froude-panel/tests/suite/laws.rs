//! Bodies with closed forms to the fifth digit, and laws of the matrix of added mass.

use core::f64::consts::PI;

use faer::linalg::solvers::Solve;
use faer::{Mat, Side};
use froude_hydro::ellipsoid::ellipsoid_added_mass;
use froude_mesh::Mesh;
use froude_mesh::measure::Measure;
use froude_mesh::robot::{Robot, sections};
use froude_mesh::sections::{Resolution, SectionBody};
use froude_mesh::vector::{cross, dot, scale, sub};
use froude_panel::convergence::converged;
use froude_panel::matrix::AddedMass;
use froude_panel::mirror::{Mirror, positive_part};
use froude_panel::problem::Problem;
use froude_panel::{dense, fast};

const OCTANT: [Mirror; 3] = [Mirror::body(0), Mirror::body(1), Mirror::body(2)];

/// The bar on extrapolated values, of ρV and ρV L²/4.
const EXTRAPOLATED: f64 = 1e-5;

fn mesh(body: &SectionBody, along: usize, around: usize) -> Mesh {
    body.mesh(Resolution { along, around }).unwrap().mesh
}

fn octant(body: &SectionBody, along: usize, around: usize) -> [[f64; 6]; 6] {
    let part = positive_part(&mesh(body, along, around), &OCTANT).unwrap();
    // With eight images the fast solver is quicker long before it is chosen.
    fast::solve(&Problem::rigid(&part, &OCTANT)).added_mass(0).matrix
}

/// Semi-axes, base cells of a half, panels around of the base; three levels, the finest of 10,000 to 20,000 panels.
const ELLIPSOIDS: [(&str, [f64; 3], usize, usize, [usize; 3]); 5] = [
    ("sphere", [1.0, 1.0, 1.0], 2, 8, [12, 18, 24]),
    ("spheroid 2:1", [2.0, 1.0, 1.0], 2, 8, [12, 18, 24]),
    ("spheroid 6:1", [6.0, 1.0, 1.0], 3, 8, [10, 14, 20]),
    ("spheroid 20:1", [20.0, 1.0, 1.0], 6, 8, [6, 9, 14]),
    ("3:1:2", [3.0, 1.0, 2.0], 2, 8, [12, 18, 24]),
];

#[test]
fn ellipsoids_are_those_of_the_closed_forms_to_the_fifth_digit() {
    for (name, axes, cells, around, levels) in ELLIPSOIDS {
        let body = SectionBody::ellipsoid(axes, cells);
        let values = levels.map(|m| octant(&body, m, around * m));
        let volume = 4.0 / 3.0 * PI * axes[0] * axes[1] * axes[2];
        for (i, exact) in ellipsoid_added_mass(axes).unwrap().into_iter().enumerate() {
            let size = volume * if i < 3 { 1.0 } else { axes[0] * axes[0] };
            let c = converged(&levels.map(|m| 1.0 / m as f64), &values.map(|v| v[i][i]), 5e-7 * exact);
            let (fine, limit) = ((c.fine.value - exact) / size, (c.extrapolated.value - exact) / size);
            println!(
                "{name}, {} panels, A{1}{1}: exact {2:.6}, error {fine:.1e}, extrapolated {limit:.1e}, U {3:.1e}, order {4:?}",
                2 * cells * around * levels[2] * levels[2],
                i + 1,
                exact / size,
                c.extrapolated.uncertainty / size,
                c.order.map(|p| (100.0 * p).round() / 100.0),
            );
            assert!(limit.abs() < EXTRAPOLATED, "{name} {i}: {c:?} {exact}");
        }
    }
}

/// Four times the panels, a quarter of the error, within a tenth: up to 32,768 panels without mirror planes.
#[test]
fn the_error_keeps_falling_with_the_square_of_the_cells() {
    let exact = 2.0 / 3.0 * PI;
    let body = SectionBody::ellipsoid([1.0; 3], 2);
    let errors = [8, 16, 32].map(|m| {
        let a = fast::solve(&Problem::rigid(&mesh(&body, m, 8 * m), &[])).added_mass(0).matrix[0][0];
        println!("{} panels: {:.3e}", 32 * m * m, a / exact - 1.0);
        a / exact - 1.0
    });
    for pair in errors.windows(2) {
        assert!((pair[0] / pair[1] / 4.0 - 1.0).abs() < 0.1, "{errors:?}");
    }
}

fn lopsided() -> Mesh {
    let body = SectionBody::capsule(1.0, 0.5, 0.8, 0.7, [2, 3]);
    // A head larger than the tail, and no plane of symmetry at all.
    mesh(&body, 2, 16).mapped(|[x, y, z]| [x, y * (1.0 + 0.2 * x), z * (1.0 + 0.1 * x) + 0.2 * y * x])
}

fn matrix(mesh: &Mesh) -> AddedMass {
    dense::solve(&Problem::rigid(mesh, &[])).added_mass(0)
}

/// What rounding of some 500 unknowns leaves.
const ROUNDING: f64 = 1e-11;

fn assert_same(a: &[[f64; 6]; 6], b: &[[f64; 6]; 6]) {
    for i in 0..6 {
        for j in 0..6 {
            let size = (b[i][i] * b[j][j]).sqrt();
            assert!((a[i][j] - b[i][j]).abs() < ROUNDING * size, "{i} {j}: {} {}", a[i][j], b[i][j]);
        }
    }
}

#[test]
fn lengths_times_s_give_the_third_fourth_and_fifth_power() {
    let (s, small) = (3.7, lopsided());
    let mut expected = matrix(&small).matrix;
    for i in 0..6 {
        for j in 0..6 {
            expected[i][j] *= s * s * s * if i < 3 { 1.0 } else { s } * if j < 3 { 1.0 } else { s };
        }
    }
    assert_same(&matrix(&small.mapped(|v| v.map(|x| s * x))).matrix, &expected);
}

#[test]
fn a_turned_body_has_the_turned_matrix() {
    let (sin, cos) = 0.7_f64.sin_cos();
    let (s2, c2) = 0.4_f64.sin_cos();
    // About z by 0.7, then about x by 0.4.
    let r = [[cos, -sin, 0.0], [c2 * sin, c2 * cos, -s2], [s2 * sin, s2 * cos, c2]];
    let body = lopsided();
    let a = matrix(&body).matrix;
    let turn = |v: [f64; 3]| [0, 1, 2].map(|i| (0..3).map(|k| r[i][k] * v[k]).sum::<f64>());
    let mut expected = [[0.0; 6]; 6];
    for i in 0..6 {
        for j in 0..6 {
            for k in 0..3 {
                for l in 0..3 {
                    expected[i][j] += r[i % 3][k] * a[i / 3 * 3 + k][j / 3 * 3 + l] * r[j % 3][l];
                }
            }
        }
    }
    assert_same(&matrix(&body.mapped(turn)).matrix, &expected);
}

/// A spheroid that moves steadily at an angle: no force, and Munk's moment (k₂ − k₁) ρV U² sin α cos α, from −U × (A U).
#[test]
fn the_moment_on_a_body_in_steady_motion_is_munks() {
    let (slenderness, angle) = (4.0, 0.3_f64);
    let body = SectionBody::ellipsoid([slenderness, 1.0, 1.0], 3);
    let (sin, cos) = angle.sin_cos();
    let munk = |m: usize| {
        // The body is turned in its frame; the motion is along x.
        let turned = mesh(&body, m, 8 * m).mapped(|[x, y, z]| [cos * x - sin * y, sin * x + cos * y, z]);
        let a = fast::solve(&Problem::rigid(&turned, &[])).added_mass(0).matrix;
        // −(U × A U)_z with U = (1, 0, 0).
        -a[1][0]
    };
    let levels = [4, 6, 8];
    let c = converged(&levels.map(|m| 1.0 / m as f64), &levels.map(munk), 0.0);
    let [along, across, ..] = ellipsoid_added_mass([slenderness, 1.0, 1.0]).unwrap();
    let expected = (across - along) * sin * cos;
    println!("Munk moment: {c:?}, Lamb {expected}");
    assert!(c.fine.holds(expected) && c.extrapolated.holds(expected), "{c:?} {expected}");
}

/// The same moment from pressures, ½ρ ∫ |∇φ − U|² (x × n) dS: nothing of A is used. Gradients are least squares over the neighbours of a
/// panel, of first order where cells change; the coarsest mesh shows 2 % and the error must fall.
#[test]
fn the_pressures_on_a_body_in_steady_motion_give_the_same_moment() {
    let (slenderness, angle) = (4.0, 0.3_f64);
    let velocity = [angle.cos(), angle.sin(), 0.0];
    let body = SectionBody::ellipsoid([slenderness, 1.0, 1.0], 3);
    let [surge, sway, ..] = ellipsoid_added_mass([slenderness, 1.0, 1.0]).unwrap();
    // −(U × A U)_z in the body's axes.
    let expected = (surge - sway) * angle.sin() * angle.cos();
    let errors = [4, 8].map(|m| {
        let problem = Problem::rigid(&mesh(&body, m, 8 * m), &[]);
        let potentials = fast::solve(&problem).potentials;
        let phi = |p: usize| (0..3).map(|i| velocity[i] * potentials[p][i]).sum::<f64>();
        let (along, around) = (6 * m, 8 * m);
        let mut moment = 0.0;
        for (p, facet) in problem.facets.iter().enumerate() {
            let (i, k) = (p / around, p % around);
            let mut beside = vec![i * around + (k + 1) % around, i * around + (k + around - 1) % around];
            beside.extend((i > 0).then(|| p - around));
            beside.extend((i + 1 < along).then(|| p + around));
            // Least squares in the plane of the panel: the normal direction is held by n nᵀ.
            let mut normal = Mat::from_fn(3, 3, |a, b| facet.normal[a] * facet.normal[b]);
            let mut right = Mat::zeros(3, 1);
            for q in beside {
                let d = sub(problem.facets[q].centroid, facet.centroid);
                let flat = sub(d, scale(facet.normal, dot(d, facet.normal)));
                for a in 0..3 {
                    right[(a, 0)] += flat[a] * (phi(q) - phi(p));
                    (0..3).for_each(|b| normal[(a, b)] += flat[a] * flat[b]);
                }
            }
            let gradient = normal.partial_piv_lu().solve(&right);
            let slip: f64 = (0..3)
                .map(|a| {
                    let tangential = velocity[a] - dot(velocity, facet.normal) * facet.normal[a];
                    (gradient[(a, 0)] - tangential).powi(2)
                })
                .sum();
            moment += 0.5 * slip * facet.area * cross(facet.centroid, facet.normal)[2];
        }
        println!("Munk moment from pressures: {moment:.5}, Lamb {expected:.5}");
        (moment / expected - 1.0).abs()
    });
    assert!(errors[0] < 0.03 && errors[1] < 0.5 * errors[0], "{errors:?}");
}

/// Kinetic energy is not negative: no eigenvalue below zero by more than the asymmetry of the mesh.
#[test]
fn the_matrix_is_positive_semi_definite() {
    let necked = mesh(&sections(&Robot::NECKED_MAMBA, 1, 0.04), 1, 16);
    let round = mesh(&SectionBody::ellipsoid([3.0, 1.0, 1.0], 2), 2, 16);
    for body in [lopsided(), necked, round] {
        let a = matrix(&body);
        let volume = Measure::of(&body).volume_m3;
        let reach = body.vertices.iter().map(|v| v[0].abs()).fold(0.0, f64::max);
        let size = |i: usize| if i < 3 { volume } else { volume * reach * reach };
        let scaled = Mat::from_fn(6, 6, |i, j| a.matrix[i][j] / (size(i) * size(j)).sqrt());
        let values = scaled.self_adjoint_eigen(Side::Lower).unwrap();
        let least = values.S().column_vector().iter().copied().fold(f64::INFINITY, f64::min);
        println!("least eigenvalue {least:.2e}, asymmetry {:.1e}", a.asymmetry);
        assert!(least > -1e-6, "{least}");
    }
}
