//! `[file]` of a sidecar: how the file is written, where nothing in it says so or somebody knows better.
//!
//! | key | what it says |
//! | --- | --- |
//! | `encoding` | a text's encoding: `"windows-1252"`, `"utf-16le"`, … |
//! | `separator` | between cells: `","`, `";"`, `"tab"`, `"\|"` or `"blanks"` |
//! | `decimal`, `thousands` | the marks in numbers: `","`, `"."`, `" "` or `"'"` |
//! | `names`, `units` | the line of the names, and that of the units (0: none) |
//! | `sheet`, `range` | of a spreadsheet: the sheet's name, and its cells as `"B3:H40"` |
//! | `part` | of a file of several tables: the group, topic or variable |
//! | `not_measured` | cells that stand for no measurement: `["NaN", "-9999"]`; `[]` where none is |
//! | `leave_out` | rows that begin with one of these words and are no observations: `["Mean", "Std"]`; `[]` where none is |

use std::path::Path;

use froude_foreign::layout::Stated;
use froude_foreign::split::Separator;

use crate::error::{Place, RecordError};
use crate::section::Section;
use crate::section_values::one_of;

/// What somebody states about a file.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FileWords {
    /// The encoding of a text.
    pub encoding: Option<String>,
    /// How a table of text is written.
    pub stated: Stated,
    /// The sheet of a spreadsheet.
    pub sheet: Option<String>,
    /// Its cells, as `B3:H40`.
    pub range: Option<String>,
    /// The group, topic or variable.
    pub part: Option<String>,
    /// Cells that stand for no measurement; where nobody said, numbers that many programs write so are asked about.
    pub not_measured: Option<Vec<String>>,
    /// First words of rows that are no observations; none where nobody said.
    pub leave_out: Option<Vec<String>>,
}

const KEYS: [&str; 11] = [
    "encoding",
    "separator",
    "decimal",
    "thousands",
    "names",
    "units",
    "sheet",
    "range",
    "part",
    "not_measured",
    "leave_out",
];

impl FileWords {
    /// Reads `[file]`; a file of which nothing is stated where there is none.
    pub(crate) fn read(root: &Section<'_>) -> Result<Self, RecordError> {
        let Some(file) = root.section("file")? else { return Ok(Self::default()) };
        file.only(&KEYS)?;
        let text = |key| Ok::<_, RecordError>(file.text(key)?.map(str::to_owned));
        let line = |key| Ok::<_, RecordError>(file.integer(key)?.and_then(|line| usize::try_from(line).ok()));
        let stated = Stated {
            separator: one_of(&file, "separator", &Separator::ALL.map(Separator::word), &Separator::ALL)?,
            decimal: one_of(&file, "decimal", &[".", ","], &['.', ','])?,
            thousands: one_of(&file, "thousands", &[".", ",", " ", "'"], &['.', ',', ' ', '\''])?,
            names_line: line("names")?,
            units_line: line("units")?,
        };
        file.refuse("names", stated.names_line == Some(0), "is 0; lines are counted from 1")?;
        let is_one = stated.decimal.is_some() && stated.decimal == stated.thousands;
        file.refuse("thousands", is_one, "is the decimal mark too; one of them is another")?;
        Ok(Self {
            encoding: text("encoding")?,
            stated,
            sheet: text("sheet")?,
            range: text("range")?,
            part: text("part")?,
            not_measured: file.get("not_measured").map(|_| file.texts("not_measured")).transpose()?,
            leave_out: file.get("leave_out").map(|_| file.texts("leave_out")).transpose()?,
        })
    }

    /// Whether a cell stands for no measurement; `value` is its number, where it is one.
    #[must_use]
    pub fn is_not_measured(&self, cell: &str, value: Option<f64>) -> bool {
        self.not_measured
            .iter()
            .flatten()
            .any(|word| word.eq_ignore_ascii_case(cell) || (value.is_some() && word.parse::<f64>().ok() == value))
    }

    /// Whether a row that begins with a cell is declared to be left out.
    #[must_use]
    pub fn leaves_out(&self, first: &str) -> bool {
        self.leave_out.iter().flatten().any(|word| word.eq_ignore_ascii_case(first))
    }
}

/// Words at the beginning of rows that sum up those above.
const SUMMARIES: [&str; 64] = [
    "mean value",
    "mw",
    "ø",
    "x̄",
    "σ",
    "cv",
    "95% ci",
    "95 % ci",
    "u95",
    "±",
    "gesamt",
    "gesamtmittel",
    "ergebnis",
    "écart type",
    "desv. est.",
    "合計",
    "offset",
    "factor",
    "faktor",
    "scale",
    "skalierung",
    "mean",
    "average",
    "avg",
    "avg.",
    "std",
    "stdev",
    "std.",
    "std dev",
    "stddev",
    "standard deviation",
    "std.-abw.",
    "std. dev.",
    "sd",
    "sigma",
    "variance",
    "min",
    "max",
    "minimum",
    "maximum",
    "sum",
    "total",
    "median",
    "rms",
    "count",
    "mittelwert",
    "mittel",
    "standardabweichung",
    "stabw",
    "summe",
    "moyenne",
    "écart-type",
    "ecart-type",
    "somme",
    "media",
    "promedio",
    "desviación estándar",
    "gjennomsnitt",
    "snitt",
    "middelverdi",
    "standardavvik",
    "平均",
    "平均値",
    "標準偏差",
];

