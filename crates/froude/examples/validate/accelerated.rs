//! Accelerated tows on their twin, from logs to intervals, as the example campaign declares them.

use std::error::Error;
use std::path::Path;

use froude::identify::reduce::Observations;
use froude::identify::regression::Scatter;
use froude::identify::seam::Choice;
use froude::identify::source::{Asked, identify_laws};
use froude::methods::tank::accelerated_tow::law::asked;
use froude::methods::tank::accelerated_tow::plan::{Forecast, forecast};
use froude::methods::tank::accelerated_tow::reduce::reduce;
use froude::methods::tank::accelerated_tow::section::plan;
use froude::methods::tank::accelerated_tow::setup::without_rig;
use froude::methods::tank::accelerated_tow::simulate::{Simulated, Twin};
use froude::methods::tank::driven::spec::Point;
use froude::records::campaign::{Campaign, SensorSpec, Source};
use froude::records::campaign_file::read_campaign;
use rayon::prelude::*;

use crate::claims::Claims;
use crate::family::{Bar, campaigns_of};
use crate::steady::{Fitted, judged};

const SECTION: &str = "Accelerated tow: drag and added mass in one run, by its twin";

struct Case {
    campaign: Campaign,
    source: Source,
    twin: Twin,
}

impl Case {
    fn read(root: &Path, edit: impl Fn(&mut Vec<Point>)) -> Result<Self, Box<dyn Error>> {
        let campaign = read_campaign(&root.join("examples/mamba-accelerated/campaign.toml"))?;
        let source = campaign.sources[0].clone();
        let mut points = plan(&source)?;
        edit(&mut points);
        let twin = Twin::with(&campaign, &source, points)?;
        Ok(Self { campaign, source, twin })
    }

    fn sensors(&self, factor: f64) -> Vec<SensorSpec> {
        let sensors = self.campaign.simulate.as_ref().map_or(&[] as &[SensorSpec], |s| &s.sensors);
        sensors.iter().map(|s| SensorSpec { noise: s.noise.map(|n| factor * n), ..s.clone() }).collect()
    }

    fn forecast(&self, factor: f64) -> Result<Forecast, Box<dyn Error>> {
        Ok(forecast(&self.twin, &self.sensors(factor), &self.source)?)
    }

    fn one(&self, factor: f64, seed: u64) -> Result<Fitted, Box<dyn Error + Send + Sync>> {
        let logs = self.twin.simulated(&self.sensors(factor), seed).ok_or("no mass")?;
        let mounted: Vec<_> = logs.iter().map(Simulated::view).collect();
        let reduced = reduce(&mounted, &self.twin.setup).ok_or("no mass")?;
        let laws = asked(&self.campaign, &self.source, &reduced.data, &self.twin.setup.axis)?;
        let scatter = if reduced.is_by_run { Scatter::Cluster } else { Scatter::Serial(reduced.of_rows.clone()) };
        let observations = Observations {
            n_read: reduced.data.rows,
            data: reduced.data,
            findings: Vec::new(),
            shared_errors: reduced.errors,
            files: Vec::new(),
        };
        let asked = Asked { method: "accelerated_tow", laws, scatter, choice: Choice::Selection, has_budget: true };
        let mut result = identify_laws(&self.campaign, &without_rig(&self.source), observations, asked, &|_| {})?;
        Ok(result.estimates.remove(0).coefficients)
    }
}

pub fn all(claims: &mut Claims, root: &Path, seeds: usize) -> Result<(), Box<dyn Error>> {
    let nine = Case::read(root, |_| {})?;
    let one = Case::read(root, |points| {
        points.truncate(1);
        points[0].conditions.extend([("speed", 0.3), ("acceleration", 0.1)]);
    })?;
    // One run tells the correlation of its own noise only: its interval allows for what that may be.
    for (case, runs, bar) in [(&nine, "9 runs", Bar::Exactly), (&one, "1 run", Bar::AtLeast)] {
        for (words, factor) in [("20 mN", 1.0), ("200 mN", 10.0)] {
            let forecast = case.forecast(factor)?;
            let expected: Vec<(&str, f64, f64)> =
                forecast.expected.iter().map(|e| (e.name.as_str(), e.value, e.combined.standard)).collect();
            let seeds = campaigns_of(factor == 1.0, seeds);
            let fits: Vec<Fitted> =
                (0..seeds).into_par_iter().filter_map(|seed| case.one(factor, 1 + seed as u64).ok()).collect();
            judged(claims, SECTION, &expected, &fits, (words, runs, factor == 1.0, seeds), bar);
            if factor == 1.0 {
                correlation(claims, &forecast, &fits, runs);
            }
        }
    }
    Ok(())
}

/// Correlation of drag and added mass: forecast, and that of the seeds.
fn correlation(claims: &mut Claims, forecast: &Forecast, fits: &[Fitted], runs: &str) {
    let names: Vec<&str> = forecast.expected.iter().map(|e| e.name.as_str()).collect();
    let Some(added) = names.iter().position(|n| n.starts_with("C_A")) else { return };
    let value = |fit: &Fitted, k: usize| fit.get(names[k]).and_then(|c| c.value).unwrap_or(f64::NAN);
    let n = fits.len() as f64;
    let mean: Vec<f64> = (0..names.len()).map(|k| fits.iter().map(|f| value(f, k)).sum::<f64>() / n).collect();
    let product =
        |a: usize, b: usize| fits.iter().map(|f| (value(f, a) - mean[a]) * (value(f, b) - mean[b])).sum::<f64>();
    let others: Vec<usize> = (0..names.len()).filter(|k| *k != added).collect();
    let of_seeds = |k: usize| product(added, k) / (product(added, added) * product(k, k)).sqrt();
    // Fisher's z of as many seeds, three times.
    let allowance = 0.1 + 3.0 / (n - 3.0).sqrt();
    let holds = others.iter().all(|&k| (of_seeds(k) - forecast.correlation[(added, k)]).abs() <= allowance);
    let each: Vec<String> = (others.iter())
        .map(|&k| format!("{} {:+.2} planned, {:+.2} found", names[k], forecast.correlation[(added, k)], of_seeds(k)))
        .collect();
    claims.holds(
        SECTION,
        &format!("correlation of {} with the drag of {runs}", names[added]),
        &format!("as planned, ± {allowance:.2}"),
        each.join(", "),
        holds,
    );
}
