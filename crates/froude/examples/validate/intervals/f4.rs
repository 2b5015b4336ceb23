//! f4 of the snake robot in the circulation tank: many settings, two loads.

use std::path::Path;

use froude::identify::dataset::Dataset;
use froude::identify::law::ForceLaw;
use froude::identify::reduce::Observations;
use froude::identify::source::{SourceResult, identify_observations};
use froude::records::campaign::Campaign;
use froude::records::units::Dimension;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use super::{Failed, Said, Tally, band, judged, rare};
use crate::claims::Claims;
use crate::coverage::normal;
use crate::snake::{TABLE_3, configurations, planned, published};

/// Tables at most: one of 536 settings takes as long as fifty others.
const MOST: u64 = 2_000;

pub fn all(claims: &mut Claims, root: &Path, seeds: u64) -> Result<(), Failed> {
    let seeds = seeds.min(MOST);
    chosen(claims, root, seeds)?;
    scatter(claims, root, seeds)?;
    setups(claims, root, seeds)?;
    weighted(claims, root, seeds)
}

/// The tank with its published law: settings, and the loads there.
struct Tank {
    campaign: Campaign,
    data: Dataset,
    law: ForceLaw,
    values: Vec<f64>,
    truth: Vec<f64>,
}

/// What a load's error is of: the load in newtons, speed, angle.
type Size = fn([f64; 3]) -> f64;

impl Tank {
    /// So many of its settings, evenly drawn, under keys of `[identify]`.
    fn of(root: &Path, rows: Option<usize>, identify: &str) -> Result<Self, Failed> {
        let (campaign, all) = planned(TABLE_3, &configurations(1..=2), identify)?;
        let rows = rows.unwrap_or(all.rows);
        let data = all.subset(&(0..rows).map(|i| i * all.rows / rows).collect::<Vec<_>>());
        let (law, values) = published(root, "circulation_tank_restricted", "f4", &data)?;
        let truth = law.predict(&data, &values)?;
        Ok(Self { campaign, data, law, values, truth })
    }

    /// Answers of so many tables; `offset` is the standard deviation of the zero of each setup.
    fn ask(
        &self,
        (seeds, stream): (u64, u128),
        (size, offset): (Size, f64),
        judge: impl Fn(&SourceResult) -> Vec<Said> + Sync,
    ) -> Result<Vec<Vec<Said>>, String> {
        let n = self.data.rows;
        let channel = |name: &str| self.data.values(name).map_or_else(|| vec![0.0; n], <[f64]>::to_vec);
        let (speed, angle) = (channel("speed"), channel("angle"));
        let setups = froude::identify::dataset::labels(&self.data.setup);
        let one = |seed: u64| {
            let mut rng = Pcg64::new(u128::from(seed), stream);
            let mut data = self.data.clone();
            for (r, load) in self.law.responses.iter().enumerate() {
                let zeros: Vec<f64> =
                    setups.iter().map(|_| if offset > 0.0 { offset * normal(&mut rng) } else { 0.0 }).collect();
                let of = self.truth[r * n..(r + 1) * n].iter().enumerate();
                let noisy = of.map(|(i, f)| f + zeros[setups[i]] + size([*f, speed[i], angle[i]]) * normal(&mut rng));
                let noisy = noisy.collect();
                data.put(load, noisy, Dimension::FORCE);
            }
            let observations =
                Observations { n_read: n, data, findings: Vec::new(), shared_errors: Vec::new(), files: Vec::new() };
            identify_observations(&self.campaign, &self.campaign.sources[0], observations, "table", &|_| {})
        };
        (0..seeds).into_par_iter().map(|seed| one(seed).map(|found| judge(&found)).map_err(|e| e.to_string())).collect()
    }
}

/// Whether a code was found.
fn alarm(code: &'static str) -> impl Fn(&SourceResult) -> Vec<Said> + Sync {
    move |found| vec![Said { holds: found.findings.iter().any(|f| f.code == code), width: 0.0 }]
}

fn first(name: &str, said: &[Vec<Said>]) -> Tally {
    Tally::of(name, &said.iter().map(|said| said[0]).collect::<Vec<_>>())
}

