//! Spectra and frequency responses by averaging (Welch).
//!
//! Segments of 2ᵏ samples, half overlapping, with their mean subtracted, under a Hann window. With input u and output y:
//! power densities `P_uu`, `P_yy` \[unit²/Hz\], response `H = P_uy/P_uu` (noise at the output only), coherence
//! `γ² = |P_uy|²/(P_uu P_yy)`.
//!
//! # Source
//!
//! Welch (1967), IEEE Trans. Audio Electroacoust. 15, 70; scaling as `scipy.signal.welch` and `csd` (their defaults).
//! Variance of H: Bendat & Piersol (2010), *Random Data*, 4th ed., 9.2.4.

use std::f64::consts::{PI, TAU};

use crate::error::{SignalError, all_finite, positive};

/// A complex number, real and imaginary part.
pub type Complex = [f64; 2];

/// Spectra of an input and an output at `segment/2 + 1` frequencies from 0 to half the rate.
#[derive(Debug, Clone, PartialEq)]
pub struct Response {
    /// Frequencies, Hz.
    pub frequency_hz: Vec<f64>,
    /// Power density of the input.
    pub input: Vec<f64>,
    /// Power density of the output.
    pub output: Vec<f64>,
    /// `P_uy/P_uu`.
    pub response: Vec<Complex>,
    /// γ², 0…1; meaningless (1) from a single segment.
    pub coherence: Vec<f64>,
    /// Segments averaged.
    pub segments: usize,
}

impl Response {
    /// Relative standard deviation of `|H|`, `√((1 − γ²)/(2 γ² n))`, segments taken as independent.
    #[must_use]
    pub fn relative_std(&self, k: usize) -> f64 {
        let g = self.coherence[k];
        ((1.0 - g) / (2.0 * g * self.segments as f64)).sqrt()
    }
}

/// Power density of one record: frequencies \[Hz\] and densities.
///
/// # Errors
///
/// As [`frequency_response`].
pub fn density(record: &[f64], rate_hz: f64, segment: usize) -> Result<(Vec<f64>, Vec<f64>), SignalError> {
    let both = frequency_response(record, record, rate_hz, segment)?;
    Ok((both.frequency_hz, both.input))
}

/// Frequency response from `input` to `output`, over segments of `segment` samples (a power of two).
///
/// # Errors
///
/// [`SignalError::OutOfRange`] for a segment that is not a power of two, [`SignalError::TooShort`] for a record shorter than
/// one, [`SignalError::Length`], [`SignalError::NotFinite`].
pub fn frequency_response(
    input: &[f64],
    output: &[f64],
    rate_hz: f64,
    segment: usize,
) -> Result<Response, SignalError> {
    positive("sampling rate (Hz)", rate_hz)?;
    if !segment.is_power_of_two() || segment < 4 {
        let (low, high) = (4.max(segment.next_power_of_two() / 2), 4.max(segment.next_power_of_two()));
        return Err(SignalError::OutOfRange { what: "segment (a power of two from 4)", found: segment, low, high });
    }
    if output.len() != input.len() {
        return Err(SignalError::Length { what: "the output", found: output.len(), expected: input.len() });
    }
    if input.len() < segment {
        return Err(SignalError::TooShort { what: "the spectrum", needed: segment - 1, found: input.len() });
    }
    all_finite(input)?;
    all_finite(output)?;
    let window: Vec<f64> = (0..segment).map(|i| 0.5 - 0.5 * (TAU * i as f64 / segment as f64).cos()).collect();
    let power: f64 = window.iter().map(|w| w * w).sum();
    let bins = segment / 2 + 1;
    let (mut uu, mut yy, mut uy) = (vec![0.0; bins], vec![0.0; bins], vec![[0.0; 2]; bins]);
    let mut segments = 0;
    let mut start = 0;
    while start + segment <= input.len() {
        let u = transformed(&input[start..start + segment], &window);
        let y = transformed(&output[start..start + segment], &window);
        for k in 0..bins {
            uu[k] += u[k][0] * u[k][0] + u[k][1] * u[k][1];
            yy[k] += y[k][0] * y[k][0] + y[k][1] * y[k][1];
            // conj(u) · y
            uy[k][0] += u[k][0] * y[k][0] + u[k][1] * y[k][1];
            uy[k][1] += u[k][0] * y[k][1] - u[k][1] * y[k][0];
        }
        segments += 1;
        start += segment / 2;
    }
    let one_sided = |k: usize| if k == 0 || k == bins - 1 { 1.0 } else { 2.0 };
    let scale = |k: usize| one_sided(k) / (rate_hz * power * f64::from(segments));
    Ok(Response {
        frequency_hz: (0..bins).map(|k| k as f64 * rate_hz / segment as f64).collect(),
        response: (0..bins).map(|k| [uy[k][0] / uu[k], uy[k][1] / uu[k]]).collect(),
        coherence: (0..bins).map(|k| (uy[k][0].powi(2) + uy[k][1].powi(2)) / (uu[k] * yy[k])).collect(),
        input: uu.iter().enumerate().map(|(k, p)| p * scale(k)).collect(),
        output: yy.iter().enumerate().map(|(k, p)| p * scale(k)).collect(),
        segments: segments as usize,
    })
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

    #[test]
    fn a_delay_is_a_phase_and_loses_no_coherence() {
        let u = noise(20_001);
        let response = frequency_response(&u[1..], &u[..20_000], 1.0, 64).unwrap();
        for k in 2..30 {
            let [re, im] = response.response[k];
            // One sample of 64 against the window: γ² and |H| fall by some 1/64.
            assert!((re.hypot(im) - 1.0).abs() < 0.03 && response.coherence[k] > 0.99);
            let phase = im.atan2(re) + TAU * k as f64 / 64.0;
            assert!((phase + PI).rem_euclid(TAU) - PI < 0.03);
        }
    }
}
