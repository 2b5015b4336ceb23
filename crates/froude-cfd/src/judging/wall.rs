//! How well the mesh at the wall resolves the flow there: which cases are rejected, and what is left in the others' uncertainty.
//!
//! | found | consequence |
//! | --- | --- |
//! | layers on less than half of the wall's area | rejected: the friction is not resolved |
//! | mean y+ above 300 with a model of turbulence | rejected: the first cell lies beyond the law of the wall |
//! | mean y+ above 5 in laminar flow | rejected: the first cell does not resolve the gradient at the wall |
//! | layers on a part of the area | 95 % half-width: the load times the part of the area without layers |
//! | mean y+ from 5 to 300 with a model of turbulence | 95 % half-width: 11 % of the load |
//!
//! A load is taken as |pressure| + |friction| here, so that one that changes its sign with the angle keeps an uncertainty.
//!
//! **Sources.** The linear sublayer ends at y+ = 5 and the logarithmic law at some 300 (Pope 2000, Turbulent Flows, section 7.1.3). The wall conditions of the cases blend both laws, at a cost that was measured on a capsule of 1 m by 90 mm at 0.4 m/s: a mesh with a mean y+ of 27 has 11 % more axial and 8.5 % more transverse force than one that resolves the wall. On a SUBOFF hull without any layer, drag is some 38 % too high (121 N; measured 87.4 N), within the half-width of 100 % that the rule gives there.

use std::path::Path;

use froude_records::RecordError;
use froude_records::read;
use serde::{Deserialize, Serialize};

use crate::case::{Case, Model};
use crate::input;
use crate::outcome::{Loads, Outcome, Status};

/// Name of the file in a mesh's folder.
const FILE: &str = "quality.json";
/// Its size, at most, bytes.
const LARGEST: u64 = 1 << 16;
/// Least part of the wall's area that must have layers \[-\].
pub const MIN_COVERAGE: f64 = 0.5;
/// y+ up to which the viscous sublayer is resolved.
pub const SUBLAYER: f64 = 5.0;
/// y+ up to which the law of the wall holds.
pub const LAW_OF_THE_WALL: f64 = 300.0;
/// 95 % half-width of a load whose wall is not resolved, over the load \[-\].
const UNRESOLVED: f64 = 0.11;
/// Standard uncertainties in a half-width of 95 %.
const COVERAGE: f64 = 2.0;

/// How good a mesh is.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct MeshQuality {
    /// Largest non-orthogonality, rad.
    pub max_non_orthogonality_rad: f64,
    /// Largest skewness \[-\].
    pub max_skewness: f64,
    /// Layers that were requested; `None`: an O-grid, whose cells at the wall are all layers.
    pub layers: Option<WallLayers>,
}

/// Layers of a mesh of cubes.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct WallLayers {
    /// How many were requested.
    pub requested: usize,
    /// How many a face of the body has, mean \[-\].
    pub achieved: f64,
    /// Part of the requested thickness \[-\].
    pub thickness_coverage: f64,
    /// Part of the body's area with layers \[-\].
    pub area_coverage: f64,
}

impl MeshQuality {
    /// Reads what was written into a mesh's folder; `None` where nothing was.
    #[must_use]
    pub fn read(mesh: &Path) -> Option<Self> {
        serde_json::from_str(&read::text(&mesh.join(FILE), LARGEST, "the quality of a mesh").ok()?).ok()
    }

    /// Writes it into a mesh's folder.
    ///
    /// # Errors
    ///
    /// [`RecordError::Write`].
    pub fn write(&self, mesh: &Path) -> Result<(), RecordError> {
        input::write_json(&mesh.join(FILE), self)
    }

    /// Part of the body's area with layers \[-\].
    #[must_use]
    pub fn area_coverage(&self) -> f64 {
        self.layers.map_or(1.0, |layers| layers.area_coverage)
    }
}

/// An outcome as it counts: one whose wall is not resolved has failed, whatever its forces are.
#[must_use]
pub fn judged(case: &Case, outcome: Outcome) -> Outcome {
    match fault(case, &outcome) {
        Some(reason) if outcome.status.is_usable() => Outcome { status: Status::Failed, reason, ..outcome },
        _ => outcome,
    }
}

/// Why the forces of a case do not count, and which key to change.
fn fault(case: &Case, outcome: &Outcome) -> Option<String> {
    let coverage = outcome.mesh.map_or(1.0, |mesh| mesh.area_coverage());
    if coverage < MIN_COVERAGE {
        return Some(format!(
            "layers cover {:.0} % of the body's area, but at least {:.0} % is required, because the friction is not resolved without layers; write mesh = {{ surface_cell, first_layer, layers }} in [source.cfd] with smaller cubes or fewer layers",
            100.0 * coverage,
            100.0 * MIN_COVERAGE
        ));
    }
    let [_, mean, _] = outcome.y_plus?;
    let (limit, why) = match case.model {
        Model::Sst { .. } => (LAW_OF_THE_WALL, "the law of the wall ends"),
        Model::Laminar => (SUBLAYER, "the viscous sublayer ends"),
    };
    (mean > limit).then(|| {
        format!(
            "the mean y+ is {mean:.0}, and {why} at {limit:.0}; make first_layer of mesh in [source.cfd] {:.1} times thinner",
            mean / limit
        )
    })
}

/// Standard uncertainty of the loads that the mesh at the wall leaves, N and N m.
#[must_use]
pub fn std_of_wall(case: &Case, outcome: &Outcome) -> Loads {
    let without = 1.0 - outcome.mesh.map_or(1.0, |mesh| mesh.area_coverage());
    let is_turbulent = matches!(case.model, Model::Sst { .. });
    let is_unresolved = is_turbulent && outcome.y_plus.is_some_and(|[_, mean, _]| mean > SUBLAYER);
    let part = without.hypot(if is_unresolved { UNRESOLVED } else { 0.0 });
    let loads = outcome.loads.unwrap_or_default();
    let pressure = outcome.pressure.unwrap_or(loads);
    core::array::from_fn(|k| part / COVERAGE * (pressure[k].abs() + (loads[k] - pressure[k]).abs()))
}
