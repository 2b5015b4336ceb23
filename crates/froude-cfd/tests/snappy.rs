//! A neck that no O-grid goes around, by snappyHexMesh.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::atomic::AtomicBool;

use froude_cfd::foam_mesh::FoamMesh;
use froude_cfd::openfoam::OpenFoam;
use froude_cfd::snappy::Snappy;
use froude_mesh::robot::{Robot, sections};
use froude_mesh::sections::Resolution;

const COARSE: Snappy = Snappy {
    surface_cell_m: 0.01,
    levels: 4,
    layers: 3,
    first_layer_m: 1e-3,
    growth: 1.3,
    reach_m: 1.28,
    is_half: true,
};

#[test]
fn a_necked_robot_has_a_mesh_and_its_patches() {
    let openfoam = match OpenFoam::find() {
        Ok(openfoam) => openfoam,
        Err(error) => {
            assert!(std::env::var_os("CI").is_none(), "{error}");
            println!("left out: {error}");
            return;
        }
    };
    let body = sections(&Robot::NECKED_MAMBA, 1, 0.01);
    let surface = body.mesh(Resolution { along: 1, around: 48 }).unwrap().mesh;
    let [meshes, folder] = [(); 2].map(|()| tempfile::tempdir().unwrap());
    let cancel = AtomicBool::new(false);
    let mesh = COARSE.mesh(&surface, meshes.path(), folder.path(), &openfoam, &cancel).unwrap();
    let log = std::fs::read_to_string(folder.path().join("log.checkMesh")).unwrap();
    let volume = log.split("Total volume = ").nth(1).unwrap().split(". ").next().unwrap();
    // Half of a box less half of the body, whose mesh has its corners on the body and chords between them.
    let carved_m3 = 4.0 * 1.28_f64.powi(3) - volume.parse::<f64>().unwrap();
    assert!((carved_m3 / (0.5 * body.volume_m3()) - 1.0).abs() < 0.05, "{carved_m3}");
    assert!(mesh.starts_with(meshes.path()));
    let found = FoamMesh::read(&mesh).unwrap();
    let mut patches: Vec<(&str, &str)> = found.patches.iter().map(|p| (p.name.as_str(), p.kind.as_str())).collect();
    patches.sort_unstable();
    assert_eq!(patches, [("body", "wall"), ("far", "patch"), ("symmetry", "symmetryPlane")]);
}

#[test]
fn numbers_that_no_mesh_has_are_refused_before_anything_runs() {
    let Ok(openfoam) = OpenFoam::find() else { return };
    let folder = tempfile::tempdir().unwrap();
    let refused = |snappy: Snappy| {
        let nothing = froude_mesh::mesh::Mesh::default();
        let cancel = AtomicBool::new(false);
        snappy.mesh(&nothing, folder.path(), folder.path(), &openfoam, &cancel).unwrap_err().to_string()
    };
    assert!(refused(Snappy { surface_cell_m: 0.0, ..COARSE }).starts_with("the cells at the surface is 0"));
    assert!(
        refused(Snappy { levels: 400, ..COARSE }).starts_with("the number of far cells in half of the box's edge is 0")
    );
    assert_eq!(
        refused(COARSE),
        "the extent of the surface from the origin is 0; it must be above 0 and at most half of 1.28 m, which the box reaches"
    );
    assert!(std::fs::read_dir(folder.path()).unwrap().next().is_none());
}
