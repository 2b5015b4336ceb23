//! The matrix beside what closed forms, strips and printed tables give for the same or a like body.

use crate::body_file::Shape;
use froude_hydro::ellipsoid::{ellipsoid_added_mass, ellipsoid_volume_m3};
use froude_hydro::strip::{Station, strip_added_mass};
use froude_hydro::tabulated::circular_cylinder_added_mass_m3;
use froude_mesh::{Mesh, Vec3};
use froude_panel::matrix::AddedMass;
use froude_panel::problem::Frame;
use froude_panel::refine::Refined;
use froude_records::block::{ResultTable, TableBuilder};
use froude_records::number;

use super::record::{diagonal_head, diagonal_key};

/// An ellipsoid in the body's box whose volume differs by more than this part is no yardstick.
const LIKE: f64 = 0.3;
/// Differences along x that count as one station, as part of the length.
const SAME: f64 = 1e-9;

/// The table; `None` where no closed form is like the body.
#[must_use]
pub fn table(
    shape: Option<&Shape>,
    mesh: &Mesh,
    refined: &Refined,
    density_kg_m3: f64,
    frame: &Frame,
) -> Option<ResultTable> {
    let mut rows: Vec<(String, [Option<f64>; 6])> =
        vec![("this result".to_owned(), core::array::from_fn(|i| Some(refined.value[i][i])))];
    let (low, high) = bounds(mesh);
    let half: Vec3 = core::array::from_fn(|a| 0.5 * (high[a] - low[a]));
    let centre: Vec3 = core::array::from_fn(|a| 0.5 * (high[a] + low[a]));
    let ellipsoid_m3 = ellipsoid_volume_m3(half);
    if let Ok(diagonal) = ellipsoid_added_mass(half)
        && (refined.volume_m3 / ellipsoid_m3 - 1.0).abs() < LIKE
    {
        let mut matrix = [[0.0; 6]; 6];
        (0..6).for_each(|i| matrix[i][i] = diagonal[i]);
        let moved = AddedMass { matrix, asymmetry: 0.0, frame: Frame::at(centre) }.seen_from(frame).matrix;
        let name = if matches!(shape, Some(Shape::Ellipsoid { .. })) {
            "ellipsoid, exact (Lamb)".to_owned()
        } else {
            let [length, breadth, height] = half.map(|h| number::plain(2.0 * h, 4));
            format!("ellipsoid in the same box, {length} × {breadth} × {height} m (Lamb)")
        };
        rows.push((name, core::array::from_fn(|i| Some(moved[i][i]))));
    }
    if shape.is_some()
        && let Ok(strips) = strip_added_mass(&stations(mesh))
    {
        let matrix = AddedMass { matrix: strips, asymmetry: 0.0, frame: Frame::at([0.0; 3]) }.seen_from(frame).matrix;
        let name = "strips of elliptic sections (Newman)".to_owned();
        rows.push((name, core::array::from_fn(|i| (i > 0).then_some(matrix[i][i]))));
    }
    if let Some(Shape::Cylinder { length_m, section }) = shape
        && section.major_m == section.minor_m
        && let Some(across) = circular_cylinder_added_mass_m3(section.major_m, *length_m)
    {
        let name = "circular cylinder (DNV-RP-C205)".to_owned();
        rows.push((name, [None, Some(across), Some(across), None, None, None]));
    }
    let caption = "Cross-checks in unbounded water. These are other bodies: the more the shape differs, the more the result may differ.";
    let t = TableBuilder::new("cross_checks", caption, &rows);
    let of = |i: usize| {
        t.number(&diagonal_key(i), &diagonal_head(i), move |(_, diagonal)| diagonal[i].map(|a| density_kg_m3 * a))
            .plain(5)
    };
    let columns = std::iter::once(t.text("body", "body", |(name, _)| name.clone())).chain((0..6).map(of));
    (rows.len() > 1).then(|| t.build(columns.collect()))
}

fn bounds(mesh: &Mesh) -> (Vec3, Vec3) {
    mesh.vertices.iter().fold(([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]), |(low, high), v| {
        (core::array::from_fn(|a| low[a].min(v[a])), core::array::from_fn(|a| high[a].max(v[a])))
    })
}

/// Sections of a body of sections: the widest at each x.
fn stations(mesh: &Mesh) -> Vec<Station> {
    let mut points = mesh.vertices.clone();
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let (low, high) = bounds(mesh);
    let mut out: Vec<Station> = Vec::new();
    for p in points {
        let is_new = out.last().is_none_or(|s| p[0] - s.x_m > SAME * (high[0] - low[0]));
        if is_new {
            out.push(Station { x_m: p[0], half_width_m: 0.0, half_height_m: 0.0 });
        }
        if let Some(s) = out.last_mut() {
            s.half_width_m = s.half_width_m.max(p[1].abs());
            s.half_height_m = s.half_height_m.max(p[2].abs());
        }
    }
    out
}
