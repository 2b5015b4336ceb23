//! A flat plate in two dimensions, of no thickness and along the stream: the upper half, one cell's span.
//!
//! Cells are finest at both edges, along the plate by cosines, and grow towards the far boundary all around.

use core::f64::consts::PI;

use froude_cfd::block::{Block, End};
use froude_cfd::layers::Layers;
use froude_cfd::mesh_error::{MeshError, check_counts, check_length};
use froude_cfd::poly_mesh::{PatchKind, PolyMesh};
use froude_cfd::quality::Quality;

/// A plate along x in the plane y = 0, its middle at the origin; the water at y > 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plate {
    /// L, m.
    pub length_m: f64,
    /// Length of the one cell along z, m.
    pub span_m: f64,
    /// Cells along the plate.
    pub along: usize,
    /// Cells from each edge to the far boundary.
    pub beyond: usize,
    /// Cells from the plate to the far boundary.
    pub layers: usize,
    /// Thickness of the cells at the plate, m.
    pub first_layer_m: f64,
    /// From the edges, and from the plate, to the far boundary, m.
    pub far_m: f64,
}

impl Plate {
    /// The mesh: patches `body` (one side of the plate), `far`, `symmetry` (y = 0 before and behind the plate) and `front_and_back`.
    ///
    /// # Errors
    ///
    /// [`MeshError`]: numbers that no mesh has, or cells beyond the limits of `checkMesh`.
    pub fn mesh(&self) -> Result<(PolyMesh, Quality), MeshError> {
        check_counts(&[
            ("the number of cells along the plate", self.along, 2),
            ("the number of cells beyond its edges", self.beyond, 2),
            ("the number of layers", self.layers, 2),
        ])?;
        check_length("the plate's length", self.length_m)?;
        check_length("the plate's span", self.span_m)?;
        check_length("the distance of the far boundary", self.far_m)?;
        let stations_m = self.stations_m()?;
        let layers = Layers::of_first(self.layers, self.first_layer_m, self.far_m)?;
        let patches = [
            ("body", PatchKind::Wall),
            ("far", PatchKind::Patch),
            ("symmetry", PatchKind::Symmetry),
            ("front_and_back", PatchKind::Empty),
        ];
        let on_plate = self.beyond..self.beyond + self.along;
        let block = Block {
            cells: [stations_m.len() - 1, self.layers, 1],
            ends: [[End::Patch(1); 2], [End::Within(&on_plate, 0, 2), End::Patch(1)], [End::Patch(3); 2]],
            patches: &patches,
        };
        let mut points = Vec::new();
        for &x_m in &stations_m {
            for j in 0..=self.layers {
                points.extend([-0.5, 0.5].map(|z| [x_m, layers.distance_m(j), z * self.span_m]));
            }
        }
        let mesh = block.mesh(points, |[i, j, k]| (2 * (i * (self.layers + 1) + j) + k) as u32);
        let quality = Quality::of(&mesh);
        quality.judge(|cell| {
            let [i, j, _] = block.place(cell);
            format!("x = {:.4} m, y = {:.1e} m", 0.5 * (stations_m[i] + stations_m[i + 1]), layers.distance_m(j))
        })?;
        Ok((mesh, quality))
    }

    fn stations_m(&self) -> Result<Vec<f64>, MeshError> {
        let half_m = 0.5 * self.length_m;
        let plate = (0..=self.along).map(|i| -half_m * (PI * i as f64 / self.along as f64).cos());
        let edge_m = half_m * (1.0 - (PI / self.along as f64).cos());
        let beyond = Layers::of_first(self.beyond, edge_m, self.far_m).map_err(|_| {
            let expected = format!(
                "so many that they reach {} m from one of {edge_m:.1e} m, each thicker than the one before and less than twice as thick",
                self.far_m
            );
            MeshError::number("the number of cells beyond the plate's edges", self.beyond as f64, expected)
        })?;
        let before = (1..=self.beyond).rev().map(|i| -half_m - beyond.distance_m(i));
        let behind = (1..=self.beyond).map(|i| half_m + beyond.distance_m(i));
        Ok(before.chain(plate).chain(behind).collect())
    }
}
