//! Harmonic fits: a record as mean and harmonics of one frequency, which is fitted too.
//!
//! x(t) = m + Σₖ cₖ cos kω(t − t₀) + sₖ sin kω(t − t₀), k = 1 … K, by least squares over m, cₖ, sₖ and ω (Gauss and Newton), with t₀ the middle of
//! the record, where the frequency is least correlated with the phases. Whole and broken periods alike; samples need not be even.
//!
//! **Units.** Time in s, ω in rad/s, the record in any unit.
//! **Range.** A record of one period and more; below two periods mean and frequency are correlated.
//!
//! # Source
//!
//! IEEE Std 1057-2017, 4.7.3 (four-parameter sine fit), with harmonics. Start: the largest line of the discrete spectrum.

use std::borrow::Cow;

use faer::Mat;
use faer::prelude::*;

use crate::error::{SignalError, all_finite, in_range};
use crate::spectrum::transform;

/// Most harmonics.
const MOST_HARMONICS: usize = 50;
/// Steps of Gauss and Newton; where little is left of the record they converge quadratically.
const MOST_STEPS: usize = 60;
/// A step of ω below this part of the spectral line's width ends the iteration.
const SMALL: f64 = 1e-12;
/// A search that still moves by this part of it has not found a period.
const CONVERGED: f64 = 1e-6;
/// Samples per unknown below which nothing is left to judge the fit by.
const SAMPLES_PER_UNKNOWN: usize = 2;

/// A fitted periodic record.
#[derive(Debug, Clone, PartialEq)]
pub struct Harmonics {
    /// ω, rad/s.
    pub omega_rad_s: f64,
    /// t₀: the time that phases count from, s.
    pub origin_s: f64,
    /// m.
    pub mean: f64,
    /// `[cₖ, sₖ]` of the harmonics 1 … K.
    pub terms: Vec<[f64; 2]>,
    /// Standard deviation of a sample about the fit, degrees of freedom counted.
    pub residual_std: f64,
    /// Samples.
    pub samples: usize,
    /// Covariance of m, c₁, s₁, …, ω for residuals that are independent.
    pub covariance: Vec<Vec<f64>>,
}

impl Harmonics {
    /// Fits a record with `order` harmonics.
    ///
    /// `start_rad_s` is a first guess of ω, good to half a spectral line (π over the length of the record); `None` looks for the largest line.
    ///
    /// # Errors
    ///
    /// [`SignalError::Length`], [`SignalError::NotFinite`], [`SignalError::OutOfRange`] for `order`, [`SignalError::TooShort`] for too few samples,
    /// [`SignalError::NoPeriod`] where the record has less than one period, or none is found.
    pub fn fit(time_s: &[f64], record: &[f64], order: usize, start_rad_s: Option<f64>) -> Result<Self, SignalError> {
        let (origin_s, length_s) = checked(time_s, record, order)?;
        let line = std::f64::consts::TAU / length_s;
        let mut omega = start_rad_s.unwrap_or_else(|| line * largest_line(time_s, record));
        let mut linear = Linear::solve(time_s, record, order, omega, origin_s, None)?;
        let mut step = f64::INFINITY;
        for _ in 0..MOST_STEPS {
            linear = Linear::solve(time_s, record, order, omega, origin_s, Some(&linear.terms))?;
            // A step beyond the line that was started from leaves the valley.
            step = linear.step_of_frequency.clamp(-0.25 * line, 0.25 * line);
            if step.abs() <= SMALL * line {
                break;
            }
            omega += step;
        }
        let periods = omega * length_s / std::f64::consts::TAU;
        if !(periods >= 0.9 && step.abs() <= CONVERGED * line) {
            return Err(SignalError::NoPeriod { length_s, periods });
        }
        Ok(Self::of(&linear, 2 * order + 2, omega, origin_s, linear.squares, record.len()))
    }

