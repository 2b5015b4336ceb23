//! The two limits of the water's surface beside unbounded water, and which of them a motion is near.
//!
//! Sources: Newman 1977, ch. 6 (ω²d/g); Faltinsen & Timokha 2009, ch. 4 (sloshing).

use froude_hydro::similarity::GRAVITY_M_S2;
use froude_hydro::sloshing::rectangular_tank_modes_rad_s;
use froude_mesh::Mesh;
use froude_records::block::{ResultTable, TableBuilder};
use froude_records::finding::{Finding, Severity};
use froude_records::number;

use super::record::{diagonal_name, unit};
use crate::outcome::Case;
use crate::uncertain::{signed_percent, told};

/// ω²d/g below which the lid, and above which φ = 0, is a fair picture.
const SLOW: f64 = 0.1;
const FAST: f64 = 10.0;

/// Diagonals side by side; `None` with one case.
#[must_use]
pub fn table(cases: &[Case], density_kg_m3: f64) -> Option<ResultTable> {
    let (first, others) = cases.split_first().filter(|(_, others)| !others.is_empty())?;
    let of = |case: &Case, i: usize| case.refined.value[i][i];
    let caption = "Zero- and infinite-frequency limits of the water's surface. They are not bounds: at frequencies between them, waves (in a tank, sloshing) may give values outside.";
    let t = TableBuilder::new("limits", caption, &[0, 1, 2, 3, 4, 5]);
    let mass = |case, head| t.number(Case::key(case), head, |i| density_kg_m3 * of(case, *i)).plain(6);
    let mut columns = vec![
        t.text("entry", "entry", |i| diagonal_name(*i)),
        t.text("unit", "", |i| unit(*i, *i).to_owned()),
        mass(first, "unbounded [kg, kg m²]"),
    ];
    for case in others {
        columns.push(mass(case, &case.title));
        let change = |i: &usize| of(case, *i) / of(first, *i) - 1.0;
        columns.extend(told(&t, &format!("change/{}", case.key()), "change", change, signed_percent));
    }
    Some(t.build(columns))
}

/// How far the body is from walls, bottom and surface: correction of a test depends on it.
#[must_use]
pub fn clearance(mesh: &Mesh, [length_m, breadth_m, depth_m]: [f64; 3], surface_m: f64) -> Finding {
    let side = |axis: usize| {
        let values = mesh.vertices.iter().map(|v| v[axis]);
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)))
    };
    let [(x_low, x_high), (y_low, y_high), (z_low, z_high)] = [side(0), side(1), side(2)];
    let m = |x: f64| number::plain(x, 3);
    Finding::new(
        Severity::Note,
        "tank-clearance",
        format!(
            "the origin of the mesh lies in the middle of the tank's plan; from the body it is {} and {} m to the ends (−x, +x), {} and {} m to \
             the sides (−y, +y), {} m to the bottom and {} m to the surface",
            m(x_low + 0.5 * length_m),
            m(0.5 * length_m - x_high),
            m(y_low + 0.5 * breadth_m),
            m(0.5 * breadth_m - y_high),
            m(z_low - surface_m + depth_m),
            m(surface_m - z_high)
        ),
    )
}

/// Where each limit holds.
#[must_use]
pub fn words(depth_m: Option<f64>, tank_m: Option<[f64; 3]>) -> Vec<String> {
    let Some(depth_m) = depth_m.filter(|d| *d > 0.0) else { return Vec::new() };
    let at = |number: f64| (number * GRAVITY_M_S2 / depth_m).sqrt();
    let mut out = vec![format!(
        "With d = {} m of water over the body's centre of buoyancy, ω²d/g is {SLOW} at {:.2} rad/s ({:.2} Hz): slower motions are near the rigid lid; it \
         is {FAST} at {:.2} rad/s ({:.2} Hz): faster ones are near φ = 0.",
        number::plain(depth_m, 3),
        at(SLOW),
        at(SLOW) / core::f64::consts::TAU,
        at(FAST),
        at(FAST) / core::f64::consts::TAU,
    )];
    if let Some([l, b, d]) = tank_m
        && let Ok([along, across]) = rectangular_tank_modes_rad_s(l, b, d, GRAVITY_M_S2)
    {
        out.push(format!(
            "The tank's first sloshing modes are {along:.2} rad/s ({:.2} Hz) along and {across:.2} rad/s ({:.2} Hz) across: near them neither \
             limit holds; well below the first the lid does, well above all that the motion excites φ = 0.",
            along / core::f64::consts::TAU,
            across / core::f64::consts::TAU,
        ));
    }
    out
}
