//! Finer meshes of the same body: divided panels, quadrilaterals without warp, and facets rounded to the smooth body behind them.
//!
//! A family of divided meshes shows how the result depends on the panels; the difference between a mesh and the rounded one shows how
//! it depends on the facets. Both have four panels for one, and the same vertices at the corners. Every corner of a panel must exist
//! ([`mod@crate::check`]).
//!
//! **Rounding.** Each edge becomes a circular arc through its ends, and its middle a vertex. Inside a smooth region the arc is
//! perpendicular to the normals of the vertices; they are weighted such that they are exact on a sphere. Along a crease, an edge whose
//! panels meet at more than an angle, the arc has the directions of the circles through three vertices of the crease; a border is a
//! crease. Where a crease ends or turns by more than that angle, or three meet, its edges stay straight there. The middle of a
//! quadrilateral is that of a Coons patch over its four arcs.
//!
//! # Sources
//!
//! Vlachos, Peters, Boyd, Mitchell (2001), Curved PN triangles, for the idea; arcs for their cubics are ours. Max (1999), Weights for
//! computing vertex normals from facet normals. Coons (1967).

use indexmap::IndexMap;

use crate::mesh::{Mesh, Panel};
use crate::panel::{Facet, halves};
use crate::topology::{Groups, by_edge, sides};
use crate::vector::{Vec3, add, cross, dot, norm, scale, sub};

/// Each panel divided into four of its shape, at the middles of its edges, which neighbours share.
///
/// The new panels of a flat one lie in its plane; those of a triangle are similar to it, and so are those of a parallelogram. A warped
/// quadrilateral changes its shape: [`without_warp`] divides it into triangles first.
#[must_use]
pub fn subdivided(mesh: &Mesh) -> Mesh {
    divided(mesh, |_, ends| scale(add(ends[0], ends[1]), 0.5))
}

/// Quadrilaterals whose corners lie off their plane by more than `limit` times their radius ([`Facet::warp`]) become two triangles, over
/// the shorter diagonal.
#[must_use]
pub fn without_warp(mesh: &Mesh, limit: f64) -> Mesh {
    let mut out = Mesh { vertices: mesh.vertices.clone(), panels: Vec::with_capacity(mesh.panels.len()) };
    for panel in &mesh.panels {
        if panel.corners().len() == 4 && Facet::of(mesh, *panel).warp() > limit {
            out.panels.extend(halves(mesh, *panel).map(|[a, b, c]| Panel::triangle(a, b, c)));
        } else {
            out.panels.push(*panel);
        }
    }
    out
}

/// Each panel divided into four, the new vertices on the smooth surface through the old ones.
///
/// Edges whose panels' normals differ by more than `crease_rad` are creases. On a sphere the new vertices in edges lie on it to rounding,
/// so that the volume's error falls to a quarter; that of a closed body of flat sides does not change at all.
#[must_use]
pub fn rounded(mesh: &Mesh, crease_rad: f64) -> Mesh {
    let tangents = Tangents::of(mesh, crease_rad);
    divided(mesh, |edge, [p, q]| {
        let chord = sub(q, p);
        let length = norm(chord);
        let [at_p, at_q] = tangents.of_edge(edge, scale(chord, 1.0 / length));
        arc_middle(p, q, at_p, at_q)
    })
}

/// Middle of the arc that leaves p and reaches q in two directions; straight where they turn back.
///
/// The mean of the two arcs that one direction each would give: a chord c whose end turns by α has the sagitta (c/2) tan(α/2).
fn arc_middle(p: Vec3, q: Vec3, at_p: Vec3, at_q: Vec3) -> Vec3 {
    let chord = sub(q, p);
    let length = norm(chord);
    let cosine = 0.5 * (dot(at_p, chord) + dot(at_q, chord)) / length;
    let middle = scale(add(p, q), 0.5);
    // Also where an edge has no length, and its directions are not numbers.
    if cosine > 0.0 { add(middle, scale(sub(at_p, at_q), 0.25 * length / (1.0 + cosine))) } else { middle }
}

