//! Rows of a table that are no observations: sums of others, scales and offsets, words among the numbers of runs.

use std::path::Path;

use froude_foreign::marks::shape;

use crate::file_words::sidecar_name;

/// What rows that sum up others begin with, in small letters and digits alone.
const SUMS: [&str; 135] = [
    "mean",
    "means",
    "meanvalue",
    "average",
    "averages",
    "avg",
    "ave",
    "mw",
    "mittelw",
    "mittel",
    "mittelwert",
    "mittelwerte",
    "mitt",
    "gemittelt",
    "durchschnitt",
    "durchschnittswert",
    "standardfehler",
    "standarderror",
    "uncertainty",
    "unsicherheit",
    "messunsicherheit",
    "gesamt",
    "gesamtmittel",
    "gesamtsumme",
    "ergebnis",
    "summe",
    "anzahl",
    "varianz",
    "spannweite",
    "stabw",
    "stdabw",
    "standardabw",
    "standardabweichung",
    "std",
    "stdev",
    "stddev",
    "stdevp",
    "stdevs",
    "stabws",
    "standdev",
    "standarddeviation",
    "rsd",
    "relstd",
    "sem",
    "var",
    "variance",
    "subtotal",
    "total",
    "sum",
    "count",
    "median",
    "rms",
    "min",
    "max",
    "minimum",
    "maximum",
    "maks",
    "sigma",
    "moy",
    "moyenne",
    "écart",
    "ecart",
    "écarttype",
    "ecarttype",
    "ecartype",
    "somme",
    "mediana",
    "varianza",
    "mín",
    "máx",
    "mínimo",
    "máximo",
    "suma",
    "promedio",
    "desvest",
    "desviacionestandar",
    "desviaciónestándar",
    "gjennomsnitt",
    "snitt",
    "stdavvik",
    "stavvik",
    "standardavvik",
    "middel",
    "middelverdi",
    "minste",
    "største",
    "medel",
    "gemiddelde",
    "średnia",
    "média",
    "keskiarvo",
    "среднее",
    "ortalama",
    "平均",
    "平均値",
    "標準偏差",
    "最大",
    "最小",
    "最大値",
    "最小値",
    "中央値",
    "偏差",
    "合計",
    "小計",
    "ø",
    "x̄",
    "σ",
    "±",
    "u95",
    "ci95",
    "p95",
    "q1",
    "q3",
    "durchschn",
    "mw1",
    "abweichung",
    "fehler",
    "ecarttypen1",
    "desviación",
    "desviacion",
    "gjennomsnittsverdi",
    "medelvärde",
    "genomsnitt",
    "totaal",
    "totale",
    "summa",
    "итого",
    "平均值",
    "均值",
    "평균",
    "průměr",
    "átlag",
    "desviopadrão",
    "leerlauf",
    "nullpunkt",
];

/// Those that also name bodies, places and directions: asked about at the end of a table alone.
const LAST_SUMS: [&str; 8] = ["se", "sd", "cv", "cov", "ci", "range", "peak", "media"];

/// Words that say so among others: `Run mean`, `Mittel Lauf 1-4`.
const SUM_WORDS: [&str; 19] = [
    "mean",
    "average",
    "avg",
    "ave",
    "std",
    "stdev",
    "stddev",
    "stabw",
    "mittel",
    "mittelwert",
    "mittelwerte",
    "moyenne",
    "promedio",
    "gjennomsnitt",
    "median",
    "summe",
    "sum",
    "total",
    "gesamt",
];

/// What rows begin with that scale or shift the numbers below.
const SCALES: [&str; 13] = [
    "offset",
    "factor",
    "faktor",
    "scale",
    "skalierung",
    "skalenfaktor",
    "gain",
    "multiplier",
    "sensitivity",
    "verstärkung",
    "empfindlichkeit",
    "calibration",
    "kalibrierung",
];

/// Why a row is no observation.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Odd {
    /// It sums up others.
    Sum,
    /// It scales or shifts others.
    Scale,
}

