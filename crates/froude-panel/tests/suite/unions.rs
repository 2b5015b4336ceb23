//! Two spheres through one another, united from their meshes: the added mass of the same body made as one surface of revolution.

use core::f64::consts::PI;

use froude_mesh::check::check;
use froude_mesh::crossing::crossings;
use froude_mesh::sections::{Resolution, SectionBody};
use froude_mesh::union::united;
use froude_mesh::{Mesh, Panel};
use froude_panel::fast;
use froude_panel::problem::Problem;

/// Half of the distance between the centres of two spheres of radius 1.
const HALF: f64 = 0.5;

fn sphere(around: usize) -> Mesh {
    SectionBody::ellipsoid([1.0; 3], 2).mesh(Resolution { along: around / 4, around }).unwrap().mesh
}

fn united_spheres(around: usize) -> Mesh {
    let ball = sphere(around);
    let (s, c) = 1.0_f64.sin_cos();
    // Turned, so that no facet of one lies as one of the other does.
    let other = ball.mapped(|[x, y, z]| [c * x - s * z + HALF, y, s * x + c * z]);
    let both = ball.mapped(|[x, y, z]| [x - HALF, y, z]).with(&other);
    united(&both).unwrap().unwrap().mesh
}

/// The outline of both about x: arcs about ±HALF that meet in the plane x = 0, in cells of the size of the spheres'.
fn revolved(around: u32) -> Mesh {
    let meet = HALF.acos();
    let cells = (f64::from(around) * (PI - meet) / (2.0 * PI)).ceil() as u32;
    let arc = |k: u32| {
        let angle = (PI - meet) * f64::from(k) / f64::from(cells);
        [-HALF - angle.cos(), angle.sin()]
    };
    let mut rings: Vec<[f64; 2]> = (1..=cells).map(arc).collect();
    rings.extend((1..cells).rev().map(|k| [-arc(k)[0], arc(k)[1]]));
    let mut mesh = Mesh { vertices: vec![[-HALF - 1.0, 0.0, 0.0], [HALF + 1.0, 0.0, 0.0]], panels: Vec::new() };
    for [x, r] in &rings {
        let angle = |k: u32| 2.0 * PI * f64::from(k) / f64::from(around);
        mesh.vertices.extend((0..around).map(|k| [*x, r * angle(k).cos(), r * angle(k).sin()]));
    }
    let at = |ring: u32, k: u32| 2 + ring * around + k % around;
    let last = rings.len() as u32 - 1;
    for k in 0..around {
        mesh.panels.push(Panel::triangle(0, at(0, k + 1), at(0, k)));
        mesh.panels.push(Panel::triangle(1, at(last, k), at(last, k + 1)));
        mesh.panels.extend((0..last).map(|i| Panel::quad(at(i, k), at(i, k + 1), at(i + 1, k + 1), at(i + 1, k))));
    }
    mesh
}

/// What facets and panels do to a sphere of as many, they may do to either mesh: the two differ by less than that error.
#[test]
fn two_united_spheres_have_the_added_mass_of_one_surface_of_revolution() {
    for around in [16, 32] {
        let diagonal = |mesh: &Mesh| {
            assert_eq!((check(mesh), crossings(mesh)), (Vec::new(), Vec::new()));
            let a = fast::solve(&Problem::rigid(mesh, &[])).added_mass(0).matrix;
            [a[0][0], a[1][1], a[2][2]]
        };
        let error = (diagonal(&sphere(around))[0] / (2.0 / 3.0 * PI) - 1.0).abs();
        let (united, revolved) = (diagonal(&united_spheres(around)), diagonal(&revolved(around as u32)));
        println!("{around}: sphere {error:.1e}, united {united:.5?}, revolved {revolved:.5?}");
        for (a, b) in united.iter().zip(revolved) {
            assert!((a / b - 1.0).abs() < error, "{around}: {united:?} {revolved:?} {error}");
        }
    }
}
