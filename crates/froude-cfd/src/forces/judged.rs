//! The mean loads of a case: judged over a window at its end, as those of `froude cfd` are.
//!
//! The window begins as the last quarter of the case, and is doubled up to its half while the forces drift ([`crate::judge`]). What is before it, the start
//! of the flow, is left out. Limits are parts of the case's mean force, as no area need be known.

use crate::case::Stop;
use crate::history::Sample;
use crate::judge::{Standing, largest, standing};
use crate::outcome::{Loads, Status};
use crate::window::Window;

/// Fewest samples that are judged.
const MIN_SAMPLES: usize = 20;
/// Most samples that are judged: longer series are thinned evenly, as the correlation of neighbours is summed pair by pair.
const MAX_SAMPLES: usize = 8_000;
/// Largest change of the mean force from one half of the window to the other, of the mean force.
pub(super) const DRIFT: f64 = 0.005;
/// Largest distance of a force from its mean within the window, likewise; beyond it the case oscillates.
const SPREAD: f64 = 0.01;
/// Steps may differ by this part before samples are taken at even times.
const EVEN: f64 = 1e-3;

/// A case as it was judged.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Judged {
    pub(super) status: Status,
    pub(super) window: Window,
    /// Times that the window begins and ends at.
    pub(super) span: [f64; 2],
    /// Time of the first sample.
    pub(super) begins: f64,
}

/// Loads in time, at even steps.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Even {
    samples: Vec<Sample>,
    /// Rows that they are made of.
    pub(super) rows: usize,
    /// Whether the steps were uneven, and the samples are means over even stretches.
    pub(super) is_resampled: bool,
}

impl Even {
    /// Mean of the last quarter.
    pub(super) fn late_mean(&self) -> Loads {
        Window::of(&self.samples, (self.samples.len() / 4).max(1)).mean
    }
}

/// Judges loads in time; `lever_m` is the length that moments are compared with forces by, `window` the length asked for, in the time of the samples.
///
/// # Errors
///
/// Why they have no mean.
pub(super) fn judged(even: &Even, lever_m: f64, window: Option<f64>) -> Result<Judged, String> {
    let samples = even.samples.as_slice();
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return Err("its force files have no rows yet".to_owned());
    };
    if samples.len() < MIN_SAMPLES {
        return Err(format!(
            "has {} rows; {MIN_SAMPLES} are needed to judge whether the loads are steady",
            samples.len()
        ));
    }
    let step = (last.time - first.time) / (samples.len() - 1) as f64;
    let length = match window {
        None => samples.len() / 4,
        Some(length) => {
            let (rows, whole) = ((length / step).round(), last.time - first.time);
            if rows < 4.0 || length > 0.5 * whole {
                return Err(format!(
                    "`window` is {length}, and the case lasts {whole} in steps of {step:.3e}: a window takes four steps at least, and half of the case at most"
                ));
            }
            rows as usize
        }
    };
    let force = norm(&Window::of(samples, length).mean);
    if force == 0.0 {
        return Err("its mean force is zero".to_owned());
    }
    let moment = if lever_m > 0.0 { force * lever_m } else { f64::INFINITY };
    let scales: Loads = [force, force, force, moment, moment, moment];
    let stop = Stop { iterations: samples.len(), window: length, drift: DRIFT, spread: SPREAD };
    let (standing, window) = standing(stop, &scales, samples);
    let status = match standing {
        Standing::Still => Status::Converged,
        Standing::Swings => Status::Oscillating,
        Standing::Drifts => {
            return Err(format!(
                "its mean load still changes by {:.2} % of its force from one half of the window to the other (limit {:.1} %): run the case longer",
                100.0 * largest(&scales, &window.drift, &|_| true),
                100.0 * DRIFT
            ));
        }
    };
    let begin = samples.get(samples.len() - window.length).map_or(first.time, |sample| sample.time);
    Ok(Judged { status, window, span: [begin, last.time], begins: first.time })
}

/// Largest of the three forces.
pub(super) fn norm(loads: &Loads) -> f64 {
    loads[..3].iter().map(|f| f * f).sum::<f64>().sqrt()
}

