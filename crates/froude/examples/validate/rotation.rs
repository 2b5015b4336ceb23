//! Rotation: a link about its own centre on its twin, as the example campaign declares it.

use std::error::Error;
use std::path::Path;

use froude::fit::budget::Uncertain;
use froude::fit::coverage::Count;
use froude::hydro::link_parameters::{LinkCoefficients, LinkParameters, YawDrag, YawInertia};
use froude::methods::tank::TankError;
use froude::methods::tank::rotation::derive::C_F_DIFFERENCE;
use froude::methods::tank::rotation::fit::LAMBDAS;
use froude::methods::tank::rotation::forecast::{Forecast, forecast, true_value};
use froude::methods::tank::rotation::section::{plan, setup_of};
use froude::methods::tank::rotation::simulate::{Planned, Simulated, Truths, planned, simulated};
use froude::methods::tank::rotation::{Derived, RotationFit, RotationRun, Setup, derived, fit, motions};
use froude::records::campaign::{Identify, SensorSpec};
use froude::records::campaign_file::read_campaign;
use rayon::prelude::*;

use crate::claims::{Claims, Verdict};
use crate::family::{Bar, campaigns_of, covers};

const SECTION: &str = "Rotation: a link about its own centre by its twin";
/// C_f^II and C_d^II of the f2 model in the circulation tank, USR Table 9; C_A of the tank, Table 12.
const TANK: LinkCoefficients = LinkCoefficients { c_f: 0.0544, c_d: 1.8601, c_a: 1.277, c_m: 1.0 };

struct Case {
    setup: Setup,
    truth: Truths,
    planned: Vec<Planned>,
    sensors: Vec<SensorSpec>,
}

impl Case {
    fn read(root: &Path) -> Result<Self, Box<dyn Error>> {
        let campaign = read_campaign(&root.join("examples/mamba-rotation/campaign.toml"))?;
        let source = &campaign.sources[0];
        let (setup, blocks) = (setup_of(&campaign, source)?, plan(source)?);
        let truth = Truths::of(&campaign, &blocks, &setup)?;
        let sensors = campaign.simulate.as_ref().map_or_else(Vec::new, |s| s.sensors.clone());
        Ok(Self { setup, truth, planned: planned(&blocks), sensors })
    }

    fn forecast(&self, setup: &Setup, sensors: &[SensorSpec]) -> Result<Forecast, TankError> {
        forecast(&self.planned, setup, &self.truth, sensors, &Identify::default())
    }
}

pub fn all(claims: &mut Claims, root: &Path, seeds: usize) -> Result<(), Box<dyn Error>> {
    let case = Case::read(root)?;
    laws(claims, &case)?;
    beforehand(claims, &case)?;
    coverage(claims, &case, seeds)
}

/// λ₃ of the Mamba link by the two laws.
fn laws(claims: &mut Claims, case: &Case) -> Result<(), Box<dyn Error>> {
    let link = case.setup.link.ok_or("no link")?;
    let of = |drag: YawDrag| LinkParameters::of(&link, 1025.0, &TANK, YawInertia::StripTheory, drag);
    let [friction, across] = [of(YawDrag::FrictionStrip)?.lambda_3_kg_m2, of(YawDrag::CrossFlow)?.lambda_3_kg_m2];
    claims.holds(
        SECTION,
        "λ₃ of the Mamba link with the f2 set of the tank, by friction and by drag across it",
        "1.41e-4 and 3.68e-3 N m s², 26 times apart, computed beforehand",
        format!("{friction:.3e} and {across:.3e}, {:.1} times", across / friction),
        (friction - 1.41e-4).abs() < 0.5e-6 && (across - 3.68e-3).abs() < 0.5e-5,
    );
    Ok(())
}

/// Standard uncertainties to expect, against a second program and against the figures that were computed beforehand.
fn beforehand(claims: &mut Claims, case: &Case) -> Result<(), Box<dyn Error>> {
    let percent = |f: &Forecast, j: usize| 100.0 * f.expected[j].combined.standard / case.truth.lambdas[j];
    let exactly = Setup {
        inertia_kg_m2: case.setup.inertia_kg_m2.map(|j| Uncertain::new(j.value, 0.0)),
        delay_s: Some(Uncertain::new(0.0, 0.0)),
        torque_relative: 0.0,
        ..case.setup.clone()
    };
    let found = case.forecast(&exactly, &case.sensors)?;
    let r = |f: &Forecast| f.correlation(LAMBDAS[1], LAMBDAS[2]).unwrap_or(0.0);
    let figures = [percent(&found, 0), percent(&found, 1), percent(&found, 2), r(&found)];
    let words = |f: [f64; 4]| format!("{:.3} %, {:.2} %, {:.2} %, r {:.3}", f[0], f[1], f[2], f[3]);
    // The servo's sine is 0.06 % larger than the one of the other program: 0.5 % of each.
    let second = [0.9218, 10.643, 5.949, -0.9360];
    claims.holds(
        SECTION,
        "standard uncertainty of λ₁, λ₂, λ₃ to expect at 1 mN m correlated over 0.5 s, and the correlation of λ₂ with λ₃, rig and delay known",
        &format!("{} ± 0.5 %, by a second program (dense covariance matrices, rotation_forecast.py)", words(second)),
        words(figures),
        figures.iter().zip(second).all(|(a, b)| (a / b - 1.0).abs() < 0.005),
    );
    let full = case.forecast(&case.setup, &case.sensors)?;
    let figures = [percent(&full, 0), percent(&full, 1), percent(&full, 2), r(&full)];
    claims.add(
        SECTION,
        "the same with the full budget (inertia 1e-5 kg m², delay 5 ms, gain 0.2 %)",
        "λ₁ to 1 %, λ₂ to 8 %, correlated by −0.92, computed beforehand for a setting that is not stated",
        words(figures),
        Verdict::Finding,
    );
    Ok(())
}

