//! The times of a log as they go by, in bounded memory: whether they increase, how even their steps are, where ticks are missing.

use std::path::Path;

use froude_records::finding::Severity;
use froude_records::run::clock_jumps::{clock_back, twice};
use froude_records::run::stamps::{GAP, LACKS, usual_step_s};
use froude_records::run::{EVEN, Gap, LogTimes, Missing, TimeSteps, gap, median, steps_finding, time_column};
use froude_records::table::Table;
use froude_records::{Place, RecordError};

/// Steps that the median is taken of: every one of a shorter log, evenly spread ones of a longer.
const MOST_STEPS: usize = 1 << 16;
/// Gaps beyond which a log is no longer one with gaps.
const MOST_GAPS: usize = 10_000;

/// What is known of the times that went by.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ticks {
    first_s: f64,
    last_s: Option<f64>,
    /// Usual step of the first rows: what gaps are told by while the log goes by.
    usual_s: Option<f64>,
    shortest_s: f64,
    longest_s: f64,
    /// The shortest that is longer than nothing, and the longest that lacks no samples.
    least_s: f64,
    longest_whole_s: f64,
    missing: Missing,
    /// The first row with the time of the row before.
    equal: Option<(Place, f64)>,
    /// How many rows repeat the stamp of the one before: a few are logged twice, many are rounded.
    n_equal: usize,
    steps: usize,
    /// Every so many steps one is kept.
    every: usize,
    kept: Vec<f64>,
    long: Vec<[f64; 2]>,
}

impl Default for Ticks {
    fn default() -> Self {
        Self {
            first_s: 0.0,
            last_s: None,
            usual_s: None,
            shortest_s: f64::INFINITY,
            longest_s: 0.0,
            least_s: f64::INFINITY,
            longest_whole_s: 0.0,
            missing: Missing::default(),
            equal: None,
            n_equal: 0,
            steps: 0,
            every: 1,
            kept: Vec::new(),
            long: Vec::new(),
        }
    }
}

impl Ticks {
    /// Takes the times of a part of the log in. Returns them, and the rows before which ticks are missing.
    ///
    /// # Errors
    ///
    /// A time column that is missing or goes back; more gaps than a log has.
    pub(crate) fn push<'t>(&mut self, part: &'t Table) -> Result<(&'t [f64], Vec<usize>), RecordError> {
        let time_s = time_column(part)?;
        if self.usual_s.is_none() && time_s.len() > 1 {
            self.usual_s = usual_step_s(time_s);
            self.first_s = time_s[0];
        }
        self.missing.samples += time_s.len();
        let mut gaps = Vec::new();
        for (row, &now) in time_s.iter().enumerate() {
            let Some(before) = self.last_s.replace(now) else { continue };
            if now < before {
                return Err(clock_back(part.place_of_row(row), before, now, self.usual_s.unwrap_or(0.0)));
            }
            let step_s = now - before;
            if step_s == 0.0 {
                self.n_equal += 1;
                self.equal.get_or_insert_with(|| (part.place_of_row(row), now));
            } else {
                self.least_s = self.least_s.min(step_s);
            }
            match self.usual_s.map(|usual| step_s / usual) {
                Some(steps) if steps > GAP => {
                    gaps.push(row);
                    self.long.push([before, now]);
                }
                Some(steps) if steps > LACKS => self.missing.add((steps.round() as usize).saturating_sub(1)),
                _ => self.longest_whole_s = self.longest_whole_s.max(step_s),
            }
            (self.shortest_s, self.longest_s) = (self.shortest_s.min(step_s), self.longest_s.max(step_s));
            if self.steps.is_multiple_of(self.every) {
                self.kept.push(step_s);
            }
            self.steps += 1;
            if self.kept.len() == MOST_STEPS {
                self.kept = self.kept.iter().copied().step_by(2).collect();
                self.every *= 2;
            }
        }
        if self.long.len() > MOST_GAPS {
            let problem = format!(
                "steps by more than {GAP} of its usual {:.6} ms at {} places; a log of so many rows is averaged in blocks while it is read, and \
                 needs even steps: resample it, or cut it into runs",
                1e3 * self.usual_s.unwrap_or(f64::NAN),
                self.long.len()
            );
            return Err(RecordError::value(Place::whole(&part.path), "time", problem));
        }
        Ok((time_s, gaps))
    }

    /// The steps, and where ticks are missing; rows and times are left to the caller.
    ///
    /// # Errors
    ///
    /// Steps that are not those of the first rows: what lies between would be averaged over unequal times. Equal times that no rounding explains.
    pub(crate) fn finish(mut self, path: &Path) -> Result<LogTimes, RecordError> {
        let refuse = |problem: String| RecordError::value(Place::whole(path), "time", problem);
        let (Some(median_s), Some(usual_s)) = (median(&mut self.kept.clone()), self.usual_s) else {
            return Err(refuse("has one value; a log needs two ticks at least".to_owned()));
        };
        let mean_s = (self.last_s.unwrap_or(self.first_s) - self.first_s) / self.steps.max(1) as f64;
        if let Some((place, time_s)) =
            self.equal.take().filter(|_| mean_s > (1.0 + EVEN) * self.least_s || self.n_equal < self.steps / 50)
        {
            return Err(twice(place, time_s));
        }
        self.kept.retain(|step| *step <= LACKS * usual_s);
        let later_s = self.kept.iter().sum::<f64>() / self.kept.len().max(1) as f64;
        if (later_s / usual_s - 1.0).abs() > EVEN {
            return Err(refuse(format!(
                "steps by {:.6} ms at first and by {:.6} ms in the mean of all; a log of so many rows is averaged in blocks while it is read, and \
                 needs one rate: cut it into runs where the rate changes",
                1e3 * usual_s,
                1e3 * later_s
            )));
        }
        let steps = TimeSteps { median_s, shortest_s: self.shortest_s, longest_s: self.longest_s };
        let lost: Vec<Gap> = self.long.into_iter().map(|[from_s, to_s]| gap(from_s, to_s, usual_s)).collect();
        let off_s = (self.longest_whole_s - usual_s).max(usual_s - self.shortest_s);
        let words =
            "blocks have the mean of their times and of all channels alike, so that no step is assumed to be even";
        let even = (off_s > EVEN * usual_s).then(|| (Severity::Note, words.to_owned()));
        let findings = vec![steps_finding(steps, even, &self.missing, &lost, &path.display().to_string())];
        Ok(LogTimes { steps, lost, findings, ..LogTimes::default() })
    }
}

