//! A case in time: for bodies that shed vortices, and as a spot check of steady ones.
//!
//! Steps are of one length, backward differences of second order. What is before the start of the statistics is the flow's own beginning and is left out.

use std::path::Path;

use crate::attempt::{Attempt, How, SolveError};
use crate::case::Case;
use crate::foam_system::Pace;
use crate::history::{self, Sample};
use crate::window::Window;

/// How a case goes through time, s.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Times {
    /// Length of a step.
    pub step_s: f64,
    /// From when on the flow counts.
    pub from_s: f64,
    /// When it ends.
    pub to_s: f64,
}

/// What a case in time came to.
#[derive(Debug, Clone, PartialEq)]
pub struct InTime {
    /// Loads of all steps.
    pub samples: Vec<Sample>,
    /// Means over the time that counts, with their standard deviations.
    pub window: Window,
    /// Frequency of the force across the inflow within the plane xy, Hz; `None` of fewer than two periods.
    pub frequency_hz: Option<f64>,
    /// Time of processors, s.
    pub cpu_s: f64,
}

/// Solves a case in time, in an empty folder as [`solve`](crate::solve::solve) does.
///
/// # Errors
///
/// [`SolveError`]; also where the solver did not reach the end.
pub fn solve_in_time(
    case: &Case,
    times: Times,
    mesh: &Path,
    start_from: Option<&Path>,
    folder: &Path,
    how: &How,
) -> Result<InTime, SolveError> {
    let pace = Pace::Transient { step_s: times.step_s };
    let steps = (times.to_s / times.step_s).round() as usize;
    let attempt = Attempt::begin(case, mesh, start_from, folder, how, pace, steps)?;
    let log = attempt.run_until(times.to_s)?;
    let samples = history::read(folder, case.is_half)?;
    let counted: Vec<Sample> = samples.iter().copied().filter(|sample| sample.time >= times.from_s).collect();
    let (sin, cos) = case.flow.angle_rad.sin_cos();
    let across = |sample: &Sample| {
        let [x, y, ..] = sample.total();
        (sample.time, y * cos + x * sin)
    };
    Ok(InTime {
        window: Window::of(&counted, counted.len()),
        frequency_hz: frequency_hz(&counted.iter().map(across).collect::<Vec<_>>()),
        cpu_s: log.cpu_s * how.ranks as f64,
        samples,
    })
}

/// Of a series of times and values: one over the mean time between its upward crossings of its mean.
fn frequency_hz(series: &[(f64, f64)]) -> Option<f64> {
    let mean = series.iter().map(|(_, value)| value).sum::<f64>() / series.len() as f64;
    let crossings: Vec<f64> = series
        .windows(2)
        .filter(|pair| pair[0].1 < mean && pair[1].1 >= mean)
        .map(|pair| {
            let ((t0, y0), (t1, y1)) = (pair[0], pair[1]);
            t0 + (t1 - t0) * (mean - y0) / (y1 - y0)
        })
        .collect();
    let (first, last) = (crossings.first()?, crossings.last()?);
    (crossings.len() > 2).then(|| (crossings.len() - 1) as f64 / (last - first))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frequency_is_that_of_the_crossings_of_the_mean() {
        let wave = |hz: f64| -> Vec<(f64, f64)> {
            (0..1000).map(|i| f64::from(i) * 0.01).map(|t| (t, 3.0 + (std::f64::consts::TAU * hz * t).sin())).collect()
        };
        let found = frequency_hz(&wave(1.37)).unwrap();
        assert!((found - 1.37).abs() < 2e-3, "{found}");
        assert_eq!(frequency_hz(&wave(0.15)), None);
        assert_eq!(frequency_hz(&[]), None);
    }
}
