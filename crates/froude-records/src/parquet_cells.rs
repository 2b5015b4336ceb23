//! The cells of a column of a Parquet file, by its type.

use std::cell::Cell;
use std::path::Path;

use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{ByteArray, DataType, Int96};
use parquet::errors::ParquetError;

use crate::assemble::Room;
use crate::error::{Place, RecordError};
use crate::memory;
use crate::parquet_types::{CellType, TimeUnit};
use crate::raw_column::Raw;

/// Julian day of 1970-01-01.
const JULIAN_DAY_OF_1970: i128 = 2_440_588;

const NS_PER_DAY: i128 = 86_400_000_000_000;

/// Cells that are empty where a table may have such: the column's name and the row from 0.
pub(crate) type Blanks = Option<Vec<(String, usize)>>;

/// Some rows of one column.
pub(crate) struct Cells<'a> {
    pub path: &'a Path,
    /// Its header, for messages.
    pub column: &'a str,
    pub kind: CellType,
    /// The unit in which times are wanted.
    pub time_unit: TimeUnit,
    /// The first timestamp of the table, ns since 1970.
    pub origin_ns: &'a Cell<Option<i128>>,
    /// The column's name where its cells may be empty.
    pub may_be_blank: Option<&'a str>,
    /// What to do about an empty cell.
    pub advice: &'a dyn Fn() -> String,
    pub first_row: usize,
    pub n_rows: usize,
}

