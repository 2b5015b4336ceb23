//! Force sensor method: the mean over the steady window less the sensor's zero.
//!
//! The zero is the mean of the still windows before and after the tow, a straight line in time between them. A drift
//! need not be straight: any curve that does not turn back lies between the two zeros, so that the line may be wrong by up
//! to half their difference, taken as rectangular. Without one of them the declared drift stands in for that difference.

use froude_fit::series::mean;

use super::run::{DragRun, Window};
use super::steady::{Rejected, SteadySettings, settled_window, still_windows};
use crate::drag::point::Point;

/// The steady point of a run with a force column.
///
/// `drift_half_width_n` is the declared half-width of the sensor's drift.
///
/// # Errors
///
/// [`Rejected`] without a usable window or zero.
pub fn point(run: &DragRun<'_>, drift_half_width_n: f64, settings: SteadySettings) -> Result<Point, Rejected> {
    let no_zero = || {
        Rejected::Unusable(format!(
            "run {:?}: no still window of {:.2} s before or after the tow to take the sensor's zero from",
            run.id, settings.shortest_s
        ))
    };
    let sensed = run.force_n.ok_or_else(no_zero)?;
    let zero = Zero::of(run, sensed, drift_half_width_n, settings).ok_or_else(no_zero)?;
    let force: Vec<f64> = sensed.iter().zip(run.time_s).map(|(f, t)| f - zero.at_n(*t)).collect();
    let window = settled_window(run, &force, 2.0 * zero.half_n, settings)?;
    let steady = mean(window.of(&force), run.step_s());
    let zero_variance = zero.variance_n2(centre_s(run, window));
    let point = Point::of(run, window, &steady, 1.0);
    Ok(Point {
        standard_n: (steady.standard.powi(2) + zero_variance).sqrt(),
        trend_n: point.trend_n.filter(|trend_n| trend_n.abs() > 2.0 * zero.half_n),
        ..point
    })
}

/// The sensor's zero as a straight line in time.
struct Zero {
    start_s: f64,
    start_n: f64,
    slope_n_s: f64,
    /// How far the line may be wrong, half-width, N.
    half_n: f64,
    /// Standard uncertainties of the zeros before and after, N, and the time between them, s.
    ends: (f64, f64, f64),
}

impl Zero {
    fn of(run: &DragRun<'_>, sensed: &[f64], drift_half_width_n: f64, settings: SteadySettings) -> Option<Self> {
        let at = |w: Window| (centre_s(run, w), mean(w.of(sensed), run.step_s()));
        match still_windows(run, settings).map(|w| w.map(at)) {
            [Some((t0, before)), Some((t1, after))] => {
                let change = after.value - before.value;
                Some(Self {
                    start_s: t0,
                    start_n: before.value,
                    slope_n_s: change / (t1 - t0),
                    half_n: 0.5 * change.abs(),
                    ends: (before.standard, after.standard, t1 - t0),
                })
            }
            [Some((t, one)), None] | [None, Some((t, one))] => Some(Self {
                start_s: t,
                start_n: one.value,
                slope_n_s: 0.0,
                half_n: drift_half_width_n,
                ends: (one.standard, one.standard, f64::INFINITY),
            }),
            [None, None] => None,
        }
    }

    fn at_n(&self, time_s: f64) -> f64 {
        self.start_n + self.slope_n_s * (time_s - self.start_s)
    }

    fn variance_n2(&self, time_s: f64) -> f64 {
        let (before, after, between_s) = self.ends;
        let late = (time_s - self.start_s) / between_s;
        ((1.0 - late) * before).powi(2) + (late * after).powi(2) + self.half_n * self.half_n / 3.0
    }
}

/// Time of the middle of a window, s.
fn centre_s(run: &DragRun<'_>, window: Window) -> f64 {
    0.5 * (run.time_s[window.first] + run.time_s[window.end - 1])
}
