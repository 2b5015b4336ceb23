//! How closely the carriage followed its reference while it held a speed: the paper's Table III.
//!
//! Errors are reference less measured, positive where the carriage lags behind in its direction of motion. A speed is taken from positions over 0.1 s; the mean over a window is
//! the change of the position error by the time. (The paper does not say whether its means are signed. A step of its encoder in one period of 4 kHz is 9.9 mm/s, so that means of
//! absolute velocity errors could not be as small as 0.02 mm/s.)
//!
//! **Source.** The towing-carriage paper, Table III. **Units.** m, m/s.

use super::run::{BodyState, DragRun, RunKind};
use super::steady::{SteadySettings, window};

/// Time over which a speed is taken from positions, s.
const SPAN_S: f64 = 0.1;
/// Speeds this close, as a part, are one.
const SAME: f64 = 1e-6;

/// Steady speed, mean position error and mean velocity error of the paper's Table III: m/s, m, m/s.
const PAPER: [[f64; 3]; 6] = [
    [0.05, 0.336e-3, 0.0169e-3],
    [0.15, 0.581e-3, 0.069e-3],
    [0.25, 0.817e-3, 0.0987e-3],
    [0.35, 1.8e-3, 0.038e-3],
    [0.45, 1.9e-3, 0.0163e-3],
    [0.55, 3.9e-3, 0.0231e-3],
];

/// Mean, standard deviation about it and largest size of an error over the windows of some runs.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Error {
    /// Mean, signed.
    pub mean: f64,
    /// Standard deviation of the samples about the mean.
    pub std: f64,
    /// Largest absolute value.
    pub largest: f64,
}

impl Error {
    fn of(samples: &[f64]) -> Self {
        let n = samples.len().max(1) as f64;
        let mean = samples.iter().sum::<f64>() / n;
        let std = (samples.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / n).sqrt();
        Self { mean, std, largest: samples.iter().fold(0.0, |most, x| x.abs().max(most)) }
    }
}

/// The errors at one speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tracking {
    /// Commanded speed, m/s.
    pub speed_m_s: f64,
    /// What hung on the strut.
    pub body: BodyState,
    /// Runs out and back.
    pub runs: usize,
    /// Position error, m.
    pub position_m: Error,
    /// Velocity error, m/s.
    pub velocity_m_s: Error,
}

impl Tracking {
    /// Mean position and velocity errors that the paper prints for this speed, m and m/s.
    #[must_use]
    pub fn of_the_paper(&self) -> Option<[f64; 2]> {
        let row = PAPER.iter().find(|row| (row[0] - self.speed_m_s).abs() <= SAME)?;
        Some([row[1], row[2]])
    }
}

/// Errors of the tows by speed and body, from each run and its reference positions, m; runs without a steady window are left out.
#[must_use]
pub fn tracking<'a>(runs: impl IntoIterator<Item = (&'a DragRun<'a>, &'a [f64])>) -> Vec<Tracking> {
    let mut cells: Vec<(f64, BodyState, usize, [Vec<f64>; 2])> = Vec::new();
    for (run, reference_m) in runs {
        let Ok(held) = window(run, SteadySettings::default()) else { continue };
        if run.kind != RunKind::Tow || reference_m.len() != run.position_m.len() {
            continue;
        }
        let pairs = held.of(reference_m).iter().zip(held.of(run.position_m));
        let position: Vec<f64> = pairs.map(|(asked, is)| run.direction * (asked - is)).collect();
        if position.len() < 2 {
            continue;
        }
        let span = run.samples(SPAN_S).clamp(1, position.len() - 1);
        let span_s = span as f64 * run.step_s();
        let velocity = position.iter().zip(&position[span..]).map(|(before, after)| (after - before) / span_s);
        let is_same = |cell: &&mut (f64, BodyState, usize, [Vec<f64>; 2])| {
            cell.1 == run.body && (cell.0 - run.target_speed_m_s).abs() <= SAME * run.target_speed_m_s
        };
        match cells.iter_mut().find(is_same) {
            Some((.., runs, [positions, velocities])) => {
                *runs += 1;
                velocities.extend(velocity);
                positions.extend(position);
            }
            None => cells.push((run.target_speed_m_s, run.body, 1, [position.clone(), velocity.collect()])),
        }
    }
    cells.sort_by(|a, b| a.0.total_cmp(&b.0).then((a.1 as u8).cmp(&(b.1 as u8))));
    let errors = |(speed_m_s, body, runs, [position, velocity]): (f64, BodyState, usize, [Vec<f64>; 2])| Tracking {
        speed_m_s,
        body,
        runs,
        position_m: Error::of(&position),
        velocity_m_s: Error::of(&velocity),
    };
    cells.into_iter().map(errors).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A run that lags by 1.8 mm and falls behind by 0.1 mm/s more, out and back.
    #[test]
    fn the_errors_of_a_lag_that_grows_are_those_of_its_middle() {
        let n = 4001;
        let time_s: Vec<f64> = (0..n).map(|i| 1e-3 * f64::from(i)).collect();
        for direction in [1.0, -1.0] {
            let reference_m: Vec<f64> = time_s.iter().map(|t| direction * 0.35 * t).collect();
            let position_m: Vec<f64> =
                time_s.iter().zip(&reference_m).map(|(t, y)| y - direction * (1.6e-3 + 1e-4 * t)).collect();
            let speed = vec![direction * 0.35; time_s.len()];
            let run = DragRun {
                id: "a",
                time_s: &time_s,
                position_m: &position_m,
                reference_speed_m_s: &speed,
                command_v: &speed,
                held: None,
                force_n: None,
                kind: RunKind::Tow,
                body: BodyState::Wet,
                target_speed_m_s: 0.35,
                direction,
                pair: 0,
                is_ballasted: true,
                hung_weight_n: None,
            };
            let [found] = tracking([(&run, reference_m.as_slice())]).try_into().unwrap();
            // The window is from 0.5 to 3.95 s.
            assert!((found.position_m.mean - (1.6e-3 + 1e-4 * 2.225)).abs() < 1e-9, "{found:?}");
            assert!((found.position_m.largest - (1.6e-3 + 1e-4 * 3.95)).abs() < 1e-6, "{found:?}");
            assert!((found.velocity_m_s.mean - 1e-4).abs() < 1e-9 && found.velocity_m_s.std < 1e-9, "{found:?}");
            assert_eq!(found.of_the_paper(), Some([1.8e-3, 0.038e-3]));
        }
    }
}
