//! Intervals after a law was chosen.

use super::{Failed, ROOM, Said, bands, campaign, capped, interval, judged, recommended, rows, run, sixteen};
use crate::claims::{Claims, Verdict};
use crate::coverage::normal;

/// Widths this near to each other are equal.
const SAME_WIDTH: f64 = 0.005;

pub fn all(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    selection(claims, seeds)?;
    powers(claims, seeds)
}

/// A linear term of no to five standard uncertainties beside 55 U²: intervals after the choice of a law.
fn selection(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    const SIGMA: f64 = 1.2;
    let speed = sixteen();
    // Standard uncertainty of the linear term in the larger law.
    let sum = |p: i32| speed.iter().map(|u| u.powi(p)).sum::<f64>();
    let u_b = SIGMA * (sum(4) / (sum(2) * sum(4) - sum(3).powi(2))).sqrt();
    for size in [0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0] {
        let b = size * u_b;
        let truth = |u: f64| -(b * u + 55.0 * u * u);
        let tallies = run(
            &campaign(""),
            seeds,
            100 + (10.0 * size) as u128,
            |rng| rows(&speed, |_, u| truth(u) + SIGMA * normal(rng)),
            |found| {
                let mut out = Vec::new();
                let Some(r) = &found.recommendation else { return out };
                let missed = Said { holds: false, width: 0.0 };
                out.push((
                    "D_x_II of the recommended law".to_owned(),
                    interval(found, r.index, "D_x_II", 55.0).unwrap_or(missed),
                ));
                let band = recommended(found).and_then(|m| bands(m, &found.data)).unwrap_or_default();
                for i in [0, 5, 10, 15] {
                    let [force, half] = band.get(i).copied().unwrap_or([f64::NAN, 0.0]);
                    let holds = (force - truth(speed[i])).abs() <= half;
                    out.push((format!("force band at {:.1} m/s", speed[i]), Said { holds, width: half }));
                }
                if let Some(f) = r.formula {
                    let band = found.models.get(f).and_then(|m| bands(m, &found.data)).unwrap_or_default();
                    let [force, half] = band.first().copied().unwrap_or([f64::NAN, 0.0]);
                    let holds = (force - truth(speed[0])).abs() <= half;
                    out.push(("force band of the formula at 0.2 m/s".to_owned(), Said { holds, width: half }));
                }
                out
            },
        )?;
        let what = format!("a linear term of {size} u beside 55 U², three laws");
        for tally in &tallies {
            judged(claims, &what, tally, 94.0, false, &format!(", mean width {:.3}", tally.width()));
        }
        // The larger law alone, of the same tables.
        let alone = run(
            &campaign("models = [\"linear_quadratic\"]\n"),
            seeds,
            100 + (10.0 * size) as u128,
            |rng| rows(&speed, |_, u| truth(u) + SIGMA * normal(rng)),
            |found| interval(found, 0, "D_x_II", 55.0).map(|said| (String::new(), said)).into_iter().collect(),
        )?;
        if let ([chosen, ..], [alone]) = (&tallies[..], &alone[..]) {
            let of = (Some(1.0 + SAME_WIDTH), "that of the larger law alone");
            capped(claims, &format!("{what}: D_x_II"), [chosen.width(), alone.width()], of);
        }
    }
    Ok(())
}

/// Truths that no law of the others contains: a power law beside polynomials.
fn powers(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    let speed = sixteen();
    for (exponent, sigma) in [(1.6, 0.4), (1.8, 0.2), (1.8, 0.8)] {
        let truth = |u: f64| -12.0 * u.powf(exponent);
        let tallies = run(
            &campaign(""),
            seeds,
            140 + (10.0 * exponent + 10.0 * sigma) as u128,
            |rng| rows(&speed, |_, u| truth(u) + sigma * normal(rng)),
            |found| {
                let band = recommended(found).and_then(|m| bands(m, &found.data)).unwrap_or_default();
                let of = |i: usize| {
                    let [force, half] = band.get(i).copied().unwrap_or([f64::NAN, 0.0]);
                    let holds = (force - truth(speed[i])).abs() <= half;
                    (format!("force band at {:.1} m/s", speed[i]), Said { holds, width: half })
                };
                [0, 5, 10, 15].map(of).to_vec()
            },
        )?;
        for tally in &tallies {
            claims.add(
                ROOM,
                &format!("12 U^{exponent} at {sigma} N, three laws: {}", tally.name),
                "laws that contain nothing of each other: the polynomial is taken unless it is clearly less likely",
                format!("{:.2} % of {}, mean half width {:.3}", tally.percent(), tally.count, tally.width()),
                Verdict::Measured,
            );
        }
    }
    Ok(())
}
