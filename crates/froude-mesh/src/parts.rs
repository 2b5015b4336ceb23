//! Connected parts of a mesh (joined by edges), which of them is inside out, and which lies inside another.
//!
//! [`mod@crate::check`] looks at the whole: a small part that is inside out disappears in the volume of a large one. Here each part is on
//! its own.

use crate::check::{Kind, Trouble, is_readable};
use crate::mesh::Mesh;
use crate::panel::halves;
use crate::topology::{Groups, by_edge, sides};
use crate::vector::{Vec3, cross, dot, norm, sub};

/// Panels that hang together over edges.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Their numbers, increasing.
    pub panels: Vec<usize>,
    /// Whether each of their edges is passed once each way.
    pub is_closed: bool,
    /// Volume that they enclose, m³; negative when inside out, without meaning when open.
    pub volume_m3: f64,
    /// First corner of the first panel, m.
    pub at: Vec3,
}

/// The parts of a mesh, by the number of their first panel; none for a mesh with coordinates or corners that are none.
#[must_use]
pub fn parts(mesh: &Mesh) -> Vec<Part> {
    if !is_readable(mesh) {
        return Vec::new();
    }
    let count = mesh.panels.len();
    let mut groups = Groups::new(count);
    let mut is_tight = vec![true; count];
    let sides = sides(mesh);
    for edge in by_edge(&sides) {
        let is_passed_each_way = edge.len() == 2 && edge[0].is_forward != edge[1].is_forward;
        for side in edge {
            groups.join(edge[0].panel, side.panel);
            is_tight[side.panel as usize] &= is_passed_each_way;
        }
    }
    let mut number_of = vec![None; count];
    let mut out: Vec<Part> = Vec::new();
    for panel in 0..count {
        let number = *number_of[groups.of(panel as u32) as usize].get_or_insert_with(|| {
            let at = mesh.vertices[mesh.panels[panel].corners()[0] as usize];
            out.push(Part { panels: Vec::new(), is_closed: true, volume_m3: 0.0, at });
            out.len() - 1
        });
        out[number].panels.push(panel);
        out[number].is_closed &= is_tight[panel];
    }
    for part in &mut out {
        part.volume_m3 = volume(mesh, &part.panels);
    }
    out
}

/// Parts that are inside out although others are not, and parts inside others.
#[must_use]
pub fn part_troubles(mesh: &Mesh) -> Vec<Trouble> {
    let parts = parts(mesh);
    let holders = holders(mesh, &parts.iter().map(|p| p.is_closed.then_some(p.panels.as_slice())).collect::<Vec<_>>());
    let has_right_one = parts.iter().any(|p| p.is_closed && p.volume_m3 > 0.0);
    let mut out = Vec::new();
    for (number, (part, holder)) in parts.iter().zip(holders).enumerate() {
        let (panels, at, volume_m3) = (part.panels.len(), part.at, part.volume_m3);
        if let Some(outer) = holder {
            let words = format!(
                "part {number} ({panels} panels, at {at:?} m, volume {volume_m3:.4e} m³) lies inside part {outer}: no water reaches it; take it out"
            );
            out.push(Trouble::new(Kind::Nested, words));
        } else if part.is_closed && has_right_one && part.volume_m3 < 0.0 {
            let words = format!(
                "part {number} ({panels} panels, at {at:?} m) is inside out (its volume is {volume_m3:.4e} m³), others are not; turn its panels"
            );
            out.push(Trouble::new(Kind::Other, words));
        }
    }
    out
}

/// Signed volume of some panels, m³, taken about a corner of theirs so that far from the origin no digit is lost.
pub(crate) fn volume(mesh: &Mesh, panels: &[usize]) -> f64 {
    let Some(first) = panels.first() else { return 0.0 };
    let origin = mesh.vertices[mesh.panels[*first].corners()[0] as usize];
    let triangles = panels.iter().flat_map(|panel| halves(mesh, mesh.panels[*panel]));
    let point = |v: u32| sub(mesh.vertices[v as usize], origin);
    triangles.map(|t| dot(point(t[0]), cross(point(t[1]), point(t[2]))) / 6.0).sum()
}

