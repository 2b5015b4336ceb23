//! Forces and moments of each iteration, as the solver wrote them.
//!
//! A restart writes into a folder of its own, named by its start; all are read in their order, and what a later one repeats takes the place of what it repeats. The last line of a file that is still written may be half there and is left out.

use std::path::{Path, PathBuf};

use crate::foam_error::FoamError;
use crate::input;
use crate::outcome::Loads;

/// Loads of one iteration or step on the whole body, body axes, N and N m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Iteration, or time in s.
    pub time: f64,
    /// By pressure.
    pub pressure: Loads,
    /// By friction.
    pub viscous: Loads,
}

impl Sample {
    /// Both together.
    #[must_use]
    pub fn total(&self) -> Loads {
        std::array::from_fn(|i| self.pressure[i] + self.viscous[i])
    }
}

/// Reads `postProcessing/forces/<start>/force.dat` and `moment.dat` of a case's folder.
///
/// Of a half body each load that its plane of symmetry z = 0 leaves is doubled; the others, f_z, m_x and m_y, are zero. A case that has written nothing yet has no samples.
///
/// # Errors
///
/// [`FoamError`]: a line is not numeric, times do not increase, or forces and moments differ in their times.
pub fn read(case: &Path, is_half: bool) -> Result<Vec<Sample>, FoamError> {
    let mut samples: Vec<Sample> = Vec::new();
    for folder in starts(&case.join("postProcessing/forces"))? {
        let forces = table(&folder.join("force.dat"))?;
        let moments = table(&folder.join("moment.dat"))?;
        if let Some(first) = forces.first() {
            samples.retain(|sample| sample.time < first.time);
        }
        for (force, moment) in forces.iter().zip(&moments) {
            if force.time != moment.time {
                let problem = format!("has the time {} where force.dat has {}", moment.time, force.time);
                return Err(FoamError::at(&folder.join("moment.dat"), problem));
            }
            samples.push(Sample {
                time: force.time,
                pressure: loads(force.pressure, moment.pressure, is_half),
                viscous: loads(force.viscous, moment.viscous, is_half),
            });
        }
    }
    Ok(samples)
}

fn loads([x, y, z]: [f64; 3], [k, m, n]: [f64; 3], is_half: bool) -> Loads {
    if is_half { [2.0 * x, 2.0 * y, 0.0, 0.0, 0.0, 2.0 * n] } else { [x, y, z, k, m, n] }
}

/// Folders of a function object's starts, by their times.
pub(crate) fn starts(folder: &Path) -> Result<Vec<PathBuf>, FoamError> {
    let failed = |e: std::io::Error| FoamError::at(folder, e);
    let entries = match std::fs::read_dir(folder) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(failed)?,
    };
    let mut starts = Vec::new();
    for entry in entries {
        let path = entry.map_err(failed)?.path();
        let time = path.file_name().and_then(|n| n.to_str()).and_then(|n| n.parse::<f64>().ok());
        if let Some(time) = time.filter(|t| t.is_finite()) {
            starts.push((time, path));
        }
    }
    starts.sort_by(|a, b| a.0.total_cmp(&b.0));
    Ok(starts.into_iter().map(|(_, path)| path).collect())
}

#[derive(Debug, PartialEq)]
struct Row {
    time: f64,
    pressure: [f64; 3],
    viscous: [f64; 3],
}

/// A file's rows; none where it is not there yet.
fn table(path: &Path) -> Result<Vec<Row>, FoamError> {
    let text = match input::bytes(path) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        bytes => bytes.map_err(|e| FoamError::at(path, e))?,
    };
    rows(&String::from_utf8_lossy(&text)).map_err(|(line, problem)| FoamError::in_line(path, line, problem))
}

