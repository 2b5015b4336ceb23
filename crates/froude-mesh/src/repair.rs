//! Repairs that change no shape, each reported: vertices merged, panels without area, copies and decks taken out, panels turned.
//!
//! Holes are not closed, and what cannot be known is not decided: the outside of an open surface, and of one inside another.
//!
//! **Orientation.** From panel to panel over the edges that have two of them; the greater number of panels stays. A closed surface is
//! turned outward when its volume is negative.

use indexmap::{IndexMap, IndexSet};

use crate::check::{extent, first_unreadable, has_no_area};
use crate::files::soup::counted;
use crate::mesh::{Mesh, Panel};
use crate::parts::{holders, parts, volume};
use crate::solids::decks;
use crate::topology::{by_edge, sides};
use crate::vector::{Vec3, norm, sub};

/// A mesh repaired, and in words all that was done to it, and what was not decided.
///
/// Vertices not farther than `weld_m` from an earlier one become that one; 0 merges those that are the same. Panels keep their order.
#[must_use]
pub fn repaired(mesh: &Mesh, weld_m: f64) -> (Mesh, Vec<String>) {
    if let Some(trouble) = first_unreadable(mesh) {
        return (mesh.clone(), vec![format!("nothing repaired: {trouble}")]);
    }
    let mut reported = Vec::new();
    let mut out = welded(mesh, weld_m, &mut reported);
    take_out(&mut out, &mut reported);
    take_out_decks(&mut out, &mut reported);
    let count = out.drop_unused_vertices();
    if count > 0 {
        reported
            .push(format!("{} taken out", counted(count, "vertex that no panel uses", "vertices that no panel uses")));
    }
    orient(&mut out, &mut reported);
    (out, reported)
}

/// The mesh with all panels turned, if each of its parts is closed and inside out: then there is no doubt about its outside.
#[must_use]
pub fn turned_outward(mesh: &Mesh) -> Option<Mesh> {
    let parts = parts(mesh);
    let is_inside_out = !parts.is_empty() && parts.iter().all(|part| part.is_closed && part.volume_m3 < 0.0);
    let panels = || mesh.panels.iter().map(Panel::turned).collect();
    is_inside_out.then(|| Mesh { vertices: mesh.vertices.clone(), panels: panels() })
}

fn corner(mesh: &Mesh, panel: usize) -> Vec3 {
    mesh.vertices[mesh.panels[panel].corners()[0] as usize]
}

/// Vertices closer than this part of the extent are one where no length is given \[-\]: above the rounding of any file, far below any panel.
pub const WELD: f64 = 1e-6;

/// The mesh of a file with the vertices merged that lie within [`WELD`] of its extent, and a sentence for each change.
///
/// Programs write the same corner twice, once for each panel or with other rounding; unmerged, its panels would be neighbours of none.
/// Panels that this leaves with fewer than three corners have no area and are removed. A mesh with unreadable vertices stays as it is.
#[must_use]
pub fn merged(mesh: Mesh) -> (Mesh, Vec<String>) {
    if first_unreadable(&mesh).is_some() {
        return (mesh, Vec::new());
    }
    let mut reported = Vec::new();
    let mut out = welded(&mesh, WELD * extent(&mesh), &mut reported);
    let collapsed = |panel: &Panel| {
        let mut corners = panel.corners().to_vec();
        corners.sort_unstable();
        corners.dedup();
        corners.len() < 3
    };
    let first = out.panels.iter().position(collapsed);
    if let Some(first) = first {
        let (before, at) = (out.panels.len(), corner(&out, first));
        out.panels.retain(|panel| !collapsed(panel));
        reported.push(without_area(before - out.panels.len(), at));
    }
    (out, reported)
}

/// Cells of the grid over the tolerance: a vertex then rarely lies so near a side that a second cell must be searched.
const CELLS: f64 = 16.0;

