//! What was recorded of an axis.

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

/// One record, columns of equal length.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ServoLog {
    /// Time, s, equidistant.
    pub time_s: Vec<f64>,
    /// Measured position along the chain, m, unfiltered.
    pub position_m: Vec<f64>,
    /// Command to the drive, V.
    pub command_v: Vec<f64>,
}

impl ServoLog {
    /// Checks lengths and steps; returns the sampling rate, Hz.
    ///
    /// # Errors
    ///
    /// [`ServoError::Length`], [`ServoError::Uneven`], [`ServoError::TooFewRows`], [`ServoError::Setting`] for a rate that no record has.
    pub fn rate_hz(&self) -> Result<f64, ServoError> {
        let n = self.time_s.len();
        if n < 3 {
            return Err(ServoError::TooFewRows { rows: n, needed: 3 });
        }
        for (column, values) in [("position", &self.position_m), ("command", &self.command_v)] {
            if values.len() != n {
                return Err(ServoError::Length { column, found: values.len(), expected: n });
            }
        }
        let mean_s = (self.time_s[n - 1] - self.time_s[0]) / (n - 1) as f64;
        for pair in self.time_s.windows(2) {
            let step_s = pair[1] - pair[0];
            if !is_even(step_s, mean_s) {
                return Err(ServoError::Uneven { time_s: pair[0], step_s, mean_s });
            }
        }
        rate_of(mean_s)
    }

    /// The samples of a range.
    #[must_use]
    pub fn part(&self, rows: std::ops::Range<usize>) -> Self {
        let of = |column: &Vec<f64>| column[rows.clone()].to_vec();
        Self { time_s: of(&self.time_s), position_m: of(&self.position_m), command_v: of(&self.command_v) }
    }
}
