//! O-grids around bodies of elliptic sections: rays leave the wall along its normals and fan out to a sphere.
//!
//! **Rays.** Near the wall a ray is the normal n of the point p on the wall, d metres off it. Far away it is the hyperbola through p that is confocal with the spheroid of the body's length and tip radius: these fans are orthogonal to spheroids, and spheroids become the outer sphere. In between the ray is their mean, `(1 − w)(p + d n) + w h(d)` with `w = d/(d + δ)`. An outer boundary of the body's own shape has long flat cells along the stream, and solvers diverge there.
//! **Layers.** `dⱼ = ℓ (gʲ − 1)/(gⁿ − 1)` on every ray, ℓ from the widest section to the sphere. The growth g follows from the first layer.
//! **Topology.** stations × layers × around, prisms at the two poles. The half domain is z ≥ 0.

use core::f64::consts::{PI, TAU};

use froude_mesh::sections::SectionBody;
use froude_mesh::vector::{Vec3, add, cross, norm, scale, sub};

use crate::block::{Block, End};
use crate::layers::Layers;
use crate::meridian::{Meridian, Station};
use crate::mesh_error::{MeshError, check_counts};
use crate::poly_mesh::{PatchKind, PolyMesh};
use crate::quality::Quality;

/// δ over the body's half length.
const BEND: f64 = 0.1;

/// How fine an O-grid is, and how far it goes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OGrid {
    /// Cells along the meridian, from tip to tip.
    pub stations: usize,
    /// Cells from the wall to the outer sphere.
    pub layers: usize,
    /// Cells around: over 180° of the half domain, over 360° of the full one.
    pub around: usize,
    /// Thickness of the cells at the wall, m.
    pub first_layer_m: f64,
    /// Radius of the outer sphere about the middle of the body, m.
    pub outer_radius_m: f64,
    /// The half domain z ≥ 0 with a plane of symmetry, or all of it.
    pub is_half: bool,
}

impl OGrid {
    /// The mesh around a body: patches `body`, `far`, and `symmetry` of the half domain.
    ///
    /// # Errors
    ///
    /// [`MeshError`]: numbers that no mesh has, a body that is none, rays that cross, cells beyond the limits of `checkMesh`.
    pub fn mesh(&self, body: &SectionBody) -> Result<(PolyMesh, Quality), MeshError> {
        let meridian = Meridian::new(body)?;
        self.check(&meridian)?;
        let layers = Layers::of_first(self.layers, self.first_layer_m, self.length_m(&meridian))?;
        let patches = [("body", PatchKind::Wall), ("far", PatchKind::Patch), ("symmetry", PatchKind::Symmetry)];
        let block = Block {
            cells: [self.stations, self.layers, self.around],
            ends: [
                [End::Line; 2],
                [End::Patch(0), End::Patch(1)],
                if self.is_half { [End::Patch(2); 2] } else { [End::Around; 2] },
            ],
            patches: &patches,
        };
        let stations = meridian.stations(self.stations);
        let fan = Fan::new(&meridian, self.outer_radius_m);
        let mesh = block.mesh(self.points(&stations, &layers, &fan), |corner| self.point(corner));
        let quality = Quality::of(&mesh);
        quality.judge(|cell| {
            let [i, j, k] = block.place(cell);
            let x_m = 0.5 * (stations[i].section.x_m + stations[i + 1].section.x_m);
            let angle = self.angle_rad(2 * k + 1).to_degrees();
            let distance_m = layers.distance_m(j);
            format!("x = {x_m:.4} m, {angle:.0}° around from +y, {distance_m:.1e} m off the wall")
        })?;
        Ok((mesh, quality))
    }

    /// From the widest section to the outer sphere, m.
    pub(crate) fn length_m(&self, meridian: &Meridian) -> f64 {
        self.outer_radius_m - meridian.largest_radius_m()
    }

    fn check(&self, meridian: &Meridian) -> Result<(), MeshError> {
        check_counts(&[
            ("the number of stations", self.stations, 4),
            ("the number of layers", self.layers, 2),
            ("the number of cells around", self.around, if self.is_half { 3 } else { 6 }),
        ])?;
        let [tail_m, head_m] = meridian.tips_m();
        let least_m = head_m - tail_m;
        if !(least_m..=1e6 * least_m).contains(&self.outer_radius_m) {
            let expected = format!("a body's length, {least_m} m, at least: the water goes around the body");
            return Err(MeshError::number("the radius of the outer sphere", self.outer_radius_m, expected));
        }
        Ok(())
    }

    /// θ, from +y towards +z, after so many halves of a cell around.
    fn angle_rad(&self, halves: usize) -> f64 {
        let all = if self.is_half { PI } else { TAU };
        0.5 * all * halves as f64 / self.around as f64
    }

    fn columns(&self) -> usize {
        if self.is_half { self.around + 1 } else { self.around }
    }

