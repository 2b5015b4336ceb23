//! Text output of OpenFAST and its drivers: `.out`.
//!
//! Some lines of description, a line of names, a line of units in parentheses, then a row per time step, separated by tabs or blanks.
//!
//! **Source.** OpenFAST, `FAST_Subs.f90` (`FAST_InitOutput`) and the drivers of its modules; FAST v7 and v8 write the same.

use crate::{Cells, Column, ForeignError, Part};

/// Most lines before the line of units.
const MAX_HEAD: usize = 40;

/// Reads a text output; units are those of the file without their parentheses.
///
/// # Errors
///
/// No line of units, names and units that differ in number, a name twice, a row with another number of cells, or a cell that is not a number.
pub fn read(text: &str) -> Result<Part, ForeignError> {
    let lines: Vec<&str> = text.lines().collect();
    let refuse = |line: usize, what: String| ForeignError(format!("line {}: {what}", line + 1));
    let is_units = |line: &str| {
        let mut words = line.split_whitespace().peekable();
        words.peek().is_some() && words.all(|word| word.starts_with('(') && word.ends_with(')'))
    };
    let at = lines.iter().take(MAX_HEAD).position(|line| is_units(line)).filter(|at| *at > 0).ok_or_else(|| {
        ForeignError("no line of units in parentheses, as (s) (m/s) (kN), below a line of names; expected the text output of OpenFAST (.out)".to_owned())
    })?;
    let (Some(head), Some(under)) = (lines.get(at - 1), lines.get(at)) else { return Ok(Part::default()) };
    let names: Vec<&str> = head.split_whitespace().collect();
    let units: Vec<&str> = under.split_whitespace().map(|word| word.trim_matches(['(', ')'])).collect();
    if names.len() != units.len() {
        let what = format!(
            "{} units, and {} names in the line before; expected a unit for each name",
            units.len(),
            names.len()
        );
        return Err(refuse(at, what));
    }
    if let Some((i, name)) = names.iter().enumerate().find(|(i, name)| names[..*i].contains(name)) {
        return Err(refuse(
            at - 1,
            format!(
                "column {}: {name:?} is the name of an earlier column too; list each output once in OutList",
                i + 1
            ),
        ));
    }
    let mut cells: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    for (i, line) in lines.iter().enumerate().skip(at + 1) {
        if line.trim().is_empty() {
            continue;
        }
        let words: Vec<&str> = line.split_whitespace().collect();
        if words.len() != names.len() {
            let end = if i + 1 == lines.len() { ": the simulation ended within this line; delete it" } else { "" };
            return Err(refuse(i, format!("{} cells, and there are {} columns{end}", words.len(), names.len())));
        }
        for (k, (word, column)) in words.iter().zip(&mut cells).enumerate() {
            let number = number(word)
                .map_err(|what| refuse(i, format!("column {} ({}): {what}", k + 1, names.get(k).unwrap_or(&""))))?;
            column.push(number);
        }
    }
    let columns = names.iter().zip(units).zip(cells).map(|((name, unit), cells)| Column {
        name: (*name).to_owned(),
        unit: unit.to_owned(),
        cells: Cells::Numbers(cells),
    });
    Ok(Part { name: String::new(), columns: columns.collect() })
}

fn number(word: &str) -> Result<f64, String> {
    if word.starts_with('*') {
        return Err(format!(
            "{word:?}: the number did not fit its format; widen OutFmt in the .fst file (\"ES15.7E2\") and run it again"
        ));
    }
    word.parse().map_err(|_| format!("{word:?} is not a number"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const OUT: &str = "\nPredictions were generated on 28-Apr-2026 at 14:02:15 using OpenFAST, compiled as a 64-bit application\nlinked with NWTC Subroutine Library\n\nDescription from the FAST input file: spar\n\nTime\tPtfmSurge\tPtfmPitch\tHydroFxi\tGenTq\n(s)\t(m)\t(deg)\t(N)\t(kN-m)\n0.0000\t 0.000E+00\t 1.000E+00\t-1.500E+03\t 4.000E+00\n0.0250\t 1.000E-03\t 9.990E-01\t-1.400E+03\t NaN\n";

    #[test]
    fn names_units_and_rows_are_those_of_the_file() {
        let part = read(OUT).unwrap();
        let heads: Vec<[&str; 2]> = part.columns.iter().map(|c| [c.name.as_str(), c.unit.as_str()]).collect();
        assert_eq!(
            heads,
            [["Time", "s"], ["PtfmSurge", "m"], ["PtfmPitch", "deg"], ["HydroFxi", "N"], ["GenTq", "kN-m"]]
        );
        assert_eq!(part.columns[3].cells, Cells::Numbers(vec![-1500.0, -1400.0]));
        let Cells::Numbers(torque) = &part.columns[4].cells else { panic!("{part:?}") };
        assert!(torque[1].is_nan());
        // By blanks, with the ends of lines of another system.
        assert_eq!(read(&OUT.replace('\t', "   ").replace('\n', "\r\n")).unwrap().columns[..4], part.columns[..4]);
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        for (from, to, said) in [
            ("(deg)\t", "", "line 8: 4 units, and 5 names in the line before; expected a unit for each name"),
            (
                "PtfmPitch",
                "PtfmSurge",
                "line 7: column 3: \"PtfmSurge\" is the name of an earlier column too; list each output once in OutList",
            ),
            (
                "\t NaN\n",
                "\n",
                "line 10: 4 cells, and there are 5 columns: the simulation ended within this line; delete it",
            ),
            ("-1.500E+03\t", "", "line 9: 4 cells, and there are 5 columns"),
            ("1.000E-03", "1,000", "line 10: column 2 (PtfmSurge): \"1,000\" is not a number"),
            (
                "1.000E-03",
                "*********",
                "line 10: column 2 (PtfmSurge): \"*********\": the number did not fit its format; widen OutFmt in the .fst file (\"ES15.7E2\") and run it again",
            ),
        ] {
            assert_eq!(read(&OUT.replacen(from, to, 1)).unwrap_err().0, said, "{from}");
        }
        assert!(read("Time speed\n0 1\n").unwrap_err().0.starts_with("no line of units in parentheses"));
        assert!(read("").is_err());
    }
}
