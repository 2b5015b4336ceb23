//! Normal velocity of panels in rigid motion: surge, sway, heave, roll, pitch, yaw.

use froude_mesh::panel::Facet;
use froude_mesh::vector::{Vec3, cross, sub};

/// Normal velocities of the six motions of a panel about an origin: n, and r × n; 1 m/s, 1 rad/s.
#[must_use]
pub fn rigid(facet: &Facet, origin: Vec3) -> [f64; 6] {
    let n = facet.normal;
    let m = cross(sub(facet.centroid, origin), n);
    [n[0], n[1], n[2], m[0], m[1], m[2]]
}