/// Bands of the recommended law beside f1 to f6, at every setting and load.
fn chosen(claims: &mut Claims, root: &Path, seeds: u64) -> Result<(), Failed> {
    let tank = Tank::of(root, None, "models = [\"f1\", \"f2\", \"f3\", \"f4\", \"f5\", \"f6\"]")?;
    let n = tank.data.rows;
    let found = tank.ask((seeds, 150), (|_| 0.3, 0.0), |found| {
        let band = band(found);
        let said = |(truth, [_, low, high]): (&f64, &[f64; 3])| Said {
            holds: (low..=high).contains(&truth),
            width: 0.5 * (high - low),
        };
        tank.truth.iter().zip(&band).map(said).collect()
    })?;
    for (r, load) in tank.law.responses.iter().enumerate() {
        let of_setting = |i: usize| Tally::of("", &found.iter().map(|all| all[r * n + i]).collect::<Vec<_>>());
        let all: Vec<Tally> = (0..n).map(of_setting).collect();
        // A load that is zero by its law at some setting has no band there, and none to miss.
        let asked: Vec<&Tally> = all.iter().filter(|tally| tally.width > 0.0).collect();
        let least = asked.iter().min_by_key(|tally| tally.holds).ok_or("no setting")?;
        let least = Tally { name: format!("{load}, the least of {} settings", asked.len()), ..(*least).clone() };
        // The least of so many lies below the mean by the scatter of the count.
        let more = format!(", half width {:.3} N", least.width());
        judged(claims, "f4 of the tank at 0.3 N, f1 to f6 asked", &least, 94.0, false, &more);
    }
    Ok(())
}

/// Errors that go with the load, and equal ones.
fn scatter(claims: &mut Claims, root: &Path, seeds: u64) -> Result<(), Failed> {
    let tank = Tank::of(root, None, "models = [\"f4\"]")?;
    for (words, size) in [("equal", (|_| 0.1) as Size), ("as the load", |[f, ..]| 0.05 * f.abs())] {
        let found = tank.ask((seeds, 160 + words.len() as u128), (size, 0.0), alarm("uneven-scatter"))?;
        let tally = first("uneven-scatter", &found);
        let what = format!("f4 of the tank, {} settings, errors {words}", tank.data.rows);
        if words == "equal" { rare(claims, &what, &tally, 0.4) } else { judged(claims, &what, &tally, 99.0, false, "") }
    }
    Ok(())
}

/// Nine setups of fifteen settings, with a zero that nobody declares.
fn setups(claims: &mut Claims, root: &Path, seeds: u64) -> Result<(), Failed> {
    let mut tank = Tank::of(root, Some(135), "models = [\"f4\"]")?;
    tank.data.setup = (0..135).map(|i| format!("day {}", i % 9)).collect();
    for offset in [0.0, 0.7] {
        let found = tank.ask((seeds, 180 + (10.0 * offset) as u128), (|_| 0.1, 0.1 * offset), alarm("setup-offset"))?;
        let tally = first("setup-offset", &found);
        let what = format!("f4 of the tank, 9 setups of 15 settings, an undeclared zero of {offset} σ");
        if offset > 0.0 { judged(claims, &what, &tally, 90.0, false, "") } else { rare(claims, &what, &tally, 0.6) }
    }
    Ok(())
}

/// 45 settings under HC3, plain and with weights of a fitted variance, whatever the errors go with: the least coefficient.
fn weighted(claims: &mut Claims, root: &Path, seeds: u64) -> Result<(), Failed> {
    let errors: [(&str, Size); 4] = [
        ("as the load", |[f, ..]| 0.05 * f.abs()),
        ("equal", |_| 0.1),
        ("as the speed", |[_, u, _]| 0.2 * u),
        ("as the angle", |[_, _, angle]| 0.02 + 0.2 * angle.abs()),
    ];
    for (kind, key, floor) in [("HC3", "", 91.0), ("weights fitted, HC3", "\nweights = \"fitted\"", 94.0)] {
        let tank = Tank::of(root, Some(45), &format!("models = [\"f4\"]\ncovariance = \"HC3\"{key}"))?;
        for (k, (words, size)) in errors.iter().enumerate() {
            let found = tank.ask((seeds, 190 + k as u128), (*size, 0.0), |found| {
                let of = |(j, truth): (usize, &f64)| super::interval(found, 0, &tank.law.coefficients[j].name, *truth);
                let missed = Said { holds: false, width: 0.0 };
                tank.values.iter().enumerate().map(|at| of(at).unwrap_or(missed)).collect()
            })?;
            let of = |j: usize| {
                Tally::of(&tank.law.coefficients[j].name, &found.iter().map(|all| all[j]).collect::<Vec<_>>())
            };
            let all: Vec<Tally> = (0..tank.values.len()).map(of).collect();
            let least = all.iter().min_by_key(|tally| tally.holds).ok_or("no coefficient")?;
            let mean = all.iter().map(Tally::percent).sum::<f64>() / all.len() as f64;
            let more = format!(
                ", the least of {} coefficients; {mean:.2} % of all, mean width {:.3}",
                all.len(),
                least.width()
            );
            judged(claims, &format!("f4 of the tank, 45 settings, errors {words}, {kind}"), least, floor, false, &more);
        }
    }
    Ok(())
}
