//! A quartic through the samples about an instant: turning points and passages that noise does not push outwards.
//!
//! The largest of noisy samples lies outside the true peak by some standard deviations of the noise. A quartic over
//! ± 1 rad of phase averages the noise instead: its value at the middle has the variance 225/64 σ²/n, its slope 75/4 σ²/n (in
//! half-widths). The top of the fitted curve is still above the true one, by half the variance of the slope over the
//! curvature; that is subtracted. What a sine keeps beyond the fourth power moves a peak by 3e-5 of its height.

use froude_fit::faer::linalg::solvers::Solve;
use froude_fit::faer::{Mat, Side};

/// Half-width of the fit, rad of phase.
pub const REACH_RAD: f64 = 1.0;
/// Fewest samples that a quartic is put through.
pub const FEWEST: usize = 7;

/// A quartic in x = (t − centre)/half-width.
#[derive(Debug, Clone, Copy)]
pub struct Quartic {
    centre_s: f64,
    half_s: f64,
    c: [f64; 5],
    /// Variance of value and slope at the middle, for noise of one.
    value_variance: f64,
    slope_variance: f64,
}

/// An instant with a position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spot {
    /// Time, s.
    pub time_s: f64,
    /// Position there, m or rad.
    pub position: f64,
    /// Slope there, m/s or rad/s.
    pub slope: f64,
    /// Variance of the position for noise of one.
    pub variance: f64,
}

impl Quartic {
    /// Least squares over the samples within `half_s` of `centre_s`; `None` where there are too few or the window leaves the record.
    pub fn about(time_s: &[f64], position: &[f64], centre_s: f64, half_s: f64) -> Option<Self> {
        let step_s = (time_s.last()? - time_s.first()?) / (time_s.len().checked_sub(1)?.max(1)) as f64;
        let first = time_s.partition_point(|t| *t < centre_s - half_s);
        let end = time_s.partition_point(|t| *t <= centre_s + half_s);
        let leaves =
            centre_s - half_s < time_s[0] - 0.5 * step_s || centre_s + half_s > time_s[time_s.len() - 1] + 0.5 * step_s;
        if leaves || end < first + FEWEST {
            return None;
        }
        let x = Mat::from_fn(end - first, 5, |i, k| ((time_s[first + i] - centre_s) / half_s).powi(k as i32));
        // The moments of the position, and two unit vectors: they give the variances of value and slope at the middle.
        let right = Mat::from_fn(5, 3, |k, j| match j {
            0 => (first..end).map(|i| x[(i - first, k)] * position[i]).sum(),
            _ => f64::from(u8::from(k + 1 == j)),
        });
        let solved = (x.transpose() * &x).llt(Side::Lower).ok()?.solve(right);
        let c = std::array::from_fn(|k| solved[(k, 0)]);
        Some(Self { centre_s, half_s, c, value_variance: solved[(0, 1)], slope_variance: solved[(1, 2)] })
    }

    fn at(&self, x: f64) -> [f64; 3] {
        let [a, b, c, d, e] = self.c;
        [
            a + x * (b + x * (c + x * (d + x * e))),
            b + x * (2.0 * c + x * (3.0 * d + x * 4.0 * e)),
            2.0 * c + x * (6.0 * d + x * 12.0 * e),
        ]
    }

    fn spot(&self, x: f64) -> Spot {
        let [position, slope, _] = self.at(x);
        Spot {
            time_s: self.centre_s + self.half_s * x,
            position,
            slope: slope / self.half_s,
            variance: self.value_variance,
        }
    }

    /// Position and slope at a time.
    pub fn value_and_slope(&self, time_s: f64) -> [f64; 2] {
        let [value, slope, _] = self.at((time_s - self.centre_s) / self.half_s);
        [value, slope / self.half_s]
    }

    /// Newton's way from the middle to where `f` = at[k] − level is zero; `None` where that is outside the window.
    fn root(&self, k: usize, level: f64) -> Option<f64> {
        let mut x = 0.0;
        for _ in 0..20 {
            let at = self.at(x);
            let step = (at[k] - level) / at[k + 1];
            x -= step;
            if x.is_nan() || x.abs() > 1.0 {
                return None;
            }
            if step.abs() < 1e-13 {
                break;
            }
        }
        Some(x)
    }

    /// The turning point, with the noise's bias subtracted; `noise` is the standard deviation of a sample.
    fn turn(&self, noise: f64) -> Option<Spot> {
        let x = self.root(1, 0.0)?;
        let [_, _, curvature] = self.at(x);
        let spot = self.spot(x);
        Some(Spot { position: spot.position + 0.5 * noise * noise * self.slope_variance / curvature, ..spot })
    }
}

/// The turning point near a guess; fitted twice, the second time about itself.
pub fn turn(time_s: &[f64], position: &[f64], guess_s: f64, half_s: f64, noise: f64) -> Option<Spot> {
    let once = Quartic::about(time_s, position, guess_s, half_s)?.turn(noise)?;
    Quartic::about(time_s, position, once.time_s, half_s)?.turn(noise)
}

