//! Free decay from the twin of its rig: coverage of the intervals that a user sees, with releases that are alike and with releases that are not; and the snake
//! robot that its buoyancy drives back, beside its plan.

use std::error::Error;
use std::path::Path;

use froude::fit::budget::Uncertain;
use froude::fit::coverage::Count;
use froude::methods::tank::decay::axis::Motion;
use froude::methods::tank::decay::forecast::{Forecast, forecast, peaks_of};
use froude::methods::tank::decay::releases::Logged;
use froude::methods::tank::decay::releases::{simulated, truth_of};
use froude::methods::tank::decay::section::plan;
use froude::methods::tank::decay::source::declared;
use froude::methods::tank::decay::{DecayFit, DecayRun, DecaySetup, Method, envelope, output_error};
use froude::records::campaign::SensorSpec;
use froude::records::campaign_file::read_campaign;
use froude::rig::decay::{DecayRig, DecaySensor, Release};
use rand_pcg::Pcg64;
use rayon::prelude::*;

use crate::claims::{Claims, Verdict};
use crate::coverage::normal;
use crate::family::{Bar, campaigns_of, covers};

const SECTION: &str = "Free decay: releases of the twin, five a campaign";

/// A heaving body on springs.
const HEAVE: DecayRig = DecayRig {
    inertia: 12.0,
    added: 8.0,
    linear: 4.0,
    quadratic: 40.0,
    stiffness: 180.0,
    is_pendulum: false,
    coulomb: 0.0,
    rest: 0.0,
};
/// Standard uncertainties that inertia and stiffness are declared with, as parts; one draw a campaign.
const DECLARED_TO: [f64; 2] = [0.005, 0.003];
const SENSOR: DecaySensor =
    DecaySensor { rate_hz: 25.0, noise: 0.2e-3, correlation_s: None, step: 0.1e-3, drift_per_s: 0.0 };
const RELEASES: u64 = 5;

/// `alike`: every release has the same coefficients; else each has its own, scattered by 3 % about the truth (water, mounting, temperature).
pub fn all(claims: &mut Claims, campaigns: usize) {
    for (words, scatter) in [("releases alike", 0.0), ("coefficients of each release scatter by 3 %", 0.03)] {
        let fits: Vec<[DecayFit; 2]> =
            (0..campaigns).into_par_iter().filter_map(|seed| campaign(seed as u64, scatter)).collect();
        for (m, method) in Method::ALL.into_iter().enumerate() {
            for (j, (name, truth)) in [("A33", 8.0), ("D_z_I", 4.0), ("D_z_II", 40.0)].into_iter().enumerate() {
                let intervals: Vec<[f64; 2]> = fits.iter().filter_map(|fit| fit[m].interval_95(j)).collect();
                let hits = intervals.iter().filter(|[low, high]| (*low..=*high).contains(&truth)).count();
                let width =
                    intervals.iter().map(|[low, high]| 0.5 * (high - low)).sum::<f64>() / intervals.len() as f64;
                let n = intervals.len() as f64;
                let mean = fits.iter().map(|fit| fit[m].values[j]).sum::<f64>() / fits.len() as f64;
                // Three binomial standard deviations below; jackknife and one common inertia and stiffness may cover more.
                let low = 0.95 * n - 3.0 * (n * 0.0475).sqrt();
                claims.holds(
                    SECTION,
                    &format!("{words}, {}, {name}: 95 % interval covers", method.name()),
                    &format!("at least {:.0} of {campaigns}", low.floor()),
                    format!(
                        "{hits} of {}, bias {:+.2} %, mean half-width {:.2} %",
                        intervals.len(),
                        100.0 * (mean / truth - 1.0),
                        100.0 * width / truth
                    ),
                    intervals.len() == campaigns && hits as f64 >= low.floor(),
                );
            }
        }
    }
}

