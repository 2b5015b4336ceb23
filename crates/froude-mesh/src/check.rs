//! Whether a mesh is a surface that potential flow can be computed on: what is wrong, and where.
//!
//! Closed means that each edge is passed once in each direction. A volume below zero means that the surface is inside out. A sliver is
//! a panel whose area is small against the square of its longest edge.

use indexmap::IndexMap;

use crate::files::soup::counted;
use crate::measure::Measure;
use crate::mesh::{Mesh, Panel};
use crate::panel::Facet;
use crate::vector::{Vec3, norm, sub};

/// Area over the square of the longest edge below which a panel is a sliver \[-\].
const SLIVER: f64 = 1e-3;
/// Area over the square of the mesh's extent below which a panel has none \[-\].
const NOTHING: f64 = 1e-14;

/// What is wrong with a mesh, and where.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{words}")]
pub struct Trouble {
    /// Its kind.
    pub kind: Kind,
    words: String,
}

/// Kind of trouble that a mesh has.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Coordinates that are not finite, or indices of vertices that do not exist.
    Unreadable,
    /// Edges with one panel only.
    Open,
    /// A part inside another.
    Nested,
    /// Parts that cross or touch.
    Crossing,
    /// Slivers: the accuracy suffers, the solution does not fail.
    Slivers,
    /// Any other; a repair may mend it.
    Other,
}

impl Trouble {
    pub(crate) fn new(kind: Kind, words: impl Into<String>) -> Self {
        Self { kind, words: words.into() }
    }

    /// Whether potential flow cannot be computed on the mesh; slivers only cost accuracy.
    #[must_use]
    pub fn is_fatal(&self) -> bool {
        self.kind != Kind::Slivers
    }
}

/// Everything wrong with a mesh; empty for one that is fit for use.
#[must_use]
pub fn check(mesh: &Mesh) -> Vec<Trouble> {
    let unreadable = unreadable(mesh);
    if !unreadable.is_empty() {
        return unreadable;
    }
    let mut out = Vec::new();
    let extent = extent(mesh);
    let mut thinnest: Option<(usize, f64)> = None;
    let mut slivers = 0;
    let mut seen: IndexMap<Vec<u32>, usize> = IndexMap::new();
    for (number, panel) in mesh.panels.iter().enumerate() {
        let facet = Facet::of(mesh, *panel);
        let corners: Vec<Vec3> = mesh.corners(*panel).collect();
        let edge = |i: usize| norm(sub(corners[(i + 1) % corners.len()], corners[i]));
        let longest = (0..corners.len()).map(edge).fold(0.0, f64::max);
        if facet.area <= NOTHING * extent * extent {
            let at = corners[0];
            let words = format!("panel {number} at {at:?} m has no area; take it out, or merge its corners");
            out.push(Trouble::new(Kind::Other, words));
            continue;
        }
        let ratio = facet.area / (longest * longest);
        if ratio < SLIVER {
            slivers += 1;
            if thinnest.is_none_or(|(_, least)| ratio < least) {
                thinnest = Some((number, ratio));
            }
        }
        let mut key = panel.corners().to_vec();
        key.sort_unstable();
        if let Some(first) = seen.insert(key, number) {
            let at = facet.centroid;
            let words = format!("panel {number} at {at:?} m is there twice (also as {first}); take one out");
            out.push(Trouble::new(Kind::Other, words));
        }
    }
    out.extend(edges(mesh));
    let volume_m3 = Measure::of(mesh).volume_m3;
    if out.is_empty() && volume_m3 <= 0.0 {
        let words = format!(
            "the surface is inside out (its volume is {volume_m3:.4e} m³): its normals must point into the water"
        );
        out.push(Trouble::new(Kind::Other, words));
    }
    if let Some((panel, ratio)) = thinnest {
        let at = Facet::of(mesh, mesh.panels[panel]).centroid;
        let words = format!(
            "{}, the thinnest is {panel} at {at:?} m with {ratio:.1e} of its longest edge squared",
            counted(slivers, "panel is a sliver", "panels are slivers")
        );
        out.push(Trouble::new(Kind::Slivers, words));
    }
    out
}

/// Whether every coordinate is a number and every corner exists, in a mesh of one panel or more.
pub(crate) fn is_readable(mesh: &Mesh) -> bool {
    first_unreadable(mesh).is_none()
}

/// Why panels cannot be looked at.
pub(crate) fn first_unreadable(mesh: &Mesh) -> Option<Trouble> {
    unreadable(mesh).into_iter().next()
}

/// Whether a panel has no area in a mesh of that extent.
pub(crate) fn has_no_area(mesh: &Mesh, panel: Panel, extent: f64) -> bool {
    Facet::of(mesh, panel).area <= NOTHING * extent * extent
}

