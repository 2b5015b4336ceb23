//! A law without dry friction, fitted to a recorded speed by simulation (output error).
//!
//! M v̇ = F(t − delay + T) − F_v v − offset − Σ k φ(v)
//!
//! T ẇ = v − w
//!
//! (w is the speed as it is recorded, through a filter of the first order) is integrated from stamp to stamp (Runge and Kutta's fourth order), and its coefficients, the delay, T and the first speed of each stretch between gaps make the
//! sum of squares of measured less simulated speed least. T is at least 0; where it comes out there, it is left out. A delay that is declared is the whole lag. The speed is neither filtered nor differentiated: its noise biases nothing, however slow the log, and a force that
//! disturbs the axis is no part of the simulated speed. At the minimum the problem is linear to first order: its rows, without what the first speeds explain, give intervals as those of
//! any other fit of this chapter, from stretches of at least five correlation times of the residuals.
//!
//! **Between stamps** nothing is known of the command. The fit takes it halfway between straight lines and cubics; what a fit with cubics gives otherwise is
//! a standard uncertainty. (Of ten stamps to a period, lines have 3.3 % less amplitude than the sine that they join.)
//!
//! **Setting.** Thrust by hand or as planned. In a loop on the speed the force answers disturbances, and output error is biased where they move the axis much beside the reference
//! (Ljung, 13.4); with 0.3 N beside 25 N the intervals held (`tests/suite/vehicle.rs`). The limits below are ours.
//! **Start.** Least squares of the equation integrated over stretches of time, at trial delays.
//! **Source.** Ljung (1999), *System identification*, 4.3, 7.2 and 13.4.

use std::borrow::Cow;
use std::ops::Range;

use froude_fit::End;
use froude_fit::nonlinear::{Model, Parameter, Settings, Solution, minimise};
use froude_records::number::{percent, plain, significant};
use froude_records::run::stamps::{parts, usual_step_s};

use crate::servo::chain::{Chain, Delay};
use crate::servo::coordinate::{DELAY, FILTER, is_inertia};
use crate::servo::error::ServoError;
use crate::servo::log::rate_of;
use crate::servo::motion::Motion;
use crate::servo::regression::solve;
use crate::servo::report::{ServoCoefficient, ServoReport, of_logs, widened};
use crate::servo::rows::{Rows, norm};
use crate::servo::settle::lag;

/// Longest step of the integration, s, and as a part of the fastest time constant of the motion.
const STEP_S: f64 = 0.025;
const STEP_PART: f64 = 0.2;
/// Longest delay, s, and as a part of the longest stretch; nothing is simulated within it of the ends, where the command may be unknown.
const LONGEST_S: f64 = 5.0;
const LONGEST_PART: f64 = 0.05;
/// Trial delays to each side, and how many of the best the search starts from.
const TRIALS: i32 = 50;
const STARTS: usize = 3;
/// Most steps of a search.
const ITERATIONS: usize = 200;
/// A search has ended where a full step, which the coefficients include, moves none by more than this part of its standard uncertainty: were all of it an error, 95 % would be
/// 94 %. (The command has corners between its stamps, so that some searches stall at a sixth.)
const ENDED: f64 = 0.3;
/// Fewest simulated samples of a stretch.
const FEWEST_USED: usize = 10;
/// Sums of squares that differ by less than this part tell nothing of which of two fits holds.
const ALIKE: f64 = 0.02;
/// Relative error of the speed above which the law does not describe the motion.
const MOST_ERROR: f64 = 0.5;
/// Stretches are at least as many times as long as the longest delay.
const LEAST_LENGTHS: f64 = 4.0;
/// Most steps of the integration from stamp to stamp.
const MOST_STEPS: f64 = 50.0;
/// Stretches of time that the equation is integrated over, for a start.
const SPANS: usize = 200;
/// Time constant of the filter at the start, s.
const FIRST_S: f64 = 0.02;
/// Halfway between straight lines and cubics.
const HALFWAY: f64 = 0.5;
/// Parameters are off by this part of their standard uncertainties.
const OFFSET: f64 = 1e-4;
/// Fewest rows of a stretch between gaps.
const FEWEST: usize = 50;
/// Relative standard uncertainty of the inertia beyond which an interval that is linear to first order says nothing.
const MOST_UNCERTAIN: f64 = 0.3;
/// A natural step of a parameter, as a part of its size.
const NATURAL: f64 = 0.01;
/// Speed, as a part of the largest, at which a load that jumps at rest shows.
const NEAR_REST: f64 = 1e-6;

