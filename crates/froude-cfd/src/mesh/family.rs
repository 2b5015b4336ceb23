//! Families of similar O-grids, each finer than the one before by √2 in all three directions.
//!
//! The rays, the stations and the layers of all grids are cuts of the same curves: the distribution of stations does not depend on their number, and layers keep the ratio of the last to the first, so that the growth g becomes its root of the order of refinement. What differs is how the counts are rounded to whole numbers; the ratio that counts is that of the cells, [`refinement_ratio`].

use core::f64::consts::SQRT_2;

use froude_mesh::sections::SectionBody;

use crate::layers::Layers;
use crate::meridian::Meridian;
use crate::mesh_error::MeshError;
use crate::o_grid::OGrid;

impl OGrid {
    /// This grid and finer ones, each by √2: `grids` in all, the coarsest first.
    ///
    /// # Errors
    ///
    /// [`MeshError`]: a body that is none, or layers that have no growth.
    pub fn family(&self, body: &SectionBody, grids: usize) -> Result<Vec<Self>, MeshError> {
        let layers = self.own_layers(body)?;
        Ok((0..grids).map(|level| self.finer(level as i32, layers)).collect())
    }

    /// The grid of the same family that is so many steps of √2 finer than this one; −1 is one coarser.
    ///
    /// # Errors
    ///
    /// As [`family`](Self::family).
    pub fn at_level(&self, body: &SectionBody, level: i32) -> Result<Self, MeshError> {
        Ok(self.finer(level, self.own_layers(body)?))
    }

    /// The same cells about the body with others of the same growth behind them, out to another radius.
    ///
    /// # Errors
    ///
    /// As [`family`](Self::family).
    pub fn of_radius(&self, body: &SectionBody, outer_radius_m: f64) -> Result<Self, MeshError> {
        let growth = self.own_layers(body)?.growth;
        let grid = Self { outer_radius_m, ..*self };
        let length_m = grid.length_m(&Meridian::new(body)?);
        // length = first (gⁿ − 1)/(g − 1), with its limit n first as g goes to 1.
        let in_first = length_m / self.first_layer_m;
        let layers = if growth - 1.0 > 1e-9 { (in_first * (growth - 1.0)).ln_1p() / growth.ln() } else { in_first };
        Ok(Self { layers: layers.round() as usize, ..grid })
    }

    fn own_layers(&self, body: &SectionBody) -> Result<Layers, MeshError> {
        Layers::of_first(self.layers, self.first_layer_m, self.length_m(&Meridian::new(body)?))
    }

    fn finer(&self, level: i32, layers: Layers) -> Self {
        let factor = SQRT_2.powi(level);
        let [stations, count, around] =
            [self.stations, self.layers, self.around].map(|cells| (cells as f64 * factor).round() as usize);
        Self { stations, layers: count, around, first_layer_m: layers.in_layers(count).first_m(), ..*self }
    }
}

/// How much finer the one of two similar grids is, \[-\]: `(N₁/N₂)^(1/D)`, N their cells and D the directions that are refined, 3 in space and 2 in a plane.
#[must_use]
pub fn refinement_ratio(fine_cells: usize, coarse_cells: usize, directions: u32) -> f64 {
    (fine_cells as f64 / coarse_cells as f64).powf(1.0 / f64::from(directions))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BASE: OGrid =
        OGrid { stations: 20, layers: 18, around: 12, first_layer_m: 1e-3, outer_radius_m: 4.0, is_half: true };

    /// After two steps of √2 every second point of a ray, every second station and every second column is there again.
    #[test]
    fn the_points_of_a_grid_are_among_those_two_steps_finer() {
        let body = SectionBody::capsule(0.4, 0.05, 0.07, 0.1, [1; 2]);
        let family = BASE.family(&body, 4).unwrap();
        assert_eq!([family[1].stations, family[1].layers, family[1].around], [28, 25, 17]);
        assert_eq!([family[2].stations, family[2].layers, family[2].around], [40, 36, 24]);
        let [coarse, fine] = [0, 2].map(|i| family[i].mesh(&body).unwrap().0);
        let mut found = fine.points_m.clone();
        found.sort_by(|a, b| a[0].total_cmp(&b[0]));
        for p in &coarse.points_m {
            let from = found.partition_point(|q| q[0] < p[0] - 1e-9);
            let near = found[from..].iter().take_while(|q| q[0] <= p[0] + 1e-9);
            assert!(near.into_iter().any(|q| (0..3).all(|c| (p[c] - q[c]).abs() < 1e-9)), "{p:?}");
        }
    }

    #[test]
    fn a_coarser_grid_and_a_wider_domain_have_the_layers_of_the_first() {
        let body = SectionBody::capsule(0.455, 0.045, 0.045, 0.045, [1; 2]);
        let coarser = BASE.at_level(&body, -1).unwrap();
        assert_eq!([coarser.stations, coarser.layers, coarser.around], [14, 13, 8]);
        assert_eq!(BASE.at_level(&body, 0).unwrap().layers, BASE.layers);
        let growth = |grid: &OGrid| grid.own_layers(&body).unwrap().growth;
        for radius_m in [2.0, 4.0, 12.0] {
            let grid = BASE.of_radius(&body, radius_m).unwrap();
            assert!((growth(&grid) / growth(&BASE) - 1.0).abs() < 0.03, "{radius_m} m: {grid:?}");
            assert_eq!(grid.first_layer_m, BASE.first_layer_m);
        }
        assert_eq!(BASE.of_radius(&body, 4.0).unwrap(), BASE);
    }

    #[test]
    fn the_ratio_is_near_to_the_root_of_two_and_the_growth_its_root() {
        let body = SectionBody::capsule(0.455, 0.045, 0.045, 0.045, [1; 2]);
        let family = BASE.family(&body, 5).unwrap();
        let length_m = BASE.length_m(&Meridian::new(&body).unwrap());
        let logs = family
            .iter()
            .map(|g| Layers::of_first(g.layers, g.first_layer_m, length_m).unwrap().growth.ln() * g.layers as f64);
        let logs: Vec<f64> = logs.collect();
        assert!(logs.iter().all(|log| (log / logs[0] - 1.0).abs() < 1e-9), "{logs:?}");
        let cells = |g: &OGrid| g.stations * g.layers * g.around;
        for pair in family.windows(2) {
            let ratio = refinement_ratio(cells(&pair[1]), cells(&pair[0]), 3);
            assert!((ratio / SQRT_2 - 1.0).abs() < 0.02, "{ratio}");
        }
    }
}
