//! The meshes of a campaign: an O-grid where one goes around the body, and otherwise cubes that snappyHexMesh cuts.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use crate::again::Again;
use crate::body::Shaped;
use crate::lock::Lock;
use crate::matrix::{Meshed, computed_again};
use crate::mesh_error::MeshError;
use crate::o_grid::OGrid;
use crate::openfoam::OpenFoam;
use crate::poly_mesh::PolyMesh;
use crate::quality::Quality;
use crate::section::Mesher;
use crate::snappy::Made;
use crate::surface::{bounds_m, shadow_m2};
use crate::wall::{MIN_COVERAGE, MeshQuality, WallLayers};
use froude_hydro::similarity::blockage;
use froude_mesh::sections::SectionBody;

use super::asked::Asked;
use super::error::VerbError;

/// Folder of the meshes in that of a campaign's cases.
pub(super) const MESHES: &str = "meshes";
/// Angles this close are one, as in the run matrix.
const SAME_RAD: f64 = 1e-9;

/// A mesh that is there.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Ready {
    /// Its folder.
    pub mesh: String,
    /// Which cases run on it; `None`: those of the plan.
    pub again: Option<Again>,
    /// Cells.
    pub cells: usize,
    /// How good it is.
    pub quality: MeshQuality,
    /// Height of the layer at the wall that was asked for, m.
    pub first_layer_m: f64,
    /// What snappyHexMesh made, where it did.
    pub cubes: Option<Made>,
    /// Why an O-grid was not taken that was asked for by a name.
    pub instead: Option<String>,
}

/// A body with the meshes of its cases, of all angles or of one.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Group {
    /// What was left out or changed in reading the body, a sentence each.
    pub notes: Vec<String>,
    /// Height of the body, z, m.
    pub height_m: f64,
    /// Part of a tank's section that the body blocks \[-\].
    pub blockage: Option<f64>,
    /// The same as the run matrix takes it.
    pub meshed: Meshed,
    /// Its own mesh first.
    pub meshes: Vec<Ready>,
}

/// All meshes of a body: one, or in a tank one for each angle, as the walls lie along the velocity.
pub(super) fn of_body(
    asked: &Asked,
    body: &Shaped,
    cancel: &AtomicBool,
    tell: &dyn Fn(&str),
) -> Result<Vec<Group>, VerbError> {
    let name = if body.configuration.is_empty() { "the body" } else { &body.configuration };
    if asked.spec.tank.is_none() {
        tell(&format!("mesh of {name}"));
        return Ok(vec![of_angle(asked, body, None, cancel)?]);
    }
    let own = asked.source.plan.iter().filter(|block| block.configurations.contains(&body.configuration));
    let mut angles: Vec<f64> = own.flat_map(|block| block.angle_rad.iter().copied()).collect();
    angles.sort_by(f64::total_cmp);
    angles.dedup_by(|a, b| (*a - *b).abs() <= SAME_RAD);
    let mut out = Vec::with_capacity(angles.len());
    for angle in angles {
        tell(&format!("mesh of {name} at {:.1}°", angle.to_degrees()));
        out.push(of_angle(asked, body, Some(angle), cancel)?);
    }
    Ok(out)
}

