//! How well lag and drift are known: noise that is correlated, clocks that do not run evenly.

use faer::Mat;

use super::{Fit, JUMP, Rows, WINDOWS, solved};

/// Correlation times of the noise that its autocovariance is summed over, and those after which its time is known (Sokal's window).
const TIMES: (f64, f64) = (10.0, 5.0);
/// Standard deviations of χ² beyond which the clocks wander.
const CHANCE: f64 = 5.0;
/// Most products that a covariance takes.
const MOST_PRODUCTS: usize = 100_000_000;

/// The autocovariance of residuals, under Bartlett's window.
pub(crate) struct Noise {
    gamma: Vec<f64>,
    /// Integrated correlation time, in rows, one at least.
    pub time: f64,
}

impl Noise {
    /// Of residuals that are 0 where there are none.
    pub fn of(residuals: &[f64]) -> Self {
        let at = |lag: usize| residuals.iter().zip(&residuals[lag..]).map(|(a, b)| a * b).sum::<f64>();
        let most = (residuals.len() / 4).min(MOST_PRODUCTS / residuals.len().max(1)).max(1);
        let seen = residuals.iter().filter(|r| **r != 0.0).count().max(1) as f64;
        let power = at(0).max(f64::MIN_POSITIVE);
        let (mut sums, mut time) = (vec![power], 1.0_f64);
        let mut end = most;
        for lag in 1..=most {
            let sum = at(lag);
            sums.push(sum);
            if end == most && (lag as f64) < TIMES.1 * time.max(1.0) {
                time += 2.0 * sum / power;
            } else if end == most {
                end = ((TIMES.0 * time.max(1.0)).ceil() as usize).clamp(lag, most);
            }
            if lag >= end {
                break;
            }
        }
        let n = sums.len() as f64;
        let gamma = sums.iter().enumerate().map(|(lag, sum)| (1.0 - lag as f64 / n) * sum / seen).collect();
        Self { gamma, time: time.max(1.0) }
    }

    /// Covariance of two sums of the noise with these factors.
    fn covariance(&self, a: &[f64], b: &[f64]) -> f64 {
        let at =
            |lag: usize, a: &[f64], b: &[f64]| a.iter().zip(&b[lag.min(b.len())..]).map(|(a, b)| a * b).sum::<f64>();
        let of = |(lag, gamma): (usize, &f64)| {
            let both = if lag == 0 { at(0, a, b) } else { at(lag, a, b) + at(lag, b, a) };
            gamma * both
        };
        self.gamma.iter().enumerate().map(of).sum()
    }
}

/// How well a shift is known.
pub(crate) struct Known {
    pub standard: [f64; 2],
    pub left_s: f64,
    /// Root mean square distance of what tells the lag from the origin, s.
    pub arm_s: f64,
    /// Where the lag jumps, s of the first clock, and by how much, s.
    pub jump: Option<[f64; 2]>,
}

