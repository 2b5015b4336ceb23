//! The slivers that a union leaves where two surfaces meet, cleaned: edges merged into one of their ends, diagonals turned.
//!
//! Every panel that the seam cuts is left in pieces of any shape, and a panel method loses digits on slivers. A panel of corners that
//! were there before stays. A change must stay within [`DEVIATION`] of the surface as it was, turn no sound neighbour by more than
//! [`TURNED`], fold nothing over ([`FOLDED`]), and all changes together move the volume by no more than [`VOLUME_PART`].

use crate::files::soup::bits;
use crate::mesh::{Mesh, Panel};
use crate::vector::{Vec3, cross, dot, norm, sub};
use indexmap::IndexSet;

/// Part of the volume that all changes together may take or add \[-\]: a tenth of what the facets of 500 panels on a sphere lack.
pub const VOLUME_PART: f64 = 1e-3;
/// Area over the square of the longest edge below which a panel is cleaned \[-\].
const THIN: f64 = 0.05;
/// Distance of a merged corner from the surface before, over the longest edge there \[-\]: the sag of facets of a sphere with 40 around.
const DEVIATION: f64 = 0.02;
/// Least cosine between the normals of a panel before and after.
const TURNED: f64 = 0.9;
/// Area that a change may add to the panels around it \[-\]: what is folded over adds more.
const FOLDED: f64 = 0.01;
/// A turned diagonal must make the thinner of its two panels this much thicker, so that none is turned forever \[-\].
const BETTER: f64 = 1.2;
/// Passes over all slivers at most; what is left then is reported by the check of the mesh.
const MOST_PASSES: usize = 40;

/// A mesh with a clean seam.
pub(crate) struct Cleaned {
    pub mesh: Mesh,
    /// Edges merged into one of their ends.
    pub merged: usize,
    /// Diagonals turned.
    pub turned: usize,
    /// Sum of all changes of the volume, each without its sign, over the volume \[-\].
    pub volume_part: f64,
}

/// Cleans a closed mesh of triangles; those with all corners among `given` stay.
pub(crate) fn cleaned(mesh: &Mesh, given: &[Vec3], volume_m3: f64) -> Cleaned {
    let given: IndexSet<[u64; 3]> = given.iter().map(|point| bits(*point)).collect();
    let mut work = Work {
        is_given: mesh.vertices.iter().map(|v| given.contains(&bits(*v))).collect(),
        points: mesh.vertices.clone(),
        triangles: mesh.panels.iter().filter_map(|p| p.corners().try_into().ok()).map(Some).collect(),
        around: vec![Vec::new(); mesh.vertices.len()],
        left_m3: VOLUME_PART * volume_m3,
    };
    for (number, triangle) in work.triangles.iter().enumerate() {
        triangle.iter().flatten().for_each(|v| work.around[*v as usize].push(number));
    }
    let (mut merged, mut turned) = (0, 0);
    for _ in 0..MOST_PASSES {
        let mut slivers: Vec<(f64, usize)> =
            (0..work.triangles.len()).filter_map(|t| Some((work.thinness(t)?, t))).collect();
        slivers.sort_by(|a, b| a.0.total_cmp(&b.0));
        let before = merged + turned;
        for (_, t) in slivers {
            if work.thinness(t).is_none() {
                continue;
            }
            if work.merge(t) {
                merged += 1;
            } else if work.turn(t) {
                turned += 1;
            }
        }
        if merged + turned == before {
            break;
        }
    }
    let panels = work.triangles.iter().flatten().map(|[a, b, c]| Panel::triangle(*a, *b, *c)).collect();
    let mut mesh = Mesh { vertices: work.points, panels };
    mesh.drop_unused_vertices();
    Cleaned { mesh, merged, turned, volume_part: VOLUME_PART - work.left_m3 / volume_m3 }
}

/// Triangles, and those around each vertex.
struct Work {
    points: Vec<Vec3>,
    is_given: Vec<bool>,
    triangles: Vec<Option<[u32; 3]>>,
    around: Vec<Vec<usize>>,
    /// Change of volume that is left, m³.
    left_m3: f64,
}

impl Work {
    fn point(&self, v: u32) -> Vec3 {
        self.points[v as usize]
    }

    /// Twice the area of a triangle, along its normal.
    fn normal(&self, [a, b, c]: [u32; 3]) -> Vec3 {
        cross(sub(self.point(b), self.point(a)), sub(self.point(c), self.point(a)))
    }

    fn length(&self, a: u32, b: u32) -> f64 {
        norm(sub(self.point(b), self.point(a)))
    }

    fn longest(&self, [a, b, c]: [u32; 3]) -> f64 {
        self.length(a, b).max(self.length(b, c)).max(self.length(c, a))
    }

    /// Area over the square of the longest edge.
    fn ratio(&self, t: [u32; 3]) -> f64 {
        let longest = self.longest(t);
        if longest > 0.0 { 0.5 * norm(self.normal(t)) / (longest * longest) } else { 0.0 }
    }

    /// The ratio of a triangle to be cleaned.
    fn thinness(&self, t: usize) -> Option<f64> {
        let corners = self.triangles[t].filter(|t| !t.iter().all(|v| self.is_given[*v as usize]))?;
        let ratio = self.ratio(corners);
        (ratio < THIN).then_some(ratio)
    }

