//! Coverage of the orthogonal distance regression: speed and angle err from row to row.

use std::error::Error;
use std::path::Path;

use froude::fit::faer::Mat;
use froude::fit::odr::Sigma;
use froude::identify::eiv;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::coverage::{Case, add, normal};
use crate::snake::{TOWING, fill, planned, published};

/// Standard deviations of a row's speed (m/s) and angle (rad), and of both loads (N): a towing rig filmed by a camera.
const SPEED_M_S: f64 = 0.004;
const ANGLE_RAD: f64 = 0.5 * std::f64::consts::PI / 180.0;
const LOAD_N: f64 = 0.02;

pub fn cases(root: &Path, repetitions: usize) -> Result<Vec<Case>, Box<dyn Error>> {
    let mut out = Vec::new();
    for (name, plan, names, model) in
        [("39 towing points", TOWING, Vec::new(), "f2"), ("39 towing points", TOWING, Vec::new(), "f4")]
    {
        let names: Vec<String> = names;
        let (_, data) = planned(plan, &names, "")?;
        let (law, values) = published(root, "circulation_tank_restricted", model, &data)?;
        let p = values.len();
        let (rows, speed, angle) = (
            data.rows,
            data.values("speed").unwrap_or_default().to_vec(),
            data.values("angle").unwrap_or_default().to_vec(),
        );
        let mut exact = data.clone();
        fill(&mut exact, &law, &values, || 0.0)?;
        let hits = (0..repetitions)
            .into_par_iter()
            .map(|k| {
                let mut rng = Pcg64::new(k as u128, 99);
                let mut noisy = exact.clone();
                let errors: Vec<f64> = (0..rows).map(|_| SPEED_M_S * normal(&mut rng)).collect();
                let turns: Vec<f64> = (0..rows).map(|_| ANGLE_RAD * normal(&mut rng)).collect();
                for (channel, moved) in [("speed", &errors), ("angle", &turns)] {
                    let from = if channel == "speed" { &speed } else { &angle };
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
                let standard = Mat::from_fn(rows, 2, |_, k| if k == 0 { SPEED_M_S } else { ANGLE_RAD });
                match eiv::regress(&law, &noisy, standard, Sigma::Estimated) {
                    Ok(fitted) => (0..p)
                        .map(|j| {
                            let interval = fitted.coefficients[j].interval;
                            u64::from(interval.is_some_and(|[low, high]| low <= values[j] && values[j] <= high))
                        })
                        .collect(),
                    Err(_) => vec![0; p],
                }
            })
            .reduce(|| vec![0; p], add);
        out.push(Case {
            name: format!("{name}, {model}, errors in speed ({SPEED_M_S} m/s) and angle (0.5°)"),
            coefficients: law.coefficients.iter().map(|c| c.name.clone()).collect(),
            hits,
            repetitions: repetitions as u64,
        });
    }
    Ok(out)
}
