//! A run as rows: motion and force weighted over short windows, the acceleration without differentiation.
//!
//! With the window φ(t) = ⅔ (1 + cos 2πt/W)²/W on |t| ≤ W/2, which with its first two derivatives is zero at both ends, integration by parts gives
//!
//! ∫ φ a dt = −∫ φ′ v dt = ∫ φ″ x dt,
//!
//! so that m ∫ φ a dt = ∫ φ f dt holds exactly for whatever motion: speed, acceleration and force of a row are weighted alike, and no filter delays or
//! flattens one against the other. Windows lie W/3 apart, so that their sum is constant.
//!
//! **Units.** SI.
//!
//! # Source
//!
//! Shinbrot (1957), Trans. ASME 79, 67 (modulating functions); the window is cos⁴ of Harris (1978), Proc. IEEE 66, 51.

use std::f64::consts::TAU;

use froude_fit::faer::Mat;
use froude_fit::serial::{RowErrors, RowWindow, serial};
use froude_fit::series::{taper, tapered};
use froude_records::run::marks::Mark;

use crate::conditioning::stretches::longest_free;
use crate::error::TankError;

/// Fewest samples in a window.
const FEWEST_SAMPLES: f64 = 8.0;
/// Fewest rows of a run.
const FEWEST_ROWS: usize = 6;
/// A window moves where its speed exceeds this part of the largest.
const MOVES: f64 = 0.02;
/// The root mean square of the acceleration must exceed that of its noise this many times.
const ABOVE_NOISE: f64 = 3.0;
/// A cell that stands at its largest or smallest reading in this part of the moving samples is clipped …
const CLIPPED: f64 = 0.05;
/// … where at rest no reading has more than this part of the samples.
const REPEATS: f64 = 0.1;

/// A step longer than this many medians has ticks missing in it …
const MISSING: f64 = 1.5;
/// … and one longer than this part of a window is a gap: over a shorter one the window's weights are still smooth.
const GAP: f64 = 1.0 / 12.0;

/// How a run moves, as it was logged.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Way<'a> {
    /// Position along the axis, m.
    Position(&'a [f64]),
    /// Speed along it, m/s.
    Speed(&'a [f64]),
}

/// One run: columns of one length, time increasing.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TowRun<'a> {
    /// Its name.
    pub id: &'a str,
    /// Time, s.
    pub time_s: &'a [f64],
    /// Its motion.
    pub way: Way<'a>,
    /// Force of the rig on the body along the axis, N.
    pub force_n: &'a [f64],
    /// What is not used of it.
    pub marks: &'a [Mark],
}

/// The rows of one run.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Rows {
    /// Middles of the windows, s of the log.
    pub middle_s: Vec<f64>,
    /// Weighted speed, m/s.
    pub speed_m_s: Vec<f64>,
    /// Weighted v|v|, m²/s².
    pub square_m2_s2: Vec<f64>,
    /// Weighted acceleration, m/s².
    pub acceleration_m_s2: Vec<f64>,
    /// Weighted force, its zero taken off, N.
    pub force_n: Vec<f64>,
    /// Its slope in time, N/s.
    pub force_slope_n_s: Vec<f64>,
    /// The zero at the first and the last row, N.
    pub zero_n: [f64; 2],
    /// Standard uncertainty of that in the middle between the parts at rest, from their scatter, N.
    pub zero_standard_n: f64,
    /// Parts at rest, one or two: their middle, s of the log, and the standard uncertainty of their mean, N.
    pub zero_parts: Vec<[f64; 2]>,
    /// Degrees of freedom of these.
    pub zero_dof: f64,
    /// Root mean square of the acceleration at rest, or what the step of its channel makes of it, m/s²: its noise.
    pub noise_m_s2: f64,
    /// Times at rest before and after, s of the log: what the zero is the mean of.
    pub rest_s: [Option<[f64; 2]>; 2],
    /// Whether the motion was logged as a position.
    pub is_position: bool,
}

