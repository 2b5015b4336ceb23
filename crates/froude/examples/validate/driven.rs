//! Methods with a motor-driven body on their twins: forecasts, and coverage of the intervals that a user is shown.

use std::error::Error;
use std::path::Path;

use froude::fit::coverage::Count;
use froude::methods::tank::TankError;
use froude::methods::tank::driven::derived::{Derived, derived};
use froude::methods::tank::driven::fit::{fit, motions};
use froude::methods::tank::driven::forecast::{Forecast, forecast};
use froude::methods::tank::driven::method::MotorDriven;
use froude::methods::tank::driven::run::Run;
use froude::methods::tank::driven::setup::Setup;
use froude::methods::tank::driven::spec::Point;
use froude::methods::tank::driven::still_fit::fit_still_runs;
use froude::methods::tank::driven::twin::{Simulated, Truth, Twin};
use froude::methods::tank::joint::JointFit;
use froude::records::campaign::{Campaign, Identify, SensorSpec};
use froude::records::campaign_file::read_campaign;
use froude::records::run::Role;
use rayon::prelude::*;

use crate::claims::{Claims, Verdict};
use crate::family::{Bar, campaigns_of, covers};

/// The twin of an example campaign.
pub struct Case<M> {
    pub campaign: Campaign,
    pub twin: Twin<M>,
    /// Constants whose truth is drawn about what is declared and known to the test; the twin draws the others itself.
    pub stated: &'static [&'static str],
    /// Stream of those draws.
    pub stream: u128,
}

/// A campaign of a seed: fit, what follows from it, and the truth.
pub struct Found {
    pub fit: JointFit,
    pub derived: Vec<Derived>,
    pub truth: Truth,
}

