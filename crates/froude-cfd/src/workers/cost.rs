//! What cases cost: measured where some have ended, assumed before.

use std::collections::BTreeMap;

use crate::case::Case;
use crate::foam_mesh::FoamMesh;
use crate::outcome::Outcome;
use crate::store::Store;

/// Of simpleFoam with k-ω SST on one core: 3.1 to 3.3 µs on meshes of 22 to 264 thousand cells.
const ASSUMED_S_PER_CELL_ITERATION: f64 = 3.2e-6;
/// Of a coarse mesh: the mean of 169 flows about the snake robot of one to four links, from the inflow 240 and from another case 250.
const ASSUMED_ITERATIONS: f64 = 250.0;
/// Cells of a coarse mesh: finer ones take more iterations.
const COARSE_CELLS: f64 = 22_400.0;
/// Of a mesh that no case has run on.
const ASSUMED_CELLS: f64 = 50_000.0;

/// What cases cost, by those that have ended.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Cost {
    cpu_s: f64,
    cell_iterations: f64,
    cells: BTreeMap<String, f64>,
    /// Iterations over the cells of a direction, and cases, from the inflow and from another case.
    ended: [(f64, f64); 2],
}

impl Cost {
    /// Takes an outcome into account; one without iterations or cells says nothing.
    pub fn learn(&mut self, case: &Case, outcome: &Outcome) {
        let (cells, iterations) = (outcome.cells as f64, outcome.iterations as f64);
        if cells * iterations <= 0.0 || outcome.cpu_s <= 0.0 {
            return;
        }
        self.cpu_s += outcome.cpu_s;
        self.cell_iterations += cells * iterations;
        self.cells.insert(case.mesh.clone(), cells);
        let (sum, count) = &mut self.ended[usize::from(outcome.start_from.is_some())];
        *sum += iterations / cells.cbrt();
        *count += 1.0;
    }

    /// Takes the cells of a mesh into account that no case may have run on yet.
    pub fn knows(&mut self, mesh: &str, cells: usize) {
        self.cells.insert(mesh.to_owned(), cells as f64);
    }

    /// The same of the mesh of a case in its campaign's folder, where it can be read.
    pub fn knows_mesh_of(&mut self, store: &Store, case: &Case) {
        if !self.cells.contains_key(&case.mesh)
            && let Ok(mesh) = FoamMesh::read(&store.mesh_folder(case))
        {
            self.knows(&case.mesh, mesh.cells);
        }
    }

    /// Whether a case has ended that says what cases cost here.
    #[must_use]
    pub fn is_measured(&self) -> bool {
        self.cell_iterations > 0.0
    }

    /// Time of a processor for one cell and iteration, s; assumed before a case has ended.
    #[must_use]
    pub fn s_per_cell_iteration(&self) -> f64 {
        if self.is_measured() { self.cpu_s / self.cell_iterations } else { ASSUMED_S_PER_CELL_ITERATION }
    }

    /// Time of a processor that a case is expected to take, s.
    ///
    /// Its iterations are the mean of those that have ended from a like start, more on a finer mesh in the ratio of the cells in a direction; before one has, a usual number.
    #[must_use]
    pub fn expected_s(&self, case: &Case) -> f64 {
        let (sum, count) = self.ended[usize::from(case.start_from.is_some())];
        let cells = self.cells.get(&case.mesh).copied().unwrap_or_else(|| self.mean_cells());
        let usual = ASSUMED_ITERATIONS * (cells / COARSE_CELLS).cbrt().max(1.0);
        let iterations = if count > 0.0 { sum / count * cells.cbrt() } else { usual };
        let iterations = iterations.min(case.stop.iterations as f64);
        self.s_per_cell_iteration() * cells * iterations
    }

    fn mean_cells(&self) -> f64 {
        if self.cells.is_empty() {
            return ASSUMED_CELLS;
        }
        self.cells.values().sum::<f64>() / self.cells.len() as f64
    }
}
