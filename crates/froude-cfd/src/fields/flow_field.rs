//! Pressure and velocity of a solved case, on its mesh: what pictures of it are made from.

use std::path::Path;

use froude_mesh::vector::Vec3;

use crate::foam_binary::of_cells;
use crate::foam_case::times;
use crate::foam_error::FoamError;
use crate::input;
use crate::poly_mesh::PolyMesh;

/// The fields that a case ended with.
#[derive(Debug, Clone, PartialEq)]
pub struct FlowField {
    /// The mesh.
    pub mesh: PolyMesh,
    /// Pressure over density in each cell, above that far away, m²/s².
    pub pressure_m2_s2: Vec<f64>,
    /// Velocity of the water in each cell, m/s.
    pub velocity_m_s: Vec<Vec3>,
    /// Iteration, or time in s.
    pub time: f64,
}

impl FlowField {
    /// Reads the last `p` and `U` of the folder that a case was solved in, on the mesh of a folder.
    ///
    /// # Errors
    ///
    /// [`FoamError`]: the case has no solved time, or a file is not a valid mesh or field.
    pub fn read(mesh: &Path, solved: &Path) -> Result<Self, FoamError> {
        let last = times(solved)?.pop().filter(|(time, _)| *time > 0.0);
        let (time, last) = last.ok_or_else(|| {
            FoamError::at(solved, "it has no fields of a later time; they were taken away, or the solver wrote none")
        })?;
        let mesh = PolyMesh::read(mesh)?;
        let pressure = values::<1>(&last.join("p"), mesh.cells)?;
        let velocity_m_s = values::<3>(&last.join("U"), mesh.cells)?;
        Ok(Self { pressure_m2_s2: pressure.into_iter().map(|[p]| p).collect(), velocity_m_s, mesh, time })
    }
}

fn values<const W: usize>(path: &Path, cells: usize) -> Result<Vec<[f64; W]>, FoamError> {
    let refuse = |problem: String| FoamError::at(path, problem);
    let content = input::bytes(path).map_err(|e| refuse(e.to_string()))?;
    let values = of_cells(&content, cells).map_err(refuse)?;
    match values.iter().position(|value: &[f64; W]| !value.iter().all(|x| x.is_finite())) {
        None => Ok(values),
        Some(cell) => Err(refuse(format!("its value in the cell {cell} is not finite"))),
    }
}