/// The passage through `level` near a guess; fitted twice.
pub fn passage(time_s: &[f64], position: &[f64], guess_s: f64, half_s: f64, level: f64) -> Option<Spot> {
    let of = |q: Quartic| q.root(0, level).map(|x| q.spot(x));
    let once = of(Quartic::about(time_s, position, guess_s, half_s)?)?;
    of(Quartic::about(time_s, position, once.time_s, half_s)?)
}

/// Standard deviation of the noise of a sample, from fourth differences: a sine of 20 samples a cycle leaves 1 % of its
/// amplitude in them, one of 100 samples 2e-5. Steps need not be even: the differences are divided ones, scaled so that white noise leaves in each what it leaves at even steps.
pub fn noise_of(time_s: &[f64], position: &[f64]) -> f64 {
    let n = position.len().min(time_s.len()).saturating_sub(4);
    if n == 0 {
        return 0.0;
    }
    let square = |(t, x): (&[f64], &[f64])| {
        let weights: [f64; 5] = std::array::from_fn(|j| {
            let others = (0..5).filter(|k| *k != j);
            others.map(|k| (t[j] - t[k]) / (t[4] - t[0])).product::<f64>().recip()
        });
        let (sum, squares) =
            weights.iter().zip(x).fold((0.0, 0.0), |(sum, squares), (w, x)| (sum + w * x, squares + w * w));
        sum * sum / squares
    };
    (time_s.windows(5).zip(position.windows(5)).map(square).sum::<f64>() / n as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    /// 50 samples in ± 1 rad, noise σ of 5 % of the amplitude: the largest sample lies more than 5 % out. The slope's noise, of variance
    /// σ² 75/4/50, pushes the quartic's top out by half of that over the curvature 1, and that is subtracted; what the choice of the window about the
    /// first top adds stays. The samples' number and the sine's shape change the push by some per cent.
    #[test]
    fn noise_pushes_the_largest_sample_outwards_and_less_the_fitted_turn() {
        let mut rng = Pcg64::seed_from_u64(3);
        let time_s: Vec<f64> = (0..121).map(|i| f64::from(i - 60) / 25.0).collect();
        let (mut largest, mut fitted, mut as_it_is) = (0.0, 0.0, 0.0);
        for _ in 0..10_000 {
            let mut noise =
                || -> f64 { 0.05 * <StandardNormal as Distribution<f64>>::sample(&StandardNormal, &mut rng) };
            let q: Vec<f64> = time_s.iter().map(|t| t.cos() + noise()).collect();
            let top = |noise| turn(&time_s, &q, 0.1, REACH_RAD, noise).unwrap().position - 1.0;
            largest += (q.iter().fold(f64::MIN, |m, x| m.max(*x)) - 1.0) / 10_000.0;
            fitted += top(0.05) / 10_000.0;
            as_it_is += top(0.0) / 10_000.0;
        }
        assert!(largest > 0.05, "{largest}");
        let push = 0.5 * 0.05 * 0.05 * 75.0 / 4.0 / 50.0;
        assert!(((as_it_is - fitted) / push - 1.0).abs() < 0.1, "{as_it_is} {fitted} {push}");
        assert!(fitted.abs() < as_it_is.abs(), "{as_it_is} {fitted}");
    }

    #[test]
    fn the_noise_of_a_slow_sine_is_that_of_its_sensor() {
        let mut rng = Pcg64::seed_from_u64(4);
        let q: Vec<f64> = (0..5000)
            .map(|i| {
                let z: f64 = StandardNormal.sample(&mut rng);
                (f64::from(i) * 0.05).sin() + 1e-3 * z
            })
            .collect();
        // Fourth differences are correlated over four lags; the variance of a variance from them is about 3.9 times 2/n.
        let within = 4.0 * (0.5 * 3.9 / 5000.0_f64).sqrt();
        let time_s: Vec<f64> = (0..5000).map(f64::from).collect();
        assert!((noise_of(&time_s, &q) / 1e-3 - 1.0).abs() < within);
        // Every twentieth sample is missing: what a sine leaves grows with the fourth power of the step.
        let of = |x: &[f64]| x.iter().enumerate().filter(|(i, _)| i % 20 != 7).map(|(_, x)| *x).collect::<Vec<f64>>();
        assert!((noise_of(&of(&time_s), &of(&q)) / 1e-3 - 1.0).abs() < 1.1 * within);
    }

    #[test]
    fn a_passage_is_where_the_sine_passes() {
        let time_s: Vec<f64> = (0..200).map(|i| 0.05 * f64::from(i)).collect();
        let q: Vec<f64> = time_s.iter().map(|t| 2.0 + (t - 5.013).sin()).collect();
        let spot = passage(&time_s, &q, 5.2, REACH_RAD, 2.0).unwrap();
        // A sine's fifth power is odd; what a window of samples off its middle makes of it is 1/120 · 0.05 · 1/15 = 3e-5 rad.
        assert!((spot.time_s - 5.013).abs() < 3e-5 && (spot.slope - 1.0).abs() < 3e-3, "{spot:?}");
    }
}
