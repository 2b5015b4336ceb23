//! Free decay from the twin of its rig: coverage of the intervals that a user sees, with releases that are alike and with releases that are not.

use froude::fit::budget::Uncertain;
use froude::methods::tank::decay::{DecayFit, DecayRun, DecaySetup, Method, envelope, output_error};
use froude::records::campaign::Motion;
use froude::rig::decay::{DecayRig, DecaySensor, Release};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::claims::Claims;
use crate::coverage::normal;

const SECTION: &str = "Free decay: releases of the twin, five a campaign";

/// A heaving body on springs.
const HEAVE: DecayRig =
    DecayRig { inertia: 12.0, added: 8.0, linear: 4.0, quadratic: 40.0, stiffness: 180.0, coulomb: 0.0, rest: 0.0 };
/// Standard uncertainties that inertia and stiffness are declared with, as parts; one draw a campaign.
const DECLARED_TO: [f64; 2] = [0.005, 0.003];
const SENSOR: DecaySensor = DecaySensor { rate_hz: 25.0, noise: 0.2e-3, step: 0.1e-3, drift_per_s: 0.0 };
const RELEASES: u64 = 5;

/// `alike`: every release has the same coefficients; else each has its own, scattered by 3 % about the truth (water, mounting, temperature).
pub fn all(claims: &mut Claims, campaigns: usize) {
    for (words, scatter) in [("releases alike", 0.0), ("coefficients of each release scatter by 3 %", 0.03)] {
        let fits: Vec<[DecayFit; 2]> =
            (0..campaigns).into_par_iter().filter_map(|seed| campaign(seed as u64, scatter)).collect();
        for (m, method) in Method::ALL.into_iter().enumerate() {
            for (j, (name, truth)) in [("A33", 8.0), ("D_z_I", 4.0), ("D_z_II", 40.0)].into_iter().enumerate() {
                let intervals: Vec<[f64; 2]> = fits.iter().filter_map(|fit| fit[m].interval_95(j)).collect();
                let hits = intervals.iter().filter(|[low, high]| (*low..=*high).contains(&truth)).count();
                let width =
                    intervals.iter().map(|[low, high]| 0.5 * (high - low)).sum::<f64>() / intervals.len() as f64;
                let n = intervals.len() as f64;
                let mean = fits.iter().map(|fit| fit[m].values[j]).sum::<f64>() / fits.len() as f64;
                // Three binomial standard deviations below; jackknife and one common inertia and stiffness may cover more.
                let low = 0.95 * n - 3.0 * (n * 0.0475).sqrt();
                claims.holds(
                    SECTION,
                    &format!("{words}, {}, {name}: 95 % interval covers", method.name()),
                    &format!("at least {:.0} of {campaigns}", low.floor()),
                    format!(
                        "{hits} of {}, bias {:+.2} %, mean half-width {:.2} %",
                        intervals.len(),
                        100.0 * (mean / truth - 1.0),
                        100.0 * width / truth
                    ),
                    intervals.len() == campaigns && hits as f64 >= low.floor(),
                );
            }
        }
    }
}

fn campaign(seed: u64, scatter: f64) -> Option<[DecayFit; 2]> {
    let mut rng = Pcg64::new(u128::from(seed), 81);
    let mut about = |value: f64, part: f64| value * (1.0 + part * normal(&mut rng));
    let declared = [(HEAVE.inertia, DECLARED_TO[0]), (HEAVE.stiffness, DECLARED_TO[1])]
        .map(|(value, part)| Uncertain::new(about(value, part), part * value));
    let traces: Vec<_> = (0..RELEASES)
        .map(|k| {
            let rig = DecayRig {
                added: about(HEAVE.added, scatter),
                linear: about(HEAVE.linear, scatter),
                quadratic: about(HEAVE.quadratic, scatter),
                ..HEAVE
            };
            let release = Release { displacement: about(0.1, 0.1), held_s: 0.5, free_s: 14.0 };
            rig.release(SENSOR, release, RELEASES * seed + k)
        })
        .collect();
    let runs: Vec<DecayRun<'_>> =
        traces.iter().map(|trace| DecayRun { id: "", time_s: &trace.time_s, position: &trace.position }).collect();
    let setup = DecaySetup::new(Motion::Heave, declared[0], declared[1]);
    Some([envelope(&runs, &setup).ok()?, output_error(&runs, &setup).ok()?])
}