fn of_angle(asked: &Asked, body: &Shaped, angle_rad: Option<f64>, cancel: &AtomicBool) -> Result<Group, VerbError> {
    let refused = |e: MeshError| -> VerbError {
        let name = if body.configuration.is_empty() { "the body" } else { &body.configuration };
        match e {
            MeshError::OpenFoam(error) => error.into(),
            e => VerbError::input(&asked.body, format!("no mesh of {name}: {e}")),
        }
    };
    // The surface itself is not kept: a plan may have hundreds of bodies.
    let [low, high] = bounds_m(&body.surface);
    let group = |meshes: Vec<Ready>| Group {
        notes: body.notes.clone(),
        height_m: high[2] - low[2],
        blockage: asked.spec.tank.zip(angle_rad).map(|(tank, angle)| {
            let (sin, cos) = angle.sin_cos();
            blockage(shadow_m2(&body.surface, [cos, -sin, 0.0]), tank.width_m * tank.depth_m)
        }),
        meshed: Meshed {
            configuration: body.configuration.clone(),
            mesh: meshes.first().map(|own| own.mesh.clone()).unwrap_or_default(),
            reference: body.reference,
            others: meshes.iter().filter_map(|m| Some((m.again?, m.mesh.clone()))).collect(),
            angle_rad,
        },
        meshes,
    };
    let again = computed_again(&asked.spec, &body.configuration);
    let meshes = asked.folder.join(MESHES);
    let mut instead = None;
    let sections = body.sections.as_ref().filter(|_| asked.spec.tank.is_none());
    match (asked.spec.mesher, sections) {
        (Mesher::OGrid, None) => {
            let problem = "is a surface that no O-grid follows; write mesh = \"coarse\", or { surface_cell, first_layer }, which snappyHexMesh cuts cubes for";
            return Err(VerbError::input(&asked.body, problem));
        }
        (Mesher::OGrid | Mesher::ByBody, Some(sections)) => match body.grid(&asked.spec).mesh(sections) {
            Ok(own) => {
                let mut ready = vec![written(asked, &meshes, None, own).map_err(refused)?];
                for again in again {
                    let mesh =
                        grid(asked, body, sections, again).and_then(|grid| grid.mesh(sections)).map_err(refused)?;
                    ready.push(written(asked, &meshes, Some(again), mesh).map_err(refused)?);
                }
                return Ok(group(ready));
            }
            Err(MeshError::Crossing { place }) if asked.spec.mesher == Mesher::ByBody => instead = Some(place),
            Err(error) => return Err(refused(error)),
        },
        (Mesher::Cubes(_), _) | (Mesher::ByBody, None) => {}
    }
    if !again.is_empty() {
        let problem = "is meshed by cubes, and no two such meshes are similar: take fine and [[source.cfd.study]] out of [source.cfd]";
        return Err(VerbError::input(&asked.body, problem));
    }
    let cubes = body.cubes(&asked.spec, angle_rad.unwrap_or(0.0));
    let made = match cubes.known(&body.surface, &meshes) {
        Some(made) => made,
        None => {
            let openfoam = OpenFoam::find()?;
            std::fs::create_dir_all(&asked.folder).map_err(|e| VerbError::input(&asked.folder, e.to_string()))?;
            let _lock = Lock::take(&asked.folder)?;
            cubes.mesh(&body.surface, &meshes, &openfoam, cancel).map_err(refused)?
        }
    };
    if made.area_coverage < MIN_COVERAGE {
        let problem = format!(
            "layers cover {} % of the body's area, but at least {} % is required, because the friction is not resolved without layers; write mesh = {{ surface_cell, first_layer, layers }} with smaller cubes or fewer layers",
            (100.0 * made.area_coverage).round(),
            (100.0 * MIN_COVERAGE).round()
        );
        return Err(refused(MeshError::Refused(problem)));
    }
    let quality = MeshQuality {
        max_non_orthogonality_rad: made.max_non_orthogonality_rad,
        max_skewness: made.max_skewness,
        layers: Some(WallLayers {
            requested: made.layers_asked,
            achieved: made.layers,
            thickness_coverage: made.coverage,
            area_coverage: made.area_coverage,
        }),
    };
    quality.write(&meshes.join(&made.mesh))?;
    Ok(group(vec![Ready {
        mesh: made.mesh.clone(),
        again: None,
        cells: made.cells,
        quality,
        first_layer_m: cubes.first_layer_m,
        cubes: Some(made),
        instead,
    }]))
}

/// An O-grid, written.
fn written(
    asked: &Asked,
    meshes: &Path,
    again: Option<Again>,
    (mesh, quality): (PolyMesh, Quality),
) -> Result<Ready, MeshError> {
    let folder = mesh.write(meshes)?;
    let quality = MeshQuality {
        max_non_orthogonality_rad: quality.max_non_orthogonality_rad.value,
        max_skewness: quality.max_skewness.value,
        layers: None,
    };
    quality.write(&folder)?;
    let first_layer_m = match (again, asked.spec.fine) {
        (Some(Again::Fine), Some(fine)) => fine.mesh.first_layer_m,
        _ => asked.spec.mesh.first_layer_m,
    };
    Ok(Ready {
        mesh: folder.file_name().unwrap_or_default().to_string_lossy().into_owned(),
        again,
        cells: mesh.cells,
        quality,
        first_layer_m,
        cubes: None,
        instead: None,
    })
}

/// The grid of the cases that compute the plan's settings again.
fn grid(asked: &Asked, body: &Shaped, sections: &SectionBody, again: Again) -> Result<OGrid, MeshError> {
    let own = body.grid(&asked.spec);
    match (again, asked.spec.fine) {
        (Again::Fine, Some(fine)) => Ok(body.grid_of(&asked.spec, fine.mesh)),
        (Again::Grid(level), _) => own.at_level(sections, level),
        (Again::Domain(radius), _) => own.of_radius(sections, radius * body.reference.length_m),
        (Again::Cold | Again::Fine, _) => Ok(own),
    }
}
