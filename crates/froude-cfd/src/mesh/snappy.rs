//! Meshes of any closed surface by OpenFOAM's own `blockMesh` and `snappyHexMesh`: for necks and hulls that no O-grid goes around, and for bodies in a tank.
//!
//! A box of cubes is halved towards the body as often as `levels` says, its cells are moved onto the surface, and layers are put under them. What comes out is what `checkMesh` has nothing to say of, or an error; the counts of cells are the program's, and no family of such meshes is similar.
//!
//! **Frame.** The box lies along the axes that the body's turn about z by `turn_rad` brings its own to. The mesh is in body axes.
//! **Once.** What was made of the same surface with the same numbers stands in `meshes/snappy-HASH.json` and is not made again; while it is made, and where it fails, the folder `meshes/snappy-HASH` has the programs' logs.

use std::path::Path;
use std::sync::atomic::AtomicBool;

use froude_mesh::mesh::Mesh;
use froude_mesh::vector::Vec3;
use froude_records::RecordError;
use froude_records::hash::sha256_of_bytes;
use froude_records::write::write_atomically;

use crate::input;
use crate::mesh_error::{MeshError, check_counts, check_length};
use crate::openfoam::{End, OpenFoam};
use crate::poly_mesh::PolyMesh;
use crate::poly_mesh_files::keep;
use crate::quality::layered_area;
pub use crate::snappy_log::Made;
use crate::snappy_log::{fault_of, layers_of, quality_of};
use crate::surface::bounds_m;

/// How fine such a mesh is, and how far it goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Snappy {
    /// Cells at the surface, m.
    pub surface_cell_m: f64,
    /// How often cells are halved from the far ones to those.
    pub levels: usize,
    /// Layers under the surface.
    pub layers: usize,
    /// Thickness of the cells at the wall, m.
    pub first_layer_m: f64,
    /// Each layer over the one before \[-\].
    pub growth: f64,
    /// Two corners of the box, m.
    pub box_m: [Vec3; 2],
    /// What its sides are.
    pub sides: Sides,
    /// Turn of the body about z in the box, rad.
    pub turn_rad: f64,
    /// The half domain z ≥ 0 with a plane of symmetry, or all of it.
    pub is_half: bool,
}

/// What the sides of a box are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sides {
    /// Open water.
    Open,
    /// A tank along the box's x: open at its ends, and four sides along which the water slips, as the walls move with it. The water's surface is one, flat.
    Tank,
}

/// A cell at the wall is a layer up to this many times the height of the first layer: snappyHexMesh may give a face fewer layers of the same thickness in all, whose first one is as high as a cube.
const LAYER_HEIGHT: f64 = 2.0;
const FILES: [&str; 5] = ["points", "faces", "owner", "neighbour", "boundary"];

impl Snappy {
    /// The mesh, where it was made before.
    #[must_use]
    pub fn known(&self, surface: &Mesh, meshes: &Path) -> Option<Made> {
        let text = input::text(&meshes.join(format!("{}.json", self.name(surface).ok()?))).ok()?;
        let made: Made = serde_json::from_str(&text).ok()?;
        meshes.join(&made.mesh).is_dir().then_some(made)
    }