/// Samples at even times: as they are where they are so already and few enough, else means over even stretches. Means of loads are those over time, and a solver that adapts its step has more samples where it is shorter.
///
/// # Errors
///
/// A load that is not finite.
pub(super) fn even(samples: Vec<Sample>) -> Result<Even, String> {
    if let Some(sample) = samples.iter().find(|sample| !sample.total().iter().all(|load| load.is_finite())) {
        return Err(format!("its loads are not finite at the time {}", sample.time));
    }
    let rows = samples.len();
    let (Some(first), Some(last)) = (samples.first(), samples.last()) else {
        return Ok(Even { samples, rows, is_resampled: false });
    };
    let mean_step = (last.time - first.time) / (rows - 1).max(1) as f64;
    let is_even = samples.windows(2).all(|pair| ((pair[1].time - pair[0].time) / mean_step - 1.0).abs() < EVEN);
    if is_even && rows <= MAX_SAMPLES {
        return Ok(Even { samples, rows, is_resampled: false });
    }
    // Means over stretches of one length each, of straight lines between the samples: they have the mean over time exactly.
    let count = rows.min(MAX_SAMPLES);
    let length = (last.time - first.time) / count as f64;
    let (mut even, mut at, mut before) = (Vec::with_capacity(count), 0, [0.0; 6]);
    let mut passed = [0.0; 6];
    for i in 0..count {
        let end = first.time + length * (i + 1) as f64;
        while let (Some(a), Some(b)) = (samples.get(at), samples.get(at + 1))
            && b.time <= end
            && at + 2 < rows
        {
            let (own, next) = (a.total(), b.total());
            passed = std::array::from_fn(|k| passed[k] + 0.5 * (b.time - a.time) * (own[k] + next[k]));
            at += 1;
        }
        let (Some(a), Some(b)) = (samples.get(at), samples.get(at + 1)) else { break };
        let (own, next, since) = (a.total(), b.total(), end - a.time);
        let part = since / (b.time - a.time);
        let until: Loads = std::array::from_fn(|k| passed[k] + since * (own[k] + 0.5 * part * (next[k] - own[k])));
        let mean = std::array::from_fn(|k| (until[k] - before[k]) / length);
        even.push(Sample { time: end - 0.5 * length, pressure: mean, viscous: [0.0; 6] });
        before = until;
    }
    Ok(Even { samples: even, rows, is_resampled: !is_even })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn series(count: usize, time: impl Fn(f64) -> f64, force: impl Fn(f64) -> f64) -> Vec<Sample> {
        let sample = |i: usize| {
            let time = time(i as f64);
            Sample { time, pressure: [force(time), 0.0, 0.0, 0.0, 0.0, 0.0], viscous: [0.0; 6] }
        };
        (1..=count).map(sample).collect()
    }

    fn judged(samples: Vec<Sample>, window: Option<f64>) -> Result<Judged, String> {
        super::judged(&even(samples)?, 0.0, window)
    }

    #[test]
    fn the_start_of_the_flow_is_left_out_and_the_window_said() {
        let settling = |t: f64| -5.0 * (1.0 + 0.4 * (-t / 2.5).exp() * (t / 0.9).cos());
        let found = judged(series(200, |i| 0.1 * i, settling), None).unwrap();
        assert_eq!(found.status, Status::Converged);
        assert!((found.window.mean[0] + 5.0).abs() < 2.0 * found.window.std_of_mean[0] + 1e-12, "{found:?}");
        assert!(found.window.std_of_mean[0] < 0.01);
        assert!((found.span[0] - 15.1).abs() < 1e-9 && (found.span[1] - 20.0).abs() < 1e-9);
    }

    #[test]
    fn what_still_drifts_or_is_short_has_no_mean() {
        let of = |samples: Vec<Sample>| judged(samples, None).unwrap_err();
        let ramp = of(series(200, |i| i, |t| 1.0 + 0.01 * t));
        assert!(ramp.starts_with("its mean load still changes by ") && ramp.ends_with("run the case longer"), "{ramp}");
        assert!(of(series(19, |i| i, |_| 1.0)).starts_with("has 19 rows; 20 are needed"));
        assert_eq!(of(Vec::new()), "its force files have no rows yet");
        assert_eq!(of(series(50, |i| i, |_| 0.0)), "its mean force is zero");
        assert_eq!(
            of(series(50, |i| i, |t| if t == 7.0 { f64::NAN } else { 1.0 })),
            "its loads are not finite at the time 7"
        );
        let long = judged(series(200, |i| i, |_| 1.0), Some(150.0)).unwrap_err();
        assert!(long.starts_with("`window` is 150, and the case lasts 199"), "{long}");
    }

    #[test]
    fn steps_that_a_solver_adapts_weigh_by_their_length() {
        // Steps of 0.01 s where the force is 2 N, of 0.09 s where it is 1 N: the mean over time is not that over rows.
        let mut samples = Vec::new();
        let mut time = 0.0;
        for _ in 0..400 {
            for (step, force) in [(0.005, 2.0), (0.005, 2.0), (0.045, 1.0), (0.045, 1.0)] {
                time += step;
                samples.push(Sample { time, pressure: [force, 0.0, 0.0, 0.0, 0.0, 0.0], viscous: [0.0; 6] });
            }
        }
        assert!(even(samples.clone()).unwrap().is_resampled);
        let found = judged(samples, None).unwrap();
        assert_eq!(found.status, Status::Oscillating);
        assert!((found.window.mean[0] - 1.3).abs() < 0.01, "{}", found.window.mean[0]);
    }
}