    fn point(&self, [i, j, k]: [usize; 3]) -> u32 {
        let (rings, columns) = (self.layers + 1, self.columns());
        let number = if i == 0 {
            j
        } else if i == self.stations {
            rings + (self.stations - 1) * rings * columns + j
        } else {
            rings + ((i - 1) * rings + j) * columns + k % columns
        };
        number as u32
    }

    fn points(&self, stations: &[Station], layers: &Layers, fan: &Fan) -> Vec<Vec3> {
        let mut points = Vec::new();
        for (i, station) in stations.iter().enumerate() {
            let is_pole = i == 0 || i == self.stations;
            let rays: Vec<Ray> = (0..if is_pole { 1 } else { self.columns() })
                .map(|k| {
                    let (mut sin, cos) = (self.angle_rad(2 * k)).sin_cos();
                    if self.is_half && (k == 0 || k == self.around) {
                        sin = 0.0; // In the plane to the bit.
                    }
                    Ray::new(
                        station,
                        (sin, cos),
                        if is_pole { [(i as f64 - 0.5).signum(), 0.0, 0.0] } else { [0.0; 3] },
                        fan,
                    )
                })
                .collect();
            for j in 0..=self.layers {
                let (d_m, part) = (layers.distance_m(j), layers.part(j));
                points.extend(rays.iter().map(|ray| ray.at(d_m, part, fan)));
            }
        }
        points
    }
}

/// What the far ends of all rays share.
struct Fan {
    middle_m: f64,
    /// Half the distance between the foci, squared.
    focus_m2: f64,
    widest_m: f64,
    bend_m: f64,
    outer_radius_m: f64,
}

impl Fan {
    fn new(meridian: &Meridian, outer_radius_m: f64) -> Self {
        let [tail_m, head_m] = meridian.tips_m();
        let half_m = 0.5 * (head_m - tail_m);
        Self {
            middle_m: 0.5 * (head_m + tail_m),
            focus_m2: (half_m * (half_m - meridian.tip_radius_m())).max(0.0),
            widest_m: meridian.largest_radius_m(),
            bend_m: BEND * half_m,
            outer_radius_m,
        }
    }
}

struct Ray {
    wall_m: Vec3,
    normal: Vec3,
    /// Direction in which it meets the sphere.
    outward: Vec3,
    /// Minor semi-axis of the confocal spheroid through the wall's point.
    spheroid_m: f64,
    radius_m: f64,
    /// From the confocal spheroid to the wall's point: what a section's ellipse differs from its circle.
    offset_m: Vec3,
}

impl Ray {
    fn new(station: &Station, (sin, cos): (f64, f64), pole: Vec3, fan: &Fan) -> Self {
        let section = station.section;
        let (w, h, radius_m) = (section.half_width_m, section.half_height_m, station.radius_m());
        let wall_m = [section.x_m, w * cos, h * sin];
        let normal = if pole == [0.0; 3] {
            let [dx, dw, dh] = station.tangent;
            let outward = cross([dx, dw * cos, dh * sin], [0.0, -w * sin, h * cos]);
            // θ runs from y to z: along × around points inwards.
            scale(outward, -1.0 / norm(outward).max(f64::MIN_POSITIVE))
        } else {
            pole
        };
        let x = section.x_m - fan.middle_m;
        let r2 = radius_m * radius_m;
        let b = x * x + r2 - fan.focus_m2;
        let spheroid_m = (0.5 * (b + (b * b + 4.0 * fan.focus_m2 * r2).sqrt())).max(0.0).sqrt();
        let along = (x / (spheroid_m * spheroid_m + fan.focus_m2).sqrt()).clamp(-1.0, 1.0);
        let across = (1.0 - along * along).sqrt();
        let mut ray = Self {
            wall_m,
            normal,
            outward: [along, across * cos, across * sin],
            spheroid_m,
            radius_m,
            offset_m: [0.0; 3],
        };
        ray.offset_m = sub(wall_m, ray.hyperbola(0.0, 0.0, fan));
        ray
    }

    /// The far ray, `part` of the way out.
    fn hyperbola(&self, d_m: f64, part: f64, fan: &Fan) -> Vec3 {
        let near_m = (self.spheroid_m.powi(2) + d_m * (d_m + 2.0 * fan.widest_m)).sqrt();
        let s_m = (1.0 - part) * near_m + part * fan.outer_radius_m;
        let x_m = (s_m * s_m + fan.focus_m2 * (1.0 - part)).sqrt();
        let [along, y, z] = self.outward;
        [fan.middle_m + x_m * along, s_m * y, s_m * z]
    }

    /// Point `d_m` along, which is `part` of the way out.
    fn at(&self, d_m: f64, part: f64, fan: &Fan) -> Vec3 {
        let weight = d_m / (d_m + fan.bend_m * (1.0 - part)).max(f64::MIN_POSITIVE);
        let fades = (1.0 - part) * self.radius_m / (self.radius_m + d_m).max(f64::MIN_POSITIVE);
        let near = add(self.wall_m, scale(self.normal, d_m));
        let far = add(self.hyperbola(d_m, part, fan), scale(self.offset_m, fades));
        add(scale(near, 1.0 - weight), scale(far, weight))
    }
}
