//! Butterworth low-pass filters as second-order sections.
//!
//! A filter of order n is a chain of ⌈n/2⌉ sections of order two (one of order one when n is odd). In one
//! polynomial of order n, coefficients rounded to 53 bits move the poles of a low corner visibly; in sections
//! they do not.
//!
//! # Source
//!
//! Oppenheim & Schafer (2010), *Discrete-Time Signal Processing*, 3rd ed., 7.2.2 (bilinear transform with the
//! corner pre-warped); states in the transposed direct form II of 6.3.

use std::f64::consts::PI;

use crate::error::{SignalError, in_range, positive};

/// Orders beyond this belong to another kind of filter.
const HIGHEST_ORDER: usize = 20;

/// One section: `y = (b₀ + b₁z⁻¹ + b₂z⁻²)/(1 + a₁z⁻¹ + a₂z⁻²) x`, unit gain at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Numerator.
    pub b: [f64; 3],
    /// Denominator without its leading 1.
    pub a: [f64; 2],
}

impl Section {
    /// One sample through the section; `state` is the transposed form's.
    #[inline]
    pub(crate) fn step(&self, x: f64, state: &mut [f64; 2]) -> f64 {
        let y = self.b[0] * x + state[0];
        state[0] = (self.b[1] * x + state[1]) - self.a[0] * y;
        state[1] = self.b[2] * x - self.a[1] * y;
        y
    }

    /// State after an endless input of 1.
    pub(crate) fn steady_state(&self) -> [f64; 2] {
        let second = self.b[2] - self.a[1];
        [self.b[1] - self.a[0] + second, second]
    }
}

/// A low-pass filter.
#[derive(Debug, Clone, PartialEq)]
pub struct LowPass {
    /// Sections in the order in which they act.
    pub sections: Vec<Section>,
    order: usize,
    corner_hz: f64,
    rate_hz: f64,
}

impl LowPass {
    /// Order of the filter.
    #[must_use]
    pub fn order(&self) -> usize {
        self.order
    }

    /// Frequency at which one pass halves the power, Hz.
    #[must_use]
    pub fn corner_hz(&self) -> f64 {
        self.corner_hz
    }

    /// Rate it was made for, Hz.
    #[must_use]
    pub fn rate_hz(&self) -> f64 {
        self.rate_hz
    }

    /// Gain of one pass at a frequency, `|H|` \[-\].
    ///
    /// Of the design, `1/√(1 + (tan(πf/f_s)/tan(πf_c/f_s))²ⁿ)`; a forward–backward pass has its square.
    #[must_use]
    pub fn gain(&self, frequency_hz: f64) -> f64 {
        let warp = |f: f64| (PI * f / self.rate_hz).tan();
        (1.0 + (warp(frequency_hz) / warp(self.corner_hz)).powi(2 * self.order as i32)).sqrt().recip()
    }

    /// Samples after which the memory of the filter has fallen below the rounding of a number.
    ///
    /// The slowest pole pair decays by |z| a sample; a factor 2 covers the growth of repeated-like terms in the chain.
    #[must_use]
    pub fn memory(&self) -> usize {
        let slowest = self.sections.iter().map(|s| if s.a[1] == 0.0 { s.a[0].abs() } else { s.a[1].sqrt() });
        let decay = slowest.fold(0.0, f64::max);
        ((2.0 * f64::EPSILON.ln() / decay.ln()).ceil() as usize).saturating_add(3 * (self.order + 1))
    }
}

/// Designs a Butterworth low-pass of `order` with its corner at `corner_hz` for samples at `rate_hz`.
///
/// # Errors
///
/// [`SignalError::OutOfRange`] for an order outside 1…20, [`SignalError::Corner`] for a corner not between 0 and half the rate.
///
/// # Example
///
/// ```
/// let filter = froude_signal::butterworth::low_pass(4, 100.0, 1000.0)?;
/// assert!((filter.gain(100.0).powi(2) - 0.5).abs() < 1e-12);
/// # Ok::<(), froude_signal::SignalError>(())
/// ```
pub fn low_pass(order: usize, corner_hz: f64, rate_hz: f64) -> Result<LowPass, SignalError> {
    in_range("order of the Butterworth filter", order, 1, HIGHEST_ORDER)?;
    positive("sampling rate (Hz)", rate_hz)?;
    if !(corner_hz > 0.0 && corner_hz < 0.5 * rate_hz) {
        return Err(SignalError::Corner { corner_hz, rate_hz });
    }
    // Analogue poles lie on a circle of radius w; z = (1 + s)/(1 − s).
    let w = (PI * corner_hz / rate_hz).tan();
    let mut sections = Vec::with_capacity(order.div_ceil(2));
    if order % 2 == 1 {
        let a1 = -(1.0 - w) / (1.0 + w);
        let g = 0.5 * (1.0 + a1);
        sections.push(Section { b: [g, g, 0.0], a: [a1, 0.0] });
    }
    // Well damped pairs first, the sharpest last.
    for k in (0..order / 2).rev() {
        let damping = (PI * (2 * k + 1) as f64 / (2 * order) as f64).sin();
        let size = 1.0 + 2.0 * w * damping + w * w;
        let a1 = -2.0 * (1.0 - w * w) / size;
        let a2 = (1.0 - 2.0 * w * damping + w * w) / size;
        // From the rounded denominator, so that the gain at rest is 1 to the last bits.
        let g = 0.25 * (1.0 + a1 + a2);
        sections.push(Section { b: [g, 2.0 * g, g], a: [a1, a2] });
    }
    Ok(LowPass { sections, order, corner_hz, rate_hz })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn order_one_is_the_textbook_one() {
        // Corner at a quarter of the rate: tan(π/4) = 1, so y = (x + x₋₁)/2.
        let filter = low_pass(1, 250.0, 1000.0).unwrap();
        let s = filter.sections[0];
        assert!((s.b[0] - 0.5).abs() < 1e-15 && (s.b[1] - 0.5).abs() < 1e-15 && s.a[0].abs() < 1e-15);
    }

    #[test]
    fn the_sections_have_the_gain_of_the_design() {
        let filter = low_pass(5, 40.0, 1000.0).unwrap();
        for f in [0.0, 10.0, 40.0, 80.0, 200.0_f64] {
            let (s, c) = (2.0 * PI * f / 1000.0).sin_cos();
            let z = |q: [f64; 3]| {
                // q₀ + q₁ e^{−iω} + q₂ e^{−2iω}
                (q[0] + q[1] * c + q[2] * (2.0 * c * c - 1.0)).hypot(q[1] * s + q[2] * 2.0 * s * c)
            };
            let gain: f64 = filter.sections.iter().map(|s| z(s.b) / z([1.0, s.a[0], s.a[1]])).product();
            assert!((gain - filter.gain(f)).abs() < 1e-12, "{f} Hz: {gain} {}", filter.gain(f));
        }
    }

    #[test]
    fn a_corner_beyond_half_the_rate_is_refused_in_words() {
        let error = low_pass(4, 600.0, 1000.0).unwrap_err();
        assert_eq!(
            error.to_string(),
            "corner 600 Hz is not between 0 and half the rate (1000 Hz); lower it or sample faster"
        );
    }
}
