//! What was recorded of an axis.

use std::ops::Range;

use froude_records::number::{percent, plain};
use froude_records::run::stamps::{LACKS, parts, usual_step_s};
use froude_records::text::counted;
use froude_signal::resample::Spline;

use crate::servo::error::ServoError;

/// A step may differ from the mean by this part: time stamps are written with few digits, filters want equal steps.
const UNEVEN: f64 = 0.01;

/// Rates that a record can have, Hz: what is beyond them counts no samples.
const RATES_HZ: [f64; 2] = [1e-3, 1e7];

/// Whether a step is the mean one, but for the digits of the clock.
pub(crate) fn is_even(step_s: f64, mean_s: f64) -> bool {
    (step_s - mean_s).abs() <= UNEVEN * mean_s
}

/// Rate of a mean step, Hz.
///
/// # Errors
///
/// [`ServoError::Setting`] for a rate that no record has.
pub(crate) fn rate_of(mean_s: f64) -> Result<f64, ServoError> {
    let rate_hz = mean_s.recip();
    let [least, most] = RATES_HZ;
    if !(least..=most).contains(&rate_hz) {
        let must = "samples are between a thousandth and ten million a second: check the unit of time";
        return Err(ServoError::Setting { what: "rate of the record (Hz)", found: rate_hz, must });
    }
    Ok(rate_hz)
}

/// Fewest samples of a stretch between gaps.
const FEWEST: usize = 8;

/// A log in stretches of even steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Evenly {
    /// The stretches, in order; all of one rate.
    pub stretches: Vec<Stretch>,
    /// That rate, Hz.
    pub rate_hz: f64,
    /// What was done for it; `None` for a log that is even and whole.
    pub done: Option<String>,
}

/// A stretch of even steps.
#[derive(Debug, Clone, PartialEq)]
pub struct Stretch {
    /// Its samples at even times.
    pub log: ServoLog,
    /// Times and commands as they were recorded; `None` where these are the even ones.
    recorded: Option<[Vec<f64>; 2]>,
}

/// The command of a stretch some time before each sample.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Command {
    /// By straight lines between the recorded ones, V.
    pub value_v: Vec<f64>,
    /// Slope of these lines, V/s.
    pub slope_v_s: Vec<f64>,
    /// 1 where the line spans missing samples, or begins before the record; else 0.
    pub is_missing: Vec<f64>,
}

impl Stretch {
    /// The command `late_s` before each sample; a held command (zero-order hold) acts half a step late on average.
    pub(crate) fn command(&self, late_s: f64) -> Command {
        let [times, commands] = match &self.recorded {
            Some([times, commands]) => [times.as_slice(), commands.as_slice()],
            None => [self.log.time_s.as_slice(), self.log.command_v.as_slice()],
        };
        let longest_s = LACKS * usual_step_s(times).unwrap_or(f64::INFINITY);
        let mut out = Command::default();
        let mut after = 1;
        for t in &self.log.time_s {
            let t = t - late_s;
            while after + 1 < times.len() && times[after] < t {
                after += 1;
            }
            let [a, b] = [times[after - 1], times[after]];
            let [u, w] = [commands[after - 1], commands[after]];
            let slope = (w - u) / (b - a);
            // Times are rounded: an end is not beyond itself.
            let is_within = (a - UNEVEN * (b - a)..=b + UNEVEN * (b - a)).contains(&t);
            out.value_v.push(u + slope * (t.clamp(a, b) - a));
            out.slope_v_s.push(slope);
            out.is_missing.push(f64::from(u8::from(b - a > longest_s || !is_within)));
        }
        out
    }
}

/// One record, columns of equal length.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ServoLog {
    /// Time, s, increasing.
    pub time_s: Vec<f64>,
    /// Measured position along the chain, m, unfiltered.
    pub position_m: Vec<f64>,
    /// Command to the drive, V.
    pub command_v: Vec<f64>,
}

