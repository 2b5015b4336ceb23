//! One log in the formats that other programs write it in, each converted as `froude convert` does: read, asked or rejected, and never read wrongly.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;
use std::process::Command;

use froude::records::convert::convert;
use froude::records::table::ColumnData;
use froude::records::table_file::read_table;
use serde::Deserialize;

use crate::claims::{Claims, Verdict};

const SECTION: &str = "Files of other programs: one log in the formats that they write";
/// Files have six digits; drag in gram-force has them of gf.
const SAME: f64 = 2e-6;

#[derive(Deserialize)]
struct Manifest {
    columns: BTreeMap<String, Vec<f64>>,
    files: Vec<Entry>,
}

#[derive(Deserialize)]
struct Entry {
    file: String,
    format: String,
    words: String,
    sidecar: String,
    expect: String,
    says: String,
}

pub fn all(claims: &mut Claims, root: &Path) -> Result<(), Box<dyn Error>> {
    let python = root.join("target/oracles/bin/python");
    if !python.is_file() {
        let found = format!("{} is not there; run cargo xtask oracles", python.display());
        claims.add(SECTION, "all files", "", found, Verdict::Skipped);
        return Ok(());
    }
    let folder = tempfile::tempdir()?;
    let script = root.join("crates/froude/examples/validate/foreign.py");
    let written = Command::new(&python).arg(script).current_dir(&folder).output()?;
    if !written.status.success() {
        return Err(String::from_utf8_lossy(&written.stderr).into());
    }
    let manifest: Manifest = serde_json::from_slice(&std::fs::read(folder.path().join("manifest.json"))?)?;
    let mut counts: BTreeMap<&str, usize> = BTreeMap::new();
    for (k, entry) in manifest.files.iter().enumerate() {
        let found = outcome(folder.path(), k, entry, &manifest.columns)?;
        let is_expected = found.starts_with(&entry.expect);
        *counts.entry(if is_expected { entry.expect.as_str() } else { "otherwise" }).or_default() += 1;
        let claim = format!("{}: {}", entry.format, entry.words);
        claims.holds(SECTION, &claim, &entry.expect, found, is_expected);
    }
    let counts: Vec<String> = counts.iter().map(|(what, n)| format!("{n} {what}")).collect();
    let formats: std::collections::BTreeSet<&str> = manifest.files.iter().map(|entry| entry.format.as_str()).collect();
    let claim = format!("{} files of {} formats", manifest.files.len(), formats.len());
    claims.holds(
        SECTION,
        &claim,
        "none read wrongly",
        counts.join(", "),
        !counts.iter().any(|c| c.ends_with("otherwise")),
    );
    Ok(())
}

/// `read`, `read wrongly`, `asked` or `rejected`, and in which words.
fn outcome(
    folder: &Path,
    k: usize,
    entry: &Entry,
    columns: &BTreeMap<String, Vec<f64>>,
) -> Result<String, Box<dyn Error>> {
    let (input, out) = (folder.join(&entry.file), folder.join(format!("out-{k}.csv")));
    let sidecar = folder.join(format!("side-{k}.toml"));
    if !entry.sidecar.is_empty() {
        std::fs::write(&sidecar, &entry.sidecar)?;
    }
    let error = match convert(&input, Some(sidecar.as_path()).filter(|path| path.exists()), &out) {
        Ok(_) => {
            let table = read_table(&out, None)?;
            let is_same = columns.iter().all(|(name, expected)| {
                let found =
                    table.columns.iter().find(|column| column.name == *name).and_then(|column| match &column.data {
                        ColumnData::Number { si, .. } => Some(si),
                        ColumnData::Text(_) => None,
                    });
                found.is_some_and(|found| {
                    found.len() == expected.len() && found.iter().zip(expected).all(|(a, b)| (a - b).abs() < SAME)
                })
            });
            return Ok(if is_same { "read" } else { "read wrongly" }.to_owned());
        }
        Err(error) => error.to_string(),
    };
    let words = error.replace(&format!("{}/", folder.display()), "");
    let first = words.lines().next().unwrap_or_default();
    // An answer that a person gives is named; a file that cannot be read is rejected.
    let how = if words.contains(&entry.says) { entry.expect.as_str() } else { "refused otherwise" };
    Ok(format!("{how}: {first}"))
}
