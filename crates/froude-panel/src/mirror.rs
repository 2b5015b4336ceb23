//! Planes that double the surface: of the body itself, a rigid wall, or a free surface that moves too fast for waves.
//!
//! The image of a panel acts on a point as the panel itself acts on the point's image, so nothing but points is mirrored. What changes is
//! the sign that potential and normal velocity have on the image: for a plane of the body that of the mode, for a wall +1 (no flow through
//! it), for φ = 0 −1.
//!
//! A body's plane passes through the origin of the mesh frame's axis; translations along the axis, and rotations about the other two, are
//! odd in it.

use froude_mesh::Mesh;
use froude_mesh::panel::Facet;
use froude_mesh::vector::Vec3;

/// What a mirror plane is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// The body's own symmetry: the mesh is its part on the positive side.
    Body,
    /// A rigid wall, or a free surface at low frequency.
    Wall,
    /// A free surface at high frequency: φ = 0.
    FreeSurface,
}

/// A plane square to a coordinate axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mirror {
    /// 0, 1, 2: x, y, z.
    pub axis: usize,
    /// Where, m; 0 for a plane of the body.
    pub at_m: f64,
    /// What it is.
    pub kind: Kind,
}

impl Mirror {
    /// A plane of the body.
    #[must_use]
    pub const fn body(axis: usize) -> Self {
        Self { axis, at_m: 0.0, kind: Kind::Body }
    }

    /// Sign of a mode's potential on the image; modes count surge, sway, heave, roll, pitch, yaw.
    #[must_use]
    pub fn sign(&self, mode: usize) -> f64 {
        let is_odd = match self.kind {
            Kind::Wall => false,
            Kind::FreeSurface => true,
            Kind::Body if mode < 3 => mode == self.axis,
            Kind::Body => mode - 3 != self.axis,
        };
        if is_odd { -1.0 } else { 1.0 }
    }
}

/// Image of a point in one plane.
#[must_use]
pub fn image(mirror: &Mirror, mut point: Vec3) -> Vec3 {
    point[mirror.axis] = 2.0 * mirror.at_m - point[mirror.axis];
    point
}

/// Images of a point in all combinations of mirrors: the point itself, then for each bit of the index the mirror of that number.
#[must_use]
pub fn images(mirrors: &[Mirror], point: Vec3) -> Vec<Vec3> {
    (0..1_usize << mirrors.len())
        .map(|set| mirrors.iter().enumerate().filter(|(i, _)| set >> i & 1 == 1).fold(point, |p, (_, m)| image(m, p)))
        .collect()
}

/// Sign of a mode on each of these images.
#[must_use]
pub fn signs(mirrors: &[Mirror], mode: usize) -> Vec<f64> {
    (0..1_usize << mirrors.len())
        .map(|set| mirrors.iter().enumerate().filter(|(i, _)| set >> i & 1 == 1).map(|(_, m)| m.sign(mode)).product())
        .collect()
}

/// A panel that lies across a plane of the body: the mesh is not symmetric panel by panel.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "panel {panel} lies across the plane where {} is 0 (from {low_m:.4} to {high_m:.4} m): the mesh has no panel line there; leave this \
     plane out, or mesh with an even number of cells",
    ["x", "y", "z"][*axis]
)]
pub struct Across {
    /// The panel, from 0.
    pub panel: usize,
    /// The plane's axis.
    pub axis: usize,
    /// Its reach along that axis, m.
    pub low_m: f64,
    /// The other end, m.
    pub high_m: f64,
}

/// How far over a plane a vertex may lie by rounding, as part of its panel's radius.
const ROUNDING: f64 = 1e-9;

/// The part of a symmetric mesh whose panels lie on the positive side of the body's planes.
///
/// # Errors
///
/// [`Across`] names the first panel that lies on both sides.
pub fn positive_part(mesh: &Mesh, mirrors: &[Mirror]) -> Result<Mesh, Across> {
    let mut panels = Vec::new();
    for (number, panel) in mesh.panels.iter().enumerate() {
        let facet = Facet::of(mesh, *panel);
        let mut is_in = true;
        for m in mirrors.iter().filter(|m| m.kind == Kind::Body) {
            let reach = facet.corners.iter().map(|c| c[m.axis]);
            let (low_m, high_m) = reach.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
            let slack_m = ROUNDING * facet.radius;
            if low_m < -slack_m && high_m > slack_m {
                return Err(Across { panel: number, axis: m.axis, low_m, high_m });
            }
            is_in &= facet.centroid[m.axis] > 0.0;
        }
        if is_in {
            panels.push(*panel);
        }
    }
    Ok(Mesh { vertices: mesh.vertices.clone(), panels })
}
