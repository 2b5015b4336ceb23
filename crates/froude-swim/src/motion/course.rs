//! Joint angles that are no plain wave: recorded over a time or one period of it, or a course that begins from straight joints.
//!
//! Between the rows of a recording the angles are a cubic spline ([`froude_signal::resample`]); its second derivative is that of the accelerations, and shows the noise of a recording
//! first. A cycle is closed: its last row is its first one again.
//!
//! **Units.** rad, s.

use std::borrow::Cow;

use froude_signal::SignalError;
use froude_signal::resample::Spline;

use crate::gait::{Course, Shape};

/// Rows of a cycle that go before its first and behind its last: what the ends of a spline do fades by 0.27 from row to row, and is below 1e-9 here.
const WRAPPED: usize = 16;

/// Recorded joint angles.
#[derive(Debug, Clone)]
pub struct Recorded {
    angles: Vec<Spline<'static>>,
    start_s: f64,
    length_s: f64,
    is_cycle: bool,
    rows: usize,
    extremes: Vec<[f64; 2]>,
}

impl Recorded {
    /// Angles over time, a row of each joint from the head, rad.
    ///
    /// # Errors
    ///
    /// [`SignalError`]: fewer than four rows, times that do not grow, numbers that are none.
    pub fn track(time_s: &[f64], angles: &[Vec<f64>]) -> Result<Self, SignalError> {
        Self::of(time_s, angles, false)
    }

    /// The same of one period, again and again.
    ///
    /// # Errors
    ///
    /// As [`Recorded::track`].
    pub fn cycle(time_s: &[f64], angles: &[Vec<f64>]) -> Result<Self, SignalError> {
        Self::of(time_s, angles, true)
    }

    fn of(time_s: &[f64], angles: &[Vec<f64>], is_cycle: bool) -> Result<Self, SignalError> {
        let (Some(start_s), Some(end_s)) = (time_s.first(), time_s.last()) else {
            return Err(SignalError::TooShort { what: "a recording of joints", needed: 3, found: 0 });
        };
        let (start_s, length_s) = (*start_s, end_s - start_s);
        let time: Cow<'_, [f64]> = if is_cycle { wrapped(time_s, length_s).into() } else { time_s.into() };
        let spline = |angle: &Vec<f64>| {
            let angle = if is_cycle { wrapped(angle, 0.0) } else { angle.clone() };
            Spline::through(time.clone().into_owned(), angle)
        };
        let angles: Vec<Spline<'static>> = angles.iter().map(spline).collect::<Result<_, _>>()?;
        // At the rows and between them.
        let largest = |spline: &Spline<'_>| {
            let middles = time_s.windows(2).map(|w| 0.5 * (w[0] + w[1]));
            time_s
                .iter()
                .copied()
                .chain(middles)
                .filter_map(|t| spline.with_derivatives_at(t))
                .fold([0.0_f64; 2], |[angle, rate], [a, r, _]| [angle.max(a.abs()), rate.max(r.abs())])
        };
        let extremes = angles.iter().map(largest).collect();
        Ok(Self { angles, start_s, length_s, is_cycle, rows: time_s.len(), extremes })
    }

    /// Number of joints.
    #[must_use]
    pub fn joints(&self) -> usize {
        self.angles.len()
    }

    /// Number of its rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Whether it is one period.
    #[must_use]
    pub fn is_cycle(&self) -> bool {
        self.is_cycle
    }
}

/// Rows of a cycle with those before and behind it, where each round adds `per_round`.
fn wrapped(rows: &[f64], per_round: f64) -> Vec<f64> {
    let n = rows.len() as isize - 1;
    let most = if n > 0 { WRAPPED as isize } else { 0 };
    (-most..=n + most)
        .map(|i| rows[i.rem_euclid(n.max(1)) as usize] + i.div_euclid(n.max(1)) as f64 * per_round)
        .collect()
}

impl Course for Recorded {
    fn at(&self, time_s: f64, shape: &mut Shape) {
        let time_s = if self.is_cycle { time_s.rem_euclid(self.length_s) } else { time_s.clamp(0.0, self.length_s) };
        for (i, spline) in self.angles.iter().enumerate().take(shape.angle.len()) {
            let found = spline.with_derivatives_at(self.start_s + time_s).unwrap_or_default();
            [shape.angle[i], shape.rate[i], shape.acceleration[i]] = found;
        }
    }

    fn period_s(&self) -> f64 {
        self.length_s
    }

    fn extremes(&self, joint: usize, _: usize) -> [f64; 2] {
        self.extremes.get(joint).copied().unwrap_or_default()
    }
}

/// Times at which a ramp is looked at for its extremes.
const RAMP_LOOKS: u32 = 1000;

