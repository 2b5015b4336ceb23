//! Shifts at which two records are alike: the peaks of their correlation.

use crate::smooth::Smooth;
use crate::spectrum::{Complex, transform};

/// Fewest values that are compared.
pub(crate) const FEWEST: usize = 20;
/// Part of the shorter record that any shift compares, unless a lag is declared.
const LEAST_OVERLAP: f64 = 0.5;
/// Peaks that are refined, and the part of the highest that they reach.
const PEAKS: (usize, f64) = (8, 0.3);

/// A shift with its correlation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Shift {
    pub lag_s: f64,
    pub correlation: f64,
}

/// The peaks of the correlation, the highest first, within the declared range where there is one.
pub(crate) fn candidates(x: &Smooth, y: &Smooth, declared: Option<[f64; 2]>) -> Vec<Shift> {
    let all = correlations(x, y, declared);
    let is_peak = |i: &usize| {
        let at = |k: Option<usize>| k.and_then(|k| all.get(k)).map_or(f64::NEG_INFINITY, |shift| shift.correlation);
        all[*i].correlation > at(i.checked_sub(1)) && all[*i].correlation >= at(Some(i + 1))
    };
    let mut peaks: Vec<Shift> = (0..all.len()).filter(is_peak).map(|i| all[i]).collect();
    peaks.sort_by(|a, b| b.correlation.total_cmp(&a.correlation));
    let least = peaks.first().map_or(0.0, |highest| PEAKS.1 * highest.correlation);
    peaks.retain(|peak| peak.correlation >= least);
    peaks.truncate(PEAKS.0);
    peaks
}

/// The size of the most negative correlation.
pub(crate) fn most_opposite(x: &Smooth, y: &Smooth, declared: Option<[f64; 2]>) -> f64 {
    correlations(x, y, declared).iter().fold(0.0, |most, shift| most.max(-shift.correlation))
}

/// The correlation at every shift by whole steps that compares enough of both, in order.
fn correlations(x: &Smooth, y: &Smooth, declared: Option<[f64; 2]>) -> Vec<Shift> {
    let (nx, ny, step_s) = (x.values.len(), y.values.len(), x.step_s);
    let (ox, oy) = (Seen::of(x), Seen::of(y));
    let n = (nx + ny).next_power_of_two();
    let products = [(&ox.values, &oy.values), (&ox.whole, &oy.whole)].map(|(a, b)| lagged_products(a, b, n));
    let needed = match declared {
        Some(_) => FEWEST as f64,
        None => (LEAST_OVERLAP * nx.min(ny) as f64).max(FEWEST as f64),
    };
    let of = |m: isize| {
        let lag_s = y.time_s[0] - x.time_s[0] - m as f64 * step_s;
        if declared.is_some_and(|[value, range]| (lag_s - value).abs() > range + step_s) {
            return None;
        }
        // y[k] lies at x[k + m].
        let from = usize::try_from(-m).unwrap_or(0);
        let to = ny.min(usize::try_from(nx as isize - m).unwrap_or(0));
        if to <= from {
            return None;
        }
        let at = |k: usize| (k as isize + m) as usize;
        let place = m.rem_euclid(n as isize) as usize;
        let (seen, xy) = (products[1][place].round(), products[0][place]);
        if seen < needed {
            return None;
        }
        let ([cx, sx, sxx], [cy, sy, syy]) = (ox.sums(at(from), at(to)), oy.sums(from, to));
        let (mx, my) = (sx / cx, sy / cy);
        let varied = (sxx / cx - mx * mx) * (syy / cy - my * my);
        let correlation = (xy / seen - mx * my) / varied.sqrt();
        correlation.is_finite().then_some(Shift { lag_s, correlation })
    };
    let ends = [-(ny as isize) + 1, nx as isize - 1];
    (ends[0]..=ends[1]).rev().filter_map(of).collect()
}

/// A record about its mean, zero where it was not seen, with its running sums.
struct Seen {
    values: Vec<f64>,
    whole: Vec<f64>,
    sums: Vec<[f64; 3]>,
}

impl Seen {
    fn of(record: &Smooth) -> Self {
        let whole: Vec<f64> = record.is_whole.iter().map(|w| f64::from(u8::from(*w))).collect();
        let count = whole.iter().sum::<f64>().max(1.0);
        let mean = record.values.iter().zip(&whole).map(|(x, w)| x * w).sum::<f64>() / count;
        let values: Vec<f64> = record.values.iter().zip(&whole).map(|(x, w)| (x - mean) * w).collect();
        let mut sums = vec![[0.0; 3]];
        let mut sum = [0.0; 3];
        for (x, w) in values.iter().zip(&whole) {
            sum = [sum[0] + w, sum[1] + x, sum[2] + x * x];
            sums.push(sum);
        }
        Self { values, whole, sums }
    }

    /// Number, sum and sum of squares of the rows from one to before another.
    fn sums(&self, from: usize, to: usize) -> [f64; 3] {
        let [a, b] = [from, to].map(|k| self.sums[k.min(self.values.len())]);
        [b[0] - a[0], b[1] - a[1], b[2] - a[2]]
    }
}

/// Σ_k b_k a_{k+m} at each m, negative ones from the end: by the transforms of both.
fn lagged_products(a: &[f64], b: &[f64], n: usize) -> Vec<f64> {
    let turned = |x: &[f64]| {
        let mut data: Vec<Complex> = x.iter().map(|x| [*x, 0.0]).collect();
        data.resize(n, [0.0; 2]);
        transform(&mut data);
        data
    };
    let (a, b) = (turned(a), turned(b));
    // a b*, conjugated: its transform is the conjugate of what is wanted.
    let mut product: Vec<Complex> =
        a.iter().zip(&b).map(|(a, b)| [a[0] * b[0] + a[1] * b[1], a[0] * b[1] - a[1] * b[0]]).collect();
    transform(&mut product);
    product.into_iter().map(|[re, _]| re / n as f64).collect()
}
