//! The weight-driven rig on its twin, from pixels to intervals, as the example campaign declares it; and what errors of the speed do to a fit that takes
//! it as exact.

use std::error::Error;
use std::path::Path;

use froude::fit::faer::Mat;
use froude::fit::odr::Sigma;
use froude::fit::{self, Options, Problem};
use froude::identify::dataset::Dataset;
use froude::identify::eiv;
use froude::identify::law::ForceLaw;
use froude::identify::reduce::reduce_table;
use froude::identify::source::identify_observations;
use froude::methods::tank::observed::plan::{Expected, exact, expected};
use froude::methods::tank::observed::read::reduced;
use froude::methods::tank::observed::settings::{Plan, loads_at};
use froude::methods::tank::observed::source::{shared, with_speeds};
use froude::methods::tank::observed::twin::Twin;
use froude::methods::tank::steady::row::{Row, table};
use froude::methods::tank::weight_tow::WeightTow;
use froude::records::campaign::{Campaign, SensorSpec, Source};
use froude::records::campaign_file::read_campaign;
use froude::records::run::Declared;
use froude::records::units::Dimension;
use rayon::prelude::*;

use crate::claims::{Claims, Verdict};
use crate::coverage::{normal, problem_of};
use crate::family::{answered, between_runs, campaigns_of, factors};
use crate::lints::{Codes, judged, of_scatter};
use crate::steady::{Fitted, covered, judge};

const SECTION: &str = "Weight-driven rig: tracks in pixels by their twin";

struct Case {
    campaign: Campaign,
    source: Source,
    twin: Twin<WeightTow>,
}

impl Case {
    fn read(root: &Path) -> Result<Self, Box<dyn Error>> {
        let campaign = read_campaign(&root.join("examples/mamba-weights/campaign.toml"))?;
        let source = campaign.sources[0].clone();
        let twin = Twin::of(&campaign, &source)?;
        Ok(Self { campaign, source, twin })
    }

    fn sensors(&self) -> &[SensorSpec] {
        self.campaign.simulate.as_ref().map_or(&[], |s| &s.sensors)
    }

    fn of(
        &self,
        twin: &Twin<WeightTow>,
        sensors: &[SensorSpec],
        seed: u64,
    ) -> Result<(Fitted, Codes), Box<dyn Error + Send + Sync>> {
        let logged = twin.simulated(sensors, &self.source.uncertainty, 1 + seed);
        let found = logged.iter().map(|run| reduced(&twin.method, &run.view())).collect::<Result<Vec<_>, _>>()?;
        let rows: Vec<Row> = found.iter().cloned().map(Row::from).collect();
        let own = with_speeds(&self.source, &twin.method, &found);
        let mut observations = reduce_table(&self.campaign, &own, &table(own.input.path(), &rows), Vec::new())?;
        observations.shared_errors.extend(shared(&twin.method, &found, &observations.data.loads()));
        let mut result = identify_observations(&self.campaign, &own, observations, "weight_tow", &|_| {})?;
        Ok((result.estimates.remove(0).coefficients, of_scatter(&result.findings)))
    }

    fn fits(&self, sensors: &[SensorSpec], seeds: usize) -> (Vec<Fitted>, Vec<Codes>) {
        (0..seeds).into_par_iter().filter_map(|seed| self.of(&self.twin, sensors, seed as u64).ok()).unzip()
    }

    fn forecast(&self, sensors: &[SensorSpec]) -> Result<Vec<Expected>, Box<dyn Error>> {
        let (_, reduced) = exact(&self.twin, sensors)?;
        let in_variables = self.campaign.identify.errors_in_variables;
        Ok(expected(&self.twin, &self.source, &reduced, (sensors, in_variables))?)
    }
}

