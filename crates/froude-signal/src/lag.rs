//! Lag and drift between two clocks, from a motion that two separately clocked records both show.
//!
//! A stamp s of the second clock is of the first clock's time t(s) = s − lag − drift (s − origin). Both records are seen under one Gaussian window ([`smooth`]); where the second saw
//! the velocity or the acceleration of what the first saw, the first is differentiated by the same window, so that neither is delayed. The correlation over all shifts gives
//! candidates; each is refined by Gauss and Newton's method to y(s) = a + b x(t(s)), a, b, lag and drift being free.
//!
//! **Uncertainty.** H⁻¹ M H⁻¹ with the whole second derivative H of the sum of squares, which noise of x does not bias, and M = Σ γ_{i−j} z_i z_j from the autocovariance γ of what is left in each of
//! twelve windows: noise may be correlated. Each window gives a lag; where these scatter about the line by more than chance, by Birge's ratio the intervals are wider, and what is left is [`Lag::left_s`].
//! A trigger is known to no better than its samples: its lag has at least the variance of the rounding of both clocks, (h₁² + h₂²)/12.
//!
//! **Units.** Time in s. **Range.** Refused: a pair that does not correlate, shifts that fit equally well, a line that the lags of the windows do not follow, a drift that rests on one moment.
//!
//! # Source
//!
//! Knapp & Carter (1976), IEEE Trans. ASSP 24, 320 (delay by correlation); White (1980), Econometrica 48, 817, and Newey & West (1987), Econometrica 55, 703 (covariance); Birge (1932), Phys. Rev. 40, 207.

mod covariance;
mod shifts;

use faer::Mat;
use faer::prelude::*;

use crate::error::SignalError;
use crate::resample::Spline;
use crate::smooth::{Smooth, smooth};
use covariance::Noise;

/// Correlation below which two records are not of one thing: half of the variance is common to both.
const LEAST_CORRELATION: f64 = 0.7;
/// By how much a correlation of opposite sign is larger than that of any shift.
const OPPOSITE: f64 = 0.05;
/// Logarithm of the likelihood ratio by which the best shift beats any other, and none at all: 5 standard deviations, over some hundred independent shifts.
const SURE: f64 = 20.0;
/// The same as a ratio of mean squares, for records whose misfit is not noise.
const CLEARLY: f64 = 1.1;
/// Windows that give a lag each.
const WINDOWS: usize = 12;
/// What is left of the lags of windows is below this part of a period: more moves inertia into damping.
const MOST_LEFT: f64 = crate::clock::MOST_LEFT_RAD / std::f64::consts::TAU;
/// A step in the lags of windows that improves their χ² by so much, and leaves less than such a part of it, is a jump of a clock.
const JUMP: (f64, f64) = (30.0, 0.3);
/// A drift rests on one moment where it moves the ends of the overlap by so many standard uncertainties of the lag.
const LEVER: f64 = 10.0;
/// Part of the range that one step changes of a record that jumps, and one in how many of its steps does so at most: a trigger.
const STEPPED: (f64, usize) = (0.3, 20);
/// A window is no wider than this part of the shorter record.
const SHORTEST_WINDOWS: f64 = 60.0;
/// Most values that are compared.
const MOST_VALUES: f64 = 2e5;
/// A declared drift is contradicted by one that lies so many standard uncertainties away.
const CONTRADICTED: f64 = 3.0;
/// No pair of clocks drifts by more.
pub const MOST_DRIFT: f64 = 0.1;
/// Steps of Gauss and Newton, and part of a step of the records at which they end.
const STEPS: (usize, f64) = (25, 1e-5);

/// A record with stamps of its own clock.
#[derive(Debug, Clone, Copy)]
pub struct Record<'a> {
    /// Stamps, s, increasing.
    pub time_s: &'a [f64],
    /// A value for each.
    pub values: &'a [f64],
    /// Its usual step, s.
    pub step_s: f64,
    /// Stretches without samples, s.
    pub gaps_s: &'a [[f64; 2]],
}