fn campaign(seed: u64, scatter: f64) -> Option<[DecayFit; 2]> {
    let mut rng = Pcg64::new(u128::from(seed), 81);
    let mut about = |value: f64, part: f64| value * (1.0 + part * normal(&mut rng));
    let declared = [(HEAVE.inertia, DECLARED_TO[0]), (HEAVE.stiffness, DECLARED_TO[1])]
        .map(|(value, part)| Uncertain::new(about(value, part), part * value));
    let traces: Vec<_> = (0..RELEASES)
        .map(|k| {
            let rig = DecayRig {
                added: about(HEAVE.added, scatter),
                linear: about(HEAVE.linear, scatter),
                quadratic: about(HEAVE.quadratic, scatter),
                ..HEAVE
            };
            let release = Release { displacement: about(0.1, 0.1), held_s: 0.5, free_s: 14.0 };
            rig.release(SENSOR, release, RELEASES * seed + k)
        })
        .collect();
    let runs: Vec<DecayRun<'_>> =
        traces.iter().map(|trace| DecayRun { id: "", time_s: &trace.time_s, position: &trace.position }).collect();
    let setup = DecaySetup::new(Motion::Heave, declared[0], declared[1]);
    Some([envelope(&runs, &setup).ok()?, output_error(&runs, &setup).ok()?])
}

const MAMBA: &str = "Free decay: the snake robot from 30 degrees, by its twin";
/// C_A of the truth, and ρ μ_n r² that it is of.
const C_A: f64 = 1.277;

/// H1LT on the rod of Table 4, as the example campaign declares it.
pub fn mamba(claims: &mut Claims, root: &Path, seeds: usize) -> Result<(), Box<dyn Error>> {
    let campaign = read_campaign(&root.join("examples/mamba-decay/campaign.toml"))?;
    let source = &campaign.sources[0];
    let setup = declared(source)?;
    let truth = truth_of(&campaign, setup.axis)?;
    let planned = plan(source)?;
    let sensors = campaign.simulate.as_ref().map_or(&[] as &[_], |s| s.sensors.as_slice());
    let loud = |times: f64, correlation_s: Option<f64>| -> (DecaySetup, Vec<SensorSpec>) {
        let mut setup = setup;
        setup.window.noise = setup.window.noise.map(|n| times * n);
        let of = |s: &SensorSpec| SensorSpec { noise: s.noise.map(|n| times * n), correlation_s, ..s.clone() };
        (setup, sensors.iter().map(of).collect())
    };
    let own = 100.0 * 0.02 * (setup.inertia.value + truth[0]) / truth[0];
    claims.add(
        MAMBA,
        "2 % of the buoyancy in A, dry inertia that of 1.63 kg at 0.476 m",
        "4.2 %, computed beforehand",
        format!(
            "{own:.2} %: (M + A)/A = {:.3}; 4.2 % takes M = 1.1 A, as an inertia of the body about its own centre of 0.045 kg m² beside it would make",
            (setup.inertia.value + truth[0]) / truth[0]
        ),
        Verdict::Finding,
    );
    for (words, times, correlation_s, is_judged) in [
        ("0.05 deg of white noise", 1.0, None, true),
        ("0.05 deg correlated over 0.5 s", 1.0, Some(0.5), true),
        ("0.15 deg of white noise", 3.0, None, false),
    ] {
        let (setup, sensors) = loud(times, correlation_s);
        let plan = forecast(&planned, &setup, truth, &sensors)?;
        peaks(claims, (words, &plan, &planned[0].id), is_judged);
        let seeds = campaigns_of(is_judged, seeds);
        let fits: Vec<Result<DecayFit, String>> = (0..seeds)
            .into_par_iter()
            .map(|seed| {
                let logged = simulated(&planned, &setup, truth, &sensors, 1 + seed as u64);
                let runs: Vec<DecayRun<'_>> = logged.iter().map(Logged::view).collect();
                if is_judged && envelope(&runs, &setup).is_ok() {
                    return Err("the envelope is not refused".to_owned());
                }
                output_error(&runs, &setup).map_err(|e| e.to_string())
            })
            .collect();
        judge(claims, (words, seeds, is_judged), truth, &plan, &fits);
    }
    let (setup, sensors) = loud(10.0, None);
    let refused = match forecast(&planned, &setup, truth, &sensors) {
        Ok(plan) => format!("{} peaks", peaks_of(&plan, &planned[0].id)),
        Err(refused) => refused.to_string(),
    };
    claims.add(MAMBA, "the plan at ten times the noise, 0.5 deg", "–", refused, Verdict::Measured);
    Ok(())
}