impl<M: MotorDriven> Case<M> {
    pub fn read(
        root: &Path,
        example: &str,
        stated: &'static [&'static str],
        stream: u128,
    ) -> Result<Self, Box<dyn Error>> {
        Self::of(&root.join("examples").join(example).join("campaign.toml"), stated, stream)
    }

    pub fn of(path: &Path, stated: &'static [&'static str], stream: u128) -> Result<Self, Box<dyn Error>> {
        let campaign = read_campaign(path)?;
        let twin = Twin::of(&campaign, &campaign.sources[0])?;
        Ok(Self { campaign, twin, stated, stream })
    }

    pub fn sensors(&self) -> &[SensorSpec] {
        self.campaign.simulate.as_ref().map_or(&[], |s| &s.sensors)
    }

    /// The sensors with this times the noise of the loads.
    pub fn louder(&self, factor: f64) -> Vec<SensorSpec> {
        let is_motion = |s: &SensorSpec| s.quantity == M::SPEC.motion.name;
        let noise = |s: &SensorSpec| s.noise.map(|noise| if is_motion(s) { noise } else { factor * noise });
        self.sensors().iter().map(|s| SensorSpec { noise: noise(s), ..s.clone() }).collect()
    }

    pub fn forecast(&self, setup: &Setup<M>, sensors: &[SensorSpec]) -> Result<Forecast, TankError> {
        forecast(&self.twin, setup, sensors, &Identify::default())
    }

    /// The campaign of a seed; `of_drag` has the factors of each run.
    pub fn one(&self, of_drag: &[Vec<f64>], sensors: &[SensorSpec], seed: u64) -> Result<Found, TankError> {
        let setup = &self.twin.setup;
        let mut twin =
            Twin { setup: setup.clone(), planned: self.twin.planned.clone(), truth: self.twin.truth.clone() };
        twin.planned.iter_mut().zip(of_drag).for_each(|(run, factor)| run.of_drag.clone_from(factor));
        let mut rng = rand_pcg::Pcg64::new(u128::from(seed), self.stream);
        for name in self.stated {
            let constants = setup.constants.iter().zip(&mut twin.truth.constants);
            for (constant, truth) in constants.filter(|(constant, _)| constant.name == *name) {
                let about =
                    |u: froude::fit::budget::Uncertain| u.value + u.standard * crate::coverage::normal(&mut rng);
                *truth = constant.known.map(about);
            }
        }
        let logged = twin.simulated(sensors, 1 + seed)?;
        let (still, runs): (Vec<Run<'_>>, Vec<Run<'_>>) =
            logged.iter().map(Simulated::view).partition(|run| run.point.role == Role::Still);
        let setup = &Setup { still_fits: fit_still_runs(&still, setup)?, ..setup.clone() };
        let motions = motions(&runs, setup, &[])?;
        let fit = fit(&runs, &motions, setup, &Identify::default())?;
        let points: Vec<&Point> = runs.iter().map(|run| &run.point).collect();
        let derived = derived(&fit, &setup.method.sums(setup, &points));
        Ok(Found { fit, derived, truth: twin.truth })
    }

    /// What a user is shown with an interval: its name, whether the interval holds the truth, and the error. The truth of a derived number is that of its sum.
    pub fn shown(&self, found: &Found, of_derived: &[&str]) -> Vec<(String, bool, f64)> {
        let setup = &self.twin.setup;
        let value = |name: &str| found.truth.value(name, setup);
        let holds = |[low, high]: [f64; 2], truth: f64| (low..=high).contains(&truth);
        let unknowns = found.fit.unknowns.iter().map(|u| {
            let (truth, known) = (value(&u.name), u.value.zip(u.combined));
            let is_held = known.is_some_and(|(value, c)| holds(c.interval(value), truth));
            (u.name.clone(), is_held, known.map_or(f64::NAN, |(v, _)| v - truth))
        });
        let points: Vec<&Point> = self.twin.planned.iter().map(|run| &run.point).collect();
        let sums = setup.method.sums(setup, &points);
        let derived = found.derived.iter().filter(|d| of_derived.contains(&d.name)).map(|d| {
            let sum = sums.iter().find(|sum| sum.name == d.name);
            let truth = sum.map_or(f64::NAN, |sum| sum.factors.iter().map(|(name, factor)| factor * value(name)).sum());
            (d.name.to_owned(), holds(d.combined.interval(d.value), truth), d.value - truth)
        });
        unknowns.chain(derived).collect()
    }

    /// How often the interval of each number holds its truth.
    pub fn counts(&self, all: &[Found], of_derived: &[&str]) -> Vec<(String, Count)> {
        let mut out: Vec<(String, Count)> = Vec::new();
        for found in all {
            for (j, (name, holds, _)) in self.shown(found, of_derived).into_iter().enumerate() {
                if out.len() == j {
                    out.push((name, Count::default()));
                }
                out[j].1.add(holds);
            }
        }
        out
    }

    /// Intervals over seeds at a noise, and the plan's forecast beside the errors; it is judged at the noise that is declared.
    pub fn coverage(
        &self,
        claims: &mut Claims,
        section: &'static str,
        (words, factor): (&str, f64),
        seeds: usize,
        of_derived: &[&str],
    ) -> Result<Vec<Found>, Box<dyn Error>> {
        let (is_judged, sensors) = (factor == 1.0, self.louder(factor));
        let plan = self.forecast(&self.twin.setup, &sensors)?;
        let seeds = campaigns_of(is_judged, seeds);
        let all: Vec<Found> =
            (0..seeds).into_par_iter().filter_map(|seed| self.one(&[], &sensors, seed as u64).ok()).collect();
        covers(
            claims,
            section,
            &format!(
                "intervals at {words} of correlated noise, {seeds} campaigns of {} runs: cover",
                self.twin.planned.len()
            ),
            &self.counts(&all, of_derived),
            (all.len() == seeds, is_judged),
            Bar::Exactly,
        );
        let mut squares = vec![0.0; plan.expected.len()];
        for found in &all {
            let shown = self.shown(found, &[]);
            squares.iter_mut().zip(shown).for_each(|(sum, (.., error))| *sum += error * error);
        }
        let rms = |sum: &f64| (sum / all.len() as f64).sqrt();
        let ratios: Vec<f64> =
            squares.iter().zip(&plan.expected).map(|(sum, e)| rms(sum) / e.combined.standard).collect();
        // The root mean square of as many errors scatters by 1/√(2n).
        let allowance = 3.0 / (2.0 * seeds as f64).sqrt();
        let each: Vec<String> = plan.expected.iter().zip(&ratios).map(|(e, r)| format!("{} {r:.3}", e.name)).collect();
        claims.add(
            section,
            &format!("error of the seeds over the plan's forecast at {words}"),
            &format!("0.9 to 1.1 (± {allowance:.2} for {seeds} seeds)"),
            each.join(", "),
            Verdict::of(is_judged, ratios.iter().all(|r| (0.9 - allowance..=1.1 + allowance).contains(r))),
        );
        Ok(all)
    }
}
