//! The observation of one run: means over its window, its zero taken off.
//!
//! The mean counts the correlation of its samples ([`froude_fit::series`]). The zero is that of the parts at rest, on the straight line between them;
//! of one part alone it is constant.

use std::ops::Range;

use froude_fit::series::{Mean, mean, tapered};

use super::section::SteadySpec;
use super::window::{Motion, Told, Window, window_told};
use crate::error::TankError;

/// A sensor that stands at its largest or smallest reading in this part of a window is clipped …
const CLIPPED: f64 = 0.2;
/// … where at rest no reading has more than this part of the samples: one whose noise is below its step repeats itself anywhere.
const REPEATS: f64 = 0.1;

/// One run: columns of one length, time increasing.
#[derive(Debug, Clone, PartialEq)]
pub struct Run<'a> {
    /// Its name.
    pub id: &'a str,
    /// Time, s.
    pub time_s: &'a [f64],
    /// Its motion.
    pub motion: Motion<'a>,
    /// Loads of the water on the body, N or N m, by name.
    pub loads: Vec<(&'a str, &'a [f64])>,
    /// Its zero, where the log has no part at rest, by load.
    pub zero: Option<Vec<Zero>>,
}

/// A zero from elsewhere.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Zero {
    /// The reading, N or N m.
    pub value: f64,
    /// Its standard uncertainty.
    pub standard: f64,
}

/// A load of one observation.
#[derive(Debug, Clone, PartialEq)]
pub struct Load {
    /// Its name.
    pub name: String,
    /// Its value, the zero taken off, N or N m.
    pub value: f64,
    /// Standard uncertainty of that from the scatter within window and zeros.
    pub standard: f64,
    /// The mean over the window as it was read.
    pub read: Mean,
    /// The zero that was taken off.
    pub zero: f64,
    /// Change of the zero from before to after, with its standard uncertainty; `None` where there is only one.
    pub drift: Option<[f64; 2]>,
}

impl Load {
    /// A load that no sensor reads.
    #[must_use]
    pub fn stated(name: &str, value: f64) -> Self {
        let (correlation_s, effective_n, trend) = (0.0, 1.0, 0.0);
        let read = Mean { value, standard: 0.0, correlation_s, effective_n, trend, trend_standard: f64::INFINITY };
        Self { name: name.to_owned(), value, standard: 0.0, read, zero: 0.0, drift: None }
    }

    /// Whether a sensor read it.
    pub(crate) fn is_read(&self) -> bool {
        self.read.trend_standard.is_finite()
    }
}

/// One observation.
#[derive(Debug, Clone, PartialEq)]
pub struct Point {
    /// Parts of the run.
    pub window: Window,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Standard deviation of the speed within the window, m/s.
    pub speed_scatter_m_s: f64,
    /// The loads.
    pub loads: Vec<Load>,
}

impl Point {
    /// An observation of these samples, without a zero.
    #[must_use]
    pub fn stated(speed_m_s: f64, loads: Vec<Load>, used: Range<usize>) -> Self {
        let window = Window { before: used.start..used.start, after: used.end..used.end, steady: used };
        Self { window, speed_m_s, speed_scatter_m_s: 0.0, loads }
    }
}

/// Reduces a run to its observation.
///
/// # Errors
///
/// [`TankError`]: columns that do not match, no window, a clipped sensor, no zero.
pub fn point(run: &Run<'_>, spec: &SteadySpec) -> Result<Point, TankError> {
    point_told(run, spec, &Told::default())
}

/// The same without what is marked, in the windows that a person has named.
///
/// # Errors
///
/// As [`point`]; a window that holds marks, or is none.
pub fn point_told(run: &Run<'_>, spec: &SteadySpec, told: &Told<'_>) -> Result<Point, TankError> {
    let n = run.time_s.len();
    let lengths = run.loads.iter().map(|(name, values)| (*name, values.len())).chain(match run.motion {
        Motion::Speed(v) => Some(("speed", v.len())),
        Motion::Position(x) => Some(("position", x.len())),
        Motion::Stream(_) => None,
    });
    for (column, found) in lengths {
        if found != n || n < 4 {
            let what = format!("{column} has {found} samples, {} are needed", n.max(4));
            return Err(TankError::of_run(run.id, what));
        }
    }
    let window = window_told(run.id, run.time_s, run.motion, spec, told)?;
    observed(run, window, spec)
}

/// The observation of a run whose parts are known.
pub(crate) fn observed(run: &Run<'_>, window: Window, spec: &SteadySpec) -> Result<Point, TankError> {
    let loads = run.loads.iter().enumerate().map(|(l, (name, values))| load(run, &window, (l, name), values, spec));
    let loads = loads.collect::<Result<_, _>>()?;
    let speed_m_s = match run.motion {
        // As the loads are averaged.
        Motion::Speed(v) => tapered(&v[window.steady.clone()]),
        _ => run.motion.mean_m_s(run.time_s, window.steady.clone()),
    };
    let speed_scatter_m_s = match run.motion {
        Motion::Speed(v) => {
            let rows = window.steady.clone();
            let square: f64 = v[rows.clone()].iter().map(|v| (v - speed_m_s).powi(2)).sum();
            (square / rows.len() as f64).sqrt()
        }
        _ => 0.0,
    };
    Ok(Point { window, speed_m_s, speed_scatter_m_s, loads })
}

