//! A closed surface as the body of a computation: the lengths that its numbers refer to, and whether half a domain is enough for it.

use froude_mesh::mesh::Mesh;
use froude_mesh::panel::{Facet, facets};
use froude_mesh::vector::{Vec3, add, cross, dot, norm, scale, sub};

use crate::case::Reference;

/// A mirror image may lie off by this part of the least extent: facets of curved sides that are divided otherwise to both sides of the plane.
const OFF: f64 = 0.01;
/// Most vertices whose images are looked for on the surface.
const MOST_LOOKED_FOR: usize = 400;

/// Corners of the box around a surface, m.
#[must_use]
pub fn bounds_m(mesh: &Mesh) -> [Vec3; 2] {
    let of = |f: fn(f64, f64) -> f64, from: f64| {
        mesh.vertices.iter().fold([from; 3], |all: Vec3, v| core::array::from_fn(|k| f(all[k], v[k])))
    };
    [of(f64::min, f64::INFINITY), of(f64::max, f64::NEG_INFINITY)]
}

/// Length along x, largest width across it, and the area of the side view, of a closed mesh; its point is what the caller takes.
#[must_use]
pub fn reference(mesh: &Mesh, point_m: Vec3) -> Reference {
    let [low, high] = bounds_m(mesh);
    Reference {
        length_m: high[0] - low[0],
        width_m: high[1] - low[1],
        area_m2: shadow_m2(mesh, [0.0, 1.0, 0.0]),
        point_m,
    }
}

/// Area of the shadow that a closed mesh throws along a unit vector, m²; that of a body with hollows has them twice.
#[must_use]
pub fn shadow_m2(mesh: &Mesh, along: Vec3) -> f64 {
    facets(mesh).iter().map(|facet: &Facet| (facet.area * dot(facet.normal, along)).max(0.0)).sum()
}

/// Why a body is not its own mirror image in the plane z = 0: the vertex whose image lies farthest from the surface.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "the body is not symmetric about z = 0: the mirror image of its corner at ({:.4}, {:.4}, {:.4}) m lies {:.4} m from the surface, and {:.4} m is allowed",
    .at_m[0], .at_m[1], .at_m[2], .off_m, .allowed_m
)]
pub struct Asymmetry {
    /// The vertex, body axes.
    pub at_m: Vec3,
    /// How far its image is from the surface.
    pub off_m: f64,
    /// How far it may be.
    pub allowed_m: f64,
}

/// Whether a surface is its own mirror image in the plane z = 0, to 1 % of its least extent; `None`: it is.
///
/// The two sides may be divided into panels differently.
#[must_use]
pub fn asymmetry(mesh: &Mesh) -> Option<Asymmetry> {
    let image = |[x, y, z]: Vec3| [x, y, -z];
    let [low, high] = bounds_m(mesh);
    let allowed_m = OFF * (0..3).map(|k| high[k] - low[k]).fold(f64::INFINITY, f64::min);
    // Zero has no sign.
    let bits = |v: Vec3| v.map(|x| (x + 0.0).to_bits());
    let known: std::collections::BTreeSet<[u64; 3]> = mesh.vertices.iter().map(|v| bits(*v)).collect();
    let unmatched: Vec<Vec3> = mesh.vertices.iter().copied().filter(|v| !known.contains(&bits(image(*v)))).collect();
    let step = unmatched.len().div_ceil(MOST_LOOKED_FOR).max(1);
    let worst = unmatched
        .iter()
        .step_by(step)
        .map(|v| Asymmetry { at_m: *v, off_m: distance_m(mesh, image(*v)), allowed_m })
        .max_by(|a, b| a.off_m.total_cmp(&b.off_m))?;
    (worst.off_m > allowed_m).then_some(worst)
}

/// From a point to the nearest of a surface, m.
fn distance_m(mesh: &Mesh, point: Vec3) -> f64 {
    let mut least = f64::INFINITY;
    for panel in &mesh.panels {
        let corners: Vec<Vec3> = mesh.corners(*panel).collect();
        for pair in corners.get(1..).unwrap_or_default().windows(2) {
            least = least.min(norm(sub(point, nearest(point, [corners[0], pair[0], pair[1]]))));
        }
    }
    least
}

