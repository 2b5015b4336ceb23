//! Numbers against the standard library, files against what was written, errors word
//! for word.

use std::io::Write;
use std::num::NonZeroUsize;

use proptest::prelude::*;

use super::number::{fast_number, separators, slow_number};
use super::*;

fn file(text: &[u8]) -> tempfile::NamedTempFile {
    let mut file = tempfile::NamedTempFile::new().unwrap();
    file.write_all(text).unwrap();
    file
}

/// All columns of a file, and its summary.
fn read(text: &str, chunk_bytes: usize) -> Result<(Vec<Vec<f64>>, Summary), FastCsvError> {
    let file = file(text.as_bytes());
    let csv = FastCsv::open_with(file.path(), chunk_bytes)?;
    let mut columns = vec![Vec::new(); csv.headers().len()];
    let mut line = 2;
    let summary = csv.for_each_chunk(|chunk, first_line| {
        assert_eq!(first_line, line);
        line += chunk[0].len() as u64;
        for (column, part) in columns.iter_mut().zip(chunk) {
            column.extend_from_slice(part);
        }
        Ok::<(), FastCsvError>(())
    })?;
    Ok((columns, summary))
}

/// The error for a file, with its path cut off.
fn error(text: &str) -> String {
    let file = file(text.as_bytes());
    let found =
        FastCsv::open_with(file.path(), 64).and_then(|csv| csv.for_each_chunk(|_, _| Ok::<(), FastCsvError>(())));
    let path = file.path().display().to_string();
    found.unwrap_err().to_string().replace(&path, "log.csv")
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
    read(&format!("a,b\n{cell},0\n"), 64).ok().map(|(columns, _)| columns[0][0])
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
    for chunk_bytes in [64, 100, 1000, 4097, text.len() - 1, text.len(), 1 << 20] {
        let (columns, summary) = read(&text, chunk_bytes).unwrap();
        assert!(columns == expected, "{chunk_bytes}");
        assert_eq!((summary.rows, summary.bytes), (2000, text.len() as u64));
    }
    let without_end = text.trim_end();
    assert!(read(without_end, 100).unwrap().0 == expected);
    let with_returns = text.replace('\n', "\r\n");
    assert!(read(&with_returns, 100).unwrap().0 == expected);
    let with_mark = format!("\u{feff}{text}\n\n\r\n\n");
    for chunk_bytes in (64..200).chain([1 << 20]) {
        assert!(read(&with_mark, chunk_bytes).unwrap().0 == expected);
    }
    let with_blanks = text.replacen("0.000,", " 0.000 ,", 1);
    assert!(read(&with_blanks, 100).unwrap().0 == expected);
}

#[test]
fn threads_fold_in_the_files_order() {
    let (text, expected) = log(5000);
    let file = file(text.as_bytes());
    for threads in 1..6 {
        let csv = FastCsv::open_with(file.path(), 700).unwrap();
        let mut column = Vec::new();
        let mut chunks = 0;
        let summary = csv.fold_chunks(
            NonZeroUsize::new(threads).unwrap(),
            |chunk| {
                assert_eq!((chunk.columns[0][0] * 1e3).round(), chunk.first_line as f64 - 2.0);
                Ok::<_, FastCsvError>((chunk.index, chunk.columns[1].to_vec()))
            },
            |(index, part)| {
                assert_eq!(index, chunks);
                chunks += 1;
                column.extend(part);
                Ok(())
            },
        );
        assert_eq!(summary.unwrap().chunks, chunks);
        assert!(column == expected[1]);
    }
}

#[test]
fn the_first_error_of_the_file_wins_on_any_number_of_threads() {
    let (text, _) = log(5000);
    let lines: Vec<&str> = text.lines().collect();
    let mut broken: Vec<String> = lines.iter().map(ToString::to_string).collect();
    for line in [3100, 3105, 4000, 4990] {
        broken[line - 1] = format!("oh,{line},no");
    }
    let file = file(broken.join("\n").as_bytes());
    for threads in 1..5 {
        let csv = FastCsv::open_with(file.path(), 500).unwrap();
        let mut rows = 0;
        let found = csv.fold_chunks(
            NonZeroUsize::new(threads).unwrap(),
            |chunk| Ok::<_, FastCsvError>(chunk.columns[0].len()),
            |n| {
                rows += n;
                Ok(())
            },
        );
        let message = found.unwrap_err().to_string();
        assert!(message.ends_with(":3100: column `t`: `oh` is not a number"), "{message}");
        assert!(rows < 3099);
    }
    // What `fold` refuses ends the work as well.
    let csv = FastCsv::open_with(file.path(), 500).unwrap();
    let stop = FastCsvError::NoRows { path: "stop".into() };
    let found = csv.fold_chunks(NonZeroUsize::new(3).unwrap(), |_| Ok::<_, FastCsvError>(()), |()| Err(stop.clone()));
    assert_eq!(found, Err(stop.clone()));
}