impl ServoLog {
    /// Checks lengths and that steps are even; returns the sampling rate, Hz.
    ///
    /// # Errors
    ///
    /// [`ServoError::Length`], [`ServoError::Uneven`], [`ServoError::TooFewRows`], [`ServoError::Setting`] for a rate that no record has.
    pub fn rate_hz(&self) -> Result<f64, ServoError> {
        let n = self.checked_len()?;
        let mean_s = (self.time_s[n - 1] - self.time_s[0]) / (n - 1) as f64;
        for pair in self.time_s.windows(2) {
            let step_s = pair[1] - pair[0];
            if !is_even(step_s, mean_s) {
                return Err(ServoError::Uneven { time_s: pair[0], step_s, mean_s });
            }
        }
        rate_of(mean_s)
    }

    fn checked_len(&self) -> Result<usize, ServoError> {
        let n = self.time_s.len();
        if n < 3 {
            return Err(ServoError::TooFewRows { rows: n, needed: 3 });
        }
        for (column, values) in [("position", &self.position_m), ("command", &self.command_v)] {
            if values.len() != n {
                return Err(ServoError::Length { column, found: values.len(), expected: n });
            }
        }
        Ok(n)
    }

    /// The log as stretches of even steps: it is cut at its gaps, and where steps are uneven or samples missing, the position is read at even times by a cubic
    /// spline, and the command is kept as it was recorded.
    ///
    /// # Errors
    ///
    /// [`ServoError::Length`], [`ServoError::TooFewRows`], [`ServoError::Setting`] for a rate that no record has.
    pub fn evenly(&self) -> Result<Evenly, ServoError> {
        self.checked_len()?;
        let step_s = usual_step_s(&self.time_s).unwrap_or(f64::NAN);
        let rate_hz = rate_of(step_s)?;
        let parts = parts(&self.time_s);
        let gaps = parts.len().saturating_sub(1);
        let (mut stretches, mut put, mut short) = (Vec::new(), 0, 0);
        for rows in parts {
            let part = self.part(rows.clone());
            if part.time_s.windows(2).all(|w| is_even(w[1] - w[0], step_s)) && rows.len() >= FEWEST {
                stretches.push(Stretch { log: part, recorded: None });
            } else if rows.len() >= FEWEST {
                let even = part.at_even_times(step_s)?;
                put += even.time_s.len().saturating_sub(part.on_time(step_s));
                stretches.push(Stretch { log: even, recorded: Some([part.time_s, part.command_v]) });
            } else {
                short += rows.len();
            }
        }
        let samples = stretches.iter().map(|part| part.log.time_s.len()).sum::<usize>();
        let mut done = Vec::new();
        if put > 0 {
            done.push(format!(
                "the position is read at even times {} ms apart by a cubic spline, {put} of {samples} samples ({}) are interpolated; the command is used \
                 as recorded, and no row is made where it is missing",
                plain(1e3 * step_s, 6),
                percent(put as f64 / samples.max(1) as f64)
            ));
        }
        if gaps > 0 {
            done.push(format!("the log is cut at {}: no filter runs across them", counted(gaps, "gap", "gaps")));
        }
        if short > 0 {
            done.push(format!("{} between gaps are too few for a filter and left out", counted(short, "row", "rows")));
        }
        if stretches.is_empty() {
            return Err(ServoError::TooFewRows { rows: 0, needed: FEWEST });
        }
        Ok(Evenly { stretches, rate_hz, done: (!done.is_empty()).then(|| done.join("; ")) })
    }

    /// Samples that lie at even times from the first on.
    fn on_time(&self, step_s: f64) -> usize {
        let start_s = self.time_s.first().copied().unwrap_or(0.0);
        let is_on = |t: &&f64| {
            let ticks = (**t - start_s) / step_s;
            (ticks - ticks.round()).abs() <= UNEVEN
        };
        self.time_s.iter().filter(is_on).count()
    }

