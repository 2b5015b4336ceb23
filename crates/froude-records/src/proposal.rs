//! A sidecar that proposes what the columns of a table are, for a person to check and correct.

use std::path::{Path, PathBuf};

use froude_foreign::layout::is_missing;
use froude_foreign::split::{Row, rows};

use crate::block::{Block, TableBuilder};
use crate::csv_table::text;
use crate::error::{Place, RecordError};
use crate::file_words::{FileWords, sentinel, sentinel_word};
use crate::foreign_names::meant_without_unit;
use crate::heading::Heading;
use crate::known_columns::{is_text_column, usual_unit};
use crate::label_rows::{Labels, Odd, OddRows, label, odd};
use crate::outcome::Outcome;
use crate::reading::Reading;
use crate::records::Skipped;
use crate::sidecar::read_sidecar;
use crate::table_file::Format;
use crate::toml_text::{key_word, quoted};
use crate::units::parse_unit;
use crate::write::Prepared;
use crate::{container_table, read, sheet_table};

/// The largest file that is looked at for a proposal.
const LARGEST_BYTES: u64 = 2 << 30;

/// As much of it as is looked at for words in the place of numbers.
const SAMPLE_BYTES: usize = 1 << 20;

/// Writes the proposal beside the table, and says so.
///
/// # Errors
///
/// As [`write_sidecar`].
pub fn propose(table: &Path, sidecar: Option<&Path>) -> Result<Outcome, RecordError> {
    let path = write_sidecar(table, sidecar)?;
    let rows = [path.display().to_string()];
    let t = TableBuilder::new("files", "", &rows);
    let files = t.build(vec![t.text("path", "", Clone::clone)]);
    let named = sidecar.map_or_else(String::new, |path| format!(" --sidecar {}", path.display()));
    let said =
        format!("wrote {}: check every line, correct it, then froude inspect {}{named}", rows[0], table.display());
    Ok(Outcome { blocks: vec![files.into(), Block::text("", vec![said])], ..Outcome::default() })
}

/// Writes the proposal as the sidecar that is named, or beside the table as its `.toml`; its path. What a sidecar without columns says of the
/// file stays, and holds.
///
/// # Errors
///
/// A sidecar that names columns already, a table that cannot be looked at, a file that cannot be written.
pub fn write_sidecar(table: &Path, sidecar: Option<&Path>) -> Result<PathBuf, RecordError> {
    let path = sidecar.map_or_else(|| table.with_extension("toml"), Path::to_owned);
    let (mut text, mut file) = (String::new(), FileWords::default());
    if path.exists() {
        let own = read_sidecar(&path)?;
        if !own.columns.is_empty() {
            let problem = "already exists and names columns; move it away, or correct it by hand";
            return Err(RecordError::Refused(format!("{}: {problem}", path.display())));
        }
        text = read::text(&path, 1 << 20, "a sidecar")?;
        file = own.file;
    }
    let proposal = self::sidecar(table, &file)?;
    let proposal = if text.is_empty() { proposal } else { with_columns(&text, &proposal) };
    Prepared::new(&path, |file| std::io::Write::write_all(file, proposal.as_bytes()))?.take_place()?;
    Ok(path)
}

/// A sidecar that is there, with the columns of a proposal, and as a remark what the proposal says of the file.
fn with_columns(text: &str, proposal: &str) -> String {
    let (head, columns) = proposal.split_once("\n[columns]\n").unwrap_or(("", proposal));
    let words = head.split_once("\n[file]\n").map_or("", |(_, words)| words);
    let words: String = words.lines().map(|line| format!("# {}\n", line.trim_start_matches("# "))).collect();
    let said = if words.is_empty() { words } else { format!("# Suggested for [file] above:\n{words}") };
    format!("{}\n\n{said}[columns]\n{columns}", text.trim_end())
}