/// Weights of one window over the samples that it touches.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Window {
    /// First sample.
    pub from: usize,
    /// φ, summing to one.
    pub value: Vec<f64>,
    /// −φ′, which gives slope 1 of a straight line of slope 1.
    pub slope: Vec<f64>,
    /// φ″, which gives 1 of t²/2.
    pub bend: Vec<f64>,
}

/// The window about `middle_s`; what its samples lack of an integral is put right, so that straight lines and parabolas are exact.
pub(crate) fn window(time_s: &[f64], middle_s: f64, window_s: f64) -> Window {
    let (low, high) = (middle_s - 0.5 * window_s, middle_s + 0.5 * window_s);
    let from = time_s.partition_point(|t| *t < low);
    let end = time_s.partition_point(|t| *t <= high);
    let at: Vec<f64> = time_s[from..end].iter().map(|t| t - middle_s).collect();
    let omega = TAU / window_s;
    // Half of the time between the samples before and after: the sums are integrals at uneven steps too.
    let last = time_s.len().saturating_sub(1);
    let lasts_s = |i: usize| 0.5 * (time_s[(i + 1).min(last)] - time_s[i.saturating_sub(1)]);
    let weighted = |shape: &dyn Fn(f64) -> f64| -> Vec<f64> {
        at.iter().enumerate().map(|(k, t)| shape(*t) * lasts_s(from + k)).collect()
    };
    let scaled = |raw: Vec<f64>, moment: i32, factorial: f64| {
        let found: f64 = raw.iter().zip(&at).map(|(w, t)| w * t.powi(moment) / factorial).sum();
        raw.into_iter().map(|w| w / found).collect::<Vec<f64>>()
    };
    let without = |mut raw: Vec<f64>, shape: &dyn Fn(f64) -> f64| {
        let (moment, norm): (f64, f64) =
            raw.iter().zip(&at).fold((0.0, 0.0), |(m, n), (w, t)| (m + w * shape(*t), n + shape(*t).powi(2)));
        for (w, t) in raw.iter_mut().zip(&at) {
            *w -= moment / norm * shape(*t);
        }
        raw
    };
    let value = scaled(weighted(&|t| (1.0 + (omega * t).cos()).powi(2)), 0, 1.0);
    let slope = without(weighted(&|t| (1.0 + (omega * t).cos()) * (omega * t).sin()), &|_| 1.0);
    // First the slope, then the mean: on even samples about the middle the two do not touch each other.
    let shape = |t: f64| -(omega * t).cos() - (2.0 * omega * t).cos();
    let bend = without(without(weighted(&shape), &|t| t), &|_| 1.0);
    Window { from, value, slope: scaled(slope, 1, 1.0), bend: scaled(bend, 2, 2.0) }
}

/// Points of a window, for the correlation of rows; their smooth ends make the sums those of integrals.
const POINTS: usize = 48;

/// Time between the points of a window, s.
pub(crate) fn sample_s(window_s: f64) -> f64 {
    window_s / POINTS as f64
}

/// The errors of rows: noise of the force, correlated in time, under φ, and white noise of the motion that makes an error of `standard_n`, under φ″ of a position and φ′ of a speed.
#[must_use]
pub fn row_errors(is_position: bool, standard_n: f64) -> RowErrors {
    let angle = |k: usize| TAU * ((k as f64 + 0.5) / POINTS as f64 - 0.5);
    let of = |shape: &dyn Fn(f64) -> f64| RowWindow::new((0..POINTS).map(|k| shape(angle(k))).collect(), POINTS / 3);
    let motion = if is_position { of(&|x| -x.cos() - (2.0 * x).cos()) } else { of(&|x| (1.0 + x.cos()) * x.sin()) };
    RowErrors { window: of(&|x| (1.0 + x.cos()).powi(2)), white: (standard_n > 0.0).then_some((motion, standard_n)) }
}

