//! Walls, free surfaces and neighbours: laws of images.

use core::f64::consts::PI;

use froude_mesh::Mesh;
use froude_mesh::robot::{Robot, sections};
use froude_mesh::sections::{Resolution, SectionBody};
use froude_panel::convergence::converged;
use froude_panel::mirror::{Kind, Mirror, positive_part};
use froude_panel::problem::{FIXED, Frame, Problem};
use froude_panel::tank::Tank;
use froude_panel::{dense, fast, solve};

use crate::near_wall::{Direction, far_from_plane, in_shell, normal_to_plane};

const VOLUME: f64 = 4.0 / 3.0 * PI;
const LEVELS: [usize; 3] = [4, 6, 8];

fn sphere(radius: f64, m: usize) -> Mesh {
    SectionBody::ellipsoid([radius; 3], 2).mesh(Resolution { along: m, around: 8 * m }).unwrap().mesh
}

/// Extrapolated over three levels.
fn limit(levels: [usize; 3], value: impl Fn(usize) -> f64) -> f64 {
    converged(&levels.map(|m| 1.0 / m as f64), &levels.map(value), 0.0).extrapolated.value
}

/// The dipole law leaves terms of (a/h)⁶ and more: 7e-5 of the value at h = 3 a, by the sum of all images of the axial dipole.
const DIPOLE: f64 = 1e-4;
/// What extrapolation leaves on the sphere alone, with these levels.
const EXTRAPOLATED: f64 = 2e-5;

#[test]
fn a_sphere_beside_a_plane_has_the_added_mass_of_its_image() {
    let levels = [8, 12, 16];
    for kind in [Kind::Wall, Kind::FreeSurface] {
        for h in [3.0, 5.0] {
            let mirrors = [Mirror::body(0), Mirror::body(1), Mirror { axis: 2, at_m: h, kind }];
            let found = levels.map(|m| {
                let part = positive_part(&sphere(1.0, m), &mirrors).unwrap();
                fast::solve(&Problem::rigid(&part, &mirrors)).added_mass(0).matrix
            });
            for (i, direction) in [(0, Direction::Parallel), (2, Direction::Normal)] {
                let sizes = levels.map(|m| 1.0 / m as f64);
                let a = converged(&sizes, &found.map(|f| f[i][i] / VOLUME), 0.0).extrapolated.value;
                let law = far_from_plane(kind, direction, h);
                println!("{kind:?}, h = {h} a, A{0}{0}: {a:.6}, dipole law {law:.6}, {1:.1e}", i + 1, a / law - 1.0);
                assert!((a / law - 1.0).abs() < DIPOLE, "{kind:?} {h} {i}: {a} {law}");
                if i == 2 {
                    let all = normal_to_plane(kind, h);
                    println!("    all images {all:.6}, {:.1e}", a / all - 1.0);
                    assert!((a / all - 1.0).abs() < EXTRAPOLATED, "{kind:?} {h}: {a} {all}");
                }
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
        let solution = if m < 6 { dense::solve(&problem) } else { fast::solve(&problem) };
        solution.added_mass(0).matrix[0][0] / VOLUME
    };
    let octant = [Mirror::body(0), Mirror::body(1), Mirror::body(2)];
    let (whole, eighth) = (both(3, &[]), both(3, &octant));
    assert!((whole - eighth).abs() < 1e-9, "{whole} {eighth}");
    let a = limit([6, 8, 12], |m| both(m, &octant));
    let exact = in_shell(Kind::Wall, 2.0);
    println!("shell: {a:.6}, 5/7 = {exact:.6}");
    // Extrapolated values of these levels err by a few parts in a million for the sphere alone.
    assert!((a - exact).abs() < 3e-5, "{a}");
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
            fast::solve(&Problem::of_parts(&one.with(&other), &parts, &frames, &planes)).matrix
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
/// Half a unit of its print.
const PRINT: f64 = 0.005;

/// Long axis along the pool, at mid-depth. x is surge, y sway (level), z heave. The other program's figures are of one mesh, which is not
/// stated: they are held against our finest one. Extrapolated, surge under the lid is 3.768 %, more than its 3.75.
#[test]
fn the_pool_of_the_paper_adds_what_another_program_found() {
    let pool = Tank { length_m: 1.5, width_m: 0.9, depth_m: 1.0 };
    let body = sections(&Robot::SMOOTH_MAMBA, 2, 0.05);
    let levels = [2, 3, 4];
    let more = levels.map(|m| {
        let mesh = body.mesh(Resolution { along: m, around: 8 * m }).unwrap().mesh;
        let alone = Problem::rigid(&mesh, &[]);
        let unbounded = solve(&alone).added_mass(0).matrix;
        let cells = pool.cells(0.3).map(|n| n * m);
        let there = pool.solve(&alone, [0.0, 0.0, -0.5], cells).unwrap();
        [&there.lid, &there.free].map(|s| {
            let a = s.added_mass(0).matrix;
            [0, 1, 2].map(|i| 100.0 * (a[i][i] / unbounded[i][i] - 1.0))
        })
    });
    for (surface, (name, other)) in ["lid", "phi = 0"].into_iter().zip(OTHER).enumerate() {
        for (i, motion) in ["surge", "sway", "heave"].into_iter().enumerate() {
            let sizes = levels.map(|m| 1.0 / m as f64);
            let c = converged(&sizes, &more.map(|l| l[surface][i]), 0.0);
            println!("pool, {name}, {motion}: finest {:.3} %, extrapolated {:?}", c.fine.value, c.extrapolated);
            if let Some(other) = other.get(i) {
                let apart = (c.fine.value - other).abs();
                assert!(apart < c.fine.uncertainty + PRINT, "{name} {motion}: {c:?}, {other} by the other");
            }
        }
    }
}
