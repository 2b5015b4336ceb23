//! Logs of more rows than are held in memory: averaged in blocks while they are read.
//!
//! An hour of eight channels at 10 kHz is 36 million rows, 2.3 GB of numbers, and the motions of a tank take seconds. Logs of more than a million
//! rows together become a quarter of a million: each block of q rows its mean, times and all channels alike ([`froude_signal::block_mean`]). Nothing
//! is delayed, what is lost of a tone is the same in every channel and stated, and white noise stays white, so that coefficients and their
//! uncertainties are those of the whole logs. All logs of a folder come to one rate, so that none gains weight on another by being shorter. Gaps,
//! uneven steps and what a sensor at the end of its range shows are told by the rows recorded.

mod ticks;

use std::path::{Path, PathBuf};

use froude_identify::method::MethodError;
use froude_records::chunks::{count_rows, for_each_chunk};
use froude_records::finding::{Finding, Severity};
use froude_records::number;
use froude_records::run::clock_jumps::{Wraps, twice};
use froude_records::run::{LogTimes, channel_name, import_run, run_of, time_column};
use froude_records::sidecar_file::sidecar_of;
use froude_records::table::{Column, ColumnData, Table};
use froude_records::units::Dimension;
use froude_records::{Place, RecordError};
use froude_signal::block_mean::{BlockMean, gain, noise_bandwidth_hz};
use indexmap::IndexMap;

use self::ticks::Ticks;
use crate::extremes::Extremes;
use crate::findings::warning;
use crate::log::{Averaged, TankLog};

/// Where the logs of a folder are too long, and what is kept of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Lengths {
    /// Most rows, of all logs together, that are read as they are.
    pub longest: usize,
    /// Rows, likewise, that longer logs are averaged to.
    pub kept: usize,
}

impl Lengths {
    /// Logs are read as they are, however long.
    pub(crate) const WHOLE: Self = Self { longest: usize::MAX, kept: 0 };
}

/// Eight channels of a million rows are 64 MB, and a reduction takes some times that; correlation times cost rows times lags.
pub(crate) const LENGTHS: Lengths = Lengths { longest: 1_000_000, kept: 250_000 };

/// How a log is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Reading {
    /// Rows that it has, as far as that is known.
    rows: usize,
    /// Rows whose mean is one; 1 for a log that is read as it is.
    block_rows: usize,
}

/// How each log of a folder is read: as it is, or by means over one time, the same for all of them.
pub(crate) fn readings(paths: &[PathBuf], lengths: Lengths) -> Vec<Reading> {
    if lengths == Lengths::WHOLE {
        return vec![Reading { rows: 0, block_rows: 1 }; paths.len()];
    }
    let rows: Vec<usize> = paths.iter().map(|path| count_rows(path).unwrap_or(0)).collect();
    let whole = |rows: &usize| Reading { rows: *rows, block_rows: 1 };
    if rows.iter().sum::<usize>() <= lengths.longest {
        return rows.iter().map(whole).collect();
    }
    let steps_s: Vec<Option<f64>> = paths.iter().map(|path| first_step_s(path)).collect();
    let length_s: f64 = rows.iter().zip(&steps_s).filter_map(|(n, step)| Some(*n as f64 * (*step)?)).sum();
    let block_s = length_s / lengths.kept as f64;
    let of = |(rows, step): (&usize, &Option<f64>)| {
        step.map_or(whole(rows), |step| Reading { rows: *rows, block_rows: (block_s / step).round().max(1.0) as usize })
    };
    rows.iter().zip(&steps_s).map(of).collect()
}

/// Median step of the first rows, s; `None` of a log that cannot be read: reading it says why.
fn first_step_s(path: &Path) -> Option<f64> {
    let mut found = None;
    // The first part is all that is asked for: what is returned ends the reading.
    let _ = for_each_chunk::<RecordError>(path, None, &mut |part| {
        let time_s = part.number("time", Dimension::TIME)?;
        let mut steps: Vec<f64> = time_s.windows(2).map(|w| w[1] - w[0]).collect();
        steps.sort_by(f64::total_cmp);
        found = steps.get(steps.len() / 2).copied().filter(|step| *step > 0.0);
        Err(RecordError::NoRows { path: path.to_owned() })
    });
    found
}