/// Each vertex becomes the first one within `weld_m` of it, found by a grid of cells.
fn welded(mesh: &Mesh, weld_m: f64, reported: &mut Vec<String>) -> Mesh {
    let weld_m = if weld_m.is_finite() { weld_m.max(0.0) } else { 0.0 };
    let low = |axis: usize| mesh.vertices.iter().map(|v| v[axis]).fold(f64::INFINITY, f64::min);
    let low = [low(0), low(1), low(2)];
    // Cells that are too small would not be counted by whole numbers.
    let cell = (CELLS * weld_m).max(1e-12 * extent(mesh)).max(f64::MIN_POSITIVE);
    let cells_of = |v: Vec3, offset_m: f64| [0, 1, 2].map(|i| ((v[i] + offset_m - low[i]) / cell).floor() as i64);
    let mut grid: IndexMap<[i64; 3], Vec<u32>> = IndexMap::new();
    let mut out = Mesh::default();
    let mut first = None;
    let mut numbers = Vec::with_capacity(mesh.vertices.len());
    for &vertex in &mesh.vertices {
        let (from, to) = (cells_of(vertex, -weld_m), cells_of(vertex, weld_m));
        let around = (from[0]..=to[0])
            .flat_map(|i| (from[1]..=to[1]).flat_map(move |j| (from[2]..=to[2]).map(move |k| [i, j, k])));
        let near = around
            .filter_map(|cell| grid.get(&cell))
            .flatten()
            .copied()
            .find(|kept| norm(sub(out.vertices[*kept as usize], vertex)) <= weld_m);
        let number = near.unwrap_or(out.vertices.len() as u32);
        if near.is_some() {
            first.get_or_insert(vertex);
        } else {
            out.vertices.push(vertex);
            grid.entry(cells_of(vertex, 0.0)).or_default().push(number);
        }
        numbers.push(number);
    }
    let renumbered = |panel: &Panel| match *panel.corners() {
        [a, b, c] => Panel::triangle(numbers[a as usize], numbers[b as usize], numbers[c as usize]),
        [a, b, c, d] => {
            let [a, b, c, d] = [a, b, c, d].map(|v| numbers[v as usize]);
            Panel::quad(a, b, c, d)
        }
        _ => *panel,
    };
    out.panels = mesh.panels.iter().map(renumbered).collect();
    let count = mesh.vertices.len() - out.vertices.len();
    if let Some(at) = first {
        let vertices = counted(count, "vertex", "vertices");
        reported.push(format!("{vertices} merged (closer than {weld_m} m), first at {at:?} m"));
    }
    out
}

fn without_area(count: usize, at: Vec3) -> String {
    format!("{} without area taken out, first at {at:?} m", counted(count, "panel", "panels"))
}

/// Takes out panels without area, and the later of two over the same corners.
fn take_out(mesh: &mut Mesh, reported: &mut Vec<String>) {
    let extent = extent(mesh);
    let mut seen = IndexSet::new();
    let (mut empty, mut copies) = ((0, None), (0, None));
    let mut panels = Vec::with_capacity(mesh.panels.len());
    for (number, panel) in mesh.panels.iter().enumerate() {
        let mut key = panel.corners().to_vec();
        key.sort_unstable();
        let gone = if has_no_area(mesh, *panel, extent) {
            &mut empty
        } else if seen.insert(key) {
            panels.push(*panel);
            continue;
        } else {
            &mut copies
        };
        gone.0 += 1;
        gone.1.get_or_insert_with(|| corner(mesh, number));
    }
    if let (count, Some(at)) = empty {
        reported.push(without_area(count, at));
    }
    if let (count, Some(at)) = copies {
        let copies = counted(count, "copy of a panel", "copies of panels");
        reported.push(format!("{copies} taken out, first at {at:?} m"));
    }
    mesh.panels = panels;
}

/// Takes out what lies inside a hull that is closed without it.
fn take_out_decks(mesh: &mut Mesh, reported: &mut Vec<String>) {
    let decks: IndexSet<usize> = decks(mesh).into_iter().collect();
    let Some(first) = decks.first() else { return };
    let (panels, at) = (counted(decks.len(), "panel", "panels"), corner(mesh, *first));
    reported.push(format!("{panels} inside the closed hull taken out (decks or bulkheads), first at {at:?} m"));
    let mut number = 0..;
    mesh.panels.retain(|_| !number.next().is_some_and(|n| decks.contains(&n)));
}

