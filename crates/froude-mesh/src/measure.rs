//! Volume, centre of buoyancy and inertia of the displaced water, by the divergence theorem.
//!
//! Each triangle (a quadrilateral as two) spans a tetrahedron with the origin; for corners p, q, r its volume is p·(q × r)/6, signed.

use crate::mesh::Mesh;
use crate::vector::{Vec3, add, cross, dot, norm, scale, sub};

/// What a closed surface encloses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Measure {
    /// Volume, m³; negative when the surface is inside out.
    pub volume_m3: f64,
    /// Its centroid, m: the centre of buoyancy.
    pub centroid_m: Vec3,
    /// Second moments of the volume about the origin, m⁵: ∫ x xᵀ dV as xx, yy, zz, xy, xz, yz.
    pub second_moments_m5: [f64; 6],
    /// Area of the surface, m².
    pub area_m2: f64,
}

impl Measure {
    /// Of a closed mesh.
    #[must_use]
    pub fn of(mesh: &Mesh) -> Self {
        let (mut volume, mut area) = (0.0, 0.0);
        let mut first = [0.0; 3];
        let mut second = [0.0; 6];
        let pairs = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
        for panel in &mesh.panels {
            let corners: Vec<Vec3> = mesh.corners(*panel).collect();
            for pair in corners[1..].windows(2) {
                let (p, q, r) = (corners[0], pair[0], pair[1]);
                let v = dot(p, cross(q, r)) / 6.0;
                let s = add(add(p, q), r);
                volume += v;
                area += 0.5 * norm(cross(sub(q, p), sub(r, p)));
                first = add(first, scale(s, v / 4.0));
                for (m, (i, j)) in second.iter_mut().zip(pairs) {
                    *m += v / 20.0 * (s[i] * s[j] + p[i] * p[j] + q[i] * q[j] + r[i] * r[j]);
                }
            }
        }
        let centroid_m = scale(first, 1.0 / volume);
        Self { volume_m3: volume, centroid_m, second_moments_m5: second, area_m2: area }
    }

    /// Inertia of the displaced water about the origin over its density, m⁵: 3 × 3, ∫ (|x|² I − x xᵀ) dV.
    #[must_use]
    pub fn inertia_m5(&self) -> [[f64; 3]; 3] {
        let [xx, yy, zz, xy, xz, yz] = self.second_moments_m5;
        [[yy + zz, -xy, -xz], [-xy, xx + zz, -yz], [-xz, -yz, xx + yy]]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mesh::Panel;

    #[test]
    fn a_box_off_the_origin_has_volume_centroid_and_inertia_of_the_textbook() {
        // 1 × 2 × 3 m with its centre at (4, 0, 0).
        let corner = |i: usize| [[3.5, 4.5][i & 1], [-1.0, 1.0][(i >> 1) & 1], [-1.5, 1.5][(i >> 2) & 1]];
        let quads = [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let panels = quads.map(|[a, b, c, d]| Panel::quad(a, b, c, d)).to_vec();
        let m = Measure::of(&Mesh { vertices: (0..8).map(corner).collect(), panels });
        assert!((m.volume_m3 - 6.0).abs() < 1e-13 && (m.area_m2 - 22.0).abs() < 1e-13);
        assert!(m.centroid_m.iter().zip([4.0, 0.0, 0.0]).all(|(a, b)| (a - b).abs() < 1e-13));
        let i = m.inertia_m5();
        // V/12 (b² + c²), and V d² by Steiner.
        let expected = [6.0 / 12.0 * 13.0, 6.0 / 12.0 * 10.0 + 96.0, 6.0 / 12.0 * 5.0 + 96.0];
        for (axis, e) in expected.iter().enumerate() {
            assert!((i[axis][axis] - e).abs() < 1e-12, "{i:?}");
        }
    }
}
