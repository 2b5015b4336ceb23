//! The ends of what a channel reads, and how long it stands there: what tells a sensor at the end of its range from a motion at its turn.

/// A sensor that stands at its extreme this many times as long as a smooth motion would is clipped, …
const CLIPPED: f64 = 3.0;
/// … from so many samples on.
const FEWEST_CLIPPED: usize = 5;
/// A load may stand this many times as long as the flattest one of inertia and drag: noise and the samples about its ends.
const CLIPPED_LOAD: f64 = 1.3;

/// What a channel reads of a body that oscillates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Oscillating {
    /// Its motion, a sine: about its peak it stays within one step q for (1/π)√(2q/A) of its period, where A is its amplitude.
    Motion,
    /// Its load, a cos θ + b sin θ|sin θ| of inertia and drag. It has next to no curvature at its top where a ≈ 2b: with c = a/2b < 1 it lies
    /// b(cos θ − c)² below its largest value b(1 + c²) for 0 ≤ θ ≤ π, so that it stays within one step for (1/π)(2q/A)^¼ of its period at most,
    /// where b(1 − c)² = q.
    Load,
}

/// A stretch of equal samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stay {
    /// Their value.
    pub value: f64,
    /// How many there are.
    pub samples: usize,
    /// Time of the first, s.
    pub from_s: f64,
}

/// What is known of the extremes of a channel while its samples go by.
#[derive(Debug, Clone, PartialEq)]
pub struct Extremes {
    /// The longest stays at the smallest and at the largest value.
    longest: [Option<Stay>; 2],
    /// The stay that goes on.
    now: Option<Stay>,
    /// Smallest step between neighbours that is none of zero.
    step: f64,
    first_s: f64,
    last_s: f64,
    samples: usize,
}

impl Default for Extremes {
    fn default() -> Self {
        Self { longest: [None; 2], now: None, step: f64::INFINITY, first_s: f64::NAN, last_s: f64::NAN, samples: 0 }
    }
}

impl Extremes {
    /// Of a whole channel.
    #[must_use]
    pub fn of(time_s: &[f64], values: &[f64]) -> Self {
        let mut out = Self::default();
        out.push(time_s, values);
        out
    }

    /// Takes samples in.
    pub fn push(&mut self, time_s: &[f64], values: &[f64]) {
        for (&time_s, &value) in time_s.iter().zip(values) {
            self.now = Some(match self.now {
                Some(now) if now.value == value => Stay { samples: now.samples + 1, ..now },
                before => {
                    self.step = before.map_or(self.step, |before| self.step.min((value - before.value).abs()));
                    Stay { value, samples: 1, from_s: time_s }
                }
            });
            let Some(now) = self.now else { continue };
            let [low, high] = &mut self.longest;
            if low.is_none_or(|low| now.value < low.value || now.value == low.value && now.samples > low.samples) {
                *low = Some(now);
            }
            if high.is_none_or(|high| now.value > high.value || now.value == high.value && now.samples > high.samples) {
                *high = Some(now);
            }
            if self.samples == 0 {
                self.first_s = time_s;
            }
            self.last_s = time_s;
            self.samples += 1;
        }
    }

    /// The same with another origin of time.
    pub fn shift(&mut self, by_s: f64) {
        self.first_s += by_s;
        self.last_s += by_s;
        for stay in self.longest.iter_mut().chain([&mut self.now]).flatten() {
            stay.from_s += by_s;
        }
    }

