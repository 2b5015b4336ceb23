//! What the mesh does to the forces of a campaign: from a finer mesh at some settings, from families of grids at others.
//!
//! | computed | forces | standard uncertainty of the mesh |
//! | --- | --- | --- |
//! | nothing again | as they are | unknown |
//! | studies | as they are | of the campaign's mesh by the family, between the angles of the studies |
//! | fine cases | plus fine less own | what the fine mesh leaves by the index of two grids, and what leaving one case out misses, squares added |
//! | both | plus fine less own | what the fine mesh leaves by the families' law, and what leaving one case out misses, squares added |
//!
//! Where a study has a domain wider than the campaign's, what is left to an endless one is known too, with its sign, and stands apart from the mesh.
//!
//! Studies are too few to correct by, fine cases too close to each other to extrapolate from: so the one corrects and the other says what is left. All of it goes as [`OverAngles`] says.

use crate::section::CfdSpec;

use crate::again::Again;
use crate::body::domain_radius;
use crate::case::Case;
use crate::collect::Collected;
use crate::family::refinement_ratio;
use crate::grid_error::two_grids;
use crate::outcome::Loads;
use crate::over_angles::{OverAngles, each};
use crate::study::{DIRECTIONS, Study, studies};

/// Standard deviations in a half-width of 95 %.
const COVERAGE: f64 = 2.0;

/// What the mesh does to the forces of a campaign.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Numerical {
    /// Settings on families of grids and in other domains.
    pub studies: Vec<Study>,
    /// Pairs of a case and the same on the fine mesh.
    pub fine: Vec<[Collected; 2]>,
    /// Names of cases that repeat one without a result.
    pub alone: Vec<String>,
    /// Fine less own.
    pub difference: OverAngles,
    /// What leaving one fine case out misses, over ½ρU²A.
    pub left_out: Option<Loads>,
    /// Standard uncertainty of the mesh that forces stand on.
    mesh: OverAngles,
    /// An endless domain less the campaign's.
    endless: OverAngles,
}

impl Numerical {
    /// Of all results of a campaign that count.
    #[must_use]
    pub fn of(rows: &[Collected], spec: &CfdSpec) -> Self {
        let (studies, mut alone) = studies(rows);
        let mut fine = Vec::new();
        for row in rows {
            if let Some((id, Again::Fine)) = Again::of(&row.case.id) {
                match rows.iter().find(|own| own.case.id == id) {
                    Some(own) => fine.push([own.clone(), row.clone()]),
                    None => alone.push(row.case.id.clone()),
                }
            }
        }
        let difference =
            OverAngles::new(fine.iter().map(|[own, fine]| (own.case.clone(), each(|k| fine.loads[k] - own.loads[k]))));
        let left_out = difference.left_out();
        let least = spec.fine.map_or(f64::INFINITY, |fine| fine.mesh.refinement(spec.mesh));
        let mesh = OverAngles::new(mesh_errors(&studies, &fine, least));
        let endless = OverAngles::new(studies.iter().filter_map(|study| {
            let radius = domain_radius(spec, study.first.case.reference);
            Some((study.first.case.clone(), study.endless(radius)?))
        }));
        Self { studies, fine, alone, difference, left_out, mesh, endless }
    }

    /// How much the loads of a case in an endless domain differ from its own, N and N m; `None` where no domain was wider.
    #[must_use]
    pub fn endless(&self, case: &Case) -> Option<Loads> {
        self.endless.at(case)
    }

    /// What is added to the loads of a case, N and N m: 0 where no case was computed on a finer mesh.
    #[must_use]
    pub fn correction(&self, case: &Case) -> Loads {
        self.difference.at(case).unwrap_or_default()
    }

    /// Standard uncertainty of the mesh in the loads of a case after their correction, N and N m; `None` where nothing was computed again.
    #[must_use]
    pub fn std_of_mesh(&self, case: &Case) -> Option<Loads> {
        let mesh = self.mesh.at(case)?;
        let scales = case.load_scales();
        // One fine case says nothing of how well it stands for others: then it may be all wrong.
        let missed = match (self.left_out, self.fine.is_empty()) {
            (_, true) => [0.0; 6],
            (Some(left_out), false) => each(|k| left_out[k] * scales[k]),
            (None, false) => self.correction(case),
        };
        Some(each(|k| mesh[k].hypot(missed[k])))
    }
}

