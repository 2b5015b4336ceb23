//! What is known from elsewhere: tares, bounds, priors, known coefficients.

use std::fmt::Write as _;

use froude::identify::source::{SourceResult, identify_source};
use froude::records::campaign::{Campaign, Source};
use froude::records::estimate::EstimateFile;
use froude::records::json::write_estimates;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::{Failed, ROOM, Said, Tally, alarm, campaign, interval, judged, rare, room, rows, run, sixteen};
use crate::claims::{Claims, Verdict};
use crate::coverage::normal;

pub fn all(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    tares(claims, seeds)?;
    bounds(claims, seeds)?;
    priors(claims, seeds)?;
    known(claims, seeds)
}

/// A tare of few runs, subtracted: its degrees of freedom go through.
fn tares(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    let speed = sixteen();
    for (runs, ratio) in [(2, 1.0), (3, 1.0), (4, 0.2), (4, 1.0), (4, 5.0), (4, 20.0), (8, 5.0)] {
        let found: Result<Vec<Said>, String> = (0..seeds)
            .into_par_iter()
            .map_init(
                || room(&campaign("models = [\"quadratic\"]\ntare = { record = \"tare.json\" }\n")),
                |room, seed| {
                    let (folder, campaign) = room.as_ref().map_err(Clone::clone)?;
                    let mut rng = Pcg64::new(u128::from(seed), 170 + runs as u128 * 100 + (10.0 * ratio) as u128);
                    let place = |name: &str| folder.path().join(name);
                    // u of a law of one coefficient is σ/√Σu⁴.
                    let of_tare: Vec<f64> = (0..runs).map(|i| 0.4 + 1.6 * f64::from(i) / f64::from(runs - 1)).collect();
                    let weight = |speed: &[f64]| speed.iter().map(|u| u.powi(4)).sum::<f64>();
                    let sigma = ratio * (weight(&of_tare) / weight(&speed)).sqrt();
                    let text = rows(&of_tare, |_, u| -7.0 * u * u + sigma * normal(&mut rng));
                    std::fs::write(place("table.csv"), text).map_err(|e| e.to_string())?;
                    let bare = Campaign {
                        sources: vec![Source { tare: None, ..campaign.sources[0].clone() }],
                        ..campaign.clone()
                    };
                    // A table that is refused holds nothing.
                    let Ok(tare) = identify_source(&bare, &bare.sources[0], &|_| {}) else {
                        return Ok(Said { holds: false, width: 0.0 });
                    };
                    write_estimates(&place("tare.json"), &EstimateFile::of(tare.estimates))
                        .map_err(|e| e.to_string())?;
                    let text = rows(&speed, |_, u| -57.0 * u * u + normal(&mut rng));
                    std::fs::write(place("table.csv"), text).map_err(|e| e.to_string())?;
                    let Ok(found) = identify_source(campaign, &campaign.sources[0], &|_| {}) else {
                        return Ok(Said { holds: false, width: 0.0 });
                    };
                    Ok(interval(&found, 0, "D_x_II", 50.0).unwrap_or(Said { holds: false, width: 0.0 }))
                },
            )
            .collect();
        let found = found?;
        let tally = Tally::of("D_x_II", &found);
        let what = format!("a tare of {runs} runs, u of it {ratio} times that of the fit");
        if runs >= 4 {
            judged(claims, &what, &tally, 94.0, false, &format!(", mean width {:.3}", tally.width()));
        } else {
            let found = format!("{:.2} % of {}, mean width {:.3}", tally.percent(), tally.count, tally.width());
            claims.add(
                ROOM,
                &format!("{what}: D_x_II"),
                "reported below three degrees of freedom",
                found,
                Verdict::Measured,
            );
        }
    }
    Ok(())
}