/// One log of a speed, columns of equal length.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SpeedLog {
    /// Time, s, increasing; steps may differ.
    pub time_s: Vec<f64>,
    /// Measured speed, m/s or rad/s.
    pub speed: Vec<f64>,
    /// Command to the drive, V.
    pub command_v: Vec<f64>,
}

/// Identifies an axis from logs of its speed: coefficients, delay and intervals as [`super::identify_logs`] gives them. `delay_standard_s` is the standard uncertainty of
/// a delay that is declared, 0 for an exact one.
///
/// # Errors
///
/// [`ServoError`]: stretches that are too short, dry friction, a motion that does not distinguish the coefficients, a delay longer than is looked for.
pub fn identify_speeds(logs: &[SpeedLog], chain: &Chain, delay_standard_s: f64) -> Result<ServoReport, ServoError> {
    let chain = Chain { is_moving: false, is_simulated: true, ..chain.clone() };
    let mut fit = Simulation::of(logs, &chain)?;
    let mut found = fit.found(None)?;
    let mut is_exchangeable = false;
    if let Some(other) = fit.exchanged(&found) {
        let [own, its] = [found.sum_of_squares, other.sum_of_squares];
        let is_other = fit
            .names
            .iter()
            .position(|(name, _)| is_inertia(name))
            .is_some_and(|j| (other.values[j] / found.values[j] - 1.0).abs() > MOST_UNCERTAIN);
        is_exchangeable = is_other && (its / own - 1.0).abs() < ALIKE;
        if its < own {
            found = other;
        }
    }
    let delay = fit.of_law();
    if chain.delay.is_estimated && found.at_bound[delay] {
        return Err(ServoError::Setting {
            what: "delay of the speed behind the command (s)",
            found: found.values[delay],
            must: "it is looked for within 5 s, and a twentieth of the longest stretch: bring the clocks together first, or record longer",
        });
    }
    let p = fit.names.len();
    let from = Some(&found.values[..p]);
    let kept = (0..p).filter(|j| !found.at_bound[*j]);
    let apart = |a: &[f64], b: &[f64], parts: f64| kept.clone().map(|j| (b[j] - a[j]) / parts).collect();
    let smooth = Simulation { smooth: 1.0, ..Simulation::of(logs, &chain)? }.found(from)?.values;
    let mut changes: Vec<Vec<f64>> = vec![apart(&found.values, &smooth, 1.0)];
    if delay_standard_s > 0.0 {
        let at = |late_s: f64| -> Result<Vec<f64>, ServoError> {
            let delay = Delay { at_s: chain.delay.at_s + late_s, ..chain.delay.clone() };
            Ok(Simulation::of(logs, &Chain { delay, ..chain.clone() })?.found(from)?.values)
        };
        changes.push(apart(&at(-delay_standard_s)?, &at(delay_standard_s)?, 2.0));
    }
    let delay = Delay { changes, ..chain.delay.clone() };
    let mut report = of_logs(fit.rows(&found), &Chain { delay, ..chain.clone() })?;
    fit.tell(&mut report, &found, is_exchangeable);
    Ok(report)
}

/// A stretch between gaps: of which log, and which of its samples.
struct Stretch<'a> {
    log: usize,
    time_s: &'a [f64],
    speed: &'a [f64],
    command_v: &'a [f64],
    /// Samples that are simulated.
    used: Range<usize>,
}

struct Simulation<'a> {
    chain: &'a Chain,
    stretches: Vec<Stretch<'a>>,
    logs: usize,
    rate_hz: f64,
    /// Longest delay that is looked for.
    longest_s: f64,
    /// Longest step of the integration.
    step_s: f64,
    /// The command between its stamps: from straight lines, 0, to cubics, 1.
    smooth: f64,
    /// Names and units of the shared parameters: inertia, drag, offset, loads, and delay and filter where they are fitted.
    names: Vec<(String, Cow<'static, str>)>,
}

