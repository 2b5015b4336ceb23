//! Tables in files of named columns: a group of a TDMS file, a structure of a MAT file, a topic of a log.

use std::path::Path;

use froude_foreign::{Cells, Contents, ForeignError, Part, hdf5, mat5, mcap, tdms, ulog};

use crate::assemble::{Room, Want, assemble, plan};
use crate::csv_table::Blanks;
use crate::error::{Place, RecordError};
use crate::file_words::{FileWords, sidecar_name};
use crate::heading::{Heading, rename_sname};
use crate::obstacles::remedy;
use crate::raw_column::Raw;
use crate::read;
use crate::reading::Reading;
use crate::records::Dialect;
use crate::sidecar::Sidecar;
use crate::table::Table;
use crate::text::counted;

/// Between the name of what was left out and the reason.
const LEFT_OUT: &str = " left out: ";

/// The part of a file that is meant, its headings, and what is to be said of the file.
fn meant(path: &Path, contents: Contents, file: &FileWords) -> Result<(Part, Vec<Heading>, Vec<String>), RecordError> {
    let several = contents.parts.len() > 1;
    let left_out = contents.left_out.iter().map(|left| format!("{}{LEFT_OUT}{}", left.name, left.reason));
    let mut words: Vec<String> = left_out.chain(contents.notes.iter().cloned()).collect();
    let part = chosen(path, contents.parts, file)?;
    if several {
        words.insert(0, format!("part {:?}", part.name));
    }
    let mut headings: Vec<Heading> =
        part.columns.iter().map(|column| Heading::stated(&column.name, &column.unit)).collect();
    let sname = rename_sname(&mut headings);
    words.extend(sname.iter().map(|(letter, name)| format!("{letter} by SNAME as {name}")));
    Ok((part, headings, words))
}

/// How a file of named columns is understood.
pub(crate) fn look(path: &Path, file: &FileWords) -> Result<Reading, RecordError> {
    let (part, headings, words) = meant(path, contents(path)?, file)?;
    let is_number = part.columns.iter().map(|column| matches!(column.cells, Cells::Numbers(_))).collect();
    Ok(Reading {
        dialect: Dialect::own(),
        headings,
        is_number,
        place: Place::whole(path),
        at: 0,
        line: 1,
        words,
        undecided: None,
        is_open: false,
    })
}

/// The tables of a file of named columns.
///
/// # Errors
///
/// Whatever the reader of the format finds.
fn contents(path: &Path) -> Result<Contents, RecordError> {
    let refuse = |error: ForeignError| RecordError::syntax(Place::whole(path), format!("the file {error}"));
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
    if ending == "mcap" {
        let mut file = read::open(path)?;
        let bytes = file.metadata().map_or(0, |data| data.len());
        return mcap::read(&mut file, bytes).map_err(refuse);
    }
    let bytes = read::whole(path, froude_foreign::MAX_BYTES, "a file of named columns")?;
    match ending.as_str() {
        "mat" if !hdf5::is_hdf5(&bytes) => mat5::read(&bytes),
        "tdms" => tdms::read(&bytes),
        "ulg" => ulog::read(&bytes),
        _ => hdf5::read(bytes),
    }
    .map_err(refuse)
}

