//! Force files of OpenFOAM, as its function objects `forces` and `forceCoeffs` write them.
//!
//! | file | of | numbers after the time |
//! | --- | --- | --- |
//! | `force.dat`, `moment.dat` | OpenFOAM.com since v1706 | total, by pressure, viscous and, with porosity, of the porous zones; in parentheses up to v2106 |
//! | `forces.dat` | OpenFOAM.org, and both before 2017 | forces and then moments: by pressure, viscous and, with porosity, of the porous zones |
//! | `coefficient.dat`, `forceCoeffs.dat` | both | columns that the header names |
//!
//! What a file is follows from its comment lines, not from its name; columns are found by the names there, and a total that is not the sum of its parts is rejected.
//!
//! **Source.** OpenFOAM v1706 to v2306, `src/functionObjects/forces`; OpenFOAM.org 2.3 to 11, the same folder.

use crate::history::Sample;

/// What a force file holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Forces: `force.dat`.
    Force,
    /// Moments: `moment.dat`.
    Moment,
    /// Both: `forces.dat`.
    Both,
    /// Coefficients: `coefficient.dat`, `forceCoeffs.dat`.
    Coefficients,
}

/// A force file as it was read.
#[derive(Debug, Clone, PartialEq)]
pub struct Dat {
    /// What it holds.
    pub kind: Kind,
    /// Its comment lines `# key : value`.
    pub header: Vec<(String, String)>,
    /// Names of its columns, without the time.
    pub columns: Vec<String>,
    /// Time of each row: s, or iterations.
    pub times: Vec<f64>,
    /// The other numbers, row by row.
    numbers: Vec<f64>,
    /// Whether its last line has no end and was left out: a solver may still be writing it.
    pub is_cut: bool,
}

/// What is wrong with a file: its line from 1, and why.
pub type Problem = (usize, String);

/// Most lines at the head of a file that are looked at for the names of its columns.
const MAX_HEAD: usize = 60;

/// What a file is by its comment lines; `None` if it is not a force file.
#[must_use]
pub fn kind_of(text: &str) -> Option<Kind> {
    head(text).map(|(kind, _)| kind)
}

/// Kind and names of the columns, from the title and the comment line that names the time.
fn head(text: &str) -> Option<(Kind, Vec<String>)> {
    let comments = text.lines().take(MAX_HEAD).filter_map(|line| line.trim_start().strip_prefix('#')).map(str::trim);
    let names = comments.clone().find_map(|line| line.strip_prefix("Time"))?;
    let title = comments.map(str::to_ascii_lowercase).find(|line| !line.is_empty())?;
    if names.contains("forces") && names.contains("moment") {
        let parts: &[&str] =
            if names.contains("porous") { &["pressure", "viscous", "porous"] } else { &["pressure", "viscous"] };
        let of = |what: &str| parts.iter().flat_map(|part| axes(&format!("{what}_{part}"))).collect::<Vec<_>>();
        return Some((Kind::Both, [of("force"), of("moment")].concat()));
    }
    let columns: Vec<String> = names
        .split(|c: char| c.is_whitespace() || c == '(' || c == ')')
        .filter(|word| !word.is_empty())
        .map(str::to_owned)
        .collect();
    let has = |name: &str| columns.iter().any(|column| column == name);
    // `Cd(f)` and `Cl(r)` keep their parentheses.
    let coefficients: Vec<String> = names.split_whitespace().map(str::to_owned).collect();
    if ["Cd", "Cl", "Cm"].iter().any(|name| coefficients.iter().any(|column| column == name)) {
        return Some((Kind::Coefficients, coefficients));
    }
    match title {
        _ if !has("total_x") => None,
        title if title.starts_with("moment") => Some((Kind::Moment, columns)),
        title if title.starts_with("force") => Some((Kind::Force, columns)),
        _ => None,
    }
}

fn axes(name: &str) -> [String; 3] {
    ["x", "y", "z"].map(|axis| format!("{name}_{axis}"))
}