impl Window {
    pub(crate) fn of(&self, weights: &[f64], series: &[f64]) -> f64 {
        weights.iter().zip(&series[self.from..]).map(|(w, x)| w * x).sum()
    }
}

/// Windows over a whole run, W/3 apart in each stretch without missing ticks.
pub(crate) fn windows(run: &TowRun<'_>, window_s: f64) -> Result<Vec<(f64, Window)>, TankError> {
    let mut steps: Vec<f64> = run.time_s.windows(2).map(|w| w[1] - w[0]).collect();
    let middle = steps.len() / 2;
    let step_s = *steps.select_nth_unstable_by(middle, f64::total_cmp).1;
    if window_s / step_s < FEWEST_SAMPLES {
        let what = format!(
            "a window of {window_s} s holds {:.1} samples, and 8 are needed; log faster, or write a longer window in [source.accelerated_tow]",
            window_s / step_s
        );
        return Err(TankError::of_run(run.id, what));
    }
    let middles = |part: &[f64]| {
        let (first, last) = (part[0], part[part.len() - 1]);
        let count = ((last - first - window_s) / (window_s / 3.0)).floor() as i64;
        (0..=count).map(move |i| first + window_s * (0.5 + i as f64 / 3.0)).collect::<Vec<f64>>()
    };
    let is_free = |t: &f64| run.marks.iter().all(|mark| !mark.touches(t - 0.5 * window_s, t + 0.5 * window_s));
    let longest_s = (MISSING * step_s).max(GAP * window_s);
    let parts = run.time_s.chunk_by(|a, b| b - a <= longest_s);
    Ok(parts.flat_map(middles).filter(is_free).map(|t| (t, window(run.time_s, t, window_s))).collect())
}

