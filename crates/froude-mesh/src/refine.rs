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
use crate::topology::{Groups, Side, by_edge, sides};
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
    let bulges = Chords::of(mesh, crease_rad).bulges();
    divided(mesh, |edge, [p, q]| add(scale(add(p, q), 0.5), bulges.get(&edge).copied().unwrap_or_default()))
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

/// Turn of an edge or of a joint that counts as none, rad.
const STRAIGHT_RAD: f64 = 1e-3;
/// Largest ratio of the turns at neighbouring joints of one curve: an arc that continues straight turns by half as much at its end.
const MAX_TURN_RATIO: f64 = 4.0;
/// Largest ratio of a curved chord to its neighbour: of arcs with the same curvature, one of three times the length has nine times the sagitta.
const MAX_LENGTH_RATIO: f64 = 3.0;
/// Largest ratio of the curvatures, turn over mean length, at joints of one circle. Below 2: a joint with a chord three times as long and the same turn
/// has half the curvature.
const MAX_CURVATURE_RATIO: f64 = 1.5;
/// Least cosine of the angle between parallel chords, and between their bends: 26°.
const MIN_PARALLEL_COSINE: f64 = 0.9;
/// Least cosine of the angle within the surface between an edge and the one that continues it: 45°.
const MIN_AHEAD_COSINE: f64 = core::f64::consts::FRAC_1_SQRT_2;
/// Largest bulge as part of the shortest of a chord and its neighbours on the curve, without those of less than a third of its length: half of what a
/// semicircle over it has.
const MAX_BULGE_PER_CHORD: f64 = 0.25;

/// An edge of the mesh as a chord of the smooth surface.
struct Chord {
    /// Its vertices, the smaller number first.
    ends: [u32; 2],
    /// Groups of the corners at each end, of the panel on either side.
    sides: [[u32; 2]; 2],
    /// Group of the corners at each end; `None` on a crease.
    groups: Option<[u32; 2]>,
    /// Angle between its panels, rad.
    turn_rad: f64,
    /// The other edges of its two triangles, where it is the longest of both: a diagonal if they lie in one plane.
    around: Option<[(u32, u32); 4]>,
}

/// Where two chords of a curve meet.
#[derive(Clone, Copy)]
struct Joint {
    /// The chord that continues, and its end that lies there.
    next: (usize, usize),
    /// Length of this chord, m.
    own_m: f64,
    /// Length of the next chord, m.
    length_m: f64,
    /// Towards the outside of the bend; its length is the angle, rad.
    bend: Vec3,
}

impl Joint {
    /// Whether it may belong to the same curve as a neighbour.
    fn is_like(&self, other: &Self) -> bool {
        let [a, b] = [norm(self.bend), norm(other.bend)];
        a.min(b) > STRAIGHT_RAD
            && (a.max(b) <= MAX_TURN_RATIO * a.min(b) || self.has_curvature_of(other))
            && dot(self.bend, other.bend) > 0.0
    }

    fn has_curvature_of(&self, other: &Self) -> bool {
        let [a, b] = [self, other].map(|joint| 2.0 * norm(joint.bend) / (joint.own_m + joint.length_m));
        a.max(b) <= MAX_CURVATURE_RATIO * a.min(b)
    }

    /// Whether it bends like a joint of the row beside it.
    fn is_parallel(&self, other: &Self) -> bool {
        let [a, b] = [norm(self.bend), norm(other.bend)];
        a.min(b) > STRAIGHT_RAD
            && self.has_curvature_of(other)
            && dot(self.bend, other.bend) > MIN_PARALLEL_COSINE * a * b
    }
}

/// Whether a chord is at most three times as long as its neighbour.
fn is_within_length_ratio(length_m: f64, next_m: f64) -> bool {
    length_m <= MAX_LENGTH_RATIO * next_m
}

/// A chord and up to three more of its curve each way. Joint i lies between chords i and i + 1; the first and the last slots stay empty, so that neighbours
/// of all others exist.
struct Run {
    lengths_m: [Option<f64>; 9],
    joints: [Option<Joint>; 8],
}

