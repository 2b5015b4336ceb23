//! The force files of one case: found, joined over restarts.

use std::path::{Path, PathBuf};

use froude_identify::method::MethodError;
use froude_records::text::counted;

use super::coefficients;
use super::dat::{self, Dat, Kind, triple};
use super::keys::ForcesSpec;
use crate::history::{Sample, starts};
use crate::input;

/// Files that begin a function object's output, in the order of preference: forces before coefficients.
const FIRST: [&str; 4] = ["force.dat", "forces.dat", "coefficient.dat", "forceCoeffs.dat"];

/// A function object with force files.
#[derive(Debug, Clone, PartialEq)]
pub struct Object {
    /// Its name.
    pub name: String,
    /// The file that it writes first, one of [`FIRST`].
    pub first: &'static str,
    /// The folders of its starts, in time.
    pub starts: Vec<PathBuf>,
}

impl Object {
    /// Whether it has forces, rather than coefficients.
    #[must_use]
    pub fn has_forces(&self) -> bool {
        matches!(self.first, "force.dat" | "forces.dat")
    }
}

/// The function objects of a case that have force files, sorted by name.
///
/// # Errors
///
/// A folder that cannot be listed; two files of one start.
pub fn objects(case: &Path) -> Result<Vec<Object>, MethodError> {
    let folder = case.join("postProcessing");
    let failed = |source| MethodError::Folder { path: folder.clone(), source };
    let entries = match std::fs::read_dir(&folder) {
        Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(Vec::new()),
        entries => entries.map_err(failed)?,
    };
    let mut out = Vec::new();
    for entry in entries {
        let path = entry.map_err(failed)?.path();
        if !path.is_dir() {
            continue;
        }
        let all = starts(&path).map_err(|e| MethodError::input(&path, e.to_string()))?;
        let first = FIRST.into_iter().find(|file| all.iter().any(|start| start.join(file).is_file()));
        let Some(first) = first else { continue };
        let with_file: Vec<PathBuf> = all.into_iter().filter(|start| start.join(first).is_file()).collect();
        let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
        out.push(Object { name, first, starts: with_file });
    }
    out.sort_by(|a, b| a.name.cmp(&b.name));
    Ok(out)
}

/// What the force files of a case hold.
#[derive(Debug, Clone)]
pub(super) struct Read {
    /// Loads in the axes of the files, about [`Self::centre_m`]: those of force files as written, those of coefficient files converted to N at the density asked for.
    pub(super) samples: Vec<Sample>,
    /// Whether they are of coefficients, whose density is that of the water already.
    pub(super) is_of_coefficients: bool,
    /// Which of the loads along and about the axes of the mesh the files determine.
    pub(super) is_known: [bool; 6],
    /// Point of the mesh that moments are about, m; `None` if no file states it.
    pub(super) centre_m: Option<[f64; 3]>,
    pub(super) files: Vec<PathBuf>,
    /// How many restarts took the place of what they repeat, and files whose last line has no end.
    pub(super) notes: Vec<String>,
}

/// Reads the force files of a case; `density_kg_m3` is that of the water.
pub(super) fn read(case: &Path, spec: &ForcesSpec, density_kg_m3: Option<f64>) -> Result<Read, MethodError> {
    let object = chosen(case, spec)?;
    let mut out = Read {
        samples: Vec::new(),
        is_of_coefficients: !object.has_forces(),
        is_known: [true; 6],
        centre_m: None,
        files: Vec::new(),
        notes: Vec::new(),
    };
    let mut centre: Option<(Option<[f64; 3]>, PathBuf)> = None;
    for (i, start) in object.starts.iter().enumerate() {
        no_second(start, object.first)?;
        let path = start.join(object.first);
        let first = parsed(&path, expected(object.first))?;
        let refuse = |(line, problem): dat::Problem| MethodError::input(&path, format!("line {line}: {problem}"));
        let mut files = vec![(path.clone(), first)];
        let (samples, is_known) = match files[0].1.kind {
            Kind::Coefficients => coefficients::samples(&path, &files[0].1, spec.of_coefficients(density_kg_m3))?,
            Kind::Force => {
                let path = start.join("moment.dat");
                if path.is_file() {
                    no_second(start, "moment.dat")?;
                    files.push((path.clone(), parsed(&path, Kind::Moment)?));
                }
                let moments = files.get(1).map(|(_, moments)| moments);
                let has_moments = moments.is_some();
                let refuse = |(_, problem): dat::Problem| MethodError::input(&path, problem);
                (files[0].1.samples(moments).map_err(refuse)?, std::array::from_fn(|k| k < 3 || has_moments))
            }
            _ => (files[0].1.samples(None).map_err(refuse)?, [true; 6]),
        };
        for (path, file) in &files {
            let own = file
                .stated("CofR")
                .map(|text| {
                    triple(text).ok_or_else(|| {
                        MethodError::input(path, format!("CofR is {text:?}; expected three numbers in parentheses"))
                    })
                })
                .transpose()?;
            match &centre {
                Some((known, other)) if *known != own => {
                    let shown = |point: &Option<[f64; 3]>| {
                        point.map_or_else(|| "not stated".to_owned(), |[x, y, z]| format!("({x} {y} {z})"))
                    };
                    let what = format!(
                        "CofR is {}, and in {} {}: moments about two points are not joined",
                        shown(&own),
                        other.display(),
                        shown(known)
                    );
                    return Err(MethodError::input(path, what));
                }
                Some(_) => {}
                None => centre = Some((own, path.clone())),
            }
            if file.is_cut {
                out.notes.push(format!("the last line of {} has no end and is left out", path.display()));
            }
        }
        if let Some(first) = samples.first() {
            let before = out.samples.len();
            out.samples.retain(|sample| sample.time < first.time);
            let repeated = before - out.samples.len();
            if repeated > 0 {
                let rows = counted(repeated, "row", "rows");
                out.notes.push(format!("the restart in {} repeats {rows}, and takes their place", start.display()));
            }
        }
        if i == 0 {
            out.is_known = is_known;
        } else if out.is_known != is_known {
            return Err(MethodError::input(&path, "has other loads than the files of the start before it"));
        }
        out.samples.extend(samples);
        out.files.extend(files.into_iter().map(|(path, _)| path));
    }
    out.centre_m = centre.and_then(|(centre, _)| centre);
    Ok(out)
}