/// A piece of surface that hangs together over edges of two panels.
struct Sheet {
    panels: Vec<usize>,
    is_two_sided: bool,
    is_closed: bool,
}

fn orient(mesh: &mut Mesh, reported: &mut Vec<String>) {
    let (sheets, mut turned) = sheets(mesh);
    let at = |mesh: &Mesh, sheet: &Sheet| corner(mesh, sheet.panels[0]);
    for sheet in &sheets {
        let count = sheet.panels.iter().filter(|p| turned[**p]).count();
        if !sheet.is_two_sided {
            sheet.panels.iter().for_each(|p| turned[*p] = false);
            let (panels, at) = (sheet.panels.len(), at(mesh, sheet));
            reported.push(format!(
                "not oriented: {panels} panels at {at:?} m cannot be oriented (a surface with one side); they are left unchanged"
            ));
        } else if 2 * count > sheet.panels.len() {
            sheet.panels.iter().for_each(|p| turned[*p] = !turned[*p]);
        }
    }
    let which: Vec<usize> = (0..turned.len()).filter(|p| turned[*p]).collect();
    if let Some(first) = which.first() {
        let (panels, at) = (counted(which.len(), "panel", "panels"), corner(mesh, *first));
        reported.push(format!("{panels} turned to match most of their neighbours, first at {at:?} m"));
    }
    for p in &which {
        mesh.panels[*p] = mesh.panels[*p].turned();
    }

    let closed: Vec<Option<&[usize]>> =
        sheets.iter().map(|s| (s.is_two_sided && s.is_closed).then_some(s.panels.as_slice())).collect();
    let holders = holders(mesh, &closed);
    for (sheet, holder) in sheets.iter().zip(&holders) {
        let (panels, at) = (sheet.panels.len(), at(mesh, sheet));
        if !sheet.is_two_sided {
            continue;
        }
        if !sheet.is_closed {
            reported.push(format!(
                "not decided: the outside of {panels} panels at {at:?} m, which are open; most of them keep their side"
            ));
            continue;
        }
        let volume_m3 = volume(mesh, &sheet.panels);
        if let Some(outer) = holder {
            let outer = corner(mesh, sheets[*outer].panels[0]);
            reported.push(format!(
                "not decided: {panels} panels at {at:?} m, volume {volume_m3:.4e} m³, lie inside the surface at {outer:?} m; take out the one that the water does not touch"
            ));
        } else if volume_m3 < 0.0 {
            sheet.panels.iter().for_each(|p| mesh.panels[*p] = mesh.panels[*p].turned());
            reported.push(format!("{panels} panels turned outward, at {at:?} m: they enclosed {volume_m3:.4e} m³"));
        }
    }
}

