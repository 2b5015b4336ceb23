//! Numbers against the standard library, files against what was written.

use std::io::Write;

use proptest::prelude::*;

use super::number::{fast_number, separators, slow_number};
use super::*;

fn file(text: &[u8]) -> tempfile::NamedTempFile {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(text).unwrap();
    file
}

/// All columns of a file with a header, some bytes at a time; `None` where one of its lines is not plain numbers.
fn read(text: &str, is_read: &[bool], chunk_bytes: usize) -> Result<Option<Vec<Vec<f64>>>, RecordError> {
    let file = file(text.as_bytes());
    let mut reader = Reader::open(file.path(), chunk_bytes)?;
    let mut start = reader.beginning()?;
    let end = memchr(b'\n', &start).unwrap() + 1;
    reader.go_on(start.split_off(end), 2);
    let (layout, mut memory) = (Layout::of(is_read), Memory::default());
    let mut columns = vec![Vec::new(); layout.selected];
    let mut line = 2;
    while let Some(lines) = reader.next(&mut memory.text)? {
        assert_eq!(lines.first, line);
        line += lines.count;
        let Some(parts) = layout.parse(&mut memory, &lines) else { return Ok(None) };
        for (column, part) in columns.iter_mut().zip(parts.into_iter().flatten()) {
            column.extend_from_slice(part);
        }
    }
    Ok(Some(columns))
}

/// Parses one cell by whichever path takes it; the flag says whether it was the quick one.
fn parse(cell: &str) -> Option<(f64, bool)> {
    let mut text = format!("{cell},").into_bytes();
    text.resize(text.len() + PADDING, 0);
    let fast = fast_number(&text, 0, cell.len());
    let slow = slow_number(cell.as_bytes());
    // Where both read it, they agree.
    assert!(fast.is_none() || fast.map(f64::to_bits) == slow.map(f64::to_bits), "{cell}");
    Some((slow?, fast.is_some()))
}

/// Parses a cell as a row of a file of its own.
fn parse_alone(cell: &str) -> Option<f64> {
    read(&format!("a,b\n{cell},0\n"), &[true; 2], 64).unwrap().map(|columns| columns[0][0])
}