    /// Fits a record with `order` harmonics of a frequency that is known.
    ///
    /// # Errors
    ///
    /// As [`Harmonics::fit`].
    pub fn held(time_s: &[f64], record: &[f64], order: usize, omega_rad_s: f64) -> Result<Self, SignalError> {
        let (origin_s, _) = checked(time_s, record, order)?;
        let linear = Linear::solve(time_s, record, order, omega_rad_s, origin_s, None)?;
        let unknowns = 2 * order + 1;
        let squares = residual_squares(time_s, record, omega_rad_s, origin_s, linear.mean, &linear.terms);
        Ok(Self::of(&linear, unknowns, omega_rad_s, origin_s, squares, record.len()))
    }

    fn of(linear: &Linear, unknowns: usize, omega_rad_s: f64, origin_s: f64, squares: f64, samples: usize) -> Self {
        let variance = squares / (samples - unknowns) as f64;
        let covariance = (0..unknowns).map(|i| (0..unknowns).map(|j| variance * linear.inverse[(i, j)]).collect());
        Self {
            omega_rad_s,
            origin_s,
            mean: linear.mean,
            terms: linear.terms.clone(),
            residual_std: variance.sqrt(),
            samples,
            covariance: covariance.collect(),
        }
    }

    /// Value and its first three derivatives at a time, in the record's unit over s⁰ … s³.
    #[must_use]
    pub fn at(&self, time_s: f64) -> [f64; 4] {
        let phase = self.omega_rad_s * (time_s - self.origin_s);
        let mut out = [self.mean, 0.0, 0.0, 0.0];
        for (k, [c, s]) in self.terms.iter().enumerate() {
            let k = (k + 1) as f64;
            let (sin, cos) = (k * phase).sin_cos();
            let w = k * self.omega_rad_s;
            let (even, odd) = (c * cos + s * sin, s * cos - c * sin);
            out[0] += even;
            out[1] += w * odd;
            out[2] -= w * w * even;
            out[3] -= w * w * w * odd;
        }
        out
    }

    /// Amplitude of harmonic `k`, from 1.
    #[must_use]
    pub fn amplitude(&self, k: usize) -> f64 {
        let [c, s] = self.terms[k - 1];
        c.hypot(s)
    }

    /// Phase of harmonic `k` as a cosine, `cos(kω(t − t₀) − phase)`, rad in (−π, π].
    #[must_use]
    pub fn phase_rad(&self, k: usize) -> f64 {
        let [c, s] = self.terms[k - 1];
        s.atan2(c)
    }

    /// Standard uncertainties of amplitude and phase (rad) of harmonic `k`, for residuals that are independent.
    #[must_use]
    pub fn standard_of(&self, k: usize) -> [f64; 2] {
        let [c, s] = self.terms[k - 1];
        let size = self.amplitude(k);
        let (i, j) = (2 * k - 1, 2 * k);
        let [cc, cs, ss] = [self.covariance[i][i], self.covariance[i][j], self.covariance[j][j]];
        let along = (c * c * cc + 2.0 * c * s * cs + s * s * ss) / (size * size);
        let across = (s * s * cc - 2.0 * c * s * cs + c * c * ss) / (size * size);
        [along.max(0.0).sqrt(), across.max(0.0).sqrt() / size]
    }

    /// Standard uncertainty of ω, rad/s, likewise.
    #[must_use]
    pub fn standard_of_frequency_rad_s(&self) -> f64 {
        self.covariance.last().and_then(|row| row.last()).copied().unwrap_or(f64::NAN).max(0.0).sqrt()
    }

    /// Period, s.
    #[must_use]
    pub fn period_s(&self) -> f64 {
        std::f64::consts::TAU / self.omega_rad_s
    }
}

/// Middle and length of a record that can be fitted, s.
fn checked(time_s: &[f64], record: &[f64], order: usize) -> Result<(f64, f64), SignalError> {
    in_range("harmonics", order, 1, MOST_HARMONICS)?;
    if time_s.len() != record.len() {
        return Err(SignalError::Length { what: "the record", found: record.len(), expected: time_s.len() });
    }
    all_finite(time_s)?;
    all_finite(record)?;
    let needed = SAMPLES_PER_UNKNOWN * (2 * order + 2);
    if record.len() <= needed {
        return Err(SignalError::TooShort { what: "the harmonic fit", needed, found: record.len() });
    }
    let (first, last) = (time_s[0], time_s[time_s.len() - 1]);
    Ok((0.5 * (first + last), last - first))
}

