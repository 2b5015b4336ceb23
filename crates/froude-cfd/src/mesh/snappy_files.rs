//! The files that blockMesh and snappyHexMesh work by.

use froude_mesh::files::write_stl_binary;
use froude_mesh::mesh::Mesh;

use crate::dictionary::{Dictionary, Entry, vector};
use crate::snappy::{Sides, Snappy};

/// Cells are halved within so many of their edges from the surface. An O-grid of 16 cells over half a turn has cells of a fifth of the distance from its axis.
const SPREAD: f64 = 5.0;

impl Snappy {
    /// Names within the folder, and content.
    pub(crate) fn inputs(&self, surface: &Mesh) -> Vec<(String, Vec<u8>)> {
        let mut files = vec![("constant/triSurface/body.stl".to_owned(), write_stl_binary(surface))];
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
            ("blockMeshDict", self.block()),
            ("snappyHexMeshDict", self.snappy()),
        ] {
            files.push((format!("system/{name}"), dictionary.file("dictionary", name).into_bytes()));
        }
        files
    }

    fn block(&self) -> Dictionary {
        let [[x0, y0, z0], [x1, y1, z1]] = self.box_m;
        let corners: Vec<String> =
            [z0, z1].iter().flat_map(|&z| [[x0, y0, z], [x1, y0, z], [x1, y1, z], [x0, y1, z]]).map(vector).collect();
        let [x, y, z] = self.far_cells();
        let (ends, sides, bottom) = ("(0 4 7 3) (1 2 6 5)", "(0 1 5 4) (3 7 6 2) (4 5 6 7)", "(0 3 2 1)");
        let sides = if self.is_half { sides.to_owned() } else { format!("{sides} {bottom}") };
        let mut patches = match self.sides {
            Sides::Open => vec![("far", "patch", format!("{ends} {sides}"))],
            // Water slips along a plane of symmetry, and pushes on it.
            Sides::Tank => vec![("far", "patch", ends.to_owned()), ("tank", "symmetry", sides)],
        };
        if self.is_half {
            patches.push(("symmetry", "symmetryPlane", bottom.to_owned()));
        }
        let patches: Vec<String> = patches
            .iter()
            .map(|(name, kind, faces)| format!("{name}\n{{\n type {kind};\n faces ({faces});\n}}\n"))
            .collect();
        Dictionary::default()
            .with("scale", "1")
            .with("vertices", format!("({})", corners.join(" ")))
            .with("blocks", format!("(hex (0 1 2 3 4 5 6 7) ({x} {y} {z}) simpleGrading (1 1 1))"))
            .with("edges", "()")
            .with("boundary", format!("(\n{})", patches.concat()))
    }

    /// Cells whose centre is this near to the surface are halved; more than half of their diagonal, so that no body is missed between the centres.
    fn distances(&self) -> String {
        let of = |level: usize| SPREAD * self.surface_cell_m * 2.0_f64.powf((self.levels - level) as f64);
        let levels: Vec<String> = (1..=self.levels).rev().map(|level| format!("({} {level})", of(level))).collect();
        format!("({})", levels.join(" "))
    }

    /// A point near a corner of the box, beyond all bodies that fit.
    fn in_the_water(&self) -> [f64; 3] {
        let [low, high] = self.box_m;
        let part = [0.9555, 0.9885, 0.9935];
        core::array::from_fn(|k| low[k] + part[k] * (high[k] - low[k]))
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
        .with("locationInMesh", vector(self.in_the_water()))
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
            // The relaxed limits hold for the layers from the first iteration on.
            ("nRelaxedIter", "0"),
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
        ])
        .with("relaxed", relaxed_for_layers());
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

/// Limits for cells in layers, which are up to a thousand times as wide as high.
///
/// The determinant of a cell falls with its aspect ratio, and the tetrahedra of a face that is not flat are inside out once a layer is thinner than the face's sagitta. Both limits of the cubes therefore reject every layer of a hull whose cells are some centimetres wide, although the solver needs neither. The limits on twist, weights and ratios of volumes stay: without them SUBOFF has more layers, and the solver diverges within 20 iterations.
fn relaxed_for_layers() -> Dictionary {
    values(&[("minTetQuality", "-1e30"), ("minDeterminant", "1e-12")])
}

fn values(entries: &[(&str, &str)]) -> Dictionary {
    entries
        .iter()
        .fold(Dictionary::default(), |all, &(keyword, value)| all.with(keyword, Entry::Value(value.to_owned())))
}
