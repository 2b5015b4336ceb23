//! Values between samples: a cubic spline through all of them, read at the times of another clock.
//!
//! At the ends the third derivative is continuous through the second sample and the last but one (not-a-knot), as `scipy.interpolate.CubicSpline`
//! has it by default. Error of a sine of period T sampled every h: below (2πh/T)⁴/48 of its amplitude away from the ends, 4e-6 from 50 samples a
//! period on.
//!
//! **Units.** Time in s, the record in any unit; samples need not be even.
//!
//! # Source
//!
//! de Boor (1978), *A Practical Guide to Splines*, ch. IV.

use std::borrow::Cow;

use crate::error::{SignalError, all_finite};

/// A cubic spline, of a record that it borrows or owns.
#[derive(Debug, Clone, PartialEq)]
pub struct Spline<'a> {
    time_s: Cow<'a, [f64]>,
    record: Cow<'a, [f64]>,
    /// First derivative at each sample.
    slope: Vec<f64>,
}

impl<'a> Spline<'a> {
    /// Through a record of four samples and more, at increasing times.
    ///
    /// # Errors
    ///
    /// [`SignalError::Length`], [`SignalError::TooShort`], [`SignalError::NotFinite`], [`SignalError::NotIncreasing`].
    pub fn through(time_s: impl Into<Cow<'a, [f64]>>, record: impl Into<Cow<'a, [f64]>>) -> Result<Self, SignalError> {
        let (time_s, record) = (time_s.into(), record.into());
        let n = time_s.len();
        if record.len() != n {
            return Err(SignalError::Length { what: "the record", found: record.len(), expected: n });
        }
        if n < 4 {
            return Err(SignalError::TooShort { what: "a cubic spline", needed: 3, found: n });
        }
        all_finite(&time_s)?;
        all_finite(&record)?;
        if let Some(index) = time_s.windows(2).position(|w| w[1] <= w[0]) {
            return Err(SignalError::NotIncreasing { index: index + 1 });
        }
        let h = |i: usize| time_s[i + 1] - time_s[i];
        let d = |i: usize| (record[i + 1] - record[i]) / h(i);
        // Rows below, on and above the diagonal, and the right-hand side; Thomas' elimination.
        let (mut below, mut on, mut above, mut right) = (vec![0.0; n], vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let (a, b) = (h(0), h(1));
        (on[0], above[0]) = (b, a + b);
        right[0] = ((a + 2.0 * (a + b)) * b * d(0) + a * a * d(1)) / (a + b);
        for i in 1..n - 1 {
            (below[i], on[i], above[i]) = (h(i), 2.0 * (h(i - 1) + h(i)), h(i - 1));
            right[i] = 3.0 * (h(i) * d(i - 1) + h(i - 1) * d(i));
        }
        let (a, b) = (h(n - 2), h(n - 3));
        (below[n - 1], on[n - 1]) = (a + b, b);
        right[n - 1] = (a * a * d(n - 3) + (2.0 * (a + b) + a) * b * d(n - 2)) / (a + b);
        for i in 1..n {
            let part = below[i] / on[i - 1];
            on[i] -= part * above[i - 1];
            right[i] -= part * right[i - 1];
        }
        let mut slope = right;
        slope[n - 1] /= on[n - 1];
        for i in (0..n - 1).rev() {
            slope[i] = (slope[i] - above[i] * slope[i + 1]) / on[i];
        }
        Ok(Self { time_s, record, slope })
    }

    /// The value at a time; `None` outside of the record.
    #[must_use]
    pub fn at(&self, time_s: f64) -> Option<f64> {
        self.with_derivatives_at(time_s).map(|[value, ..]| value)
    }

    /// The value at a time with its first and second derivative; `None` outside of the record.
    #[must_use]
    pub fn with_derivatives_at(&self, time_s: f64) -> Option<[f64; 3]> {
        let last = self.time_s.len() - 1;
        if !(self.time_s[0]..=self.time_s[last]).contains(&time_s) {
            return None;
        }
        let i = self.time_s.partition_point(|t| *t <= time_s).clamp(1, last) - 1;
        let h = self.time_s[i + 1] - self.time_s[i];
        let u = (time_s - self.time_s[i]) / h;
        let d = (self.record[i + 1] - self.record[i]) / h;
        let (s0, s1) = (self.slope[i], self.slope[i + 1]);
        let c2 = (3.0 * d - 2.0 * s0 - s1) * h;
        let c3 = (s0 + s1 - 2.0 * d) * h;
        Some([
            self.record[i] + u * (s0 * h + u * (c2 + u * c3)),
            s0 + u * (2.0 * c2 + 3.0 * u * c3) / h,
            (2.0 * c2 + 6.0 * u * c3) / (h * h),
        ])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// A cubic is its own spline, whatever the steps.
        #[test]
        fn a_cubic_comes_back(c in prop::array::uniform4(-3.0_f64..3.0), steps in prop::collection::vec(0.2_f64..1.0, 5..20)) {
            let time: Vec<f64> = steps.iter().scan(0.0, |t, h| { *t += h; Some(*t) }).collect();
            let cubic = |t: f64| c[0] + t * (c[1] + t * (c[2] + t * c[3]));
            let record: Vec<f64> = time.iter().map(|t| cubic(*t)).collect();
            let spline = Spline::through(&time, &record).unwrap();
            for k in 0..40 {
                let t = time[0] + (time[time.len() - 1] - time[0]) * f64::from(k) / 39.0;
                if let Some(value) = spline.at(t) {
                    // Rounding of numbers up to 3·20³.
                    prop_assert!((value - cubic(t)).abs() < 1e-9, "{t}");
                }
            }
        }
    }

    #[test]
    fn outside_of_the_record_there_is_nothing() {
        let time = [0.0, 1.0, 2.0, 3.0];
        let spline = Spline::through(&time, &time).unwrap();
        assert_eq!((spline.at(-1e-9), spline.at(3.0), spline.at(3.1)), (None, Some(3.0), None));
        assert!(matches!(Spline::through(&[0.0, 1.0, 1.0, 2.0], &time), Err(SignalError::NotIncreasing { index: 2 })));
    }
}