/// What a user is shown with an interval, and the truth of it.
fn shown(case: &Case, truth: &Truths, fit: &RotationFit, derived: &[Derived]) -> Vec<(bool, f64)> {
    let holds = |[low, high]: [f64; 2], truth: f64| (low..=high).contains(&truth);
    let mut out: Vec<(bool, f64)> = (fit.unknowns.iter())
        .map(|u| {
            let truth = true_value(&u.name, &case.setup, truth);
            let known = u.value.zip(u.combined);
            (
                known.is_some_and(|(value, c)| holds(c.interval(value), truth)),
                known.map_or(f64::NAN, |(v, _)| v - truth),
            )
        })
        .collect();
    // C_f by λ₂ less that by λ₃: the difference of both, factors of the strips as the record states them.
    let difference =
        derived.iter().find(|d| d.name == C_F_DIFFERENCE).zip(case.setup.link).zip(case.setup.density_kg_m3);
    out.extend(difference.map(|((d, link), density)| {
        let (a, b, l) = (link.major_semi_axis_m, link.minor_semi_axis_m, link.half_length_m);
        let strips = density.value * std::f64::consts::PI * (a + b) * l.powi(3);
        let truth = 6.0 * truth.lambdas[1] / strips - 8.0 * truth.lambdas[2] / (strips * l);
        (holds(d.combined.interval(d.value), truth), d.value - truth)
    }));
    out
}

/// Intervals over seeds, inertia, gain and delay drawn, and the plan's forecast beside the scatter.
fn coverage(claims: &mut Claims, case: &Case, seeds: usize) -> Result<(), Box<dyn Error>> {
    for (words, factor) in [("1 mN m", 1.0), ("10 mN m", 10.0)] {
        let louder = |s: &SensorSpec| SensorSpec {
            noise: s.noise.map(|n| if s.quantity == "torque" { factor * n } else { n }),
            ..s.clone()
        };
        let sensors: Vec<SensorSpec> = case.sensors.iter().map(louder).collect();
        let plan = case.forecast(&case.setup, &sensors)?;
        let one = |seed: usize| {
            let truth = drawn(case, seed as u64);
            let logged = simulated(&case.planned, &case.setup, &truth, &sensors, 1 + seed as u64);
            let runs: Vec<RotationRun<'_>> = logged.iter().map(Simulated::view).collect();
            let motions = motions(&runs, &case.setup).ok()?;
            let found = fit(&runs, &motions, &case.setup, &Identify::default()).ok()?;
            Some(shown(case, &truth, &found, &derived(&found, &case.setup)))
        };
        let seeds = campaigns_of(factor == 1.0, seeds);
        let all: Vec<Vec<(bool, f64)>> = (0..seeds).into_par_iter().filter_map(one).collect();
        let names: Vec<&str> = plan.expected.iter().map(|e| e.name.as_str()).chain([C_F_DIFFERENCE]).collect();
        let mut counts = vec![Count::default(); names.len()];
        for shown in &all {
            for (count, (holds, _)) in counts.iter_mut().zip(shown) {
                count.add(*holds);
            }
        }
        let is_judged = factor == 1.0;
        let named: Vec<(String, Count)> = names.iter().map(|name| (*name).to_owned()).zip(counts).collect();
        covers(
            claims,
            SECTION,
            &format!("intervals at {words} of correlated noise, {seeds} campaigns of 9 runs: cover"),
            &named,
            (all.len() == seeds, is_judged),
            Bar::Exactly,
        );
        let rms = |j: usize| (all.iter().map(|shown| shown[j].1.powi(2)).sum::<f64>() / all.len() as f64).sqrt();
        let ratios: Vec<f64> = plan.expected.iter().enumerate().map(|(j, e)| rms(j) / e.combined.standard).collect();
        // The root mean square of as many errors scatters by 1/√(2n).
        let allowance = 3.0 / (2.0 * seeds as f64).sqrt();
        let each: Vec<String> = names.iter().zip(&ratios).map(|(name, r)| format!("{name} {r:.3}")).collect();
        claims.add(
            SECTION,
            &format!("error of the seeds over the plan's forecast at {words}"),
            &format!("0.9 to 1.1 (± {allowance:.2} for {seeds} seeds)"),
            each.join(", "),
            Verdict::of(is_judged, ratios.iter().all(|r| (0.9 - allowance..=1.1 + allowance).contains(r))),
        );
    }
    Ok(())
}

/// The delay drawn about what is declared, and known to the test; the twin draws inertia and gain itself.
fn drawn(case: &Case, seed: u64) -> Truths {
    let mut rng = rand_pcg::Pcg64::new(u128::from(seed), 141);
    let about = |u: Uncertain| u.value + u.standard * crate::coverage::normal(&mut rng);
    Truths { delay_s: case.setup.delay_s.map(about), ..case.truth }
}