/// Reads a force file.
///
/// # Errors
///
/// The text is not a force file, a line has too few or too many numbers, times do not increase, or a total is not the sum of its parts.
pub fn read(text: &str) -> Result<Dat, Problem> {
    let Some((kind, columns)) = head(text) else {
        let expected = "its comment lines do not name the columns of forces, moments or coefficients, as `# Time total_x total_y …`, `# Time forces(pressure viscous) moments(pressure viscous)` or `# Time Cd Cl …` do";
        return Err((1, expected.to_owned()));
    };
    let whole = text.rfind('\n').map_or("", |end| &text[..=end]);
    let is_cut = whole.len() < text.len();
    let mut out = Dat { kind, header: Vec::new(), columns, times: Vec::new(), numbers: Vec::new(), is_cut };
    for (index, line) in whole.lines().enumerate() {
        let refuse = |problem: String| (index + 1, problem);
        let line = line.trim();
        if let Some(comment) = line.strip_prefix('#') {
            if let Some((key, value)) = comment.split_once(':') {
                out.header.push((key.trim().to_owned(), value.trim().to_owned()));
            }
            continue;
        }
        let words = line.split(|c: char| c.is_whitespace() || c == '(' || c == ')').filter(|word| !word.is_empty());
        let start = out.numbers.len();
        let mut time = None;
        for word in words {
            let number: f64 = word.parse().map_err(|_| refuse(format!("{word:?} is not a number")))?;
            if time.is_none() {
                time = Some(number);
            } else {
                out.numbers.push(number);
            }
        }
        let Some(time) = time else { continue };
        let found = out.numbers.len() - start;
        if found != out.columns.len() {
            return Err(refuse(format!(
                "has {found} numbers after the time; the header names {}: {}",
                out.columns.len(),
                out.columns.join(" ")
            )));
        }
        if let Some(last) = out.times.last().filter(|last| time.is_nan() || time <= **last) {
            return Err(refuse(format!("the time {time} does not follow {last}")));
        }
        out.times.push(time);
        if matches!(kind, Kind::Force | Kind::Moment) {
            out.check_total(out.times.len() - 1).map_err(refuse)?;
        }
    }
    Ok(out)
}

/// A total may differ from the sum of its parts by this part of the largest number of its row: files have four digits and more.
const ROUNDING: f64 = 2e-3;

impl Dat {
    /// Value of a comment line; the first, where there are several.
    #[must_use]
    pub fn stated(&self, key: &str) -> Option<&str> {
        self.header.iter().find(|(own, _)| own.eq_ignore_ascii_case(key)).map(|(_, value)| value.as_str())
    }

    /// A row's number in a column; `None` if there is no such column.
    #[must_use]
    pub fn number(&self, row: usize, column: &str) -> Option<f64> {
        let at = self.columns.iter().position(|own| own == column)?;
        self.numbers.get(row * self.columns.len() + at).copied()
    }

    /// Three numbers of a row; `None` if there are no such columns.
    fn vector(&self, row: usize, name: &str) -> Option<[f64; 3]> {
        let [x, y, z] = axes(name).map(|column| self.number(row, &column));
        Some([x?, y?, z?])
    }

    fn check_total(&self, row: usize) -> Result<(), String> {
        let part = |name: &str| self.vector(row, name);
        let (Some(total), Some(pressure), Some(viscous)) = (part("total"), part("pressure"), part("viscous")) else {
            return Err(format!(
                "the header names {}; expected total, pressure and viscous along x, y and z",
                self.columns.join(" ")
            ));
        };
        let porous = part("porous").or_else(|| part("internal")).unwrap_or_default();
        let sum: [f64; 3] = std::array::from_fn(|k| pressure[k] + viscous[k] + porous[k]);
        let largest = [total, pressure, viscous, porous].concat().iter().fold(0.0_f64, |most, x| most.max(x.abs()));
        match (0..3).find(|k| (total[*k] - sum[*k]).abs() > ROUNDING * largest) {
            Some(k) => Err(format!(
                "the total along {} is {}, but its parts sum to {}; expected the columns total, pressure, viscous and, where there are porous zones, theirs",
                ["x", "y", "z"][k],
                total[k],
                sum[k]
            )),
            None => Ok(()),
        }
    }