impl<'a> Simulation<'a> {
    fn of(logs: &'a [SpeedLog], chain: &'a Chain) -> Result<Self, ServoError> {
        let mut all = Vec::new();
        for (log, columns) in logs.iter().enumerate() {
            for rows in parts(&columns.time_s).into_iter().filter(|rows| rows.len() >= FEWEST) {
                let of = |column: &'a [f64]| &column[rows.clone()];
                all.push((log, of(&columns.time_s), of(&columns.speed), of(&columns.command_v)));
            }
        }
        let length_s = |t: &[f64]| t[t.len() - 1] - t[0];
        let longest_s = LONGEST_S.min(LONGEST_PART * all.iter().map(|(_, t, ..)| length_s(t)).fold(0.0, f64::max));
        all.retain(|(_, t, ..)| length_s(t) >= LEAST_LENGTHS * longest_s);
        let stretch = |(log, time_s, speed, command_v): (usize, &'a [f64], &'a [f64], &'a [f64])| {
            let (first, last) = (time_s[0] + longest_s, time_s[time_s.len() - 1] - longest_s);
            let used = time_s.partition_point(|t| *t < first)..time_s.partition_point(|t| *t <= last);
            Stretch { log, time_s, speed, command_v, used }
        };
        let stretches: Vec<Stretch<'a>> =
            all.into_iter().map(stretch).filter(|stretch| stretch.used.len() >= FEWEST_USED).collect();
        for (log, columns) in logs.iter().enumerate() {
            if !stretches.iter().any(|stretch| stretch.log == log) {
                return Err(ServoError::TooFewRows { rows: columns.time_s.len(), needed: FEWEST });
            }
        }
        let step_s = logs.first().and_then(|log| usual_step_s(&log.time_s)).unwrap_or(f64::NAN);
        let names = chain.regressors(&Motion::at_speeds(Vec::new()))?.into_iter().map(|r| (r.name, r.unit));
        let lags: &[&str] = if chain.delay.is_estimated { &[DELAY, FILTER] } else { &[] };
        let lags = lags.iter().map(|name| ((*name).to_owned(), "s".into()));
        let (rate_hz, names) = (rate_of(step_s)?, names.chain(lags).collect());
        let out =
            Self { chain, logs: logs.len(), rate_hz, longest_s, step_s: STEP_S, smooth: HALFWAY, names, stretches };
        out.has_no_jump()?;
        Ok(out)
    }

    /// That no load jumps at rest.
    fn has_no_jump(&self) -> Result<(), ServoError> {
        let at = [-NEAR_REST, NEAR_REST, 1.0].map(|part| part * self.fastest());
        let columns = self.chain.regressors(&Motion::at_speeds(at.to_vec()))?;
        let jump = |x: &[f64]| (x[1] - x[0]).abs() / x[2].abs();
        let largest = columns.iter().map(|column| jump(&column.values)).fold(0.0, f64::max);
        if largest > NEAR_REST.sqrt() {
            return Err(ServoError::Setting {
                what: "the jump of a load at rest, over the load at the largest speed,",
                found: largest,
                must: "a jump is dry friction, which a speed alone does not tell: record the position, or leave the load out",
            });
        }
        Ok(())
    }

    fn fastest(&self) -> f64 {
        self.stretches.iter().flat_map(|stretch| stretch.speed).fold(0.0, |most, v| v.abs().max(most))
    }

    /// The minimum from `start`, or the lowest from some starts of its own.
    fn found(&mut self, start: Option<&[f64]>) -> Result<Solution, ServoError> {
        let starts = start.map_or_else(|| self.starts(), |start| Ok(vec![start.to_vec()]))?;
        let mut best: Option<Solution> = None;
        for start in starts {
            let Ok(found) = self.from(&start) else { continue };
            if best.as_ref().is_none_or(|best| found.sum_of_squares < best.sum_of_squares) {
                best = Some(found);
            }
        }
        best.ok_or(ServoError::Dependent)
    }

