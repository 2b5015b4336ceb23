//! Stamps as times of the log: other clocks, delays, and what a causal filter delays.
//!
//! A sample stamped t by a clock with offset o, skew s and origin t₀, late by d and behind a filter of phase delay d_f, is of the log's time
//!
//! t + o + s (t − t₀) − d − d_f(f).
//!
//! f is the frequency of the motion where the method is one of a periodic motion, else 0. Channels whose stamps moved are read at the rows of the log by a
//! cubic spline; rows for which one of them has no data are cut off, never extrapolated.

use crate::names::{ACCELERATED_TOW, STEADY, WEIGHT_TOW};
use froude_identify::method::MethodError;
use froude_records::number::{percent, plain, significant};
use froude_records::run::LOG;
use froude_records::run::clocks::{Clock, is_own};
use froude_records::run::marks::SegmentKind;
use froude_records::run::sensor::Filter;
use froude_records::run::step::Step;
use froude_records::text::counted;
use froude_signal::analogue::Analogue;
use froude_signal::harmonic::Harmonics;
use froude_signal::resample::Spline;
use indexmap::IndexMap;

use super::stretches::keep_rows;
use crate::extremes::Extremes;
use crate::findings::warning;
use crate::log::TankLog;

/// Methods whose motion is not periodic.
const APERIODIC: [&str; 3] = [STEADY, WEIGHT_TOW, ACCELERATED_TOW];
/// Channels that show the motion, the first that is there.
const MOTION: [&str; 6] = ["reference", "sway", "angle", "position", "y/position", "heave"];
/// A filter that takes more than this part of the signal is said.
const TAKES: f64 = 0.01;
/// Fewest rows that are left.
const FEWEST: usize = 4;

/// Stamps of the channels whose samples are not of the log's own times, by channel.
pub type Stamps = IndexMap<String, Vec<f64>>;

/// The frequency of the motion, Hz; 0 where it has none.
fn frequency_hz(run: &TankLog, method: &str) -> f64 {
    if APERIODIC.contains(&method) {
        return 0.0;
    }
    let motion = MOTION.iter().find_map(|name| run.log.channels.get(*name));
    let fit = motion.and_then(|channel| Harmonics::fit(&run.log.time_s, &channel.values, 1, None).ok());
    fit.map_or(0.0, |fit| fit.omega_rad_s / std::f64::consts::TAU)
}

/// The times of the log that the samples of each channel are of, where those are not its rows, and how that was found as steps.
pub fn stamps(run: &mut TankLog, method: &str) -> Stamps {
    let has_filter = run.told.values().any(|told| told.sensor.filter.is_some());
    let signal_hz = if has_filter { frequency_hz(run, method) } else { 0.0 };
    let (mut out, mut steps, mut findings) = (Stamps::new(), Vec::new(), Vec::new());
    for (name, told) in &mut run.told {
        let Some(channel) = run.log.channels.get_mut(name) else { continue };
        let clock = run.declared.clocks.get(&channel.meaning.clock).filter(|_| !is_own(&channel.meaning.clock));
        let mut late_s = 0.0;
        if let Some(clock) = clock {
            let words = format!(
                "clock {}: {} ms and {} ms/s from {} s on are added to its stamps, standard uncertainty {} ms; found {}",
                channel.meaning.clock,
                plain(1e3 * clock.offset_s, 6),
                plain(1e3 * clock.skew, 6),
                plain(clock.origin_s, 6),
                significant(1e3 * clock.standard_s, 2),
                clock.found
            );
            let step =
                Step::new("clock", name, words).with("offset", clock.offset_s, "s").with("skew", clock.skew, "1");
            steps.push(step.with("origin", clock.origin_s, "s").with("standard_uncertainty", clock.standard_s, "s"));
            told.time_standard_s = told.time_standard_s.hypot(clock.standard_s);
            LOG.clone_into(&mut channel.meaning.clock);
        }
        if let Some(delay) = told.sensor.delay_s {
            let words = format!("{} ms are taken off its stamps", plain(1e3 * delay.value, 6));
            let step = Step::new("delay", name, words).with("delay", delay.value, "s");
            steps.push(step.with("standard_uncertainty", delay.standard_uncertainty, "s"));
            told.time_standard_s = told.time_standard_s.hypot(delay.standard_uncertainty);
            late_s += delay.value;
        }
        if let Some(filter) = told.sensor.filter {
            let done = filtered(filter, signal_hz);
            let gain = done.gain;
            steps.push(Step { channel: name.clone(), ..done.step });
            late_s += done.delay_s;
            if (1.0 - gain).abs() > TAKES {
                let text = format!(
                    "{}: the filter of {name} passes {} of its amplitude at the {} Hz that it is used at, and that is not repaired; filter higher, or count it in [[source.uncertainty]]",
                    run.log.path.display(),
                    percent(gain),
                    plain(signal_hz, 4)
                );
                findings.push(warning("filter-at-the-signal", text));
            }
        }
        if clock.is_some() || late_s != 0.0 {
            let on_log = |t: f64, clock: &Clock| t + clock.offset_s + clock.skew * (t - clock.origin_s);
            let at = |t: &f64| clock.map_or(*t, |clock| on_log(*t, clock)) - late_s;
            out.insert(name.clone(), run.log.time_s.iter().map(at).collect());
        }
    }
    run.done.extend(steps);
    run.findings.extend(findings);
    out
}