/// Every panel into four, with a rule for the middle of an edge given by its vertices (the smaller number first) and their points.
fn divided(mesh: &Mesh, middle: impl Fn((u32, u32), [Vec3; 2]) -> Vec3) -> Mesh {
    let mut out = Mesh { vertices: mesh.vertices.clone(), panels: Vec::with_capacity(4 * mesh.panels.len()) };
    let mut middles: IndexMap<(u32, u32), u32> = IndexMap::with_capacity(2 * mesh.panels.len());
    let point = |v: u32| mesh.vertices[v as usize];
    for panel in &mesh.panels {
        let corners = panel.corners();
        let mut of_edge = [0; 4];
        for (i, &from) in corners.iter().enumerate() {
            let to = corners[(i + 1) % corners.len()];
            let edge = (from.min(to), from.max(to));
            of_edge[i] = *middles.entry(edge).or_insert_with(|| {
                out.vertices.push(middle(edge, [point(edge.0), point(edge.1)]));
                out.vertices.len() as u32 - 1
            });
        }
        let [ab, bc, cd, da] = of_edge;
        match *corners {
            [a, b, c] => out.panels.extend([[a, ab, cd], [b, bc, ab], [c, cd, bc], [ab, bc, cd]].map(triangle)),
            [a, b, c, d] => {
                // Coons: both means of opposite middles, less the mean of the corners.
                let sum = |v: [Vec3; 4]| add(add(v[0], v[1]), add(v[2], v[3]));
                let arcs = sum([ab, bc, cd, da].map(|v| out.vertices[v as usize]));
                let centre = sub(scale(arcs, 0.5), scale(sum([a, b, c, d].map(point)), 0.25));
                let o = out.vertices.len() as u32;
                out.vertices.push(centre);
                let quads = [[a, ab, o, da], [ab, b, bc, o], [o, bc, c, cd], [da, o, cd, d]];
                out.panels.extend(quads.map(|[a, b, c, d]| Panel::quad(a, b, c, d)));
            }
            _ => {}
        }
    }
    out
}

const fn triangle([a, b, c]: [u32; 3]) -> Panel {
    Panel::triangle(a, b, c)
}

/// Directions of the surface at the ends of edges.
struct Tangents {
    /// Of a smooth edge: unit normals at its ends.
    normals: IndexMap<(u32, u32), [Vec3; 2]>,
    /// Of a vertex between two edges of a crease: the direction of the circle through the three vertices.
    creases: IndexMap<u32, Vec3>,
}

impl Tangents {
    fn of(mesh: &Mesh, crease_rad: f64) -> Self {
        let normals: Vec<Vec3> = mesh.panels.iter().map(|p| Facet::of(mesh, *p).normal).collect();
        let sides = sides(mesh);
        let is_smooth = |edge: &[crate::topology::Side]| {
            let [a, b] = edge else { return false };
            let (m, n) = (normals[a.panel as usize], normals[b.panel as usize]);
            a.is_forward != b.is_forward && norm(cross(m, n)).atan2(dot(m, n)) <= crease_rad
        };
        // Corners of panels at one vertex, together as far as smooth edges reach; number of a corner: 4 × panel + place.
        let corner = |side: &crate::topology::Side, vertex: u32| {
            let corners = mesh.panels[side.panel as usize].corners();
            let begin = usize::from(side.corner);
            let place = if corners[begin] == vertex { begin } else { (begin + 1) % corners.len() };
            4 * side.panel + place as u32
        };
        let mut groups = Groups::new(4 * mesh.panels.len());
        let mut beside: IndexMap<u32, Vec<u32>> = IndexMap::new();
        for edge in by_edge(&sides) {
            let (from, to) = edge[0].edge;
            if is_smooth(edge) {
                groups.join(corner(&edge[0], from), corner(&edge[1], from));
                groups.join(corner(&edge[0], to), corner(&edge[1], to));
            } else {
                beside.entry(from).or_default().push(to);
                beside.entry(to).or_default().push(from);
            }
        }
        let mut sums = vec![[0.0; 3]; 4 * mesh.panels.len()];
        for (number, panel) in (0..).zip(&mesh.panels) {
            let corners: Vec<Vec3> = mesh.corners(*panel).collect();
            let n = corners.len();
            for i in 0..n {
                let (next, last) = (sub(corners[(i + 1) % n], corners[i]), sub(corners[(i + n - 1) % n], corners[i]));
                let weight = 1.0 / (dot(next, next) * dot(last, last));
                if weight.is_finite() {
                    let sum = &mut sums[groups.of(4 * number + i as u32) as usize];
                    *sum = add(*sum, scale(cross(next, last), weight));
                }
            }
        }
        let mut smooth = IndexMap::new();
        for edge in by_edge(&sides).filter(|edge| is_smooth(edge)) {
            let (from, to) = edge[0].edge;
            let normal = |groups: &mut Groups, vertex| {
                let sum = sums[groups.of(corner(&edge[0], vertex)) as usize];
                scale(sum, 1.0 / norm(sum))
            };
            smooth.insert((from, to), [normal(&mut groups, from), normal(&mut groups, to)]);
        }
        let point = |v: u32| mesh.vertices[v as usize];
        let crease = |(vertex, ends): (u32, Vec<u32>)| {
            let [before, after] = ends[..] else { return None };
            let (one, two) = (sub(point(vertex), point(before)), sub(point(after), point(vertex)));
            let is_bend = norm(cross(one, two)).atan2(dot(one, two)) <= crease_rad;
            let sum = add(scale(one, 1.0 / dot(one, one)), scale(two, 1.0 / dot(two, two)));
            is_bend.then(|| (vertex, scale(sum, 1.0 / norm(sum))))
        };
        Self { normals: smooth, creases: beside.into_iter().filter_map(crease).collect() }
    }

