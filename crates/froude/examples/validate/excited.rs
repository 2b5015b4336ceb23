//! Excited response: the real section of NTNU by the verb, and the coverage of its twin.

use std::error::Error;
use std::path::Path;

use froude::fit::coverage::Count;
use froude::methods::tank::excited_response::plan::forecast;
use froude::methods::tank::excited_response::section::{plan, setup_of};
use froude::methods::tank::excited_response::simulate::{Simulated, planned, simulated, truth};
use froude::methods::tank::excited_response::{AtPeriod, WaveRun, fit};
use froude::pipeline::{Identified, Job, identify};
use froude::records::campaign_file::read_campaign;
use froude::records::estimate::{Coefficient, Status};
use rayon::prelude::*;

use crate::claims::{Claims, Verdict};
use crate::family::{Bar, campaigns_of, covers};

const REAL: &str = "Excited response: a ship section in waves (NTNU)";
const TWIN: &str = "Excited response: held and free runs by their twin";
const EXAMPLE: &str = "examples/ntnu-section";
/// A33 from accelerometers by the preparer of the data, kg, and how near it is to be.
const ADDED: [(f64, f64, f64); 4] = [(1.210, 31.8, 1.0), (1.074, 31.3, 1.0), (0.802, 32.7, 1.0), (0.733, 35.7, 2.5)];
/// Skew of the camera's clock, ms/s, likewise; `None` where offset and skew do not align it.
const CLOCKS: [(&str, Option<f64>); 4] =
    [("6041_1", Some(-7.3)), ("6041_2", Some(-6.6)), ("6081_1", Some(8.5)), ("6111_1", None)];
/// The window of the example.
const WINDOW: &str = "window    = { from = \"14 s\", to = \"20.5 s\" }";

pub fn all(claims: &mut Claims, root: &Path, shared: &Path, seeds: usize) -> Result<(), Box<dyn Error>> {
    real(claims, root, shared)?;
    coverage(claims, root, seeds)
}

/// The whole logs at 200 Hz with the example's sidecars, identified with another window.
fn identified(root: &Path, shared: &Path, window: &str) -> Result<Option<Identified>, Box<dyn Error>> {
    let folder = tempfile::tempdir()?;
    let waves = folder.path().join("waves");
    std::fs::create_dir(&waves)?;
    for entry in std::fs::read_dir(root.join(EXAMPLE).join("waves"))? {
        let path = entry?.path();
        let Some(name) = path.file_name() else { continue };
        let from = if path.extension().is_some_and(|e| e == "csv") {
            shared.join("ntnu-2d-section").join(name)
        } else {
            path.clone()
        };
        if !from.exists() {
            return Ok(None);
        }
        // Not its permissions: the data may be read-only.
        std::fs::write(waves.join(name), std::fs::read(from)?)?;
    }
    let text = std::fs::read_to_string(root.join(EXAMPLE).join("campaign.toml"))?;
    if !text.contains(WINDOW) {
        return Err(format!("{EXAMPLE}/campaign.toml has no {WINDOW}").into());
    }
    let campaign = folder.path().join("campaign.toml");
    std::fs::write(&campaign, text.replace(WINDOW, window))?;
    let mut job = Job::new(campaign);
    job.out = Some(folder.path().join("results"));
    Ok(Some(identify(&job, &|_| {})?))
}

fn coefficient(done: &Identified, period_s: f64, name: &str) -> Result<Coefficient, Box<dyn Error>> {
    let of = format!("at {period_s:.3} s");
    let found = done.file.estimates.iter().find(|e| e.id.ends_with(&of)).and_then(|e| e.coefficients.get(name));
    found.cloned().ok_or_else(|| format!("no {name} {of}").into())
}

fn real(claims: &mut Claims, root: &Path, shared: &Path) -> Result<(), Box<dyn Error>> {
    let Some(done) = identified(root, shared, WINDOW)? else {
        let place = shared.join("ntnu-2d-section");
        claims.add(
            REAL,
            "A33, B33 and the camera's clock",
            "",
            format!("{} is not there", place.display()),
            Verdict::Skipped,
        );
        return Ok(());
    };
    for (period_s, kg, within) in ADDED {
        let found = coefficient(&done, period_s, "A33")?;
        let half = found.interval_95.map_or(f64::NAN, |[low, high]| 0.5 * (high - low));
        let claim = format!("A33 from accelerometers in waves of {period_s:.3} s, kg (U95 {half:.1})");
        claims.near(REAL, &claim, found.value.unwrap_or(f64::NAN), kg, within, "data README, by its preparer");
    }
    for (run, skew) in CLOCKS {
        let of_run = |f: &&froude::records::finding::Finding| f.code.starts_with("camera") && f.message.contains(run);
        let found = done.file.findings.iter().find(of_run);
        let text = found.map_or_else(|| "nothing".to_owned(), |f| f.message.clone());
        let number = |after: &str| {
            let rest = text.split(after).nth(1).unwrap_or_default().trim_start();
            rest.split([' ', ',']).next().and_then(|x| x.parse::<f64>().ok()).unwrap_or(f64::NAN)
        };
        let (bar, holds) = match skew {
            Some(skew) => (
                format!("skew {skew:+.1} ± 1.5 ms/s, gain 0.86 to 0.87, not repaired"),
                (number("skew ") - skew).abs() <= 1.5
                    && (0.855..0.875).contains(&number("gain "))
                    && text.contains("reported and not repaired"),
            ),
            None => ("not alignable by offset and skew".to_owned(), text.contains("not alignable by offset and skew")),
        };
        claims.holds(REAL, &format!("what is said of the camera of sway_clamped_{run}"), &bar, text, holds);
    }
    damping(claims, root, shared)
}

