//! What 95 % means at the verb: tables of a known truth go through a campaign as a user's do, and what the answer says is counted.
//!
//! Every row has its own generator and seeds. Rows that are exact are judged two-sided at their binomial scatter, approximate ones against their floor.

use std::error::Error;
use std::fmt::Write as _;
use std::path::Path;

use froude::identify::reduce::Observations;
use froude::identify::regression::ModelFit;
use froude::identify::source::{SourceResult, identify_observations, identify_source};
use froude::records::campaign::{Campaign, Source, read_campaign};
use froude::records::estimate::EstimateFile;
use froude::records::json::write_estimates;
use froude::records::units::Dimension;
use rand::seq::SliceRandom;
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::claims::{Claims, Verdict};
use crate::coverage::normal;
use crate::snake::{TABLE_3, configurations, planned, published};

const ROOM: &str = "What 95 % means: intervals and tests at the verb";
/// Standard deviations of a count that a row may lie off.
const BAND: f64 = 3.0;

/// Tables of the tank's 536 settings at most: each takes as long as fifty others.
const MOST_OF_F4: u64 = 2_000;

/// What answers without an interval are counted under.
const WITHOUT: &str = "no interval";
/// What tables that are refused are counted under.
const REFUSED: &str = "refused";

type Failed = Box<dyn Error>;

/// What one table's answer says of a question: held or not, and how wide.
#[derive(Debug, Clone, Copy)]
pub struct Said {
    pub holds: bool,
    pub width: f64,
}

/// A question over all seeds.
#[derive(Debug, Clone, Default)]
pub struct Tally {
    name: String,
    holds: u64,
    width: f64,
    count: u64,
}

impl Tally {
    pub fn percent(&self) -> f64 {
        100.0 * self.holds as f64 / self.count as f64
    }

    fn width(&self) -> f64 {
        self.width / self.count as f64
    }
}

/// Tables of seeds through one campaign; `table` writes the rows, `judge` reads the answer. A table without answer is counted as one that does not hold.
pub fn run(
    campaign: &str,
    seeds: u64,
    stream: u128,
    table: impl Fn(&mut Pcg64) -> String + Sync,
    judge: impl Fn(&SourceResult) -> Vec<(String, Said)> + Sync,
) -> Result<Vec<Tally>, Failed> {
    let found: Result<Vec<Vec<(String, Said)>>, String> = (0..seeds)
        .into_par_iter()
        .map_init(
            || room(campaign),
            |room, seed| {
                let (folder, campaign) = room.as_ref().map_err(Clone::clone)?;
                let text = table(&mut Pcg64::new(u128::from(seed), stream));
                std::fs::write(folder.path().join("table.csv"), text).map_err(|e| e.to_string())?;
                // A refusal is an answer too, and holds nothing.
                Ok(match identify_source(campaign, &campaign.sources[0], &|_| {}) {
                    Ok(found) => judge(&found),
                    Err(_) => vec![(REFUSED.to_owned(), Said { holds: false, width: 0.0 })],
                })
            },
        )
        .collect();
    let mut out: Vec<Tally> = Vec::new();
    for (name, said) in found?.into_iter().flatten() {
        let place = out.iter().position(|tally| tally.name == name).unwrap_or_else(|| {
            out.push(Tally { name, ..Tally::default() });
            out.len() - 1
        });
        let tally = &mut out[place];
        tally.holds += u64::from(said.holds);
        tally.width += said.width;
        tally.count += 1;
    }
    Ok(out)
}

/// A folder with a campaign, which is read once.
pub fn room(text: &str) -> Result<(tempfile::TempDir, Campaign), String> {
    let shared = Path::new("/dev/shm");
    let folder = if shared.is_dir() { tempfile::tempdir_in(shared) } else { tempfile::tempdir() };
    let folder = folder.map_err(|e| e.to_string())?;
    let path = folder.path().join("campaign.toml");
    // What a campaign names has to be there when it is read.
    std::fs::write(folder.path().join("tare.json"), "{}").map_err(|e| e.to_string())?;
    std::fs::write(&path, text).map_err(|e| e.to_string())?;
    std::fs::write(folder.path().join("table.csv"), "speed [m/s],f_x [N]\n1,-1\n").map_err(|e| e.to_string())?;
    let campaign = read_campaign(&path).map_err(|e| e.to_string())?;
    Ok((folder, campaign))
}

