//! Area, centroid, normal and second moments of one panel.
//!
//! A quadrilateral is two triangles over its shorter diagonal; when its corners lie in one plane the choice does not matter, and a
//! warped one has the mean normal of the two. Second moments are about the centroid: ∫ (x − c)(x − c)ᵀ dS.

use crate::mesh::{Mesh, Panel};
use crate::vector::{Vec3, add, cross, dot, norm, scale, sub};

/// Geometry of a panel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Facet {
    /// Its corners; a triangle has its last one twice.
    pub corners: [Vec3; 4],
    /// Three or four.
    pub count: usize,
    /// Centroid, m.
    pub centroid: Vec3,
    /// Unit normal into the fluid.
    pub normal: Vec3,
    /// Area, m².
    pub area: f64,
    /// ∫ (x − c)(x − c)ᵀ dS, m⁴: xx, yy, zz, xy, xz, yz.
    pub moments: [f64; 6],
    /// Largest distance of a corner from the centroid, m.
    pub radius: f64,
}

impl Facet {
    /// Of a panel of a mesh.
    #[must_use]
    pub fn of(mesh: &Mesh, panel: Panel) -> Self {
        let mut corners = [[0.0; 3]; 4];
        let mut count = 0;
        for corner in mesh.corners(panel) {
            corners[count] = corner;
            count += 1;
        }
        if count == 3 {
            corners[3] = corners[2];
        }
        Self::new(corners, count)
    }

    fn new(corners: [Vec3; 4], count: usize) -> Self {
        let [a, b, c, d] = corners;
        let halves = if count == 3 {
            [[a, b, c], [c, c, c]]
        } else if norm(sub(c, a)) <= norm(sub(d, b)) {
            [[a, b, c], [a, c, d]]
        } else {
            [[a, b, d], [b, c, d]]
        };
        let twice = halves.map(|[p, q, r]| cross(sub(q, p), sub(r, p)));
        let areas = twice.map(|t| 0.5 * norm(t));
        let total = add(twice[0], twice[1]);
        let area = areas[0] + areas[1];
        let third = |t: [Vec3; 3]| scale(add(add(t[0], t[1]), t[2]), 1.0 / 3.0);
        let centroid = scale(add(scale(third(halves[0]), areas[0]), scale(third(halves[1]), areas[1])), 1.0 / area);
        let mut moments = [0.0; 6];
        for (half, area) in halves.iter().zip(areas) {
            // ∫ x xᵀ over a triangle: A/12 (Σ p pᵀ + s sᵀ), s the sum of the corners, all about the centroid.
            let p = half.map(|p| sub(p, centroid));
            let s = add(add(p[0], p[1]), p[2]);
            for (m, (i, j)) in moments.iter_mut().zip(PAIRS) {
                *m += area / 12.0 * (p.iter().map(|p| p[i] * p[j]).sum::<f64>() + s[i] * s[j]);
            }
        }
        let radius = corners.iter().map(|p| norm(sub(*p, centroid))).fold(0.0, f64::max);
        Self { corners, count, centroid, normal: scale(total, 1.0 / norm(total)), area, moments, radius }
    }

    /// How far the corners lie off the plane through the centroid, as part of the radius.
    #[must_use]
    pub fn warp(&self) -> f64 {
        let off = |p: &Vec3| dot(sub(*p, self.centroid), self.normal).abs();
        self.corners.iter().map(off).fold(0.0, f64::max) / self.radius
    }
}

/// Corners of the triangles that a panel is made of: itself, or two over the shorter diagonal.
pub(crate) fn halves(mesh: &Mesh, panel: Panel) -> impl Iterator<Item = [u32; 3]> + use<> {
    let point = |v: u32| mesh.vertices[v as usize];
    let (first, second) = match *panel.corners() {
        [a, b, c, d] if norm(sub(point(c), point(a))) <= norm(sub(point(d), point(b))) => ([a, b, c], Some([a, c, d])),
        [a, b, c, d] => ([a, b, d], Some([b, c, d])),
        [a, b, c] => ([a, b, c], None),
        _ => ([0; 3], None),
    };
    core::iter::once(first).chain(second)
}

/// Order of the six moments.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];

/// Facets of all panels.
#[must_use]
pub fn facets(mesh: &Mesh) -> Vec<Facet> {
    mesh.panels.iter().map(|p| Facet::of(mesh, *p)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_has_the_moments_of_the_textbook() {
        let vertices = vec![[1.0, 2.0, 3.0], [3.0, 2.0, 3.0], [3.0, 3.0, 3.0], [1.0, 3.0, 3.0]];
        let mesh = Mesh { vertices, panels: vec![Panel::quad(0, 1, 2, 3)] };
        let f = Facet::of(&mesh, mesh.panels[0]);
        assert_eq!((f.area, f.normal), (2.0, [0.0, 0.0, 1.0]));
        assert!(norm(sub(f.centroid, [2.0, 2.5, 3.0])) < 1e-15);
        // b h³/12 and h b³/12.
        let expected = [8.0 / 12.0, 2.0 / 12.0, 0.0, 0.0, 0.0, 0.0];
        assert!(f.moments.iter().zip(expected).all(|(m, e)| (m - e).abs() < 1e-15), "{:?}", f.moments);
        assert!(f.warp() < 1e-15);
    }
}