/// The rows of a run; the force is taken `delay_s` later than the motion.
///
/// # Errors
///
/// [`TankError`]: no motion, no part at rest, a clipped cell, accelerations below their noise.
pub fn rows(run: &TowRun<'_>, window_s: f64, delay_s: f64) -> Result<Rows, TankError> {
    let too_few = |found: usize| {
        let what = format!(
            "{found} windows of {window_s} s show motion, and {FEWEST_ROWS} are needed; a run at rest has the role \"still\", and a short one wants a shorter window"
        );
        TankError::of_run(run.id, what)
    };
    let n = match run.way {
        Way::Position(x) => x.len(),
        Way::Speed(v) => v.len(),
    };
    if n < 2 || [run.time_s.len(), run.force_n.len()] != [n; 2] {
        return Err(too_few(0));
    }
    let all = windows(run, window_s)?;
    let speed_of = |w: &Window| match run.way {
        Way::Position(x) => w.of(&w.slope, x),
        Way::Speed(v) => w.of(&w.value, v),
    };
    let acceleration_of = |w: &Window| match run.way {
        Way::Position(x) => w.of(&w.bend, x),
        Way::Speed(v) => w.of(&w.slope, v),
    };
    let motion: Vec<[f64; 2]> = all.iter().map(|(_, w)| [speed_of(w), acceleration_of(w)]).collect();
    let top = motion.iter().fold(0.0_f64, |m, row| m.max(row[0].abs()));
    let moves = |row: &[f64; 2]| row[0].abs() > MOVES * top;
    let (Some(start), Some(end)) = (motion.iter().position(moves), motion.iter().rposition(moves)) else {
        return Err(too_few(0));
    };
    // Windows before the first, and after the last, may hold the beginning and the end of the motion.
    let (start, end) = (start.saturating_sub(2), (end + 2).min(all.len() - 1));
    if end - start + 1 < FEWEST_ROWS {
        return Err(too_few(end - start + 1));
    }
    let half = 0.5 * window_s;
    let (begins_s, ends_s) = (all[start].0 - half, all[end].0 + half);
    let zero = zero(run, begins_s, ends_s, window_s)?;
    clipped(run, begins_s, ends_s)?;
    let mut out = Rows {
        zero_standard_n: zero.standard_n,
        zero_parts: zero.parts.clone(),
        zero_dof: zero.dof,
        rest_s: zero.rest_s,
        is_position: matches!(run.way, Way::Position(_)),
        ..Rows::default()
    };
    for (i, (middle_s, w)) in all.iter().enumerate().take(end + 1).skip(start) {
        let of_force = window(run.time_s, middle_s + delay_s, window_s);
        if of_force.value.len() < w.value.len().saturating_sub(1) {
            continue;
        }
        let square = |v: f64| v * v.abs();
        out.middle_s.push(*middle_s);
        out.speed_m_s.push(motion[i][0]);
        out.acceleration_m_s2.push(motion[i][1]);
        out.square_m2_s2.push(match run.way {
            Way::Speed(v) => w.value.iter().zip(&v[w.from..]).map(|(w, v)| w * square(*v)).sum(),
            // v² about its mean by the acceleration: the variance of φ is W² · ⅔ (1/8 − 15/16π²).
            Way::Position(_) => {
                square(motion[i][0]) + motion[i][0].signum() * (SPREAD * window_s * motion[i][1]).powi(2)
            }
        });
        out.force_n.push(of_force.of(&of_force.value, run.force_n) - zero.at(*middle_s));
        out.force_slope_n_s.push(of_force.of(&of_force.slope, run.force_n));
    }
    // A delay beyond the end of the log leaves none.
    if out.middle_s.len() < FEWEST_ROWS {
        return Err(too_few(out.middle_s.len()));
    }
    out.zero_n = [zero.at(begins_s), zero.at(ends_s)];
    let at_rest: Vec<f64> =
        all.iter().zip(&motion).filter(|((t, _), _)| zero.is_rest(*t, half)).map(|(_, row)| row[1]).collect();
    // An encoder that stands on one step at rest shows none of its noise.
    out.noise_m_s2 = root_mean_square(&at_rest).max(noise_of_step(run, &all[start].1));
    let rms = root_mean_square(&out.acceleration_m_s2);
    if rms < ABOVE_NOISE * out.noise_m_s2 {
        let what = format!(
            "its acceleration ({rms:.2e} m/s² in the mean square) is not above its noise ({:.2e} m/s²); accelerate harder, or write a longer window in \
             [source.accelerated_tow]",
            out.noise_m_s2
        );
        return Err(TankError::of_run(run.id, what));
    }
    Ok(out)
}

/// Standard deviation of the window as part of its length, √(⅔ (1/8 − 15/16π²)).
const SPREAD: f64 = 0.141_448_200_967;

/// Standard deviation of a window's acceleration by the step of the motion's channel, q/√12 in each sample, m/s².
fn noise_of_step(run: &TowRun<'_>, window: &Window) -> f64 {
    let (values, weights) = match run.way {
        Way::Position(x) => (x, &window.bend),
        Way::Speed(v) => (v, &window.slope),
    };
    let step = values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|d| *d > 0.0).fold(f64::INFINITY, f64::min);
    if step.is_finite() { step / 12.0_f64.sqrt() * weights.iter().map(|w| w * w).sum::<f64>().sqrt() } else { 0.0 }
}

impl Rows {
    /// What an error of 1 N in the mean of each part at rest adds to the zero at a time: the line between both.
    #[must_use]
    pub fn by_zero(&self, at_s: f64) -> Vec<f64> {
        match self.zero_parts[..] {
            [[from, _], [to, _]] => {
                let second = (at_s - from) / (to - from);
                vec![1.0 - second, second]
            }
            _ => vec![1.0; self.zero_parts.len()],
        }
    }
}