/// B33 at 1.21 s by the window, and without one.
fn damping(claims: &mut Claims, root: &Path, shared: &Path) -> Result<(), Box<dyn Error>> {
    let mut each = Vec::new();
    for (from, to) in [(14.0, 20.5), (12.0, 22.0), (15.0, 25.0), (18.0, 30.0)] {
        let window = format!("window    = {{ from = \"{from} s\", to = \"{to} s\" }}");
        let Some(done) = identified(root, shared, &window)? else { return Ok(()) };
        each.push((from, to, coefficient(&done, 1.210, "B33")?.value.unwrap_or(f64::NAN)));
    }
    let words: Vec<String> = each.iter().map(|(from, to, b)| format!("{b:.0} from {from} s to {to} s")).collect();
    // Where the windows of the figures end is not stated: ten seconds are taken, and what differs is said.
    let is_near = each[1..].iter().zip([108.0, 125.0, 176.0]).all(|((.., b), figure)| (b - figure).abs() < 5.0);
    claims.add(
        REAL,
        "B33 in waves of 1.210 s by the window, N s/m",
        "108, 125, 176 from 12, 15, 18 s after the start (data README): it follows the window",
        words.join(", "),
        if is_near { Verdict::Pass } else { Verdict::Finding },
    );
    let Some(done) = identified(root, shared, "# no window")? else { return Ok(()) };
    let is_undetermined = |period: f64| coefficient(&done, period, "B33").map(|b| b.status == Status::Undetermined);
    let without = ADDED.iter().map(|(period, ..)| is_undetermined(*period)).collect::<Result<Vec<bool>, _>>()?;
    let added =
        ADDED.iter().map(|(period, ..)| coefficient(&done, *period, "A33").map(|a| a.value.unwrap_or(f64::NAN)));
    let added: Vec<String> = added.collect::<Result<Vec<f64>, _>>()?.iter().map(|a| format!("{a:.1}")).collect();
    claims.holds(
        REAL,
        "without a declared window",
        "B33 undetermined, A33 stands",
        format!(
            "B33 undetermined at {} of 4 periods, A33 {} kg",
            without.iter().filter(|x| **x).count(),
            added.join(", ")
        ),
        without.iter().all(|x| *x),
    );
    Ok(())
}

/// Intervals over seeds, mass, C33, gains and delay drawn, and the plan's forecast beside their scatter.
fn coverage(claims: &mut Claims, root: &Path, seeds: usize) -> Result<(), Box<dyn Error>> {
    let campaign = read_campaign(&root.join(EXAMPLE).join("twin.toml"))?;
    let source = &campaign.sources[0];
    let setup = setup_of(source)?;
    let truths = truth(&campaign)?;
    let planned = planned(&plan(source)?, &setup, truths);
    let window_s = setup.window_s.ok_or("no window")?;
    let declared = campaign.simulate.as_ref().map_or(&[][..], |s| &s.sensors);
    for (words, factor) in [("0.3 N and 0.02 m/s²", 1.0), ("ten times that", 10.0)] {
        let mut sensors = declared.to_vec();
        for sensor in sensors.iter_mut().filter(|s| s.quantity != "reference") {
            sensor.noise = sensor.noise.map(|n| factor * n);
        }
        let expected = forecast(&planned, &setup, window_s, &sensors)?;
        let seeds = campaigns_of(factor == 1.0, seeds);
        let fits: Vec<Vec<AtPeriod>> = (0..seeds)
            .into_par_iter()
            .filter_map(|seed| {
                let logged = simulated(&planned, &setup, &sensors, 1 + seed as u64);
                let runs: Vec<WaveRun<'_>> = logged.iter().map(Simulated::view).collect();
                fit(&runs, &setup).ok().map(|mut all| {
                    // From the longest period on, as they are planned.
                    all.sort_by(|a, b| b.period_s.total_cmp(&a.period_s));
                    all
                })
            })
            .collect();
        let names = || expected.iter().enumerate().flat_map(|(i, at)| [(i, 0, at.period_s), (i, 1, at.period_s)]);
        let mut cover = Vec::new();
        let mut ratios = Vec::new();
        for (i, j, period_s) in names() {
            let mut count = Count::default();
            let mut squares = 0.0;
            for all in &fits {
                let [low, high] = all[i].combined[j].interval(all[i].values[j]);
                count.add((low..=high).contains(&truths[j]));
                squares += (all[i].values[j] - truths[j]).powi(2) / fits.len() as f64;
            }
            let name = format!("{} at {period_s} s", ["A33", "B33"][j]);
            cover.push((name.clone(), count));
            ratios.push((name, squares.sqrt() / expected[i].combined[j].standard));
        }
        let is_judged = factor == 1.0;
        let verdict = |holds: bool| Verdict::of(is_judged, holds);
        covers(
            claims,
            TWIN,
            &format!("intervals at {words} of correlated noise, {seeds} campaigns of {} runs: cover", planned.len()),
            &cover,
            (fits.len() == seeds, is_judged),
            Bar::Exactly,
        );
        // The root mean square of as many errors scatters by 1/√(2n).
        let allowance = 3.0 / (2.0 * seeds as f64).sqrt();
        let holds = ratios.iter().all(|(_, r)| (0.9 - allowance..=1.1 + allowance).contains(r));
        claims.add(
            TWIN,
            &format!("error of the seeds over the plan's forecast at {words}"),
            &format!("0.9 to 1.1 (± {allowance:.2} for {seeds} seeds)"),
            ratios.iter().map(|(name, r)| format!("{name} {r:.3}")).collect::<Vec<_>>().join(", "),
            verdict(holds),
        );
    }
    Ok(())
}