/// Standard uncertainty of the mesh that forces stand on, at the settings where it is known, N and N m.
///
/// The meshes of a pair need not be similar: their index is taken with the refinement of the direction that is refined least, `least`, which is on the safe side.
fn mesh_errors(studies: &[Study], fine: &[[Collected; 2]], least: f64) -> Vec<(Case, Loads)> {
    let of_study = |study: &Study| {
        let own = fine.iter().find(|[own, _]| own.case.configuration == study.first.case.configuration);
        let on = own.or_else(|| fine.first()).map_or(&study.first, |[_, fine]| fine);
        let size = refinement_ratio(study.finest_cells(), on.outcome.cells, DIRECTIONS);
        let loads: Result<Vec<f64>, String> = (0..6).map(|k| Ok(study.error(k)?.at(size) / COVERAGE)).collect();
        let loads: Loads = loads.ok()?.try_into().ok()?;
        Some((study.first.case.clone(), loads))
    };
    let found: Vec<(Case, Loads)> = studies.iter().filter_map(of_study).collect();
    if !found.is_empty() {
        return found;
    }
    let of_pair = |[own, fine]: &[Collected; 2]| {
        let refinement = refinement_ratio(fine.outcome.cells, own.outcome.cells, DIRECTIONS).min(least);
        let loads = each(|k| two_grids(fine.loads[k] - own.loads[k], refinement) / COVERAGE);
        (own.case.clone(), loads)
    };
    fine.iter().map(of_pair).collect()
}

#[cfg(test)]
mod tests {
    use crate::section::{FineSpec, MeshSpec};

    use super::*;
    use crate::case::{Flow, Model, Reference, Stop, Water};
    use crate::outcome::{Outcome, Status};

    const ANGLES: [f64; 5] = [0.0, 0.4, 0.8, 1.2, 1.6];

    /// A result on so many cells, of a law: `limit + error h²` over ½ρU²A, h that of the campaign's mesh at 1.
    fn row(id: &str, angle_rad: f64, cells: usize, error: f64) -> Collected {
        let case = Case {
            id: id.to_owned(),
            configuration: "H1LT".to_owned(),
            mesh: String::new(),
            is_half: true,
            flow: Flow { speed_m_s: 0.2, angle_rad, pitch_rad: 0.0 },
            water: Water { density_kg_m3: 1000.0, viscosity_m2_s: 1e-6 },
            model: Model::Laminar,
            stop: Stop { iterations: 10, window: 5, drift: 1e-3, spread: 1e-2 },
            reference: Reference { length_m: 2.0, width_m: 0.1, area_m2: 0.5, point_m: [0.0; 3] },
            start_from: None,
        };
        let size = refinement_ratio(OWN, cells, DIRECTIONS);
        let scales = case.load_scales();
        let loads = each(|k| scales[k] * (limit(angle_rad) + error * size.powi(2)));
        let outcome = Outcome {
            status: Status::Converged,
            reason: String::new(),
            loads: Some(loads),
            pressure: None,
            std_iterative: Some([0.0; 6]),
            iterations: 10,
            cpu_s: 1.0,
            y_plus: None,
            mesh: None,
            start_from: None,
            cells,
            solver_version: String::new(),
        };
        Collected { case, outcome, loads }
    }

    const OWN: usize = 8_000;
    const FINE: usize = 64_000;
    const ERROR: f64 = 0.012;

    fn limit(angle_rad: f64) -> f64 {
        angle_rad.cos() * angle_rad.cos().abs()
    }

    fn rows(has_study: bool, has_fine: bool) -> Vec<Collected> {
        let mut out = Vec::new();
        for angle in ANGLES {
            out.push(row(&format!("H1LT-a{angle}"), angle, OWN, ERROR));
            if has_fine {
                out.push(row(&format!("H1LT-a{angle}-fine"), angle, FINE, ERROR));
            }
        }
        if has_study {
            for (suffix, cells) in [("coarser", 2_828), ("finer", 22_627), ("finer2", 64_000)] {
                out.push(row(&format!("H1LT-a0-{suffix}"), 0.0, cells, ERROR));
            }
        }
        out
    }

    /// Forces of order 2 are at h² of the limit: 1.25 times that is the 95 % of a grid, half of it the standard uncertainty.
    #[test]
    fn the_mesh_of_a_campaign_has_the_error_that_its_study_finds() {
        let rows = rows(true, false);
        let found = Numerical::of(&rows, &CfdSpec::default());
        let case = &rows[2].case;
        assert_eq!(found.correction(case), [0.0; 6]);
        // ½ρU²A = 10 N.
        let std = found.std_of_mesh(case).unwrap();
        assert!((std[0] - 10.0 * 0.5 * 1.25 * ERROR).abs() < 1e-4 && (std[5] / std[0] - 2.0).abs() < 1e-9, "{std:?}");
        assert!(Numerical::of(&rows[..1], &CfdSpec::default()).std_of_mesh(case).is_none());
    }

