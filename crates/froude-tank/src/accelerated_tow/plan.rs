//! The plan of accelerated tows: run matrix, time, travel, and the intervals to expect.
//!
//! The planned runs are driven without noise on the twin and reduced. A coefficient is a sum over the samples of force and position, through the weights
//! of the rows, the zeros and the regression, β = S y; the noise of the sensors with its correlation goes through that sum as it is, and the declared
//! errors by the directions that the reduction states.
//!
//! **Source.** As [`crate::driven::forecast`].

use froude_fit::FEWEST_CLUSTERS;
use froude_fit::budget::{Kind, Part};
use froude_fit::faer::Mat;
use froude_fit::serial::to_expect;
use froude_fit::series::taper;
use froude_identify::method::{MethodError, Prospect};
use froude_records::block::{ResultTable, TableBuilder};
use froude_records::campaign::{Campaign, SensorSpec, Source};
use froude_records::run::Role;
use froude_records::text::counted;
use froude_rig::accelerated_tow::Profile;

use super::law::names;
use super::reduce::reduce;
use super::rows::{Rows, row_errors, sample_s, window};
use super::section::profile;
use super::setup::{Setup, no_mass};
use super::simulate::{Simulated, Truths, Twin, senses};
use crate::error::undeclared;
use crate::inverted::inverted;
use crate::joint::part;
use crate::matrix::Point;
use crate::noise::correlated;
use crate::plan::{self, Expected};
use crate::sensors::seed_and_sensors;

/// What a plan will determine.
#[derive(Debug, Clone)]
pub struct Forecast {
    /// The coefficients.
    pub expected: Vec<Expected>,
    /// Correlations of their combined errors.
    pub correlation: Mat<f64>,
}

/// The intervals to expect of the fit of the true law to the planned runs.
///
/// # Errors
///
/// Runs that give no rows, a body without mass, coefficients that the plan does not determine.
pub fn forecast(twin: &Twin, sensors: &[SensorSpec], source: &Source) -> Result<Forecast, MethodError> {
    let Twin { setup, truth, .. } = twin;
    let logs = twin.exactly().ok_or_else(|| no_mass(source, setup))?;
    let mounted: Vec<_> = logs.iter().map(Simulated::view).collect();
    let mut reduced = reduce(&mounted, setup).ok_or_else(|| no_mass(source, setup))?;
    if !reduced.left_out.is_empty() {
        return Err(MethodError::refused(reduced.left_out.remove(0)));
    }
    let x = truth.law.regressors(&reduced.data, &truth.values)?;
    let (n, p) = (x.nrows(), x.ncols());
    let undetermined = || {
        let what = format!(
            "the planned runs do not tell the coefficients of {} apart: plan a second speed, or a law with fewer terms",
            truth.law.name
        );
        undeclared(&source.place, what)
    };
    let inverse = inverted(&(x.transpose() * &x)).ok_or_else(undetermined)?;
    let sensitivity = &inverse * x.transpose();
    let [force, position] = ["force", "position"].map(|name| sensors.iter().find(|s| s.quantity == name));
    let noise = Noise { setup, truth, force, position };
    let mut scatter = Mat::<f64>::zeros(p, p);
    let mut from = 0;
    let wet: Vec<&Simulated> = logs.iter().filter(|log| !log.is_dry()).collect();
    for (log, (_, body, rows)) in wet.iter().zip(&reduced.runs) {
        let own = from..from + rows.middle_s.len();
        let s: Vec<Vec<f64>> = (0..p).map(|j| own.clone().map(|i| sensitivity[(j, i)]).collect()).collect();
        scatter += noise.of_run(log, rows, &s, reduced.masses[*body].value_kg);
        from = own.end;
    }
    let clusters = reduced.runs.len();
    let run: Vec<usize> =
        reduced.runs.iter().enumerate().flat_map(|(r, (_, _, rows))| vec![r; rows.middle_s.len()]).collect();
    let moved_kg =
        reduced.masses.iter().zip(&reduced.added_kg).map(|(m, added)| m.value_kg + added).fold(0.0, f64::max);
    let dof = if clusters >= FEWEST_CLUSTERS {
        vec![clusters as f64 - 1.0; p]
    } else {
        noise.dof(&x, &sensitivity, wet[0], &run, moved_kg).unwrap_or_else(|| vec![1.0; p])
    };
    let fewest = dof.iter().copied().fold(f64::INFINITY, f64::min);
    let mut parts = vec![Part { dof, ..part("scatter", Kind::A, scatter, fewest) }];
    for (b, mass) in reduced.masses.iter().enumerate().filter(|(_, mass)| mass.is_weighed) {
        let standard = noise.of_mass(&logs, b, mass.value_kg);
        let load = |i: usize| {
            if reduced.data.configuration[i] == setup.bodies[b].name {
                reduced.data.values(&names(&setup.axis)[2]).map_or(0.0, |a| a[i])
            } else {
                0.0
            }
        };
        let direction: Vec<f64> = (0..n).map(|i| standard * load(i)).collect();
        parts.push(moved(
            &format!("mass of {} by runs in air", setup.bodies[b].name),
            &sensitivity,
            &direction,
            fewest,
        ));
    }
    for error in reduced.errors.iter().filter(|e| e.quantity != "zero") {
        let standard = error.covariance[0][0].sqrt();
        let direction: Vec<f64> = error.directions[0].1.iter().map(|row| standard * row[0]).collect();
        parts.push(moved(&error.name, &sensitivity, &direction, error.dof));
    }
    let of = truth.law.coefficients.iter().zip(&truth.values).enumerate();
    let expected = of.map(|(j, (c, value))| Expected::of(&truth.law.name, (&c.name, &c.unit), *value, &parts, j));
    let expected = expected.collect();
    let sum = |i: usize, j: usize| parts.iter().map(|part| part.covariance[(i, j)]).sum::<f64>();
    let correlation = Mat::from_fn(p, p, |i, j| sum(i, j) / (sum(i, i) * sum(j, j)).sqrt());
    Ok(Forecast { expected, correlation })
}