/// Index of the central chord.
const OWN: usize = 4;

impl Run {
    /// Ends at which the central chord is part of a curve of at least three joints.
    fn curved_ends(&self) -> [bool; 2] {
        let alone = |first: usize, second: usize| self.fits(OWN) && self.is_like(first) && self.is_like(second);
        match [self.joints[OWN - 1], self.joints[OWN]] {
            [Some(_), Some(_)] => [self.is_like(OWN) && (self.is_like(OWN - 1) || self.is_like(OWN + 1)); 2],
            [Some(_), None] => [alone(OWN - 1, OWN - 2), false],
            [None, Some(_)] => [false, alone(OWN + 1, OWN + 2)],
            [None, None] => [false; 2],
        }
    }

    /// Whether one or two joints of a curve are all that there is of it, which alone do not show a curve.
    fn is_short(&self) -> bool {
        let joints = self.joints.iter().flatten().count();
        let bends = |joint: &Joint| norm(joint.bend) > STRAIGHT_RAD;
        let is_like =
            |chord: usize| self.joints[chord - 1].is_none() || self.joints[chord].is_none() || self.is_like(chord);
        (1..3).contains(&joints)
            && self.fits(OWN)
            && self.joints.iter().flatten().all(bends)
            && (OWN - 1..=OWN + 1).all(is_like)
    }

    /// Whether the joints at both ends of a chord may belong to one curve.
    fn is_like(&self, chord: usize) -> bool {
        matches!([self.joints[chord - 1], self.joints[chord]], [Some(a), Some(b)] if a.is_like(&b)) && self.fits(chord)
    }

    /// False for a flat beside a short chord, between fillets or cut off a circle: more than three times as long as a neighbour, unless the curve has the
    /// same curvature at its other end, where a chord of like length follows, and beyond the neighbour.
    fn fits(&self, chord: usize) -> bool {
        // Places of the chords beside it, and of the joints at its other end, on the way to the neighbour, and beyond that.
        let beside = |next: usize, other: usize, joints: [usize; 3]| {
            let (Some(length_m), Some(next_m)) = (self.lengths_m[chord], self.lengths_m[next]) else { return true };
            let goes_on = || match (self.lengths_m[other], joints.map(|k| self.joints[k])) {
                (Some(other_m), [Some(behind), Some(here), Some(beyond)]) => {
                    is_within_length_ratio(length_m, other_m)
                        && is_within_length_ratio(other_m, length_m)
                        && here.has_curvature_of(&behind)
                        && here.has_curvature_of(&beyond)
                }
                _ => false,
            };
            is_within_length_ratio(length_m, next_m) || goes_on()
        };
        beside(chord - 1, chord + 1, [chord, chord - 1, chord - 2])
            && beside(chord + 1, chord - 1, [chord - 1, chord, chord + 1])
    }
}

struct Chords<'a> {
    mesh: &'a Mesh,
    crease_rad: f64,
    edges: Vec<Chord>,
    /// Chords in smooth regions at a group of corners, and its unit normal.
    smooth: IndexMap<u32, (Vec<(usize, usize)>, Vec3)>,
    /// Chords that end at a vertex.
    vertices: Vec<Vec<(usize, usize)>>,
    /// The joint at each end of each chord.
    joints: Vec<[Option<Joint>; 2]>,
}

