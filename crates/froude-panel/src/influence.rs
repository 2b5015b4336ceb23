//! Potential and solid angle of a flat panel with constant strength.
//!
//! Over a polygon with unit density: ∫ 1/r dS, and ∫ ∂(1/r)/∂n_y dS, which is the solid angle Ω that it fills, seen from the point, with the
//! sign of the side: positive where the normal points to.
//!
//! | quantity | formula | source |
//! | --- | --- | --- |
//! | ∫ 1/r dS | Σ h_e ln((r₁ + r₂ + d)/(r₁ + r₂ − d)) − z Ω, z the height over the plane, h_e the distance of its foot from the edge | Hess & Smith 1967, in the symmetric form of Newman 1986 |
//! | Ω | arg of Π over its triangles of the complex denominator + i numerator, doubled | Van Oosterom & Strackee 1983 |
//! | both, far away | to the second moments of the panel about its centroid | Taylor series |
//!
//! The error of the far form falls with the third power of size over distance (the fourth for parallelograms); at [`FAR`] radii it is below
//! 2e-5 of the value.

use froude_mesh::panel::Facet;
use froude_mesh::vector::{Vec3, cross, dot, norm, sub};

/// Distance, in radii of the panel, from which the second-moment form is taken.
pub const FAR: f64 = 16.0;

/// ∫ 1/r dS and ∫ ∂(1/r)/∂n_y dS over a panel at a point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Influence {
    /// ∫ 1/r dS, m.
    pub source: f64,
    /// ∫ ∂(1/r)/∂n_y dS \[-\].
    pub dipole: f64,
}

/// Of a panel at a point, by whichever form is exact enough.
#[must_use]
pub fn influence(facet: &Facet, point: Vec3) -> Influence {
    let d = sub(point, facet.centroid);
    if dot(d, d) > (FAR * facet.radius).powi(2) { far(facet, d) } else { near(facet, point) }
}

/// The closed form for a flat polygon. On the panel itself the solid angle is taken as zero: half of what the two sides have.
#[must_use]
pub fn near(facet: &Facet, point: Vec3) -> Influence {
    let count = facet.count;
    let mut to = [[0.0; 3]; 4];
    let mut distance = [0.0; 4];
    for i in 0..count {
        to[i] = sub(facet.corners[i], point);
        distance[i] = norm(to[i]);
    }
    let height = -dot(sub(facet.centroid, point), facet.normal);
    let mut sum = 0.0;
    for i in 0..count {
        let j = if i + 1 == count { 0 } else { i + 1 };
        let edge = sub(to[j], to[i]);
        let length = norm(edge);
        if length == 0.0 {
            continue;
        }
        // Distance of the foot from the edge, positive inside; the edge runs counter-clockwise about the normal.
        let beside = dot(cross(facet.normal, edge), to[i]) / -length;
        let both = distance[i] + distance[j];
        // On the edge itself the logarithm is infinite and h_e zero.
        if both > length {
            sum += beside * ((both + length) / (both - length)).ln();
        }
    }
    let angle = solid_angle(&to, &distance, count, height);
    Influence { source: sum - height * angle, dipole: angle }
}

/// Solid angle with the sign of the height, from the vectors to the corners.
fn solid_angle(to: &[Vec3; 4], distance: &[f64; 4], count: usize, height: f64) -> f64 {
    let [a, b, c, d] = *to;
    let [ra, rb, rc, rd] = *distance;
    let triangle = |p: Vec3, q: Vec3, r: Vec3, rp: f64, rq: f64, rr: f64| {
        let numerator = dot(p, cross(q, r));
        let denominator = rp * rq * rr + dot(p, q) * rr + dot(p, r) * rq + dot(q, r) * rp;
        (denominator, numerator)
    };
    let first = triangle(a, b, c, ra, rb, rc);
    let (re, im) = if count == 3 {
        first
    } else {
        let second = triangle(a, c, d, ra, rc, rd);
        (first.0 * second.0 - first.1 * second.1, first.0 * second.1 + first.1 * second.0)
    };
    let half = im.atan2(re);
    if height == 0.0 { 0.0 } else { 2.0 * half.abs().copysign(height) }
}

