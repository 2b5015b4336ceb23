//! What a solver says beside its forces: residuals, time of processors, errors, the largest speed, y+.

use std::path::Path;

use crate::foam_error::FoamError;
use crate::history::starts;
use crate::input;

/// Of a solver's log.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SolverLog {
    /// Initial residual of the pressure's equation, an entry an iteration.
    pub residuals: Vec<f64>,
    /// Time that the solver's runs took of one processor each, s.
    pub cpu_s: f64,
    /// First sentence of its fatal error.
    pub fatal: Option<String>,
}

impl SolverLog {
    /// Reads the log of one run behind another.
    ///
    /// Nothing in it is an error: what says nothing is passed over.
    #[must_use]
    pub fn of(text: &str) -> Self {
        let mut log = Self::default();
        let (mut is_new, mut run_s) = (false, 0.0);
        let mut lines = text.lines();
        while let Some(line) = lines.next() {
            let number = |behind: &str| {
                let rest = line.split(behind).nth(1)?.trim_start();
                rest.split([' ', ',']).next()?.parse::<f64>().ok()
            };
            if line.starts_with("Time = ") {
                is_new = true;
            } else if is_new && line.contains("Solving for p,") {
                log.residuals.extend(number("Initial residual ="));
                is_new = false;
            } else if let Some(spent_s) = number("ExecutionTime =") {
                // A run that starts anew counts from zero.
                if spent_s < run_s {
                    log.cpu_s += run_s;
                }
                run_s = spent_s;
            } else if log.fatal.is_none() && line.contains("FOAM FATAL") {
                let words = |line: &str| line.trim().trim_start_matches("[0]").trim().to_owned();
                log.fatal = lines.by_ref().map(words).find(|line| !line.is_empty());
            }
        }
        log.cpu_s += run_s;
        log
    }
}

/// The largest speed in the field at an iteration or time.
#[derive(Debug, Clone, PartialEq)]
pub struct Fastest {
    /// Iteration, or time in s.
    pub time: f64,
    /// Speed, m/s.
    pub speed_m_s: f64,
    /// Where, body axes in m, as the solver writes it: `(0.1 0 2)`.
    pub place: String,
}

/// The largest speeds that `fieldMinMax` wrote, in the order of its starts.
///
/// # Errors
///
/// [`FoamError`] of a file that cannot be read.
pub fn fastest(case: &Path) -> Result<Vec<Fastest>, FoamError> {
    let texts = texts(case, "speed", "fieldMinMax.dat")?;
    Ok(texts.iter().flat_map(|text| text.lines()).filter_map(fastest_of).collect())
}

/// Of a line `time, field, least, place, [processor,] largest, place[, processor]`.
fn fastest_of(line: &str) -> Option<Fastest> {
    let columns: Vec<&str> = line.split('\t').map(str::trim).collect();
    let mut places = (0..columns.len()).filter(|column| columns[*column].starts_with('('));
    let at = places.nth(1)?;
    let place = columns[at].strip_suffix(')').map(|inner| format!("{inner})"))?;
    Some(Fastest { time: columns[0].parse().ok()?, speed_m_s: columns[at - 1].parse().ok()?, place })
}

/// Least, mean and largest y+ over all walls at the last time that has it; the mean is over walls, not over faces.
///
/// # Errors
///
/// [`FoamError`] of a file that cannot be read.
pub fn y_plus(case: &Path) -> Result<Option<[f64; 3]>, FoamError> {
    let rows = texts(case, "yPlus", "yPlus.dat")?;
    let rows: Vec<(String, [f64; 3])> = rows
        .iter()
        .flat_map(|text| text.lines())
        .filter_map(|line| {
            let mut words = line.split_whitespace();
            let (time, _patch) = (words.next()?, words.next()?);
            let mut number = || words.next()?.parse::<f64>().ok();
            let (least, most, mean) = (number()?, number()?, number()?);
            Some((time.to_owned(), [least, mean, most]))
        })
        .collect();
    let Some((last, _)) = rows.last() else { return Ok(None) };
    let walls: Vec<[f64; 3]> = rows.iter().filter(|(time, _)| time == last).map(|(_, row)| *row).collect();
    Ok(Some([
        walls.iter().map(|row| row[0]).fold(f64::INFINITY, f64::min),
        walls.iter().map(|row| row[1]).sum::<f64>() / walls.len() as f64,
        walls.iter().map(|row| row[2]).fold(0.0, f64::max),
    ]))
}