/// What is known beforehand.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Known {
    /// The lag at the second record's first stamp lies so near to a value, s.
    pub lag_s: Option<[f64; 2]>,
    /// The drift with its standard uncertainty; else it is found.
    pub drift: Option<[f64; 2]>,
    /// How often the first is to be differentiated to be what the second saw; below 0 the second.
    pub derivative: i32,
}

/// How the stamps of the second clock differ from the time of the first.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lag {
    /// How much the second clock's stamp exceeds the first clock's time at [`Lag::origin_s`], s.
    pub lag_s: f64,
    /// By how much it gains, s/s.
    pub drift: f64,
    /// The stamp of the second clock at which the lag holds, s: where the records tell it best.
    pub origin_s: f64,
    /// Standard uncertainties of lag (s) and drift.
    pub standard: [f64; 2],
    /// Root mean square by which the lags of windows leave the line beyond chance, s.
    pub left_s: f64,
    /// Slope of the second record over the first.
    pub gain: f64,
    /// Their correlation under the window.
    pub correlation: f64,
    /// What they have in common, in the first clock's time, s.
    pub overlap_s: [f64; 2],
}

impl Lag {
    /// The first clock's time of a stamp of the second, s.
    #[must_use]
    pub fn time_s(&self, stamp_s: f64) -> f64 {
        stamp_s - self.lag_s - self.drift * (stamp_s - self.origin_s)
    }

    /// Standard uncertainty of such a time, root mean square over the overlap, s.
    #[must_use]
    pub fn standard_s(&self) -> f64 {
        let [from, to] = self.overlap_s;
        let (length, off) = (to - from, 0.5 * (from + to) - self.time_s(self.origin_s));
        let arm = (length * length / 12.0 + off * off).sqrt();
        self.standard[0].hypot(self.standard[1] * arm).hypot(self.left_s)
    }
}

/// Why two records do not tell how their clocks differ.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LagError {
    /// A record that cannot be looked at.
    #[error(transparent)]
    Record(#[from] SignalError),
    /// No shift makes them alike.
    #[error("their largest correlation at any shift is {correlation:.2}, and {LEAST_CORRELATION} is needed")]
    NotAlike {
        /// The largest.
        correlation: f64,
    },
    /// They are alike with the opposite sign.
    #[error("they correlate with opposite signs (−{correlation:.2})")]
    Opposite {
        /// Its size.
        correlation: f64,
    },
    /// Another shift fits as well.
    #[error("lags of {lag_s:.4} s and {other_s:.4} s fit about as well")]
    Ambiguous {
        /// The best, at the second record's first stamp.
        lag_s: f64,
        /// The rival.
        other_s: f64,
    },
    /// The motion in the overlap tells no lag: a ramp, or nothing that changes.
    #[error("the records change too little, or too evenly, to tell a lag")]
    Undetermined,
    /// It tells a lag, and no drift.
    #[error(
        "the only event is near {origin_s:.3} s of the second clock: it fixes the lag there ({lag_s:.4} s) but not the drift"
    )]
    DriftOpen {
        /// The lag there, s.
        lag_s: f64,
        /// That moment, s of the second clock.
        origin_s: f64,
    },
    /// The best lag is at the end of the declared range.
    #[error("the best lag lies at the end of the declared range, {lag_s:.4} s")]
    AtTheEnd {
        /// That end.
        lag_s: f64,
    },
    /// One clock jumps.
    #[error("the lag jumps by {jump_s:.4} s near {time_s:.3} s of the first clock")]
    Jump {
        /// By how much.
        jump_s: f64,
        /// Where.
        time_s: f64,
    },
    /// The records show another drift than the declared one.
    #[error("the records show a drift of {:.1} ± {:.1} ppm, and {:.1} ± {:.1} ppm is declared (standard uncertainties)", 1e6 * found, 1e6 * standard, 1e6 * declared, 1e6 * of_declared)]
    DriftContradicted {
        /// As the lags of windows show it.
        found: f64,
        /// Its standard uncertainty.
        standard: f64,
        /// As declared.
        declared: f64,
        /// Its standard uncertainty.
        of_declared: f64,
    },
    /// The clocks wander.
    #[error(
        "the lags of {WINDOWS} windows leave a straight line by {left_s:.4} s (rms), beyond a 36th of the motion's period of {period_s:.3} s: the clocks wander"
    )]
    NotLinear {
        /// Root mean square, s.
        left_s: f64,
        /// Period of the motion, s.
        period_s: f64,
    },
}

