//! Steady tows on their twin, from raw series to intervals, as the example campaign declares them.

use std::error::Error;
use std::path::Path;

use froude::fit::coverage::Count;
use froude::identify::reduce::reduce_table;
use froude::identify::source::identify_observations;
use froude::methods::tank::observed::plan::{Expected, exact, expected};
use froude::methods::tank::observed::read::reduced;
use froude::methods::tank::observed::settings::Plan;
use froude::methods::tank::observed::twin::Twin;
use froude::methods::tank::steady::Steady;
use froude::methods::tank::steady::row::{Row, table};
use froude::records::campaign::{Campaign, SensorSpec, Source};
use froude::records::campaign_file::read_campaign;
use froude::records::estimate::Coefficient;
use indexmap::IndexMap;
use rayon::prelude::*;

use crate::claims::{Claims, Verdict};
use crate::family::{Bar, answered, between_runs, campaigns_of, covers, factors};
use crate::lints::{Codes, judged as judged_codes, of_scatter};

/// The coefficients of a fit: of thousands, nothing else is kept.
pub type Fitted = IndexMap<String, Coefficient>;

const SECTION: &str = "Steady tows: raw series by their twin";

pub fn all(claims: &mut Claims, root: &Path, seeds: usize) -> Result<(), Box<dyn Error>> {
    let campaign = read_campaign(&root.join("examples/mamba-steady/campaign.toml"))?;
    let source = Source { models: vec!["f4".to_owned()], model_places: Vec::new(), ..campaign.sources[0].clone() };
    let twin = Twin::<Steady>::of(&campaign, &source)?;
    let forecast = |sensors: &[SensorSpec]| -> Result<Vec<Expected>, Box<dyn Error>> {
        Ok(expected(&twin, &source, &exact(&twin, sensors)?.1, (sensors, false))?)
    };
    let sensors = campaign.simulate.as_ref().map_or(&[] as &[_], |s| s.sensors.as_slice());
    for (words, factor) in [("0.02 N", 1.0), ("0.2 N", 10.0)] {
        let louder = |s: &SensorSpec| SensorSpec {
            noise: s.noise.map(|n| if s.quantity == "speed" { n } else { factor * n }),
            ..s.clone()
        };
        let sensors: Vec<SensorSpec> = sensors.iter().map(louder).collect();
        let forecast = forecast(&sensors)?;
        let seeds = campaigns_of(factor == 1.0, seeds);
        let (fits, codes): (Vec<Fitted>, Vec<Codes>) = (0..seeds)
            .into_par_iter()
            .filter_map(|seed| one(&campaign, &source, &twin, &sensors, seed as u64).ok())
            .unzip();
        judged_codes(claims, SECTION, &format!("tests of the scatter at {words}, {seeds} sound campaigns"), codes);
        judge(claims, SECTION, &forecast, &fits, (words, "56 tows", factor == 1.0, seeds));
    }
    let seeds = seeds.min(2_000);
    let (fits, refused) = answered(seeds, |seed| {
        let plan = Plan { of_run: factors(twin.points.len(), seed), ..twin.plan.clone() };
        one(&campaign, &source, &Twin { plan, ..twin.clone() }, sensors, seed).map(|(fitted, _)| fitted)
    });
    let truths = forecast(sensors)?.into_iter().map(|e| (e.name, e.value));
    let each = covered(truths, &fits);
    between_runs(claims, SECTION, &format!("{seeds} campaigns of 56 tows"), &each, &refused);
    Ok(())
}

/// One campaign: logs, windows, rows, fit.
fn one(
    campaign: &Campaign,
    source: &Source,
    twin: &Twin<Steady>,
    sensors: &[SensorSpec],
    seed: u64,
) -> Result<(Fitted, Codes), Box<dyn Error + Send + Sync>> {
    let logged = twin.simulated(sensors, &source.uncertainty, 1 + seed);
    let found = logged.iter().map(|run| reduced(&twin.method, &run.view())).collect::<Result<Vec<_>, _>>()?;
    let rows: Vec<Row> = found.into_iter().map(Row::from).collect();
    let observations = reduce_table(campaign, source, &table(source.input.path(), &rows), Vec::new())?;
    let mut result = identify_observations(campaign, source, observations, "steady", &|_| {})?;
    Ok((result.estimates.remove(0).coefficients, of_scatter(&result.findings)))
}