/// What a cell says of its row: `Mean`, `Std. dev.:`, `25%`, `Faktor`.
pub(crate) fn odd(cell: &str) -> Option<Odd> {
    let is_number = cell.bytes().any(|b| b.is_ascii_digit())
        && cell.bytes().all(|b| b.is_ascii_digit() || matches!(b, b'.' | b',' | b'+' | b'-' | b' '));
    if is_number || cell.parse::<f64>().is_ok() || cell.starts_with(['=', '@', '\'']) {
        return None;
    }
    let lower = cell.trim().to_lowercase();
    let words =
        || lower.split(|c: char| !c.is_alphanumeric()).map(|word| word.trim_end_matches(|c: char| c.is_ascii_digit()));
    let is_part = lower.ends_with('%') && lower.trim_end_matches('%').trim_end().parse::<f64>().is_ok();
    if words().any(|word| SCALES.contains(&word)) {
        Some(Odd::Scale)
    } else if is_part
        || matches!(lower.trim(), "+/-" | "+-")
        || is_statistic(&lower)
        || words().any(|word| SUM_WORDS.contains(&word))
        || has_count(&lower)
    {
        Some(Odd::Sum)
    } else {
        None
    }
}

/// Whether a note beside numbers says that its row sums up others: `Mean`, `mean of 1 to 3`; other sentences may speak of a maximum.
pub(crate) fn is_sum_in_note(note: &str) -> bool {
    let lower = note.to_lowercase();
    let mut words = lower.split_whitespace();
    let begins = words.next().is_some_and(|word| SUM_WORDS.contains(&word.trim_end_matches('.')))
        && words.next().is_some_and(|word| {
            ["of", "over", "from", "von", "aus", "de", "der", "des", "run", "runs"].contains(&word)
                || word.starts_with(|c: char| c.is_ascii_digit())
        });
    odd(note) == Some(Odd::Sum) && !LAST_SUMS.contains(&bare(&lower).as_str()) && (begins || !note.contains(' '))
}

/// Whether a text is a statistic alone, `Mean`, `Std. dev.`, and not one among other words, as `Total resistance` is.
pub(crate) fn is_statistic(text: &str) -> bool {
    let whole = bare(&text.to_lowercase());
    SUMS.contains(&whole.as_str()) || LAST_SUMS.contains(&whole.as_str())
}

/// The first cell of a row with content.
pub(crate) fn label<C: AsRef<str>>(cells: &[C]) -> &str {
    cells.iter().map(|cell| cell.as_ref().trim()).find(|cell| !cell.is_empty()).unwrap_or_default()
}

/// Letters and digits of a label in small letters.
fn bare(lower: &str) -> String {
    lower.chars().filter(|c| c.is_alphanumeric() || matches!(c, '±' | '\u{304}')).collect()
}

/// Finds the rows whose label says that they sum up or scale others.
#[derive(Debug, Default)]
pub(crate) struct OddRows {
    first: Option<String>,
    are_many: bool,
    n: usize,
    held: Option<(usize, String)>,
}

impl OddRows {
    /// Takes in the label of a row on a line; the row that is to be asked about.
    ///
    /// Where all labels are one word, it says what the table holds, and no row sums up others.
    pub(crate) fn see(&mut self, label: &str, line: usize) -> Option<(usize, String)> {
        self.n += 1;
        let first = self.first.get_or_insert_with(|| label.to_owned());
        let becomes_many = !self.are_many && first != label;
        self.are_many |= becomes_many;
        let is_last = |word: &str| LAST_SUMS.contains(&bare(&word.to_lowercase()).as_str());
        let released = self.held.take_if(|(_, word)| becomes_many && !is_last(word));
        if odd(label).is_none() {
            self.held.take_if(|_| self.are_many);
            return released;
        }
        if self.are_many && !is_last(label) {
            return released.or_else(|| Some((line, label.to_owned())));
        }
        self.held.get_or_insert_with(|| (line, label.to_owned()));
        released
    }