/// Reads the table that is meant of a file; numbers that are not there are an error without a place for them.
pub(crate) fn read_columns(
    path: &Path,
    sidecar: Option<&Sidecar>,
    mut blank: Option<&mut Blanks>,
) -> Result<Table, RecordError> {
    let unstated = FileWords::default();
    let file = sidecar.map_or(&unstated, |sidecar| &sidecar.file);
    let (part, headings, words) = meant(path, contents(path)?, file)?;
    let place = Place::whole(path);
    let header: Vec<String> = headings.iter().map(Heading::header).collect();
    let fitted = sidecar.map(|sidecar| sidecar.fitted(&headings)).transpose()?;
    let columns = fitted.as_ref().filter(|sidecar| !sidecar.columns.is_empty());
    let told = |error| if columns.is_none() { with_remedy(error, path) } else { error };
    let wants = plan(path, &header, columns, &place).map_err(|error| told(with_reason(error, &words)))?;
    let n_rows = part.columns.first().map_or(0, |column| column.cells.len());
    let mut room = Room::new(path);
    let mut raws = Vec::new();
    for (column, (want, header)) in part.columns.into_iter().zip(wants.iter().zip(&header)) {
        raws.push(match column.cells {
            Cells::Texts(texts) => Raw::Texts(texts),
            Cells::Numbers(_) if matches!(want, Want::LeftOut) => Raw::Texts(Vec::new()),
            Cells::Numbers(mut numbers) => {
                room.take((numbers.len() * size_of::<f64>()) as u64)?;
                for (row, value) in numbers.iter_mut().enumerate() {
                    if !value.is_nan() && !file.is_not_measured("", Some(*value)) {
                        continue;
                    }
                    match (want.name_if_blank(), &mut blank) {
                        (Some(name), Some(blank)) => blank.push((name.to_owned(), row)),
                        _ => {
                            let advice = want.advice(path, sidecar);
                            return Err(RecordError::empty_cell(Place::in_table(path, row + 1), header, &advice));
                        }
                    }
                    *value = 0.0;
                }
                Raw::Numbers(numbers)
            }
        });
    }
    let table = assemble(path, &header, &wants, raws, (columns, file), &place, (1..=n_rows).collect()).map_err(told)?;
    let understood = (!words.is_empty()).then(|| words.join(", "));
    Ok(Table { sidecar: sidecar.map(|sidecar| sidecar.path.clone()), ..table }.also(understood))
}

/// An error about a column of a file without a sidecar, with the way to one.
fn with_remedy(error: RecordError, path: &Path) -> RecordError {
    match error {
        RecordError::Syntax { place, problem } => RecordError::syntax(place, format!("{problem}\n{}", remedy(path))),
        other => other,
    }
}

/// An error about a column that was left out, with the reason; `words` are of the file.
fn with_reason(error: RecordError, words: &[String]) -> RecordError {
    let RecordError::Syntax { place, problem } = error else { return error };
    let is_meant = |words: &&String| {
        let name = words.split(LEFT_OUT).next().unwrap_or_default();
        let last = name.rsplit(['.', '/']).next().unwrap_or_default();
        words.contains(LEFT_OUT) && [name, last].iter().any(|name| problem.contains(&format!("`{name}`")))
    };
    match words.iter().find(is_meant) {
        Some(reason) => RecordError::syntax(place, format!("{problem}; {reason}")),
        None => RecordError::Syntax { place, problem },
    }
}

fn has_numbers(part: &Part) -> bool {
    part.columns.iter().any(|column| matches!(column.cells, Cells::Numbers(_)))
}

/// The part that is declared, or the only one with numbers.
fn chosen(path: &Path, mut parts: Vec<Part>, file: &FileWords) -> Result<Part, RecordError> {
    let all: Vec<String> = parts
        .iter()
        .take(20)
        .map(|part| {
            let rows = part.columns.first().map_or(0, |column| column.cells.len());
            let columns = counted(part.columns.len(), "column", "columns");
            format!("{:?} ({columns}, {})", part.name, counted(rows, "row", "rows"))
        })
        .collect();
    let at = match &file.part {
        Some(name) => parts.iter().position(|part| part.name == *name),
        // A remark beside the numbers is no table.
        None => {
            let mut of_numbers = (0..parts.len()).filter(|at| has_numbers(&parts[*at]));
            of_numbers.next().filter(|_| of_numbers.next().is_none()).or(Some(0).filter(|_| parts.len() == 1))
        }
    };
    if let Some(at) = at {
        return Ok(parts.swap_remove(at));
    }
    let problem = match (&file.part, parts.first()) {
        (_, None) => "the file holds no table: columns of numbers of one length".to_owned(),
        (Some(name), _) => format!("there is no part {name:?}; its parts are {}", all.join(", ")),
        (None, Some(first)) => format!(
            "the file holds {} tables: {}; write in {} which one is meant:\n  schema = 1\n  [file]\n  part = {:?}",
            parts.len(),
            all.join(", "),
            sidecar_name(path),
            first.name
        ),
    };
    Err(RecordError::syntax(Place::whole(path), problem))
}