/// Loss of the fastest tone that counts, as part of its amplitude, beyond which averages are too coarse.
const MOST_LOST: f64 = 1e-3;
/// Loss up to which a tone is called kept.
const KEPT: f64 = 1e-4;

/// Reads a log through the sidecar beside it, whole or averaged.
pub(crate) fn import(path: &Path, reading: Reading, progress: &dyn Fn(&str)) -> Result<TankLog, MethodError> {
    if reading.block_rows == 1 {
        return Ok(import_run(path, None)?.into());
    }
    let jumps = sidecar_of(path, None)?.map(|sidecar| sidecar.run.declared.jumps).unwrap_or_default();
    let (mut means, mut wraps) = (Means::of(reading.block_rows), Wraps::default());
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut shown = None;
    for_each_chunk::<RecordError>(path, None, &mut |mut part| {
        wraps.undo(&mut part, jumps)?;
        means.push(&part)?;
        let percent = (100 * means.rows / reading.rows.max(1)).min(100);
        if shown.replace(percent) != Some(percent) {
            progress(&format!("reading {name}, {percent} %"));
        }
        Ok(())
    })?;
    means.finish(path)
}

/// The means of a log while it goes by.
struct Means {
    block_rows: usize,
    rows: usize,
    left_out: usize,
    ticks: Ticks,
    extremes: IndexMap<String, Extremes>,
    blocks: Vec<BlockMean>,
    /// The columns of numbers of the log, with the means so far.
    table: Option<Table>,
}

impl Means {
    fn of(block_rows: usize) -> Self {
        let (ticks, extremes) = (Ticks::default(), IndexMap::new());
        Self { block_rows, rows: 0, left_out: 0, ticks, extremes, blocks: Vec::new(), table: None }
    }

    fn push(&mut self, part: &Table) -> Result<(), RecordError> {
        let (time_s, gaps) = self.ticks.push(part)?;
        let table = self.table.get_or_insert_with(|| Table {
            columns: part.columns.iter().filter_map(empty).collect(),
            path: part.path.clone(),
            n_rows: 0,
            line_of_row: Vec::new(),
            sidecar: part.sidecar.clone(),
            left_out: part.left_out.clone(),
            understood: part.understood.clone(),
            blank: Vec::new(),
            joined: part.joined.clone(),
        });
        self.blocks.resize(table.columns.len(), BlockMean::of(self.block_rows));
        let of = |column: &&Column| matches!(column.data, ColumnData::Number { .. });
        for ((column, means), block) in part.columns.iter().filter(of).zip(&mut table.columns).zip(&mut self.blocks) {
            let (ColumnData::Number { si, .. }, ColumnData::Number { si: means, .. }) = (&column.data, &mut means.data)
            else {
                continue;
            };
            let mut from = 0;
            for &gap in &gaps {
                block.push(&si[from..gap], means);
                let left = block.leave();
                from = gap;
                if column.name == "time" {
                    self.left_out += left;
                }
            }
            block.push(&si[from..], means);
            if column.name != "time" {
                self.extremes.entry(column.name.clone()).or_default().push(time_s, si);
            }
        }
        self.rows += part.n_rows;
        Ok(())
    }

    fn finish(mut self, path: &Path) -> Result<TankLog, MethodError> {
        let Some(mut table) = self.table else { return Err(RecordError::NoRows { path: path.to_owned() }.into()) };
        self.left_out += self.blocks.first_mut().map_or(0, BlockMean::leave);
        table.n_rows = table.columns.first().map_or(0, |column| match &column.data {
            ColumnData::Number { si, .. } => si.len(),
            ColumnData::Text(_) => 0,
        });
        if table.n_rows < 2 {
            let what = format!(
                "gaps cut all blocks of {} rows that a log of {} rows is averaged in while it is read: cut it into runs, or find out why it has \
                 gaps",
                self.block_rows, self.rows
            );
            return Err(MethodError::input(path, what));
        }
        let averaged = Averaged { rows: self.rows, block_rows: self.block_rows, left_out: self.left_out };
        let sidecar = sidecar_of(&table.path, table.sidecar.as_deref())?;
        let found = self.ticks.finish(&table.path)?;
        let time_s = time_column(&table)?.to_vec();
        if let Some(row) = time_s.windows(2).position(|w| w[1] <= w[0]) {
            return Err(twice(Place::whole(path), time_s[row]).into());
        }
        let mut run = run_of(&table, sidecar.as_ref(), LogTimes { rows: 0..time_s.len(), time_s, ..found })?;
        run.log.meta.log_rate_hz /= averaged.block_rows as f64;
        let recorded = self.extremes.into_iter().map(|(name, extremes)| (channel_name(&name), extremes)).collect();
        Ok(TankLog { recorded, averaged: Some(averaged), ..run.into() })
    }
}