/// So many rows tell their scatter: the factor of Student's t is a normal's to some hundredths, and what is expected of their mixture would take the square of their number.
const MOST_ROWS: usize = 500;

/// The noise of the sensors on its way to the coefficients.
struct Noise<'a> {
    setup: &'a Setup,
    truth: &'a Truths,
    force: Option<&'a SensorSpec>,
    position: Option<&'a SensorSpec>,
}

impl Noise<'_> {
    /// Covariance of the coefficients by the noise of one run; `s` has a row per coefficient and a column per row of the run.
    fn of_run(&self, log: &Simulated, rows: &Rows, s: &[Vec<f64>], mass_kg: f64) -> Mat<f64> {
        let (p, t) = (s.len(), &log.trace.time_s);
        let samples = t.len();
        let load = |v: f64, a: f64| {
            if log.is_dry() { 0.0 } else { self.truth.load_n(self.setup, log.body, v, a) }
        };
        let mut of_force = vec![vec![0.0; samples]; p];
        let mut of_position = vec![vec![0.0; samples]; p];
        let rests: Vec<std::ops::Range<usize>> = rows
            .rest_s
            .iter()
            .flatten()
            .map(|[from, to]| t.partition_point(|x| x < from)..t.partition_point(|x| x <= to))
            .collect();
        let middle = |r: &std::ops::Range<usize>| 0.5 * (t[r.start] + t[r.end - 1]);
        for (i, at) in rows.middle_s.iter().enumerate() {
            let w = window(t, *at, self.setup.window_s);
            let late = window(t, at + self.setup.delay_s.value, self.setup.window_s);
            let (v, a) = (rows.speed_m_s[i], rows.acceleration_m_s2[i]);
            // Of m a − f(v, a): how it moves with the two.
            let by_a = mass_kg - (load(v, a + 1e-3) - load(v, a - 1e-3)) / 2e-3;
            let by_v = -(load(v + 1e-4, a) - load(v - 1e-4, a)) / 2e-4;
            for j in 0..p {
                for (k, weight) in late.value.iter().enumerate() {
                    of_force[j][late.from + k] -= s[j][i] * weight;
                }
                for k in 0..w.value.len() {
                    of_position[j][w.from + k] += s[j][i] * (by_a * w.bend[k] + by_v * w.slope[k]);
                }
                for (r, rest) in rests.iter().enumerate() {
                    let part = match rests.as_slice() {
                        [before, after] => {
                            let second = (at - middle(before)) / (middle(after) - middle(before));
                            if r == 0 { 1.0 - second } else { second }
                        }
                        _ => 1.0,
                    };
                    let all: f64 = taper(rest.len()).sum();
                    for (k, weight) in taper(rest.len()).enumerate() {
                        of_force[j][rest.start + k] += s[j][i] * part * weight / all;
                    }
                }
            }
        }
        let rate_hz = log.point.condition("rate");
        covariance(&of_force, self.force, rate_hz) + covariance(&of_position, self.position, rate_hz)
    }

    /// Standard uncertainty of the mass of a body by its runs in air, kg.
    fn of_mass(&self, logs: &[Simulated], body: usize, mass_kg: f64) -> f64 {
        let dry = logs.iter().filter(|log| log.is_dry() && log.body == body);
        let dry: Vec<(&Simulated, Rows)> = dry
            .filter_map(|log| {
                let rows = super::rows::rows(&log.view().run, self.setup.window_s, self.setup.delay_s.value).ok()?;
                Some((log, rows))
            })
            .collect();
        let squares: f64 = dry.iter().flat_map(|(_, rows)| &rows.acceleration_m_s2).map(|a| a * a).sum();
        let variance = dry.iter().map(|(log, rows)| {
            let s = vec![rows.acceleration_m_s2.iter().map(|a| a / squares).collect::<Vec<f64>>()];
            self.of_run(log, rows, &s, mass_kg)[(0, 0)]
        });
        variance.sum::<f64>().sqrt()
    }

    /// Degrees of freedom of few runs, as [`froude_fit::serial`] finds them in the middle; `moved_kg` is the mass that an acceleration moves.
    fn dof(
        &self,
        x: &Mat<f64>,
        sensitivity: &Mat<f64>,
        log: &Simulated,
        run: &[usize],
        moved_kg: f64,
    ) -> Option<Vec<f64>> {
        if run.len() > MOST_ROWS {
            return Some(vec![f64::INFINITY; x.ncols()]);
        }
        let rate_hz = log.point.condition("rate");
        let own = window(&log.trace.time_s, 0.5 * self.setup.window_s + log.trace.time_s[0], self.setup.window_s);
        let of = |weights: &[f64], sensor| covariance(&[weights.to_vec()], sensor, rate_hz)[(0, 0)].sqrt();
        let rho =
            self.force.and_then(|s| s.correlation_s).map_or(0.0, |time| (-sample_s(self.setup.window_s) / time).exp());
        let errors = row_errors(true, moved_kg * of(&own.bend, self.position));
        to_expect(x, sensitivity.as_ref(), run, &errors, (rho, of(&own.value, self.force))).map(|found| found.dof)
    }
}

