//! Power spectra by averaging (Welch).
//!
//! Segments of 2ᵏ samples, half overlapping, with their mean subtracted, under a Hann window.
//!
//! # Source
//!
//! Welch (1967), IEEE Trans. Audio Electroacoust. 15, 70; scaling as `scipy.signal.welch` (its defaults).

use std::f64::consts::{PI, TAU};

use crate::error::{SignalError, all_finite, positive};

/// A complex number, real and imaginary part.
pub(crate) type Complex = [f64; 2];

/// Power density of a record, over segments of `segment` samples (a power of two): frequencies \[Hz\] from 0 to half the rate, and
/// densities \[unit²/Hz\].
///
/// # Errors
///
/// [`SignalError::OutOfRange`] for a segment that is not a power of two, [`SignalError::TooShort`] for a record shorter than
/// one, [`SignalError::NotFinite`].
pub fn density(record: &[f64], rate_hz: f64, segment: usize) -> Result<(Vec<f64>, Vec<f64>), SignalError> {
    positive("sampling rate (Hz)", rate_hz)?;
    if !segment.is_power_of_two() || segment < 4 {
        let (low, high) = (4.max(segment.next_power_of_two() / 2), 4.max(segment.next_power_of_two()));
        return Err(SignalError::OutOfRange { what: "segment (a power of two from 4)", found: segment, low, high });
    }
    if record.len() < segment {
        return Err(SignalError::TooShort { what: "the spectrum", needed: segment - 1, found: record.len() });
    }
    all_finite(record)?;
    let window: Vec<f64> = (0..segment).map(|i| 0.5 - 0.5 * (TAU * i as f64 / segment as f64).cos()).collect();
    let power: f64 = window.iter().map(|w| w * w).sum();
    let bins = segment / 2 + 1;
    let mut sums = vec![0.0; bins];
    let mut segments = 0;
    for part in record.windows(segment).step_by(segment / 2) {
        for (sum, [re, im]) in sums.iter_mut().zip(transformed(part, &window)) {
            *sum += re * re + im * im;
        }
        segments += 1;
    }
    let one_sided = |k: usize| if k == 0 || k == bins - 1 { 1.0 } else { 2.0 };
    let scale = |k: usize| one_sided(k) / (rate_hz * power * f64::from(segments));
    let frequency_hz = (0..bins).map(|k| k as f64 * rate_hz / segment as f64).collect();
    Ok((frequency_hz, sums.iter().enumerate().map(|(k, p)| p * scale(k)).collect()))
}

fn transformed(samples: &[f64], window: &[f64]) -> Vec<Complex> {
    let mean = samples.iter().sum::<f64>() / samples.len() as f64;
    let mut data: Vec<Complex> = samples.iter().zip(window).map(|(x, w)| [(x - mean) * w, 0.0]).collect();
    transform(&mut data);
    data
}

/// Fourier transform in place, `X_k = Σ x_i e^{−2πi k i/n}`; the length is a power of two (Cooley & Tukey 1965).
pub(crate) fn transform(data: &mut [Complex]) {
    let n = data.len();
    if n < 2 {
        return;
    }
    let bits = n.trailing_zeros();
    for i in 0..n {
        let j = i.reverse_bits() >> (usize::BITS - bits);
        if i < j {
            data.swap(i, j);
        }
    }
    let turn: Vec<Complex> = (0..n / 2)
        .map(|k| {
            let (s, c) = (-2.0 * PI * k as f64 / n as f64).sin_cos();
            [c, s]
        })
        .collect();
    let mut size = 2;
    while size <= n {
        let stride = n / size;
        for block in data.chunks_exact_mut(size) {
            let (low, high) = block.split_at_mut(size / 2);
            for (k, (a, b)) in low.iter_mut().zip(high).enumerate() {
                let [c, s] = turn[k * stride];
                let moved = [b[0] * c - b[1] * s, b[0] * s + b[1] * c];
                *b = [a[0] - moved[0], a[1] - moved[1]];
                *a = [a[0] + moved[0], a[1] + moved[1]];
            }
        }
        size *= 2;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    fn noise(n: usize) -> Vec<f64> {
        let mut rng = rand_pcg::Pcg64Mcg::seed_from_u64(3);
        (0..n).map(|_| rng.random_range(-1.0..1.0)).collect()
    }

    #[test]
    fn the_transform_is_its_definition() {
        let x = noise(16);
        let mut fast: Vec<Complex> = x.iter().map(|&x| [x, 0.0]).collect();
        transform(&mut fast);
        for (k, f) in fast.iter().enumerate() {
            let slow = x.iter().enumerate().fold([0.0; 2], |sum: Complex, (i, x)| {
                let (s, c) = (-TAU * (k * i % 16) as f64 / 16.0).sin_cos();
                [sum[0] + x * c, sum[1] + x * s]
            });
            // Sixteen products below 1, each rounded to 2e-16.
            assert!((f[0] - slow[0]).abs() < 1e-14 && (f[1] - slow[1]).abs() < 1e-14);
        }
    }

    #[test]
    fn the_density_of_white_noise_adds_up_to_its_variance() {
        let (f, p) = density(&noise(1 << 16), 100.0, 256).unwrap();
        let variance: f64 = p.iter().sum::<f64>() * (f[1] - f[0]);
        // 1/3, to the scatter of 65,536 uniform numbers: √(4/45)/(256/3) of it, 0.35 %; three times.
        assert!((variance * 3.0 - 1.0).abs() < 0.0105, "{variance}");
    }
}