/// For each closed surface the one that it lies in, if any: the smallest.
pub(crate) fn holders(mesh: &Mesh, closed: &[Option<&[usize]>]) -> Vec<Option<usize>> {
    let boxes: Vec<Option<[Vec3; 2]>> = closed.iter().map(|panels| panels.map(|p| bounds(mesh, p))).collect();
    let mut by_size: Vec<usize> = (0..closed.len()).filter(|i| closed[*i].is_some()).collect();
    let size = |i: usize| boxes[i].map_or(0.0, |[low, high]| norm(sub(high, low)));
    by_size.sort_by(|a, b| size(*a).total_cmp(&size(*b)));
    let is_inside = |inner: usize, outer: usize| {
        let (Some([low, high]), Some([outer_low, outer_high])) = (boxes[inner], boxes[outer]) else { return false };
        let is_boxed = (0..3).all(|i| outer_low[i] <= low[i] && high[i] <= outer_high[i]);
        let (Some(panels), Some(around)) = (closed[inner], closed[outer]) else { return false };
        let Some(first) = panels.first() else { return false };
        is_boxed && winding(mesh, around, mesh.vertices[mesh.panels[*first].corners()[0] as usize]).abs() > 0.5
    };
    (0..closed.len())
        .map(|inner| by_size.iter().copied().find(|outer| *outer != inner && is_inside(inner, *outer)))
        .collect()
}

fn bounds(mesh: &Mesh, panels: &[usize]) -> [Vec3; 2] {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    for corner in panels.iter().flat_map(|panel| mesh.corners(mesh.panels[*panel])) {
        for i in 0..3 {
            low[i] = low[i].min(corner[i]);
            high[i] = high[i].max(corner[i]);
        }
    }
    [low, high]
}

/// How often a surface goes around a point: its solid angle there over 4π (Van Oosterom and Strackee 1983).
pub(crate) fn winding(mesh: &Mesh, panels: &[usize], at: Vec3) -> f64 {
    let angle = |t: [u32; 3]| {
        let [a, b, c] = t.map(|v| sub(mesh.vertices[v as usize], at));
        let (la, lb, lc) = (norm(a), norm(b), norm(c));
        let below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
        2.0 * dot(a, cross(b, c)).atan2(below)
    };
    let triangles = panels.iter().flat_map(|panel| halves(mesh, mesh.panels[*panel]));
    triangles.map(angle).sum::<f64>() / (4.0 * core::f64::consts::PI)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::check::check;
    use crate::sections::{Resolution, SectionBody};

    fn ball(x_m: f64, radius_m: f64) -> Mesh {
        let mesh = SectionBody::ellipsoid([radius_m; 3], 2).mesh(Resolution { along: 2, around: 8 }).unwrap().mesh;
        mesh.mapped(|[x, y, z]| [x + x_m, y, z])
    }

    fn inside_out(mut mesh: Mesh) -> Mesh {
        mesh.panels.iter_mut().for_each(|p| *p = p.turned());
        mesh
    }

    #[test]
    fn each_part_has_its_panels_and_its_volume() {
        let mesh = ball(0.0, 1.0).with(&ball(3.0, 0.5));
        let parts = parts(&mesh);
        let n = mesh.panels.len() / 2;
        assert_eq!(
            parts.iter().map(|p| p.panels.clone()).collect::<Vec<_>>(),
            [(0..n).collect(), (n..2 * n).collect::<Vec<_>>()]
        );
        assert!(parts.iter().all(|p| p.is_closed));
        assert!((parts[0].volume_m3 / parts[1].volume_m3 - 8.0).abs() < 1e-12);
        assert_eq!(part_troubles(&mesh), []);
    }

    #[test]
    fn a_small_part_that_is_inside_out_is_reported_although_the_whole_has_a_volume() {
        let mesh = ball(0.0, 1.0).with(&inside_out(ball(3.0, 0.5)));
        assert_eq!(check(&mesh), []);
        let reported: Vec<String> = part_troubles(&mesh).iter().map(ToString::to_string).collect();
        assert_eq!(
            reported,
            [
                "part 1 (64 panels, at [2.5, 0.0, 0.0] m) is inside out (its volume is -4.5346e-1 m³), others are not; turn its panels"
            ]
        );
    }

    #[test]
    fn a_part_inside_another_is_reported() {
        let mesh = ball(0.1, 0.5).with(&ball(0.0, 1.0)).with(&ball(5.0, 0.2));
        let reported: Vec<String> = part_troubles(&mesh).iter().map(ToString::to_string).collect();
        assert_eq!(
            reported,
            [
                "part 0 (64 panels, at [-0.4, 0.0, 0.0] m, volume 4.5346e-1 m³) lies inside part 1: no water reaches it; take it out"
            ]
        );
    }
}
