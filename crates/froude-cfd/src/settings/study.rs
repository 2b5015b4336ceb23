//! Settings of a campaign that were computed on a family of grids and in several domains.

use crate::again::Again;
use crate::collect::Collected;
use crate::grid_error::{GridError, OnGrid, grid_error};
use crate::outcome::Loads;
use crate::over_angles::each;

/// Directions that a family of grids is refined in.
pub const DIRECTIONS: u32 = 3;

/// A setting.
#[derive(Debug, Clone, PartialEq)]
pub struct Study {
    /// The campaign's own case.
    pub first: Collected,
    /// All grids that have a result, with the step of √2 from the campaign's, the coarsest first; the campaign's own is one.
    pub grids: Vec<(i32, Collected)>,
    /// Other domains, with the radius in lengths of the body, the smallest first.
    pub domains: Vec<(f64, Collected)>,
}

impl Study {
    /// What the family says of a load, in N or N m; the loads are in the order of [`Loads`].
    ///
    /// # Errors
    ///
    /// Fewer than two grids have a result.
    pub fn error(&self, load: usize) -> Result<GridError, String> {
        let on = |(_, row): &(i32, Collected)| OnGrid {
            cells: row.outcome.cells,
            value: row.loads[load],
            std_iterative: row.outcome.std_iterative.map_or(0.0, |std| std[load]),
        };
        grid_error(&self.grids.iter().map(on).collect::<Vec<_>>(), DIRECTIONS)
    }

    /// Cells of the finest grid.
    #[must_use]
    pub fn finest_cells(&self) -> usize {
        self.grids.iter().map(|(_, row)| row.outcome.cells).max().unwrap_or(0)
    }

    /// How much the loads in an endless domain differ from those in the campaign's at most, N and N m; `None` without a larger domain.
    ///
    /// From the largest: far from a body its wake is a source, whose velocity falls with the square of the distance, so that of the error of a radius R the part 1 − (R/R₁)² is gone at R₁ (Batchelor, An Introduction to Fluid Dynamics, 5.12).
    #[must_use]
    pub fn endless(&self, own_radius: f64) -> Option<Loads> {
        let (radius, widest) = self.domains.last().filter(|(radius, _)| *radius > own_radius)?;
        let gone = 1.0 - (own_radius / radius).powi(2);
        Some(each(|k| (widest.loads[k] - self.first.loads[k]) / gone))
    }
}

/// The settings that were computed again on other grids or in other domains, in the order of the plan; and the names of cases whose first has no result.
#[must_use]
pub fn studies(rows: &[Collected]) -> (Vec<Study>, Vec<String>) {
    let mut out: Vec<Study> = Vec::new();
    let mut alone = Vec::new();
    for row in rows {
        let Some((id, again @ (Again::Grid(_) | Again::Domain(_)))) = Again::of(&row.case.id) else { continue };
        let at = out.iter().position(|study| study.first.case.id == id).or_else(|| {
            let first = rows.iter().find(|row| row.case.id == id)?.clone();
            out.push(Study { grids: vec![(0, first.clone())], domains: Vec::new(), first });
            Some(out.len() - 1)
        });
        match (at.and_then(|at| out.get_mut(at)), again) {
            (Some(study), Again::Grid(level)) => study.grids.push((level, row.clone())),
            (Some(study), Again::Domain(radius)) => study.domains.push((radius, row.clone())),
            _ => alone.push(row.case.id.clone()),
        }
    }
    for study in &mut out {
        study.grids.sort_by_key(|(level, _)| *level);
        study.domains.sort_by(|a, b| a.0.total_cmp(&b.0));
    }
    (out, alone)
}