    fn at_even_times(&self, step_s: f64) -> Result<Self, ServoError> {
        let position = Spline::through(self.time_s.as_slice(), self.position_m.as_slice())?;
        let (start_s, end_s) = (self.time_s[0], self.time_s[self.time_s.len() - 1]);
        let count = ((end_s - start_s) / step_s + UNEVEN).floor() as usize;
        let time_s: Vec<f64> = (0..=count).map(|k| (start_s + k as f64 * step_s).min(end_s)).collect();
        let command = |t: f64| {
            let after = self.time_s.partition_point(|s| *s <= t).clamp(1, self.time_s.len() - 1);
            let (a, b) = (self.time_s[after - 1], self.time_s[after]);
            let part = ((t - a) / (b - a)).clamp(0.0, 1.0);
            (1.0 - part) * self.command_v[after - 1] + part * self.command_v[after]
        };
        Ok(Self {
            position_m: time_s.iter().map(|t| position.at(*t).unwrap_or(f64::NAN)).collect(),
            command_v: time_s.iter().map(|t| command(*t)).collect(),
            time_s,
        })
    }

    /// The samples of a range.
    #[must_use]
    pub fn part(&self, rows: Range<usize>) -> Self {
        let of = |column: &Vec<f64>| column[rows.clone()].to_vec();
        Self { time_s: of(&self.time_s), position_m: of(&self.position_m), command_v: of(&self.command_v) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn log(keep: impl Fn(u32) -> bool, late: impl Fn(u32) -> f64) -> ServoLog {
        let time_s: Vec<f64> = (0..4000).filter(|i| keep(*i)).map(|i| 5e-3 * f64::from(i) + late(i)).collect();
        let of = |f: &dyn Fn(f64) -> f64| time_s.iter().map(|t| f(*t)).collect();
        ServoLog { position_m: of(&|t| 0.2 * (2.0 * t).sin()), command_v: of(&|t| (2.0 * t).cos()), time_s }
    }

    /// One sample in thirty missing, and stamps that jitter by a tenth of a step: the spline is off by (2π h/T)⁴/48 of 0.2 m per missing sample and less, and a line
    /// by (ω h)²/2 of 1 V.
    #[test]
    fn missing_and_jittering_samples_are_read_at_even_times() {
        let log = log(|i| i % 30 != 7, |i| 5e-4 * f64::from(i * 7 % 11) / 11.0);
        let even = log.evenly().unwrap();
        let [stretch] = even.stretches.as_slice() else { panic!("one stretch") };
        let part = &stretch.log;
        assert!((even.rate_hz - 200.0).abs() < 0.1, "{}", even.rate_hz);
        assert!(part.rate_hz().is_ok());
        // Two even times for each missing sample lie on a line that spans it, or one where it lies on a sample.
        let missing = stretch.command(0.0).is_missing.iter().sum::<f64>();
        assert!((133.0..=2.0 * 134.0).contains(&missing), "{missing}");
        for ((t, x), u) in part.time_s.iter().zip(&part.position_m).zip(&part.command_v) {
            assert!((x - 0.2 * (2.0 * t).sin()).abs() < 1e-7, "{t}: {x}");
            assert!((u - (2.0 * t).cos()).abs() < 1e-4, "{t}: {u}");
        }
        let done = even.done.unwrap();
        assert!(
            done.starts_with("the position is read at even times 5.0")
                && done.ends_with("no row is made where it is missing"),
            "{done}"
        );
    }

    #[test]
    fn a_log_is_cut_at_its_gaps_and_an_even_one_is_left_as_it_is() {
        let whole = log(|_| true, |_| 0.0);
        let even = whole.evenly().unwrap();
        assert_eq!(even.stretches.iter().map(|part| &part.log).collect::<Vec<_>>(), [&whole]);
        assert_eq!(even.done, None);
        let cut = log(|i| !(1000..1400).contains(&i) && !(1404..1600).contains(&i), |_| 0.0).evenly().unwrap();
        assert_eq!(cut.stretches.iter().map(|part| part.log.time_s.len()).collect::<Vec<_>>(), [1000, 2400]);
        assert_eq!(
            cut.done.unwrap(),
            "the log is cut at 2 gaps: no filter runs across them; 4 rows between gaps are too few for a filter and left out"
        );
    }
}