    /// A mesh twice as fine has a quarter of the error: three quarters of it are corrected.
    #[test]
    fn a_fine_mesh_corrects_and_leaves_its_own_error() {
        for has_study in [false, true] {
            let rows = rows(has_study, true);
            let found = Numerical::of(&rows, &CfdSpec::default());
            for angle in ANGLES {
                let own = row("", angle, OWN, ERROR);
                let corrected = own.loads[0] + found.correction(&own.case)[0];
                assert!((corrected - 10.0 * (limit(angle) + 0.25 * ERROR)).abs() < 1e-9, "{angle}");
                let std = found.std_of_mesh(&own.case).unwrap()[0];
                // The difference is 3/4 of the error at all angles, which no other misses.
                let expected = if has_study { 0.5 * 1.25 * 0.25 } else { 0.5 * 3.0 * 0.75 / 3.0 };
                assert!((std - 10.0 * expected * ERROR).abs() < 1e-4, "{has_study} {angle}: {std}");
            }
        }
    }

    /// Coarse to medium is refined by 48/35 where it is refined least, and by 1.6 on the average of all directions.
    #[test]
    fn a_pair_that_is_not_similar_is_taken_by_its_least_refinement() {
        let rows = rows(false, true);
        let spec = |fine| CfdSpec { fine: Some(FineSpec { mesh: fine, every: 1 }), ..CfdSpec::default() };
        let std = |spec: &CfdSpec| Numerical::of(&rows, spec).std_of_mesh(&rows[0].case).unwrap()[0];
        let twice = MeshSpec { stations: 80, layers: 70, azimuth: 32, ..MeshSpec::COARSE };
        let expected = (2.0_f64.powi(2) - 1.0) / ((48.0_f64 / 35.0).powi(2) - 1.0);
        assert!((std(&spec(MeshSpec::MEDIUM)) / std(&spec(twice)) / expected - 1.0).abs() < 1e-6);
    }

    #[test]
    fn what_the_correction_misses_at_a_left_out_case_widens_it() {
        let mut rows = rows(true, true);
        let before = Numerical::of(&rows, &CfdSpec::default());
        for row in rows.iter_mut().filter(|row| row.case.id == "H1LT-a0.8-fine") {
            row.loads[0] += 10.0 * 0.004;
        }
        let after = Numerical::of(&rows, &CfdSpec::default());
        // 0.004 at the case itself, half of it at both neighbours, nothing at the ends.
        let missed = (0.004_f64.powi(2) * (1.0 + 0.25 + 0.25) / 5.0).sqrt();
        assert!((after.left_out.unwrap()[0] - missed).abs() < 1e-9);
        let [was, is] = [&before, &after].map(|n| n.std_of_mesh(&rows[0].case).unwrap()[0]);
        assert!((is - was.hypot(10.0 * missed)).abs() < 1e-9, "{was} {is}");
    }

    /// An error that falls with the square of the radius: at 2 R three quarters of it are gone, and the rest is known.
    #[test]
    fn a_wider_domain_says_what_an_endless_one_would_change() {
        let mut rows = rows(false, false);
        let mut wide = row("H1LT-a0-r6", 0.0, OWN, ERROR);
        wide.loads[0] -= 10.0 * 0.75 * 0.02;
        rows.push(wide);
        let spec = CfdSpec { radius: Some(3.0), ..CfdSpec::default() };
        let found = Numerical::of(&rows, &spec);
        assert!((found.endless(&rows[3].case).unwrap()[0] + 10.0 * 0.02).abs() < 1e-9);
        let wider = CfdSpec { radius: Some(8.0), ..spec };
        assert!(Numerical::of(&rows, &wider).endless(&rows[3].case).is_none());
    }

    #[test]
    fn a_case_that_repeats_one_without_a_result_is_named() {
        let rows = [row("a-fine", 0.0, FINE, ERROR), row("b-finer", 0.0, FINE, ERROR)];
        let found = Numerical::of(&rows, &CfdSpec::default());
        assert_eq!(found.alone, ["b-finer", "a-fine"]);
        assert!(found.studies.is_empty() && found.std_of_mesh(&rows[0].case).is_none());
    }
}
