//! Panels that go through one another, touch where they share no vertex, or are folded onto a neighbour.
//!
//! Each panel is one or two triangles. Two triangles meet when an edge of one has a point in common with the other; the signs of the
//! determinants that decide it are exact, so that no tolerance is needed and what touches is reported as well. Of two triangles with one
//! common corner, the opposite edges must not meet the other. Two with a common edge meet elsewhere only when they are folded onto one
//! another; there the angle between them is compared with [`FOLD_RAD`]. Vertices at one point count as one here, so that a seam that is
//! not welded is no crossing.
//!
//! Boxes in a tree find the pairs: the time grows with the panels times their logarithm.
//!
//! # Source
//!
//! Shewchuk (1997), Adaptive precision floating-point arithmetic and fast robust geometric predicates (crate `robust`).

use indexmap::IndexMap;
use robust::{Coord, Coord3D, orient2d, orient3d};

use crate::check::{Kind, Trouble, is_readable};
use crate::files::soup::{bits, counted};
use crate::mesh::Mesh;
use crate::panel::halves;
use crate::vector::{Vec3, add, cross, dot, norm, scale, sub};

/// Angle between two triangles below which they lie on one another, rad.
pub const FOLD_RAD: f64 = 1e-6;

/// Pairs after which counting ends.
pub const MOST: usize = 100_000;

/// Crossings and folds of a mesh: at most one fault of each kind, with its count and first pair.
///
/// None for a mesh with coordinates or corners that are none. Panels without area cross nothing.
#[must_use]
pub fn crossings(mesh: &Mesh) -> Vec<Trouble> {
    let [crossing, folded] = met(mesh);
    let crossing = crossing.map(|Met { count, first, second, at }| {
        let pairs = counted(count, "pair of panels crosses or touches", "pairs of panels cross or touch");
        let words = format!(
            "{pairs} without a common vertex there, the first {first} and {second} at {at:?} m; unite the bodies, or move them apart"
        );
        Trouble::new(Kind::Crossing, words)
    });
    let folded = folded.map(|Met { count, first, second, at }| {
        let pairs = counted(count, "pair of neighbours is", "pairs of neighbours are");
        let words =
            format!("{pairs} folded onto one another, the first {first} and {second} at {at:?} m; take one out");
        Trouble::new(Kind::Other, words)
    });
    crossing.into_iter().chain(folded).collect()
}

/// Panels that meet: how many pairs, the first of them, and a point of both.
struct Met {
    count: usize,
    first: usize,
    second: usize,
    at: Vec3,
}

/// Panels that cross, and those folded onto a neighbour.
fn met(mesh: &Mesh) -> [Option<Met>; 2] {
    pairs(mesh).map(|pairs| {
        let (first, second, at) = *pairs.first()?;
        Some(Met { count: pairs.len(), first: first as usize, second: second as usize, at })
    })
}

/// Each pair of panels that cross, and each of neighbours folded onto one another, with a point of both: [`MOST`] of a kind or little more.
pub(crate) fn pairs(mesh: &Mesh) -> [Vec<(u32, u32, Vec3)>; 2] {
    if !is_readable(mesh) {
        return [Vec::new(), Vec::new()];
    }
    let triangles = triangles(mesh);
    let mut crossing: Vec<(u32, u32, Vec3)> = Vec::new();
    let mut folded: Vec<(u32, u32, Vec3)> = Vec::new();
    Tree::new(&triangles).each_pair(|a, b| {
        let (a, b) = (&triangles[a], &triangles[b]);
        let pair = |at: Vec3| (a.panel.min(b.panel), a.panel.max(b.panel), at);
        match meeting(a, b) {
            Some(Meeting::Fold(at)) => folded.push(pair(at)),
            Some(Meeting::Point(at)) if a.panel != b.panel => crossing.push(pair(at)),
            _ => {}
        }
        crossing.len().max(folded.len()) < MOST
    });
    // Halves of two panels can meet more than once.
    [crossing, folded].map(|mut pairs| {
        pairs.sort_by_key(|(a, b, _)| (*a, *b));
        pairs.dedup_by_key(|(a, b, _)| (*a, *b));
        pairs
    })
}

struct Triangle {
    panel: u32,
    /// Numbers of the corners, the same for corners at one point.
    ids: [u32; 3],
    points: [Vec3; 3],
}

