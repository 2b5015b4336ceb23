//! All that a case is: `case.json` in its folder.
//!
//! Two cases are the same when the hash of their inputs is: the mesh by its content, the flow, the model, what it may cost. Where a case starts from is not among them, as the answer must not depend on it; its outcome says it.

use std::path::Path;

use froude_records::hash::sha256_of_bytes;
use serde::{Deserialize, Serialize};

use crate::input;
use crate::outcome::Loads;

/// A case.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Case {
    /// Name of its folder, and of its row: `H3LT-u0.30-a045`.
    pub id: String,
    /// `HkLT`, or the name of the body.
    pub configuration: String,
    /// The mesh's folder under `meshes/`, which is the hash of its content.
    pub mesh: String,
    /// Whether the mesh is one half of the body's surroundings, cut at its plane of symmetry z = 0.
    pub is_half: bool,
    /// Velocity through the water.
    pub flow: Flow,
    /// The water.
    pub water: Water,
    /// Model of turbulence.
    pub model: Model,
    /// When it ends.
    pub stop: Stop,
    /// Lengths that its numbers refer to.
    pub reference: Reference,
    /// The case whose fields it starts from, scaled; `None`: from the inflow.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_from: Option<String>,
}

/// How the body moves through the water.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Flow {
    /// U, m/s.
    pub speed_m_s: f64,
    /// Angle of the campaign, rad: v = U (cos α, −sin α, 0), so that a positive one has a positive f_y.
    pub angle_rad: f64,
    /// Angle of the velocity out of the xy plane, towards +z, rad; the full domain only.
    pub pitch_rad: f64,
}

impl Flow {
    /// Velocity of the body through the water in its axes, m/s.
    #[must_use]
    pub fn velocity_m_s(&self) -> [f64; 3] {
        let ((sin, cos), (up, level)) = (self.angle_rad.sin_cos(), self.pitch_rad.sin_cos());
        // Zero has no sign.
        [self.speed_m_s * cos * level, 0.0 - self.speed_m_s * sin * level, self.speed_m_s * up]
    }
}

/// Water.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Water {
    /// ρ, kg/m³.
    pub density_kg_m3: f64,
    /// ν, m²/s.
    pub viscosity_m2_s: f64,
}

/// Model of turbulence.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", tag = "kind")]
pub enum Model {
    /// Menter's k-ω SST with wall conditions for any y+.
    Sst {
        /// Of the inflow: √(2k/3)/U \[-\].
        intensity: f64,
        /// Of the inflow: ν_t/ν \[-\].
        viscosity_ratio: f64,
    },
    /// None.
    Laminar,
}

/// When a steady case ends.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Stop {
    /// Most iterations.
    pub iterations: usize,
    /// Iterations that forces are averaged and judged over.
    pub window: usize,
    /// Largest change of the mean force from one half of the window to the other, of ½ρU²A, for the case to be converged.
    pub drift: f64,
    /// Largest spread within the window, likewise; beyond it the case oscillates.
    pub spread: f64,
}

/// What forces and Reynolds numbers refer to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Length of the body, m.
    pub length_m: f64,
    /// Largest width across it, m.
    pub width_m: f64,
    /// A: largest plan area, m².
    pub area_m2: f64,
    /// Point that moments are about, body axes, m.
    pub point_m: [f64; 3],
}

impl Case {
    /// SHA-256 of all inputs that the answer depends on.
    #[must_use]
    pub fn hash(&self) -> String {
        let inputs = Self { id: String::new(), start_from: None, ..self.clone() };
        // A struct of numbers and texts has a JSON.
        sha256_of_bytes(serde_json::to_string(&inputs).unwrap_or_default().as_bytes())
    }

    /// Reynolds number U W/ν of the width \[-\].
    #[must_use]
    pub fn reynolds(&self) -> f64 {
        self.flow.speed_m_s * self.reference.width_m / self.water.viscosity_m2_s
    }

    /// What loads are compared with: ½ρU²A, N, and for moments ½ρU²A L, N m.
    #[must_use]
    pub fn load_scales(&self) -> Loads {
        let force_n = 0.5 * self.water.density_kg_m3 * self.flow.speed_m_s.powi(2) * self.reference.area_m2;
        let moment_n_m = force_n * self.reference.length_m;
        [force_n, force_n, force_n, moment_n_m, moment_n_m, moment_n_m]
    }

    /// Whether its layer is laminar over the whole body, and its model has it turbulent from the nose on.
    ///
    /// Below a Reynolds number of the width of 10⁴ that of a length of ten widths is 10⁵, where the layer of a smooth plate in a quiet stream is laminar up to some 5·10⁵ (Schlichting and Gersten, Boundary-Layer Theory).
    #[must_use]
    pub fn is_tripped_too_early(&self) -> bool {
        matches!(self.model, Model::Sst { .. }) && self.reynolds() < LAMINAR_REYNOLDS
    }

    /// Reads `case.json` of a folder.
    ///
    /// # Errors
    ///
    /// [`CaseError`].
    pub fn read(folder: &Path) -> Result<Self, CaseError> {
        let path = folder.join(CASE_FILE);
        let text =
            input::text(&path).map_err(|e| CaseError { path: path.display().to_string(), problem: e.to_string() })?;
        serde_json::from_str(&text).map_err(|e| CaseError { path: path.display().to_string(), problem: e.to_string() })
    }
}

/// See [`Case::is_tripped_too_early`].
pub const LAMINAR_REYNOLDS: f64 = 1e4;

/// Name of a case's file.
pub const CASE_FILE: &str = "case.json";

/// A case's file that is none.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{path}: {problem}: the file of a CFD case is written by froude cfd plan; plan the campaign again")]
pub struct CaseError {
    /// The file.
    pub path: String,
    /// What is wrong with it.
    pub problem: String,
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_velocity_has_the_speed_and_points_to_port_at_a_right_angle() {
        let flow = Flow { speed_m_s: 0.4, angle_rad: std::f64::consts::FRAC_PI_2, pitch_rad: 0.3 };
        let [u, v, w] = flow.velocity_m_s();
        assert!((u.hypot(v).hypot(w) - 0.4).abs() < 1e-15);
        assert!(u.abs() < 1e-16 && v < 0.0 && w > 0.0);
    }
}
