//! The closed solids of a mesh in which some share edges, and the decks inside a closed hull.
//!
//! About an edge, in the order of the angle, the inside of a solid begins at one panel and ends at another. Each beginning belongs to
//! the end that closes it, as brackets do: so two boxes that were merged at a common face are two solids again. The order of solids
//! that overlap there is not known, but no pairing changes how often a point is inside. A panel with the inside on both of its sides is
//! that of a deck.

use core::f64::consts::TAU;

use indexmap::IndexSet;

use crate::check::{Kind, Trouble, is_closed, is_readable};
use crate::crossing::FOLD_RAD;
use crate::files::soup::counted;
use crate::mesh::Mesh;
use crate::panel::Facet;
use crate::parts::{Part, parts, volume, winding};
use crate::topology::{Groups, Side, by_edge, sides};
use crate::vector::{Vec3, add, cross, dot, norm, scale, sub};

/// Solids, each with vertices of its own.
pub(crate) struct Solids {
    pub meshes: Vec<Mesh>,
    /// Those that have an edge in common.
    pub touching: Vec<(usize, usize)>,
}

/// Solids at most: more are parts of something else than a body.
const MOST_SOLIDS: usize = 200;
/// Panels at one edge at most.
const MOST_AT_EDGE: usize = 64;
/// Panels of sheets times panels of hulls at most, to find the sheets inside: some seconds.
const MOST_INSIDE: usize = 200_000_000;

/// The solids of a mesh; `None` if some surface is open, has three panels at an edge, or if there are more than [`MOST_SOLIDS`].
pub(crate) fn solids(mesh: &Mesh) -> Option<Solids> {
    let sides = sides(mesh);
    let (plain, shared): (Vec<&[Side]>, Vec<&[Side]>) = by_edge(&sides).partition(|edge| edge.len() < 3);
    let mut groups = Groups::new(mesh.panels.len());
    for edge in plain {
        for [opens, closes] in brackets(edge)? {
            groups.join(opens.panel, closes.panel);
        }
    }
    let mut pairs = Vec::new();
    if shared.iter().any(|edge| edge.len() > MOST_AT_EDGE) {
        return None;
    }
    for edge in &shared {
        // A sheet that comes to an edge from both sides goes on there.
        let mut rest = around(mesh, edge);
        while let Some((i, j)) = first_pair(&rest, |a, b| groups.of(a.panel) == groups.of(b.panel)) {
            rest.remove(j);
            rest.remove(i);
        }
        pairs.extend(brackets(&rest)?);
    }
    for [opens, closes] in pairs {
        groups.join(opens.panel, closes.panel);
    }
    let meeting: Vec<(u32, u32)> =
        shared.iter().flat_map(|edge| edge.iter().map(|side| (edge[0].panel, side.panel))).collect();
    let mut number_of = vec![None; mesh.panels.len()];
    let mut of_solid: Vec<Vec<usize>> = Vec::new();
    for panel in 0..mesh.panels.len() {
        let number = *number_of[groups.of(panel as u32) as usize].get_or_insert_with(|| {
            of_solid.push(Vec::new());
            of_solid.len() - 1
        });
        of_solid[number].push(panel);
    }
    if of_solid.len() > MOST_SOLIDS {
        return None;
    }
    let mut number = |panel: u32| number_of[groups.of(panel) as usize].unwrap_or(0);
    let touching = meeting.into_iter().map(|(a, b)| (number(a), number(b))).filter(|(a, b)| a != b).collect();
    let meshes = of_solid.iter().map(|panels| only(mesh, panels)).collect();
    Some(Solids { meshes, touching })
}

/// Whether the inside of a solid begins at a side, in the sense of the angle about its edge: the normal of a panel that passes the edge
/// forwards points to larger angles.
const fn opens(side: &Side) -> bool {
    !side.is_forward
}

/// The sides of an edge in the order of the angle about it; of those at one angle, first the ones where the inside ends.
fn around(mesh: &Mesh, edge: &[Side]) -> Vec<Side> {
    if edge.len() < 3 {
        return edge.to_vec();
    }
    let (low, high) = edge[0].edge;
    let [from, to] = [low, high].map(|v| mesh.vertices[v as usize]);
    let along = scale(sub(to, from), 1.0 / norm(sub(to, from)));
    let across = |side: &Side| {
        let panel = mesh.panels[side.panel as usize];
        let n = panel.corners().len() as f64;
        let middle = sub(scale(mesh.corners(panel).fold([0.0; 3], add), 1.0 / n), from);
        sub(middle, scale(along, dot(middle, along)))
    };
    let first = across(&edge[0]);
    let beside = cross(along, first);
    let angle = |side: &Side| {
        let to = across(side);
        let angle = dot(to, beside).atan2(dot(to, first));
        if angle < -FOLD_RAD { angle + TAU } else { angle }
    };
    let mut sorted: Vec<(f64, Side)> = edge.iter().map(|side| (angle(side), *side)).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    for at_one_angle in sorted.chunk_by_mut(|a, b| b.0 - a.0 < FOLD_RAD) {
        at_one_angle.sort_by_key(|(_, side)| opens(side));
    }
    sorted.into_iter().map(|(_, side)| side).collect()
}