/// Four coefficients that are zero, bounded below by zero.
fn bounds(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    let speed = sixteen();
    let rest = "models = [\"four\"]\n[identify]\nbounds = { a = \"non-negative\", b = \"non-negative\", c = \"non-negative\", d = \"non-negative\" }\n\
                [[identify.model]]\nname = \"four\"\nf_x = \"-D*v_x*abs(v_x) - a*v_x - b*v_x^3 - c*v_x^5 - d*v_x^7\"\n";
    let table = |rng: &mut Pcg64| rows(&speed, |_, u| -12.0 * u * u + normal(rng));
    for tally in run(&campaign(rest), seeds, 190, table, alarm("bound-contradicted"))? {
        rare(claims, "four bounds at which the truth lies", &tally, 1.0);
    }
    Ok(())
}

/// A prior that is so many of its own standard uncertainties off, and as uncertain as the data.
fn priors(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    let speed = sixteen();
    let u_d = 1.0 / speed.iter().map(|u| u.powi(4)).sum::<f64>().sqrt();
    for off in [0.0, 1.0, 2.0, 3.0, 4.0, 5.0, 6.0] {
        let prior = format!(
            "models = [\"quadratic\"]\n[identify]\nprior = [{{ coefficient = \"D_x_II\", value = {}, standard_uncertainty = {u_d} }}]\n",
            12.0 + off * u_d
        );
        let table = |rng: &mut Pcg64| rows(&speed, |_, u| -12.0 * u * u + normal(rng));
        let judge = |found: &SourceResult| {
            let is_said = found.findings.iter().any(|f| f.code == "prior-contradicted");
            let covered =
                interval(found, 0, "D_x_II", 12.0).map(|said| ("its interval holds the truth".to_owned(), said));
            [("prior-contradicted".to_owned(), Said { holds: is_said, width: 0.0 })]
                .into_iter()
                .chain(covered)
                .collect()
        };
        for tally in run(&campaign(&prior), seeds, 195 + off as u128, table, judge)? {
            let found = format!("{:.2} % of {}", tally.percent(), tally.count);
            let what = format!("a prior {off} standard uncertainties off, the data as uncertain: {}", tally.name);
            claims.add(ROOM, &what, "the power of the 1 % test, and what is left of 95 %", found, Verdict::Measured);
        }
    }
    Ok(())
}

/// A mass that is known from elsewhere to 10 %: what it does to the drag beside it, held against the same without its uncertainty.
fn known(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    const MASS_KG: [f64; 2] = [20.0, 2.0];
    let table = |rng: &mut Pcg64| {
        let mass = MASS_KG[0] + MASS_KG[1] * normal(rng);
        let mut out = "v_x [m/s],v_x_dot [m/s^2],f_x [N]\n".to_owned();
        for i in 0..24 {
            let u = 0.3 + 0.05 * f64::from(i);
            // Faster runs speed up more.
            let a = 0.2 * u + 0.1 * f64::from(i % 3);
            let _ = writeln!(out, "{u},{a},{}", -12.0 * u * u - mass * a + 0.2 * normal(rng));
        }
        out
    };
    let law = "models = [\"towed\"]\n[[identify.model]]\nname = \"towed\"\nf_x = \"-D*v_x*abs(v_x) - A*v_x_dot\"\n";
    let judge =
        |found: &SourceResult| interval(found, 0, "D", 12.0).map(|said| ("D".to_owned(), said)).into_iter().collect();
    let [value, standard] = MASS_KG;
    let stated = format!(
        "{law}[[identify.known]]\ncoefficient = \"A\"\nvalue = \"{value} kg\"\nstandard_uncertainty = \"{standard} kg\"\n"
    );
    for tally in run(&campaign(&stated), seeds, 198, table, judge)? {
        let what = "a mass known to 10 % beside the drag";
        judged(claims, what, &tally, 94.0, false, &format!(", mean width {:.3}", tally.width()));
    }
    let fixed = format!("{law}[identify.fixed]\nA = \"{value} kg\"\n");
    for tally in run(&campaign(&fixed), seeds, 198, table, judge)? {
        let found = format!("{:.2} % of {}, mean width {:.3}", tally.percent(), tally.count, tally.width());
        claims.add(ROOM, "the same mass fixed, as if it were exact: D", "how wrong that is", found, Verdict::Measured);
    }
    Ok(())
}