/// The sheets, and for each panel whether it must be turned to run as the first of its sheet.
fn sheets(mesh: &Mesh) -> (Vec<Sheet>, Vec<bool>) {
    let count = mesh.panels.len();
    let sides = sides(mesh);
    // Over each corner's edge: the neighbour, and whether it runs the other way than it should.
    let mut over: Vec<[Option<(u32, bool)>; 4]> = vec![[None; 4]; count];
    for edge in by_edge(&sides) {
        if let [a, b] = edge
            && a.panel != b.panel
        {
            let is_against = a.is_forward == b.is_forward;
            over[a.panel as usize][usize::from(a.corner)] = Some((b.panel, is_against));
            over[b.panel as usize][usize::from(b.corner)] = Some((a.panel, is_against));
        }
    }
    let mut turned = vec![false; count];
    let mut sheet_of = vec![usize::MAX; count];
    let mut out: Vec<Sheet> = Vec::new();
    for first in 0..count {
        if sheet_of[first] != usize::MAX {
            continue;
        }
        let number = out.len();
        let mut sheet = Sheet { panels: Vec::new(), is_two_sided: true, is_closed: true };
        sheet_of[first] = number;
        let mut next = vec![first];
        while let Some(panel) = next.pop() {
            sheet.panels.push(panel);
            for (neighbour, is_against) in over[panel].iter().flatten() {
                let neighbour = *neighbour as usize;
                let turn = turned[panel] != *is_against;
                if sheet_of[neighbour] == usize::MAX {
                    sheet_of[neighbour] = number;
                    turned[neighbour] = turn;
                    next.push(neighbour);
                } else if turned[neighbour] != turn {
                    sheet.is_two_sided = false;
                }
            }
        }
        sheet.panels.sort_unstable();
        out.push(sheet);
    }
    // At an edge of more panels, two of one sheet that pass it each way close that sheet there.
    for edge in by_edge(&sides) {
        let way = |side: &crate::topology::Side| if side.is_forward == turned[side.panel as usize] { -1 } else { 1 };
        for side in edge {
            let number = sheet_of[side.panel as usize];
            let of_sheet = edge.iter().filter(|s| sheet_of[s.panel as usize] == number);
            let (there, sum) = of_sheet.fold((0, 0), |(n, sum), s| (n + 1, sum + way(s)));
            out[number].is_closed &= there == 2 && sum == 0;
        }
    }
    (out, turned)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::check::check;
    use crate::files::{read, write_stl_binary};
    use crate::measure::Measure;
    use crate::sections::{Resolution, SectionBody};

    fn ball(x_m: f64, radius_m: f64) -> Mesh {
        let mesh = SectionBody::ellipsoid([radius_m; 3], 2).mesh(Resolution { along: 2, around: 8 }).unwrap().mesh;
        mesh.mapped(|[x, y, z]| [x + x_m, y, z])
    }

    /// Each panel with vertices of its own.
    fn torn(mesh: &Mesh) -> Mesh {
        let mut out = Mesh::default();
        for panel in &mesh.panels {
            let first = out.vertices.len() as u32;
            out.vertices.extend(mesh.corners(*panel));
            out.panels.push(match panel.corners().len() {
                3 => Panel::triangle(first, first + 1, first + 2),
                _ => Panel::quad(first, first + 1, first + 2, first + 3),
            });
        }
        out
    }

    #[test]
    fn a_good_mesh_stays_as_it_is() {
        let mesh = ball(0.0, 1.0);
        assert_eq!(repaired(&mesh, 1e-6), (mesh, Vec::new()));
    }

    #[test]
    fn every_repair_is_reported() {
        let mut mesh = ball(0.0, 1.0);
        mesh.vertices.push([-1.0, 5e-7, 0.0]);
        let extra = mesh.vertices.len() as u32 - 1;
        let first = *mesh.panels[0].corners().first().unwrap();
        assert_eq!(mesh.vertices[first as usize], [-1.0, 0.0, 0.0]);
        mesh.panels[0] = mesh.panels[0].renumbered(|v| if v == first { extra } else { v });
        mesh.panels.push(mesh.panels[20]);
        mesh.panels.push(Panel::triangle(0, 1, 0));
        mesh.panels[30] = mesh.panels[30].turned();
        mesh.vertices.push([9.0, 9.0, 9.0]);
        let (out, repairs) = repaired(&mesh, 1e-6);
        assert_eq!(check(&out), []);
        let at = |v: Vec3| format!("{v:?} m");
        let [copied, turned] = [20, 30].map(|p| at(mesh.corners(mesh.panels[p]).next().unwrap()));
        let expected = [
            "1 vertex merged (closer than 0.000001 m), first at [-1.0, 5e-7, 0.0] m".to_owned(),
            "1 panel without area taken out, first at [-1.0, 0.0, 0.0] m".to_owned(),
            format!("1 copy of a panel taken out, first at {copied}"),
            "1 vertex that no panel uses taken out".to_owned(),
            format!("1 panel turned to match most of their neighbours, first at {turned}"),
        ];
        assert_eq!(repairs, expected);
    }

    #[test]
    fn surfaces_that_are_inside_out_are_turned_and_nested_ones_are_not() {
        let mut mesh = ball(0.0, 1.0).with(&ball(3.0, 0.5));
        mesh.panels.iter_mut().for_each(|p| *p = p.turned());
        let (out, repairs) = repaired(&mesh, 0.0);
        assert!((Measure::of(&out).volume_m3 + Measure::of(&mesh).volume_m3).abs() < 1e-12);
        assert_eq!(repairs[1], "64 panels turned outward, at [2.5, 0.0, 0.0] m: they enclosed -4.5346e-1 m³");

        let nested = ball(0.0, 1.0).with(&ball(0.0, 0.5));
        let (out, repairs) = repaired(&nested, 0.0);
        assert_eq!(out, nested);
        let sentence = "not decided: 64 panels at [-0.5, 0.0, 0.0] m, volume 4.5346e-1 m³, lie inside the surface at [-1.0, 0.0, 0.0] m; \
                        take out the one that the water does not touch";
        assert_eq!(repairs, [sentence]);
    }

    #[test]
    fn holes_stay_open_and_one_sided_surfaces_stay() {
        let mut open = ball(0.0, 1.0);
        open.panels.remove(0);
        let (out, repairs) = repaired(&open, 1e-6);
        assert_eq!(out, open);
        assert!(repairs[0].starts_with("not decided: the outside of 63 panels"), "{repairs:?}");

        // A band of quadrilaterals, joined with half a turn.
        let vertices = (0..16).map(|i| {
            let (s, c) = (f64::from(i / 2) * core::f64::consts::TAU / 8.0).sin_cos();
            let (half_s, half_c) = (f64::from(i / 2) * core::f64::consts::PI / 8.0).sin_cos();
            let w = 0.3 * f64::from(i % 2 * 2 - 1);
            [(1.0 + w * half_c) * c, (1.0 + w * half_c) * s, w * half_s]
        });
        let quad = |i: u32| {
            let [a, b] = [2 * i, 2 * i + 1];
            let [c, d] = if i == 7 { [0, 1] } else { [2 * i + 3, 2 * i + 2] };
            Panel::quad(a, b, c, d)
        };
        let band = Mesh { vertices: vertices.collect(), panels: (0..8).map(quad).collect() };
        let (out, repairs) = repaired(&band, 0.0);
        assert_eq!(out.panels, band.panels);
        assert!(repairs[0].starts_with("not oriented: 8 panels"), "{repairs:?}");
    }

    #[test]
    fn bodies_that_touch_along_an_edge_are_two_closed_surfaces() {
        let box_at = |x: f64, z: f64| {
            let body = SectionBody::flat_cylinder(0.5, 0.5, 0.5, [1, 1]);
            let turn = core::f64::consts::FRAC_1_SQRT_2;
            let mesh = body.mesh(Resolution { along: 1, around: 4 }).unwrap().mesh;
            mesh.mapped(|[a, b, c]| [a, x + turn * (b - c), z + turn * (b + c)])
        };
        let half = 0.5 * core::f64::consts::SQRT_2;
        let mesh = box_at(0.0, 0.0).with(&box_at(half, half));
        let (out, repairs) = repaired(&mesh, 1e-9);
        assert_eq!(repairs.len(), 1, "{repairs:?}");
        assert!((Measure::of(&out).volume_m3 - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_torn_mesh_through_a_file_is_whole_again() {
        let mesh = ball(0.3, 1.0);
        let stl = read("a.stl", &write_stl_binary(&torn(&mesh))).unwrap().mesh;
        let (out, repairs) = repaired(&torn(&stl), 1e-6);
        assert_eq!((check(&out), repairs.len()), (Vec::new(), 1));
    }

    proptest! {
        /// Torn apart, shaken within a third of the tolerance, with panels turned at random: the same body comes out.
        #[test]
        fn a_shaken_and_turned_body_comes_back(turns in prop::collection::vec(any::<bool>(), 64), shift in -0.3..0.3_f64) {
            let mesh = ball(0.0, 1.0);
            let mut broken = torn(&mesh);
            for (i, v) in broken.vertices.iter_mut().enumerate() {
                v[i % 3] += shift * 1e-4 * f64::from((i * 7919 % 101) as u32) / 101.0;
            }
            for (panel, turn) in broken.panels.iter_mut().zip(turns) {
                if turn {
                    *panel = panel.turned();
                }
            }
            let (out, _) = repaired(&broken, 1e-4);
            prop_assert_eq!(check(&out), []);
            prop_assert_eq!(out.vertices.len(), mesh.vertices.len());
            prop_assert!((Measure::of(&out).volume_m3 - Measure::of(&mesh).volume_m3).abs() < 1e-3);
        }
    }
}