fn load(
    run: &Run<'_>,
    window: &Window,
    (l, name): (usize, &str),
    values: &[f64],
    spec: &SteadySpec,
) -> Result<Load, TankError> {
    clipped(run.id, name, values, window)?;
    let step_s = (run.time_s[values.len() - 1] - run.time_s[0]) / (values.len() - 1) as f64;
    let read = mean(&values[window.steady.clone()], step_s);
    let middle_s = |rows: &Range<usize>| 0.5 * (run.time_s[rows.start] + run.time_s[rows.end - 1]);
    let at_rest = |rows: &Range<usize>| {
        let is_long = rows.len() as f64 * step_s >= spec.block_s && rows.len() >= 4;
        is_long.then(|| (middle_s(rows), mean(&values[rows.clone()], step_s)))
    };
    let (zero, standard, drift) = match (at_rest(&window.before), at_rest(&window.after)) {
        (Some((from_s, a)), Some((to_s, b))) => {
            let part = (middle_s(&window.steady) - from_s) / (to_s - from_s);
            let standard = ((1.0 - part) * a.standard).hypot(part * b.standard);
            let drift = [b.value - a.value, a.standard.hypot(b.standard)];
            (a.value + part * (b.value - a.value), standard, Some(drift))
        }
        (Some((_, only)), None) | (None, Some((_, only))) => (only.value, only.standard, None),
        (None, None) => {
            let elsewhere = run.zero.as_ref().and_then(|zeros| zeros.get(l));
            let none = || {
                let what = format!(
                    "nothing tells the zero of the sensor: the log has no part at rest of {} s or more, and there is no run of the role \"still\" with \
                     [conditions] at = \"…\" in the folder; log some seconds at rest before each tow",
                    spec.block_s
                );
                TankError::of_run(run.id, what)
            };
            let zero = elsewhere.ok_or_else(none)?;
            (zero.value, zero.standard, None)
        }
    };
    let standard = read.standard.hypot(standard);
    Ok(Load { name: name.to_owned(), value: read.value - zero, standard, read, zero, drift })
}

/// A channel whose window stands at the largest or smallest reading of its log.
fn clipped(run: &str, name: &str, values: &[f64], window: &Window) -> Result<(), TankError> {
    let (low, high) =
        values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(*x), high.max(*x)));
    let at_rest = if window.before.is_empty() { &window.after } else { &window.before };
    // Held in a stream nothing is at rest; the window itself tells how a reading repeats that is at no end.
    let beside = if at_rest.is_empty() { &window.steady } else { at_rest };
    let mut readings: Vec<f64> = values[beside.clone()].iter().copied().filter(|x| *x != low && *x != high).collect();
    readings.sort_by(f64::total_cmp);
    let most = readings.chunk_by(|a, b| a == b).map(<[f64]>::len).max().unwrap_or(beside.len());
    if most as f64 > REPEATS * beside.len() as f64 {
        return Ok(());
    }
    let rows = &window.steady;
    for value in [low, high] {
        let part = values[rows.clone()].iter().filter(|x| **x == value).count() as f64 / rows.len() as f64;
        if part >= CLIPPED {
            let what = format!(
                "{name} saturates at {value} in {:.0} % of its steady window: the sensor is clipped; widen its range, or tow more slowly",
                1e2 * part
            );
            return Err(TankError::of_run(run, what));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A zero that moves by a line: the load is what the line does not explain.
    #[test]
    fn a_drifting_zero_is_taken_off_along_its_line() {
        let time_s: Vec<f64> = (0..1000).map(|i| 0.02 * f64::from(i)).collect();
        let speed: Vec<f64> = time_s.iter().map(|t| (0.4 * (t - 4.0)).min(0.4 * (16.0 - t)).clamp(0.0, 0.4)).collect();
        let force: Vec<f64> = time_s.iter().zip(&speed).map(|(t, v)| 0.3 + 0.01 * t - 5.0 * v * v).collect();
        let run =
            Run { id: "a", time_s: &time_s, motion: Motion::Speed(&speed), loads: vec![("f_x", &force)], zero: None };
        let found = point(&run, &SteadySpec::default()).unwrap();
        assert!((found.speed_m_s - 0.4).abs() < 1e-12);
        // Nothing but rounding: means of a line are the line at their middles.
        assert!((found.loads[0].value + 0.8).abs() < 1e-9, "{}", found.loads[0].value);
        assert!((found.loads[0].drift.unwrap()[0] - 0.01 * 16.0).abs() < 0.02);
    }

    /// Noise of 0.01 N cut at −0.6 N is clipped; read in steps of 0.05 N it repeats itself at rest too, and is none.
    #[test]
    fn a_clipped_window_is_refused_and_a_coarse_sensor_is_none() {
        let time_s: Vec<f64> = (0..1000).map(|i| 0.02 * f64::from(i)).collect();
        let speed: Vec<f64> = time_s.iter().map(|t| (0.4 * (t - 4.0)).min(0.4 * (16.0 - t)).clamp(0.0, 0.4)).collect();
        let noisy: Vec<f64> = time_s.iter().zip(&speed).map(|(t, v)| 0.01 * (977.0 * t).sin() - 5.0 * v * v).collect();
        let reduced = |force: &[f64]| {
            let run = Run {
                id: "a",
                time_s: &time_s,
                motion: Motion::Speed(&speed),
                loads: vec![("f_x", force)],
                zero: None,
            };
            point(&run, &SteadySpec::default())
        };
        let found = reduced(&noisy.iter().map(|f| f.max(-0.6)).collect::<Vec<f64>>());
        let refused = found.unwrap_err().to_string();
        assert!(refused.contains("f_x saturates at -0.6 in 100 % of its steady window"), "{refused}");
        let coarse = reduced(&noisy.iter().map(|f| (f / 0.05).round() * 0.05).collect::<Vec<f64>>()).unwrap();
        assert!((coarse.loads[0].value + 0.8).abs() < 1e-9);
    }
}