/// A campaign of one table, with more keys of its source and sections.
pub fn campaign(rest: &str) -> String {
    format!(
        "schema = 1\nname = \"a known truth\"\n[fluid]\ndensity = \"1000 kg/m^3\"\n[[source]]\nname = \"tank\"\nkind = \"towing\"\ntable = \"table.csv\"\n{rest}"
    )
}

/// The recommended law of an answer.
fn recommended(found: &SourceResult) -> Option<&ModelFit> {
    found.models.get(found.recommendation.as_ref()?.index)
}

/// The same under a name, or that there is none.
fn told(found: &SourceResult, name: &str, truth: f64, words: &str) -> (String, Said) {
    interval(found, 0, name, truth).map_or_else(
        || (format!("{name}{words}: {WITHOUT}"), Said { holds: false, width: 0.0 }),
        |said| (format!("{name}{words}"), said),
    )
}

/// Whether the interval of a coefficient in the record of a law holds a truth.
fn interval(found: &SourceResult, index: usize, name: &str, truth: f64) -> Option<Said> {
    let [low, high] = found.estimates.get(index)?.coefficients.get(name)?.interval_95?;
    Some(Said { holds: low <= truth && truth <= high, width: high - low })
}

/// The 95 % band of the first load at each row: the force, and half its width.
fn bands(model: &ModelFit, data: &froude::identify::dataset::Dataset) -> Option<Vec<[f64; 2]>> {
    let at = model.law_coefficients();
    let (force, slopes) = (model.law.predict(data, at).ok()?, model.law.regressors(data, at).ok()?);
    let n = data.rows;
    let of = |row: usize| {
        let r = row / n;
        let line: Vec<f64> = (0..slopes.ncols()).map(|j| slopes[(row, j)]).collect();
        let [below, above] = model.arms(&line, model.scatter_dof(&slopes, r * n..(r + 1) * n));
        [force[row], 0.5 * (below + above)]
    };
    Some((0..force.len()).map(of).collect())
}

/// Counts beside a floor: an exact row two-sided, another one from below.
fn judged(claims: &mut Claims, what: &str, tally: &Tally, floor: f64, exact: bool, more: &str) {
    let n = tally.count as f64;
    let scatter = BAND * 100.0 * (0.01 * floor * (1.0 - 0.01 * floor) / n).sqrt();
    let found = tally.percent();
    if tally.name == REFUSED {
        claims.holds(
            ROOM,
            &format!("{what}: tables refused"),
            "1 at most",
            format!("{} of those asked", tally.count),
            n <= 1.0,
        );
        return;
    }
    if tally.name.ends_with(WITHOUT) {
        let found = format!("{} tables, and the count beside is of the others", tally.count);
        claims.add(ROOM, &format!("{what}: {}", tally.name), "reported", found, Verdict::Measured);
        return;
    }
    let holds = found >= floor - scatter && (!exact || found <= floor + scatter);
    let band =
        if exact { format!("{floor} ± {scatter:.2} %") } else { format!("{floor} % at least, less {scatter:.2}") };
    claims.holds(
        ROOM,
        &format!("{what}: {}", tally.name),
        &band,
        format!("{found:.2} % of {}{more}", tally.count),
        holds,
    );
}

/// All rows; `seeds` tables each.
pub fn all(claims: &mut Claims, root: &Path, seeds: u64) -> Result<(), Failed> {
    selection(claims, seeds)?;
    powers(claims, seeds)?;
    of_f4(claims, root, seeds.min(MOST_OF_F4))?;
    tares(claims, seeds)?;
    bounds(claims, seeds)?;
    priors(claims, seeds)?;
    known(claims, seeds)?;
    clusters(claims, seeds)?;
    leverage(claims, seeds)?;
    setups(claims, seeds)?;
    neighbours(claims, seeds)?;
    uneven(claims, seeds)?;
    Ok(())
}

/// Speeds of 16 runs.
fn sixteen() -> Vec<f64> {
    (0..16).map(|i| 0.2 + 0.12 * f64::from(i)).collect()
}

