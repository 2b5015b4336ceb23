//! How good a mesh is, by the measures of OpenFOAM's `checkMesh`, and where it is worst.
//!
//! **Definitions.** Those of OpenFOAM 1912: centres of faces weighted by the area of their triangles, centres of cells by the volume of their pyramids; non-orthogonality is the angle between a face's normal and the line between the centres of its cells; skewness the distance of the face's centre from that line over the face's extent that way; the aspect ratio of a cell the largest over the smallest of its area projected on x, y, z.

use froude_mesh::vector::{Vec3, add, cross, dot, norm, scale, sub};

use crate::mesh_error::MeshError;
use crate::poly_mesh::{PatchKind, PolyMesh};

/// Non-orthogonality that needs no more than the usual correctors, rad.
pub const MAX_NON_ORTHOGONALITY_RAD: f64 = 70.0 / 180.0 * core::f64::consts::PI;
/// Skewness that `checkMesh` takes \[-\].
pub const MAX_SKEWNESS: f64 = 4.0;
/// Aspect ratio that `checkMesh` takes \[-\].
pub const MAX_ASPECT: f64 = 1000.0;

/// A measure where it is worst.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Worst {
    /// The measure.
    pub value: f64,
    /// The cell, or the owner of the face.
    pub cell: usize,
}

/// Measures of a mesh.
#[derive(Debug, Clone, PartialEq)]
pub struct Quality {
    /// Volume of all cells, m³.
    pub volume_m3: f64,
    /// Smallest volume of a cell, m³.
    pub least_volume_m3: Worst,
    /// Smallest pyramid of a face and its cell's centre, m³: below 0, the cell is turned inside out.
    pub least_pyramid_m3: Worst,
    /// Sum of a cell's area vectors over that of their lengths \[-\]: above rounding, the cell is open.
    pub max_openness: Worst,
    /// Largest non-orthogonality, rad.
    pub max_non_orthogonality_rad: Worst,
    /// Angle of the mean cosine, rad.
    pub mean_non_orthogonality_rad: f64,
    /// Largest skewness \[-\].
    pub max_skewness: Worst,
    /// Largest aspect ratio \[-\].
    pub max_aspect: Worst,
    /// Sum of the area vectors of each patch, m².
    pub patch_area_m2: Vec<Vec3>,
}

/// Centres and area vectors.
struct Shapes {
    face_m: Vec<Vec3>,
    area_m2: Vec<Vec3>,
    cell_m: Vec<Vec3>,
    volume_m3: Vec<f64>,
}

impl Quality {
    /// Of a mesh.
    #[must_use]
    pub fn of(mesh: &PolyMesh) -> Self {
        let shapes = Shapes::of(mesh);
        let (non_orthogonality, mean) = non_orthogonality(mesh, &shapes);
        let (openness, aspect) = closedness(mesh, &shapes);
        let patch_area_m2 = mesh.patches.iter().map(|patch| {
            shapes.area_m2.iter().skip(patch.start).take(patch.count).fold([0.0; 3], |sum, &area| add(sum, area))
        });
        Self {
            volume_m3: shapes.volume_m3.iter().sum(),
            least_volume_m3: least(shapes.volume_m3.iter().copied().enumerate()),
            least_pyramid_m3: least(pyramids(mesh, &shapes)),
            max_openness: openness,
            max_non_orthogonality_rad: non_orthogonality,
            mean_non_orthogonality_rad: mean,
            max_skewness: skewness(mesh, &shapes),
            max_aspect: aspect,
            patch_area_m2: patch_area_m2.collect(),
        }
    }
}

impl Quality {
    /// Refuses what a solver would stumble over, at the place that `place` says of a cell.
    ///
    /// # Errors
    ///
    /// [`MeshError`] beyond the limits of `checkMesh`.
    pub fn judge(&self, place: impl Fn(usize) -> String) -> Result<(), MeshError> {
        if self.least_pyramid_m3.value <= 0.0 {
            return Err(MeshError::Crossing { place: place(self.least_pyramid_m3.cell) });
        }
        let degrees =
            Worst { value: self.max_non_orthogonality_rad.value.to_degrees(), ..self.max_non_orthogonality_rad };
        let smoother = "take more stations, or the body's smooth stand-in";
        let thicker = "take more cells along the wall, or a thicker first layer";
        for (measure, worst, limit, advice) in [
            ("the non-orthogonality in degrees", degrees, MAX_NON_ORTHOGONALITY_RAD.to_degrees(), smoother),
            ("the skewness", self.max_skewness, MAX_SKEWNESS, smoother),
            ("the aspect ratio", self.max_aspect, MAX_ASPECT, thicker),
        ] {
            if worst.value > limit {
                let (found, place) = (worst.value, place(worst.cell));
                return Err(MeshError::Refused(format!(
                    "{measure} of the mesh is {found:.1} at {place}, and {limit:.0} is the limit: {advice}"
                )));
            }
        }
        Ok(())
    }
}