/// The first two sides of which one opens, the other closes, and that belong together.
fn first_pair(sides: &[Side], mut belong: impl FnMut(&Side, &Side) -> bool) -> Option<(usize, usize)> {
    let pairs = (0..sides.len()).flat_map(|i| (i + 1..sides.len()).map(move |j| (i, j)));
    pairs.into_iter().find(|(i, j)| opens(&sides[*i]) != opens(&sides[*j]) && belong(&sides[*i], &sides[*j]))
}

/// Where the inside begins and where it ends; `None` if one is without the other.
fn brackets(sides: &[Side]) -> Option<Vec<[Side; 2]>> {
    let (mut depth, mut least, mut start) = (0, 0, 0);
    for (i, side) in sides.iter().enumerate() {
        depth += if opens(side) { 1 } else { -1 };
        if depth < least {
            (least, start) = (depth, i + 1);
        }
    }
    let (mut open, mut out) = (Vec::new(), Vec::new());
    for side in sides[start..].iter().chain(&sides[..start]) {
        if opens(side) {
            open.push(*side);
        } else {
            out.push([open.pop()?, *side]);
        }
    }
    open.is_empty().then_some(out)
}

/// What is wrong with a hull that is closed but for decks and bulkheads inside it.
#[must_use]
pub fn deck_trouble(mesh: &Mesh) -> Option<Trouble> {
    let decks = decks(mesh);
    let at = Facet::of(mesh, mesh.panels[*decks.first()?]).centroid.map(|x| (1e9 * x).round() / 1e9);
    let panels = counted(decks.len(), "panel lies", "panels lie");
    let words = format!(
        "{panels} inside the hull, which is closed without them, as a deck or a bulkhead is, the first at {at:?} m: no water reaches them; take them out"
    );
    Some(Trouble::new(Kind::Other, words))
}

/// Panels of decks and bulkheads: sheets inside a hull that is closed without them; none where that is not so.
pub(crate) fn decks(mesh: &Mesh) -> Vec<usize> {
    if !is_readable(mesh) || has_copies(mesh) {
        return Vec::new();
    }
    let sides = sides(mesh);
    let mut sheets = Groups::new(mesh.panels.len());
    let mut inner = Vec::new();
    for edge in by_edge(&sides) {
        if let [a, b] = edge {
            sheets.join(a.panel, b.panel);
        } else if edge.len() > 2 {
            let order = around(mesh, edge);
            let next = |i: usize| &order[(i + 1) % order.len()];
            for (i, side) in order.iter().enumerate() {
                // The outside lies between an end and a beginning; a panel that borders on none has the inside on both sides.
                if opens(side) && opens(next(i)) {
                    inner.push(next(i).panel);
                } else if !opens(side) && !opens(next(i)) {
                    inner.push(side.panel);
                }
            }
        }
    }
    let roots: IndexSet<u32> = inner.into_iter().map(|panel| sheets.of(panel)).collect();
    let (mut deck, mut hull): (Vec<usize>, Vec<usize>) =
        (0..mesh.panels.len()).partition(|panel| roots.contains(&sheets.of(*panel as u32)));
    // Sheets that touch nothing, all of their corners inside a closed part.
    let rest = only(mesh, &hull);
    let (closed, open): (Vec<Part>, Vec<Part>) = parts(&rest).into_iter().partition(|part| part.is_closed);
    let count = |parts: &[Part]| parts.iter().map(|part| part.panels.len()).sum::<usize>();
    if count(&open).saturating_mul(count(&closed)) > MOST_INSIDE {
        return Vec::new();
    }
    let is_inside = |part: &Part, corner: Vec3| winding(&rest, &part.panels, corner) > 0.5;
    let mut loose: IndexSet<usize> = IndexSet::new();
    for sheet in &open {
        let mut corners = sheet.panels.iter().flat_map(|p| rest.corners(rest.panels[*p]));
        if corners.all(|corner| closed.iter().any(|part| is_inside(part, corner))) {
            loose.extend(sheet.panels.iter().map(|p| hull[*p]));
        }
    }
    hull.retain(|panel| !loose.contains(panel));
    deck.extend(loose);
    deck.sort_unstable();
    let is_hull = !hull.is_empty() && is_closed(&only(mesh, &hull)) && volume(mesh, &hull) > 0.0;
    if is_hull { deck } else { Vec::new() }
}

/// Whether two panels have the same corners: these lie on the hull and not inside.
fn has_copies(mesh: &Mesh) -> bool {
    let mut seen = IndexSet::new();
    mesh.panels.iter().any(|panel| {
        let mut key = panel.corners().to_vec();
        key.sort_unstable();
        !seen.insert(key)
    })
}

/// Some panels of a mesh, with their vertices and no others.
fn only(mesh: &Mesh, panels: &[usize]) -> Mesh {
    let panels = panels.iter().map(|p| mesh.panels[*p]).collect();
    let mut out = Mesh { vertices: mesh.vertices.clone(), panels };
    out.drop_unused_vertices();
    out
}