/// How often the interval of each coefficient holds its truth.
pub fn covered(truths: impl Iterator<Item = (String, f64)>, fits: &[Fitted]) -> Vec<(String, Count)> {
    let of = |name: &str, truth: f64| {
        let mut count = Count::default();
        for fit in fits {
            let interval = fit.get(name).and_then(|c| c.interval_95);
            count.add(interval.is_some_and(|[low, high]| (low..=high).contains(&truth)));
        }
        count
    };
    truths.map(|(name, truth)| (name.clone(), of(&name, truth))).collect()
}

/// Coverage of the intervals, and the errors of the seeds beside the forecast.
pub fn judge(
    claims: &mut Claims,
    section: &'static str,
    forecast: &[Expected],
    fits: &[Fitted],
    (words, runs, is_judged, seeds): (&str, &str, bool, usize),
) {
    let expected: Vec<(&str, f64, f64)> =
        forecast.iter().map(|e| (e.name.as_str(), e.value, e.combined.standard)).collect();
    judged(claims, section, &expected, fits, (words, runs, is_judged, seeds), Bar::Exactly);
}

/// Widest mean interval of an approximation, over that with the noise known: Student's t of five clusters, the fewest that are taken, over a normal.
const WIDEST: f64 = 1.42;

/// The same of coefficients by name, truth and standard uncertainty to expect.
pub fn judged(
    claims: &mut Claims,
    section: &'static str,
    forecast: &[(&str, f64, f64)],
    fits: &[Fitted],
    (words, runs, is_judged, seeds): (&str, &str, bool, usize),
    bar: Bar,
) {
    let of = |fit: &Fitted, name: &str| fit.get(name).and_then(|c| Some((c.value?, c.interval_95?)));
    let mut counts = vec![Count::default(); forecast.len()];
    let (mut squares, mut widths) = (vec![0.0; forecast.len()], vec![0.0; forecast.len()]);
    for fit in fits {
        for (j, (name, truth, _)) in forecast.iter().enumerate() {
            let (truth, found) = (*truth, of(fit, name));
            counts[j].add(found.is_some_and(|(_, [low, high])| (low..=high).contains(&truth)));
            squares[j] += found.map_or(f64::NAN, |(value, _)| (value - truth).powi(2));
            widths[j] += found.map_or(f64::NAN, |(_, [low, high])| 0.5 * (high - low));
        }
    }
    let named: Vec<(String, Count)> = forecast.iter().map(|e| e.0.to_owned()).zip(counts).collect();
    covers(
        claims,
        section,
        &format!("intervals at {words} of correlated noise, {seeds} campaigns of {runs}: cover"),
        &named,
        (fits.len() == seeds, is_judged),
        bar,
    );
    let verdict = |holds: bool| Verdict::of(is_judged, holds);
    let ratios: Vec<f64> =
        (0..forecast.len()).map(|j| (squares[j] / fits.len() as f64).sqrt() / forecast[j].2).collect();
    // The root mean square of as many errors scatters by 1/√(2n).
    let allowance = 3.0 / (2.0 * seeds as f64).sqrt();
    let each: Vec<String> = forecast.iter().zip(&ratios).map(|(e, r)| format!("{} {r:.3}", e.0)).collect();
    let holds = ratios.iter().all(|r| (0.9 - allowance..=1.1 + allowance).contains(r));
    claims.add(
        section,
        &format!("error of the seeds over the plan's forecast at {words}"),
        &format!("0.9 to 1.1 (± {allowance:.2} for {seeds} seeds)"),
        each.join(", "),
        verdict(holds),
    );
    if bar == Bar::AtLeast {
        // A normal's U95 of the errors that the seeds have.
        let width = |j: usize| widths[j] / fits.len() as f64 / (1.96 * (squares[j] / fits.len() as f64).sqrt());
        let each: Vec<String> = forecast.iter().enumerate().map(|(j, e)| format!("{} {:.2}", e.0, width(j))).collect();
        claims.add(
            section,
            &format!("mean U95 over that with the noise known, at {words}"),
            &format!("{WIDEST} or less"),
            each.join(", "),
            verdict((0..forecast.len()).all(|j| width(j) <= WIDEST)),
        );
    }
}