    /// By pressure, and all the rest, of a row; `what` is empty, `force_` or `moment_`.
    fn parts(&self, row: usize, what: &str) -> [[f64; 3]; 2] {
        let part = |name: &str| self.vector(row, &format!("{what}{name}"));
        let viscous = part("viscous").unwrap_or_default();
        let porous = part("porous").or_else(|| part("internal")).unwrap_or_default();
        [part("pressure").unwrap_or_default(), std::array::from_fn(|k| viscous[k] + porous[k])]
    }

    /// Loads of every row, in the axes of the mesh: of `forces.dat`, or of `force.dat` with its `moment.dat`.
    ///
    /// # Errors
    ///
    /// Forces and moments differ in their times.
    pub fn samples(&self, moments: Option<&Self>) -> Result<Vec<Sample>, Problem> {
        let is_both = self.kind == Kind::Both;
        let of_moments = moments.unwrap_or(self);
        let rows = self.times.len().min(of_moments.times.len());
        // The last row of one may not be written yet; more is a file of another run.
        if self.times.len().abs_diff(of_moments.times.len()) > 1 {
            let last = |times: &[f64]| times.last().map_or_else(|| "no time".to_owned(), f64::to_string);
            return Err((
                rows,
                format!(
                    "the forces have {} rows up to {}, the moments {} up to {}: they are not of one run",
                    self.times.len(),
                    last(&self.times),
                    of_moments.times.len(),
                    last(&of_moments.times)
                ),
            ));
        }
        let mut out = Vec::with_capacity(rows);
        for (row, (time, other)) in self.times.iter().zip(&of_moments.times).enumerate() {
            if time != other {
                return Err((
                    row + 1,
                    format!("row {} is at the time {other}, and that of the forces at {time}", row + 1),
                ));
            }
            let [pressure, rest] = self.parts(row, if is_both { "force_" } else { "" });
            let [turning, rest_of_it] = match moments {
                Some(moments) => moments.parts(row, ""),
                None if is_both => self.parts(row, "moment_"),
                None => [[0.0; 3]; 2],
            };
            let six = |[x, y, z]: [f64; 3], [k, m, n]: [f64; 3]| [x, y, z, k, m, n];
            out.push(Sample { time: *time, pressure: six(pressure, turning), viscous: six(rest, rest_of_it) });
        }
        Ok(out)
    }
}