    /// The row that only the end of the table shows to be one.
    pub(crate) fn end(self) -> Option<(usize, String)> {
        self.held.filter(|_| self.are_many || self.n == 1)
    }
}

/// `n=5`, `U(k=2)`, `95% CI`: a letter, or a part, and a number.
fn has_count(lower: &str) -> bool {
    let start = lower.split(['=', '(']).next().unwrap_or_default().trim_end();
    let is_interval = lower.contains('%') && lower.split(|c: char| !c.is_alphanumeric()).any(|word| word == "ci");
    let rest =
        lower.get(start.len()..).unwrap_or_default().trim_matches(|c: char| matches!(c, '=' | '(' | ')' | 'k' | ' '));
    is_interval || (rest.parse::<f64>().is_ok() && matches!(start, "n" | "u" | "k"))
}

/// Most rows at the beginning or the end of a table that are no runs.
const ODD_ROWS: usize = 12;
/// Fewest rows with numbers that make words among them odd.
const FEWEST_NUMBERS: usize = 3;

/// Words among the numbers of the first column: `Tara` below `1, 2, 3`, or `Gain` above them.
#[derive(Debug, Default)]
pub(crate) struct Labels {
    numbers: usize,
    blank: usize,
    above: Vec<(usize, String)>,
    below: Vec<(usize, String)>,
    are_mixed: bool,
}

impl Labels {
    /// Takes in the label of a row on a line.
    pub(crate) fn see(&mut self, cell: &str, line: usize) {
        if self.are_mixed {
            return;
        }
        // `3b` is the number of a run.
        let is_number = shape(cell).is_some()
            || (cell.starts_with(|c: char| c.is_ascii_digit()) && cell.ends_with(|c: char| c.is_ascii_alphabetic()));
        let (is_first, is_blank) = (self.numbers + self.blank == 0, cell.is_empty());
        if is_number || is_blank {
            self.are_mixed = !self.below.is_empty();
            self.numbers += usize::from(is_number);
            self.blank += usize::from(is_blank);
        } else if is_first {
            self.above.push((line, cell.to_owned()));
        } else {
            self.below.push((line, cell.to_owned()));
        }
        self.are_mixed |= self.above.len().max(self.below.len()) > ODD_ROWS;
    }

    /// The words, each with its line; none where they are names of rows as any others.
    pub(crate) fn words(&self) -> impl Iterator<Item = &(usize, String)> {
        let above = !self.are_mixed && self.numbers + self.blank >= FEWEST_NUMBERS;
        let below = !self.are_mixed && self.numbers >= FEWEST_NUMBERS;
        self.above.iter().filter(move |_| above).chain(self.below.iter().filter(move |_| below))
    }
}

/// What to do about a row with a word that says that it is no observation.
pub(crate) fn advice(path: &Path, word: &str, odd: Option<Odd>) -> String {
    let why = match odd {
        Some(Odd::Sum) => "where it sums up others it is no observation",
        Some(Odd::Scale) => {
            "where it scales or shifts the numbers of other rows, nothing applies it: apply it (by the unit of the column, if it is a power of ten), and leave the row out"
        }
        None => "if it is not an observation (a sum, a tare, a scale), leave it out",
    };
    format!(
        "the row begins with `{word}`: {why}; write in {}:\n  schema = 1\n  [file]\n  leave_out = [\"{word}\"]\nor leave_out = [] if it is an observation",
        sidecar_name(path)
    )
}

