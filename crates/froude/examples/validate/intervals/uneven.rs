//! Errors that are not of one size.

use rand_pcg::Pcg64;

use super::{Failed, alarm, campaign, interval, judged, rare, rows, run};
use crate::claims::Claims;
use crate::coverage::normal;

pub fn all(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    leverage(claims, seeds)?;
    uneven(claims, seeds)
}

/// Twenty slow rows and three fast ones under HC3, noise equal or as the load; plain, and weighted by a fitted variance.
fn leverage(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    let speed: Vec<f64> = (0..20).map(|i| 0.2 + 0.01 * f64::from(i)).chain([1.8, 1.9, 2.0]).collect();
    let evenly: Vec<f64> = (0..45).map(|i| 0.2 + 0.04 * f64::from(i)).collect();
    for (words, speed) in [("20 slow and 3 fast rows", &speed), ("45 rows", &evenly)] {
        for (noise, of) in [
            ("equal errors", (|_: f64, _: f64| 1.0) as fn(f64, f64) -> f64),
            ("errors as the load", |f, _| 0.02 * f.abs()),
            ("errors as the speed", |_, u| 0.5 * u),
        ] {
            for (kind, key, floor) in [
                ("HC3", "covariance = \"HC3\"\n", 91.0),
                ("weights fitted, HC3", "covariance = \"HC3\"\nweights = \"fitted\"\n", 94.0),
            ] {
                let rest = format!("models = [\"linear_quadratic\"]\n[identify]\n{key}");
                let tallies = run(
                    &campaign(&rest),
                    seeds,
                    300 + speed.len() as u128 + noise.len() as u128,
                    |rng| rows(speed, |_, u| -(4.0 * u + 20.0 * u * u) + of(4.0 * u + 20.0 * u * u, u) * normal(rng)),
                    |found| {
                        let of =
                            |name: &str, truth| interval(found, 0, name, truth).map(|said| (name.to_owned(), said));
                        [of("D_x_I", 4.0), of("D_x_II", 20.0)].into_iter().flatten().collect()
                    },
                )?;
                for tally in &tallies {
                    judged(
                        claims,
                        &format!("{kind}, {words}, {noise}"),
                        tally,
                        floor,
                        false,
                        &format!(", mean width {:.3}", tally.width()),
                    );
                }
            }
        }
    }
    Ok(())
}

/// Errors that go with the load, and equal ones.
fn uneven(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    for (n, floor) in [(16, 50.0), (30, 85.0)] {
        for is_uneven in [false, true] {
            let table = |rng: &mut Pcg64| {
                let speed: Vec<f64> = (0..n).map(|i| 0.3 + 1.5 * f64::from(i) / f64::from(n)).collect();
                rows(&speed, |_, u| {
                    let load = 12.0 * u * u;
                    -load + if is_uneven { 0.05 * load } else { 0.5 } * normal(rng)
                })
            };
            for tally in
                run(&campaign("models = [\"quadratic\"]\n"), seeds, 700 + n as u128, table, alarm("uneven-scatter"))?
            {
                let what = format!("{n} rows, errors {}", if is_uneven { "as the load" } else { "equal" });
                if is_uneven {
                    judged(claims, &what, &tally, floor, false, "");
                } else {
                    rare(claims, &what, &tally, 0.4);
                }
            }
        }
    }
    Ok(())
}
