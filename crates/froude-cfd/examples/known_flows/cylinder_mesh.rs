//! A circular cylinder in two dimensions: an O-grid of one cell's span, to hold solvers against what is known of it.

use core::f64::consts::TAU;

use froude_cfd::block::{Block, End};
use froude_cfd::layers::Layers;
use froude_cfd::mesh_error::{MeshError, check_counts, check_length};
use froude_cfd::poly_mesh::{PatchKind, PolyMesh};
use froude_cfd::quality::Quality;

/// A circular cylinder along z, its axis at the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Cylinder {
    /// D, m.
    pub diameter_m: f64,
    /// Length of the one cell along z, m.
    pub span_m: f64,
    /// Cells around, over 360°.
    pub around: usize,
    /// Cells from the wall to the outer circle.
    pub layers: usize,
    /// Thickness of the cells at the wall, m.
    pub first_layer_m: f64,
    /// Radius of the outer circle, m.
    pub outer_radius_m: f64,
}

impl Cylinder {
    /// The mesh: patches `body`, `far` and `front_and_back`.
    ///
    /// # Errors
    ///
    /// [`MeshError`]: numbers that no mesh has, or cells beyond the limits of `checkMesh`.
    pub fn mesh(&self) -> Result<(PolyMesh, Quality), MeshError> {
        check_counts(&[("the number of layers", self.layers, 2), ("the number of cells around", self.around, 6)])?;
        check_length("the cylinder's diameter", self.diameter_m)?;
        check_length("the cylinder's span", self.span_m)?;
        check_length("the radius of the outer circle", self.outer_radius_m)?;
        let radius_m = 0.5 * self.diameter_m;
        let layers = Layers::of_first(self.layers, self.first_layer_m, self.outer_radius_m - radius_m)?;
        let patches = [("body", PatchKind::Wall), ("far", PatchKind::Patch), ("front_and_back", PatchKind::Empty)];
        let block = Block {
            cells: [self.layers, self.around, 1],
            ends: [[End::Patch(0), End::Patch(1)], [End::Around; 2], [End::Patch(2); 2]],
            patches: &patches,
        };
        let mut points = Vec::new();
        for i in 0..=self.layers {
            let r_m = radius_m + layers.distance_m(i);
            for j in 0..self.around {
                let (sin, cos) = self.angle_rad(2 * j).sin_cos();
                points.extend([-0.5, 0.5].map(|z| [r_m * cos, r_m * sin, z * self.span_m]));
            }
        }
        let mesh = block.mesh(points, |[i, j, k]| (2 * (i * self.around + j % self.around) + k) as u32);
        let quality = Quality::of(&mesh);
        quality.judge(|cell| {
            format!("{:.0}° around from +x", self.angle_rad(2 * block.place(cell)[1] + 1).to_degrees())
        })?;
        Ok((mesh, quality))
    }

    /// From +x towards +y, after so many halves of a cell around.
    fn angle_rad(&self, halves: usize) -> f64 {
        0.5 * TAU * halves as f64 / self.around as f64
    }
}