/// Three numbers of a comment line: `(0 0 0)`.
#[must_use]
pub fn triple(text: &str) -> Option<[f64; 3]> {
    let inner = text.trim().strip_prefix('(')?.strip_suffix(')')?;
    let numbers: Vec<f64> = inner.split_whitespace().map(|word| word.parse().ok()).collect::<Option<_>>()?;
    <[f64; 3]>::try_from(numbers).ok().filter(|all| all.iter().all(|x| x.is_finite()))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// v2112 and later.
    const FORCE: &str = "# Force\n# CofR                : (0.5 0 0)\n# Time          \ttotal_x\ttotal_y\ttotal_z\tpressure_x\tpressure_y\tpressure_z\tviscous_x\tviscous_y\tviscous_z\n0.1\t5 7 9 1 2 3 4 5 6\n0.2\t5 7 9 -1 2 3 6 5 6\n";
    /// v1912, with a porous zone.
    const OLD: &str = "# Force       \n# CofR                : (0 0 0)\n#\n# Time          \t(total_x total_y total_z)\t(pressure_x pressure_y pressure_z)\t(viscous_x viscous_y viscous_z)\t(porous_x porous_y porous_z)\n1\t(6 7 9)\t(1 2 3)\t(4 5 6)\t(1 0 0)\n";
    const BOTH: &str = "# Forces\n# CofR : (0 0 0)\n# Time forces(pressure viscous) moments(pressure viscous)\n0.1 ((1 2 3) (4 5 6)) ((7 8 9) (1 1 1))\n";
    const COEFFICIENTS: &str = "# Force coefficients\n# dragDir : (1 0 0)\n# Aref : 0.75\n# Time \tCm\tCd\tCl\tCl(f)\tCl(r)\n1\t0.1\t0.2\t0.3\t0.1\t0.2\n";

    #[test]
    fn each_family_is_told_by_its_comment_lines() {
        for (text, kind) in [
            (FORCE, Kind::Force),
            (OLD, Kind::Force),
            (BOTH, Kind::Both),
            (COEFFICIENTS, Kind::Coefficients),
            (&FORCE.replace("# Force", "# Moment"), Kind::Moment),
        ] {
            assert_eq!(kind_of(text), Some(kind), "{text}");
        }
        for text in ["", "1 2 3\n", "# Time speed\n1 2\n", "2 0\n1 0. 0. 0.\n", "time,total_x\n1,2\n"] {
            assert_eq!(kind_of(text), None, "{text}");
        }
    }

    #[test]
    fn loads_are_read_by_the_names_of_their_columns() {
        let samples = |text: &str| read(text).unwrap().samples(None).unwrap();
        assert_eq!(samples(FORCE)[1].total(), [5.0, 7.0, 9.0, 0.0, 0.0, 0.0]);
        assert_eq!(samples(FORCE)[1].pressure[0], -1.0);
        assert_eq!(samples(OLD)[0].total(), [6.0, 7.0, 9.0, 0.0, 0.0, 0.0]);
        assert_eq!(samples(BOTH)[0].total(), [5.0, 7.0, 9.0, 8.0, 9.0, 10.0]);
        let porous = BOTH
            .replace("viscous)", "viscous porous)")
            .replace("(4 5 6)", "(4 5 6) (1 0 0)")
            .replace("(1 1 1)", "(1 1 1) (0 0 1)");
        assert_eq!(samples(&porous)[0].total(), [6.0, 7.0, 9.0, 8.0, 9.0, 11.0]);
        let found = read(COEFFICIENTS).unwrap();
        assert_eq!(
            (found.number(0, "Cd"), found.number(0, "Cl(f)"), found.number(0, "Cs")),
            (Some(0.2), Some(0.1), None)
        );
        assert_eq!((found.stated("aref"), found.stated("lRef")), (Some("0.75"), None));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_line() {
        let refused = |text: &str| read(text).unwrap_err();
        assert_eq!(refused(&FORCE.replace("0.2\t5", "0.2\tx")), (5, "\"x\" is not a number".to_owned()));
        assert_eq!(refused(&FORCE.replace("0.2\t", "0.1\t")), (5, "the time 0.1 does not follow 0.1".to_owned()));
        let (line, problem) = refused(&FORCE.replace("6 5 6\n", "6 5\n"));
        assert!(
            line == 5 && problem.starts_with("has 8 numbers after the time; the header names 9: total_x"),
            "{problem}"
        );
        let (_, problem) = refused(&FORCE.replace(
            "total_x\ttotal_y\ttotal_z\tpressure_x\tpressure_y\tpressure_z",
            "pressure_x\tpressure_y\tpressure_z\ttotal_x\ttotal_y\ttotal_z",
        ));
        assert!(problem.starts_with("the total along x is 1, but its parts sum to 9"), "{problem}");
        assert!(refused("1 2 3\n").1.starts_with("its comment lines do not name the columns"));
        let force = read(FORCE).unwrap();
        let later = read(&FORCE.replace("# Force", "# Moment").replace("0.2", "0.3")).unwrap();
        assert_eq!(
            force.samples(Some(&later)).unwrap_err().1,
            "row 2 is at the time 0.3, and that of the forces at 0.2"
        );
    }

    #[test]
    fn a_last_line_without_an_end_is_left_out_and_said() {
        let cut = read(&FORCE[..FORCE.len() - 2]).unwrap();
        assert_eq!((cut.times.len(), cut.is_cut), (1, true));
        assert!(!read(FORCE).unwrap().is_cut);
    }

    #[test]
    fn three_numbers_stand_in_parentheses() {
        assert_eq!(triple(" (0.5 0 -1e-3) "), Some([0.5, 0.0, -1e-3]));
        for text in ["", "0 0 0", "(0 0)", "(0 0 nan)", "(0 0 0 0)"] {
            assert_eq!(triple(text), None, "{text}");
        }
    }

    proptest! {
        #[test]
        fn arbitrary_text_never_panics(cut in 0..OLD.len(), at in 0..OLD.len(), with in "[0-9a-z().#\n é-]{0,6}") {
            let _ = read(&OLD[..cut]);
            let mut edited = OLD.to_owned();
            edited.replace_range(at..=at, &with);
            let _ = read(&edited).map(|found| found.samples(None));
        }
    }
}