/// A column of numbers without them; none of text.
fn empty(column: &Column) -> Option<Column> {
    let ColumnData::Number { unit, dimension, .. } = &column.data else { return None };
    let data = ColumnData::Number { unit: unit.clone(), dimension: *dimension, si: Vec::new() };
    Some(Column { name: column.name.clone(), data })
}

/// What was done to a log that is averaged.
pub(crate) fn note(log: &TankLog) -> Option<Finding> {
    let averaged = log.averaged.as_ref()?;
    let (rate_hz, q) = (1.0 / log.steps.median_s, averaged.block_rows);
    let kept_hz = (6.0 * KEPT).sqrt() * rate_hz / (std::f64::consts::PI * q as f64);
    let left_out = match averaged.left_out {
        0 => String::new(),
        n => format!(
            "; {} of blocks that a gap or the end cuts are left out",
            froude_records::text::counted(n, "row", "rows")
        ),
    };
    let text = format!(
        "{}: {} rows at {} Hz are averaged in blocks of {q} while they are read, time and all channels alike, to {} Hz: no delay, gain above {} below \
         {} Hz, noise bandwidth {} Hz{left_out}",
        log.log.path.display(),
        number::count(averaged.rows),
        number::significant(rate_hz, 5),
        number::significant(rate_hz / q as f64, 4),
        1.0 - KEPT,
        number::significant(kept_hz, 3),
        number::significant(noise_bandwidth_hz(q, rate_hz), 3),
    );
    Some(Finding::new(Severity::Note, "log-averaged", text))
}

/// What averages leave of the fastest tone that counts; `None` of a log that is as it was recorded.
fn left(log: &TankLog, frequency_hz: f64) -> Option<f64> {
    log.averaged.as_ref().map(|averaged| gain(averaged.block_rows, 1.0 / log.steps.median_s, frequency_hz))
}

/// That averages are too coarse for a tone.
pub(crate) fn too_coarse(log: &TankLog, frequency_hz: f64) -> Option<Finding> {
    let left = left(log, frequency_hz).filter(|left| 1.0 - left > MOST_LOST)?;
    let text = format!(
        "{}: the averages that the log is read in leave {left:.4} of what moves at {frequency_hz:.2} Hz, in every channel; cut the log into shorter runs",
        log.log.path.display()
    );
    Some(warning("averages-too-coarse", text))
}

/// The step as a record states it, of the logs that were averaged; `frequencies_hz` is the fastest tone that counts in each.
pub(crate) fn step(logs: &[TankLog], frequencies_hz: &[f64]) -> Option<String> {
    let of = |(log, hz): (&TankLog, &f64)| Some((log.averaged.as_ref()?.block_rows, left(log, *hz)?));
    let all: Vec<(usize, f64)> = logs.iter().zip(frequencies_hz).filter_map(of).collect();
    let (fewest, most) = (all.iter().map(|a| a.0).min()?, all.iter().map(|a| a.0).max()?);
    let least = all.iter().map(|a| a.1).fold(f64::INFINITY, f64::min);
    let rows = if fewest == most { format!("{most}") } else { format!("{fewest} to {most}") };
    Some(format!(
        "{} of {} averaged in blocks of {rows} rows while read (no delay; gain at the highest harmonic {least:.6}, the same in every channel)",
        all.len(),
        froude_records::text::counted(logs.len(), "log", "logs")
    ))
}