/// Part of the walls' area whose cell is at most so high, its volume over its face's area \[-\].
#[must_use]
pub fn layered_area(mesh: &PolyMesh, height_m: f64) -> f64 {
    let shapes = Shapes::of(mesh);
    let walls = mesh.patches.iter().filter(|patch| patch.is_wall());
    let (mut all_m2, mut layered_m2) = (0.0, 0.0);
    for face in walls.flat_map(|patch| patch.start..patch.start + patch.count) {
        let area_m2 = norm(shapes.area_m2[face]);
        all_m2 += area_m2;
        if shapes.volume_m3[mesh.owner[face] as usize] <= height_m * area_m2 {
            layered_m2 += area_m2;
        }
    }
    if all_m2 > 0.0 { layered_m2 / all_m2 } else { 0.0 }
}

fn least(found: impl Iterator<Item = (usize, f64)>) -> Worst {
    let start = Worst { value: f64::INFINITY, cell: 0 };
    // A number that is none is the worst.
    found.fold(start, |worst, (cell, value)| if value >= worst.value { worst } else { Worst { value, cell } })
}

fn largest(found: impl Iterator<Item = (usize, f64)>) -> Worst {
    let worst = least(found.map(|(cell, value)| (cell, -value)));
    Worst { value: -worst.value, ..worst }
}

/// Cells behind and before each face.
fn sides(mesh: &PolyMesh) -> impl Iterator<Item = (usize, usize, f64)> {
    let behind = mesh.owner.iter().enumerate().map(|(face, &cell)| (face, cell as usize, 1.0));
    let before = mesh.neighbour.iter().enumerate().map(|(face, &cell)| (face, cell as usize, -1.0));
    behind.chain(before)
}

impl Shapes {
    fn of(mesh: &PolyMesh) -> Self {
        let (face_m, area_m2): (Vec<_>, Vec<_>) = mesh.faces.iter().map(|corners| face(mesh, corners)).unzip();
        let mut rough_m = vec![[0.0; 3]; mesh.cells];
        let mut count = vec![0.0; mesh.cells];
        for (face, cell, _) in sides(mesh) {
            rough_m[cell] = add(rough_m[cell], face_m[face]);
            count[cell] += 1.0;
        }
        for (centre, n) in rough_m.iter_mut().zip(&count) {
            *centre = scale(*centre, 1.0 / n);
        }
        let mut volume_m3 = vec![0.0; mesh.cells];
        let mut cell_m = vec![[0.0; 3]; mesh.cells];
        for (face, cell, sign) in sides(mesh) {
            let pyramid = sign * dot(area_m2[face], sub(face_m[face], rough_m[cell])) / 3.0;
            let centre = add(scale(face_m[face], 0.75), scale(rough_m[cell], 0.25));
            cell_m[cell] = add(cell_m[cell], scale(centre, pyramid));
            volume_m3[cell] += pyramid;
        }
        for ((centre, volume), rough) in cell_m.iter_mut().zip(&volume_m3).zip(rough_m) {
            *centre = if volume.abs() > f64::MIN_POSITIVE { scale(*centre, 1.0 / volume) } else { rough };
        }
        Self { face_m, area_m2, cell_m, volume_m3 }
    }
}

/// Centre and area vector of a face.
pub(crate) fn face(mesh: &PolyMesh, corners: &[u32]) -> (Vec3, Vec3) {
    let at = |corner: u32| mesh.points_m[corner as usize];
    if let &[a, b, c] = corners {
        let (a, b, c) = (at(a), at(b), at(c));
        return (scale(add(a, add(b, c)), 1.0 / 3.0), scale(cross(sub(b, a), sub(c, a)), 0.5));
    }
    let mean = scale(corners.iter().fold([0.0; 3], |sum, &c| add(sum, at(c))), 1.0 / corners.len() as f64);
    let (mut area, mut size, mut moment) = ([0.0; 3], 0.0, [0.0; 3]);
    for (&p, &q) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let (p, q) = (at(p), at(q));
        let twice = cross(sub(q, p), sub(mean, p));
        area = add(area, scale(twice, 0.5));
        size += norm(twice);
        moment = add(moment, scale(add(p, add(q, mean)), norm(twice)));
    }
    (if size > f64::MIN_POSITIVE { scale(moment, 1.0 / (3.0 * size)) } else { mean }, area)
}

