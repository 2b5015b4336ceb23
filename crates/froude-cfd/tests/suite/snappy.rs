//! A neck that no O-grid goes around, and a tank, by snappyHexMesh.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use froude_cfd::foam_mesh::FoamMesh;
use froude_cfd::openfoam::OpenFoam;
use froude_cfd::snappy::{Sides, Snappy};
use froude_mesh::robot::{Robot, sections};
use froude_mesh::sections::{Resolution, SectionBody};

const COARSE: Snappy = Snappy {
    surface_cell_m: 0.01,
    levels: 4,
    layers: 3,
    first_layer_m: 1e-3,
    growth: 1.3,
    box_m: [[-1.28, -1.28, 0.0], [1.28; 3]],
    sides: Sides::Open,
    turn_rad: 0.0,
    is_half: true,
};

fn openfoam() -> Option<OpenFoam> {
    match OpenFoam::find() {
        Ok(openfoam) => Some(openfoam),
        Err(error) => {
            assert!(std::env::var_os("CI").is_none(), "{error}");
            println!("left out: {error}");
            None
        }
    }
}

/// Patches and their types, in order of their names.
fn patches(folder: &Path) -> Vec<(String, String)> {
    let patches = FoamMesh::read(folder).unwrap().patches.into_iter();
    let mut found: Vec<_> = patches.map(|p| (p.name, p.kind.word().to_owned())).collect();
    found.sort_unstable();
    found
}

fn pairs(of: &[(&str, &str)]) -> Vec<(String, String)> {
    of.iter().map(|(a, b)| ((*a).to_owned(), (*b).to_owned())).collect()
}

#[test]
fn a_necked_robot_has_a_mesh_and_its_patches_and_is_meshed_once() {
    let Some(openfoam) = openfoam() else { return };
    let body = sections(&Robot::NECKED_MAMBA, 1, 0.01);
    let surface = body.mesh(Resolution { along: 1, around: 48 }).unwrap().mesh;
    let meshes = tempfile::tempdir().unwrap();
    let cancel = AtomicBool::new(false);
    assert_eq!(COARSE.known(&surface, meshes.path()), None);
    let made = COARSE.mesh(&surface, meshes.path(), &openfoam, &cancel).unwrap();
    assert!(made.cells > 1000 && made.max_skewness < 4.0 && made.max_non_orthogonality_rad < 1.3, "{made:?}");
    assert!(made.layers_asked == 3 && (0.5..=3.0).contains(&made.layers) && made.coverage <= 1.0, "{made:?}");
    assert_eq!(
        patches(&meshes.path().join(&made.mesh)),
        pairs(&[("body", "wall"), ("far", "patch"), ("symmetry", "symmetryPlane")])
    );
    assert_eq!(COARSE.known(&surface, meshes.path()), Some(made));
    assert_eq!(Snappy { growth: 1.2, ..COARSE }.known(&surface, meshes.path()), None);
}

/// A body across a tank: the mesh is in the body's axes, so its points lie in the turned tank.
#[test]
fn a_tank_lies_along_the_velocity_and_the_mesh_along_the_body() {
    let Some(openfoam) = openfoam() else { return };
    let surface = SectionBody::ellipsoid([0.1, 0.04, 0.04], 12).mesh(Resolution { along: 1, around: 32 }).unwrap().mesh;
    let tank = Snappy {
        surface_cell_m: 0.02,
        levels: 2,
        layers: 1,
        first_layer_m: 4e-3,
        growth: 1.2,
        box_m: [[-0.8, -0.3, -0.2], [0.8, 0.3, 0.3]],
        sides: Sides::Tank,
        turn_rad: std::f64::consts::FRAC_PI_2,
        is_half: false,
    };
    let meshes = tempfile::tempdir().unwrap();
    let cancel = AtomicBool::new(false);
    let made = tank.mesh(&surface, meshes.path(), &openfoam, &cancel).unwrap();
    let folder = meshes.path().join(&made.mesh);
    assert_eq!(patches(&folder), pairs(&[("body", "wall"), ("far", "patch"), ("tank", "symmetry")]));
    let text = std::fs::read_to_string(folder.join("points")).unwrap();
    let points: Vec<Vec<f64>> = text
        .lines()
        .filter_map(|line| line.strip_prefix('(')?.strip_suffix(')'))
        .map(|inner| inner.split_whitespace().map(|word| word.parse().unwrap()).collect())
        .collect();
    let most = |k: usize| points.iter().map(|p| p[k].abs()).fold(0.0, f64::max);
    // A turn by +90° brings x to y: along the body's y the tank is as long as its own x.
    // Smoothing moves points of the sides by a hundredth of the surface's cells.
    for (k, expected) in [0.3, 0.8, 0.3].into_iter().enumerate() {
        assert!((most(k) - expected).abs() < 0.02 * 0.02, "{k}: {} {expected}", most(k));
    }
}

#[test]
fn numbers_that_no_mesh_has_are_refused_before_anything_runs() {
    let Ok(openfoam) = OpenFoam::find() else { return };
    let folder = tempfile::tempdir().unwrap();
    let body = SectionBody::ellipsoid([0.5, 0.05, 0.05], 8).mesh(Resolution { along: 1, around: 16 }).unwrap().mesh;
    let refused = |snappy: Snappy, body: &froude_mesh::mesh::Mesh| {
        let cancel = AtomicBool::new(false);
        snappy.mesh(body, folder.path(), &openfoam, &cancel).unwrap_err().to_string()
    };
    assert!(refused(Snappy { surface_cell_m: 0.0, ..COARSE }, &body).starts_with("the cells at the surface is 0"));
    assert!(refused(Snappy { levels: 400, ..COARSE }, &body).starts_with("the number of far cells along the box is 0"));
    let nothing = froude_mesh::mesh::Mesh::default();
    assert_eq!(refused(COARSE, &nothing), "the body is not in the water: the surface has no panel");
    let long = body.mapped(|[x, y, z]| [2.0 * x, y, z]);
    assert!(refused(COARSE, &long).contains("along the box of -1.2800 to 1.2800 m the body reaches from -1.0000"));
    assert!(std::fs::read_dir(folder.path()).unwrap().next().is_none());
}