/// The linear problem at one frequency: mean, harmonics, and the step of ω.
struct Linear {
    mean: f64,
    terms: Vec<[f64; 2]>,
    step_of_frequency: f64,
    squares: f64,
    inverse: Mat<f64>,
}

impl Linear {
    /// Without `terms`, ω is held: its column needs harmonics to stand for.
    fn solve(
        time_s: &[f64],
        record: &[f64],
        order: usize,
        omega: f64,
        origin_s: f64,
        terms: Option<&[[f64; 2]]>,
    ) -> Result<Self, SignalError> {
        let unknowns = 2 * order + 1 + usize::from(terms.is_some());
        let mut gram = Mat::<f64>::zeros(unknowns, unknowns);
        let (mut right, mut power) = (Mat::<f64>::zeros(unknowns, 1), 0.0);
        let mut row = vec![1.0; unknowns];
        // About the first sample, so that a large mean costs no digits.
        let shift = record[0];
        for (t, x) in time_s.iter().zip(record) {
            let t = t - origin_s;
            let x = x - shift;
            let mut slope = 0.0;
            for k in 0..order {
                let multiple = (k + 1) as f64;
                let (sin, cos) = (multiple * omega * t).sin_cos();
                (row[2 * k + 1], row[2 * k + 2]) = (cos, sin);
                if let Some([c, s]) = terms.map(|terms| terms[k]) {
                    slope += multiple * t * (s * cos - c * sin);
                }
            }
            if terms.is_some() {
                row[unknowns - 1] = slope;
            }
            for i in 0..unknowns {
                for j in 0..=i {
                    gram[(i, j)] += row[i] * row[j];
                }
                right[(i, 0)] += row[i] * x;
            }
            power += x * x;
        }
        // Columns of unit length, so that the length of the record does not decide what is singular.
        let scale: Vec<f64> = (0..unknowns).map(|i| gram[(i, i)].sqrt().max(f64::MIN_POSITIVE)).collect();
        let scaled = Mat::from_fn(unknowns, unknowns, |i, j| gram[(i.max(j), i.min(j))] / (scale[i] * scale[j]));
        let no_period = || SignalError::NoPeriod {
            length_s: time_s[time_s.len() - 1] - time_s[0],
            periods: omega * (time_s[time_s.len() - 1] - time_s[0]) / std::f64::consts::TAU,
        };
        let factor = scaled.llt(faer::Side::Lower).map_err(|_| no_period())?;
        let solved = factor.solve(Mat::from_fn(unknowns, 1, |i, _| right[(i, 0)] / scale[i]));
        let identity = factor.solve(Mat::<f64>::identity(unknowns, unknowns));
        let value = |i: usize| solved[(i, 0)] / scale[i];
        let fitted: f64 = (0..unknowns).map(|i| value(i) * right[(i, 0)]).sum();
        let squares = if terms.is_some() {
            // From the residuals themselves: the difference of two large sums would lose a small one.
            let linear: Vec<[f64; 2]> = (0..order).map(|k| [value(2 * k + 1), value(2 * k + 2)]).collect();
            residual_squares(time_s, record, omega, origin_s, value(0) + shift, &linear)
        } else {
            (power - fitted).max(0.0)
        };
        Ok(Self {
            mean: value(0) + shift,
            terms: (0..order).map(|k| [value(2 * k + 1), value(2 * k + 2)]).collect(),
            step_of_frequency: if terms.is_some() { value(unknowns - 1) } else { 0.0 },
            squares,
            inverse: Mat::from_fn(unknowns, unknowns, |i, j| identity[(i, j)] / (scale[i] * scale[j])),
        })
    }
}