/// Of a fit, whose origin is moved to where the records tell the lag best; `rounding_s` is what the samples of a trigger leave open.
pub(crate) fn of(rows: &Rows, fit: &mut Fit, is_free: bool, rounding_s: f64) -> Option<Known> {
    let told = rows.values.iter().flatten().map(|row| (row[0], row[3] * row[3]));
    let (weight, first) = told.clone().fold((0.0, 0.0), |(w, ws), (s, x)| (w + x, ws + x * s));
    let origin_s = first / weight;
    let arm_s = (told.map(|(s, x)| x * (s - origin_s).powi(2)).sum::<f64>() / weight).sqrt();
    (fit.lag_s, fit.origin_s) = (fit.lag_s + fit.drift * (origin_s - fit.origin_s), origin_s);
    let p = 3 + usize::from(is_free);
    let mut hessian = Mat::<f64>::zeros(p, p);
    let columns: Vec<[f64; 4]> =
        rows.values.iter().map(|row| row.as_ref().map_or([0.0; 4], |row| fit.columns(row))).collect();
    for (row, z) in rows.values.iter().zip(&columns) {
        let Some(row) = row else { continue };
        (0..p).for_each(|i| (0..p).for_each(|j| hessian[(i, j)] += z[i] * z[j]));
        // What the products of first derivatives lack: −r ∂²(a + b x).
        let (r, arm) = (fit.residual(row), [1.0, row[0] - fit.origin_s]);
        for i in 2..p {
            hessian[(i, 1)] += r * row[3] * arm[i - 2];
            hessian[(1, i)] += r * row[3] * arm[i - 2];
            (2..p).for_each(|j| hessian[(i, j)] -= r * fit.gain * row[4] * arm[i - 2] * arm[j - 2]);
        }
    }
    let inverse = solved(&hessian, &Mat::identity(p, p))?;
    let factors = |k: usize, columns: &[[f64; 4]], inverse: &Mat<f64>| -> Vec<f64> {
        columns.iter().map(|z| (0..inverse.nrows()).map(|i| inverse[(k, i)] * z[i]).sum()).collect()
    };
    // A lag of each window about the line: what they leave is noise alone, whatever the clocks do from one to the next.
    let mut residuals = rows.residuals(fit);
    let there: Vec<usize> = (0..rows.values.len()).filter(|k| rows.values[*k].is_some()).collect();
    let mut of_window = |part: &[usize]| {
        let (from, to) = (*part.first()?, *part.last()? + 1);
        let (own, left) = (&columns[from..to], &mut residuals[from..to]);
        let power: f64 = own.iter().map(|z| z[2] * z[2]).sum();
        let c: Vec<f64> = own.iter().map(|z| z[2] / power).collect();
        let off = c.iter().zip(&*left).map(|(c, r)| c * r).sum::<f64>();
        left.iter_mut().zip(own).for_each(|(r, z)| *r -= z[2] * off);
        Some((rows.values[part[part.len() / 2]].as_ref()?[0], off, c)).filter(|_| power > 0.0)
    };
    let windows: Vec<(f64, f64, Vec<f64>)> =
        there.chunks(there.len().div_ceil(WINDOWS).max(1)).filter_map(&mut of_window).collect();
    let mut noise = Noise::of(&residuals);
    // Each of them took the part of one independent value from the noise.
    let taken = windows.len() as f64 * noise.time / there.len() as f64;
    noise.gamma.iter_mut().for_each(|gamma| *gamma /= 1.0 - taken.min(0.5));
    let with_variance =
        |(s, off, c): &(f64, f64, Vec<f64>)| [*s, *off, noise.covariance(c, c) + rounding_s * rounding_s];
    let windows: Vec<[f64; 3]> = windows.iter().map(with_variance).filter(|[.., variance]| *variance > 0.0).collect();
    let standard = |c: &[f64]| noise.covariance(c, c).max(0.0).sqrt();
    let lag = standard(&factors(2, &columns, &inverse));
    let drift = if is_free { standard(&factors(3, &columns, &inverse)) } else { 0.0 };
    // A declared drift holds within its uncertainty only: the windows are compared with a line either way.
    let about_line = line(&windows, &|_| 0.0);
    let dof = windows.len() as f64 - 2.0;
    let Some((chi2, _)) = about_line.filter(|_| dof >= 1.0) else {
        return Some(Known { standard: [lag, drift], left_s: 0.0, arm_s, jump: None });
    };
    let birge = (chi2 / dof).max(1.0);
    let weight: f64 = windows.iter().map(|w| 1.0 / w[2]).sum();
    let left_s = ((chi2 - dof).max(0.0) / weight).sqrt();
    let jumps = (2..windows.len().saturating_sub(1)).filter_map(|k| {
        let edge = 0.5 * (windows[k - 1][0] + windows[k][0]);
        let (left, jump) = line(&windows, &|s| f64::from(u8::from(s > edge)))?;
        Some([left, edge, jump])
    });
    let best = jumps.min_by(|a, b| a[0].total_cmp(&b[0]));
    let jump = best.filter(|[left, ..]| chi2 - left > JUMP.0 && *left < JUMP.1 * chi2);
    Some(Known {
        standard: [lag, drift].map(|s| s * birge.sqrt()),
        // Chance alone leaves nothing.
        left_s: if chi2 > dof + CHANCE * (2.0 * dof).sqrt() { left_s } else { 0.0 },
        arm_s,
        jump: jump.map(|[_, s, jump]| [s - fit.lag_s - fit.drift * (s - fit.origin_s), jump]),
    })
}

/// χ² of the lags of windows about a line, and a step where `step` is not 0 everywhere; with the step's size.
fn line(windows: &[[f64; 3]], step: &dyn Fn(f64) -> f64) -> Option<(f64, f64)> {
    let middle = windows.iter().map(|w| w[0]).sum::<f64>() / windows.len().max(1) as f64;
    let has_step = windows.iter().any(|w| step(w[0]) != 0.0);
    let row = |s: f64| {
        let mut row = vec![1.0, s - middle];
        row.extend(has_step.then(|| step(s)));
        row
    };
    let p = row(middle).len();
    let (mut gram, mut right) = (Mat::<f64>::zeros(p, p), Mat::<f64>::zeros(p, 1));
    for [s, lag, variance] in windows {
        let z = row(*s);
        for i in 0..p {
            (0..p).for_each(|j| gram[(i, j)] += z[i] * z[j] / variance);
            right[(i, 0)] += z[i] * lag / variance;
        }
    }
    let found = solved(&gram, &right)?;
    let left = |[s, lag, variance]: &[f64; 3]| {
        let at: f64 = row(*s).iter().enumerate().map(|(i, z)| z * found[(i, 0)]).sum();
        (lag - at).powi(2) / variance
    };
    Some((windows.iter().map(left).sum(), found[(p - 1, 0)]))
}
