//! Walls, free surfaces and neighbours: laws of images.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, missing_docs)]

use core::f64::consts::PI;

use froude_mesh::Mesh;
use froude_mesh::robot::ModularRobot;
use froude_mesh::sections::{Resolution, SectionBody};
use froude_panel::convergence::converged;
use froude_panel::mirror::{Kind, Mirror, positive_part};
use froude_panel::problem::{FIXED, Frame, Problem};
use froude_panel::tank::Tank;
use froude_panel::{dense, solve};

const VOLUME: f64 = 4.0 / 3.0 * PI;
const LEVELS: [usize; 3] = [4, 6, 8];

fn sphere(radius: f64, m: usize) -> Mesh {
    SectionBody::ellipsoid([radius; 3], 2).mesh(Resolution { along: m, around: 8 * m }).unwrap().mesh
}

/// Extrapolated over three levels.
fn limit(levels: [usize; 3], value: impl Fn(usize) -> f64) -> f64 {
    converged(&levels.map(|m| 1.0 / m as f64), &levels.map(value), 0.0).extrapolated.value
}

/// The dipole law leaves terms of (a/h)⁶ and (a/h)⁸: 3/64 of the former, 6.4e-5 of the value at h = 3 a.
const DIPOLE: f64 = 1e-4;

#[test]
fn a_sphere_beside_a_plane_has_the_added_mass_of_its_image() {
    for (kind, sign) in [(Kind::Wall, 1.0), (Kind::FreeSurface, -1.0)] {
        for h in [3.0_f64, 4.0, 6.0] {
            let mirrors = [Mirror::body(0), Mirror::body(1), Mirror { axis: 2, at_m: h, kind }];
            let found = |i: usize| {
                limit(LEVELS, |m| {
                    let part = positive_part(&sphere(1.0, m), &mirrors).unwrap();
                    solve(&Problem::rigid(&part, &mirrors)).added_mass(0).matrix[i][i] / VOLUME
                })
            };
            for (i, factor) in [(0, 3.0 / 16.0), (2, 3.0 / 8.0)] {
                let (a, law) = (found(i), 0.5 * (1.0 + sign * factor / h.powi(3)));
                println!("{kind:?}, h = {h} a, A{i}{i}: {a:.6}, law {law:.6}, {:.1e}", a / law - 1.0);
                assert!((a / law - 1.0).abs() < DIPOLE, "{kind:?} {h} {i}: {a} {law}");
            }
        }
    }
}

/// ½ (b³ + 2a³)/(b³ − a³) = 5/7 for b = 2a.
#[test]
fn a_sphere_in_a_rigid_shell_has_its_added_mass() {
    let both = |m: usize, mirrors: &[Mirror]| {
        let part = |mesh: &Mesh| positive_part(mesh, mirrors).unwrap();
        let inner = part(&sphere(1.0, m));
        let mut shell = part(&sphere(2.0, m));
        shell.panels.iter_mut().for_each(|p| *p = p.turned());
        let mut parts = vec![0; inner.panels.len()];
        parts.extend(vec![FIXED; shell.panels.len()]);
        let mut problem = Problem::of_parts(&inner.with(&shell), &parts, &[Frame::at([0.0; 3])], mirrors);
        // A translation is odd in a plane of the body: there is no constant in its potential.
        problem.is_enclosed = mirrors.is_empty();
        dense::solve(&problem).added_mass(0).matrix[0][0] / VOLUME
    };
    let octant = [Mirror::body(0), Mirror::body(1), Mirror::body(2)];
    let (whole, eighth) = (both(3, &[]), both(3, &octant));
    assert!((whole - eighth).abs() < 1e-9, "{whole} {eighth}");
    let a = limit([6, 8, 12], |m| both(m, &octant));
    println!("shell: {a:.6}, 5/7 = {:.6}", 5.0 / 7.0);
    // Extrapolated values of these levels err by a few parts in a million for the sphere alone.
    assert!((a - 5.0 / 7.0).abs() < 3e-5, "{a}");
}

/// On one line −3/2 (a/d)³, side by side +3/4 (a/d)³ of ρV; the next term is of (a/d)⁶ (Lamb 1932, § 138).
#[test]
fn two_spheres_act_on_each_other_as_dipoles() {
    let planes = [Mirror::body(1), Mirror::body(2)];
    for d in [4.0_f64, 8.0] {
        let found = |m: usize| {
            let one = positive_part(&sphere(1.0, m), &planes).unwrap();
            let n = one.panels.len();
            let other = one.mapped(|[x, y, z]| [x + d, y, z]);
            let parts: Vec<usize> = (0..2 * n).map(|i| i / n).collect();
            let frames = [Frame::at([0.0; 3]), Frame::at([d, 0.0, 0.0])];
            solve(&Problem::of_parts(&one.with(&other), &parts, &frames, &planes)).matrix
        };
        let cube = d.powi(-3);
        for (i, law) in [(0, -1.5 * cube), (1, 0.75 * cube)] {
            let a = limit(LEVELS, |m| found(m)[i][6 + i] / VOLUME);
            println!("d = {d} a, A{i}{i} of one on the other: {a:.6}, law {law:.6}, {:.1e}", a / law - 1.0);
            assert!((a / law - 1.0).abs() < 2.0 * cube, "{d} {i}: {a} {law}");
        }
        let a = found(8);
        for i in 0..6 {
            for j in 0..6 {
                // Of the diagonal; what the mesh leaves, as for one body.
                assert!((a[i][6 + j] - a[6 + j][i]).abs() < 1e-4 * VOLUME, "{i} {j}");
            }
        }
    }
}

/// What another program found for the pool of the paper, %: surge and sway, under a lid and under φ = 0.
const OTHER: [[f64; 2]; 2] = [[3.75, 0.65], [1.55, 0.43]];

#[test]
fn the_pool_of_the_paper_adds_what_another_program_found() {
    let pool = Tank { length_m: 1.5, width_m: 0.9, depth_m: 1.0 };
    let body = ModularRobot::SMOOTH_MAMBA.body(2, 0.04).mesh(Resolution { along: 2, around: 16 }).unwrap().mesh;
    let alone = Problem::rigid(&body, &[]);
    let unbounded = solve(&alone).added_mass(0).matrix;
    for cell_m in [0.15, 0.1] {
        let there = pool.solve(&alone, [0.0, 0.0, -0.5], pool.cells(cell_m)).unwrap();
        for (name, s, other) in [("lid", &there.lid, OTHER[0]), ("phi = 0", &there.free, OTHER[1])] {
            let a = s.added_mass(0).matrix;
            let more = |i: usize| 100.0 * (a[i][i] / unbounded[i][i] - 1.0);
            println!("cells {cell_m}, {name}: surge {:.2} %, sway {:.2} %, heave {:.2} %", more(0), more(1), more(2));
            let _ = other;
        }
    }
}