#[test]
fn a_panic_in_a_map_does_not_hang_the_other_threads() {
    let (text, _) = log(5000);
    let file = file(text.as_bytes());
    let csv = FastCsv::open_with(file.path(), 500).unwrap();
    let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| {
        csv.fold_chunks(
            NonZeroUsize::new(3).unwrap(),
            |chunk| {
                assert!(chunk.index != 20, "on purpose");
                Ok::<_, FastCsvError>(())
            },
            |()| Ok(()),
        )
    }));
    assert!(outcome.is_err());
}

#[test]
fn columns_are_selected_by_name_and_others_passed_over() {
    let text = "name,f_x [N],note,speed [m/s]\r\nrun 1,-1.5,good,0.1\r\nrun 2,-2.5,,0.2\r\n";
    let file = file(text.as_bytes());
    let csv = FastCsv::open(file.path()).unwrap();
    assert_eq!(csv.headers(), ["name", "f_x [N]", "note", "speed [m/s]"]);
    assert_eq!((csv.unit(1), csv.unit(2)), (Some("N"), None));
    assert_eq!(csv.column("speed").unwrap(), csv.column("speed [m/s]").unwrap());
    let mut seen = Vec::new();
    let csv = csv.select(&["speed", "f_x"]).unwrap();
    csv.for_each_chunk(|columns, _| {
        seen.extend(columns.iter().map(|column| column.to_vec()));
        Ok::<(), FastCsvError>(())
    })
    .unwrap();
    assert_eq!(seen, [[0.1, 0.2], [-1.5, -2.5]]);
}

#[test]
fn every_refusal_names_line_and_column() {
    let header = "t [s],f_x [N]\n";
    let rows = |rows: &str| error(&format!("{header}0.1,1\n{rows}"));
    assert_eq!(rows("0.2,abc\n"), "log.csv:3: column `f_x`: `abc` is not a number");
    assert_eq!(rows("0.2,1.5x\n0.3,1\n"), "log.csv:3: column `f_x`: `1.5x` is not a number");
    assert_eq!(rows("0.2,\n"), "log.csv:3: column `f_x`: the cell is empty; fill it in or delete the row");
    assert_eq!(rows(",2"), "log.csv:3: column `t`: the cell is empty; fill it in or delete the row");
    assert_eq!(rows("nan,2"), "log.csv:3: column `t`: `nan` is not a finite number; delete the row");
    assert_eq!(rows("0.2,-1e999\n"), "log.csv:3: column `f_x`: `-1e999` is not a finite number; delete the row");
    assert_eq!(rows("0.2\r,1\n"), "log.csv:3: column `t`: `0.2\r` is not a number");
    assert_eq!(rows("0.2\n"), "log.csv:3: the row has 1 cell, the header has 2");
    assert_eq!(rows("0.2,1,2\n"), "log.csv:3: the row has 3 cells, the header has 2");
    assert_eq!(rows("0.2,1,\n"), "log.csv:3: the row has 3 cells, the header has 2");
    assert_eq!(rows("\n0.2,1\n"), "log.csv:3: the line is blank; delete it");
    assert_eq!(rows("0.2,1\n\n\n0.3,4\n"), "log.csv:4: the line is blank; delete it");
    assert_eq!(
        rows("0.2,\"1\"\n"),
        "log.csv:3: column `f_x` is quoted; long tables are read without quotes: write plain \
         numbers, or read the file as a small table"
    );
    assert_eq!(rows(&"9".repeat(100)), "log.csv:3: the line is longer than 64 bytes; is this a CSV file?");
    let no_rows = "log.csv: the table has no rows; at least one observation is needed";
    assert_eq!(error(header), no_rows);
    assert_eq!(error(&format!("{header}\n\n")), no_rows);
    assert_eq!(error("a,b,a [m]\n1,2,3\n"), "log.csv:1: column `a` appears twice; rename or delete one");
    assert_eq!(error(""), "log.csv:1: there is no line end; the first line must name the columns");
    assert_eq!(error("a,,b\n1,2,3\n"), "log.csv:1: a column has no name; the first line must name the columns");
    assert_eq!(
        error("\"a,b\",c\n1,2,3\n"),
        "log.csv:1: a name holds a comma or a quote; the first line must name the columns"
    );
    let file = file(b"a,b\n1,2\n");
    let path = file.path().display().to_string();
    let csv = FastCsv::open(file.path()).unwrap();
    assert_eq!(
        csv.select(&["c"]).unwrap_err().to_string().replace(&path, "log.csv"),
        "log.csv:1: there is no column `c`; the columns are a, b"
    );
    let missing = FastCsv::open("no/such/file.csv").unwrap_err().to_string();
    assert!(missing.starts_with("cannot read no/such/file.csv: "), "{missing}");
}
