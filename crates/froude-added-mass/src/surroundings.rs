//! What is around the body: unbounded water, and the limits of the water's surface above it.

use froude_mesh::Mesh;
use froude_mesh::check::extent;
use froude_mesh::plausible::crosses;
use froude_panel::mirror::{Kind, Mirror};
use froude_panel::refine::Placed;
use froude_panel::tank::{Surface, Tank};

use super::frame::Direction;
use super::options::Asked;
use crate::error::AddedMassError;

/// Distance from the water's surface that is none, as part of the body's extent.
const ROUNDING: f64 = 1e-9;

/// What is around the body in one case.
pub(super) struct Surrounding {
    pub(super) title: String,
    pub(super) words: String,
    pub(super) is_lid: Option<bool>,
    pub(super) mirrors: Vec<Mirror>,
    pub(super) tank: Option<Placed>,
}

/// The cases of a job; a body that the surface meets, or that lies above it, is refused.
pub(super) fn surroundings(job: &Asked, mesh: &Mesh) -> Result<Vec<Surrounding>, AddedMassError> {
    let deep = Surrounding {
        title: "Deeply submerged".to_owned(),
        words: "unbounded water".to_owned(),
        is_lid: None,
        mirrors: Vec::new(),
        tank: None,
    };
    let Some(surface_m) = job.surface_m else { return Ok(vec![deep]) };
    let up = job.orientation.unwrap_or_default().up();
    let (axis, at_m) = (up.axis, up.sign() * surface_m);
    let letter = ["x", "y", "z"][axis];
    let refuse = |why: String| Err(AddedMassError::input(&job.input, why));
    if let Some(crossing) = crosses(mesh, axis, at_m) {
        return refuse(format!(
            "{crossing}: the body pierces the water's surface; bodies that float are not computed here, submerge it"
        ));
    }
    let is_above = mesh.vertices.iter().any(|v| up.coordinate(*v) > surface_m);
    if is_above {
        return refuse(format!(
            "the body lies above the water's surface at {letter} = {at_m} m; give --surface the height of the surface over the origin of the mesh, \
             and --up the axis of the mesh that points up, as --up -z"
        ));
    }
    let slack_m = ROUNDING * extent(mesh);
    let touching = mesh.panels.iter().position(|p| mesh.corners(*p).all(|c| (c[axis] - at_m).abs() <= slack_m));
    if let Some(panel) = touching {
        return refuse(format!(
            "panel {panel} lies in the water's surface at {letter} = {at_m} m: bodies that float are not computed here, submerge it"
        ));
    }
    if job.tank_m.is_some() && up != Direction::Z {
        return refuse(format!(
            "in a tank the z axis of the mesh must point up, and here {up} does; export the mesh with z up"
        ));
    }
    let place = match job.tank_m {
        Some([l, b, d]) => {
            format!("tank {l} × {b} × {d} m (length, breadth, depth of water), surface {surface_m} m over the origin")
        }
        None => format!("water's surface {surface_m} m over the origin"),
    };
    let case = |title: &str, limit: &str, is_lid: bool, kind, surface| {
        let tank = job.tank_m.map(|[length_m, width_m, depth_m]| Placed {
            tank: Tank { length_m, width_m, depth_m },
            surface,
            over_origin_m: surface_m,
        });
        let mirrors = if tank.is_some() { Vec::new() } else { vec![Mirror { axis, at_m, kind }] };
        Surrounding { title: title.to_owned(), words: format!("{place}, {limit}"), is_lid: Some(is_lid), mirrors, tank }
    };
    Ok(vec![
        deep,
        case("Zero-frequency limit: rigid lid", "rigid: ω²d/g → 0", true, Kind::Wall, Surface::Lid),
        case("Infinite-frequency limit: φ = 0", "φ = 0 there: ω²d/g → ∞", false, Kind::FreeSurface, Surface::Free),
    ])
}