fn peaks(claims: &mut Claims, (words, plan, id): (&str, &Forecast, &str), is_judged: bool) {
    let found = peaks_of(plan, id);
    let verdict = match (is_judged, found == 4) {
        (true, true) => Verdict::Pass,
        (true, false) => Verdict::Miss,
        (false, _) => Verdict::Measured,
    };
    claims.add(MAMBA, &format!("peaks of a release, {words}"), "4 at 0.05 deg", found.to_string(), verdict);
}

/// Coverage of the intervals of the output error, and the errors of the seeds beside the plan's forecast.
fn judge(
    claims: &mut Claims,
    (words, seeds, is_judged): (&str, usize, bool),
    truth: [f64; 3],
    plan: &Forecast,
    fits: &[Result<DecayFit, String>],
) {
    let verdict = |holds: bool| Verdict::of(is_judged, holds);
    let found: Vec<&DecayFit> = fits.iter().flatten().collect();
    let (mut counts, mut squares, mut widths) = ([Count::default(); 3], [0.0; 3], [0.0; 3]);
    for fit in &found {
        for j in 0..3 {
            let interval = fit.interval_95(j);
            counts[j].add(interval.is_some_and(|[low, high]| (low..=high).contains(&truth[j])));
            squares[j] += (fit.values[j] - truth[j]).powi(2) / found.len() as f64;
            widths[j] += interval.map_or(f64::NAN, |[low, high]| 0.5 * (high - low)) / found.len() as f64;
        }
    }
    let each = |of: &dyn Fn(usize) -> String| {
        plan.expected.iter().enumerate().map(|(j, e)| format!("{} {}", e.name, of(j))).collect::<Vec<_>>().join(", ")
    };
    let refused = fits.iter().find_map(|fit| fit.as_ref().err()).map_or_else(String::new, |why| format!("; {why}"));
    let named: Vec<(String, Count)> = plan.expected.iter().map(|e| e.name.clone()).zip(counts).collect();
    covers(
        claims,
        MAMBA,
        &format!(
            "{words}, {seeds} campaigns of 5 releases, envelope refused in each{refused}: intervals of the output error cover"
        ),
        &named,
        (found.len() == seeds, is_judged),
        Bar::Exactly,
    );
    let ratio = |j: usize| squares[j].sqrt() / plan.expected[j].combined.standard;
    // The root mean square of as many errors scatters by 1/√(2n).
    let allowance = 3.0 / (2.0 * seeds as f64).sqrt();
    claims.add(
        MAMBA,
        &format!("{words}: error of the seeds over the plan's forecast"),
        &format!("0.8 to 1.25 (± {allowance:.2} for {seeds} seeds)"),
        each(&|j| format!("{:.3}", ratio(j))),
        verdict((0..3).all(|j| (0.8 - allowance..=1.25 + allowance).contains(&ratio(j)))),
    );
    let per_c_a = C_A / truth[0];
    claims.add(
        MAMBA,
        &format!("{words}: U95 of C_A = A44/(ρ μ_n r²) to expect, and the mean of the seeds; of D_rx_I and D_rx_II"),
        "–",
        format!(
            "{:.4}, {:.4} of {C_A}; {}",
            per_c_a * plan.expected[0].combined.arms[1],
            per_c_a * widths[0],
            [1, 2]
                .map(|j| {
                    let of = |half: f64| 100.0 * half / truth[j];
                    format!("{:.1} %, {:.1} %", of(plan.expected[j].combined.arms[1]), of(widths[j]))
                })
                .join("; ")
        ),
        Verdict::Measured,
    );
}