/// The second-moment form; `d` from the centroid to the point.
#[must_use]
pub fn far(facet: &Facet, d: Vec3) -> Influence {
    let [xx, yy, zz, xy, xz, yz] = facet.moments;
    let square = dot(d, d);
    let per = 1.0 / square;
    let inverse = per.sqrt();
    let [n, area] = [dot(facet.normal, d), facet.area];
    // M d, dᵀ M d, tr M. The panel is flat: M n = 0.
    let md = [xx * d[0] + xy * d[1] + xz * d[2], xy * d[0] + yy * d[1] + yz * d[2], xz * d[0] + yz * d[1] + zz * d[2]];
    let (dmd, trace) = (dot(md, d), xx + yy + zz);
    // 1/|d − u| = 1/d + u·d/d³ + ½ (3 (u·d)² − u² d²)/d⁵ + …, averaged over u with ∫ u = 0 and ∫ u uᵀ = M.
    let source = inverse * (area + 0.5 * per * (3.0 * dmd * per - trace));
    // ∂/∂n_y (1/|x − y|) = n·(x − y)/|x − y|³ and u·n = 0: n·d ∫ |d − u|⁻³ dS to second order.
    let cube = inverse * per;
    let dipole = n * cube * (area + 1.5 * per * (5.0 * dmd * per - trace));
    Influence { source, dipole }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;
    use froude_mesh::{Mesh, Panel};

    fn square() -> Facet {
        let vertices = vec![[-1.0, -1.0, 0.0], [1.0, -1.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
        let mesh = Mesh { vertices, panels: vec![Panel::quad(0, 1, 2, 3)] };
        Facet::of(&mesh, mesh.panels[0])
    }

    /// Over its centre a square of side 2 fills 4 atan(1/(h √(2 + h²))), and ∫ 1/r dS in the middle is 8 ln(1 + √2).
    #[test]
    fn a_square_has_the_potential_and_the_solid_angle_of_the_textbook() {
        let f = square();
        assert!((near(&f, [0.0; 3]).source - 8.0 * (1.0 + 2.0_f64.sqrt()).ln()).abs() < 1e-14);
        assert_eq!(near(&f, [0.0; 3]).dipole, 0.0);
        for h in [1e-9_f64, 0.1, 1.0, 7.0] {
            let angle = 4.0 * (1.0 / (h * (2.0 + h * h).sqrt())).atan();
            // ∂(1/r)/∂n_y is positive where the normal points to: r falls when y moves there.
            for (side, sign) in [(h, 1.0), (-h, -1.0)] {
                let got = near(&f, [0.0, 0.0, side]).dipole;
                // Close by, the denominators cancel to their rounding while the numerators are of the order of the height.
                let rounding = 1e-15 * (1.0 + 1.0 / h);
                assert!((got - sign * angle).abs() < rounding * angle, "{side}: {got} {angle}");
            }
        }
        assert!((near(&f, [0.3, -0.2, 1e-12]).dipole - 2.0 * PI).abs() < 1e-3);
        assert_eq!(near(&f, [5.0, 0.5, 0.0]).dipole, 0.0);
    }

    #[test]
    fn near_and_far_meet() {
        let vertices = vec![[0.0, 0.0, 0.0], [1.0, 0.1, 0.0], [1.2, 0.9, 0.0], [0.1, 0.7, 0.0]];
        let mesh = Mesh { vertices, panels: vec![Panel::quad(0, 1, 2, 3)] };
        let f = Facet::of(&mesh, mesh.panels[0]);
        for direction in [[1.0, 0.0, 0.5], [0.3, -0.8, 0.2], [0.0, 0.1, -1.0]] {
            let d = direction.map(|x: f64| x * FAR * f.radius / norm(direction));
            let p = [d[0] + f.centroid[0], d[1] + f.centroid[1], d[2] + f.centroid[2]];
            let (n, a) = (near(&f, p), far(&f, d));
            // The third moments of this panel, over the cube of 16.
            assert!((n.source / a.source - 1.0).abs() < 1e-5, "{n:?} {a:?}");
            assert!((n.dipole / a.dipole - 1.0).abs() < 2e-5, "{n:?} {a:?}");
        }
    }
}