    /// A stay at the smallest or largest value that is longer than a smooth channel of that period and resolution would stay there.
    #[must_use]
    pub fn clipped(&self, period_s: f64, channel: Oscillating) -> Option<Stay> {
        let [low, high] = self.longest;
        let amplitude = 0.5 * (high?.value - low?.value);
        if amplitude.is_nan() || amplitude <= 0.0 {
            return None;
        }
        let rate_hz = (self.samples - 1) as f64 / (self.last_s - self.first_s);
        let sine = (2.0 * (self.step / amplitude).min(1.0)).sqrt();
        let samples = |part: f64| (period_s * rate_hz * part / std::f64::consts::PI).max(1.0);
        let longest = match channel {
            Oscillating::Motion => CLIPPED * samples(sine),
            Oscillating::Load => (CLIPPED * samples(sine)).max(CLIPPED_LOAD * samples(sine.sqrt())),
        };
        let is_long = |stay: &Stay| stay.samples >= FEWEST_CLIPPED && stay.samples as f64 > longest;
        [low, high].into_iter().flatten().find(is_long)
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use super::Oscillating::{Load, Motion};
    use super::*;

    fn cut(level: f64, noise: f64) -> (Vec<f64>, Vec<f64>) {
        let time: Vec<f64> = (0..5_000).map(|i| f64::from(i) * 0.01).collect();
        let value = |(i, t): (usize, &f64)| ((TAU * 0.2 * t).sin() + noise * f64::from((i * 7 % 11) as u8)).min(level);
        let values = time.iter().enumerate().map(value).collect();
        (time, values)
    }

    #[test]
    fn a_sine_that_is_cut_off_is_clipped_and_one_that_turns_is_not() {
        let (time, values) = cut(0.9, 1e-3);
        let stay = Extremes::of(&time, &values).clipped(5.0, Motion).unwrap();
        // sin > 0.9 for 2·arccos(0.9)/2π = 0.1436 of 5 s, 72 samples; what the noise lifts, from 0.89 on, makes it 76 at most.
        assert_eq!(stay.value, 0.9);
        assert!((71..=76).contains(&stay.samples), "{stay:?}");
        assert!((stay.from_s % 5.0 - 0.89).abs() < 0.02, "{stay:?}");
        let (time, values) = cut(2.0, 1e-3);
        assert_eq!(Extremes::of(&time, &values).clipped(5.0, Motion), None);
        // A coarse sensor stays at its last step as long as the motion does.
        let steps: Vec<f64> = values.iter().map(|x| (x * 20.0).round() / 20.0).collect();
        assert_eq!(Extremes::of(&time, &steps).clipped(5.0, Motion), None);
    }

    #[test]
    fn a_load_of_inertia_and_drag_is_not_clipped_however_flat_its_top_is() {
        let time: Vec<f64> = (0..5_000).map(|i| f64::from(i) * 0.01).collect();
        let mut were_called_clipped = 0;
        for (inertia, steps) in
            (0..=400).flat_map(|i| [50.0, 100.0, 200.0, 1_000.0].map(|steps| (f64::from(i) * 0.01, steps)))
        {
            let load = |t: &f64| {
                let (sin, cos) = (TAU * 0.2 * t).sin_cos();
                let largest = if inertia < 2.0 { 1.0 + 0.25 * inertia.powi(2) } else { inertia };
                ((inertia * cos + sin * sin.abs()) / largest * steps).round() / steps
            };
            let values: Vec<f64> = time.iter().map(load).collect();
            assert_eq!(Extremes::of(&time, &values).clipped(5.0, Load), None, "{inertia} {steps}");
            were_called_clipped += usize::from(Extremes::of(&time, &values).clipped(5.0, Motion).is_some());
            let cut: Vec<f64> = values.iter().map(|x| x.min(0.75)).collect();
            assert!(Extremes::of(&time, &cut).clipped(5.0, Load).is_some(), "cut: {inertia} {steps}");
        }
        assert!(were_called_clipped > 0);
    }

    #[test]
    fn chunks_are_the_whole_and_a_new_extreme_begins_anew() {
        let (time, values) = cut(0.9, 1e-3);
        let mut parts = Extremes::default();
        for (t, x) in time.chunks(37).zip(values.chunks(37)) {
            parts.push(t, x);
        }
        assert_eq!(parts, Extremes::of(&time, &values));
        let time: Vec<f64> = (0..40).map(f64::from).collect();
        let mut values = vec![1.0; 40];
        values[0] = 0.0;
        values[39] = 2.0;
        assert_eq!(Extremes::of(&time, &values).longest[1], Some(Stay { value: 2.0, samples: 1, from_s: 39.0 }));
        assert_eq!(Extremes::of(&time, &[3.0; 40]).clipped(5.0, Motion), None);
    }
}