/// Root of the mean square; 0 of nothing.
pub(crate) fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// The zero of a run as a straight line between the parts at rest.
struct Zero {
    ends: [(f64, f64); 2],
    parts: Vec<[f64; 2]>,
    standard_n: f64,
    dof: f64,
    rest_s: [Option<[f64; 2]>; 2],
}

impl Zero {
    fn at(&self, t: f64) -> f64 {
        let [(from, a), (to, b)] = self.ends;
        if to > from { a + (t - from) / (to - from) * (b - a) } else { a }
    }

    fn is_rest(&self, middle_s: f64, half: f64) -> bool {
        self.rest_s.iter().flatten().any(|[from, to]| middle_s - half >= *from && middle_s + half <= *to)
    }
}

fn zero(run: &TowRun<'_>, begins_s: f64, ends_s: f64, window_s: f64) -> Result<Zero, TankError> {
    let t = run.time_s;
    let (first, last) = (t[0], t[t.len() - 1]);
    let free = |rows| longest_free(t, rows, run.marks).unwrap_or(0..0);
    let before = free(0..t.partition_point(|t| *t < begins_s));
    let after = free(t.partition_point(|t| *t <= ends_s)..t.len());
    let step_s = (last - first) / (t.len() - 1) as f64;
    // A single window of rest is as short as a row: two are the least that tells its scatter.
    let is_enough = |rows: &std::ops::Range<usize>| rows.len() as f64 * step_s >= 2.0 * window_s;
    let of = |rows: std::ops::Range<usize>| {
        is_enough(&rows).then(|| (0.5 * (t[rows.start] + t[rows.end - 1]), &run.force_n[rows]))
    };
    let rest = |rows: std::ops::Range<usize>| is_enough(&rows).then(|| [t[rows.start], t[rows.end - 1]]);
    let rest_s = [rest(before.clone()), rest(after.clone())];
    let (ends, rests) = match (of(before), of(after)) {
        (Some((from, a)), Some((to, b))) => ([(from, tapered(a)), (to, tapered(b))], vec![(from, a), (to, b)]),
        (Some((at, only)), None) | (None, Some((at, only))) => ([(at, tapered(only)); 2], vec![(at, only)]),
        (None, None) => {
            let what = format!(
                "the zero of the cell is unknown: the body stands still for {:.2} s before and {:.2} s after the tow, and {:.2} s are needed once; \
                 log while it stands still",
                begins_s - first,
                last - ends_s,
                2.0 * window_s
            );
            return Err(TankError::of_run(run.id, what));
        }
    };
    let (standards, dof) = of_means(&rests.iter().map(|(_, values)| *values).collect::<Vec<_>>());
    let parts: Vec<[f64; 2]> = rests.iter().zip(standards).map(|((at, _), standard)| [*at, standard]).collect();
    let squares: f64 = parts.iter().map(|[_, standard]| standard * standard).sum();
    Ok(Zero { ends, standard_n: squares.sqrt() / parts.len() as f64, parts, dof, rest_s })
}

/// Blocks that a part at rest is averaged to for the uncertainty of its mean.
const BLOCKS: usize = 32;