/// Rows `time (total) (pressure) (viscous)`, with or without parentheses, each up to its line's end.
fn rows(text: &str) -> Result<Vec<Row>, (usize, String)> {
    let whole = text.rfind('\n').map_or("", |end| &text[..end]);
    let mut rows: Vec<Row> = Vec::new();
    for (index, line) in whole.lines().enumerate() {
        if line.trim_start().starts_with('#') || line.trim().is_empty() {
            continue;
        }
        let refuse = |problem: String| (index + 1, problem);
        let numbers = line
            .split(|c: char| c.is_whitespace() || c == '(' || c == ')')
            .filter(|word| !word.is_empty())
            .map(|word| word.parse().map_err(|_| refuse(format!("{word:?} is no number"))))
            .collect::<Result<Vec<f64>, _>>()?;
        let [time, _, _, _, px, py, pz, vx, vy, vz, ..] = numbers[..] else {
            return Err(refuse(format!(
                "has {} numbers; expected the time and three times three: total, by pressure, by friction",
                numbers.len()
            )));
        };
        if let Some(last) = rows.last().filter(|last| time.is_nan() || time <= last.time) {
            return Err(refuse(format!("the time {time} does not follow {}", last.time)));
        }
        rows.push(Row { time, pressure: [px, py, pz], viscous: [vx, vy, vz] });
    }
    Ok(rows)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const FORCE: &str =
        "# Force\n# Time\t(total) (pressure) (viscous)\n1\t(5 7 9) (1 2 3) (4 5 6)\n2\t(5 7 9) (-1e-2 2 3) (4 5 6)\n";

    fn written(starts: &[(&str, &str)]) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        for (start, force) in starts {
            let folder = root.path().join("postProcessing/forces").join(start);
            std::fs::create_dir_all(&folder).unwrap();
            std::fs::write(folder.join("force.dat"), force).unwrap();
            std::fs::write(folder.join("moment.dat"), FORCE).unwrap();
        }
        root
    }

    #[test]
    fn a_half_body_is_doubled_where_its_plane_leaves_a_load() {
        let root = written(&[("0", FORCE)]);
        let whole = read(root.path(), false).unwrap();
        assert_eq!(whole[0].total(), [5.0, 7.0, 9.0, 5.0, 7.0, 9.0]);
        let half = read(root.path(), true).unwrap();
        assert_eq!(half[0].pressure, [2.0, 4.0, 0.0, 0.0, 0.0, 6.0]);
        assert_eq!(half[1].total(), [7.98, 14.0, 0.0, 0.0, 0.0, 18.0]);
    }

    #[test]
    fn a_restart_takes_the_place_of_what_it_repeats() {
        let root = written(&[("0", FORCE), ("1", "2 (1 1 1) (7 7 7) (0 0 0)\n")]);
        let moment = root.path().join("postProcessing/forces/1/moment.dat");
        std::fs::write(moment, "2 (1 1 1) (8 8 8) (0 0 0)\n3 (1 1 1) (8 8 8) (0 0").unwrap();
        let samples = read(root.path(), false).unwrap();
        assert_eq!(samples.len(), 2);
        assert_eq!(samples[1].pressure, [7.0, 7.0, 7.0, 8.0, 8.0, 8.0]);
    }

    #[test]
    fn a_line_that_is_half_written_is_left_out_and_one_that_is_wrong_is_named() {
        assert_eq!(rows(&FORCE[..FORCE.len() - 1]).unwrap().len(), 1);
        assert_eq!(rows("").unwrap(), []);
        let (line, problem) = rows(&FORCE.replace("2\t(5", "2\t(x")).unwrap_err();
        assert_eq!((line, problem.as_str()), (4, "\"x\" is no number"));
        let (_, problem) = rows(&FORCE.replace("2\t(5 7 9)", "1\t(5 7 9)")).unwrap_err();
        assert_eq!(problem, "the time 1 does not follow 1");
        let (_, problem) = rows("1 2 3\n").unwrap_err();
        assert!(problem.starts_with("has 3 numbers"), "{problem}");
    }

    #[test]
    fn a_case_that_wrote_nothing_has_no_samples() {
        assert_eq!(read(tempfile::tempdir().unwrap().path(), false).unwrap(), []);
    }

    proptest! {
        #[test]
        fn no_text_brings_the_reader_down(cut in 0..FORCE.len(), at in 0..FORCE.len(), with in "[0-9a-z().#\n é-]{0,6}") {
            let _ = rows(&FORCE[..cut]);
            let mut edited = FORCE.to_owned();
            edited.replace_range(at..=at, &with);
            let _ = rows(&edited);
        }
    }
}
