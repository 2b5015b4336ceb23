//! Meshes of any closed surface by OpenFOAM's own `blockMesh` and `snappyHexMesh`: for necks and hulls that no O-grid goes around.
//!
//! A box of cubes about the origin is halved towards the body as often as `levels` says, its cells are moved onto the surface, and layers are put under them. What comes out is what `checkMesh` has nothing to say of, or an error; the counts of cells are the program's, and no family of such meshes is similar.

use std::fs::read_to_string;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use froude_mesh::files::write_stl_binary;
use froude_mesh::mesh::Mesh;
use froude_records::RecordError;
use froude_records::write::write_atomically;

use crate::dictionary::{Dictionary, Entry, vector};
use crate::mesh_error::{MeshError, check_counts, check_length};
use crate::openfoam::{End, OpenFoam};
use crate::poly_mesh_files::keep;

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
    /// Half of the box's edge, m.
    pub reach_m: f64,
    /// The half domain z ≥ 0 with a plane of symmetry, or all of it.
    pub is_half: bool,
}

const FILES: [&str; 5] = ["points", "faces", "owner", "neighbour", "boundary"];

impl Snappy {
    /// Makes the mesh around a closed surface that holds the origin, works in an empty folder, and puts it into `meshes/HASH`, which it gives: patches `body`, `far`, and `symmetry` of the half domain.
    ///
    /// # Errors
    ///
    /// [`MeshError`]: numbers that no mesh has, a program that fails, a mesh that `checkMesh` finds fault with.
    pub fn mesh(
        &self,
        surface: &Mesh,
        meshes: &Path,
        folder: &Path,
        openfoam: &OpenFoam,
        cancel: &AtomicBool,
    ) -> Result<PathBuf, MeshError> {
        let cells = self.check()?;
        let extent_m = surface.vertices.iter().flatten().fold(0.0, |most: f64, v| most.max(v.abs()));
        // Twice, so that the place in the water that the mesh is kept from is none in the body.
        if surface.panels.is_empty() || 2.0 * extent_m > self.reach_m {
            return Err(MeshError::Number {
                quantity: "the extent of the surface from the origin",
                found: extent_m,
                expected: format!("above 0 and at most half of {} m, which the box reaches", self.reach_m),
            });
        }
        self.write(surface, folder, cells)?;
        for (program, arguments, sign) in [
            ("blockMesh", &[][..], "End"),
            ("snappyHexMesh", &["-overwrite"][..], "Finished meshing"),
            ("checkMesh", &["-constant"][..], "Mesh OK."),
        ] {
            let log = format!("log.{program}");
            let end = openfoam.run(program, arguments, 1, folder, &log, cancel, &mut || {})?;
            let path = folder.join(&log);
            let text = read_to_string(&path).unwrap_or_default();
            if end != End::Whole || !text.contains(sign) {
                let faults: Vec<&str> = text.lines().filter(|l| l.contains("***")).map(str::trim).collect();
                let problem = if faults.is_empty() { format!("it ended as {end:?}") } else { faults.join("; ") };
                return Err(MeshError::Program { program, problem, log: path.display().to_string() });
            }
        }
        let mut files = Vec::new();
        for name in FILES {
            let path = folder.join("constant/polyMesh").join(name);
            let text =
                read_to_string(&path).map_err(|e| RecordError::Read { path: path.clone(), reason: e.to_string() })?;
            files.push((name, text));
        }
        keep(meshes, &files)
    }

    /// Cells of the box each way, in the half of its edge.
    fn check(&self) -> Result<usize, MeshError> {
        check_length("the cells at the surface", self.surface_cell_m)?;
        check_length("the thickness of the first layer", self.first_layer_m)?;
        check_length("the half of the box's edge", self.reach_m)?;
        check_length("the growth of the layers", self.growth)?;
        check_counts(&[("the number of layers", self.layers, 1)])?;
        check_counts(&[("the number of halvings", self.levels, 1)])?;
        let cells = (self.reach_m / (self.surface_cell_m * 2.0_f64.powf(self.levels as f64))).round() as usize;
        check_counts(&[("the number of far cells in half of the box's edge", cells, 2); 3])?;
        Ok(cells)
    }

    fn write(&self, surface: &Mesh, folder: &Path, cells: usize) -> Result<(), MeshError> {
        for inner in ["constant/triSurface", "system"] {
            let path = folder.join(inner);
            std::fs::create_dir_all(&path)
                .map_err(|e| RecordError::Write { path: path.clone(), reason: e.to_string() })?;
        }
        write_atomically(&folder.join("constant/triSurface/body.stl"), &write_stl_binary(surface))?;
        let control = values(&[
            ("application", "simpleFoam"),
            ("startFrom", "startTime"),
            ("startTime", "0"),
            ("stopAt", "endTime"),
            ("endTime", "1"),
            ("deltaT", "1"),
            ("writeControl", "timeStep"),
            ("writeInterval", "1"),
            ("writeFormat", "ascii"),
            ("writePrecision", "12"),
        ]);
        let schemes = ["ddt", "grad", "div", "laplacian", "interpolation", "snGrad"]
            .iter()
            .fold(Dictionary::default(), |all, name| all.with(&format!("{name}Schemes"), Dictionary::default()));
        for (name, dictionary) in [
            ("controlDict", control),
            ("fvSchemes", schemes),
            ("fvSolution", Dictionary::default()),
            ("blockMeshDict", self.block(cells)),
            ("snappyHexMeshDict", self.snappy()),
        ] {
            write_atomically(&folder.join("system").join(name), dictionary.file("dictionary", name).as_bytes())?;
        }
        Ok(())
    }