/// Standard uncertainties of the tapered means of parts at rest whose noise is alike, and their degrees of freedom: parts without scatter have none.
fn of_means(parts: &[&[f64]]) -> (Vec<f64>, f64) {
    let shortest = parts.iter().map(|part| part.len()).min().unwrap_or(0);
    let samples = (shortest / BLOCKS).max(1);
    let blocks: Vec<Vec<f64>> = parts
        .iter()
        .map(|part| part.chunks_exact(samples).map(|b| b.iter().sum::<f64>() / samples as f64).collect())
        .collect();
    let of: Vec<usize> = blocks.iter().enumerate().flat_map(|(k, b)| vec![k; b.len()]).collect();
    let design = Mat::from_fn(of.len(), parts.len(), |i, j| f64::from(u8::from(of[i] == j)));
    let weights: Vec<f64> = blocks
        .iter()
        .flat_map(|b| {
            let all: f64 = taper(b.len()).sum();
            taper(b.len()).map(move |w| w / all).collect::<Vec<f64>>()
        })
        .collect();
    let sensitivity = Mat::from_fn(parts.len(), of.len(), |j, i| if of[i] == j { weights[i] } else { 0.0 });
    let flat: Vec<f64> = blocks.concat();
    let mean = |j: usize| (0..of.len()).map(|i| sensitivity[(j, i)] * flat[i]).sum::<f64>();
    let means: Vec<f64> = (0..parts.len()).map(mean).collect();
    let residual: Vec<f64> = flat.iter().zip(&of).map(|(x, j)| x - means[*j]).collect();
    // A mean over a block is one of as many points: sixteen are an integral to a thousandth.
    let points = samples.min(16);
    let errors = RowErrors { window: RowWindow::new(vec![1.0; points], points), white: None };
    match serial(&design, sensitivity.as_ref(), &residual, &of, &errors) {
        Some(found) => {
            let standard = |j: usize| found.covariance[(j, j)].sqrt();
            ((0..parts.len()).map(standard).collect(), found.dof.iter().copied().fold(f64::INFINITY, f64::min))
        }
        None => (vec![0.0; parts.len()], 1.0),
    }
}