/// Lag and drift of the second record's clock behind the first's.
///
/// A declared drift is combined with the one that the records show, where they show one, by the inverse squares of their standard uncertainties.
///
/// # Errors
///
/// [`LagError`].
pub fn find(first: &Record<'_>, second: &Record<'_>, known: &Known) -> Result<Lag, LagError> {
    let Some([declared, of_declared]) = known.drift else { return at_drift(first, second, known) };
    let Ok(lag) = at_drift(first, second, &Known { drift: None, ..*known }) else {
        return at_drift(first, second, known);
    };
    let (drift, standard) = (lag.drift, lag.standard[1]);
    if (drift - declared).abs() > CONTRADICTED * of_declared.hypot(standard) {
        return Err(LagError::DriftContradicted { found: drift, standard, declared, of_declared });
    }
    // At its origin the lag goes with no drift.
    let part = of_declared.powi(2) / (of_declared.powi(2) + standard.powi(2));
    let drift = declared + part * (drift - declared);
    Ok(Lag { drift, standard: [lag.standard[0], standard * part.sqrt()], ..lag })
}

/// The same with the drift as declared, where it is.
fn at_drift(first: &Record<'_>, second: &Record<'_>, known: &Known) -> Result<Lag, LagError> {
    let begin_s = second.time_s.first().copied().unwrap_or(0.0);
    let declared = known.drift.map_or(0.0, |[drift, _]| drift);
    // A declared drift is taken off first.
    let straight = |s: &f64| s - declared * (s - begin_s);
    let times: Vec<f64> = second.time_s.iter().map(straight).collect();
    let gaps: Vec<[f64; 2]> = second.gaps_s.iter().map(|gap| [straight(&gap[0]), straight(&gap[1])]).collect();
    let pair = Pair::of(first, &Record { time_s: &times, gaps_s: &gaps, ..*second }, known.derivative)?;
    let shifts = shifts::candidates(&pair.x, &pair.y, known.lag_s);
    let best_shift = shifts.first().ok_or(LagError::NotAlike { correlation: 0.0 })?;
    let is_free = known.drift.is_none();
    let mut fits: Vec<Fit> = shifts.iter().filter_map(|shift| pair.fit(shift.lag_s, is_free)).collect();
    fits.sort_by(|a, b| a.mean_square.total_cmp(&b.mean_square));
    let Some(mut best) = fits.first().cloned() else {
        let correlation = best_shift.correlation;
        return Err(if correlation < LEAST_CORRELATION {
            LagError::NotAlike { correlation }
        } else if is_free && pair.fit(best_shift.lag_s, false).is_some() {
            LagError::DriftOpen { lag_s: best_shift.lag_s, origin_s: pair.y.time_s[pair.y.time_s.len() / 2] }
        } else {
            LagError::Undetermined
        });
    };
    let opposite = shifts::most_opposite(&pair.x, &pair.y, known.lag_s);
    if opposite > best.correlation.max(LEAST_CORRELATION) + OPPOSITE {
        return Err(LagError::Opposite { correlation: opposite });
    }
    if best.correlation < LEAST_CORRELATION {
        return Err(LagError::NotAlike { correlation: best.correlation.max(best_shift.correlation) });
    }
    let at_begin = |fit: &Fit| fit.lag_s + fit.drift * (begin_s - fit.origin_s);
    if let Some([value, range]) = known.lag_s
        && (at_begin(&best) - value).abs() > range
    {
        return Err(LagError::AtTheEnd { lag_s: value + range * (at_begin(&best) - value).signum() });
    }
    let rows = pair.rows(&best);
    let loses = |n: f64, mean_square: f64| {
        mean_square >= CLEARLY * best.mean_square && n * (mean_square / best.mean_square).ln() >= SURE
    };
    // Two records of nothing in common have two degrees of freedom a period.
    let [from, to] = rows.ends_s;
    let alone = best.mean_square / (1.0 - best.correlation * best.correlation).max(f64::MIN_POSITIVE);
    if !loses(2.0 * (to - from) / pair.period_s, alone) {
        return Err(LagError::Undetermined);
    }
    let n = best.n as f64 / Noise::of(&rows.residuals(&best)).time;
    let apart = 0.25 * pair.period_s;
    let rival = fits.iter().find(|fit| (at_begin(fit) - at_begin(&best)).abs() > apart && !loses(n, fit.mean_square));
    if let Some(rival) = rival {
        return Err(LagError::Ambiguous { lag_s: at_begin(&best), other_s: at_begin(rival) });
    }
    let is_rounded = is_stepped(first.values) || is_stepped(second.values);
    let rounding_s = if is_rounded { first.step_s.hypot(second.step_s) / 12.0_f64.sqrt() } else { 0.0 };
    let found = covariance::of(&rows, &mut best, is_free, rounding_s).ok_or(LagError::Undetermined)?;
    let mut standard = found.standard;
    if is_rounded {
        standard = [standard[0].hypot(rounding_s), standard[1].hypot(rounding_s / found.arm_s)];
    }
    if is_free && standard[1] * 0.5 * (to - from) > LEVER * standard[0].max(0.05 * first.step_s) {
        return Err(LagError::DriftOpen { lag_s: best.lag_s, origin_s: best.origin_s });
    }
    if let Some([time_s, jump_s]) = found.jump {
        return Err(LagError::Jump { jump_s, time_s });
    }
    if found.left_s > MOST_LEFT * pair.period_s {
        return Err(LagError::NotLinear { left_s: found.left_s, period_s: pair.period_s });
    }
    if let Some([_, known]) = known.drift {
        standard[1] = known;
    }
    // Back to stamps as they are.
    let stamp_s = begin_s + (best.origin_s - begin_s) / (1.0 - declared);
    Ok(Lag {
        lag_s: stamp_s - (best.origin_s - best.lag_s),
        drift: 1.0 - (1.0 - best.drift) * (1.0 - declared),
        origin_s: stamp_s,
        standard,
        left_s: found.left_s,
        gain: best.gain,
        correlation: best.correlation,
        overlap_s: rows.ends_s,
    })
}