/// What a filter did.
struct Filtered {
    step: Step,
    delay_s: f64,
    gain: f64,
}

fn filtered(filter: Filter, signal_hz: f64) -> Filtered {
    let (analogue, is_causal, kind) = match filter {
        Filter::Butterworth { order, corner_hz, is_causal } => {
            let kind = format!("Butterworth of order {order}, corner {} Hz", plain(corner_hz, 6));
            (Analogue::Butterworth { order, corner_hz }, is_causal, kind)
        }
        Filter::MovingAverage { length_s, is_causal } => {
            (Analogue::MovingAverage { length_s }, is_causal, format!("mean over {} ms", plain(1e3 * length_s, 6)))
        }
    };
    // A centred mean is one pass; a Butterworth filter without phase is two.
    let passes = if !is_causal && matches!(analogue, Analogue::Butterworth { .. }) { 2 } else { 1 };
    let gain = analogue.gain(signal_hz).powi(passes as i32);
    let (bandwidth_hz, delay_s) =
        (analogue.noise_bandwidth_hz(passes), if is_causal { analogue.delay_s(signal_hz) } else { 0.0 });
    let delayed = if is_causal {
        format!("{} ms that it delays there are taken off the stamps", significant(1e3 * delay_s, 4))
    } else {
        "without phase".to_owned()
    };
    let words = format!(
        "filtered before the log: {kind}; at {} Hz its gain is {}; {delayed}; noise bandwidth {} Hz",
        plain(signal_hz, 4),
        plain(gain, 6),
        significant(bandwidth_hz, 4)
    );
    let step = Step::new("filter", "", words).with("signal", signal_hz, "Hz").with("gain", gain, "1");
    let step = step.with("delay", delay_s, "s").with("noise_bandwidth", bandwidth_hz, "Hz");
    let step = match filter {
        Filter::Butterworth { order, corner_hz, .. } => {
            step.with("order", order as f64, "1").with("corner", corner_hz, "Hz")
        }
        Filter::MovingAverage { length_s, .. } => step.with("length", length_s, "s"),
    };
    Filtered { step, delay_s, gain }
}

/// Reads the channels whose stamps moved at the rows of the log; rows without data of one of them are cut.
///
/// # Errors
///
/// Fewer than four rows are left, or stamps that no spline can be drawn through.
pub fn resample(run: &mut TankLog, stamps: &Stamps) -> Result<(), MethodError> {
    if stamps.is_empty() {
        return Ok(());
    }
    let time_s = &run.log.time_s;
    let (mut from_s, mut to_s) = (f64::NEG_INFINITY, f64::INFINITY);
    for stamps in stamps.values() {
        from_s = from_s.max(stamps.first().copied().unwrap_or(f64::INFINITY));
        to_s = to_s.min(stamps.last().copied().unwrap_or(f64::NEG_INFINITY));
    }
    let rows = time_s.partition_point(|t| *t < from_s)..time_s.partition_point(|t| *t <= to_s);
    if rows.len() < FEWEST {
        let names: Vec<&str> = stamps.keys().map(String::as_str).collect();
        return Err(MethodError::input(
            &run.log.path,
            format!(
                "clocks that cannot be aligned: as its sidecar states clocks, delays and filters of {}, these have data from {from_s:.3} s to {to_s:.3} s of the log's time, and the log goes \
                 from {:.3} s to {:.3} s; check offset and skew in [clocks]",
                names.join(", "),
                time_s.first().copied().unwrap_or(f64::NAN),
                time_s.last().copied().unwrap_or(f64::NAN)
            ),
        ));
    }
    let test = run.declared.segments.iter().find(|segment| segment.kind == SegmentKind::Test);
    let used_s = test.map_or([from_s, to_s], |test| [from_s.max(test.from_s), to_s.min(test.to_s)]);
    let mut done = Vec::new();
    for (name, stamps) in stamps {
        let Some(channel) = run.log.channels.get_mut(name) else { continue };
        let refuse = |why: String| {
            MethodError::input(&run.log.path, format!("{name} cannot be read at the rows of the log: {why}"))
        };
        let spline = Spline::through(stamps, &channel.values).map_err(|e| refuse(e.to_string()))?;
        // Of the part that is used alone: a rig that is parked before the test is at no sensor's end.
        let used = stamps.partition_point(|t| *t < used_s[0])..stamps.partition_point(|t| *t <= used_s[1]);
        let extremes = || Extremes::of(&stamps[used.clone()], &channel.values[used.clone()]);
        run.recorded.entry(name.clone()).or_insert_with(extremes);
        // What is outside is cut below; its value does not matter.
        let values: Vec<f64> =
            time_s.iter().zip(&channel.values).map(|(t, old)| spline.at(*t).unwrap_or(*old)).collect();
        channel.values = values;
        done.push(Step::new("resampled", name, "at the rows of the log, by a cubic spline"));
    }
    let n = time_s.len();
    if rows.len() < n {
        let (first, last) = (rows.start, n - rows.end);
        let words = format!(
            "{} at the beginning and {} at the end are cut, where a channel of another clock, or one that is stamped late, has no data",
            counted(first, "row", "rows"),
            counted(last, "row", "rows")
        );
        done.push(Step::new("cut", "", words).with("beginning", first as f64, "1").with("end", last as f64, "1"));
        keep_rows(&mut run.log, rows);
    }
    run.done.extend(done);
    Ok(())
}