pub fn all(claims: &mut Claims, root: &Path, seeds: usize) -> Result<(), Box<dyn Error>> {
    let case = Case::read(root)?;
    for (words, factor) in [("5 mN and half a pixel", 1.0), ("50 mN and half a pixel", 10.0)] {
        let louder = |s: &SensorSpec| SensorSpec {
            noise: s.noise.map(|n| if s.quantity == "mark" { n } else { factor * n }),
            ..s.clone()
        };
        let sensors: Vec<SensorSpec> = case.sensors().iter().map(louder).collect();
        let forecast = case.forecast(&sensors)?;
        let seeds = campaigns_of(factor == 1.0, seeds);
        let (fits, codes) = case.fits(&sensors, seeds);
        judged(claims, SECTION, &format!("tests of the scatter at {words}, {seeds} sound campaigns"), codes);
        judge(claims, SECTION, &forecast, &fits, (words, "78 runs", factor == 1.0, seeds));
    }
    let sensors = case.sensors();
    let (fits, refused) = answered(seeds, |seed| {
        let plan = &case.twin.plan;
        let plan = Plan { of_run: factors(plan.data.rows, seed), ..plan.clone() };
        let twin = Twin { plan, ..case.twin.clone() };
        case.of(&twin, sensors, seed).map(|(fitted, _)| fitted)
    });
    let each = covered(case.forecast(sensors)?.into_iter().map(|e| (e.name, e.value)), &fits);
    between_runs(claims, SECTION, &format!("{seeds} campaigns of 78 runs"), &each, &refused);
    errors_of_speed(claims, root, seeds)
}

/// Of a mean shift: eight thousand draws tell a tenth of the least one.
const MOST_DRAWN: usize = 400;

/// Errors of the speed of 1, 3 and 5 %, independent by run, on 39 runs of H1LT: f_y by a law with a linear and a quadratic part.
fn errors_of_speed(claims: &mut Claims, root: &Path, seeds: usize) -> Result<(), Box<dyn Error>> {
    let runs = Errors::read(root)?;
    // Computed beforehand for 39 speeds of the balance from 0.046 to 0.307 m/s.
    for (percent, second, first) in [(1.0, -0.33, 0.8), (3.0, -3.0, 7.4), (5.0, -8.0, 20.0)] {
        let draws = 20 * seeds.min(MOST_DRAWN);
        let plain = runs.bias(percent / 100.0, false, draws);
        let repaired = runs.bias(percent / 100.0, true, draws);
        // What the mean of so many seeds scatters by, three times, beside a tenth of each.
        let near = |[mean, standard]: [f64; 2], to: f64| (mean - to).abs() <= 0.1 * f64::abs(to) + 3.0 * standard;
        claims.add(
            SECTION,
            &format!("{percent} % of error in each speed, 39 runs of H1LT, least squares: C^II and C^I move"),
            &format!("{second} %, {first:+} %, each ± a tenth, computed beforehand"),
            format!("{:+.2} ± {:.2} %, {:+.2} ± {:.2} %", plain[0][0], plain[0][1], plain[1][0], plain[1][1]),
            if near(plain[0], second) && near(plain[1], first) { Verdict::Pass } else { Verdict::Finding },
        );
        let holds = [0, 1].into_iter().all(|k| repaired[k][0].abs() <= 0.2 * plain[k][0].abs() + 3.0 * repaired[k][1]);
        claims.holds(
            SECTION,
            &format!("the same by errors in variables, {percent} %"),
            "a fifth of that at most, and what the seeds scatter by",
            format!(
                "{:+.2} ± {:.2} %, {:+.2} ± {:.2} %",
                repaired[0][0], repaired[0][1], repaired[1][0], repaired[1][1]
            ),
            holds,
        );
    }
    let (low, high) = runs
        .data
        .values("speed")
        .unwrap_or_default()
        .iter()
        .fold((f64::INFINITY, 0.0_f64), |(l, h), u| (l.min(*u), h.max(*u)));
    claims.holds(
        SECTION,
        "speeds of the balance of those 39 runs",
        "0.046 to 0.307 m/s",
        format!("{low:.3} to {high:.3} m/s"),
        (low - 0.046).abs() < 1e-3 && (high - 0.307).abs() < 1e-3,
    );
    // 1 % of all speeds together.
    let scaled = runs.coefficients(&vec![1.01; runs.data.rows], &vec![0.0; runs.data.rows], None);
    let moved = scaled.map_or(f64::NAN, |c| 100.0 * (c[1] / runs.truth[1] - 1.0));
    claims.holds(
        SECTION,
        "a common error of scale of 1 %: C^II moves, and the residuals do not show it",
        "−2 %",
        format!("{moved:+.2} %"),
        (moved + 2.0).abs() < 0.1,
    );
    Ok(())
}

/// 39 runs of H1LT at the speeds of the balance, and f_y of them.
struct Errors {
    data: Dataset,
    law: ForceLaw,
    /// Linear and quadratic coefficient without errors.
    truth: [f64; 2],
}

/// Standard deviation of f_y, N, where errors in variables need one.
const LOAD_N: f64 = 1e-3;