    /// Makes the mesh around a closed surface in body axes and puts it into `meshes/HASH`: patches `body`, `far`, `tank` of a tank, and `symmetry` of the half domain.
    ///
    /// # Errors
    ///
    /// [`MeshError`]: numbers that no mesh has, a body that does not fit, a program that fails, a mesh that `checkMesh` finds fault with.
    pub fn mesh(
        &self,
        surface: &Mesh,
        meshes: &Path,
        openfoam: &OpenFoam,
        cancel: &AtomicBool,
    ) -> Result<Made, MeshError> {
        let name = self.name(surface)?;
        if let Some(made) = self.known(surface, meshes) {
            return Ok(made);
        }
        let folder = meshes.join(&name);
        let failed = |e: std::io::Error| RecordError::Write { path: folder.clone(), reason: e.to_string() };
        if folder.exists() {
            std::fs::remove_dir_all(&folder).map_err(failed)?;
        }
        self.write(&self.turned(surface), &folder)?;
        let no_mesh = |program: &str, problem: &str| {
            let log = folder.join(format!("log.{program}"));
            MeshError::Refused(format!("{program} made no mesh: {problem}; its log is {}", log.display()))
        };
        let run = |program: &'static str, arguments: &[&str], sign: &str| -> Result<String, MeshError> {
            let log = format!("log.{program}");
            let end = openfoam.run(program, arguments, 1, &folder, &log, cancel, &mut || {})?;
            let text = input::text(&folder.join(&log)).unwrap_or_default();
            if end == End::Whole && text.contains(sign) {
                return Ok(text);
            }
            let problem = fault_of(&text).unwrap_or_else(|| format!("it ended as {end:?}"));
            Err(no_mesh(program, &problem))
        };
        run("blockMesh", &[], "End")?;
        let snapped = run("snappyHexMesh", &["-overwrite"], "Finished meshing")?;
        let checked = run("checkMesh", &["-constant"], "Mesh OK.")?;
        let unreadable = |program: &str| no_mesh(program, "its log does not say what it made");
        let (wall_faces, layers, layers_m, coverage) =
            layers_of(&snapped, "body").ok_or_else(|| unreadable("snappyHexMesh"))?;
        let (cells, non_orthogonality_deg, max_skewness) =
            quality_of(&checked).ok_or_else(|| unreadable("checkMesh"))?;
        let kept = keep(meshes, &self.files(&folder)?)?;
        let finished =
            PolyMesh::read(&kept).map_err(|e| no_mesh("snappyHexMesh", &format!("its mesh cannot be read: {e}")))?;
        let made = Made {
            mesh: kept.file_name().unwrap_or_default().to_string_lossy().into_owned(),
            cells,
            max_non_orthogonality_rad: non_orthogonality_deg.to_radians(),
            max_skewness,
            wall_faces,
            layers_asked: self.layers,
            layers,
            layers_m,
            coverage,
            area_coverage: layered_area(&finished, LAYER_HEIGHT * self.first_layer_m),
            openfoam: openfoam.version.clone(),
        };
        input::write_json(&meshes.join(format!("{name}.json")), &made)?;
        std::fs::remove_dir_all(&folder).map_err(failed)?;
        Ok(made)
    }

    /// Of all that the mesh depends on, OpenFOAM aside.
    fn name(&self, surface: &Mesh) -> Result<String, MeshError> {
        self.check(surface)?;
        let inputs = self.inputs(&self.turned(surface));
        let parts: Vec<String> =
            inputs.iter().map(|(name, bytes)| format!("{name} {} {}", sha256_of_bytes(bytes), self.turn_rad)).collect();
        Ok(format!("snappy-{}", &sha256_of_bytes(parts.join("\n").as_bytes())[..16]))
    }

    /// The surface as it lies in the box.
    fn turned(&self, surface: &Mesh) -> Mesh {
        let turn = Turn::by(self.turn_rad);
        surface.mapped(|point| turn.of(point))
    }

    /// The mesh's files, in body axes.
    fn files(&self, folder: &Path) -> Result<Vec<(&'static str, String)>, MeshError> {
        let back = Turn::by(-self.turn_rad);
        let mut files = Vec::new();
        for name in FILES {
            let path = folder.join("constant/polyMesh").join(name);
            let text =
                input::text(&path).map_err(|e| RecordError::Read { path: path.clone(), reason: e.to_string() })?;
            files.push((name, if name == "points" && self.turn_rad != 0.0 { back.of_points(&text) } else { text }));
        }
        Ok(files)
    }

    /// Far cells along x, y, z.
    pub(crate) fn far_cells(&self) -> [usize; 3] {
        let far_m = self.surface_cell_m * 2.0_f64.powf(self.levels as f64);
        let [low, high] = self.box_m;
        core::array::from_fn(|k| ((high[k] - low[k]) / far_m).round() as usize)
    }

    fn check(&self, surface: &Mesh) -> Result<(), MeshError> {
        check_length("the cells at the surface", self.surface_cell_m)?;
        check_length("the thickness of the first layer", self.first_layer_m)?;
        check_length("the growth of the layers", self.growth)?;
        check_counts(&[("the number of layers", self.layers, 1)])?;
        check_counts(&[("the number of halvings", self.levels, 1)])?;
        let [x, y, z] = self.far_cells();
        check_counts(&[
            ("the number of far cells along the box", x, 2),
            ("the number of far cells across the box", y, 2),
            ("the number of far cells over the box's height", z, 2),
        ])?;
        if surface.panels.is_empty() {
            return Err(MeshError::Refused("the body is not in the water: the surface has no panel".to_owned()));
        }
        let ([low, high], [least, most]) = (self.box_m, bounds_m(&self.turned(surface)));
        for (k, axis) in ["along", "across", "over its height"].into_iter().enumerate() {
            // Half of the box to each side of open water; of a tank a few cells before its walls.
            let room_m = match self.sides {
                Sides::Tank if k > 0 => 4.0 * self.surface_cell_m,
                _ => 0.25 * (high[k] - low[k]),
            };
            let is_cut = self.is_half && k == 2;
            if most[k] > high[k] - room_m || (!is_cut && least[k] < low[k] + room_m) {
                let problem = format!(
                    "the body is not in the water: {axis} the box of {:.4} to {:.4} m the body reaches from {:.4} to {:.4} m, and {room_m:.4} m of water are needed on both sides",
                    low[k], high[k], least[k], most[k]
                );
                return Err(MeshError::Refused(problem));
            }
        }
        Ok(())
    }

    fn write(&self, surface: &Mesh, folder: &Path) -> Result<(), MeshError> {
        for inner in ["constant/triSurface", "system"] {
            let path = folder.join(inner);
            std::fs::create_dir_all(&path)
                .map_err(|e| RecordError::Write { path: path.clone(), reason: e.to_string() })?;
        }
        for (name, bytes) in self.inputs(surface) {
            write_atomically(&folder.join(name), &bytes)?;
        }
        Ok(())
    }
}