fn triangles(mesh: &Mesh) -> Vec<Triangle> {
    let mut first_at: IndexMap<[u64; 3], u32> = IndexMap::with_capacity(mesh.vertices.len());
    let ids: Vec<u32> = (0..).zip(&mesh.vertices).map(|(id, v)| *first_at.entry(bits(*v)).or_insert(id)).collect();
    let mut out = Vec::with_capacity(2 * mesh.panels.len());
    for (number, panel) in (0..).zip(&mesh.panels) {
        for half in halves(mesh, *panel) {
            let points = half.map(|v| mesh.vertices[v as usize]);
            let [a, b, c] = points;
            if norm(cross(sub(b, a), sub(c, a))) > 0.0 {
                out.push(Triangle { panel: number, ids: half.map(|v| ids[v as usize]), points });
            }
        }
    }
    out
}

enum Meeting {
    Point(Vec3),
    Fold(Vec3),
}

fn meeting(a: &Triangle, b: &Triangle) -> Option<Meeting> {
    let is_common = |id: &u32| b.ids.contains(id);
    let commons = a.ids.iter().filter(|id| is_common(id)).count();
    match commons {
        0 => {
            if is_aside(&a.points, &b.points) || is_aside(&b.points, &a.points) {
                return None;
            }
            let edges = |[p, q, r]: [Vec3; 3]| [[p, q], [q, r], [r, p]];
            let of_a = edges(a.points).into_iter().find_map(|edge| common_point(edge, &b.points));
            let of_b = || edges(b.points).into_iter().find_map(|edge| common_point(edge, &a.points));
            of_a.or_else(of_b).map(Meeting::Point)
        }
        1 => {
            let opposite = |t: &Triangle, other: &Triangle| {
                let i = t.ids.iter().position(|id| other.ids.contains(id)).unwrap_or(0);
                [t.points[(i + 1) % 3], t.points[(i + 2) % 3]]
            };
            let of_a = common_point(opposite(a, b), &b.points);
            of_a.or_else(|| common_point(opposite(b, a), &a.points)).map(Meeting::Point)
        }
        2 => fold(a, b),
        // Copies are found by the corners of the panels.
        _ => None,
    }
}

/// Whether two triangles over one edge lie on one another.
fn fold(a: &Triangle, b: &Triangle) -> Option<Meeting> {
    let apex = |t: &Triangle, other: &Triangle| t.ids.iter().position(|id| !other.ids.contains(id));
    let (i, j) = (apex(a, b)?, apex(b, a)?);
    let (p, q) = (a.points[(i + 1) % 3], a.points[(i + 2) % 3]);
    let along = sub(q, p);
    let across = |apex: Vec3| {
        let to = sub(apex, p);
        let off = sub(to, scale(along, dot(to, along) / dot(along, along)));
        scale(off, 1.0 / norm(off))
    };
    let apart = norm(sub(across(a.points[i]), across(b.points[j])));
    (apart < FOLD_RAD).then(|| Meeting::Fold(scale(add(p, q), 0.5)))
}

fn side(t: &[Vec3; 3], p: Vec3) -> f64 {
    let [a, b, c, d] = [t[0], t[1], t[2], p].map(|[x, y, z]| Coord3D { x, y, z });
    orient3d(a, b, c, d)
}

/// Whether all corners lie strictly on one side of the plane of the other triangle.
fn is_aside(corners: &[Vec3; 3], plane: &[Vec3; 3]) -> bool {
    let sides = corners.map(|p| side(plane, p));
    sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0)
}

/// A point of both an edge and a triangle, ends and border included.
fn common_point([p, q]: [Vec3; 2], t: &[Vec3; 3]) -> Option<Vec3> {
    let (at_p, at_q) = (side(t, p), side(t, q));
    if at_p == 0.0 && at_q == 0.0 {
        return common_point_in_plane([p, q], t);
    }
    if (at_p > 0.0 && at_q > 0.0) || (at_p < 0.0 && at_q < 0.0) {
        return None;
    }
    let [a, b, c] = *t;
    let turns = [[a, b], [b, c], [c, a]].map(|[from, to]| side(&[p, q, from], to));
    let is_through = !(turns.iter().any(|s| *s > 0.0) && turns.iter().any(|s| *s < 0.0));
    is_through.then(|| add(p, scale(sub(q, p), at_p / (at_p - at_q))))
}