fn residual_squares(time_s: &[f64], record: &[f64], omega: f64, origin_s: f64, mean: f64, terms: &[[f64; 2]]) -> f64 {
    let left = |t: &f64, x: &f64| {
        let phase = omega * (t - origin_s);
        let fitted = terms.iter().enumerate().fold(mean, |sum, (k, [c, s])| {
            let (sin, cos) = ((k + 1) as f64 * phase).sin_cos();
            sum + c * cos + s * sin
        });
        x - fitted
    };
    time_s.iter().zip(record).map(|(t, x)| left(t, x).powi(2)).sum()
}

/// Steps that differ less than this from their mean, relative to it, are even for a spectrum.
const EVEN: f64 = 0.1;

/// The record at as many even times, by straight lines; as it is where its samples are even.
fn at_even_times<'a>(time_s: &[f64], record: &'a [f64]) -> Cow<'a, [f64]> {
    let last = record.len() - 1;
    let step_s = (time_s[last] - time_s[0]) / last as f64;
    if time_s.windows(2).all(|w| (w[1] - w[0] - step_s).abs() <= EVEN * step_s) {
        return Cow::Borrowed(record);
    }
    let at = |i: usize| {
        let t = time_s[0] + i as f64 * step_s;
        let after = time_s.partition_point(|s| *s <= t).clamp(1, last);
        let part = (t - time_s[after - 1]) / (time_s[after] - time_s[after - 1]);
        record[after - 1] + part.clamp(0.0, 1.0) * (record[after] - record[after - 1])
    };
    (0..record.len()).map(at).collect()
}