    /// The minimum from one start, integrated in steps that suit the motion there.
    fn from(&mut self, start: &[f64]) -> Result<Solution, ServoError> {
        self.step_s = STEP_S.min(STEP_PART * start[0] / self.slope(start, self.fastest()));
        self.step_s = self.step_s.max(1.0 / (MOST_STEPS * self.rate_hz));
        let settings = Settings { offset: OFFSET, iterations: ITERATIONS, ..Settings::default() };
        Ok(minimise(self, &self.parameters(start), &settings)?)
    }

    /// How fast the resistance grows with the speed, up to a speed.
    fn slope(&self, theta: &[f64], speed: f64) -> f64 {
        let mut resistance = self.resistance(theta);
        ((resistance(speed) - resistance(0.0)) / speed).abs()
    }

    /// The fit where inertia and filter have changed their places: through a linear law both give the same speed. `None` without a filter.
    fn exchanged(&mut self, found: &Solution) -> Option<Solution> {
        let filter = self.names.iter().position(|(name, _)| name == FILTER)?;
        let mut start = found.values[..self.names.len()].to_vec();
        let speeds: Vec<f64> = self.stretches.iter().flat_map(|s| s.speed).copied().collect();
        let slope = self.slope(&start, norm(&speeds) / (speeds.len() as f64).sqrt());
        (start[0], start[filter]) = (start[filter] * slope, start[0] / slope);
        let is_possible = !found.at_bound[filter] && start[0] > 0.0 && start[filter] < self.longest_s;
        is_possible.then(|| self.from(&start).ok()).flatten()
    }

    /// How many of the shared parameters are coefficients of the law: delay and filter follow them.
    fn of_law(&self) -> usize {
        self.names.len() - if self.chain.delay.is_estimated { 2 } else { 0 }
    }

    /// By how much the motion itself is late, and the time constant of the filter; together they are the delay.
    fn lags_s(&self, theta: &[f64]) -> [f64; 2] {
        match theta[self.of_law()..] {
            [delay, filter] => [delay - filter, filter],
            _ => [self.chain.delay.at_s, 0.0],
        }
    }

    /// Force of the drive at a time, the command between its stamps between straight lines and Catmull and Rom's cubics; `after` moves on with the times.
    fn force(&self, stretch: &Stretch<'_>, t: f64, after: &mut usize) -> f64 {
        while *after + 1 < stretch.time_s.len() && stretch.time_s[*after] < t {
            *after += 1;
        }
        while *after > 1 && stretch.time_s[*after - 1] > t {
            *after -= 1;
        }
        let [a, b] = [stretch.time_s[*after - 1], stretch.time_s[*after]];
        let [u, w] = [stretch.command_v[*after - 1], stretch.command_v[*after]];
        let part = ((t - a) / (b - a)).clamp(0.0, 1.0);
        let slope = |i: usize| {
            let (from, to) = (i.saturating_sub(1), (i + 1).min(stretch.time_s.len() - 1));
            (stretch.command_v[to] - stretch.command_v[from]) / (stretch.time_s[to] - stretch.time_s[from])
        };
        let [left, right] = [*after - 1, *after].map(|i| (b - a) * slope(i) - (w - u));
        let bend = part * (1.0 - part) * ((1.0 - part) * left - part * right);
        self.chain.force_per_volt_n_v * (u + (w - u) * part + self.smooth * bend)
    }

    /// What resists a speed: `F_v v + offset + Σ k φ(v)`.
    fn resistance<'t>(&'t self, theta: &'t [f64]) -> impl FnMut(f64) -> f64 + 't {
        let (mut row, mut channels) = (vec![0.0; theta.len()], vec![0.0; theta.len()]);
        move |v| {
            channels.fill(v);
            let mut sum = theta[1] * v + theta[2];
            let mut loads = &theta[3..];
            for (formula, _) in &self.chain.load.terms {
                let (own, rest) = loads.split_at(formula.coefficients.len());
                formula.regressor(&channels, &mut row[..own.len()]);
                sum += row.iter().zip(own).map(|(x, k)| x * k).sum::<f64>();
                loads = rest;
            }
            sum
        }
    }