impl<'a> Chords<'a> {
    fn of(mesh: &'a Mesh, crease_rad: f64) -> Self {
        let facets: Vec<Facet> = mesh.panels.iter().map(|p| Facet::of(mesh, *p)).collect();
        let sides = sides(mesh);
        let turn = |edge: &[Side]| {
            let [a, b] = edge else { return f64::INFINITY };
            let [m, n] = [a, b].map(|side| facets[side.panel as usize].normal);
            if a.is_forward == b.is_forward { f64::INFINITY } else { angle(m, n) }
        };
        // Corners of panels at one vertex, together as far as smooth edges reach; number of a corner: 4 × panel + place.
        let corner = |side: &Side, vertex: u32| {
            let corners = mesh.panels[side.panel as usize].corners();
            let begin = usize::from(side.corner);
            let place = if corners[begin] == vertex { begin } else { (begin + 1) % corners.len() };
            4 * side.panel + place as u32
        };
        let mut groups = Groups::new(4 * mesh.panels.len());
        for edge in by_edge(&sides).filter(|edge| turn(edge) <= crease_rad) {
            let (from, to) = edge[0].edge;
            groups.join(corner(&edge[0], from), corner(&edge[1], from));
            groups.join(corner(&edge[0], to), corner(&edge[1], to));
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
        let vertices = vec![Vec::new(); mesh.vertices.len()];
        let mut out =
            Self { mesh, crease_rad, edges: Vec::new(), smooth: IndexMap::new(), vertices, joints: Vec::new() };
        for edge in by_edge(&sides) {
            let (from, to) = edge[0].edge;
            let turn_rad = turn(edge);
            let is_smooth = turn_rad <= crease_rad;
            let number = out.edges.len();
            let own = [from, to].map(|vertex| groups.of(corner(&edge[0], vertex)));
            for (end, (vertex, group)) in [from, to].into_iter().zip(own).enumerate() {
                out.vertices[vertex as usize].push((number, end));
                if is_smooth {
                    let sum = sums[group as usize];
                    let entry = out.smooth.entry(group).or_insert_with(|| (Vec::new(), scale(sum, 1.0 / norm(sum))));
                    entry.0.push((number, end));
                }
            }
            let sides =
                [from, to].map(|vertex| [edge[0], edge[edge.len() - 1]].map(|side| groups.of(corner(&side, vertex))));
            out.edges.push(Chord {
                ends: [from, to],
                sides,
                groups: is_smooth.then_some(own),
                turn_rad,
                around: around(mesh, edge),
            });
        }
        out.joints = (0..out.edges.len()).map(|number| [0, 1].map(|end| out.joint_of((number, end)))).collect();
        out
    }

    fn vector(&self, chord: &Chord) -> Vec3 {
        let [p, q] = chord.ends.map(|v| self.mesh.vertices[v as usize]);
        sub(q, p)
    }

    /// Out of a vertex along a chord that ends there.
    fn outwards(&self, (chord, end): (usize, usize)) -> Vec3 {
        let v = self.vector(&self.edges[chord]);
        scale(v, if end == 0 { 1.0 } else { -1.0 } / norm(v))
    }

    /// The joint at an end of a chord; `None` at a crease, where the surface does not continue smoothly.
    fn joint_of(&self, (number, end): (usize, usize)) -> Option<Joint> {
        let chord = &self.edges[number];
        let own = self.outwards((number, end));
        let (next, bend) = if let Some(groups) = chord.groups {
            let (others, normal) = self.smooth.get(&groups[end])?;
            let flat = |v: Vec3| sub(v, scale(*normal, dot(v, *normal)));
            let ahead = |other: &&(usize, usize)| {
                let (a, b) = (flat(own), flat(self.outwards(**other)));
                -dot(a, b) / (norm(a) * norm(b))
            };
            let next = others.iter().filter(|other| other.0 != number && ahead(other) > MIN_AHEAD_COSINE);
            let next = *next.max_by(|a, b| ahead(a).total_cmp(&ahead(b)))?;
            let dip = |v: Vec3| -dot(v, *normal).clamp(-1.0, 1.0).asin();
            (next, scale(*normal, dip(own) + dip(self.outwards(next))))
        } else {
            let creases = self.at_vertex(chord.ends[end]).filter(|at| self.edges[at.0].groups.is_none());
            let [one, other] = creases.copied().collect::<Vec<_>>()[..] else { return None };
            let next = if one.0 == number { other } else { one };
            let ahead = self.outwards(next);
            let back = add(own, ahead);
            let turn = angle(scale(own, -1.0), ahead);
            (next, if turn > 0.0 { scale(back, -turn / norm(back)) } else { [0.0; 3] })
        };
        let length_m = norm(self.vector(&self.edges[next.0]));
        // Between panels that meet at no crease an edge turns by more than they do: 63° on an icosahedron of 42°.
        let most_rad = if chord.groups.is_some() { core::f64::consts::FRAC_PI_2 } else { self.crease_rad };
        let own_m = norm(self.vector(chord));
        (norm(bend) <= most_rad).then_some(Joint { next, own_m, length_m, bend })
    }

    /// The curve through a chord, three joints each way.
    fn run(&self, number: usize) -> Run {
        let mut run = Run { lengths_m: [None; 9], joints: [None; 8] };
        run.lengths_m[OWN] = Some(norm(self.vector(&self.edges[number])));
        for way in 0..2 {
            let mut end = (number, way);
            for step in 0..3 {
                let Some(joint) = self.joints[end.0][end.1] else { break };
                let (at, chord) =
                    if way == 0 { (OWN - 1 - step, OWN - 1 - step) } else { (OWN + step, OWN + 1 + step) };
                run.joints[at] = Some(joint);
                run.lengths_m[chord] = Some(joint.length_m);
                end = (joint.next.0, 1 - joint.next.1);
            }
        }
        run
    }

    /// The ends of each chord at which it is part of a curve.
    fn curved_ends(&self) -> Vec<[bool; 2]> {
        let mut out: Vec<[bool; 2]> = (0..self.edges.len()).map(|number| self.run(number).curved_ends()).collect();
        // Between its fins a hull has only one or two joints in a row; the rows of its bow show that they belong to a curve.
        let mut to_see: Vec<usize> = (0..out.len()).filter(|number| out[*number] != [false; 2]).collect();
        while let Some(number) = to_see.pop() {
            let ends = out[number];
            for end in (0..2).filter(|end| ends[*end]) {
                for beside in self.parallel((number, end)) {
                    if out[beside] == [false; 2] && self.run(beside).is_short() {
                        out[beside] = self.joints[beside].map(|joint| joint.is_some());
                        to_see.push(beside);
                    }
                }
            }
        }
        out
    }

    /// Chords in the rows beside this one that are parallel and have a joint like that at an end of this, reached over a transverse edge.
    fn parallel(&self, at: (usize, usize)) -> Vec<usize> {
        let Some(joint) = self.joints[at.0][at.1] else { return Vec::new() };
        let own = self.outwards(at);
        let mut out = Vec::new();
        for edge in self.at_vertex(self.edges[at.0].ends[at.1]) {
            let Some(groups) = self.edges[edge.0].groups else { continue };
            if dot(own, self.outwards(*edge)).abs() > MIN_AHEAD_COSINE || !self.bends_with(at, groups[edge.1]) {
                continue;
            }
            let is_beside = |other: &&(usize, usize)| {
                dot(own, self.outwards(**other)) > MIN_PARALLEL_COSINE
                    && self.joints[other.0][other.1].is_some_and(|there| joint.is_parallel(&there))
                    && self.bends_with(**other, groups[1 - edge.1])
            };
            let there = self.at_vertex(self.edges[edge.0].ends[1 - edge.1]);
            out.extend(there.filter(is_beside).map(|(number, _)| *number));
        }
        out
    }

    /// Whether a chord lies in the surface of a group of corners at its end, or borders on it, and bends as that surface does and not within it: the
    /// rim of a cylinder bends with its side, and not with its end.
    fn bends_with(&self, at: (usize, usize), group: u32) -> bool {
        let (Some(joint), Some((_, normal))) = (self.joints[at.0][at.1], self.smooth.get(&group)) else { return false };
        self.edges[at.0].sides[at.1].contains(&group)
            && dot(joint.bend, *normal).abs() > MIN_AHEAD_COSINE * norm(joint.bend)
    }

    fn at_vertex(&self, vertex: u32) -> impl Iterator<Item = &(usize, usize)> {
        self.vertices[vertex as usize].iter()
    }

    /// From the middle of each chord to that of its arc.
    fn bulges(&self) -> IndexMap<(u32, u32), Vec3> {
        let curved = self.curved_ends();
        let arc = |number: usize| {
            let chord = &self.edges[number];
            let ends = curved[number];
            let sum = (0..2).filter(|end| ends[*end]).fold([0.0; 3], |sum, end| add(sum, self.bulge(number, end)));
            let count = ends.iter().filter(|end| **end).count();
            let mean = scale(sum, 1.0 / count.max(1) as f64);
            let length_m = norm(self.vector(chord));
            let next_m = (0..2).filter(|end| ends[*end]).filter_map(|end| Some(self.joints[number][end]?.length_m));
            let most_m = MAX_BULGE_PER_CHORD
                * next_m.filter(|next_m| is_within_length_ratio(length_m, *next_m)).fold(length_m, f64::min);
            let size = norm(mean);
            if size > most_m { scale(mean, most_m / size) } else { mean }
        };
        let key = |chord: &Chord| (chord.ends[0], chord.ends[1]);
        let mut out: IndexMap<(u32, u32), Vec3> =
            self.edges.iter().enumerate().map(|(k, c)| (key(c), arc(k))).collect();
        // The diagonal of a flat quadrilateral lies on the Coons patch over its four sides.
        for chord in &self.edges {
            let Some(around) = chord.around.filter(|_| chord.turn_rad < STRAIGHT_RAD) else { continue };
            let sum = around.iter().fold([0.0; 3], |sum, side| add(sum, out.get(side).copied().unwrap_or_default()));
            out.insert(key(chord), scale(sum, 0.5));
        }
        out
    }

    /// Sagitta of the arc that leaves an end of a chord in the direction of the surface: a chord c that its end meets at α has (c/2) tan(α/2).
    fn bulge(&self, number: usize, end: usize) -> Vec3 {
        let chord = &self.edges[number];
        let length_m = norm(self.vector(chord));
        let own = self.outwards((number, end));
        let tangent = if let Some(groups) = chord.groups {
            let normal = self.smooth.get(&groups[end]).map_or([0.0; 3], |(_, normal)| *normal);
            sub(own, scale(normal, dot(own, normal)))
        } else {
            // Of the circle through three vertices.
            let Some(joint) = self.joints[number][end] else { return [0.0; 3] };
            sub(scale(own, 1.0 / length_m), scale(self.outwards(joint.next), 1.0 / joint.length_m))
        };
        let tangent = scale(tangent, 1.0 / norm(tangent));
        let cosine = dot(tangent, own);
        // Also where an edge has no length, and its directions are not numbers.
        if cosine > 0.0 { scale(sub(tangent, scale(own, cosine)), 0.5 * length_m / (1.0 + cosine)) } else { [0.0; 3] }
    }
}

/// Angle between two directions, rad.
fn angle(a: Vec3, b: Vec3) -> f64 {
    norm(cross(a, b)).atan2(dot(a, b))
}

/// The other edges of two triangles that share their longest.
fn around(mesh: &Mesh, edge: &[Side]) -> Option<[(u32, u32); 4]> {
    let [a, b] = edge else { return None };
    let mut out = [(0, 0); 4];
    for (k, side) in [a, b].into_iter().enumerate() {
        let [p, q, r] = *mesh.panels[side.panel as usize].corners() else { return None };
        let begin = usize::from(side.corner);
        let [from, to, tip] = [0, 1, 2].map(|i| [p, q, r][(begin + i) % 3]);
        let point = |v: u32| mesh.vertices[v as usize];
        let length = |v: u32, w: u32| norm(sub(point(v), point(w)));
        if length(from, to) < length(to, tip).max(length(tip, from)) {
            return None;
        }
        out[2 * k] = (to.min(tip), to.max(tip));
        out[2 * k + 1] = (from.min(tip), from.max(tip));
    }
    Some(out)
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
