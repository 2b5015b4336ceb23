//! O-grids: the laws of closed cells, and what OpenFOAM says of them.

use std::f64::consts::PI;

use crate::common::{assert_openfoam_agrees, number_after};
use froude_cfd::o_grid::OGrid;
use froude_cfd::quality::Quality;
use froude_mesh::robot::{Robot, sections};
use froude_mesh::sections::SectionBody;

const COARSE: OGrid =
    OGrid { stations: 24, layers: 16, around: 12, first_layer_m: 1e-3, outer_radius_m: 4.0, is_half: true };

fn capsule() -> SectionBody {
    SectionBody::capsule(0.455, 0.045, 0.045, 0.045, [1; 2])
}

fn bodies() -> Vec<(&'static str, SectionBody)> {
    vec![
        ("capsule", capsule()),
        ("sphere", SectionBody::ellipsoid([0.5; 3], 1)),
        ("flat ellipsoid", SectionBody::ellipsoid([0.5, 0.1, 0.2], 1)),
        ("H1LT", sections(&Robot::SMOOTH_MAMBA, 1, 1.0)),
        ("H3LT", sections(&Robot::SMOOTH_MAMBA, 3, 1.0)),
    ]
}

/// Sum of all patches' areas is nothing; a wall that is closed has none of its own but the hole in the plane of symmetry.
fn assert_is_closed(name: &str, quality: &Quality, is_half: bool) {
    assert!(quality.max_openness.value < 1e-12, "{name}: {quality:?}");
    let sum: [f64; 3] = std::array::from_fn(|c| quality.patch_area_m2.iter().map(|a| a[c]).sum());
    assert!(sum.iter().all(|v| v.abs() < 1e-11), "{name}: {sum:?}");
    let [x, y, z] = quality.patch_area_m2[0];
    assert!(x.abs() < 1e-12 && y.abs() < 1e-12, "{name}: {:?}", quality.patch_area_m2);
    // Of the water's domain the body's normal points into the body.
    assert!(if is_half { z < -0.01 } else { z.abs() < 1e-12 }, "{name}: {z}");
}

/// The corners lie on the body and on the sphere, and volumes of facets converge with the square of the cells.
#[test]
fn volumes_are_those_of_the_sphere_less_the_body() {
    for (name, body) in bodies() {
        for is_half in [true, false] {
            let part = if is_half { 0.5 } else { 1.0 };
            let exact = part * (4.0 / 3.0 * PI * 4.0_f64.powi(3) - body.volume_m3());
            let error = |factor: usize| {
                let around = if is_half { 12 } else { 24 };
                let grid = OGrid { stations: 24 * factor, around: around * factor, is_half, ..COARSE };
                let (mesh, quality) = grid.mesh(&body).unwrap();
                assert_eq!(mesh.cells, grid.stations * grid.layers * grid.around);
                assert_is_closed(name, &quality, is_half);
                1.0 - quality.volume_m3 / exact
            };
            let (coarse, fine) = (error(1), error(2));
            assert!(fine > 0.0 && fine < 0.01 && (coarse / fine - 4.0).abs() < 0.1, "{name}: {coarse} {fine}");
        }
    }
}

/// The hole in the plane of symmetry is the body's own plane section.
#[test]
fn the_hole_of_the_symmetry_plane_is_the_bodys_section() {
    let (mesh, quality) = OGrid { stations: 80, ..COARSE }.mesh(&capsule()).unwrap();
    let names: Vec<&str> = mesh.patches.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["body", "far", "symmetry"]);
    let section = 0.91 * 0.09 + PI * 0.045 * 0.045;
    assert!((-quality.patch_area_m2[0][2] / section - 1.0).abs() < 1e-3);
    // A half circle of 80 chords.
    assert!((quality.patch_area_m2[1][2] / (PI * 16.0) - 1.0).abs() < 1e-2);
}

#[test]
fn the_first_layer_is_as_thick_as_asked_everywhere() {
    let (mesh, _) = COARSE.mesh(&capsule()).unwrap();
    let body = &mesh.patches[0];
    let walls: std::collections::BTreeSet<u32> =
        mesh.faces[body.start..body.start + body.count].iter().flatten().copied().collect();
    let mut edges = 0;
    for corners in &mesh.faces {
        for (i, a) in corners.iter().enumerate() {
            let b = corners[(i + 1) % corners.len()];
            if walls.contains(a) && !walls.contains(&b) {
                let [p, q] = [*a, b].map(|c| mesh.points_m[c as usize]);
                let length = (0..3).map(|c| (p[c] - q[c]).powi(2)).sum::<f64>().sqrt();
                assert!((length / 1e-3 - 1.0).abs() < 0.03, "{p:?} {length}");
                edges += 1;
            }
        }
    }
    assert!(edges > 24 * 12, "{edges}");
}

#[test]
fn openfoam_finds_nothing_to_say_and_measures_the_same() {
    for (name, body) in bodies() {
        for is_half in [true, false] {
            let (mesh, quality) = OGrid { is_half, ..COARSE }.mesh(&body).unwrap();
            assert_openfoam_agrees(name, &mesh, &quality);
        }
    }
}

#[test]
fn a_necked_robot_is_refused_with_the_place() {
    let body = sections(&Robot::NECKED_MAMBA, 1, 1.0);
    let refusal = OGrid { stations: 120, ..COARSE }.mesh(&body).unwrap_err().to_string();
    assert!(refusal.starts_with("the rays of the O-grid cross at x = "), "{refusal}");
    let x_m = number_after(&refusal, "x = ");
    // Its necks are 60 mm long, 90 mm to each side of the middle.
    assert!((x_m.abs() - 0.09).abs() < 0.031, "{refusal}");
}

#[test]
fn what_has_no_mesh_is_refused_in_a_sentence() {
    let refused = |grid: OGrid| grid.mesh(&capsule()).unwrap_err().to_string();
    assert_eq!(
        refused(OGrid { outer_radius_m: 0.5, ..COARSE }),
        "the radius of the outer sphere is 0.5; it must be a body's length, 1 m, at least: the water goes around the body"
    );
    assert_eq!(refused(OGrid { stations: 1, ..COARSE }), "the number of stations is 1; it must be from 4 to 10000");
    assert!(refused(OGrid { layers: usize::MAX, ..COARSE }).starts_with("the number of layers is"));
    assert!(
        refused(OGrid { first_layer_m: f64::NAN, ..COARSE }).starts_with("the thickness of the first layer is NaN")
    );
    assert!(refused(OGrid { outer_radius_m: f64::INFINITY, ..COARSE }).contains("inf"));
    assert!(refused(OGrid { stations: 10_000, layers: 10_000, ..COARSE }).starts_with("the number of cells is"));
    // Cells of 40 mm by 0.01 mm.
    assert!(
        refused(OGrid { layers: 40, first_layer_m: 1e-5, ..COARSE }).starts_with("the aspect ratio of the mesh is ")
    );
}