/// Periods in the record, by the largest line of its spectrum; four points a line.
fn largest_line(time_s: &[f64], record: &[f64]) -> f64 {
    let record = at_even_times(time_s, record);
    let mean = record.iter().sum::<f64>() / record.len() as f64;
    let size = (4 * record.len()).next_power_of_two();
    let mut data: Vec<[f64; 2]> = record.iter().map(|x| [x - mean, 0.0]).collect();
    data.resize(size, [0.0; 2]);
    transform(&mut data);
    let power = |k: usize| data[k][0].powi(2) + data[k][1].powi(2);
    // Below half a line there is the mean.
    let first = size.div_ceil(2 * record.len()).max(1);
    let best = (first..size / 2).max_by(|&a, &b| power(a).total_cmp(&power(b))).unwrap_or(first);
    best as f64 * (record.len() - 1) as f64 / size as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use rand::{RngExt, SeedableRng};

    fn times(n: usize, rate_hz: f64) -> Vec<f64> {
        (0..n).map(|i| 3.0 + i as f64 / rate_hz).collect()
    }

    proptest! {
        /// What was put in comes out, over whole and broken periods.
        #[test]
        fn a_record_of_harmonics_is_found_exactly(
            omega in 0.8_f64..20.0, periods in 2.0_f64..12.0, c in -2.0_f64..2.0, s in 0.5_f64..2.0, third in -0.2_f64..0.2, mean in -5.0_f64..5.0
        ) {
            let n = 800;
            let rate = n as f64 * omega / (std::f64::consts::TAU * periods);
            let t = times(n, rate);
            let x: Vec<f64> = t
                .iter()
                .map(|t| mean + c * (omega * t).cos() + s * (omega * t).sin() + third * (3.0 * omega * t).sin())
                .collect();
            let fit = Harmonics::fit(&t, &x, 3, None).unwrap();
            // Rounding: 800 terms of some 1e-16 against a condition below 100 from two periods on.
            prop_assert!((fit.omega_rad_s / omega - 1.0).abs() < 1e-10);
            prop_assert!((fit.amplitude(1) - c.hypot(s)).abs() < 1e-9 && (fit.amplitude(3) - third.abs()).abs() < 1e-9);
            for &i in &[0, 399, 799] {
                let [value, rate, second, jerk] = fit.at(t[i]);
                let (sin, cos) = (omega * t[i]).sin_cos();
                let (sin3, cos3) = (3.0 * omega * t[i]).sin_cos();
                prop_assert!((value - x[i]).abs() < 1e-9);
                prop_assert!((rate - omega * (s * cos - c * sin + 3.0 * third * cos3)).abs() < 1e-8 * omega);
                prop_assert!((second + omega * omega * (c * cos + s * sin + 9.0 * third * sin3)).abs() < 1e-8 * omega.powi(2));
                prop_assert!((jerk + omega.powi(3) * (s * cos - c * sin + 27.0 * third * cos3)).abs() < 1e-7 * omega.powi(3));
            }
        }
    }

    /// A fifth of the record is missing, and a twentieth of the rest: the period is found as before.
    #[test]
    fn a_record_with_a_gap_has_the_same_harmonics() {
        let (omega, n) = (1.7, 2400);
        let t: Vec<f64> = times(n, 100.0);
        let keep = |i: &usize| !(1000..1480).contains(i) && i % 20 != 7;
        let t: Vec<f64> = (0..n).filter(keep).map(|i| t[i]).collect();
        let x: Vec<f64> = t.iter().map(|t| 0.3 + 2.0 * (omega * t).cos() + 0.1 * (3.0 * omega * t).sin()).collect();
        let fit = Harmonics::fit(&t, &x, 3, None).unwrap();
        assert!((fit.omega_rad_s / omega - 1.0).abs() < 1e-10 && (fit.amplitude(1) - 2.0).abs() < 1e-9);
    }

    /// Rife & Boorstyn (1974): variance 2σ²/n of an amplitude, 2σ²/(A²n) of the phase in the middle, 24σ²/(A²n T²) of ω.
    #[test]
    fn the_uncertainties_are_those_of_the_closed_form_and_of_repeats() {
        let (n, rate, omega, sigma) = (1_000, 50.0, std::f64::consts::TAU * 0.5, 0.1);
        let t = times(n, rate);
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(11);
        // Uniform noise of the same standard deviation.
        let mut noise = || sigma * 12.0_f64.sqrt() * (rng.random::<f64>() - 0.5);
        let mut found = Vec::new();
        let mut stated = [0.0; 3];
        for _ in 0..400 {
            let x: Vec<f64> = t.iter().map(|t| 2.0 * (omega * t).sin() + noise()).collect();
            let fit = Harmonics::fit(&t, &x, 1, None).unwrap();
            let [amplitude, phase] = fit.standard_of(1);
            stated = [amplitude, phase, fit.standard_of_frequency_rad_s()];
            found.push([fit.amplitude(1), fit.phase_rad(1), fit.omega_rad_s]);
        }
        let length_s = n as f64 / rate;
        let closed = [
            (2.0 / n as f64).sqrt() * sigma,
            (2.0 / n as f64).sqrt() * sigma / 2.0,
            (24.0 / n as f64).sqrt() * sigma / (2.0 * length_s),
        ];
        for j in 0..3 {
            let mean = found.iter().map(|f| f[j]).sum::<f64>() / 400.0;
            let scatter = (found.iter().map(|f| (f[j] - mean).powi(2)).sum::<f64>() / 399.0).sqrt();
            // The last fit's σ scatters by 2.2 %, the closed form leaves out terms of one part in thirty (ten periods).
            assert!((stated[j] / closed[j] - 1.0).abs() < 0.1, "{j}: {} {}", stated[j], closed[j]);
            // Standard error of a standard deviation from 400 repeats: 3.5 %; four of them, and the above.
            assert!((scatter / closed[j] - 1.0).abs() < 0.17, "{j}: {scatter} {}", closed[j]);
        }
    }

    #[test]
    fn what_has_no_period_is_refused() {
        let t = times(200, 10.0);
        let line: Vec<f64> = t.iter().map(|t| 0.1 * t).collect();
        assert!(matches!(Harmonics::fit(&t, &line, 1, None), Err(SignalError::NoPeriod { .. })), "a line");
        assert!(Harmonics::fit(&t, &vec![1.0; 200], 1, None).is_err(), "a constant");
        assert!(matches!(Harmonics::fit(&t[..7], &line[..7], 2, None), Err(SignalError::TooShort { .. })));
    }
}