/// σ² Σ_ij u_i c^|i−j| w_j, and what the step of the sensor adds as white noise.
fn covariance(sums: &[Vec<f64>], sensor: Option<&SensorSpec>, rate_hz: f64) -> Mat<f64> {
    let p = sums.len();
    let Some(sensor) = sensor else { return Mat::zeros(p, p) };
    let keep = sensor.correlation_s.map_or(0.0, |time| (-1.0 / (rate_hz * time)).exp());
    let smoothed: Vec<Vec<f64>> = sums.iter().map(|u| correlated(u, keep)).collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (noise, step) = (sensor.noise.unwrap_or(0.0).powi(2), sensor.resolution.unwrap_or(0.0).powi(2) / 12.0);
    Mat::from_fn(p, p, |i, j| noise * dot(&sums[i], &smoothed[j]) + step * dot(&sums[i], &sums[j]))
}

fn moved(name: &str, sensitivity: &Mat<f64>, direction: &[f64], dof: f64) -> Part {
    let p = sensitivity.nrows();
    let by: Vec<f64> = (0..p).map(|j| (0..direction.len()).map(|i| sensitivity[(j, i)] * direction[i]).sum()).collect();
    part(name, Kind::B, Mat::from_fn(p, p, |i, j| by[i] * by[j]), dof)
}