impl Cells<'_> {
    fn place(&self, row: usize) -> Place {
        Place::row(self.path, self.first_row + row)
    }

    fn damaged(&self, reason: String) -> RecordError {
        RecordError::Damaged { path: self.path.to_owned(), reason }
    }

    /// Reads them behind what is there.
    pub fn read(
        &self,
        column: &mut ColumnReader,
        raw: &mut Raw,
        blanks: &mut Blanks,
        room: &mut Room<'_>,
    ) -> Result<(), RecordError> {
        use CellType as T;
        use ColumnReader as C;
        match (column, raw, self.kind) {
            (C::DoubleColumnReader(c), Raw::Numbers(out), T::Number) => self.numbers(c, out, blanks, room, |x| Ok(*x)),
            (C::FloatColumnReader(c), Raw::Numbers(out), T::Number) => {
                self.numbers(c, out, blanks, room, |x| Ok(f64::from(*x)))
            }
            (C::Int32ColumnReader(c), Raw::Numbers(out), T::Number) => {
                self.numbers(c, out, blanks, room, |x| Ok(f64::from(*x)))
            }
            (C::Int64ColumnReader(c), Raw::Numbers(out), T::Number) => {
                self.numbers(c, out, blanks, room, |x| Ok(*x as f64))
            }
            (C::Int32ColumnReader(c), Raw::Numbers(out), T::Unsigned) => {
                self.numbers(c, out, blanks, room, |x| Ok(f64::from(x.cast_unsigned())))
            }
            (C::Int64ColumnReader(c), Raw::Numbers(out), T::Unsigned) => {
                self.numbers(c, out, blanks, room, |x| Ok(x.cast_unsigned() as f64))
            }
            (C::BoolColumnReader(c), Raw::Numbers(out), T::Boolean) => {
                self.numbers(c, out, blanks, room, |x| Ok(f64::from(u8::from(*x))))
            }
            (C::FixedLenByteArrayColumnReader(c), Raw::Numbers(out), T::Half) => {
                self.numbers(c, out, blanks, room, |x| match x.data().first_chunk() {
                    Some(bytes) => Ok(half::f16::from_le_bytes(*bytes).to_f64()),
                    None => Err("its float16 has fewer than two bytes".to_owned()),
                })
            }
            (C::Int32ColumnReader(c), Raw::Numbers(out), T::Decimal { scale }) => {
                self.numbers(c, out, blanks, room, |x| decimal(i128::from(*x), scale))
            }
            (C::Int64ColumnReader(c), Raw::Numbers(out), T::Decimal { scale }) => {
                self.numbers(c, out, blanks, room, |x| decimal(i128::from(*x), scale))
            }
            (C::ByteArrayColumnReader(c), Raw::Numbers(out), T::Decimal { scale }) => {
                self.numbers(c, out, blanks, room, |x| decimal(big_endian(x.data())?, scale))
            }
            (C::FixedLenByteArrayColumnReader(c), Raw::Numbers(out), T::Decimal { scale }) => {
                self.numbers(c, out, blanks, room, |x| decimal(big_endian(x.data())?, scale))
            }
            (C::Int32ColumnReader(c), Raw::Numbers(out), T::TimeOfDay(unit)) => {
                self.numbers(c, out, blanks, room, |x| Ok(self.time(i128::from(*x) * unit.nanoseconds())))
            }
            (C::Int64ColumnReader(c), Raw::Numbers(out), T::TimeOfDay(unit) | T::Duration(unit)) => {
                self.numbers(c, out, blanks, room, |x| Ok(self.time(i128::from(*x) * unit.nanoseconds())))
            }
            (C::Int64ColumnReader(c), Raw::Numbers(out), T::Timestamp(unit)) => {
                self.numbers(c, out, blanks, room, |x| Ok(self.since_first(i128::from(*x) * unit.nanoseconds())))
            }
            (C::Int96ColumnReader(c), Raw::Numbers(out), T::Timestamp(_)) => {
                self.numbers(c, out, blanks, room, |x| Ok(self.since_first(of_int96(x))))
            }
            (C::Int32ColumnReader(c), Raw::Texts(out), T::Date) => self.each(c, |row, cell| {
                let text = cell.map_or_else(String::new, |days| date(i64::from(*days)));
                room.text(out, &text, &|| self.place(row))
            }),
            (C::ByteArrayColumnReader(c), Raw::Texts(out), T::Text) => self.each(c, |row, cell| {
                let text = std::str::from_utf8(cell.map_or(&[], ByteArray::data)).map_err(|_| {
                    RecordError::syntax(self.place(row), format!("column `{}`: the text is not UTF-8", self.column))
                })?;
                room.text(out, text, &|| self.place(row))
            }),
            _ => Err(self.damaged(format!("column {} is of another type than its schema says", self.column))),
        }
    }

    /// A time in the unit that is wanted.
    fn time(&self, ns: i128) -> f64 {
        let per = self.time_unit.nanoseconds();
        if ns.unsigned_abs() < 1 << 53 {
            return ns as f64 / per as f64;
        }
        (ns / per) as f64 + (ns % per) as f64 / per as f64
    }

    fn since_first(&self, ns: i128) -> f64 {
        let origin = self.origin_ns.get().unwrap_or(ns);
        self.origin_ns.set(Some(origin));
        self.time(ns - origin)
    }

    fn numbers<T: DataType>(
        &self,
        column: &mut ColumnReaderImpl<T>,
        out: &mut Vec<f64>,
        blanks: &mut Blanks,
        room: &mut Room<'_>,
        number: impl Fn(&T::T) -> Result<f64, String>,
    ) -> Result<(), RecordError> {
        self.each(column, |row, cell| {
            let Some(cell) = cell else {
                let (Some(blanks), Some(name)) = (blanks.as_mut(), self.may_be_blank) else {
                    return Err(RecordError::empty_cell(self.place(row), self.column, &(self.advice)()));
                };
                room.take((size_of::<(String, usize)>() + name.len()) as u64)?;
                memory::push(blanks, (name.to_owned(), self.first_row + row - 1))
                    .map_err(|e| RecordError::memory(self.path, e))?;
                return room.number(out, 0.0);
            };
            let value = number(cell).map_err(|problem| RecordError::syntax(self.place(row), self.says(&problem)))?;
            if !value.is_finite() {
                return Err(RecordError::not_finite(self.place(row), self.column, &value.to_string()));
            }
            room.number(out, value)
        })
    }

    fn says(&self, problem: &str) -> String {
        format!("column `{}`: {problem}", self.column)
    }

    /// Every cell of these rows, `None` for a null, with its row from 0.
    fn each<T: DataType>(
        &self,
        column: &mut ColumnReaderImpl<T>,
        mut see: impl FnMut(usize, Option<&T::T>) -> Result<(), RecordError>,
    ) -> Result<(), RecordError> {
        const BATCH: usize = 4096;
        let mut row = 0;
        let (mut levels, mut values) = (Vec::new(), Vec::new());
        while row < self.n_rows {
            levels.clear();
            values.clear();
            let most = BATCH.min(self.n_rows - row);
            let (n, _, _) = column
                .read_records(most, Some(&mut levels), None, &mut values)
                .map_err(|e| self.damaged(describe(&e)))?;
            if n == 0 {
                return Err(self.damaged(format!("column {} ends before row {}", self.column, self.first_row + row)));
            }
            // A required column has no levels: every cell has a value.
            let mut given = values.iter();
            for k in 0..n {
                let cell = if levels.get(k).is_none_or(|level| *level > 0) { given.next() } else { None };
                see(row + k, cell)?;
            }
            row += n;
        }
        Ok(())
    }
}