/// A turn about z.
#[derive(Debug, Clone, Copy)]
struct Turn {
    sin: f64,
    cos: f64,
}

impl Turn {
    fn by(angle_rad: f64) -> Self {
        let (sin, cos) = angle_rad.sin_cos();
        Self { sin, cos }
    }

    fn of(self, [x, y, z]: Vec3) -> Vec3 {
        [self.cos * x - self.sin * y, self.sin * x + self.cos * y, z]
    }

    /// The points of a file of OpenFOAM, each on a line of its own.
    fn of_points(self, text: &str) -> String {
        let point = |line: &str| -> Option<Vec3> {
            let inner = line.strip_prefix('(')?.strip_suffix(')')?;
            let mut words = inner.split_whitespace().map(|word| word.parse::<f64>().ok());
            Some([words.next()??, words.next()??, words.next()??])
        };
        let mut out = String::with_capacity(text.len());
        for line in text.lines() {
            match point(line) {
                Some(found) => {
                    let [x, y, z] = self.of(found);
                    out.push_str(&format!("({x:.12e} {y:.12e} {z:.12e})"));
                }
                None => out.push_str(line),
            }
            out.push('\n');
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_turned_and_the_rest_of_their_file_stays() {
        let text = "FoamFile\n{\n    object points;\n}\n2\n(\n(1 0 3)\n(0 -2e-1 0)\n)\n";
        let turned = Turn::by(std::f64::consts::FRAC_PI_2).of_points(text);
        let lines: Vec<&str> = turned.lines().collect();
        assert_eq!((lines.len(), lines[2], lines[5], lines[8]), (9, "    object points;", "(", ")"));
        assert!(lines[6].ends_with(" 1.000000000000e0 3.000000000000e0)"), "{turned}");
        assert!(lines[7].starts_with("(2.000000000000e-1 "), "{turned}");
    }
}