fn pyramids(mesh: &PolyMesh, shapes: &Shapes) -> impl Iterator<Item = (usize, f64)> {
    sides(mesh).map(|(face, cell, sign)| {
        let height = sub(shapes.face_m[face], shapes.cell_m[cell]);
        (cell, sign * dot(shapes.area_m2[face], height) / 3.0)
    })
}

fn non_orthogonality(mesh: &PolyMesh, shapes: &Shapes) -> (Worst, f64) {
    let cosines: Vec<f64> = mesh
        .neighbour
        .iter()
        .enumerate()
        .map(|(face, &next)| {
            let line = sub(shapes.cell_m[next as usize], shapes.cell_m[mesh.owner[face] as usize]);
            let area = shapes.area_m2[face];
            dot(line, area) / (norm(line) * norm(area)).max(f64::MIN_POSITIVE)
        })
        .collect();
    let mean = cosines.iter().sum::<f64>() / cosines.len() as f64;
    let angle = |cosine: f64| cosine.clamp(-1.0, 1.0).acos();
    (largest(cosines.iter().enumerate().map(|(face, &c)| (mesh.owner[face] as usize, angle(c)))), angle(mean))
}

fn skewness(mesh: &PolyMesh, shapes: &Shapes) -> Worst {
    largest(mesh.owner.iter().enumerate().map(|(face, &owner)| {
        let (centre, area) = (shapes.face_m[face], shapes.area_m2[face]);
        let own = shapes.cell_m[owner as usize];
        let to_face = sub(centre, own);
        // Beyond the boundary lies a mirror's cell.
        let (line, floor) = match mesh.neighbour.get(face) {
            Some(&next) => (sub(shapes.cell_m[next as usize], own), 0.2),
            None => (scale(area, dot(area, to_face) / dot(area, area).max(f64::MIN_POSITIVE)), 0.4),
        };
        let off = sub(to_face, scale(line, dot(area, to_face) / dot(area, line)));
        let towards = scale(off, 1.0 / norm(off).max(f64::MIN_POSITIVE));
        let extent = mesh.faces[face].iter().fold(floor * norm(line), |extent, &corner| {
            extent.max(dot(towards, sub(mesh.points_m[corner as usize], centre)).abs())
        });
        (owner as usize, norm(off) / extent.max(f64::MIN_POSITIVE))
    }))
}

/// Largest openness and aspect ratio. A mesh in two dimensions has no extent across its empty patches.
fn closedness(mesh: &PolyMesh, shapes: &Shapes) -> (Worst, Worst) {
    let (mut sum, mut sum_abs) = (vec![[0.0; 3]; mesh.cells], vec![[0.0; 3]; mesh.cells]);
    for (face, cell, sign) in sides(mesh) {
        for c in 0..3 {
            sum[cell][c] += sign * shapes.area_m2[face][c];
            sum_abs[cell][c] += shapes.area_m2[face][c].abs();
        }
    }
    let open = sum
        .iter()
        .zip(&sum_abs)
        .map(|(s, a)| (0..3).map(|c| s[c].abs() / a[c].max(f64::MIN_POSITIVE)).fold(0.0, f64::max));
    let mut across = [0.0; 3];
    for patch in mesh.patches.iter().filter(|p| p.kind == PatchKind::Empty) {
        for area in shapes.area_m2.iter().skip(patch.start).take(patch.count) {
            across = core::array::from_fn(|c| across[c] + area[c].abs());
        }
    }
    let widest = across.iter().copied().fold(0.0, f64::max);
    let solved: Vec<usize> = (0..3).filter(|&c| widest == 0.0 || across[c] < 0.5 * widest).collect();
    let aspect = sum_abs.iter().zip(&shapes.volume_m3).map(|(a, &volume)| {
        let (low, high) =
            solved.iter().fold((f64::INFINITY, 0.0_f64), |(low, high), &c| (low.min(a[c]), high.max(a[c])));
        let slab = if solved.len() == 3 {
            a.iter().sum::<f64>() / 6.0 / volume.max(f64::MIN_POSITIVE).powf(2.0 / 3.0)
        } else {
            0.0
        };
        (high / low.max(f64::MIN_POSITIVE)).max(slab)
    });
    (largest(open.enumerate()), largest(aspect.enumerate()))
}