impl Errors {
    fn read(root: &Path) -> Result<Self, Box<dyn Error>> {
        // Weights that drive H1LT at 0.1, 0.2 and 0.3 m/s along the rail at 0 deg, without friction.
        let Case { campaign, source, twin: any } = Case::read(root)?;
        let weights = [0.1, 0.2, 0.3].map(|u| -loads_at(&any.plan, 0, u, 0.0)[0]);
        // The plan has three weights too, and the first of its two configurations is this.
        let mut planned: Vec<f64> = any.points.iter().map(|point| point.condition("weight")).collect();
        planned.dedup();
        let mut points = any.points.clone();
        points.retain(|point| point.configuration == "H1LT");
        for point in &mut points {
            let at = planned.iter().position(|weight| *weight == point.condition("weight")).ok_or("no such weight")?;
            point.conditions.insert("weight", weights[at]);
        }
        let method = WeightTow { friction_n: Declared::exact(0.0), ..any.method };
        let plan = &Twin::with(&campaign, &source, method, points)?.plan;
        let mut data = plan.data.clone();
        let loads = plan.law.predict(&data, &plan.values)?;
        data.channels.shift_remove("f_x");
        data.put("f_y", loads[data.rows..].to_vec(), Dimension::FORCE);
        let texts = [("f_y".to_owned(), "-D_y_I*v_y - D_y_II*v_y*abs(v_y)".to_owned())].into();
        let law = ForceLaw::formulas("linear and quadratic", &texts, &data)?;
        let mut out = Self { data, law, truth: [f64::NAN; 2] };
        let n = out.data.rows;
        out.truth = out.coefficients(&vec![1.0; n], &vec![0.0; n], None).ok_or("no fit")?;
        Ok(out)
    }

    /// Linear and quadratic coefficient where speeds are read as `factor` times what they are and loads with `noise`.
    fn coefficients(&self, factor: &[f64], noise: &[f64], relative: Option<f64>) -> Option<[f64; 2]> {
        let mut data = self.data.clone();
        let speed = data.values("speed")?.iter().zip(factor).map(|(u, f)| u * f).collect();
        let load = data.values("f_y")?.iter().zip(noise).map(|(y, e)| y + e).collect();
        data.put("speed", speed, Dimension::SPEED);
        data.put("f_y", load, Dimension::FORCE);
        data.velocity_from_speed_and_angle();
        let found: Vec<f64> = match relative {
            Some(part) => {
                let speeds = data.values("speed")?.to_vec();
                let standard = Mat::from_fn(data.rows, 2, |i, k| if k == 0 { part * speeds[i] } else { 0.0 });
                let fit = eiv::regress(&self.law, &data, eiv::Inputs::polar(standard), Sigma::Known(LOAD_N)).ok()?;
                fit.coefficients.iter().filter_map(|c| c.value).collect()
            }
            None => {
                let problem = problem_of(&self.law, &data).ok()?;
                let response = self.law.measured(&data).ok()?;
                let fit = fit::fit(&Problem { response, ..problem }, &Options::default()).ok()?;
                fit.coefficients.iter().filter_map(|c| c.value).collect()
            }
        };
        found.try_into().ok()
    }

    /// Mean shift of C^II and C^I over seeds, per cent, each with its standard error.
    fn bias(&self, part: f64, in_variables: bool, seeds: usize) -> [[f64; 2]; 2] {
        let found: Vec<[f64; 2]> = (0..seeds)
            .into_par_iter()
            .filter_map(|seed| {
                let mut rng = rand_pcg::Pcg64::new(seed as u128, 77);
                let n = self.data.rows;
                let factor: Vec<f64> = (0..n).map(|_| 1.0 + part * normal(&mut rng)).collect();
                let noise: Vec<f64> = (0..n).map(|_| LOAD_N * normal(&mut rng)).collect();
                self.coefficients(&factor, &noise, in_variables.then_some(part))
            })
            .collect();
        let of = |k: usize| {
            let n = found.len() as f64;
            let shift = |c: &[f64; 2]| 100.0 * (c[k] / self.truth[k] - 1.0);
            let mean = found.iter().map(shift).sum::<f64>() / n;
            let variance = found.iter().map(|c| (shift(c) - mean).powi(2)).sum::<f64>() / (n - 1.0);
            [mean, (variance / n).sqrt()]
        };
        [of(1), of(0)]
    }
}
