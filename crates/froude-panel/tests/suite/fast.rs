//! The fast solver against the plain one, on the same panels.

use froude_mesh::robot::{Robot, sections};
use froude_mesh::sections::{Resolution, SectionBody};
use froude_mesh::{Mesh, Panel};
use froude_panel::mirror::{Kind, Mirror, positive_part};
use froude_panel::problem::Problem;
use froude_panel::{dense, fast};

/// Largest difference of two matrices, entry by entry over the roots of the diagonal.
fn difference(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let size = |i: usize| b[i][i].abs().max(1e-6 * b[0][0]).sqrt();
    let entries = (0..a.len()).flat_map(|i| (0..a.len()).map(move |j| (i, j)));
    entries.map(|(i, j)| (a[i][j] - b[i][j]).abs() / (size(i) * size(j))).fold(0.0, f64::max)
}

fn compared(name: &str, problem: &Problem) {
    let (plain, fast) = (dense::solve(problem), fast::solve(problem));
    let apart = difference(&fast.matrix, &plain.matrix);
    println!("{name}: {apart:.1e} {:?}", fast.report);
    assert!(apart < 2e-6, "{name}: {apart}");
}

fn cube(cells: usize) -> Mesh {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            for i in 0..cells {
                for j in 0..cells {
                    let corner = |a: usize, b: usize| {
                        let mut p = [side; 3];
                        p[(axis + 1) % 3] = 2.0 * a as f64 / cells as f64 - 1.0;
                        p[(axis + 2) % 3] = 2.0 * b as f64 / cells as f64 - 1.0;
                        p
                    };
                    let first = mesh.vertices.len() as u32;
                    let mut corners = [corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)];
                    if side < 0.0 {
                        corners.reverse();
                    }
                    mesh.vertices.extend(corners);
                    mesh.panels.push(Panel::quad(first, first + 1, first + 2, first + 3));
                }
            }
        }
    }
    mesh
}

#[test]
fn a_slender_body_a_box_and_a_body_beside_mirrors_are_those_of_the_plain_solver() {
    let slender = SectionBody::capsule(9.0, 1.0, 0.8, 1.0, [2, 18]);
    let slender = slender.mesh(Resolution { along: 5, around: 20 }).unwrap().mesh;
    compared("capsule", &Problem::rigid(&slender, &[]));
    // Panels that lie in one plane with many others do nothing to them.
    compared("box", &Problem::rigid(&cube(18), &[]));
    let wall = Mirror { axis: 2, at_m: 1.3, kind: Kind::FreeSurface };
    let mirrors = [Mirror::body(1), wall];
    let half = positive_part(&slender, &mirrors).unwrap();
    compared("half a capsule under a free surface", &Problem::rigid(&half, &mirrors));
    let robot = sections(&Robot::NECKED_MAMBA, 3, 0.03).mesh(Resolution { along: 3, around: 24 }).unwrap();
    compared("robot", &Problem::rigid(&robot.mesh, &[]));
}