/// Whether a cell at the beginning of a row says that the row sums up others: `Mean`, `Mean (n = 5)`, `Std. dev.:`.
#[must_use]
pub fn is_summary(cell: &str) -> bool {
    let lower = cell.trim().trim_end_matches(':').to_lowercase();
    let first = lower.split([' ', '(', '-', '_', '=']).next().unwrap_or_default();
    SUMMARIES.contains(&lower.as_str()) || (lower.len() > first.len() && STEMS.contains(&first))
}

/// Whether a cell, wherever it stands, is the name of a row that sums up others.
#[must_use]
pub fn is_sum(cell: &str) -> bool {
    cell.starts_with(char::is_alphabetic) && SUMMARIES.contains(&cell.trim_end_matches(':').to_lowercase().as_str())
}

/// Most rows at the end of a table that are no runs.
const ODD_ROWS: usize = 3;

/// The row of a first column from which on words stand below whole numbers, `1, 2, 3, Tara`: sums, tares and notes rather than runs.
#[must_use]
pub fn words_below_numbers(cells: &[String]) -> Option<usize> {
    let is_whole = |cell: &String| cell.parse::<u64>().is_ok();
    let row = cells.iter().rposition(is_whole)? + 1;
    let are_words = cells.get(row..)?.iter().all(|cell| cell.starts_with(char::is_alphabetic));
    let is_odd = (1..=ODD_ROWS).contains(&(cells.len() - row)) && row >= ODD_ROWS;
    (is_odd && are_words && cells.iter().take(row).all(is_whole)).then_some(row)
}

/// First words of longer names of such rows.
const STEMS: [&str; 18] = [
    "mean",
    "average",
    "avg",
    "avg.",
    "std",
    "std.",
    "stddev",
    "stdev",
    "standard",
    "grand",
    "sum",
    "total",
    "median",
    "mittelwert",
    "moyenne",
    "promedio",
    "gjennomsnitt",
    "summe",
];

/// Round numbers that programs write where there is none.
const SENTINELS: [f64; 31] = [
    32767.0,
    -32768.0,
    65535.0,
    1e6,
    -1e6,
    -99.0,
    -99.9,
    -9999.0,
    9999.0,
    -999.0,
    999.0,
    -99999.0,
    99999.0,
    -999999.0,
    999999.0,
    7999.0,
    -7999.0,
    6999.0,
    -6999.0,
    8888.0,
    -8888.0,
    888.8,
    -888.8,
    -888.88,
    -2_147_483_648.0,
    1e10,
    1e20,
    -1e20,
    1e30,
    -1e30,
    1e35,
];

/// Those that no measurement is by chance: fill values and flags of loggers, netCDF, Fortran and single precision.
const CERTAIN: [f64; 12] = [
    -999.25,
    -999.9,
    -999.99,
    -9999.25,
    -9999.9,
    -9999.99,
    9999.99,
    -1e34,
    9.969_21e36,
    3.402_823e38,
    -3.402_823e38,
    -9.99e-29,
];

/// Part of itself by which a number may differ from one of these, as it is printed.
const PRINTED: f64 = 2e-6;

/// A round one is one of these where it is so much farther out than all others of its column, or is there twice and is the farthest.
const FAR: f64 = 5.0;

/// The first number of a column that stands for no measurement, by its value and its distance from all others.
#[must_use]
pub fn sentinel(values: &[f64]) -> Option<(usize, f64)> {
    let is_among = |value: f64, list: &[f64]| {
        list.iter().any(|known| {
            value == *known || ((value - known).abs() <= PRINTED * known.abs() && !(1e-20..1e20).contains(&known.abs()))
        })
    };
    let first = |list: &[f64]| values.iter().enumerate().find(|(_, value)| is_among(**value, list));
    if let Some((row, certain)) = first(&CERTAIN) {
        return Some((row, *certain));
    }
    let (row, found) = first(&SENTINELS)?;
    let others = values.iter().filter(|value| !is_among(**value, &SENTINELS)).map(|value| value.abs());
    let farthest = others.fold(0.0, f64::max);
    let is_twice = values.iter().filter(|value| *value == found).count() > 1;
    let is_far = found.abs() > FAR * farthest || (is_twice && *found < 0.0 && found.abs() > farthest);
    (is_far && values.len() > 1).then_some((row, *found))
}

/// The name that a sidecar of this table has.
pub(crate) fn sidecar_name(path: &Path) -> String {
    let sidecar = path.with_extension("toml");
    sidecar.file_name().map_or_else(String::new, |n| n.to_string_lossy().into_owned())
}

/// What to do about a row that begins as one of sums does.
pub(crate) fn of_summary(path: &Path, first: &str) -> String {
    format!(
        "the row begins with `{first}`: where it sums up others it is no observation; write in {}:\n  schema = 1\n  [file]\n  leave_out = [\"{first}\"]\nor leave_out = [] where it is one",
        sidecar_name(path)
    )
}

/// What to do about a number that stands for no measurement.
pub(crate) fn of_sentinel(value: f64) -> String {
    format!(
        "{value} is far from all other numbers, and many programs write it where nothing was measured; if so, declare not_measured = [\"{value}\"], or not_measured = [] where it was"
    )
}

/// Refuses a number that stands for no measurement, unless somebody said that all were measured.
pub(crate) fn refuse_sentinel(
    values: &[f64],
    header: &str,
    file: &FileWords,
    place: &dyn Fn(usize) -> Place,
) -> Result<(), RecordError> {
    match sentinel(values).filter(|_| file.not_measured.as_ref().is_none_or(|words| !words.is_empty())) {
        Some((row, value)) => Err(RecordError::column(
            place(row),
            header,
            format!(": {}; in a sidecar, under [file]", of_sentinel(value)),
        )),
        None => Ok(()),
    }
}