/// The reader's words, without its names of variants and types.
pub(crate) fn describe(error: &ParquetError) -> String {
    match error {
        ParquetError::General(text) | ParquetError::EOF(text) | ParquetError::NYI(text) => text.clone(),
        other => other.to_string(),
    }
}

/// The double nearest to `unscaled · 10^-scale`: a division would round twice.
fn decimal(unscaled: i128, scale: i32) -> Result<f64, String> {
    let text = format!("{unscaled}e{}", -i64::from(scale));
    fast_float2::parse(&text).map_err(|_| format!("`{text}` is not a number"))
}

/// An integer in two's complement, its highest byte first.
fn big_endian(bytes: &[u8]) -> Result<i128, String> {
    let sign = if bytes.first().is_some_and(|first| first & 0x80 != 0) { 0xff } else { 0 };
    let head = bytes.len().saturating_sub(16);
    let (more, low) = bytes.split_at(head);
    let mut whole = [sign; 16];
    for (to, from) in whole.iter_mut().rev().zip(low.iter().rev()) {
        *to = *from;
    }
    let value = i128::from_be_bytes(whole);
    if more.iter().any(|byte| *byte != sign) || (value < 0) != (sign == 0xff) {
        return Err(format!("its decimal of {} bytes is beyond 38 digits; write the column as double", bytes.len()));
    }
    Ok(value)
}

/// ns since 1970 of nanoseconds of a day and a Julian day.
fn of_int96(time: &Int96) -> i128 {
    let [low, high, day] = *time.data() else { return 0 };
    let nanoseconds = i128::from((u64::from(high) << 32 | u64::from(low)).cast_signed());
    (i128::from(day.cast_signed()) - JULIAN_DAY_OF_1970) * NS_PER_DAY + nanoseconds
}

/// A day of the Gregorian calendar, counted from 1970-01-01, as `2026-03-31`.
///
/// Source: Hinnant, "chrono-compatible low-level date algorithms", `civil_from_days`.
fn date(days: i64) -> String {
    let days = days + 719_468; // from 0000-03-01, where leap days come last
    let (era, day_of_era) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year_of_era = (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month = (5 * day_of_year + 2) / 153; // from March
    let day = day_of_year - (153 * month + 2) / 5 + 1;
    let month = if month < 10 { month + 3 } else { month - 9 };
    let year = year_of_era + 400 * era + i64::from(month <= 2);
    format!("{year:04}-{month:02}-{day:02}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_are_dates() {
        for (days, text) in [
            (0, "1970-01-01"),
            (-1, "1969-12-31"),
            (11_016, "2000-02-29"),
            (20_543, "2026-03-31"),
            (-719_162, "0001-01-01"),
        ] {
            assert_eq!(date(days), text);
        }
        for days in [i64::from(i32::MIN), i64::from(i32::MAX)] {
            assert!(date(days).contains('-'));
        }
    }

    #[test]
    fn decimals_are_the_nearest_doubles() {
        assert_eq!(decimal(12_345, 2), Ok(123.45));
        assert_eq!(decimal(-1, 3), Ok(-0.001));
        assert_eq!(decimal(99_999_999_999_999_999_999_999_999_999_999_999_999, 30), Ok(1e8));
        assert_eq!(decimal(5, -3), Ok(5000.0));
    }

    #[test]
    fn integers_of_any_length_are_in_twos_complement() {
        assert_eq!(big_endian(&[]), Ok(0));
        assert_eq!(big_endian(&[0xff, 0x85]), Ok(-123));
        assert_eq!(big_endian(&[0, 0x85]), Ok(0x85));
        let mut long = vec![0xff; 32];
        assert_eq!(big_endian(&long), Ok(-1));
        long[3] = 0;
        assert!(big_endian(&long).is_err());
        // The sign of the low 16 bytes is not that of the whole.
        let mut high = vec![0; 17];
        high[1] = 0x80;
        assert!(big_endian(&high).is_err());
    }

    #[test]
    fn a_julian_day_is_a_time() {
        let mut time = Int96::new();
        time.set_data(1, 0, 2_440_589);
        assert_eq!(of_int96(&time), NS_PER_DAY + 1);
    }
}