fn texts(case: &Path, object: &str, file: &str) -> Result<Vec<String>, FoamError> {
    let mut texts = Vec::new();
    for folder in starts(&case.join("postProcessing").join(object))? {
        let path = folder.join(file);
        match input::bytes(&path) {
            Ok(bytes) => texts.push(String::from_utf8_lossy(&bytes).into_owned()),
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => {}
            Err(e) => return Err(FoamError::at(&path, e)),
        }
    }
    Ok(texts)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const LOG: &str = "Time = 1\n\nsmoothSolver:  Solving for Ux, Initial residual = 1, Final residual = 0.03, No Iterations 2\nGAMG:  Solving for p, Initial residual = 0.5, Final residual = 0.02, No Iterations 4\nGAMG:  Solving for p, Initial residual = 0.4, Final residual = 0.02, No Iterations 4\nExecutionTime = 1.5 s  ClockTime = 2 s\n\nTime = 2\nGAMG:  Solving for p, Initial residual = 2.5e-03, Final residual = 1e-05, No Iterations 4\nExecutionTime = 2.5 s  ClockTime = 3 s\nEnd\n";

    #[test]
    fn an_iteration_has_its_first_residual_and_runs_add_up() {
        let log = SolverLog::of(&format!("{LOG}{}", LOG.replace("2.5 s", "3 s")));
        assert_eq!(log.residuals, [0.5, 2.5e-3, 0.5, 2.5e-3]);
        assert_eq!(log.cpu_s, 5.5);
        assert_eq!(log.fatal, None);
    }

    #[test]
    fn a_fatal_error_is_told_by_its_first_sentence() {
        for lead in ["", "[0] "] {
            let log = SolverLog::of(&format!(
                "{LOG}{lead}--> FOAM FATAL ERROR: \n{lead}\n{lead}cannot find file \"p\"\n{lead}\n"
            ));
            assert_eq!(log.fatal.as_deref(), Some("cannot find file \"p\""));
        }
    }

    fn written(object: &str, file: &str, text: &str) -> tempfile::TempDir {
        let root = tempfile::tempdir().unwrap();
        let folder = root.path().join("postProcessing").join(object).join("0");
        std::fs::create_dir_all(&folder).unwrap();
        std::fs::write(folder.join(file), text).unwrap();
        root
    }

    #[test]
    fn the_largest_speed_is_found_with_its_place() {
        let text = "# Time\tfield\tmin\tlocation(min)\tmax\tlocation(max)\n1\tmag(U)\t1e-03\t(0 0 1)\t4e-01\t(1 0 0)\n2\tmag(U)\t1e-03\t(0 0 1)\t9e-01\t(2 0";
        let root = written("speed", "fieldMinMax.dat", text);
        let first = Fastest { time: 1.0, speed_m_s: 0.4, place: "(1 0 0)".to_owned() };
        assert_eq!(fastest(root.path()).unwrap(), std::slice::from_ref(&first));
        let parallel = "1\tmag(U)\t1e-03\t(0 0 1)\t1\t4e-01\t(1 0 0)\t0\n";
        assert_eq!(fastest_of(parallel), Some(first));
    }

    #[test]
    fn y_plus_is_that_of_the_last_time() {
        let text = "# y+ ()\n# Time\tpatch\tmin\tmax\taverage\n40\tbody\t0.1\t9\t2\n60\tbody\t0.2\t8\t1\n60\twall\t0.1\t4\t3\n";
        let root = written("yPlus", "yPlus.dat", text);
        assert_eq!(y_plus(root.path()).unwrap(), Some([0.1, 2.0, 8.0]));
        assert_eq!(y_plus(tempfile::tempdir().unwrap().path()).unwrap(), None);
    }

    proptest! {
        #[test]
        fn no_text_brings_the_reader_down(cut in 0..LOG.len(), text in "[a-zA-Z=0-9., >\n-]{0,80}") {
            let _ = SolverLog::of(&LOG[..cut]);
            let _ = SolverLog::of(&text);
            let _ = fastest_of(&text.replace(' ', "\t").replace('a', "("));
        }
    }
}