    fn block(&self, cells: usize) -> Dictionary {
        let r = self.reach_m;
        let (low, up) = if self.is_half { (0.0, cells) } else { (-r, 2 * cells) };
        let corners: Vec<String> =
            [low, r].iter().flat_map(|&z| [[-r, -r, z], [r, -r, z], [r, r, z], [-r, r, z]]).map(vector).collect();
        let (bottom, kind) = if self.is_half { ("symmetry", "symmetryPlane") } else { ("bottom", "patch") };
        let sides = "(0 4 7 3) (1 2 6 5) (0 1 5 4) (3 7 6 2) (4 5 6 7)";
        let (sides, last) = if self.is_half {
            (sides.to_owned(), format!("{bottom}\n{{\n type {kind};\n faces ((0 3 2 1));\n}}\n"))
        } else {
            (format!("{sides} (0 3 2 1)"), String::new())
        };
        Dictionary::default()
            .with("scale", "1")
            .with("vertices", format!("({})", corners.join(" ")))
            .with("blocks", format!("(hex (0 1 2 3 4 5 6 7) ({0} {0} {up}) simpleGrading (1 1 1))", 2 * cells))
            .with("edges", "()")
            .with("boundary", format!("(\nfar\n{{\n type patch;\n faces ({sides});\n}}\n{last})"))
    }

    /// Cells whose centre is this near to the surface are halved: more than half of their diagonal, so that no body is missed between the centres.
    fn distances(&self) -> String {
        let of = |level: usize| 2.0 * self.surface_cell_m * 2.0_f64.powf((self.levels - level) as f64);
        let levels: Vec<String> = (1..=self.levels).rev().map(|level| format!("({} {level})", of(level))).collect();
        format!("({})", levels.join(" "))
    }

    fn snappy(&self) -> Dictionary {
        let level = format!("({0} {0})", self.levels);
        let body = |inner: Dictionary| Dictionary::default().with("body", inner);
        let castellated = values(&[
            ("maxLocalCells", "20000000"),
            ("maxGlobalCells", "50000000"),
            ("minRefinementCells", "0"),
            ("nCellsBetweenLevels", "3"),
            ("features", "()"),
            ("resolveFeatureAngle", "30"),
            ("allowFreeStandingZoneFaces", "false"),
        ])
        // Not on a face of any cell.
        .with("locationInMesh", vector([0.911, 0.917, 0.907].map(|part| part * self.reach_m)))
        .with("refinementRegions", body(values(&[("mode", "distance"), ("levels", &self.distances())])))
        .with("refinementSurfaces", body(values(&[("level", &level)]).with("patchInfo", values(&[("type", "wall")]))));
        let snap = values(&[
            ("nSmoothPatch", "3"),
            ("tolerance", "2"),
            ("nSolveIter", "50"),
            ("nRelaxIter", "5"),
            ("nFeatureSnapIter", "10"),
            ("implicitFeatureSnap", "true"),
            ("explicitFeatureSnap", "false"),
        ]);
        let layers = values(&[
            ("relativeSizes", "false"),
            ("firstLayerThickness", &self.first_layer_m.to_string()),
            ("expansionRatio", &self.growth.to_string()),
            ("minThickness", &(0.1 * self.first_layer_m).to_string()),
            ("nGrow", "0"),
            ("featureAngle", "130"),
            ("nRelaxIter", "5"),
            ("nSmoothSurfaceNormals", "1"),
            ("nSmoothNormals", "3"),
            ("nSmoothThickness", "10"),
            ("maxFaceThicknessRatio", "0.5"),
            ("maxThicknessToMedialRatio", "0.3"),
            ("minMedianAxisAngle", "90"),
            ("nBufferCellsNoExtrude", "0"),
            ("nLayerIter", "50"),
        ])
        .with("layers", body(values(&[("nSurfaceLayers", &self.layers.to_string())])));
        let quality = values(&[
            ("maxNonOrtho", "65"),
            ("maxBoundarySkewness", "4"),
            ("maxInternalSkewness", "4"),
            ("maxConcave", "80"),
            ("minVol", "1e-18"),
            ("minTetQuality", "1e-30"),
            ("minArea", "-1"),
            ("minTwist", "0.02"),
            ("minDeterminant", "0.001"),
            ("minFaceWeight", "0.05"),
            ("minVolRatio", "0.01"),
            ("minTriangleTwist", "-1"),
            ("nSmoothScale", "4"),
            ("errorReduction", "0.75"),
        ]);
        values(&[("castellatedMesh", "true"), ("snap", "true"), ("addLayers", "true"), ("mergeTolerance", "1e-6")])
            .with(
                "geometry",
                Dictionary::default().with("body.stl", values(&[("type", "triSurfaceMesh"), ("name", "body")])),
            )
            .with("castellatedMeshControls", castellated)
            .with("snapControls", snap)
            .with("addLayersControls", layers)
            .with("meshQualityControls", quality)
    }
}

fn values(entries: &[(&str, &str)]) -> Dictionary {
    entries
        .iter()
        .fold(Dictionary::default(), |all, &(keyword, value)| all.with(keyword, Entry::Value(value.to_owned())))
}