/// What the plan of a source takes and determines.
///
/// # Errors
///
/// What the campaign does not declare, and what the plan does not determine.
pub fn prospect(campaign: &Campaign, source: &Source) -> Result<Prospect, MethodError> {
    let twin = Twin::of(campaign, source)?;
    let (_, sensors) = seed_and_sensors(campaign, &senses())?;
    let found = forecast(&twin, sensors, source)?;
    let profiles: Vec<Profile> = twin.points.iter().map(profile).collect();
    let duration_s: f64 = profiles.iter().map(Profile::duration_s).sum();
    let longest_m = profiles.iter().map(Profile::travel_m).fold(0.0, f64::max);
    let steady_m: f64 = profiles.iter().map(steady_distance_m).sum();
    let paragraph = format!(
        "{} of {:.1} min in all on the log, waits between them and the way back not counted; {steady_m:.1} m of steady distance; the longest needs {longest_m:.2} m of travel. The \
         intervals are those of the linearised fit at the true coefficients of [simulate], with the noise of [[simulate.sensor]] and everything that is declared.",
        counted(profiles.len(), "run", "runs"),
        duration_s / 60.0
    );
    let tables = [matrix(&twin.points), coefficients(&twin.truth.law.name, &found)];
    Ok(plan::prospect(source, (profiles.len(), duration_s), tables, vec![paragraph]))
}

fn steady_distance_m(of: &Profile) -> f64 {
    of.speed_m_s.abs() * of.steady_s
}

fn matrix(points: &[Point]) -> ResultTable {
    let runs: Vec<(&Point, Profile)> = points.iter().map(|point| (point, profile(point))).collect();
    let t = TableBuilder::new("matrix", "Run matrix.", &runs);
    t.build(vec![
        t.text("run", "run", |(point, _)| point.id.clone()),
        t.text("configuration", "configuration", |(point, _)| point.configuration.clone()),
        t.text("in", "medium", |(p, _)| if p.role == Role::DryAir { "air" } else { "water" }.to_owned()),
        t.number("speed_m_s", "speed [m/s]", |(_, of)| of.speed_m_s).significant(3),
        t.number("acceleration_m_s2", "acceleration [m/s²]", |(_, of)| of.acceleration_m_s2).significant(3),
        t.number("duration_s", "duration [s]", |(_, of)| of.duration_s()).places(1),
        t.number("travel_m", "travel [m]", |(_, of)| of.travel_m()).places(2),
        t.number("steady_distance_m", "steady distance [m]", |(_, of)| steady_distance_m(of)).places(2),
    ])
}

/// The intervals to expect, each with the coefficient that it is most correlated with.
fn coefficients(law: &str, found: &Forecast) -> ResultTable {
    let most = |j: usize| {
        let others = found.expected.iter().enumerate().filter(|(k, _)| *k != j);
        others.map(|(k, e)| (&e.name, found.correlation[(j, k)])).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
    };
    let most: Vec<Option<(&String, f64)>> = (0..found.expected.len()).map(most).collect();
    let t = TableBuilder::new("", "", &most);
    let mut table = plan::intervals(&found.expected, "");
    table.columns.extend([
        t.text("", "correlated with", |most| most.map(|(name, r)| format!("{name} ({r:.2})"))),
        t.text("correlated_with", "", |most| most.map(|(name, _)| name.clone())),
        t.number("correlation", "", |most| most.map(|(_, r)| r)),
    ]);
    let caption = format!(
        "Intervals to expect, with the law {law} of [simulate]: true value, half-width of the 95 % interval (U95), the largest of the standard uncertainties (u) behind it, and the coefficient that it is \
         most correlated with."
    );
    ResultTable { caption, ..table }
}