    fn at(&self, v: u32) -> impl Iterator<Item = (usize, [u32; 3])> + '_ {
        self.around[v as usize].iter().filter_map(|t| Some((*t, self.triangles[*t]?)))
    }

    fn neighbours(&self, v: u32) -> IndexSet<u32> {
        self.at(v).flat_map(|(_, t)| t).filter(|other| *other != v).collect()
    }

    /// Six times the volume of a tetrahedron, m³.
    fn six_volumes(&self, [a, b, c, d]: [u32; 4]) -> f64 {
        let from = |v: u32| sub(self.point(v), self.point(a));
        dot(from(b), cross(from(c), from(d)))
    }

    /// Whether a panel may replace another: it is not turned over, and not thinner unless it is thick.
    fn may_become(&self, from: [u32; 3], to: [u32; 3]) -> bool {
        let (before, after) = (self.normal(from), self.normal(to));
        let (ratio, new_ratio) = (self.ratio(from), self.ratio(to));
        let least = if ratio < THIN { 0.0 } else { TURNED };
        dot(before, after) > least * norm(before) * norm(after) && new_ratio > ratio.min(THIN)
    }

    /// The change of volume when `gone` moves to `kept`, m³; `None` if it may not.
    fn move_m3(&self, gone: u32, kept: u32) -> Option<f64> {
        if self.neighbours(gone).intersection(&self.neighbours(kept)).count() != 2 {
            return None;
        }
        let way = sub(self.point(kept), self.point(gone));
        let allowed = DEVIATION * self.at(gone).map(|(_, t)| self.longest(t)).fold(0.0, f64::max);
        let (mut change, mut before, mut after) = (0.0, 0.0, 0.0);
        for (_, t) in self.at(gone) {
            let normal = self.normal(t);
            if self.ratio(t) >= THIN && dot(normal, way).abs() > allowed * norm(normal) {
                return None;
            }
            before += norm(normal);
            if t.contains(&kept) {
                continue;
            }
            let moved = t.map(|v| if v == gone { kept } else { v });
            if !self.may_become(t, moved) {
                return None;
            }
            after += norm(self.normal(moved));
            change += self.six_volumes([kept, t[0], t[1], t[2]]) / 6.0;
        }
        (change.abs() <= self.left_m3 && after <= (1.0 + FOLDED) * before).then_some(change.abs())
    }

    /// Merges an edge of a triangle, the shortest that may be.
    fn merge(&mut self, t: usize) -> bool {
        let Some([a, b, c]) = self.triangles[t] else { return false };
        let mut edges = [(a, b), (b, c), (c, a)];
        edges.sort_by(|x, y| self.length(x.0, x.1).total_cmp(&self.length(y.0, y.1)));
        let ways = edges.into_iter().take(2).flat_map(|(u, v)| [(u, v), (v, u)]);
        let able = ways.filter_map(|(gone, kept)| Some((self.move_m3(gone, kept)?, gone, kept)));
        let Some((change_m3, gone, kept)) = able.min_by(|x, y| x.0.total_cmp(&y.0)) else { return false };
        self.left_m3 -= change_m3;
        for t in std::mem::take(&mut self.around[gone as usize]) {
            let Some(corners) = self.triangles[t] else { continue };
            if corners.contains(&kept) {
                self.triangles[t] = None;
            } else {
                self.triangles[t] = Some(corners.map(|v| if v == gone { kept } else { v }));
                self.around[kept as usize].push(t);
            }
        }
        true
    }

    /// Turns the longest edge of a triangle into the other diagonal of it and its neighbour.
    fn turn(&mut self, t: usize) -> bool {
        let Some([a, b, c]) = self.triangles[t] else { return false };
        let turns = [[a, b, c], [b, c, a], [c, a, b]];
        let Some([a, b, c]) =
            turns.into_iter().max_by(|x, y| self.length(x[0], x[1]).total_cmp(&self.length(y[0], y[1])))
        else {
            return false;
        };
        let Some((over, beyond)) = self.at(a).find(|(number, other)| *number != t && other.contains(&b)) else {
            return false;
        };
        let Some(d) = beyond.into_iter().find(|v| *v != a && *v != b) else { return false };
        if c == d || self.neighbours(c).contains(&d) {
            return false;
        }
        let (first, second) = ([a, d, c], [d, b, c]);
        let change_m3 = self.six_volumes([a, b, c, d]).abs() / 6.0;
        // A sliver has no normal to speak of.
        let normal = self.normal(if self.ratio(beyond) < self.ratio([a, b, c]) { [a, b, c] } else { beyond });
        let off = |v: u32| dot(normal, sub(self.point(v), self.point(a))).abs();
        let least = |x, y| self.ratio(x).min(self.ratio(y));
        let is_better = least(first, second) > BETTER * least([a, b, c], beyond);
        let is_near = off(c).max(off(d)) <= DEVIATION * self.longest(beyond) * norm(normal);
        let area = |x, y| norm(self.normal(x)) + norm(self.normal(y));
        let is_unfolded = area(first, second) <= (1.0 + FOLDED) * area([a, b, c], beyond);
        let stays = |new: [u32; 3]| {
            let new = self.normal(new);
            dot(new, normal) > TURNED * norm(new) * norm(normal)
        };
        if !(is_better && is_near && is_unfolded && stays(first) && stays(second) && change_m3 <= self.left_m3) {
            return false;
        }
        self.left_m3 -= change_m3;
        self.triangles[t] = Some(first);
        self.triangles[over] = Some(second);
        self.around[b as usize].retain(|number| *number != t);
        self.around[a as usize].retain(|number| *number != over);
        self.around[d as usize].push(t);
        self.around[c as usize].push(over);
        true
    }
}
