//! Loads of the mesh as loads of the water on the whole body, in its axes about its reference point.
//!
//! In this order: the density of the water over that of the file; the half that the plane of symmetry leaves out; the point that moments are about,
//! M_o = M_c + (c − o) × F; the axes of the body, and their turn by θ where the body was turned in the mesh,
//! f_x = f_X cos θ + f_Y sin θ, f_y = −f_X sin θ + f_Y cos θ with X forward and Y to starboard at no drift.

use crate::outcome::Loads;

/// How loads of a case become those of the body.
#[derive(Debug, Clone, Copy)]
pub(super) struct Conversion {
    /// Density of the water over that of the file.
    pub(super) density_ratio: f64,
    /// Axis of the mesh that is normal to the plane of symmetry through its origin, where half of the body is modelled.
    pub(super) plane: Option<usize>,
    /// Point that the moments in the files are about, axes of the mesh, m.
    pub(super) centre_m: [f64; 3],
    /// Point that they are wanted about, m.
    pub(super) origin_m: [f64; 3],
    /// Forward, starboard and down, in the axes of the mesh.
    pub(super) body: [[f64; 3]; 3],
    /// Angle that the body is turned by in the mesh, rad.
    pub(super) turn_rad: f64,
}

fn cross([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [f64; 3] {
    [b * z - c * y, c * x - a * z, a * y - b * x]
}

fn about(moment: [f64; 3], force: [f64; 3], from: [f64; 3], to: [f64; 3]) -> [f64; 3] {
    let arm: [f64; 3] = std::array::from_fn(|k| from[k] - to[k]);
    let more = cross(arm, force);
    std::array::from_fn(|k| moment[k] + more[k])
}

impl Conversion {
    /// Loads of the water on the whole body, N and N m.
    pub(super) fn loads(&self, mesh: &Loads) -> Loads {
        let [x, y, z, k, m, n] = mesh.map(|load| self.density_ratio * load);
        let (mut force, mut moment, mut centre) = ([x, y, z], [k, m, n], self.centre_m);
        if let Some(normal) = self.plane {
            // About a point of the plane the other half has the mirrored moment.
            let mut on_plane = centre;
            on_plane[normal] = 0.0;
            moment = about(moment, force, centre, on_plane);
            centre = on_plane;
            force = std::array::from_fn(|k| if k == normal { 0.0 } else { 2.0 * force[k] });
            moment = std::array::from_fn(|k| if k == normal { 2.0 * moment[k] } else { 0.0 });
        }
        moment = about(moment, force, centre, self.origin_m);
        let [x, y, z] = self.turned(force);
        let [k, m, n] = self.turned(moment);
        [x, y, z, k, m, n].map(|load| load + 0.0)
    }

    fn turned(&self, v: [f64; 3]) -> [f64; 3] {
        let [x, y, z] = self.body.map(|axis| axis.iter().zip(v).map(|(a, v)| a * v).sum::<f64>());
        let (sin, cos) = self.turn_rad.sin_cos();
        [x * cos + y * sin, y * cos - x * sin, z]
    }

    /// Which of the body's loads are determined and not zero by symmetry, by those that the files determine.
    pub(super) fn determined(&self, is_known: [bool; 6]) -> [bool; 6] {
        let forces = [is_known[0], is_known[1], is_known[2]];
        let is_moved = self.centre_m != self.origin_m;
        let has_moments = !is_moved || forces == [true; 3];
        let moments = [is_known[3], is_known[4], is_known[5]].map(|known| known && has_moments);
        let of_body = |known: [bool; 3], is_left: &dyn Fn(usize) -> bool| {
            let axis = |axis: [f64; 3]| (0..3).find(|k| axis[*k] != 0.0).is_some_and(|k| known[k] && is_left(k));
            let [x, y, z] = self.body.map(axis);
            let both = x && y;
            if self.turn_rad == 0.0 { [x, y, z] } else { [both, both, z] }
        };
        let [x, y, z] = of_body(forces, &|k| self.plane != Some(k));
        let [k, m, n] = of_body(moments, &|k| self.plane.is_none_or(|normal| normal == k));
        [x, y, z, k, m, n]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The water flows along +x at no drift, z is up.
    const USUAL: Conversion = Conversion {
        density_ratio: 1.0,
        plane: None,
        centre_m: [0.0; 3],
        origin_m: [0.0; 3],
        body: [[-1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]],
        turn_rad: 0.0,
    };

    fn is_near(found: Loads, expected: Loads) {
        assert!(found.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{found:?} instead of {expected:?}");
    }

    #[test]
    fn drag_along_the_flow_is_against_the_body_and_the_density_scales_it() {
        is_near(USUAL.loads(&[3.0, 1.0, 2.0, 4.0, 5.0, 6.0]), [-3.0, 1.0, -2.0, -4.0, 5.0, -6.0]);
        let water = Conversion { density_ratio: 998.0, ..USUAL };
        is_near(water.loads(&[3.0, 0.0, 0.0, 0.0, 0.0, 1.0]), [-2994.0, 0.0, 0.0, 0.0, 0.0, -998.0]);
    }

    #[test]
    fn a_half_has_its_mirror_image_beside_it() {
        let half = Conversion { plane: Some(2), ..USUAL };
        is_near(half.loads(&[3.0, 1.0, 2.0, 4.0, 5.0, 6.0]), [-6.0, 2.0, 0.0, 0.0, 0.0, -12.0]);
        assert_eq!(half.determined([true; 6]), [true, true, false, false, false, true]);
        let across = Conversion { plane: Some(1), ..USUAL };
        is_near(across.loads(&[3.0, 1.0, 2.0, 4.0, 5.0, 6.0]), [-6.0, 0.0, -4.0, 0.0, 10.0, 0.0]);
        // A force of 1 N on the upper half at z = 2 m, about a point 2 m above the plane: the lower one has it at −2 m, so both together have −4 N m there.
        let above = Conversion { centre_m: [0.0, 0.0, 2.0], origin_m: [0.0, 0.0, 2.0], ..half };
        is_near(above.loads(&[1.0, 0.0, 0.0, 0.0, 0.0, 0.0]), [-2.0, 0.0, 0.0, 0.0, -4.0, 0.0]);
    }

    #[test]
    fn a_moment_is_moved_to_the_point_that_is_asked_for() {
        // 1 N to port of the mesh's +y at its origin: about a point 2 m along x it turns by −2 N m about z.
        let moved = Conversion { origin_m: [2.0, 0.0, 0.0], ..USUAL };
        is_near(moved.loads(&[0.0, 1.0, 0.0, 0.0, 0.0, 0.0]), [0.0, 1.0, 0.0, 0.0, 0.0, 2.0]);
        let without_side = [true, false, true, true, true, true];
        assert_eq!(moved.determined(without_side), [true, false, true, false, false, false]);
        assert_eq!(USUAL.determined(without_side), [true, false, true, true, true, true]);
    }

    #[test]
    fn a_body_that_is_turned_in_the_mesh_has_its_axes_turned_with_it() {
        // Drag of 2 N along the flow on a body at 30° of drift.
        let turned = Conversion { turn_rad: 30_f64.to_radians(), ..USUAL };
        is_near(turned.loads(&[2.0, 0.0, 0.0, 0.0, 0.0, 0.0]), [-(3.0_f64.sqrt()), 1.0, 0.0, 0.0, 0.0, 0.0]);
        assert_eq!(turned.determined([true, false, true, true, true, true]), [false, false, true, true, true, true]);
    }
}
