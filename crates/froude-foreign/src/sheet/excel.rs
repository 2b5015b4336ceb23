//! What `.xlsx` and `.xls` have in common: dates, number formats, and what formulas refer to.

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

/// Said of a number whose format leaves its last three digits out.
const THOUSANDS: &str = "shown in thousands";

/// What a number format shows behind the number that changes what it means: `%`, or a unit in quotes, `0.0" kN"`; or that it shows thousandths, `0,`.
pub(crate) fn behind(format: &str) -> Option<String> {
    let (mut is_quoted, mut is_escaped, mut is_scaled) = (false, false, false);
    let (mut literal, mut is_percent) = (String::new(), false);
    for c in format.chars() {
        let is_code = !is_quoted && !is_escaped;
        match c {
            // The next section is of negative numbers.
            ';' if is_code => break,
            '"' if !is_escaped => is_quoted = !is_quoted,
            // What stands before the number says which one it is.
            '0' | '#' | '?' if is_code => {
                literal.clear();
                is_scaled = false;
            }
            ',' if is_code => is_scaled = true,
            '%' if is_code => is_percent = true,
            // `_x` is as wide as x, `*x` is filled with it, and `\\x` shows it.
            '_' | '*' if is_code => {
                is_escaped = true;
                continue;
            }
            '\\' if is_code => {
                is_escaped = true;
                literal.push('\\');
                continue;
            }
            _ if is_quoted || (is_escaped && literal.ends_with('\\')) => {
                literal = literal.trim_end_matches('\\').to_owned();
                literal.push(c);
            }
            _ => {}
        }
        is_escaped = false;
    }
    let unit = literal.trim();
    if is_percent {
        Some("%".to_owned())
    } else if is_scaled {
        Some(THOUSANDS.to_owned())
    } else {
        unit.contains(|c: char| c.is_alphabetic() || matches!(c, '%' | '‰' | '°')).then(|| unit.to_owned())
    }
}

/// A number with what its format shows behind it.
pub(crate) fn shown(x: f64, behind: Option<&String>) -> Cell {
    match behind.map(String::as_str) {
        None => Cell::Number(x),
        Some("%") => Cell::Percent(x),
        Some(THOUSANDS) => Cell::Text(format!("{x} {THOUSANDS}")),
        Some(word) => Cell::Shown(x, word.to_owned()),
    }
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
    fn a_number_format_shows_percent_or_a_unit() {
        for (format, expected) in [
            ("0%", "%"),
            ("0.00%", "%"),
            ("0.0 %;[Red]-0.0 %", "%"),
            ("\"slip \"0%", "%"),
            ("0.0\"%\"", "%"),
            ("0.0\\%", "%"),
            ("0.0\" kN\"", "kN"),
            ("#,##0.00\\ \\N;-#,##0.00\\ \\N", "N"),
            ("General\" °C\"", "°C"),
            ("0.0,", "shown in thousands"),
            ("#,##0,\" k\"", "shown in thousands"),
        ] {
            assert_eq!(behind(format).as_deref(), Some(expected), "{format}");
        }
        for format in [
            "0.00",
            "General",
            "#,##0.00",
            "\"Run \"0",
            "_(* #,##0.00_);_(* (#,##0.00)",
            "0.00E+00",
            "0.0\" \"",
            "[$€-407] 0.00",
        ] {
            assert_eq!(behind(format), None, "{format}");
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
