//! Where moments and rotations are about.

use froude_mesh::panel::Facet;
use froude_mesh::vector::{Vec3, cross, dot, sub};

/// Axes and point of a rigid part.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// The point that its rotations are about, m.
    pub origin_m: Vec3,
    /// Its axes x, y, z in the mesh frame.
    pub axes: [Vec3; 3],
}

impl Frame {
    /// The axes of the mesh, about a point.
    #[must_use]
    pub const fn at(origin_m: Vec3) -> Self {
        Self { origin_m, axes: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] }
    }

    /// Normal velocities of a panel in the six motions: surge, sway, heave (1 m/s), roll, pitch, yaw (1 rad/s).
    ///
    /// Source: Newman 1977, 4.13.
    #[must_use]
    pub fn normal_velocities(&self, facet: &Facet) -> [f64; 6] {
        let n = facet.normal;
        let m = cross(sub(facet.centroid, self.origin_m), n);
        core::array::from_fn(|mode| dot(self.axes[mode % 3], if mode < 3 { n } else { m }))
    }

    /// Motions along and about these axes (rows) of a rigid body whose motions are expressed in another frame (columns).
    ///
    /// With d from the other point to this one, the velocity here is v + ω × d.
    #[must_use]
    pub fn motions_from(&self, other: &Self) -> [[f64; 6]; 6] {
        let d = sub(self.origin_m, other.origin_m);
        core::array::from_fn(|row| {
            let own = self.axes[row % 3];
            core::array::from_fn(|column| {
                let axis = other.axes[column % 3];
                match (row < 3, column < 3) {
                    (true, true) | (false, false) => dot(own, axis),
                    (true, false) => dot(own, cross(axis, d)),
                    (false, true) => 0.0,
                }
            })
        })
    }
}