#[cfg(test)]
mod tests {
    use froude_records::run::run_of_table;
    use froude_records::table::{Column, ColumnData};
    use froude_records::units::{Dimension, Unit};

    use super::*;

    fn table(time_s: &[f64], first_row: usize) -> Table {
        Table::of(
            "a.parquet".into(),
            vec![Column {
                name: "time".to_owned(),
                data: ColumnData::Number {
                    unit: Unit::si(Dimension::TIME),
                    dimension: Dimension::TIME,
                    si: time_s.to_vec(),
                },
            }],
            (first_row + 1..=first_row + time_s.len()).collect(),
        )
    }

    fn through(time_s: &[f64]) -> Result<(TimeSteps, Vec<Gap>, Vec<usize>), RecordError> {
        let (mut ticks, mut rows) = (Ticks::default(), Vec::new());
        for (k, part) in time_s.chunks(1000).enumerate() {
            let gaps = ticks.push(&table(part, 1000 * k))?.1;
            rows.extend(gaps.iter().map(|row| 1000 * k + row));
        }
        let LogTimes { steps, lost, .. } = ticks.finish(Path::new("a.parquet"))?;
        Ok((steps, lost, rows))
    }

    /// Two gaps, one of them between chunks; steps jitter by a tenth of a per mille.
    #[test]
    fn steps_and_gaps_are_those_of_the_log_in_memory() {
        let time: Vec<f64> = (0..9_000)
            .filter(|i| !(500..510).contains(i) && !(1006..1030).contains(i) && *i != 4000)
            .map(|i| 1e-4 * (f64::from(i) + 1e-4 * f64::from(i * 7 % 11)))
            .collect();
        let whole = run_of_table(&table(&time, 0), None).unwrap();
        let (steps, lost, rows) = through(&time).unwrap();
        assert_eq!((steps, &lost), (whole.steps, &whole.log.lost));
        assert_eq!((lost.len(), rows), (2, vec![500, 996]));
        assert_eq!(lost.iter().filter_map(|gap| gap.ticks).sum::<u64>(), 34, "one missing tick is no gap");
    }

    #[test]
    fn what_goes_back_is_named_by_its_row_across_chunks() {
        let mut time: Vec<f64> = (0..3_000).map(f64::from).collect();
        time[2000] = 1999.0;
        let error = through(&time).unwrap_err().to_string();
        assert_eq!(error, run_of_table(&table(&time, 0), None).unwrap_err().to_string());
        assert!(error.contains("row 2001"), "{error}");
    }

    #[test]
    fn a_rate_that_changes_is_refused_and_the_median_of_a_long_log_is_kept_in_little() {
        let time: Vec<f64> = (0..4_000).map(|i| f64::from(i) + f64::from((i - 1000).max(0)) * 0.2).collect();
        let error = through(&time).unwrap_err().to_string();
        assert!(error.contains("1000.000000 ms at first and by 1149.9"), "{error}");
        let time: Vec<f64> = (0..300_000).map(|i| f64::from(i) * 0.25).collect();
        let mut ticks = Ticks::default();
        ticks.push(&table(&time, 0)).unwrap();
        assert!(ticks.kept.len() < MOST_STEPS && ticks.every == 8, "{}", ticks.every);
        let often: Vec<f64> = (0..30_000).map(|i| f64::from(i) + 20.0 * f64::from(i / 2)).collect();
        assert!(through(&often).unwrap_err().to_string().contains("at 10"), "gaps after every second row");
    }
}