    /// Directions at the ends of an edge, given that of its chord.
    fn of_edge(&self, edge: (u32, u32), along: Vec3) -> [Vec3; 2] {
        if let Some(normals) = self.normals.get(&edge) {
            return normals.map(|n| {
                let tangent = sub(along, scale(n, dot(along, n)));
                let length = norm(tangent);
                if length > 0.0 { scale(tangent, 1.0 / length) } else { along }
            });
        }
        [edge.0, edge.1].map(|vertex| match self.creases.get(&vertex) {
            Some(tangent) if dot(*tangent, along) < 0.0 => scale(*tangent, -1.0),
            Some(tangent) => *tangent,
            None => along,
        })
    }
}

#[cfg(test)]
mod tests {
    use core::f64::consts::PI;

    use super::*;
    use crate::check::check;
    use crate::measure::Measure;
    use crate::sections::{Resolution, SectionBody};

    const CREASE_RAD: f64 = 0.7;

    fn body(body: &SectionBody, along: usize) -> Mesh {
        body.mesh(Resolution { along, around: 12 * along }).unwrap().mesh
    }

    fn volume(mesh: &Mesh) -> f64 {
        Measure::of(mesh).volume_m3
    }

    fn icosahedron() -> Mesh {
        let g = 0.5 * (1.0 + 5.0_f64.sqrt());
        let vertices = [
            [-1.0, g, 0.0],
            [1.0, g, 0.0],
            [-1.0, -g, 0.0],
            [1.0, -g, 0.0],
            [0.0, -1.0, g],
            [0.0, 1.0, g],
            [0.0, -1.0, -g],
            [0.0, 1.0, -g],
            [g, 0.0, -1.0],
            [g, 0.0, 1.0],
            [-g, 0.0, -1.0],
            [-g, 0.0, 1.0],
        ];
        let panels = [
            [0, 11, 5],
            [0, 5, 1],
            [0, 1, 7],
            [0, 7, 10],
            [0, 10, 11],
            [1, 5, 9],
            [5, 11, 4],
            [11, 10, 2],
            [10, 7, 6],
            [7, 1, 8],
            [3, 9, 4],
            [3, 4, 2],
            [3, 2, 6],
            [3, 6, 8],
            [3, 8, 9],
            [4, 9, 5],
            [2, 4, 11],
            [6, 2, 10],
            [8, 6, 7],
            [9, 8, 1],
        ];
        Mesh { vertices: vertices.map(|v| scale(v, 1.0 / norm(v))).to_vec(), panels: panels.map(triangle).to_vec() }
    }

    #[test]
    fn a_divided_mesh_is_the_same_body_of_four_times_the_panels() {
        let cylinder = SectionBody::flat_cylinder(1.0, 0.5, 0.3, [2, 3]);
        let mesh = body(&cylinder, 1);
        let fine = subdivided(&mesh);
        assert_eq!(check(&fine), []);
        assert_eq!(fine.panels.len(), 4 * mesh.panels.len());
        let (a, b) = (Measure::of(&mesh), Measure::of(&fine));
        assert!((a.volume_m3 / b.volume_m3 - 1.0).abs() < 1e-13 && (a.area_m2 / b.area_m2 - 1.0).abs() < 1e-13);
        // Triangles have a quarter of the area each, to rounding.
        let area = |mesh: &Mesh, i: usize| Facet::of(mesh, mesh.panels[i]).area;
        let (coarse, fine) = (icosahedron(), subdivided(&icosahedron()));
        for i in 0..fine.panels.len() {
            assert!((4.0 * area(&fine, i) / area(&coarse, i / 4) - 1.0).abs() < 1e-14);
        }
    }