    /// Simulated speeds of a stretch; `None` where they run away.
    fn speeds(&self, stretch: &Stretch<'_>, theta: &[f64], first: f64) -> Option<Vec<f64>> {
        let (inertia, [late_s, filter_s]) = (theta[0], self.lags_s(theta));
        let mut resistance = self.resistance(theta);
        let times = &stretch.time_s[stretch.used.clone()];
        let (mut v, mut after) = (first, 1);
        let slope = (self.force(stretch, times[0] - late_s, &mut after) - resistance(v)) / inertia;
        let mut recorded = first - filter_s * slope;
        let mut out = vec![recorded];
        for pair in times.windows(2) {
            let steps = ((pair[1] - pair[0]) / self.step_s).ceil().max(1.0);
            let h = (pair[1] - pair[0]) / steps;
            for k in 0..steps as u32 {
                let t = pair[0] + f64::from(k) * h - late_s;
                let [f_0, f_1, f_2] = [t, t + 0.5 * h, t + h].map(|t| self.force(stretch, t, &mut after));
                let k_1 = (f_0 - resistance(v)) / inertia;
                let k_2 = (f_1 - resistance(v + 0.5 * h * k_1)) / inertia;
                let k_3 = (f_1 - resistance(v + 0.5 * h * k_2)) / inertia;
                let k_4 = (f_2 - resistance(v + h * k_3)) / inertia;
                let change = h * (k_1 + 2.0 * k_2 + 2.0 * k_3 + k_4) / 6.0;
                // Exact for a speed that changes evenly over the step.
                let behind = change / h * filter_s;
                let kept = if filter_s > 0.0 { (-h / filter_s).exp() } else { 0.0 };
                recorded = v + change - behind + (recorded - v + behind) * kept;
                v += change;
            }
            out.push(recorded);
        }
        out.iter().all(|v| v.is_finite()).then_some(out)
    }

    /// Shared parameters by least squares of the equation integrated over spans, at the trial delays that leave least.
    fn starts(&self) -> Result<Vec<Vec<f64>>, ServoError> {
        let is_estimated = self.chain.delay.is_estimated;
        let mut all: Vec<(f64, Vec<f64>)> = Vec::new();
        for trial in if is_estimated { -TRIALS..=TRIALS } else { 0..=0 } {
            let trial_s = 0.99 * self.longest_s * f64::from(trial) / f64::from(TRIALS);
            let late_s = if is_estimated { trial_s } else { self.chain.delay.at_s };
            let (columns, response) = self.integrated(late_s)?;
            let left = match solve(&columns, &response) {
                Ok(solution) if solution.coefficients[0] > 0.0 => {
                    let lags = if is_estimated { vec![late_s, FIRST_S] } else { Vec::new() };
                    (solution.sigma, [solution.coefficients, lags].concat())
                }
                _ => (f64::INFINITY, Vec::new()),
            };
            all.push(left);
        }
        // Valleys of what is left, the deepest first.
        let at = |i: usize| all.get(i).map_or(f64::INFINITY, |(left, _)| *left);
        let is_valley = |i: &usize| at(*i).is_finite() && at(*i) <= at(i.wrapping_sub(1)) && at(*i) <= at(i + 1);
        let mut valleys: Vec<usize> = (0..all.len()).filter(is_valley).collect();
        valleys.sort_by(|i, j| at(*i).total_cmp(&at(*j)));
        Ok(valleys.into_iter().take(STARTS).map(|i| all[i].1.clone()).collect())
    }