/// Whether a few steps change a record by a large part of its range: a motion that is sampled coarsely has many such steps.
fn is_stepped(values: &[f64]) -> bool {
    let (low, high) = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    let large = values.windows(2).filter(|w| (w[1] - w[0]).abs() > STEPPED.0 * (high - low)).count();
    large > 0 && STEPPED.1 * large < values.len()
}

/// Two records under one window.
struct Pair {
    x: Smooth,
    y: Smooth,
    spline: Spline<'static>,
    /// Mean period of what they show, s.
    period_s: f64,
}

/// A shift that was refined.
#[derive(Debug, Clone)]
pub(crate) struct Fit {
    lag_s: f64,
    drift: f64,
    origin_s: f64,
    offset: f64,
    gain: f64,
    mean_square: f64,
    correlation: f64,
    n: usize,
}

/// What is compared at one shift: of each value of y that x was seen at, its stamp, itself, and x with two derivatives at that time.
pub(crate) struct Rows {
    /// `None` where x or y was not seen.
    values: Vec<Option<[f64; 5]>>,
    /// First and last time that both were, s of the first clock.
    ends_s: [f64; 2],
}

impl Pair {
    fn of(first: &Record<'_>, second: &Record<'_>, derivative: i32) -> Result<Self, LagError> {
        let length = |r: &Record<'_>| r.time_s.last().unwrap_or(&0.0) - r.time_s.first().unwrap_or(&0.0);
        let step_s = first.step_s.max(second.step_s).max(length(first).max(length(second)) / MOST_VALUES);
        let seen = |r: &Record<'_>, width_s: f64, d: i32| {
            smooth(r.time_s, r.values, r.step_s, r.gaps_s, [width_s, step_s], d.max(0) as usize)
        };
        // Derivatives are the noisier ones.
        let period_s = match derivative {
            0 => mean_period_s(&seen(first, step_s, 0)?).max(mean_period_s(&seen(second, step_s, 0)?)),
            1.. => mean_period_s(&seen(first, step_s, 0)?),
            _ => mean_period_s(&seen(second, step_s, 0)?),
        };
        // Noise of a record that is differentiated is kept small by a window of a part of the motion's period, and of the record: a ramp of position has a long one.
        let shortest_s = length(first).min(length(second));
        let width_s =
            if derivative == 0 { step_s } else { step_s.max((period_s / 12.0).min(shortest_s / SHORTEST_WINDOWS)) };
        let (x, y) = (seen(first, width_s, derivative)?, seen(second, width_s, -derivative)?);
        // The period of the motion is that of what is compared.
        let period_s = mean_period_s(&x).max(mean_period_s(&y)).max(4.0 * step_s);
        let spline = Spline::through(x.time_s.clone(), x.values.clone())?;
        Ok(Self { x, y, spline, period_s })
    }

    fn rows(&self, fit: &Fit) -> Rows {
        let (mut ends_s, start) = ([f64::INFINITY, f64::NEG_INFINITY], self.x.time_s[0]);
        let at = |k: usize| {
            let s = self.y.time_s[k];
            let t = s - fit.lag_s - fit.drift * (s - fit.origin_s);
            let i = ((t - start) / self.x.step_s).max(0.0) as usize;
            let is_seen = |i: usize| self.x.is_whole.get(i).copied().unwrap_or(false);
            let [x, rate, second] = self.spline.with_derivatives_at(t)?;
            if !(self.y.is_whole[k] && is_seen(i) && is_seen((i + 1).min(self.x.is_whole.len() - 1))) {
                return None;
            }
            ends_s = [ends_s[0].min(t), ends_s[1].max(t)];
            Some([s, self.y.values[k], x, rate, second])
        };
        Rows { values: (0..self.y.time_s.len()).map(at).collect(), ends_s }
    }

    /// Gauss and Newton from a lag on; `None` where the records do not determine what is free.
    fn fit(&self, lag_s: f64, is_free: bool) -> Option<Fit> {
        let origin_s = 0.5 * (self.y.time_s.first()? + self.y.time_s.last()?);
        let start =
            Fit { lag_s, drift: 0.0, origin_s, offset: 0.0, gain: 1.0, mean_square: 0.0, correlation: 0.0, n: 0 };
        let mut fit = self.linear(start)?;
        for _ in 0..STEPS.0 {
            let rows = self.rows(&fit);
            let columns = 3 + usize::from(is_free);
            let (mut gram, mut right) = (Mat::<f64>::zeros(columns, columns), Mat::<f64>::zeros(columns, 1));
            for row in rows.values.iter().flatten() {
                let z = fit.columns(row);
                for i in 0..columns {
                    (0..columns).for_each(|j| gram[(i, j)] += z[i] * z[j]);
                    right[(i, 0)] += z[i] * fit.residual(row);
                }
            }
            let step = solved(&gram, &right)?;
            // A step beyond a part of the period leaves the hill of this shift.
            let (most_s, half_s) = (0.1 * self.period_s, 0.5 * (rows.ends_s[1] - rows.ends_s[0]).max(self.y.step_s));
            let drift = if is_free { step[(3, 0)] } else { 0.0 };
            let mut part = (most_s / step[(2, 0)].abs().max(drift.abs() * half_s)).min(1.0);
            let moved = |part: f64| Fit {
                lag_s: fit.lag_s + part * step[(2, 0)],
                drift: (fit.drift + part * drift).clamp(-MOST_DRIFT, MOST_DRIFT),
                ..fit.clone()
            };
            let mut next = self.linear(moved(part))?;
            while next.mean_square > fit.mean_square && part > 1e-3 {
                part *= 0.5;
                next = self.linear(moved(part))?;
            }
            if next.mean_square > fit.mean_square {
                break;
            }
            let change = (next.lag_s - fit.lag_s).abs() + (next.drift - fit.drift).abs() * half_s;
            fit = next;
            if change < STEPS.1 * self.y.step_s {
                break;
            }
        }
        (fit.drift.abs() < MOST_DRIFT).then_some(fit)
    }

    /// The same shift with offset and gain by least squares; `None` of fewer than twenty values, or of a record that does not change.
    fn linear(&self, fit: Fit) -> Option<Fit> {
        let rows = self.rows(&fit);
        let n = rows.values.iter().flatten().count();
        if n < shifts::FEWEST {
            return None;
        }
        let mean = |of: usize| rows.values.iter().flatten().map(|row| row[of]).sum::<f64>() / n as f64;
        let (x, y) = (mean(2), mean(1));
        let [xx, xy, yy] = rows.values.iter().flatten().fold([0.0; 3], |[xx, xy, yy], row| {
            let (dx, dy) = (row[2] - x, row[1] - y);
            [xx + dx * dx, xy + dx * dy, yy + dy * dy]
        });
        let gain = xy / xx;
        let correlation = xy / (xx * yy).sqrt();
        let fit = Fit { offset: y - gain * x, gain, correlation, n, ..fit };
        let squares: f64 = rows.values.iter().flatten().map(|row| fit.residual(row).powi(2)).sum();
        // Per variance of y: shifts see other parts of it.
        correlation.is_finite().then_some(Fit { mean_square: squares / yy, ..fit })
    }
}

