//! Whether the releases can be what their units say: a column of degrees under `[rad]` swings and decays all the same.
//!
//! Frequency and damping ratio do not depend on the unit of the position, quadratic damping and every stated amplitude do. So a swing that few bodies
//! make is asked about:
//!
//! | swing       | asked about where                                                   | what that looks like           |
//! |-------------|---------------------------------------------------------------------|--------------------------------|
//! | a rotation  | above 90°, or below 1°                                              | degrees as rad, rad as degrees |
//! | along       | above 1 m, below 1 mm, or with an acceleration above that of gravity | mm or pixels as m, m as mm    |
//! | the time    | in whole numbers one after the other                                | numbers of frames as seconds   |
//! |             | with a period below 5 ms                                            | days, or seconds under `[ms]`  |
//!
//! Not found: cm under `[mm]`, mm under `[cm]` of a slow body, and pixels that come out between.

use std::f64::consts::{FRAC_PI_2, TAU};

use froude_identify::method::MethodError;

use super::run::{DecayRun, DecaySetup};
use crate::log::TankLog;

/// Least swing of a rotation that nobody is asked about, rad; most and least of a translation, m.
const LEAST_RAD: f64 = 0.017_453;
const ALONG_M: [f64; 2] = [1e-3, 1.0];
/// Bodies that are released in water swing at some 10 Hz at most; below a twentieth of that period, s, the unit of the time is asked about.
const LEAST_PERIOD_S: f64 = 5e-3;
/// m/s².
const GRAVITY: f64 = 9.81;
/// What was seen and what was logged agree within this factor.
const AGREE: f64 = 2.0;

/// Refuses releases whose size or time is unusual and that nobody confirmed, and those that differ from what somebody saw.
pub(super) fn check(
    logs: &[TankLog],
    runs: &[DecayRun<'_>],
    setup: &DecaySetup,
    period_s: f64,
) -> Result<(), MethodError> {
    let swing = |run: &DecayRun<'_>| {
        let ends = run.position.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(*x), b.max(*x)]);
        0.5 * (ends[1] - ends[0])
    };
    let largest = logs.iter().zip(runs.iter().map(swing)).max_by(|a, b| a.1.total_cmp(&b.1));
    let Some((log, swing)) = largest.filter(|(_, swing)| *swing > 0.0) else { return Ok(()) };
    let refused = |log: &TankLog, what: String| Err(MethodError::input(&log.log.path, what));
    let is_angle = setup.axis.is_rotation();
    let shown =
        |x: f64| if is_angle { format!("{} deg", rounded(x.to_degrees())) } else { format!("{} m", rounded(x)) };
    let [seen, seen_s] = setup.window.seen;
    let apart = |seen: f64, found: f64| !(1.0 / AGREE..=AGREE).contains(&(found / seen));
    let sidecar = if is_angle {
        "state the unit of the column: `angle [rad]` or `angle [deg]` as its header, or unit = \"rad\" in a sidecar"
    } else {
        "state the unit of the column: `position [mm]` as its header, for example, or unit = \"mm\" in a sidecar"
    };
    // First: a wrong unit of time also makes an absurd acceleration.
    if seen_s.is_none() && period_s < LEAST_PERIOD_S {
        let what = format!(
            "the period comes out as {period_s:.1e} s, too short for a body in water. The times are probably in a larger unit than stated: seconds under a header in ms, or MATLAB's datenum, which counts days (multiply by 86400); if the period is right, write period = \"{period_s:e} s\" in [source.decay]"
        );
        return refused(&logs[0], what);
    }
    match (seen, doubt(swing, is_angle, period_s)) {
        (Some(seen), _) if apart(seen, swing) => {
            let [declared, found] = [seen, swing].map(shown);
            return refused(
                log,
                format!("amplitude = \"{declared}\" is declared, and the logs swing by {found} at most: {sidecar}"),
            );
        }
        (None, Some(why)) => {
            let found = shown(swing);
            return refused(
                log,
                format!(
                    "the largest swing is {found}{why}. If the unit is another one, {sidecar}; if the body really swung that far, write amplitude = \"{found}\" in [source.decay]"
                ),
            );
        }
        _ => {}
    }
    if let Some(seen_s) = seen_s.filter(|seen_s| apart(*seen_s, period_s)) {
        let what = format!(
            "period = \"{seen_s:.4} s\" is declared, and the logs swing with {period_s:.4} s: state the unit of the time, `time [ms]` as its header, for example"
        );
        return refused(log, what);
    }
    let is_counted = |run: &DecayRun<'_>| {
        let is_whole = run.time_s.iter().all(|t| t.fract() == 0.0);
        is_whole && run.time_s.windows(2).any(|w| (w[1] - w[0] - 1.0).abs() < 1e-9)
    };
    match logs.iter().zip(runs).find(|(_, run)| seen_s.is_none() && is_counted(run)) {
        Some((log, _)) => refused(
            log,
            format!(
                "the times are whole numbers one after the other, as numbers of frames are, and the period comes out as {period_s:.4} s. If they count frames, divide them by the \
                 frame rate; if they are seconds, write period = \"{period_s:.3} s\" in [source.decay]"
            ),
        ),
        None => Ok(()),
    }
}

/// Three digits, and no power of ten that a campaign cannot read.
fn rounded(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}

/// Why a swing is unusual, in words after its size.
fn doubt(swing: f64, is_angle: bool, period_s: f64) -> Option<String> {
    if is_angle {
        // A log may be in either unit.
        let (deg, what) = if swing > FRAC_PI_2 {
            (swing, "degrees under a header in rad")
        } else if swing < LEAST_RAD {
            (swing.to_degrees().to_degrees(), "radians under a header in deg")
        } else {
            return None;
        };
        return Some(format!(" ({} deg if these are {what})", rounded(deg)));
    }
    let times_g = swing * (TAU / period_s).powi(2) / GRAVITY;
    if times_g > 1.0 {
        Some(format!(", with a period of {period_s:.3} s an acceleration of {times_g:.1} times that of gravity"))
    } else if !(ALONG_M[0]..=ALONG_M[1]).contains(&swing) {
        Some(String::new())
    } else {
        None
    }
}
