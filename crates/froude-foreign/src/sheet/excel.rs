//! What `.xlsx` and `.xls` have in common: dates, percent, and what formulas refer to.

use calamine::ExcelDateTime;

use super::grid::{Cell, cell_name};
use crate::ForeignError;

/// A date, a time of day or a duration as a text; `None` if the number is none that Excel shows as one.
pub(crate) fn iso(date: &ExcelDateTime) -> Option<Cell> {
    let days = date.as_f64();
    if date.is_duration() {
        return days.is_finite().then(|| Cell::Date(format!("PT{}S", days * 86400.0)));
    }
    if !(0.0..2_958_466.0).contains(&days) {
        return None;
    }
    let (year, month, day, hour, minute, second, milli) = date.to_ymd_hms_milli();
    let fraction = if milli == 0 { String::new() } else { format!(".{milli:03}") };
    let time = format!("{hour:02}:{minute:02}:{second:02}{fraction}");
    let day = format!("{year:04}-{month:02}-{day:02}");
    Some(Cell::Date(match (days < 1.0, time == "00:00:00") {
        (true, _) => time,
        (false, true) => day,
        (false, false) => format!("{day}T{time}"),
    }))
}

/// Whether a number format shows percent: a `%` outside of quotes that is not escaped.
pub(crate) fn is_percent(format: &str) -> bool {
    let (mut is_quoted, mut is_escaped) = (false, false);
    format.chars().any(|c| {
        let found = c == '%' && !is_quoted && !is_escaped;
        is_quoted ^= c == '"' && !is_escaped;
        is_escaped = !is_escaped && !is_quoted && matches!(c, '\\' | '_' | '*');
        found
    })
}

/// Whether a formula refers to another file: `[1]Sheet1!A1`, `'[1]My sheet'!A1`, `'C:\[tank.xlsx]Sheet1'!A1`.
///
/// Brackets after a name, `Runs[speed]`, and inside of brackets belong to a table of the same file.
pub(crate) fn is_external(formula: &str) -> bool {
    let (mut depth, mut is_text, mut last) = (0_usize, false, ' ');
    for c in formula.chars() {
        match c {
            '"' => is_text = !is_text,
            _ if is_text => {}
            '[' if depth == 0 && !(last.is_alphanumeric() || matches!(last, '_' | '.')) => return true,
            '[' => depth += 1,
            ']' => depth = depth.saturating_sub(1),
            _ => {}
        }
        last = c;
    }
    false
}

/// A number that a date format cannot show.
pub(crate) fn no_date(sheet: &str, row: usize, column: usize, number: f64) -> ForeignError {
    ForeignError(format!(
        "sheet {sheet:?}: cell {} has the format of a date, but its number {number} is not a date; give the cell a number format",
        cell_name(row, column)
    ))
}

/// Whether a formula uses one of some names, whatever their case. Names inside of texts count, too.
pub(crate) fn uses(formula: &str, names: &[String]) -> bool {
    let mut words = formula.split(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '.' | '\\')));
    !names.is_empty() && words.any(|word| names.iter().any(|name| name.eq_ignore_ascii_case(word)))
}

/// The value of a formula was not stored, or is not that of its program.
pub(crate) fn no_cached_value(sheet: &str, row: usize, column: usize) -> ForeignError {
    ForeignError(format!(
        "sheet {sheet:?}: cell {} is a formula that has not been computed; open the file in Excel or LibreOffice and save it there",
        cell_name(row, column)
    ))
}

/// A formula reads another file, so that its stored value may be old.
pub(crate) fn refers_elsewhere(sheet: &str, row: usize, column: usize) -> ForeignError {
    ForeignError(format!(
        "sheet {sheet:?}: cell {} is a formula that reads another file, so its stored value may be old; replace the formula by its \
         value (copy, then paste special, values) and save the file",
        cell_name(row, column)
    ))
}

#[cfg(test)]
mod tests {
    use calamine::ExcelDateTimeType::{DateTime, TimeDelta};

    use super::*;

    #[test]
    fn a_date_is_a_text_and_never_a_number() {
        let of = |days, kind| iso(&ExcelDateTime::new(days, kind, false));
        let text = |text: &str| Some(Cell::Date(text.to_owned()));
        assert_eq!(of(45352.0, DateTime), text("2024-03-01"));
        assert_eq!(of(45352.5 + 0.25 / 86400.0, DateTime), text("2024-03-01T12:00:00.250"));
        assert_eq!(of(0.75, DateTime), text("18:00:00"));
        assert_eq!(of(0.5 / 86400.0, TimeDelta), text("PT0.5S"));
        assert_eq!([of(-1.0, DateTime), of(f64::NAN, DateTime), of(1e9, DateTime)], [None, None, None]);
        assert_eq!(iso(&ExcelDateTime::new(0.0, DateTime, true)), text("00:00:00"));
    }

    #[test]
    fn percent_is_a_sign_of_the_format_and_not_of_its_texts() {
        for format in ["0%", "0.00%", "0.0 %;[Red]-0.0 %", "\"slip \"0%"] {
            assert!(is_percent(format), "{format}");
        }
        for format in ["0.00", "0.0\"%\"", "0.0\\%", "General"] {
            assert!(!is_percent(format), "{format}");
        }
    }

    #[test]
    fn a_formula_that_reads_another_file_is_known_by_its_brackets() {
        for formula in ["[1]Sheet1!A1", "2*'[1]My sheet'!A1", "'C:\\tank\\[runs.xlsx]Sheet1'!$A$1", "SUM(A1,[2]x!B2)"] {
            assert!(is_external(formula), "{formula}");
        }
        for formula in ["A1*2", "Runs[speed]", "SUM(Runs[[#This Row],[speed]:[force]])", "\"[1]\"&A1", "Run.1[a]"] {
            assert!(!is_external(formula), "{formula}");
        }
        let names = ["Tare".to_owned()];
        assert_eq!(["2*tare+A1", "2*Tare_2", "A1"].map(|formula| uses(formula, &names)), [true, false, false]);
    }
}