/// Whether a text above or below a name scales its numbers: `x1000`, `×10⁻³`, `E-3`, `Faktor 10`.
pub(crate) fn is_scale(text: &str) -> bool {
    let lower = text.trim().to_lowercase();
    let after = |marks: &[char]| lower.strip_prefix(marks).map(str::trim_start);
    let begins_with_digit = |rest: &str| rest.starts_with(|c: char| c.is_ascii_digit());
    after(&['x', '×', '*', '·', '/', '÷']).is_some_and(begins_with_digit)
        || ["10^", "10⁻", "e-", "e+"].iter().any(|start| lower.starts_with(start))
        || lower.strip_prefix('e').is_some_and(|rest| rest.parse::<u32>().is_ok())
        || (odd(&lower) == Some(Odd::Scale) && lower.contains(|c: char| c.is_ascii_digit()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_and_scales_are_told_by_their_words() {
        for cell in [
            "Max.",
            "Mw.",
            "Stabw.",
            "STDEV.S",
            "St. dev.",
            "arith. Mittel",
            "Mittel Lauf 1-4",
            "Mean1",
            "<mean>",
            "Run mean",
            "25%",
            "95 % CI",
            "n=5",
            "U(k=2)",
            "Écart type",
            "Desv.Est.",
            "最大",
            "Mean (n = 5)",
            "ø",
            "Średnia",
            "Min:",
            "-Mean-",
            "+/-",
            "Durchschnittswert",
            "Mittelwerte 1-2",
            "standard error",
            "Uncertainty",
            "SD",
        ] {
            assert_eq!(odd(cell), Some(Odd::Sum), "{cell}");
        }
        for cell in ["Faktor", "Scale", "gain 100", "Cal. factor", "Offset:"] {
            assert_eq!(odd(cell), Some(Odd::Scale), "{cell}");
        }
        for cell in ["1", "run 12", "H1LT", "maximus", "3b", "meander", "tow_07", "A1", ""] {
            assert_eq!(odd(cell), None, "{cell}");
        }
        for text in ["x1000", "×10⁻³", "*10", "E-3", "e3", "10^-3", "/10", "Faktor 10"] {
            assert!(is_scale(text), "{text}");
        }
        for text in ["x", "xi", "f_x", "E", "Fx 1", "10 Hz", "eta", "scale"] {
            assert!(!is_scale(text), "{text}");
        }
    }

    #[test]
    fn a_word_that_begins_every_row_does_not_mark_a_summary() {
        let asked = |labels: &[&str]| {
            let mut rows = OddRows::default();
            let found: Vec<_> =
                labels.iter().enumerate().filter_map(|(line, label)| rows.see(label, line)).map(|(at, _)| at).collect();
            found.into_iter().chain(rows.end().map(|(at, _)| at)).collect::<Vec<_>>()
        };
        assert_eq!(asked(&["Mean", "Mean", "Mean"]), [0_usize; 0]);
        assert_eq!(asked(&["Mean"]), [0]);
        assert_eq!(asked(&["Mean", "Std"]), [0]);
        assert_eq!(asked(&["Mean", "Mean", "a"]), [0]);
        assert_eq!(asked(&["a", "b", "Mean", "c", "d", "Mean"]), [2, 5]);
        assert_eq!(asked(&["N", "SE", "S", "SW"]), [0_usize; 0]);
        assert_eq!(asked(&["SE", "N", "S"]), [0_usize; 0]);
        assert_eq!(asked(&["a", "b", "SD"]), [2]);
        assert_eq!(asked(&["SE", "SE", "Mean"]), [2, 0]);
        assert!(
            ["Mean", "mean of 1 to 3", "avg. of runs 1-3", "Mittelwert der Fahrten 1-3"]
                .iter()
                .all(|note| is_sum_in_note(note))
        );
        assert!(!["average weather", "SE", "good"].iter().any(|note| is_sum_in_note(note)));
    }

    #[test]
    fn words_among_numbers_are_odd_above_and_below_them() {
        let words = |cells: &[&str]| {
            let mut labels = Labels::default();
            cells.iter().enumerate().for_each(|(line, cell)| labels.see(cell, line));
            labels.words().map(|(_, word)| word.clone()).collect::<Vec<_>>().join(" ")
        };
        assert_eq!(words(&["1", "2", "3", "Tara", "Fehler"]), "Tara Fehler");
        assert_eq!(words(&["Gain", "", "", ""]), "Gain");
        assert_eq!(words(&["1", "2", "3", "3b"]), "");
        assert_eq!(words(&["1", "a", "2", "3"]), "");
        assert_eq!(words(&["a", "b", "c"]), "");
        assert_eq!(words(&["", "", "", "note"]), "");
    }
}
