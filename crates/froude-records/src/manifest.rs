//! `froude-files.json`: what Froude wrote into a folder of results, with fingerprints.
//!
//! By it the next job tells its own files from those that a person put there or changed: the former are replaced as a whole,
//! the latter are never touched. It also lets anybody check a folder that was sent: `sha256sum` gives the same fingerprints.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::{Place, RecordError, read_bytes, reason, utf8};
use crate::hash::sha256_of_file;
use crate::write::write_atomically;

/// Its name.
pub const MANIFEST: &str = "froude-files.json";

/// Name and major version of the format.
const SCHEMA: &str = "froude/files/1";

/// The largest that is read: 100,000 files.
const LARGEST_BYTES: u64 = 16 << 20;

/// What file browsers put into a folder that somebody looks at.
const OF_BROWSERS: [&str; 3] = [".DS_Store", "Thumbs.db", "desktop.ini"];

/// What stands in the file.
#[derive(Debug, Serialize, Deserialize)]
struct Manifest {
    schema: String,
    /// SHA-256 by name, as seen from the folder, with `/`.
    files: BTreeMap<String, String>,
    /// Folders with a manifest of their own.
    folders: BTreeSet<String>,
}

/// Something in a folder of results that is a person's.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Alien {
    /// The file or folder.
    pub path: PathBuf,
    /// Froude wrote it, and somebody changed it.
    pub is_changed: bool,
}

/// Writes the manifest of everything that lies in a folder.
///
/// # Errors
///
/// A file that cannot be read, or the manifest cannot be written.
pub fn write_manifest(folder: &Path) -> Result<(), RecordError> {
    let mut manifest = Manifest { schema: SCHEMA.to_owned(), files: BTreeMap::new(), folders: BTreeSet::new() };
    walk(folder, "", &mut |name, path, kind| {
        match kind {
            Kind::File => _ = manifest.files.insert(name, sha256_of_file(path)?),
            Kind::OwnFolder => _ = manifest.folders.insert(name),
            Kind::Other => {}
        }
        Ok(())
    })?;
    let path = folder.join(MANIFEST);
    let mut text = serde_json::to_string_pretty(&manifest)
        .map_err(|e| RecordError::Write { path: path.clone(), reason: e.to_string() })?;
    text.push('\n');
    write_atomically(&path, text.as_bytes())
}

/// The first thing in a folder that Froude did not write, or that somebody changed since; `None` where all is Froude's.
///
/// # Errors
///
/// A folder or file that cannot be read, or a manifest that is none.
pub fn first_alien(folder: &Path) -> Result<Option<Alien>, RecordError> {
    let path = folder.join(MANIFEST);
    let manifest = if path.is_file() { Some(read(&path)?) } else { None };
    let mut found: Vec<Alien> = Vec::new();
    walk(folder, "", &mut |name, path, kind| {
        let alien = |is_changed| Some(Alien { path: path.to_owned(), is_changed });
        let is_listed = manifest.as_ref().is_some_and(|m| m.folders.contains(&name));
        let fingerprint = manifest.as_ref().and_then(|m| m.files.get(&name));
        found.extend(match (kind, fingerprint) {
            (Kind::OwnFolder, _) if is_listed => first_alien(path)?,
            (Kind::File, Some(own)) if *own == sha256_of_file(path)? => None,
            (Kind::File, Some(_)) => alien(true),
            _ => alien(false),
        });
        Ok(())
    })?;
    // The order of a directory is no order.
    Ok(found.into_iter().min_by(|a, b| a.path.cmp(&b.path)))
}

fn read(path: &Path) -> Result<Manifest, RecordError> {
    let bytes = read_bytes(path, LARGEST_BYTES, "a list of results")?;
    let text = utf8(path, &bytes)?;
    let bad = |line: usize, problem: String| RecordError::Syntax {
        place: Place::line(path, line),
        problem: format!("{problem}; move the folder away, or name another one"),
    };
    let manifest: Manifest =
        serde_json::from_str(text).map_err(|e| bad(e.line(), format!("not a list of results: {e}")))?;
    if manifest.schema == SCHEMA {
        Ok(manifest)
    } else {
        Err(bad(1, format!("the list of results is {:?}, and {SCHEMA:?} is known", manifest.schema)))
    }
}

enum Kind {
    File,
    /// With a manifest.
    OwnFolder,
    /// A link, a device, a name that is no text.
    Other,
}

/// Visits what lies in a folder but its manifest and what file browsers put there; a folder without a manifest is visited itself.
fn walk(
    folder: &Path,
    before: &str,
    visit: &mut dyn FnMut(String, &Path, Kind) -> Result<(), RecordError>,
) -> Result<(), RecordError> {
    let failed = |e: std::io::Error| RecordError::Read { path: folder.to_owned(), reason: reason(&e) };
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let entry = entry.map_err(failed)?;
        let (path, kind) = (entry.path(), entry.file_type().map_err(failed)?);
        let Some(own) = entry.file_name().to_str().map(str::to_owned) else {
            visit(String::new(), &path, Kind::Other)?;
            continue;
        };
        let name = format!("{before}{own}");
        if OF_BROWSERS.contains(&own.as_str()) || name == MANIFEST {
            continue;
        }
        if kind.is_file() {
            visit(name, &path, Kind::File)?;
        } else if kind.is_dir() && path.join(MANIFEST).is_file() {
            visit(name, &path, Kind::OwnFolder)?;
        } else if kind.is_dir() {
            walk(&path, &format!("{name}/"), visit)?;
        } else {
            visit(name, &path, Kind::Other)?;
        }
    }
    Ok(())
}
