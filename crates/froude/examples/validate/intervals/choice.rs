//! Intervals, ranges and bands after a law was chosen.

use froude::identify::source::SourceResult;

use super::{Failed, Said, band, campaign, capped, interval, judged, rows, run, sixteen};
use crate::claims::Claims;
use crate::coverage::normal;

pub fn all(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    selection(claims, seeds)?;
    conditional(claims, seeds)?;
    powers(claims, seeds)
}

/// Indices of the speeds at which bands are checked.
const AT: [usize; 4] = [0, 5, 10, 15];

/// Whether the band of the recommended load holds the truth.
fn bands_hold(found: &SourceResult, speed: &[f64], truth: impl Fn(f64) -> f64) -> Vec<(String, Said)> {
    let band = band(found);
    let of = |i: usize| {
        let [_, low, high] = band.get(i).copied().unwrap_or([f64::NAN; 3]);
        let holds = (low..=high).contains(&truth(speed[i]));
        (format!("force band at {:.1} m/s", speed[i]), Said { holds, width: 0.5 * (high - low) })
    };
    AT.map(of).to_vec()
}

/// A linear term of no to five standard uncertainties beside 55 U².
fn selection(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    const SIGMA: f64 = 1.2;
    let speed = sixteen();
    // Standard uncertainty of the linear term in the larger law.
    let sum = |p: i32| speed.iter().map(|u| u.powi(p)).sum::<f64>();
    let u_b = SIGMA * (sum(4) / (sum(2) * sum(4) - sum(3).powi(2))).sqrt();
    for size in [0.0, 0.5, 1.0, 2.0, 3.0, 4.0, 5.0] {
        let b = size * u_b;
        let truth = |u: f64| -(b * u + 55.0 * u * u);
        let of_seed = 100 + (10.0 * size) as u128;
        let tallies = run(
            &campaign(""),
            seeds,
            of_seed,
            |rng| rows(&speed, |_, u| truth(u) + SIGMA * normal(rng)),
            |found| {
                let mut out = Vec::new();
                let Some(r) = &found.recommendation else { return out };
                // A power law has no D_x_II, and where the data contradict every law no range is stated.
                let of_law = |i: &usize| found.estimates[*i].coefficients.get("D_x_II").and_then(|c| c.range_95);
                let range = r.not_contradicted.iter().find_map(of_law);
                out.extend(range.map(|[low, high]| {
                    let said = Said { holds: (low..=high).contains(&55.0), width: high - low };
                    ("range of D_x_II, where a law that is left has one".to_owned(), said)
                }));
                out.extend(bands_hold(found, &speed, truth));
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
            of_seed,
            |rng| rows(&speed, |_, u| truth(u) + SIGMA * normal(rng)),
            |found| interval(found, 0, "D_x_II", 55.0).map(|said| (String::new(), said)).into_iter().collect(),
        )?;
        if let (Some(chosen), [alone]) = (tallies.iter().find(|t| t.name.starts_with("range")), &alone[..]) {
            let of = (None, "that of the larger law alone");
            capped(claims, &format!("{what}: range of D_x_II"), [chosen.width(), alone.width()], of);
        }
    }
    Ok(())
}

/// Intervals of each law where it is the true one, beside two others: conditional on it, whatever is recommended.
fn conditional(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    let speed = sixteen();
    let truths: [(&str, fn(f64) -> f64, &[(&str, f64)]); 3] = [
        ("quadratic", |u| -12.0 * u * u, &[("D_x_II", 12.0)]),
        ("linear_quadratic", |u| -(3.0 * u + 9.0 * u * u), &[("D_x_I", 3.0), ("D_x_II", 9.0)]),
        ("power_law", |u| -12.0 * u.powf(1.8), &[("k_x", 12.0), ("n_x", 1.8)]),
    ];
    for (i, (law, truth, coefficients)) in truths.into_iter().enumerate() {
        let tallies = run(
            &campaign(""),
            seeds,
            130 + i as u128,
            |rng| rows(&speed, |_, u| truth(u) + 0.4 * normal(rng)),
            |found| {
                let index = found.models.iter().position(|m| m.law.name == law).unwrap_or_default();
                let of = |(name, truth): &(&str, f64)| {
                    let said = interval(found, index, name, *truth).unwrap_or(Said { holds: false, width: 0.0 });
                    (format!("interval of {name} if {law} is true"), said)
                };
                let mut out: Vec<(String, Said)> = coefficients.iter().map(of).collect();
                out.extend(bands_hold(found, &speed, truth));
                out
            },
        )?;
        for tally in &tallies {
            let is_interval = tally.name.starts_with("interval");
            let floor = if is_interval { 95.0 } else { 94.0 };
            judged(claims, &format!("{law} is true, three laws"), tally, floor, is_interval, "");
        }
    }
    Ok(())
}

/// Truths that no polynomial contains.
fn powers(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    let speed = sixteen();
    for (factor, exponent, sigma) in
        [(12.0, 1.6, 0.4), (12.0, 1.8, 0.2), (12.0, 1.8, 0.8), (55.0, 1.6, 1.2), (55.0, 1.8, 1.2)]
    {
        let truth = move |u: f64| -factor * u.powf(exponent);
        let tallies = run(
            &campaign(""),
            seeds,
            140 + (10.0 * exponent + 10.0 * sigma) as u128,
            |rng| rows(&speed, |_, u| truth(u) + sigma * normal(rng)),
            |found| bands_hold(found, &speed, truth),
        )?;
        for tally in &tallies {
            let what = format!("{factor} U^{exponent} at {sigma} N, three laws");
            judged(claims, &what, tally, 94.0, false, &format!(", mean half width {:.3}", tally.width()));
        }
    }
    Ok(())
}
