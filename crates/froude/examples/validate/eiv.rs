//! Coverage of the orthogonal distance regression: speed and angle err from row to row.

use std::error::Error;
use std::path::Path;

use froude::fit::faer::Mat;
use froude::fit::odr::Sigma;
use froude::fit::{self, Options, Problem};
use froude::identify::dataset::Dataset;
use froude::identify::eiv;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::claims::Claims;
use crate::coverage::{Case, SECTION, add, count, normal, problem_of};
use crate::snake::{TOWING, fill, planned, published};

/// Standard deviations of a row's speed (m/s) and angle (rad), and of both loads (N): a towing rig filmed by a camera.
const SPEED_M_S: f64 = 0.004;
const ANGLE_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;
const LOAD_N: f64 = 0.02;

/// Repetitions of the negative control, whose failure is plain.
const CONTROL_REPETITIONS: usize = 1_000;

/// The cases, and as a negative control ordinary least squares, which takes speed and angle as exact.
pub fn cases(claims: &mut Claims, root: &Path, repetitions: usize) -> Result<Vec<Case>, Box<dyn Error>> {
    let mut out = Vec::new();
    for (name, plan, names, model) in
        [("39 towing points", TOWING, Vec::new(), "f2"), ("39 towing points", TOWING, Vec::new(), "f4")]
    {
        let names: Vec<String> = names;
        let (_, data) = planned(plan, &names, "")?;
        let (law, values) = published(root, "circulation_tank_restricted", model, &data)?;
        let (rows, speed, angle) = (
            data.rows,
            data.values("speed").unwrap_or_default().to_vec(),
            data.values("angle").unwrap_or_default().to_vec(),
        );
        let mut exact = data.clone();
        fill(&mut exact, &law, &values, || 0.0)?;
        let noisy = |k: usize| {
            let mut rng = Pcg64::new(k as u128, 99);
            let mut noisy = exact.clone();
            let errors: Vec<f64> = (0..rows).map(|_| SPEED_M_S * normal(&mut rng)).collect();
            let turns: Vec<f64> = (0..rows).map(|_| ANGLE_RAD * normal(&mut rng)).collect();
            for (channel, from, moved) in [("speed", &speed, &errors), ("angle", &angle, &turns)] {
                if let Some(c) = noisy.channels.get_mut(channel) {
                    c.values = from.iter().zip(moved).map(|(x, e)| x + e).collect();
                }
            }
            noisy.velocity_from_speed_and_angle();
            for load in ["f_x", "f_y"] {
                if let Some(c) = noisy.channels.get_mut(load) {
                    for f in &mut c.values {
                        *f += LOAD_N * normal(&mut rng);
                    }
                }
            }
            noisy
        };
        let coverage = |repetitions: usize, intervals: &(dyn Fn(&Dataset) -> Vec<Option<[f64; 2]>> + Sync)| {
            (0..repetitions)
                .into_par_iter()
                .map(|k| count(&intervals(&noisy(k)), &values))
                .collect::<Vec<_>>()
                .into_iter()
                .fold(vec![0; values.len()], add)
        };
        let hits = coverage(repetitions, &|data| {
            let standard = Mat::from_fn(rows, 2, |_, k| if k == 0 { SPEED_M_S } else { ANGLE_RAD });
            eiv::regress(&law, data, eiv::Inputs::polar(standard), Sigma::Estimated)
                .map_or_else(|_| Vec::new(), |f| f.coefficients.iter().map(|c| c.interval).collect())
        });
        let runs = repetitions.min(CONTROL_REPETITIONS);
        let ordinary = coverage(runs, &|data| {
            let fitted = problem_of(&law, data)
                .ok()
                .zip(law.measured(data).ok())
                .and_then(|(problem, response)| fit::fit(&Problem { response, ..problem }, &Options::default()).ok());
            fitted.map_or_else(Vec::new, |f| f.coefficients.iter().map(|c| c.interval).collect())
        });
        let names = law.coefficients.iter().map(|c| c.name.as_str());
        let rate = |h: &u64| *h as f64 / runs as f64;
        claims.holds(
            SECTION,
            &format!(
                "negative control, {name}, {model}: ordinary least squares of the same tables ({runs} repetitions)"
            ),
            "fails: some coefficient below 90 %",
            names.zip(&ordinary).map(|(n, h)| format!("{n} {:.1} %", 100.0 * rate(h))).collect::<Vec<_>>().join(", "),
            ordinary.iter().any(|h| rate(h) < 0.90),
        );
        out.push(Case {
            name: format!("{name}, {model}, errors in speed ({SPEED_M_S} m/s) and angle (0.5°)"),
            coefficients: law.coefficients.iter().map(|c| c.name.clone()).collect(),
            hits,
            repetitions: repetitions as u64,
        });
    }
    Ok(out)
}