fn unreadable(mesh: &Mesh) -> Vec<Trouble> {
    let vertices = mesh.vertices.len();
    if mesh.panels.is_empty() {
        return vec![Trouble::new(Kind::Unreadable, "the mesh has no panel")];
    }
    let wild = mesh.vertices.iter().enumerate().filter(|(_, v)| v.iter().any(|x| !x.is_finite()));
    let unreadable = |words| Trouble::new(Kind::Unreadable, words);
    let mut out: Vec<Trouble> = wild
        .map(|(vertex, point)| format!("vertex {vertex} has the coordinates {point:?}: each must be a finite number"))
        .map(unreadable)
        .collect();
    for (panel, p) in mesh.panels.iter().enumerate() {
        if let Some(&vertex) = p.corners().iter().find(|v| **v as usize >= vertices) {
            out.push(unreadable(format!("panel {panel} has the vertex {vertex}, and there are {vertices}")));
        }
    }
    out
}

/// Largest side of the box around the mesh, m.
#[must_use]
pub fn extent(mesh: &Mesh) -> f64 {
    let side = |axis: usize| {
        let values = mesh.vertices.iter().map(|v| v[axis]);
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        high - low
    };
    (0..3).map(side).fold(0.0, f64::max)
}

/// Whether each edge is passed once each way.
pub(crate) fn is_closed(mesh: &Mesh) -> bool {
    edges(mesh).is_empty()
}

/// Edges that are not passed once each way.
fn edges(mesh: &Mesh) -> Vec<Trouble> {
    // Smaller vertex first: how often it is passed that way, and the other.
    let mut passed: IndexMap<(u32, u32), (usize, usize)> = IndexMap::new();
    for panel in &mesh.panels {
        let corners = panel.corners();
        for (i, &from) in corners.iter().enumerate() {
            let to = corners[(i + 1) % corners.len()];
            let entry = passed.entry((from.min(to), from.max(to))).or_default();
            if from < to {
                entry.0 += 1;
            } else {
                entry.1 += 1;
            }
        }
    }
    let mut edges: Vec<_> = passed.into_iter().collect();
    edges.sort_unstable();
    let point = |v: u32| mesh.vertices[v as usize];
    let reported = |kind: Kind, is_such: fn(usize, usize) -> bool, [one, more]: [&str; 2], problem: &str| {
        let mut such = edges.iter().filter(|(_, (there, back))| is_such(*there, *back));
        let ((from, to), _) = *such.next()?;
        let (edges, from, to) = (counted(1 + such.count(), one, more), point(from), point(to));
        Some(Trouble::new(kind, format!("{edges}, the first from {from:?} to {to:?} m: {problem}")))
    };
    let open = reported(
        Kind::Open,
        |there, back| there + back == 1,
        ["edge has one panel only", "edges have one panel only"],
        "the surface is open there",
    );
    let turned = reported(
        Kind::Other,
        |there, back| there + back == 2 && there != back,
        ["edge is traversed twice in the same direction", "edges are traversed twice in the same direction"],
        "neighbours are oriented against each other",
    );
    let branched = reported(
        Kind::Other,
        |there, back| there + back > 2,
        ["edge has three panels or more", "edges have three panels or more"],
        "surfaces touch there",
    );
    open.into_iter().chain(turned).chain(branched).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sections::{Resolution, SectionBody};

    fn good() -> Mesh {
        SectionBody::ellipsoid([2.0, 1.0, 1.0], 2).mesh(Resolution { along: 1, around: 8 }).unwrap().mesh
    }

    #[test]
    fn a_generated_body_is_fit_for_use_and_its_troubles_are_found() {
        assert_eq!(check(&good()), []);
        let reported = |change: fn(&mut Mesh)| {
            let mut mesh = good();
            change(&mut mesh);
            check(&mesh).iter().map(ToString::to_string).collect::<Vec<_>>().join("; ")
        };
        assert_eq!(reported(|m| m.panels.clear()), "the mesh has no panel");
        assert!(reported(|m| m.vertices[3][1] = f64::NAN).starts_with("vertex 3 has the coordinates"));
        assert!(reported(|m| m.panels[0] = Panel::triangle(0, 1, 999)).contains("the vertex 999, and there are 26"));
        assert!(reported(|m| _ = m.panels.pop()).starts_with("3 edges have one panel only"));
        assert!(
            reported(|m| m.panels[9] = m.panels[9].turned())
                .contains("4 edges are traversed twice in the same direction")
        );
        assert!(reported(|m| m.panels.push(m.panels[9])).contains("is there twice (also as 9)"));
        assert!(
            reported(|m| m.panels.iter_mut().for_each(|p| *p = p.turned())).starts_with("the surface is inside out")
        );
        assert!(reported(|m| m.vertices.iter_mut().for_each(|v| (v[1], v[2]) = (0.0, 0.0))).contains("has no area"));
    }
}