/// A course that grows from straight joints: its angles times 10x³ − 15x⁴ + 6x⁵, x = t over the time of the ramp, which has no jump in the acceleration.
#[derive(Debug, Clone, Copy)]
pub struct Ramped<'a> {
    /// What is grown to.
    pub course: &'a dyn Course,
    /// For how long, s.
    pub ramp_s: f64,
}

impl Course for Ramped<'_> {
    fn at(&self, time_s: f64, shape: &mut Shape) {
        self.course.at(time_s, shape);
        let x = time_s / self.ramp_s;
        // Without a length of the ramp at its end from the start.
        if x.is_nan() || x >= 1.0 {
            return;
        }
        let x = x.max(0.0);
        let grown = x * x * x * (10.0 - x * (15.0 - 6.0 * x));
        let first = 30.0 * (x * (1.0 - x)).powi(2) / self.ramp_s;
        let second = 60.0 * x * (1.0 - x) * (1.0 - 2.0 * x) / (self.ramp_s * self.ramp_s);
        for i in 0..shape.angle.len() {
            let (angle, rate, acceleration) = (shape.angle[i], shape.rate[i], shape.acceleration[i]);
            shape.angle[i] = grown * angle;
            shape.rate[i] = first * angle + grown * rate;
            shape.acceleration[i] = second * angle + 2.0 * first * rate + grown * acceleration;
        }
    }

    fn period_s(&self) -> f64 {
        self.course.period_s()
    }

    fn extremes(&self, joint: usize, joints: usize) -> [f64; 2] {
        // While it grows the ramp adds a rate of its own.
        let [mut angle, mut rate] = self.course.extremes(joint, joints);
        let mut shape = Shape::straight(joints);
        for k in 0..RAMP_LOOKS {
            self.at(self.ramp_s * f64::from(k) / f64::from(RAMP_LOOKS), &mut shape);
            (angle, rate) = (angle.max(shape.angle[joint].abs()), rate.max(shape.rate[joint].abs()));
        }
        [angle, rate]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::{Envelope, Gait};

    /// A wave of 200 rows a period: the spline is off by (2π/200)⁴/48 = 2e-8 of it, and its second derivative by (2π/200)²/12 = 8e-5; without the wrapping the ends would be worse.
    #[test]
    fn a_recorded_period_of_a_wave_is_the_wave() {
        let gait = Gait::wave(0.5, 1.4, 0.7, Envelope::Lateral);
        let time: Vec<f64> = (0..=200).map(|i| gait.period_s() * f64::from(i) / 200.0).collect();
        let mut shape = Shape::straight(3);
        let mut angles = vec![Vec::new(); 3];
        for t in &time {
            gait.at(*t, &mut shape);
            for (row, angle) in angles.iter_mut().zip(&shape.angle) {
                row.push(*angle);
            }
        }
        let cycle = Recorded::cycle(&time, &angles).unwrap();
        assert_eq!((cycle.joints(), cycle.period_s()), (3, gait.period_s()));
        let mut found = Shape::straight(3);
        for k in 0..1000 {
            // Three periods, from before the first.
            let t = gait.period_s() * (f64::from(k) / 333.0 - 1.0);
            cycle.at(t, &mut found);
            gait.at(t, &mut shape);
            for i in 0..3 {
                assert!((found.angle[i] - shape.angle[i]).abs() < 0.5 * 3e-8, "{t}");
                assert!((found.acceleration[i] - shape.acceleration[i]).abs() < 0.5 * 1.4 * 1.4 * 1e-4, "{t}");
            }
        }
    }

    /// Derivatives of a ramp are those of its angles.
    #[test]
    fn a_ramp_begins_straight_and_has_its_own_derivatives() {
        let gait = Gait::wave(0.5, 1.4, 0.7, Envelope::Lateral);
        let ramp = Ramped { course: &gait, ramp_s: 2.0 };
        let at = |t: f64| {
            let mut shape = Shape::straight(2);
            ramp.at(t, &mut shape);
            shape
        };
        assert_eq!(at(0.0), Shape::straight(2));
        let h = 1e-4;
        for t in [0.3, 1.0, 1.7, 1.9999, 2.5] {
            let (before, here, after) = (at(t - h), at(t), at(t + h));
            for i in 0..2 {
                // Central differences: h²/6 of the third derivative.
                let rate = (after.angle[i] - before.angle[i]) / (2.0 * h);
                let second = (after.rate[i] - before.rate[i]) / (2.0 * h);
                assert!((rate - here.rate[i]).abs() < 1e-7, "{t}");
                assert!((second - here.acceleration[i]).abs() < 1e-3, "{t}");
            }
        }
    }
}
