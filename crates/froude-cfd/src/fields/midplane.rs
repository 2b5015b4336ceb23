//! Speeds of the water in the plane z = 0 through the body: its wake, in a slice of cells.
//!
//! A cell is cut where it has corners above the plane and others not above it. So a plane that coincides with faces, the plane of symmetry of a half domain above all, has the cells above it, each once.

use std::collections::BTreeMap;

use froude_mesh::vector::norm;

use crate::case::Case;
use crate::flow_field::FlowField;

/// Heights of so many lengths of the body are none: points of a plane are on it but for rounding.
const FLAT: f64 = 1e-9;

/// A slice.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Midplane {
    /// The cells that the plane cuts.
    pub cells: Vec<CutCell>,
    /// Where it cuts the body's surface: the two ends of each piece, (x, y) in m.
    pub body_m: Vec<[[f64; 2]; 2]>,
}

/// A cell that the plane cuts.
#[derive(Debug, Clone, PartialEq)]
pub struct CutCell {
    /// Corners of the cut in their order around it, (x, y) in m.
    pub corners_m: Vec<[f64; 2]>,
    /// Speed of the water in the cell over that of the inflow, |U|/U \[-\].
    pub speed_ratio: f64,
}

/// An edge of the mesh from one side of the plane to the other, by its points, the lower number first.
type Crossing = (u32, u32);

impl Midplane {
    /// Of a solved case.
    #[must_use]
    pub fn of(case: &Case, field: &FlowField) -> Self {
        let mesh = &field.mesh;
        let flat_m = FLAT * case.reference.length_m;
        let height_m = |point: u32| Some(mesh.points_m[point as usize][2]).filter(|z| z.abs() > flat_m).unwrap_or(0.0);
        let place_m = |(p, q): Crossing| {
            let (a, b) = (mesh.points_m[p as usize], mesh.points_m[q as usize]);
            let part = height_m(p) / (height_m(p) - height_m(q));
            [0, 1].map(|axis| a[axis] + part * (b[axis] - a[axis]))
        };
        let mut cells: BTreeMap<u32, Vec<Crossing>> = BTreeMap::new();
        let mut body_m = Vec::new();
        for (index, corners) in mesh.faces.iter().enumerate() {
            let edges = corners.iter().zip(corners.iter().cycle().skip(1));
            let crossings: Vec<Crossing> = edges
                .filter(|(p, q)| (height_m(**p) > 0.0) != (height_m(**q) > 0.0))
                .map(|(p, q)| (*p.min(q), *p.max(q)))
                .collect();
            if crossings.is_empty() {
                continue;
            }
            for cell in [mesh.owner.get(index), mesh.neighbour.get(index)].into_iter().flatten() {
                cells.entry(*cell).or_default().extend(&crossings);
            }
            let mut patches = mesh.patches.iter();
            let is_wall = patches.any(|p| p.is_wall() && (p.start..p.start + p.count).contains(&index));
            if let ([from, to], true) = (&crossings[..], is_wall) {
                let piece = [place_m(*from), place_m(*to)];
                body_m.extend(Some(piece).filter(|[a, b]| (a[0] - b[0]).hypot(a[1] - b[1]) > flat_m));
            }
        }
        let cut = |(cell, mut crossings): (u32, Vec<Crossing>)| {
            crossings.sort_unstable();
            crossings.dedup();
            let corners_m = around(crossings.into_iter().map(place_m).collect());
            // A cell that stands on the plane by an edge, as at the poles of an O-grid, is not cut.
            (area_m2(&corners_m) > flat_m * case.reference.length_m).then(|| CutCell {
                corners_m,
                speed_ratio: norm(field.velocity_m_s[cell as usize]) / case.flow.speed_m_s,
            })
        };
        Self { cells: cells.into_iter().filter_map(cut).collect(), body_m }
    }
}

/// Corners of a convex polygon in their order around it.
fn around(mut corners: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let count = corners.len() as f64;
    let middle = corners.iter().fold([0.0; 2], |sum, corner| [sum[0] + corner[0] / count, sum[1] + corner[1] / count]);
    corners.sort_by(|a, b| {
        let angle = |corner: &[f64; 2]| (corner[1] - middle[1]).atan2(corner[0] - middle[0]);
        angle(a).total_cmp(&angle(b))
    });
    corners
}