    #[test]
    fn warped_quadrilaterals_become_triangles_and_flat_ones_stay() {
        let flat = body(&SectionBody::ellipsoid([1.0; 3], 2), 1);
        assert_eq!(without_warp(&flat, 1e-9), flat);
        let twisted = flat.mapped(|[x, y, z]| [x, y * x.cos() - z * x.sin(), y * x.sin() + z * x.cos()]);
        let out = without_warp(&twisted, 1e-3);
        assert_eq!(check(&out), []);
        assert_eq!(out.panels.len(), flat.panels.len() + 2 * 12);
        assert_eq!(without_warp(&twisted, 1.0), twisted);
    }

    #[test]
    fn a_box_does_not_move_when_rounded() {
        let cube = body(&SectionBody::flat_cylinder(1.0, 0.5, 0.3, [2, 3]), 1);
        let side =
            SectionBody::flat_cylinder(1.0, 0.5, 0.5, [2, 3]).mesh(Resolution { along: 1, around: 4 }).unwrap().mesh;
        assert!(volume(&rounded(&cube, CREASE_RAD)) > 1.01 * volume(&cube));
        let (plain, round) = (subdivided(&side), rounded(&side, CREASE_RAD));
        assert!(plain.vertices.iter().zip(&round.vertices).all(|(a, b)| norm(sub(*a, *b)) < 1e-15));
    }

    #[test]
    fn every_new_vertex_of_a_triangulated_sphere_lies_on_it() {
        // Its panels meet at 41.8 degrees.
        let mut mesh = icosahedron();
        for _ in 0..3 {
            mesh = rounded(&mesh, 0.75);
            assert!(mesh.vertices.iter().all(|v| (norm(*v) - 1.0).abs() < 1e-14));
        }
        assert_eq!(check(&mesh), []);
        // 1280 panels: the volume misses by what flat panels cost.
        assert!((volume(&mesh) / (4.0 / 3.0 * PI) - 1.0).abs() < 0.01);
    }

    /// The facets' error is that of h² and h⁴ and so on: a plain and a rounded mesh together take out the first.
    #[test]
    fn facets_cost_a_quarter_after_rounding_and_the_rest_falls_with_the_fourth_power() {
        let exact = 4.0 / 3.0 * PI;
        for semi_axes_m in [[1.0; 3], [2.0, 1.0, 0.5]] {
            let errors = |along| {
                let mesh = body(&SectionBody::ellipsoid(semi_axes_m, 3), along);
                let (plain, round) = (volume(&mesh), volume(&rounded(&mesh, CREASE_RAD)));
                [plain, round, (4.0 * round - plain) / 3.0].map(|v| 1.0 - v / exact)
            };
            let (coarse, fine) = (errors(2), errors(4));
            // Each ratio is that of the leading terms, and what is left of it falls fourfold.
            let quarter = |errors: [f64; 3]| (errors[0] / errors[1] - 4.0).abs();
            assert!(quarter(fine) < 0.2 && quarter(fine) < 0.3 * quarter(coarse), "{coarse:?} {fine:?}");
            assert!(fine[2].abs() < 0.05 * fine[1], "{fine:?}");
            assert!((coarse[2] / fine[2] - 16.0).abs() < 2.0, "{coarse:?} {fine:?}");
        }
    }

    #[test]
    fn a_cylinder_is_rounded_along_its_rims() {
        let exact = 2.0 * PI * 0.25;
        let mesh = body(&SectionBody::flat_cylinder(1.0, 0.5, 0.5, [2, 3]), 1);
        let round = rounded(&mesh, CREASE_RAD);
        assert_eq!(check(&round), []);
        let rim = |v: &&Vec3| v[0] == 1.0 && v[1].hypot(v[2]) > 0.45;
        let on_rim: Vec<f64> = round.vertices.iter().filter(rim).map(|v| v[1].hypot(v[2])).collect();
        assert!(on_rim.len() == 24 && on_rim.iter().all(|r| (r - 0.5).abs() < 1e-14), "{on_rim:?}");
        assert!(round.vertices.iter().all(|v| v[0].abs() <= 1.0 + 1e-15));
        let error = |mesh: &Mesh| 1.0 - volume(mesh) / exact;
        assert!((error(&mesh) / error(&round) - 4.0).abs() < 0.1, "{} {}", error(&mesh), error(&round));
    }
}