/// The point of a triangle that is nearest to another.
///
/// # Source
///
/// Ericson (2005), Real-Time Collision Detection, section 5.1.5: by the region of the corners, edges and the face that it lies before.
fn nearest(p: Vec3, [a, b, c]: [Vec3; 3]) -> Vec3 {
    let on_edge = |from: Vec3, to: Vec3| {
        let way = sub(to, from);
        let part = dot(sub(p, from), way) / dot(way, way).max(f64::MIN_POSITIVE);
        add(from, scale(way, part.clamp(0.0, 1.0)))
    };
    let normal = cross(sub(b, a), sub(c, a));
    let is_before = |from: Vec3, to: Vec3| dot(cross(sub(to, from), sub(p, from)), normal) >= 0.0;
    if dot(normal, normal) > 0.0 && is_before(a, b) && is_before(b, c) && is_before(c, a) {
        return sub(p, scale(normal, dot(sub(p, a), normal) / dot(normal, normal)));
    }
    let edges = [on_edge(a, b), on_edge(b, c), on_edge(c, a)];
    edges.into_iter().min_by(|q, r| norm(sub(p, *q)).total_cmp(&norm(sub(p, *r)))).unwrap_or(a)
}

#[cfg(test)]
mod tests {
    use froude_mesh::mesh::Panel;
    use froude_mesh::sections::{Resolution, SectionBody};

    use super::*;

    #[test]
    fn a_point_is_nearest_to_a_face_an_edge_or_a_corner() {
        let triangle = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        for (p, q) in [
            ([0.5, 0.5, 3.0], [0.5, 0.5, 0.0]),
            ([1.0, -2.0, 1.0], [1.0, 0.0, 0.0]),
            ([-1.0, -1.0, 0.0], [0.0, 0.0, 0.0]),
            ([2.0, 2.0, -1.0], [1.0, 1.0, 0.0]),
        ] {
            assert!(norm(sub(nearest(p, triangle), q)) < 1e-15, "{p:?}");
        }
    }

    #[test]
    fn a_body_that_is_divided_otherwise_is_symmetric_and_one_with_a_keel_is_not() {
        let body = SectionBody::ellipsoid([0.5, 0.05, 0.08], 8).mesh(Resolution { along: 2, around: 24 }).unwrap().mesh;
        assert_eq!(asymmetry(&body), None);
        // Turned by half a division about x, its corners are no images of each other, and within the facets' depth they are.
        let (sin, cos) = 0.1_f64.sin_cos();
        let round =
            SectionBody::ellipsoid([0.5, 0.05, 0.05], 8).mesh(Resolution { along: 2, around: 64 }).unwrap().mesh;
        assert_eq!(asymmetry(&round.mapped(|[x, y, z]| [x, cos * y - sin * z, sin * y + cos * z])), None);
        let keeled = body.mapped(|[x, y, z]| [x, y, if z > 0.0 { 1.2 * z } else { z }]);
        let found = asymmetry(&keeled).unwrap();
        assert!((found.off_m - 0.016).abs() < 1e-3, "{found:?}");
        assert!(
            found.to_string().starts_with("the body is not symmetric about z = 0: the mirror image of its corner at (")
        );
    }

    #[test]
    fn a_cube_throws_the_shadow_of_its_face() {
        let v = |i: usize| [i & 1, (i >> 1) & 1, (i >> 2) & 1].map(|b| b as f64);
        let mesh = Mesh {
            vertices: (0..8).map(v).collect(),
            panels: [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]]
                .map(|[a, b, c, d]| Panel::quad(a, b, c, d))
                .to_vec(),
        };
        assert!((shadow_m2(&mesh, [0.0, 1.0, 0.0]) - 1.0).abs() < 1e-15);
        let diagonal = 0.5_f64.sqrt();
        assert!((shadow_m2(&mesh, [diagonal, diagonal, 0.0]) - 2.0 * diagonal).abs() < 1e-15);
        let found = reference(&mesh, [0.5; 3]);
        assert_eq!((found.length_m, found.width_m, found.point_m), (1.0, 1.0, [0.5; 3]));
    }
}