/// The function object to read: the one that the campaign names, or the only one. Force files are preferred to coefficient files.
fn chosen(case: &Path, spec: &ForcesSpec) -> Result<Object, MethodError> {
    let all = objects(case)?;
    let names = |all: &[&Object]| all.iter().map(|o| o.name.as_str()).collect::<Vec<_>>().join(", ");
    if let Some(name) = &spec.object {
        let found = all.iter().find(|object| object.name == *name).cloned();
        return found.ok_or_else(|| {
            let known = names(&all.iter().collect::<Vec<_>>());
            let what = format!("its postProcessing has no force files of the function object {name:?}; it has {known}");
            MethodError::input(case, what)
        });
    }
    let mut wanted: Vec<&Object> = all.iter().filter(|object| object.has_forces()).collect();
    if wanted.is_empty() {
        wanted = all.iter().collect();
    }
    match wanted[..] {
        [] => {
            let what = format!("has no force files: expected postProcessing/OBJECT/TIME/ with {}", FIRST.join(", "));
            Err(MethodError::input(case, what))
        }
        [one] => Ok(one.clone()),
        [first, ..] => {
            let what = format!(
                "several function objects have force files: {}; name one, object = {:?}",
                names(&wanted),
                first.name
            );
            Err(MethodError::input(case, what))
        }
    }
}

/// Refuses `force_5.dat` beside `force.dat`: OpenFOAM writes it when a start is repeated, and which of them counts is not known.
fn no_second(start: &Path, first: &str) -> Result<(), MethodError> {
    let stem = first.trim_end_matches(".dat");
    let entries = std::fs::read_dir(start).map_err(|source| MethodError::Folder { path: start.to_owned(), source })?;
    let names = entries.filter_map(Result::ok).map(|entry| entry.file_name().to_string_lossy().into_owned());
    let is_second = |name: &String| {
        let end = name.strip_prefix(stem).and_then(|end| end.strip_suffix(".dat"));
        end.is_some_and(|end| end.starts_with('_'))
    };
    match names.into_iter().find(is_second) {
        Some(second) => {
            let what = format!(
                "{second} and {first} are two runs from one start; move the one that does not count out of the folder"
            );
            Err(MethodError::input(start, what))
        }
        None => Ok(()),
    }
}

/// The density that the `forces` function object of a case multiplies by, with the file that states it; `None` if several are stated, or there is no `forces`
/// object: a `forceCoeffs` object divides by its own.
pub(super) fn stated_rho_inf(case: &Path) -> Option<(f64, PathBuf)> {
    let path = case.join("system/controlDict");
    let text = input::text(&path).ok()?;
    let code = || text.lines().map(|line| line.split_once("//").map_or(line, |(code, _)| code).trim());
    let value = |line: &'_ str, key: &str| Some(line.strip_prefix(key)?.strip_suffix(';')?.trim().to_owned());
    if !code().any(|line| value(line, "type").is_some_and(|kind| kind == "forces")) {
        return None;
    }
    // `rhoInf 998;` and, in old files, `rhoInf rhoInf [1 -3 0 0 0 0 0] 998;`.
    let mut stated = code()
        .filter_map(|line| value(line, "rhoInf"))
        .map(|value| value.split_whitespace().next_back().and_then(|last| last.parse::<f64>().ok()));
    let first = stated.next()??;
    stated.all(|other| other == Some(first)).then_some((first, path))
}

fn expected(file: &str) -> Kind {
    match file {
        "force.dat" => Kind::Force,
        "forces.dat" => Kind::Both,
        _ => Kind::Coefficients,
    }
}

fn parsed(path: &Path, expected: Kind) -> Result<Dat, MethodError> {
    let text = input::text(path).map_err(|e| MethodError::input(path, e.to_string()))?;
    let read =
        dat::read(&text).map_err(|(line, problem)| MethodError::input(path, format!("line {line}: {problem}")))?;
    if read.kind == expected {
        return Ok(read);
    }
    let what = format!("its comment lines are those of {}; expected those of {}", words(read.kind), words(expected));
    Err(MethodError::input(path, what))
}

const fn words(kind: Kind) -> &'static str {
    match kind {
        Kind::Force => "forces (force.dat)",
        Kind::Moment => "moments (moment.dat)",
        Kind::Both => "forces and moments (forces.dat)",
        Kind::Coefficients => "coefficients",
    }
}