    /// ∫F = M Δv + Σ k ∫φ over spans of each stretch, each half over the one before.
    fn integrated(&self, late_s: f64) -> Result<(Vec<Vec<f64>>, Vec<f64>), ServoError> {
        let (mut columns, mut response) = (vec![Vec::new(); self.of_law()], Vec::new());
        for stretch in &self.stretches {
            let (times, speed) = (&stretch.time_s[stretch.used.clone()], &stretch.speed[stretch.used.clone()]);
            let regressors = self.chain.regressors(&Motion::at_speeds(speed.to_vec()))?;
            let mut after = 1;
            let force: Vec<f64> = times.iter().map(|t| self.force(stretch, t - late_s, &mut after)).collect();
            let span = (2 * times.len() / SPANS).max(10);
            let integral = |x: &[f64], rows: &Range<usize>| {
                let steps = times[rows.clone()].windows(2).zip(x[rows.clone()].windows(2));
                steps.map(|(t, x)| 0.5 * (t[1] - t[0]) * (x[0] + x[1])).sum::<f64>()
            };
            for from in (0..times.len().saturating_sub(span)).step_by(span / 2) {
                let rows = from..from + span;
                response.push(integral(&force, &rows));
                columns[0].push(speed[rows.end - 1] - speed[rows.start]);
                for (column, regressor) in columns[1..].iter_mut().zip(&regressors[1..]) {
                    column.push(integral(&regressor.values, &rows));
                }
            }
        }
        Ok((columns, response))
    }

    /// Shared parameters from their start on, and the first speed of each stretch.
    fn parameters(&self, start: &[f64]) -> Vec<Parameter> {
        let rms = |x: &[f64]| norm(x) / (x.len() as f64).sqrt();
        let force: Vec<f64> =
            self.stretches.iter().flat_map(|s| s.command_v).map(|u| self.chain.force_per_volt_n_v * u).collect();
        let speeds: Vec<f64> = self.stretches.iter().flat_map(|s| s.speed).copied().collect();
        let (force, speed) = (rms(&force), rms(&speeds));
        let columns = self.chain.regressors(&Motion::at_speeds(speeds)).unwrap_or_default();
        let mut out: Vec<Parameter> = Vec::new();
        for (j, ((name, _), value)) in self.names.iter().zip(start).enumerate() {
            out.push(match columns.get(j) {
                Some(_) if is_inertia(name) => {
                    Parameter::new(name.as_str(), *value, NATURAL * value).within(1e-3 * value, f64::INFINITY)
                }
                Some(column) => Parameter::new(name.as_str(), *value, NATURAL * force / rms(&column.values)),
                None => {
                    let least = if name == FILTER { 0.0 } else { -self.longest_s };
                    Parameter::new(name.as_str(), value.max(least), 0.1 / self.rate_hz).within(least, self.longest_s)
                }
            });
        }
        for (i, stretch) in self.stretches.iter().enumerate() {
            let first = stretch.speed[stretch.used.start];
            out.push(Parameter::new(format!("first speed of stretch {}", i + 1), first, NATURAL * speed).of_run(i));
        }
        out
    }

    /// The rows of each log at the minimum, where the problem is linear, without what the first speeds explain.
    fn rows(&self, found: &Solution) -> Vec<Rows> {
        let p = self.names.len();
        let kept: Vec<usize> = (0..p).filter(|j| !found.at_bound[*j]).collect();
        let mut logs: Vec<Option<Rows>> = vec![None; self.logs];
        for (i, stretch) in self.stretches.iter().enumerate() {
            let own = &found.columns[i][p];
            let square = own.iter().map(|x| x * x).sum::<f64>();
            let without = |x: &[f64]| {
                let part = own.iter().zip(x).map(|(o, x)| o * x).sum::<f64>() / square;
                x.iter().zip(own).map(|(x, o)| x - part * o).collect::<Vec<f64>>()
            };
            let columns: Vec<Vec<f64>> = kept.iter().map(|j| without(&found.columns[i][*j])).collect();
            let mut response = without(&found.residuals[i]);
            for (column, j) in columns.iter().zip(&kept) {
                response.iter_mut().zip(column).for_each(|(y, x)| *y += found.values[*j] * x);
            }
            let rows = Rows {
                rate_hz: self.rate_hz,
                time_s: stretch.time_s[stretch.used.clone()].to_vec(),
                force_n: response,
                names: kept.iter().map(|j| self.names[*j].clone()).collect(),
                columns,
            };
            match &mut logs[stretch.log] {
                Some(all) => all.append(rows),
                none => *none = Some(rows),
            }
        }
        logs.into_iter().flatten().collect()
    }

