//! Pictures of the flow of a case: pressure on the surface from three sides, and the wake in the plane z = 0.
//!
//! Views are those of an eye: from port the nose is left, from starboard and from below it is right.

use froude_records::number::{degrees, fixed, plain};
use froude_records::page::{Field, Polygon, View};

use super::solved::Solved;
use crate::case::Case;
use crate::flow_field::FlowField;
use crate::midplane::{CutCell, Midplane};
use crate::surface_pressure::{Facet, facets, pressure_force_n};

/// Half the width and the height of the slice that is shown, in lengths of the body.
const WINDOW: [f64; 2] = [1.25, 0.75];
/// Of the largest extent of a view, left free around the body.
const MARGIN: f64 = 0.04;

/// Pictures of a case, with what they say in numbers.
#[derive(Debug)]
pub(super) struct Pictures {
    pub(super) surface: Field,
    pub(super) wake: Field,
    /// Least and largest.
    pub(super) pressure_coefficient: [f64; 2],
    pub(super) pressure_force_n: [f64; 3],
    pub(super) largest_speed_ratio: f64,
    pub(super) time: f64,
}

impl Pictures {
    /// Of a case; or why there are none.
    pub fn of(solved: &Solved) -> Result<Self, String> {
        let case = &solved.case;
        let field = FlowField::read(&solved.mesh, &solved.folder).map_err(|e| e.to_string())?;
        let facets = facets(case, &field);
        let slice = Midplane::of(case, &field);
        let pressure_coefficient = range(facets.iter().map(|f| f.pressure_coefficient));
        let [_, largest_speed_ratio] = range(slice.cells.iter().map(|c| c.speed_ratio));
        let setting = format!(
            "{}: U = {} m/s at {}, {}, iteration {}",
            case.id,
            plain(case.flow.speed_m_s, 3),
            degrees(case.flow.angle_rad),
            solved.outcome.status.word(),
            field.time
        );
        Ok(Self {
            surface: surface(case, &setting, &facets, pressure_coefficient),
            wake: wake(case, &setting, &slice),
            pressure_coefficient,
            pressure_force_n: pressure_force_n(case, &facets),
            largest_speed_ratio,
            time: field.time,
        })
    }

    pub fn fields(&self) -> [Field; 2] {
        [self.surface.clone(), self.wake.clone()]
    }
}

fn range(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(x), high.max(x)])
}

/// Where an eye looks from.
struct Eye {
    words: &'static str,
    /// Axis across the page, and whether it runs to the left.
    across: (usize, bool),
    /// Axis up the page, and whether it runs down.
    up: (usize, bool),
    /// Axis that it looks along, and its sign.
    along: (usize, f64),
}

const EYES: [Eye; 3] = [
    Eye { words: "from port", across: (0, true), up: (2, true), along: (1, 1.0) },
    Eye { words: "from starboard", across: (0, false), up: (2, true), along: (1, -1.0) },
    Eye { words: "from below", across: (0, false), up: (1, false), along: (2, -1.0) },
];

fn surface(case: &Case, setting: &str, facets: &[Facet], [low, high]: [f64; 2]) -> Field {
    let inflow = case.flow.velocity_m_s().map(|v| 0.0 - v);
    Field {
        name: format!("surface-{}", case.id),
        title: format!("Pressure on the surface of {}", case.id),
        caption: format!(
            "{setting}. Pressure coefficient C_p = (p − p∞)/(½ρU²) on the surface, {} to {}{}.",
            fixed(low, 2),
            fixed(high, 2),
            if case.is_half { "; the half z < 0 is the image of the computed one" } else { "" }
        ),
        value_label: "C_p [-]".to_owned(),
        views: EYES.iter().map(|eye| eye.view(facets, inflow)).collect(),
    }
}

impl Eye {
    fn view(&self, facets: &[Facet], inflow: [f64; 3]) -> View {
        const AXES: [&str; 3] = ["x [m]", "y [m]", "z [m]"];
        let (along, sign) = self.along;
        // What faces the eye, the far first.
        let mut seen: Vec<(f64, &Facet)> = facets
            .iter()
            .filter(|f| sign * f.area_m2[along] > 0.0)
            .map(|f| (sign * f.corners_m.iter().map(|c| c[along]).sum::<f64>() / f.corners_m.len() as f64, f))
            .collect();
        seen.sort_by(|a, b| b.0.total_cmp(&a.0));
        let polygons = seen.into_iter().map(|(_, facet)| Polygon {
            corners: facet.corners_m.iter().map(|c| [c[self.across.0], c[self.up.0]]).collect(),
            value: facet.pressure_coefficient,
        });
        let extent = |axis: usize| range(facets.iter().flat_map(|f| f.corners_m.iter().map(move |c| c[axis])));
        let (x, y) = (extent(self.across.0), extent(self.up.0));
        let margin = MARGIN * (x[1] - x[0]).max(y[1] - y[0]);
        let ends = |[low, high]: [f64; 2], is_reversed: bool| {
            if is_reversed { [high + margin, low - margin] } else { [low - margin, high + margin] }
        };
        let towards = sign * inflow[along];
        let side = if towards > 1e-9 { ", where the water meets it" } else { "" };
        View {
            title: format!("{}{side}", self.words),
            x_label: AXES[self.across.0].to_owned(),
            y_label: AXES[self.up.0].to_owned(),
            x: ends(x, self.across.1),
            y: ends(y, self.up.1),
            polygons: polygons.collect(),
            lines: Vec::new(),
            flow: None,
        }
    }
}

fn wake(case: &Case, setting: &str, slice: &Midplane) -> Field {
    let middle = |axis: usize| {
        let [low, high] = range(slice.body_m.iter().flatten().map(|p| p[axis]));
        if low <= high { 0.5 * (low + high) } else { case.reference.point_m[axis] }
    };
    let length_m = case.reference.length_m;
    let ends = |axis: usize| [-1.0, 1.0].map(|side| middle(axis) + side * WINDOW[axis] * length_m);
    let (x, y) = (ends(0), ends(1));
    let is_shown = |cell: &&CutCell| {
        [x, y].iter().enumerate().all(|(axis, ends)| {
            let [low, high] = range(cell.corners_m.iter().map(|c| c[axis]));
            low < ends[1] && high > ends[0]
        })
    };
    let shown = || slice.cells.iter().filter(is_shown);
    let [low, high] = range(shown().map(|cell| cell.speed_ratio));
    let [u, v, _] = case.flow.velocity_m_s();
    Field {
        name: format!("wake-{}", case.id),
        title: format!("Wake of {}", case.id),
        caption: format!(
            "{setting}. Speed of the water over that of the inflow, |U|/U∞, in the plane z = 0 of the computed cells, {} to {} in this window.",
            fixed(low, 2),
            fixed(high, 2)
        ),
        value_label: "|U|/U∞ [-]".to_owned(),
        views: vec![View {
            title: "plane z = 0, from below".to_owned(),
            x_label: "x [m]".to_owned(),
            y_label: "y [m]".to_owned(),
            x,
            y,
            polygons: shown().map(|c| Polygon { corners: c.corners_m.clone(), value: c.speed_ratio }).collect(),
            lines: slice.body_m.clone(),
            flow: Some(([0.0 - u, 0.0 - v], "U∞".to_owned())),
        }],
    }
}