/// The same for an edge in the plane of the triangle, looked at along the axis nearest to its normal.
fn common_point_in_plane([p, q]: [Vec3; 2], t: &[Vec3; 3]) -> Option<Vec3> {
    let normal = cross(sub(t[1], t[0]), sub(t[2], t[0])).map(f64::abs);
    let (i, j) = match normal {
        [x, y, z] if x >= y && x >= z => (1, 2),
        [_, y, z] if y >= z => (2, 0),
        _ => (0, 1),
    };
    let turn = |a: Vec3, b: Vec3, c: Vec3| {
        let [a, b, c] = [a, b, c].map(|v| Coord { x: v[i], y: v[j] });
        orient2d(a, b, c)
    };
    let is_inside = |v: Vec3| {
        let turns = [turn(t[0], t[1], v), turn(t[1], t[2], v), turn(t[2], t[0], v)];
        turns.iter().all(|s| *s >= 0.0) || turns.iter().all(|s| *s <= 0.0)
    };
    if is_inside(p) {
        return Some(p);
    }
    if is_inside(q) {
        return Some(q);
    }
    // Both ends outside: the edge passes two borders, and properly one that it is not parallel to.
    [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]].into_iter().find_map(|[from, to]| {
        let (a, b) = (turn(p, q, from), turn(p, q, to));
        let (c, d) = (turn(from, to, p), turn(from, to, q));
        let is_between = |x: f64, y: f64| (x <= 0.0 && y >= 0.0) || (x >= 0.0 && y <= 0.0);
        let is_met = is_between(a, b) && is_between(c, d) && c != d;
        is_met.then(|| add(p, scale(sub(q, p), c / (c - d))))
    })
}

/// Triangles in boxes in boxes.
struct Tree {
    order: Vec<u32>,
    boxes: Vec<[Vec3; 2]>,
    nodes: Vec<Node>,
}

struct Node {
    bounds: [Vec3; 2],
    from: usize,
    to: usize,
    /// The two nodes below; none in a leaf.
    below: Option<[usize; 2]>,
}

/// Triangles of a leaf.
const LEAF: usize = 6;

fn around(boxes: impl Iterator<Item = [Vec3; 2]>) -> [Vec3; 2] {
    let mut out = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    for [low, high] in boxes {
        for i in 0..3 {
            out[0][i] = out[0][i].min(low[i]);
            out[1][i] = out[1][i].max(high[i]);
        }
    }
    out
}

fn meet(a: &[Vec3; 2], b: &[Vec3; 2]) -> bool {
    (0..3).all(|i| a[0][i] <= b[1][i] && b[0][i] <= a[1][i])
}

impl Tree {
    fn new(triangles: &[Triangle]) -> Self {
        let boxes: Vec<[Vec3; 2]> = triangles.iter().map(|t| around(t.points.iter().map(|p| [*p, *p]))).collect();
        let mut tree = Self { order: (0..triangles.len() as u32).collect(), boxes, nodes: Vec::new() };
        let mut open = vec![tree.node(0, triangles.len())];
        while let Some(number) = open.pop() {
            let Node { bounds: [low, high], from, to, .. } = tree.nodes[number];
            if to - from <= LEAF {
                continue;
            }
            let sides = sub(high, low);
            let axis = (0..3).max_by(|a, b| sides[*a].total_cmp(&sides[*b])).unwrap_or(0);
            let middle = usize::midpoint(from, to);
            let boxes = &tree.boxes;
            let key = |t: &u32| boxes[*t as usize][0][axis] + boxes[*t as usize][1][axis];
            tree.order[from..to].select_nth_unstable_by(middle - from, |a, b| key(a).total_cmp(&key(b)));
            let below = [tree.node(from, middle), tree.node(middle, to)];
            tree.nodes[number].below = Some(below);
            open.extend(below);
        }
        tree
    }

    fn node(&mut self, from: usize, to: usize) -> usize {
        let bounds = around(self.order[from..to].iter().map(|t| self.boxes[*t as usize]));
        self.nodes.push(Node { bounds, from, to, below: None });
        self.nodes.len() - 1
    }