fn assert_same_as_std(cell: &str) {
    let expected: f64 = cell.parse().unwrap();
    let found = parse(cell).map(|(value, _)| value);
    if expected.is_finite() {
        assert_eq!(found.map(f64::to_bits), Some(expected.to_bits()), "{cell}");
    } else {
        assert_eq!(found, None, "{cell}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]

    /// Any decimal text: sign, digits, point, exponent, at any length.
    #[test]
    fn decimals_are_those_of_the_standard_library(
        cell in "-?[0-9]{1,20}(\\.[0-9]{1,24})?(e-?[0-9]{1,3})?"
    ) {
        assert_same_as_std(&cell);
    }

    /// What logs look like: all of these take the quick way.
    #[test]
    fn short_decimals_take_the_quick_way(cell in "-?[0-9]{1,8}(\\.[0-9]{1,7})?") {
        assert_same_as_std(&cell);
        prop_assert!(parse(&cell).unwrap().1);
    }

    /// Shortest representation of any double, plain and with exponent.
    #[test]
    fn doubles_survive_being_written(bits in any::<u64>()) {
        let value = f64::from_bits(bits);
        prop_assume!(value.is_finite());
        for cell in [format!("{value}"), format!("{value:e}"), format!("{value:.6}")] {
            assert_same_as_std(&cell);
        }
    }

    /// Bytes of any kind: an answer, or None, never a panic; and never another answer.
    #[test]
    fn any_bytes_are_read_as_the_standard_library_does_or_not_at_all(
        bytes in proptest::collection::vec(prop::sample::select(b"0123456789.-+eE \"ainf".to_vec()), 0..24)
    ) {
        let cell = String::from_utf8(bytes).unwrap();
        if let Some((value, _)) = parse(&cell) {
            prop_assert_eq!(Ok(value.to_bits()), cell.trim_ascii().parse().map(f64::to_bits));
        }
    }
}

proptest! {
    /// Commas and line ends are found wherever they are, and nothing else is.
    #[test]
    fn separators_are_commas_and_line_ends(
        mut bytes in proptest::collection::vec(
            prop_oneof![Just(b','), Just(b'\n'), any::<u8>()], 0..200
        )
    ) {
        bytes.resize(bytes.len().next_multiple_of(16), 0);
        let mut places = vec![0; bytes.len() + 16];
        let found = separators(&bytes, &mut places);
        let expected: Vec<u32> = (0_u32..)
            .zip(&bytes)
            .filter(|(_, byte)| matches!(byte, b',' | b'\n'))
            .map(|(k, _)| k)
            .collect();
        prop_assert_eq!(&places[..found], &expected[..]);
    }
}

#[test]
fn edges_of_the_quick_way() {
    for cell in [
        "0",
        "-0",
        "-0.0",
        "00000000",
        "99999999",
        "999999999",
        "0.00000000",
        "1.0000000000000000",
        "9007199254740992",
        "9007199254740993",
        "90071992.54740992",
        "90071992.54740993",
        "0.9007199254740993",
        "12345678.1234567890123456",
        "1.00000000000000000000001",
        "5e-324",
        "1.7976931348623157e308",
        "2.2250738585072014e-308",
        "0.1",
        "0.30000000000000004",
        ".5",
        "5.",
        "+1",
        "1e5",
        "1E5",
        "1e400",
        "inf",
        "-inf",
        "NaN",
        "infinity",
    ] {
        assert_same_as_std(cell);
    }
    for cell in ["", "-", ".", "1.2.3", "1 2", "0x10", "1_000", "--1", "e5", "1e", "1\r"] {
        assert_eq!(parse_alone(cell), None, "{cell}");
    }
}

/// A log of `n` rows, as text and as numbers.
fn log(n: usize) -> (String, Vec<Vec<f64>>) {
    let mut text = String::from("t [s],f_x [N],\"speed [m/s]\"\n");
    let mut columns = vec![Vec::new(); 3];
    for i in 0..n {
        let k = i as f64;
        let row = [k * 0.001, (k * 0.7).sin() * 10.0_f64.powi(i32::try_from(i % 7).unwrap() - 3), 1.0 / (k + 1.0)];
        let cells = [format!("{:.3}", row[0]), format!("{:.6}", row[1]), format!("{}", row[2])];
        for (column, cell) in columns.iter_mut().zip(&cells) {
            column.push(cell.parse().unwrap());
        }
        text.push_str(&cells.join(","));
        text.push('\n');
    }
    (text, columns)
}

#[test]
fn a_log_is_read_as_it_was_written_whatever_the_chunks() {
    let (text, expected) = log(2000);
    let is_same = |text: &str, chunk_bytes| read(text, &[true; 3], chunk_bytes).unwrap().as_ref() == Some(&expected);
    for chunk_bytes in [64, 100, 1000, 4097, text.len() - 1, text.len(), 1 << 20] {
        assert!(is_same(&text, chunk_bytes), "{chunk_bytes}");
    }
    assert!(is_same(text.trim_end(), 100));
    assert!(is_same(&text.replace('\n', "\r\n"), 100));
    for chunk_bytes in (64..200).chain([1 << 20]) {
        assert!(is_same(&format!("{text}\n\n\r\n\n"), chunk_bytes));
    }
    assert!(is_same(&text.replacen("0.000,", " 0.000 ,", 1), 100));
}

#[test]
fn columns_that_are_not_selected_are_passed_over() {
    let text = "name,f_x [N],note,speed [m/s]\r\nrun 1,-1.5,good,0.1\r\nrun 2,-2.5,,0.2\r\n";
    let is_read = [false, true, false, true];
    assert_eq!(read(text, &is_read, 1 << 10).unwrap().unwrap(), [[-1.5, -2.5], [0.1, 0.2]]);
    assert_eq!(read(&text.replace("good", "\"good\""), &is_read, 1 << 10), Ok(None));
}

#[test]
fn what_is_not_plain_numbers_is_left_and_what_is_no_line_is_refused() {
    let rows = |rows: &str| read(&format!("t [s],f_x [N]\n0.1,1\n{rows}"), &[true; 2], 64);
    for bad in ["0.2,abc\n", "0.2,\n", ",2", "nan,2", "0.2,-1e999\n", "0.2\r,1\n", "0.2\n", "0.2,1,2\n", "0.2,1,\n"] {
        assert_eq!(rows(bad), Ok(None), "{bad}");
    }
    for bad in ["\n0.2,1\n", "0.2,1\n\n\n0.3,4\n", "0.2,\"1\"\n"] {
        assert_eq!(rows(bad), Ok(None), "{bad}");
    }
    let long = rows(&"9".repeat(100)).unwrap_err().to_string();
    assert!(long.ends_with(":3: the line is longer than 64 bytes; is this a CSV file?"), "{long}");
}
