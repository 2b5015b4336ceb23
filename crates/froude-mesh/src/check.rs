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

/// Something wrong with a mesh; numbers of panels and vertices count from 0 in the order of the file.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Trouble {
    /// Nothing in it.
    #[error("the mesh has no panel")]
    Empty,
    /// A coordinate that is NaN or infinite.
    #[error("vertex {vertex} has the coordinates {point:?}: each must be a finite number")]
    NotFinite {
        /// The vertex.
        vertex: usize,
        /// Its coordinates.
        point: Vec3,
    },
    /// A corner that does not exist.
    #[error("panel {panel} has the vertex {vertex}, and there are {vertices}")]
    NoSuchVertex {
        /// The panel.
        panel: usize,
        /// The number that it names.
        vertex: usize,
        /// How many there are.
        vertices: usize,
    },
    /// A panel without area.
    #[error("panel {panel} at {at:?} m has no area; take it out, or merge its corners")]
    NoArea {
        /// The panel.
        panel: usize,
        /// Its first corner.
        at: Vec3,
    },
    /// Two panels over the same corners.
    #[error("panel {panel} at {at:?} m is there twice (also as {first}); take one out")]
    Copy {
        /// The later one.
        panel: usize,
        /// The earlier one.
        first: usize,
        /// Its centroid.
        at: Vec3,
    },
    /// An edge with one panel only.
    #[error("{} one panel only, the first from {from:?} to {to:?} m: the surface is open there", counted(*count, "edge has", "edges have"))]
    Open {
        /// How many.
        count: usize,
        /// One end of the first.
        from: Vec3,
        /// Its other end.
        to: Vec3,
    },
    /// Neighbours that run the same way along an edge.
    #[error(
        "{} traversed twice in the same direction, the first from {from:?} to {to:?} m: neighbours are oriented against each other", counted(*count, "edge is", "edges are")
    )]
    Turned {
        /// How many.
        count: usize,
        /// One end of the first.
        from: Vec3,
        /// Its other end.
        to: Vec3,
    },
    /// Three panels or more at an edge.
    #[error("{} three panels or more, the first from {from:?} to {to:?} m: surfaces touch there", counted(*count, "edge has", "edges have"))]
    Branched {
        /// How many.
        count: usize,
        /// One end of the first.
        from: Vec3,
        /// Its other end.
        to: Vec3,
    },
    /// Normals point into the body.
    #[error("the surface is inside out (its volume is {volume_m3:.4e} m³): its normals must point into the water")]
    InsideOut {
        /// The signed volume, m³.
        volume_m3: f64,
    },
    /// A part that is inside out where others are not.
    #[error(
        "part {part} ({panels} panels, at {at:?} m) is inside out (its volume is {volume_m3:.4e} m³), others are \
         not; turn its panels"
    )]
    PartInsideOut {
        /// The part.
        part: usize,
        /// How many panels it has.
        panels: usize,
        /// A corner of its first panel.
        at: Vec3,
        /// Its signed volume, m³.
        volume_m3: f64,
    },
    /// A closed surface inside another.
    #[error(
        "part {part} ({panels} panels, at {at:?} m, volume {volume_m3:.4e} m³) lies inside part {outer}: no water \
         reaches it; take it out"
    )]
    Nested {
        /// The inner part.
        part: usize,
        /// How many panels it has.
        panels: usize,
        /// A corner of its first panel.
        at: Vec3,
        /// Its signed volume, m³.
        volume_m3: f64,
        /// The part around it.
        outer: usize,
    },
    /// Panels through or against one another.
    #[error(
        "{} without a common vertex there, the first {first} and {second} at {at:?} m; unite the \
         bodies, or move them apart", counted(*count, "pair of panels crosses or touches", "pairs of panels cross or touch")
    )]
    Crossing {
        /// How many pairs; counting ends at [`crate::crossing::MOST`].
        count: usize,
        /// The smaller number of the first pair.
        first: usize,
        /// The larger one.
        second: usize,
        /// A point of both.
        at: Vec3,
    },
    /// Neighbours that lie on one another, or a panel that does so with itself.
    #[error(
        "{} folded onto one another, the first {first} and {second} at {at:?} m; take one out", counted(*count, "pair of neighbours is", "pairs of neighbours are")
    )]
    Folded {
        /// How many pairs.
        count: usize,
        /// The smaller number of the first pair; for a quadrilateral that crosses itself, both are one.
        first: usize,
        /// The larger one.
        second: usize,
        /// The middle of their common edge.
        at: Vec3,
    },
    /// Thin panels: the result may lose digits.
    #[error(
        "{}, the thinnest is {panel} at {at:?} m with {ratio:.1e} of its longest edge squared", counted(*count, "panel is a sliver", "panels are slivers")
    )]
    Slivers {
        /// How many.
        count: usize,
        /// The thinnest.
        panel: usize,
        /// Its centroid.
        at: Vec3,
        /// Its area over its longest edge squared.
        ratio: f64,
    },
}

impl Trouble {
    /// Whether nothing can be computed with it; slivers only cost digits.
    #[must_use]
    pub const fn is_fatal(&self) -> bool {
        !matches!(self, Self::Slivers { .. })
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
            out.push(Trouble::NoArea { panel: number, at: corners[0] });
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
            out.push(Trouble::Copy { panel: number, first, at: facet.centroid });
        }
    }
    out.extend(edges(mesh));
    let volume_m3 = Measure::of(mesh).volume_m3;
    if out.is_empty() && volume_m3 <= 0.0 {
        out.push(Trouble::InsideOut { volume_m3 });
    }
    if let Some((panel, ratio)) = thinnest {
        let at = Facet::of(mesh, mesh.panels[panel]).centroid;
        out.push(Trouble::Slivers { count: slivers, panel, at, ratio });
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
        return vec![Trouble::Empty];
    }
    let wild = mesh.vertices.iter().enumerate().filter(|(_, v)| v.iter().any(|x| !x.is_finite()));
    let mut out: Vec<Trouble> = wild.map(|(vertex, point)| Trouble::NotFinite { vertex, point: *point }).collect();
    for (panel, p) in mesh.panels.iter().enumerate() {
        if let Some(&vertex) = p.corners().iter().find(|v| **v as usize >= vertices) {
            out.push(Trouble::NoSuchVertex { panel, vertex: vertex as usize, vertices });
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
    let reported = |is_such: fn(usize, usize) -> bool, trouble: fn(usize, Vec3, Vec3) -> Trouble| {
        let mut such = edges.iter().filter(|(_, (there, back))| is_such(*there, *back));
        let ((from, to), _) = *such.next()?;
        Some(trouble(1 + such.count(), point(from), point(to)))
    };
    [
        reported(|there, back| there + back == 1, |count, from, to| Trouble::Open { count, from, to }),
        reported(
            |there, back| there + back == 2 && there != back,
            |count, from, to| Trouble::Turned { count, from, to },
        ),
        reported(|there, back| there + back > 2, |count, from, to| Trouble::Branched { count, from, to }),
    ]
    .into_iter()
    .flatten()
    .collect()
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
