//! `froude inspect` of force files, of a case, and of a folder of cases.

use std::path::{Path, PathBuf};

use froude_identify::inspect::Inspection;
use froude_identify::method::MethodError;
use froude_records::number::significant;
use froude_records::read;
use froude_records::text::counted;

use super::dat::{self, Dat};
use super::files::{Object, objects};
use super::keys::NAME;

/// Largest head of a file that is looked at to tell what it is.
const HEAD_BYTES: u64 = 16 << 10;
/// Largest force file that is inspected.
const LARGEST_BYTES: u64 = 1 << 30;
/// Most folders of a folder that are looked at.
const MAX_FOLDERS: usize = 10_000;

/// What a text file whose name ends in `.dat` is by its first lines: force files, surface meshes and tables of many programs have that ending.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DatFile {
    /// Forces, moments or coefficients of OpenFOAM.
    Forces,
    /// A surface mesh of Nemoh.
    Mesh,
    /// Data of Tecplot.
    Tecplot,
    /// None of these.
    Other,
}

/// Looks at the head of a file; `None` if it cannot be read.
#[must_use]
pub fn dat_file(path: &Path) -> Option<DatFile> {
    use std::io::Read as _;
    let mut bytes = Vec::new();
    read::open(path).ok()?.take(HEAD_BYTES).read_to_end(&mut bytes).ok()?;
    Some(recognised(&String::from_utf8_lossy(&bytes)))
}

fn recognised(head: &str) -> DatFile {
    if dat::kind_of(head).is_some() {
        return DatFile::Forces;
    }
    let first = head.lines().find(|line| !line.trim().is_empty()).unwrap_or_default();
    let words: Vec<&str> = first.split_whitespace().collect();
    let upper = first.trim_start().to_ascii_uppercase();
    match words[..] {
        // Nemoh: "2" and whether the mesh is symmetric.
        ["2", "0" | "1"] => DatFile::Mesh,
        _ if ["TITLE", "VARIABLES", "ZONE"].iter().any(|word| upper.starts_with(word)) => DatFile::Tecplot,
        _ => DatFile::Other,
    }
}

/// Inspects a force file, a case, or a folder of cases; `None` for any other path.
///
/// # Errors
///
/// A force file that cannot be read.
pub fn inspect(path: &Path) -> Result<Option<Inspection>, MethodError> {
    if !path.is_dir() {
        let is_dat = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("dat"));
        return if is_dat && dat_file(path) == Some(DatFile::Forces) { file(path).map(Some) } else { Ok(None) };
    }
    let mut cases = vec![(path.to_owned(), objects(path)?)];
    let below = std::fs::read_dir(path).map_err(|source| MethodError::Folder { path: path.to_owned(), source })?;
    let mut folders: Vec<PathBuf> =
        below.filter_map(Result::ok).map(|entry| entry.path()).filter(|path| path.is_dir()).take(MAX_FOLDERS).collect();
    folders.sort();
    for folder in folders {
        let own = objects(&folder)?;
        cases.push((folder, own));
    }
    cases.retain(|(_, objects)| !objects.is_empty());
    if cases.is_empty() {
        return Ok(None);
    }
    let mut facts = vec![(
        "cases".to_owned(),
        counted(cases.len(), "case of OpenFOAM with force files", "cases of OpenFOAM with force files"),
    )];
    for (folder, objects) in &cases {
        let name =
            folder.file_name().map_or_else(|| folder.display().to_string(), |name| name.to_string_lossy().into_owned());
        facts.push((name, objects.iter().map(object).collect::<Result<Vec<_>, _>>()?.join("; ")));
    }
    let next = format!(
        "froude new openfoam --out DIR writes a campaign for such cases: runs = \"FOLDER\" and method = \"{NAME}\" in a [[source]]"
    );
    facts.push(("next".to_owned(), next));
    Ok(Some(Inspection::new("openfoam forces", facts, Vec::new())))
}

fn object(object: &Object) -> Result<String, MethodError> {
    let mut rows = 0;
    let mut span: Option<[f64; 2]> = None;
    let mut centre = None;
    for start in &object.starts {
        let read = parsed(&start.join(object.first))?;
        rows += read.times.len();
        if let (Some(first), Some(last)) = (read.times.first(), read.times.last()) {
            span = Some(span.map_or([*first, *last], |[low, high]| [low.min(*first), high.max(*last)]));
        }
        centre = centre.or_else(|| read.stated("CofR").map(str::to_owned));
    }
    let times = span.map_or_else(String::new, |[first, last]| format!(", time {first} to {last}"));
    let starts = if object.starts.len() > 1 { format!(" of {} starts", object.starts.len()) } else { String::new() };
    let centre = centre.map_or_else(|| ", CofR not stated".to_owned(), |centre| format!(", CofR {centre}"));
    Ok(format!("{} in {}, {}{starts}{times}{centre}", object.first, object.name, counted(rows, "row", "rows")))
}

fn parsed(path: &Path) -> Result<Dat, MethodError> {
    let text = read::text(path, LARGEST_BYTES, "a force file")?;
    dat::read(&text).map_err(|(line, problem)| MethodError::input(path, format!("line {line}: {problem}")))
}

fn file(path: &Path) -> Result<Inspection, MethodError> {
    let read = parsed(path)?;
    let kind = match read.kind {
        dat::Kind::Force => "forces",
        dat::Kind::Moment => "moments",
        dat::Kind::Both => "forces and moments",
        dat::Kind::Coefficients => "coefficients",
    };
    let mut facts = vec![
        ("holds".to_owned(), format!("{kind}, {}", counted(read.times.len(), "row", "rows"))),
        ("columns".to_owned(), read.columns.join(", ")),
    ];
    if let (Some(first), Some(last)) = (read.times.first(), read.times.last()) {
        facts.push(("time".to_owned(), format!("{} to {}", significant(*first, 6), significant(*last, 6))));
    }
    facts.extend(read.header.iter().cloned());
    let next = "inspect the folder that holds the cases; froude new openfoam --out DIR writes a campaign for them";
    facts.push(("next".to_owned(), next.to_owned()));
    Ok(Inspection::new("openfoam force file", facts, Vec::new()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_of_one_ending_are_told_apart_by_their_first_lines() {
        for (text, is) in [
            ("# Force\n# CofR : (0 0 0)\n# Time total_x total_y total_z pressure_x\n", DatFile::Forces),
            ("# Moment\n#\n# Time (total_x total_y total_z) (pressure_x\n", DatFile::Forces),
            ("# Forces\n# Time forces(pressure viscous) moments(pressure viscous)\n", DatFile::Forces),
            ("# Force coefficients\n# Time Cm Cd Cl Cl(f) Cl(r)\n", DatFile::Forces),
            ("    2  1\n 1 0. 0. 0.\n", DatFile::Mesh),
            ("2 0\r\n1 0. 0. 0.\r\n", DatFile::Mesh),
            ("TITLE = \"flow\"\nVARIABLES = \"x\", \"y\"\n", DatFile::Tecplot),
            ("variables = x y\nzone\n", DatFile::Tecplot),
            ("speed [m/s];f_x [N]\n0,5;-1,2\n", DatFile::Other),
            ("# Time speed\n1 2\n", DatFile::Other),
            ("", DatFile::Other),
        ] {
            assert_eq!(recognised(text), is, "{text}");
        }
    }
}