fn rows(speed: &[f64], force: impl FnMut(usize, f64) -> f64) -> String {
    let mut force = force;
    let mut out = "speed [m/s],f_x [N]\n".to_owned();
    for (i, u) in speed.iter().enumerate() {
        let _ = writeln!(out, "{u},{}", force(i, *u));
    }
    out
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
        for tally in &tallies {
            let what = format!("a linear term of {size} u beside 55 U², three laws");
            judged(claims, &what, tally, 94.0, false, &format!(", mean width {:.3}", tally.width()));
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

/// The tank's f4 at 0.3 N beside f1 to f6, at every setting and load; and errors that go with the load.
fn of_f4(claims: &mut Claims, root: &Path, seeds: u64) -> Result<(), Failed> {
    const SIGMA: f64 = 0.3;
    let laws = "models = [\"f1\", \"f2\", \"f3\", \"f4\", \"f5\", \"f6\"]";
    let (campaign, data) = planned(TABLE_3, &configurations(1..=2), laws)?;
    let (law, values) = published(root, "circulation_tank_restricted", "f4", &data)?;
    let truth = law.predict(&data, &values)?;
    let ask =
        |stream: u128, size: &(dyn Fn(f64) -> f64 + Sync), judge: &(dyn Fn(&SourceResult) -> Vec<Said> + Sync)| {
            let found: Result<Vec<Vec<Said>>, String> = (0..seeds)
                .into_par_iter()
                .map(|seed| {
                    let mut rng = Pcg64::new(u128::from(seed), stream);
                    let mut data = data.clone();
                    for (r, load) in law.responses.iter().enumerate() {
                        let of = &truth[r * data.rows..(r + 1) * data.rows];
                        let noisy = of.iter().map(|f| f + size(*f) * normal(&mut rng)).collect();
                        data.put(load, noisy, Dimension::FORCE);
                    }
                    let observations = Observations {
                        n_read: data.rows,
                        data,
                        findings: Vec::new(),
                        shared_errors: Vec::new(),
                        files: Vec::new(),
                    };
                    let found = identify_observations(&campaign, &campaign.sources[0], observations, "table", &|_| {});
                    found.map(|found| judge(&found)).map_err(|e| e.to_string())
                })
                .collect();
            found
        };
    let found = ask(150, &|_| SIGMA, &|found| {
        let band = recommended(found).and_then(|m| bands(m, &found.data)).unwrap_or_default();
        let said =
            |(truth, [force, half]): (&f64, &[f64; 2])| Said { holds: (force - truth).abs() <= *half, width: *half };
        truth.iter().zip(&band).map(said).collect()
    })?;
    for (r, load) in law.responses.iter().enumerate() {
        let of_setting = |i: usize| {
            let said = || found.iter().map(|all| all[r * data.rows + i]);
            let holds = said().filter(|said| said.holds).count() as u64;
            Tally { name: String::new(), holds, width: said().map(|s| s.width).sum(), count: seeds }
        };
        let all: Vec<Tally> = (0..data.rows).map(of_setting).collect();
        // A load that is zero by its law at some setting has no band there, and none to miss.
        let asked: Vec<&Tally> = all.iter().filter(|tally| tally.width > 0.0).collect();
        let least = asked.iter().min_by_key(|tally| tally.holds).ok_or("no setting")?;
        let least = Tally { name: format!("{load}, the least of {} settings", asked.len()), ..(*least).clone() };
        // The least of so many lies below the mean by the scatter of the count.
        judged(
            claims,
            "f4 of the tank at 0.3 N, f1 to f6 asked",
            &least,
            94.0,
            false,
            &format!(", half width {:.3} N", least.width()),
        );
    }
    let alarm = |found: &SourceResult| {
        vec![Said { holds: found.findings.iter().any(|f| f.code == "uneven-scatter"), width: 0.0 }]
    };
    for (words, size) in [("equal", (|_| 0.1) as fn(f64) -> f64), ("as the load", |f: f64| 0.05 * f.abs())] {
        let found = ask(160 + words.len() as u128, &size, &alarm)?;
        let holds = found.iter().filter(|said| said[0].holds).count() as u64;
        let tally = Tally { name: "uneven-scatter".to_owned(), holds, width: 0.0, count: seeds };
        let what = format!("f4 of the tank, {} settings, errors {words}", data.rows);
        if words == "equal" { rare(claims, &what, &tally, 0.4) } else { judged(claims, &what, &tally, 99.0, false, "") }
    }
    Ok(())
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
        let tally = Tally {
            name: "D_x_II".to_owned(),
            holds: found.iter().filter(|said| said.holds).count() as u64,
            width: found.iter().map(|said| said.width).sum(),
            count: seeds,
        };
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

/// One cluster of forty rows and five of four, with an error that the rows of a cluster share.
fn clusters(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    for (words, sizes) in [
        ("one cluster of 40 and five of 4", vec![40, 4, 4, 4, 4, 4]),
        ("two clusters of 40 and six of 4", vec![40, 40, 4, 4, 4, 4, 4, 4]),
        ("clusters of 12, 10, 8, 6, 4, 4", vec![12, 10, 8, 6, 4, 4]),
        ("six clusters of 8", vec![8; 6]),
    ] {
        let rest = "group = \"group\"\nmodels = [\"quadratic\"]\n[identify]\ncovariance = \"cluster\"\n";
        let tallies = run(
            &campaign(rest),
            seeds,
            200 + sizes.len() as u128 * 50 + sizes[0] as u128,
            |rng| {
                let mut out = "speed [m/s],f_x [N],group\n".to_owned();
                for (g, n) in sizes.iter().enumerate() {
                    let shared = normal(rng);
                    for i in 0..*n {
                        let u = 0.2 + (f64::from(i) + 0.5) / f64::from(*n);
                        let _ = writeln!(out, "{u},{},day {g}", -20.0 * u * u + shared + normal(rng));
                    }
                }
                out
            },
            |found| {
                let dof = found.models[0].fit.coefficients[0].dof.unwrap_or(f64::NAN);
                let said = interval(found, 0, "D_x_II", 20.0);
                let is_refused = found.findings.iter().any(|f| f.code == "one-group-decides");
                match said {
                    Some(said) => vec![(format!("D_x_II by CR3 with {dof:.2} degrees of freedom"), said)],
                    None => vec![(
                        format!("refused by name at {dof:.2} degrees of freedom"),
                        Said { holds: is_refused, width: 0.0 },
                    )],
                }
            },
        )?;
        for tally in &tallies {
            let floor = if tally.name.starts_with("refused") { 100.0 } else { 94.0 };
            judged(claims, words, tally, floor, false, &format!(", mean width {:.3}", tally.width()));
        }
    }
    Ok(())
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

/// Six setups of eight rows with a zero each: declared, estimated, and not declared.
fn setups(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    let table = |offset: f64| {
        move |rng: &mut Pcg64| {
            let mut out = "speed [m/s],f_x [N],setup\n".to_owned();
            for setup in 0..6 {
                let zero = offset * normal(rng);
                for i in 0..8 {
                    let u = 0.3 + 0.2 * f64::from(i);
                    let _ = writeln!(out, "{u},{},day {setup}", -(3.0 * u + 12.0 * u * u) + zero + normal(rng));
                }
            }
            out
        }
    };
    let judge = |found: &SourceResult| {
        let of = |name: &str, truth| interval(found, 0, name, truth).map(|said| (name.to_owned(), said));
        [of("D_x_I", 3.0), of("D_x_II", 12.0)].into_iter().flatten().collect::<Vec<_>>()
    };
    let laws = "models = [\"linear_quadratic\"]\n";
    let declared = format!(
        "{laws}[[source.uncertainty]]\nname = \"zero\"\nquantity = \"f_x\"\nstandard = \"1 N\"\nshared = \"setup\"\n"
    );
    for tally in run(&campaign(&declared), seeds, 400, table(1.0), judge)? {
        judged(
            claims,
            "6 setups of 8 rows, their zero of 1 σ declared",
            &tally,
            95.0,
            true,
            &format!(", mean width {:.3}", tally.width()),
        );
    }
    let estimated = format!("group = \"setup\"\n{laws}[identify]\ngroup_offset = \"estimate\"\n");
    for tally in run(&campaign(&estimated), seeds, 401, table(1.0), judge)? {
        judged(
            claims,
            "the same with an offset of each setup estimated",
            &tally,
            95.0,
            true,
            &format!(", mean width {:.3}", tally.width()),
        );
    }
    for (size, floor) in [(0.0, None), (1.0, Some(80.0))] {
        for tally in run(&campaign(laws), seeds, 402 + (10.0 * size) as u128, table(size), alarm("setup-offset"))? {
            let what = format!("6 setups of 8 rows, an undeclared zero of {size} σ");
            match floor {
                Some(floor) => judged(claims, &what, &tally, floor, false, ""),
                None => rare(claims, &what, &tally, 0.6),
            }
        }
    }
    Ok(())
}

/// Alarms of sound tables: at most so many per cent.
fn rare(claims: &mut Claims, what: &str, tally: &Tally, level: f64) {
    let scatter = BAND * 100.0 * (0.01 * level * (1.0 - 0.01 * level) / tally.count as f64).sqrt();
    let found = tally.percent();
    let band = format!("{level} % at most, and {scatter:.2}");
    claims.holds(
        ROOM,
        &format!("{what}: {}", tally.name),
        &band,
        format!("{found:.2} % of {}", tally.count),
        found <= level + scatter,
    );
}

/// Errors that follow each other by 0.8, in 16 to 48 rows: whether it is seen, and what intervals by four blocks hold then.
fn neighbours(claims: &mut Claims, seeds: u64) -> Result<(), Failed> {
    const NOISE_N: f64 = 0.2;
    for (n, floor, of_blocks) in [(16, 50.0, 91.0), (24, 80.0, 91.0), (30, 90.0, 93.0), (48, 99.0, 93.0)] {
        let table = |rho: f64, linear: f64| {
            move |rng: &mut Pcg64| {
                let mut error = normal(rng);
                let mut order: Vec<usize> = (0..n).collect();
                order.shuffle(rng);
                let speed: Vec<f64> = order.iter().map(|i| 0.3 + 1.5 * *i as f64 / n as f64).collect();
                rows(&speed, |_, u| {
                    error = rho * error + (1.0 - rho * rho).sqrt() * normal(rng);
                    -(linear * u + 12.0 * u * u) + NOISE_N * error
                })
            }
        };
        let law = "models = [\"linear_quadratic\"]\n";
        for rho in [0.0, 0.8] {
            let what = format!("{n} rows in random order whose errors follow each other by {rho}");
            for tally in run(&campaign(law), seeds, 500 + n as u128, table(rho, 4.0), alarm("serial-correlation"))? {
                if rho > 0.0 {
                    judged(claims, &what, &tally, floor, false, "");
                } else {
                    rare(claims, &what, &tally, 0.6);
                }
            }
        }
        let judge = |found: &SourceResult| {
            [("D_x_I", 4.0), ("D_x_II", 12.0)].map(|(name, truth)| told(found, name, truth, " by four blocks")).to_vec()
        };
        let rest = format!("{law}[identify]\ncovariance = \"blocks\"\n");
        for tally in run(&campaign(&rest), seeds, 600 + n as u128, table(0.8, 4.0), judge)? {
            let what = format!("{n} rows in random order whose errors follow each other by 0.8, two coefficients");
            judged(claims, &what, &tally, of_blocks, false, &format!(", mean width {:.3}", tally.width()));
        }
        // One coefficient averages over blocks of unequal speeds, and neighbours across their borders are alike.
        let rest = "models = [\"quadratic\"]\n[identify]\ncovariance = \"blocks\"\n";
        let judge = |found: &SourceResult| vec![told(found, "D_x_II", 12.0, " by four blocks")];
        for tally in run(&campaign(rest), seeds, 650 + n as u128, table(0.8, 0.0), judge)? {
            if tally.name.ends_with(WITHOUT) {
                continue;
            }
            claims.add(
                ROOM,
                &format!(
                    "{n} rows in random order whose errors follow each other by 0.8, one coefficient: {}",
                    tally.name
                ),
                &format!("{of_blocks} % wanted"),
                format!(
                    "{:.2} % of {}, of {seeds} with an interval, mean width {:.3}",
                    tally.percent(),
                    tally.count,
                    tally.width()
                ),
                Verdict::Measured,
            );
        }
    }
    Ok(())
}

/// Whether a finding of a code is there.
fn alarm(code: &'static str) -> impl Fn(&SourceResult) -> Vec<(String, Said)> + Sync {
    move |found| vec![(code.to_owned(), Said { holds: found.findings.iter().any(|f| f.code == code), width: 0.0 })]
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
