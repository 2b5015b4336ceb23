//! Fields at the start of a case, and the conditions at its boundary: the folder `0`.
//!
//! Walls take any y+: k, omega and the eddy viscosity have conditions that blend the viscous sublayer with the wall's law. Open water is in- and outflow in one, by the sign of the flux, so that one mesh serves every angle.

use crate::case::{Case, Model};
use crate::dictionary::{Dictionary, vector};
use crate::foam_mesh::FoamMesh;
use crate::poly_mesh::Patch;

/// A field: its name, and the file's content without the header.
pub struct Field {
    /// `U`, `p`, `k`, `omega`, `nut`.
    pub name: &'static str,
    /// `volVectorField`, `volScalarField`.
    pub class: &'static str,
    dimensions: &'static str,
    inflow: String,
    wall: Dictionary,
    open: Dictionary,
}

/// The fields that a case starts with.
///
/// The turbulence of the inflow is `k = 3/2 (I U)²` and `ω = k/ν_t`.
#[must_use]
pub fn fields(case: &Case) -> Vec<Field> {
    let inflow = format!("uniform {}", vector(case.flow.velocity_m_s().map(|v| 0.0 - v)));
    let of_type = |kind: &str| Dictionary::default().with("type", kind);
    let mut fields = vec![
        Field {
            name: "U",
            class: "volVectorField",
            dimensions: "[0 1 -1 0 0 0 0]",
            wall: of_type("noSlip"),
            open: of_type("freestreamVelocity").with("freestreamValue", inflow.as_str()),
            inflow,
        },
        Field {
            name: "p",
            class: "volScalarField",
            dimensions: "[0 2 -2 0 0 0 0]",
            inflow: "uniform 0".to_owned(),
            wall: of_type("zeroGradient"),
            open: of_type("freestreamPressure").with("freestreamValue", "uniform 0"),
        },
    ];
    if let Model::Sst { intensity, viscosity_ratio } = case.model {
        let k = 1.5 * (intensity * case.flow.speed_m_s).powi(2);
        let nut = viscosity_ratio * case.water.viscosity_m2_s;
        let uniform = |value: f64| format!("uniform {value:e}");
        let scalar = |name, dimensions, value: f64, wall: Dictionary| Field {
            name,
            class: "volScalarField",
            dimensions,
            inflow: uniform(value),
            wall,
            open: of_type("inletOutlet").with("inletValue", uniform(value)).with("value", uniform(value)),
        };
        let k_wall = of_type("kLowReWallFunction").with("value", uniform(k));
        fields.push(scalar("k", "[0 2 -2 0 0 0 0]", k, k_wall));
        let omega_wall = of_type("omegaWallFunction").with("blended", "true").with("value", uniform(k / nut));
        fields.push(scalar("omega", "[0 0 -1 0 0 0 0]", k / nut, omega_wall));
        let nut_wall = of_type("nutUSpaldingWallFunction").with("value", "uniform 0");
        fields.push(Field {
            open: of_type("calculated").with("value", uniform(nut)),
            ..scalar("nut", "[0 2 -1 0 0 0 0]", nut, nut_wall)
        });
    }
    fields
}

/// The fields around a wall that moves with the mesh, in a stream from ahead or in water at rest. The pressure at the outer boundary is 0 at rest, and that of a free stream else, whose in- and outflow is told by the velocity in axes at rest.
///
/// The turbulence is that of the case's own speed.
#[must_use]
pub fn fields_about_a_moving_wall(case: &Case, stream_m_s: f64) -> Vec<Field> {
    let of_type = |kind: &str| Dictionary::default().with("type", kind);
    let mut fields = fields(case);
    for field in &mut fields {
        match field.name {
            "U" => {
                field.inflow = format!("uniform {}", vector([0.0 - stream_m_s, 0.0, 0.0]));
                field.wall = of_type("movingWallVelocity").with("value", "uniform (0 0 0)");
                // At rest there is no direction that in- and outflow could be told by.
                field.open = if stream_m_s == 0.0 {
                    of_type("pressureInletOutletVelocity").with("value", "uniform (0 0 0)")
                } else {
                    of_type("freestreamVelocity").with("freestreamValue", field.inflow.as_str())
                };
            }
            "p" if stream_m_s == 0.0 => field.open = of_type("fixedValue").with("value", "uniform 0"),
            _ => {}
        }
    }
    fields
}

impl Field {
    /// The file of a start from the inflow.
    #[must_use]
    pub fn file(&self, mesh: &FoamMesh) -> String {
        let start =
            Dictionary::default().with("dimensions", self.dimensions).with("internalField", self.inflow.as_str());
        format!("{}{}", start.file(self.class, self.name), self.boundary(mesh))
    }

    /// The entry `boundaryField`.
    #[must_use]
    pub fn boundary(&self, mesh: &FoamMesh) -> String {
        let condition = |patch: &Patch| {
            if patch.is_wall() {
                self.wall.clone()
            } else if patch.is_open() {
                self.open.clone()
            } else {
                Dictionary::default().with("type", patch.kind.word())
            }
        };
        let patches = mesh.patches.iter().fold(Dictionary::default(), |all, p| all.with(&p.name, condition(p)));
        Dictionary::default().with("boundaryField", patches).text()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::case::{Flow, Reference, Stop, Water};

    #[test]
    fn the_stream_comes_from_ahead_and_the_wall_moves_with_its_mesh() {
        let case = Case {
            id: String::new(),
            configuration: String::new(),
            mesh: String::new(),
            is_half: true,
            flow: Flow { speed_m_s: 0.3, angle_rad: 0.0, pitch_rad: 0.0 },
            water: Water { density_kg_m3: 1000.0, viscosity_m2_s: 1e-6 },
            model: Model::Laminar,
            stop: Stop { iterations: 1, window: 1, drift: 0.0, spread: 0.0 },
            reference: Reference { length_m: 1.0, width_m: 1.0, area_m2: 1.0, point_m: [0.0; 3] },
            start_from: None,
        };
        let of = |stream: f64| {
            let fields = fields_about_a_moving_wall(&case, stream);
            fields.iter().map(|f| (f.inflow.clone(), f.wall.text(), f.open.text())).collect::<Vec<_>>()
        };
        let [(inflow, wall, open), (_, still, pressure)] = &of(0.2)[..] else { panic!("U and p") };
        assert_eq!(inflow, "uniform (-2e-1 0e0 0e0)");
        assert!(wall.contains("movingWallVelocity") && still.contains("zeroGradient"));
        assert!(open.contains("freestreamVelocity") && open.contains("uniform (-2e-1 0e0 0e0)"), "{open}");
        assert!(pressure.contains("freestreamPressure"), "{pressure}");
        let [(inflow, _, open), (_, _, pressure)] = &of(0.0)[..] else { panic!("U and p") };
        assert!(inflow == "uniform (0e0 0e0 0e0)" && open.contains("pressureInletOutletVelocity"), "{inflow} {open}");
        assert!(pressure.contains("fixedValue"), "{pressure}");
        assert_eq!(of(-0.2)[0].0, "uniform (2e-1 0e0 0e0)");
    }
}