/// A cell that stands at its largest or smallest reading where it moves. One whose noise is below its step repeats itself at rest, too, and is none.
fn clipped(run: &TowRun<'_>, begins_s: f64, ends_s: f64) -> Result<(), TankError> {
    let (low, high) =
        run.force_n.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    let (from, to) = (run.time_s.partition_point(|t| *t < begins_s), run.time_s.partition_point(|t| *t <= ends_s));
    let moving = &run.force_n[from..to];
    let rest = run.force_n[..from].iter().chain(&run.force_n[to..]);
    let part = |value: f64| moving.iter().filter(|x| **x == value).count() as f64 / moving.len().max(1) as f64;
    let mut readings: Vec<f64> = rest.copied().collect();
    readings.sort_by(f64::total_cmp);
    let most = readings.chunk_by(|a, b| a == b).map(<[f64]>::len).max().unwrap_or(0);
    let repeats = most as f64 / readings.len().max(1) as f64;
    for value in [low, high] {
        let found = part(value);
        if found >= CLIPPED && low < high && repeats <= REPEATS {
            let what = format!(
                "force saturates at {value} N in {:.0} % of its moving part: the cell is clipped; widen its range, or accelerate less",
                1e2 * found
            );
            return Err(TankError::of_run(run.id, what));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn times(n: usize) -> Vec<f64> {
        (0..n).map(|i| 0.01 * i as f64).collect()
    }

    /// Up to a parabola every window is exact, wherever it lies between the samples.
    #[test]
    fn weights_are_exact_for_parabolas() {
        let t = times(200);
        let x: Vec<f64> = t.iter().map(|t| 0.3 - 0.2 * t + 0.45 * t * t).collect();
        let v: Vec<f64> = t.iter().map(|t| -0.2 + 0.9 * t).collect();
        for middle in [0.5, 0.9, 1.3] {
            let w = window(&t, middle, 0.4);
            // Forty products of size one.
            assert!((w.of(&w.value, &v) - (-0.2 + 0.9 * middle)).abs() < 1e-12);
            assert!((w.of(&w.slope, &v) - 0.9).abs() < 1e-11);
            assert!((w.of(&w.bend, &x) - 0.9).abs() < 1e-9);
        }
        let spread: f64 = window(&t, 1.0, 0.4).value.iter().zip(&t[80..]).map(|(w, t)| w * (t - 1.0).powi(2)).sum();
        // A sum of forty samples in the place of an integral of a window that ends smoothly.
        assert!((spread.sqrt() / 0.4 - SPREAD).abs() < 1e-6);
    }

    /// m ∫φa = ∫φf for a motion that is no polynomial, by position and by speed: weighted alike, nothing is lost.
    #[test]
    fn the_weighted_equation_holds_for_any_motion() {
        let t = times(1200);
        let bump = |t: f64| (-(t - 6.0).powi(2) / 0.5).exp();
        let x: Vec<f64> = t.iter().map(|t| bump(*t)).collect();
        let v: Vec<f64> = t.iter().map(|t| -4.0 * (t - 6.0) * bump(*t)).collect();
        let f: Vec<f64> = t.iter().map(|t| 2.0 * (16.0 * (t - 6.0).powi(2) - 4.0) * bump(*t)).collect();
        for way in [Way::Position(&x), Way::Speed(&v)] {
            let run = TowRun { id: "a", time_s: &t, way, force_n: &f, marks: &[] };
            let rows = rows(&run, 0.4, 0.0).unwrap();
            for (a, f) in rows.acceleration_m_s2.iter().zip(&rows.force_n) {
                // Sums of forty samples in the place of integrals: the window's bend ends in zero with a slope, which costs h⁴ of its second derivative.
                assert!((2.0 * a - f).abs() < 1e-3, "{a} {f}");
            }
        }
    }

    /// A second of ticks is missing in a ramp: no window reaches over it, and the equation holds in the others.
    #[test]
    fn windows_do_not_reach_over_missing_ticks() {
        let t: Vec<f64> = times(1200).into_iter().filter(|t| !(5.0..6.0).contains(t)).collect();
        let v: Vec<f64> = t.iter().map(|t| (0.1 * (t - 3.0)).clamp(0.0, 0.5)).collect();
        let f: Vec<f64> = t.iter().map(|t| if (3.0..8.0).contains(t) { 0.2 } else { 0.0 }).collect();
        let run = TowRun { id: "a", time_s: &t, way: Way::Speed(&v), force_n: &f, marks: &[] };
        let found = rows(&run, 0.4, 0.0).unwrap();
        // A window within its half of the gap would have lost samples.
        assert!(found.middle_s.iter().all(|t| *t < 4.8 + 0.011 || *t > 6.2 - 0.011), "{:?}", found.middle_s);
        for (a, f) in found.acceleration_m_s2.iter().zip(&found.force_n) {
            // Corners between samples: a sample of forty, weighted.
            assert!((2.0 * a - f).abs() < 0.01, "{a} {f}");
        }
        // A force that is later than the log is long leaves nothing.
        let refused = |run: &TowRun<'_>, delay_s: f64| rows(run, 0.4, delay_s).unwrap_err().to_string();
        assert!(refused(&run, 100.0).starts_with("run \"a\": 0 windows of 0.4 s show motion, and 6 are needed"));
        let short = TowRun { way: Way::Speed(&v[..10]), ..run };
        assert!(refused(&short, 0.0).contains("windows of 0.4 s show motion"));
    }

    #[test]
    fn a_run_without_rest_and_one_that_does_not_move_are_refused() {
        let t = times(400);
        let moving: Vec<f64> = t.iter().map(|t| 0.3 + 0.1 * t).collect();
        let run = TowRun { id: "a", time_s: &t, way: Way::Speed(&moving), force_n: &moving, marks: &[] };
        let refused = |run: &TowRun<'_>, window_s: f64| rows(run, window_s, 0.0).unwrap_err().to_string();
        assert!(refused(&run, 0.4).starts_with("run \"a\": the zero of the cell is unknown"));
        let still = vec![0.0; 400];
        let run = TowRun { way: Way::Speed(&still), ..run };
        assert!(refused(&run, 0.4).starts_with("run \"a\": 0 windows of 0.4 s show motion"));
        assert!(refused(&run, 0.05).starts_with("run \"a\": a window of 0.05 s holds 5.0 samples"));
    }
}