/// The proposal for a table of whose file something is stated.
///
/// # Errors
///
/// A table that cannot be looked at.
pub fn sidecar(table: &Path, file: &FileWords) -> Result<String, RecordError> {
    match Format::of(table)? {
        Format::Text => {
            let bytes = read::whole(table, LARGEST_BYTES, "a table")?;
            let decoded = text(table, &bytes, file)?;
            let reading = Reading::of(table, &decoded, file)?;
            let end = decoded.text.floor_char_boundary(SAMPLE_BYTES);
            let rows = rows(&decoded.text[..end], reading.dialect.separator);
            Ok(proposed(table, &reading, &rows))
        }
        Format::Sheet => sheet_table::look(table, file).map(|(rows, reading)| proposed(table, &reading, &rows)),
        Format::Columns => container_table::look(table, file).map(|reading| proposed(table, &reading, &[])),
        Format::Parquet => {
            let problem = "a sidecar is proposed for text, spreadsheets and logs; name the columns of a Parquet file as `speed [m/s]`";
            Err(RecordError::syntax(Place::whole(table), problem))
        }
    }
}

fn proposed(table: &Path, reading: &Reading, rows: &[Row<'_>]) -> String {
    let name = table.file_name().unwrap_or_default().to_string_lossy();
    let mut out = format!(
        "# What the columns of {name} are: a proposal. Check every line, correct it, and delete what you do not need.\n"
    );
    if let Some(understood) = reading.understood(Skipped::default(), 0) {
        out += &format!("# The file was understood as: {understood}.\n");
    }
    out += "schema = 1\n";
    if reading.headings.iter().any(|heading| target(heading) == Some("time")) {
        out += "# Where this is the log of a run: which method it belongs to and what it is for there.\n# method = \"free-decay\"\n# role = \"test\"\n";
    }
    out += &of_file(reading, rows);
    out += "\n[columns]\n# name: what Froude calls it; unit: of the numbers in the file; sign = -1 where the file counts against Froude's axes\n# (x forward, y to starboard, z down; loads are those of the water on the body).\n";
    for heading in &reading.headings {
        // Of two columns of one name only a person can tell which is which.
        let n_alike = reading.headings.iter().filter(|other| other.written == heading.written).count();
        let is_open = heading.written.is_empty() || n_alike > 1;
        out += if is_open { "# " } else { "" };
        out += &line(heading, reading);
    }
    out
}

/// `[file]`, where something about it has to be stated.
fn of_file(reading: &Reading, rows: &[Row<'_>]) -> String {
    let data = || rows.iter().filter(|row| !row.is_comment && row.line >= reading.line);
    let (mut missing, mut sums, mut scales) = (Vec::<String>::new(), Vec::<String>::new(), Vec::<String>::new());
    let mut labels = Labels::default();
    let mut odd_rows = OddRows::default();
    let mut found: Vec<(usize, String)> = Vec::new();
    for row in data() {
        labels.see(row.cells.first().map_or("", |cell| cell.trim()), row.line);
        found.extend(odd_rows.see(label(&row.cells), row.line));
    }
    found.extend(odd_rows.end());
    let top = data().next().map(|row| row.line);
    for (line, word) in found {
        match odd(&word) {
            // Words above all numbers may be a second line of names.
            Some(Odd::Sum) if Some(line) == top => scales.push(word),
            Some(Odd::Sum) if !sums.contains(&word) => sums.push(word),
            Some(Odd::Scale) if !scales.contains(&word) => scales.push(word),
            _ => {}
        }
    }
    scales.extend(labels.words().map(|(_, word)| word.clone()).filter(|word| odd(word).is_none()));
    let is_odd =
        |row: &Row<'_>| [&sums, &scales].iter().any(|words| words.iter().any(|word| word == label(&row.cells)));
    for at in (0..reading.headings.len()).filter(|at| reading.is_number.get(*at) == Some(&true)) {
        let cells: Vec<_> = data().filter(|row| !is_odd(row)).filter_map(|row| row.cells.get(at)).collect();
        let words = cells.iter().filter(|cell| !cell.is_empty() && is_missing(cell)).map(ToString::to_string);
        let numbers: Vec<f64> =
            cells.iter().filter_map(|cell| reading.dialect.marks.plain(cell)?.parse().ok()).collect();
        let far = sentinel(&numbers).map(|(_, value)| sentinel_word(value));
        for word in words.chain(far) {
            if !missing.contains(&word) {
                missing.push(word);
            }
        }
    }
    let list = |words: &[String]| words.iter().map(|word| quoted(word)).collect::<Vec<_>>().join(", ");
    let mut out = String::new();
    if reading.undecided.is_some() {
        out += "# Numbers of this file can be read in two ways: state its marks.\n# decimal = \",\"\n# thousands = \".\"\n";
    }
    if !missing.is_empty() {
        out += &format!("# Cells that stand for no measurement.\nnot_measured = [{}]\n", list(&missing));
    }
    if !sums.is_empty() && scales.is_empty() {
        out += &format!("# Rows that sum up others and are no observations.\nleave_out = [{}]\n", list(&sums));
    }
    if !scales.is_empty() {
        sums.extend(scales);
        out += &format!(
            "# Other rows that may be no observations, as a tare, or may scale the others, which nothing applies: look at each, and then remove the # in front.\n# leave_out = [{}]\n",
            list(&sums)
        );
    }
    if out.is_empty() { out } else { format!("\n[file]\n{out}") }
}

/// What Froude calls a column.
fn target(heading: &Heading) -> Option<&'static str> {
    heading.meant().map(|meant| meant.name)
}

/// The line of a column; a comment where something has to be filled in first.
fn line(heading: &Heading, reading: &Reading) -> String {
    let key = key_word(&heading.written);
    let own = heading.name.as_str();
    let at = reading.headings.iter().position(|other| other == heading).unwrap_or_default();
    let is_number = reading.is_number.get(at).copied().unwrap_or(true);
    // Of two columns that seem the same neither is renamed: somebody has to say which is which.
    let is_alone = |name: &str| {
        reading.headings.iter().filter(|other| target(other) == Some(name) || other.name == name).count() <= 1
    };
    let dimension = heading.dimension();
    let meant = heading.meant().filter(|meant| is_alone(meant.name));
    if let Some(meant) = meant.filter(|meant| is_text_column(meant.name)) {
        return format!("{key} = {{ name = \"{}\" }}\n", meant.name);
    }
    if is_text_column(own) || !is_number {
        return format!("{key} = {{ name = {} }}\n", quoted(own));
    }
    match (&heading.unit, dimension, meant) {
        (Some(unit), Some(_), Some(meant)) => {
            let (sign, why) = if meant.sign < 0 {
                (", sign = -1", "  # a resistance is written positive; f_x points forward")
            } else {
                ("", "")
            };
            format!("{key} = {{ name = \"{}\", unit = {}{sign} }}{why}\n", meant.name, quoted(unit))
        }
        (Some(unit), Some(_), None) => format!("{key} = {{ name = {}, unit = {} }}\n", quoted(own), quoted(unit)),
        (Some(unit), None, _) => {
            let told = parse_unit(unit).err().map_or_else(String::new, |error| error.to_string());
            format!("# {key} = {{ name = {}, unit = \"\" }}  # {told}\n", quoted(own))
        }
        (None, ..) => {
            let meant = meant_without_unit(own)
                .or_else(|| meant_without_unit(&heading.above))
                .filter(|(meant, _)| is_alone(meant.name));
            let name = meant.map_or(own, |(meant, _)| meant.name);
            let example = usual_unit(name).map_or_else(String::new, |unit| format!(", {unit} for example"));
            let sign = if meant.is_some_and(|(meant, _)| meant.sign < 0) { ", sign = -1" } else { "" };
            format!(
                "# {key} = {{ name = {}, unit = \"\"{sign} }}  # state the unit{example}, and remove the # at the beginning\n",
                quoted(name)
            )
        }
    }
}