    /// Replaces the linearised rows with speeds for the page, and adds the findings; withholds the intervals of a fit that does not support them.
    fn tell(&self, report: &mut ServoReport, found: &Solution, is_exchangeable: bool) {
        let measured = |stretch: &Stretch<'_>| stretch.speed[stretch.used.clone()].to_vec();
        let speeds: Vec<f64> = self.stretches.iter().flat_map(measured).collect();
        let residuals: Vec<f64> = found.residuals.iter().flatten().copied().collect();
        let fit = &mut report.fit;
        fit.relative_force_error = norm(&residuals) / norm(&speeds);
        fit.preparation = format!(
            "speed simulated from stamp to stamp and fitted as measured, without {} s at each end",
            plain(self.longest_s, 3)
        );
        let mut accelerations = [f64::INFINITY, f64::NEG_INFINITY];
        for (stretch, residuals) in self.stretches.iter().zip(&found.residuals) {
            let times = &stretch.time_s[stretch.used.clone()];
            let simulated: Vec<f64> = measured(stretch).iter().zip(residuals).map(|(v, r)| v - r).collect();
            let slopes = times.windows(2).zip(simulated.windows(2)).map(|(t, v)| (v[1] - v[0]) / (t[1] - t[0]));
            accelerations = widened(accelerations, &slopes.collect::<Vec<f64>>());
        }
        let of_speed = widened([f64::INFINITY, f64::NEG_INFINITY], &speeds);
        for ((name, _), range) in self.names.iter().zip(&mut fit.ranges) {
            *range = if is_inertia(name) { accelerations } else { of_speed };
        }
        let kept = found.values.iter().zip(&found.at_bound).filter(|(_, at_bound)| !**at_bound);
        let step = |(c, (value, _)): (&ServoCoefficient, (&f64, &bool))| (c.value - value).abs() / c.block_std;
        let last_step = fit.coefficients.iter().zip(kept).map(step).fold(0.0, f64::max);
        let inertia = fit.coefficients.iter().find(|c| is_inertia(&c.name));
        let uncertain = inertia.filter(|c| c.block_std <= MOST_UNCERTAIN * c.value.abs());
        let why = if is_exchangeable {
            Some("inertia and filter may change places, which this motion does not tell: reach higher speeds, or declare the delay, which is then a pure one".to_owned())
        } else if found.report.end == End::IterationLimit || last_step > ENDED {
            Some(
                "the search for them did not converge: fit fewer, or record a motion with more changes of the thrust"
                    .to_owned(),
            )
        } else if fit.relative_force_error > MOST_ERROR {
            Some(format!(
                "they leave {} of the speed: the law is not that of this motion, the clocks differ by more than is looked for, or a sign is wrong",
                percent(fit.relative_force_error)
            ))
        } else if uncertain.is_none() {
            let said = inertia
                .map_or_else(String::new, |c| format!(" ({} ± {})", plain(c.value, 3), significant(c.block_std, 2)));
            Some(format!("the motion hardly determines the inertia{said}: change the thrust more often"))
        } else {
            None
        };
        if let Some(why) = why {
            fit.excitation.push(format!("no coefficient has an interval, because {why}"));
            for c in &mut fit.coefficients {
                (c.block_std, c.hac_std, c.interval) = (f64::NAN, f64::NAN, [f64::NAN; 2]);
            }
        }
        fit.findings.extend(lag(fit, self.rate_hz.recip()));
        report.rows.force_n = speeds;
        report.residuals_n = residuals;
    }
}

impl Model for Simulation<'_> {
    fn runs(&self) -> usize {
        self.stretches.len()
    }

    fn residuals(&self, run: usize, theta: &[f64]) -> Option<Vec<f64>> {
        let stretch = &self.stretches[run];
        let simulated = self.speeds(stretch, &theta[..self.names.len()], theta[self.names.len() + run])?;
        Some(stretch.speed[stretch.used.clone()].iter().zip(simulated).map(|(v, s)| v - s).collect())
    }
}
