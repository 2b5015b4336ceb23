//! The cylinder and the plate.

use std::f64::consts::PI;

use crate::common::assert_openfoam_agrees;

use crate::cylinder_mesh::Cylinder;
use crate::plate_mesh::Plate;

const CYLINDER: Cylinder =
    Cylinder { diameter_m: 1.0, span_m: 1.0, around: 64, layers: 40, first_layer_m: 0.02, outer_radius_m: 30.0 };
const PLATE: Plate =
    Plate { length_m: 1.0, span_m: 0.5, along: 40, beyond: 24, layers: 40, first_layer_m: 1e-3, far_m: 4.0 };

#[test]
fn a_cylinder_has_the_area_of_its_polygons() {
    let (mesh, quality) = CYLINDER.mesh().unwrap();
    assert_eq!(mesh.cells, 64 * 40);
    let polygon = 32.0 * (2.0 * PI / 64.0).sin();
    assert!((quality.volume_m3 / (polygon * (900.0 - 0.25)) - 1.0).abs() < 1e-12);
    assert!(quality.max_openness.value < 1e-12);
    assert!(quality.patch_area_m2.iter().flatten().all(|v| v.abs() < 1e-12), "{:?}", quality.patch_area_m2);
    assert_openfoam_agrees("cylinder", &mesh, &quality);
}

#[test]
fn a_plate_is_a_wall_between_planes_of_symmetry() {
    let (mesh, quality) = PLATE.mesh().unwrap();
    assert_eq!(mesh.cells, (40 + 48) * 40);
    let faces: Vec<(&str, usize)> = mesh.patches.iter().map(|p| (p.name.as_str(), p.count)).collect();
    assert_eq!(faces, [("body", 40), ("far", 88 + 80), ("symmetry", 48), ("front_and_back", 2 * 88 * 40)]);
    assert!((quality.volume_m3 - 9.0 * 4.0 * 0.5).abs() < 1e-12);
    let [x, y, z] = quality.patch_area_m2[0];
    assert!(x == 0.0 && (y + 0.5).abs() < 1e-12 && z == 0.0);
    assert!((quality.patch_area_m2[2][1] + 4.0).abs() < 1e-12);
    assert_openfoam_agrees("plate", &mesh, &quality);
}

#[test]
fn what_has_no_mesh_is_refused() {
    let refused = |cylinder: Cylinder| cylinder.mesh().unwrap_err().to_string();
    assert_eq!(
        refused(Cylinder { diameter_m: -1.0, ..CYLINDER }),
        "the cylinder's diameter is -1; it must be above 0 and finite, in metres"
    );
    assert!(refused(Cylinder { outer_radius_m: 0.4, ..CYLINDER }).starts_with("the thickness of the first layer"));
    assert!(refused(Cylinder { span_m: f64::NAN, ..CYLINDER }).contains("NaN"));
    assert!(refused(Cylinder { around: 0, ..CYLINDER }).starts_with("the number of cells around is 0"));
    let refused = |plate: Plate| plate.mesh().unwrap_err().to_string();
    assert!(
        refused(Plate { first_layer_m: 1e-6, layers: 60, ..PLATE }).starts_with("the aspect ratio of the mesh is ")
    );
    let far = refused(Plate { along: 4000, ..PLATE });
    assert!(
        far.starts_with("the number of cells beyond the plate's edges is 24; it must be so many that they reach 4 m"),
        "{far}"
    );
}