/// Positive of corners counter-clockwise.
fn area_m2(corners: &[[f64; 2]]) -> f64 {
    let pairs = corners.iter().zip(corners.iter().cycle().skip(1));
    0.5 * pairs.map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use froude_mesh::sections::SectionBody;

    use super::*;
    use crate::case::{Flow, Model, Reference, Stop, Water};
    use crate::o_grid::OGrid;
    use crate::surface_pressure::{facets, pressure_force_n};

    const SEMI_AXES_M: [f64; 3] = [0.5, 0.1, 0.2];
    const OUTER_M: f64 = 3.0;

    /// Water that moves as if no body were there, at a pressure of 1 m²/s² everywhere.
    fn undisturbed(is_half: bool) -> (Case, FlowField) {
        let around = if is_half { 10 } else { 20 };
        let grid = OGrid { stations: 30, layers: 12, around, first_layer_m: 0.01, outer_radius_m: OUTER_M, is_half };
        let (mesh, _) = grid.mesh(&SectionBody::ellipsoid(SEMI_AXES_M, 1)).unwrap();
        let case = Case {
            id: "c".to_owned(),
            configuration: "ellipsoid".to_owned(),
            mesh: "m".to_owned(),
            is_half,
            flow: Flow { speed_m_s: 0.5, angle_rad: 0.3, pitch_rad: 0.0 },
            water: Water { density_kg_m3: 1000.0, viscosity_m2_s: 1e-6 },
            model: Model::Laminar,
            stop: Stop { iterations: 400, window: 40, drift: 1e-4, spread: 1e-3 },
            reference: Reference { length_m: 1.0, width_m: 0.2, area_m2: 0.1, point_m: [0.0; 3] },
            start_from: None,
        };
        let velocity_m_s = vec![case.flow.velocity_m_s().map(|v| -v); mesh.cells];
        (case, FlowField { pressure_m2_s2: vec![1.0; mesh.cells], velocity_m_s, mesh, time: 1.0 })
    }

    /// A half and a whole domain have the same slice: the disc of the outer sphere less the body's section, but for what chords cut off.
    #[test]
    fn a_slice_covers_the_plane_once_and_its_water_is_undisturbed() {
        let slices = [true, false].map(|is_half| {
            let (case, field) = undisturbed(is_half);
            Midplane::of(&case, &field)
        });
        let areas = slices.clone().map(|slice| slice.cells.iter().map(|c| area_m2(&c.corners_m)).sum::<f64>());
        // Of n chords the area is 1 − (2π/n)²/6 of the circle's, at 60 a five-hundredth less.
        let disc_m2 = PI * (OUTER_M * OUTER_M - SEMI_AXES_M[0] * SEMI_AXES_M[1]);
        assert!((areas[0] / disc_m2 - 1.0).abs() < 4e-3, "{areas:?} {disc_m2}");
        assert!((areas[0] - areas[1]).abs() < 1e-9 * disc_m2, "{areas:?}");
        for slice in slices {
            assert_eq!((slice.cells.len(), slice.body_m.len()), (2 * 30 * 12, 2 * 30));
            assert!(slice.cells.iter().all(|cell| (cell.speed_ratio - 1.0).abs() < 1e-12));
            let on_ellipse = |[x, y]: [f64; 2]| (x / SEMI_AXES_M[0]).hypot(y / SEMI_AXES_M[1]);
            assert!(slice.body_m.iter().flatten().all(|p| (on_ellipse(*p) - 1.0).abs() < 1e-6));
        }
    }

    /// An even pressure pushes a closed surface nowhere.
    #[test]
    fn an_even_pressure_has_no_force_and_its_coefficient_everywhere() {
        for is_half in [true, false] {
            let (case, field) = undisturbed(is_half);
            let facets = facets(&case, &field);
            assert_eq!(facets.len(), 30 * 20);
            // 1 m²/s² over ½U² of 0.125 m²/s².
            assert!(facets.iter().all(|f| (f.pressure_coefficient - 8.0).abs() < 1e-12));
            let force_n = pressure_force_n(&case, &facets);
            assert!(norm(force_n) < 1e-9, "{force_n:?}");
        }
    }
}