impl Fit {
    fn residual(&self, [_, y, x, ..]: &[f64; 5]) -> f64 {
        y - self.offset - self.gain * x
    }

    /// ∂(a + b x)/∂(a, b, lag, drift).
    fn columns(&self, [s, _, x, rate, _]: &[f64; 5]) -> [f64; 4] {
        let slope = -self.gain * rate;
        [1.0, *x, slope, slope * (s - self.origin_s)]
    }
}

impl Rows {
    fn residuals(&self, fit: &Fit) -> Vec<f64> {
        self.values.iter().map(|row| row.as_ref().map_or(0.0, |row| fit.residual(row))).collect()
    }
}

/// Rice's period of a record, 2π σ/σ', from the values that are whole.
fn mean_period_s(record: &Smooth) -> f64 {
    let whole: Vec<f64> = record.values.iter().zip(&record.is_whole).filter(|(_, w)| **w).map(|(x, _)| *x).collect();
    let mean = whole.iter().sum::<f64>() / whole.len().max(1) as f64;
    let power: f64 = whole.iter().map(|x| (x - mean).powi(2)).sum();
    let slopes: f64 = whole.windows(2).map(|w| ((w[1] - w[0]) / record.step_s).powi(2)).sum();
    if slopes > 0.0 { std::f64::consts::TAU * (power / slopes).sqrt() } else { f64::INFINITY }
}

/// The solution of symmetric equations, their unknowns scaled to be alike; `None` where they are singular.
pub(crate) fn solved(gram: &Mat<f64>, right: &Mat<f64>) -> Option<Mat<f64>> {
    let n = gram.nrows();
    let scale: Vec<f64> = (0..n).map(|i| gram[(i, i)].abs().sqrt()).collect();
    if scale.iter().any(|s| !(s.is_finite() && *s > 0.0)) {
        return None;
    }
    let alike = Mat::from_fn(n, n, |i, j| gram[(i, j)] / (scale[i] * scale[j]));
    let factor = alike.llt(faer::Side::Lower).ok()?;
    // Rounding alone makes a singular matrix positive.
    (0..n).all(|i| factor.L()[(i, i)] > 1e-5).then_some(())?;
    let part = factor.solve(Mat::from_fn(n, right.ncols(), |i, j| right[(i, j)] / scale[i]));
    Some(Mat::from_fn(n, right.ncols(), |i, j| part[(i, j)] / scale[i]))
}