    /// Calls for each two triangles whose boxes meet, until asked to stop.
    fn each_pair(&self, mut f: impl FnMut(usize, usize) -> bool) {
        let mut open = vec![(0, 0)];
        while let Some((a, b)) = open.pop() {
            let (first, second) = (&self.nodes[a], &self.nodes[b]);
            if a != b && !meet(&first.bounds, &second.bounds) {
                continue;
            }
            match (first.below, second.below) {
                (Some([c, d]), _) if a == b => open.extend([(c, c), (d, d), (c, d)]),
                (None, None) => {
                    for i in first.from..first.to {
                        let from = if a == b { i + 1 } else { second.from };
                        for j in from..second.to {
                            let (t, u) = (self.order[i] as usize, self.order[j] as usize);
                            if meet(&self.boxes[t], &self.boxes[u]) && !f(t, u) {
                                return;
                            }
                        }
                    }
                }
                (Some([c, d]), other) if other.is_none() || first.to - first.from >= second.to - second.from => {
                    open.extend([(c, b), (d, b)]);
                }
                (_, Some([c, d])) => open.extend([(a, c), (a, d)]),
                (Some(_), None) => {}
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::check::check;
    use crate::mesh::Panel;
    use crate::robot::{Robot, sections};
    use crate::sections::{Resolution, SectionBody};

    fn ball(x_m: f64, along: usize) -> Mesh {
        let mesh = SectionBody::ellipsoid([1.0; 3], 2).mesh(Resolution { along, around: 8 * along }).unwrap().mesh;
        mesh.mapped(|[x, y, z]| [x + x_m, y, z])
    }

    fn reported(mesh: &Mesh) -> Vec<String> {
        crossings(mesh).iter().map(ToString::to_string).collect()
    }

    #[test]
    fn sound_bodies_cross_nothing() {
        assert_eq!(reported(&ball(0.0, 4)), <[&str; 0]>::default());
        let robot = sections(&Robot::NECKED_MAMBA, 3, 0.03).mesh(Resolution { along: 2, around: 24 }).unwrap().mesh;
        assert_eq!(reported(&robot), <[&str; 0]>::default());
        let flat =
            SectionBody::flat_cylinder(1.0, 0.5, 0.5, [3, 5]).mesh(Resolution { along: 2, around: 16 }).unwrap().mesh;
        assert_eq!(reported(&flat), <[&str; 0]>::default());
    }

    #[test]
    fn bodies_through_one_another_are_reported_with_a_point_of_both() {
        let mesh = ball(0.0, 4).with(&ball(1.5, 4));
        assert_eq!(check(&mesh), []);
        let [Some(Met { count, first, second, at }), None] = met(&mesh) else { panic!("{:?}", reported(&mesh)) };
        assert!(count > 30 && first < mesh.panels.len() / 2 && second >= mesh.panels.len() / 2);
        // Between the two spheres at x = 0.75, and within a panel's sag of both.
        assert!((at[0] - 0.75).abs() < 0.1 && (at[1].hypot(at[2]) - 0.75_f64.acos().sin()).abs() < 0.1, "{at:?}");
        assert_eq!(reported(&ball(0.0, 4).with(&ball(2.5, 4))), <[&str; 0]>::default());
    }

    fn one(vertices: &[Vec3], panels: &[&[u32]]) -> Vec<String> {
        let panel = |p: &&[u32]| {
            if let [a, b, c] = **p { Panel::triangle(a, b, c) } else { Panel::quad(p[0], p[1], p[2], p[3]) }
        };
        reported(&Mesh { vertices: vertices.to_vec(), panels: panels.iter().map(panel).collect() })
    }

    #[test]
    fn each_way_to_meet_is_found_and_each_way_to_miss_is_not() {
        let base = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let with = |more: [Vec3; 3]| one(&[base, more].concat(), &[&[0, 1, 2], &[3, 4, 5]]);
        let cross = |at: &str| {
            let rest = "unite the bodies, or move them apart";
            vec![format!(
                "1 pair of panels crosses or touches without a common vertex there, the first 0 and 1 at {at} m; {rest}"
            )]
        };
        // Through the middle; through the border; a corner on the panel; in its plane, over it, beside it; in a parallel plane.
        assert_eq!(with([[0.25, 0.25, -1.0], [0.25, 0.25, 1.0], [5.0, 5.0, 0.5]]), cross("[0.5, 0.5, 0.0]"));
        assert_eq!(with([[0.5, 0.0, -1.0], [0.5, 0.0, 1.0], [0.5, -3.0, 0.5]]), cross("[0.5, 0.0, 0.0]"));
        assert_eq!(with([[0.25, 0.25, 0.0], [0.25, 0.5, 1.0], [0.5, 0.25, 1.0]]), cross("[0.25, 0.25, 0.0]"));
        assert_eq!(with([[0.25, 0.25, 0.0], [2.0, 2.0, 0.0], [2.0, 3.0, 0.0]]), cross("[0.5, 0.5, 0.0]"));
        assert_eq!(with([[-4.0, -4.0, 0.0], [8.0, -4.0, 0.0], [-4.0, 8.0, 0.0]]), cross("[0.0, 0.0, 0.0]"));
        assert_eq!(with([[0.6, 0.6, 0.0], [2.0, 2.0, 0.0], [2.0, 3.0, 0.0]]), <[&str; 0]>::default());
        assert_eq!(with([[0.0, 0.0, 1e-300], [1.0, 0.0, 1e-300], [0.0, 1.0, 1e-300]]), <[&str; 0]>::default());
        assert_eq!(with([[0.6, 0.6, -1.0], [0.6, 0.6, 1.0], [5.0, 5.0, 0.5]]), <[&str; 0]>::default());
        // One common corner: apart, through, and on one another.
        let at_corner = |b: Vec3, c: Vec3| one(&[base[0], base[1], base[2], b, c], &[&[0, 1, 2], &[0, 3, 4]]);
        assert_eq!(at_corner([0.0, -1.0, 0.0], [0.0, 0.0, 1.0]), <[&str; 0]>::default());
        assert_eq!(at_corner([0.5, 0.5, -0.5], [0.5, 0.5, 0.5]), cross("[0.5, 0.5, 0.0]"));
        assert_eq!(at_corner([0.25, 0.25, 0.0], [0.5, 0.25, 0.0]), cross("[0.25, 0.25, 0.0]"));
        // A common edge: open like a book, and shut; a quadrilateral that crosses itself.
        let at_edge = |c: Vec3| one(&[base[0], base[1], base[2], c], &[&[0, 1, 2], &[1, 0, 3]]);
        assert_eq!(at_edge([0.0, 1.0, 0.1]), <[&str; 0]>::default());
        let fold =
            "1 pair of neighbours is folded onto one another, the first 0 and 1 at [0.5, 0.0, 0.0] m; take one out";
        assert_eq!(at_edge([0.7, 2.0, 0.0]), [fold]);
        let bow = one(&[base[0], base[1], base[2], [1.0, 1.0, 0.0]], &[&[0, 1, 2, 3]]);
        assert!(bow[0].contains("the first 0 and 0"), "{bow:?}");
    }

    #[test]
    fn a_seam_that_is_not_welded_is_no_crossing() {
        let vertices =
            [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, -0.0, 0.0], [0.0, 0.0, 0.0], [0.0, -1.0, 1.0]];
        assert_eq!(one(&vertices, &[&[0, 1, 2], &[4, 3, 5]]), <[&str; 0]>::default());
    }

    proptest! {
        /// The tree finds what every pair on its own finds.
        #[test]
        fn the_tree_misses_no_pair(points in prop::collection::vec(prop::array::uniform3(-4..5_i32), 9..90)) {
            let vertices: Vec<Vec3> = points.iter().map(|p| p.map(f64::from)).collect();
            let panels = (0..vertices.len() as u32 / 3).map(|i| Panel::triangle(3 * i, 3 * i + 1, 3 * i + 2)).collect();
            let triangles = triangles(&Mesh { vertices, panels });
            let mut all = Vec::new();
            for i in 0..triangles.len() {
                all.extend((i + 1..triangles.len()).filter(|j| meeting(&triangles[i], &triangles[*j]).is_some()).map(|j| (i, j)));
            }
            let mut found = Vec::new();
            if !triangles.is_empty() {
                Tree::new(&triangles).each_pair(|a, b| {
                    if meeting(&triangles[a], &triangles[b]).is_some() {
                        found.push((a.min(b), a.max(b)));
                    }
                    true
                });
            }
            found.sort_unstable();
            prop_assert_eq!(found, all);
        }
    }
}
