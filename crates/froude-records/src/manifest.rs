//! `froude-files.json`: what Froude wrote into a folder of results, with fingerprints.
//!
//! By it the next job tells its own files from those that a person put there or changed: the former are replaced as a whole,
//! the latter are never touched. It also lets anybody check a folder that was sent: `sha256sum` gives the same fingerprints.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::error::{Place, RecordError, reason};
use crate::hash::sha256_of_file;
use crate::read;
use crate::write::{Prepared, write_atomically};

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
    #[serde(default)]
    folders: BTreeSet<String>,
    /// SHA-256 of files that are replaced one by one, in a folder that is not replaced as a whole: the one before and the newest.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    single: BTreeMap<String, Vec<String>>,
}

impl Default for Manifest {
    fn default() -> Self {
        Self { schema: SCHEMA.to_owned(), files: BTreeMap::new(), folders: BTreeSet::new(), single: BTreeMap::new() }
    }
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
    let mut manifest = Manifest::default();
    walk(folder, "", &mut |name, path, kind| {
        match kind {
            Kind::File => _ = manifest.files.insert(name, sha256_of_file(path)?),
            Kind::OwnFolder => _ = manifest.folders.insert(name),
            Kind::Other => {}
        }
        Ok(())
    })?;
    write(folder, &manifest)
}

fn write(folder: &Path, manifest: &Manifest) -> Result<(), RecordError> {
    let path = folder.join(MANIFEST);
    let mut text = serde_json::to_string_pretty(manifest)
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

/// Whether a file may be replaced: nothing is there, or what Froude wrote last. For before a long computation.
///
/// # Errors
///
/// [`RecordError::Refused`]; a list of results that is none.
pub fn may_replace(path: &Path) -> Result<(), RecordError> {
    let (folder, name) = split(path);
    single(&folder, &name, path).map(drop)
}

/// Puts a file into a folder that holds other files too, and lists its fingerprint there. A file in its place is replaced only if Froude wrote
/// it and nobody changed it since.
///
/// # Errors
///
/// [`RecordError::Refused`]; a disk that is full. What stood there is untouched.
pub fn take_own_place(file: Prepared) -> Result<(), RecordError> {
    let (folder, name) = split(file.path());
    let (mut manifest, before) = single(&folder, &name, file.path())?;
    manifest.files.remove(&name);
    // Both are listed first: killed before or after the rename, what stands there is known.
    manifest.single.insert(name, before.into_iter().chain([file.sha256()?]).collect());
    write(&folder, &manifest)?;
    file.take_place()
}

/// The list of a folder, and the fingerprint of what stands in a file's place.
fn single(folder: &Path, name: &str, path: &Path) -> Result<(Manifest, Option<String>), RecordError> {
    let list = folder.join(MANIFEST);
    let manifest = if list.is_file() { read(&list)? } else { Manifest::default() };
    if path.symlink_metadata().is_err() {
        return Ok((manifest, None));
    }
    // A file of results that were written as a whole folder is Froude's as well.
    let mut listed = manifest.single.get(name).into_iter().flatten().chain(manifest.files.get(name)).peekable();
    let is_changed = listed.peek().is_some();
    let found = if path.is_file() { Some(sha256_of_file(path)?) } else { None };
    match found {
        Some(found) if listed.any(|own| *own == found) => Ok((manifest, Some(found))),
        _ => {
            let problem = "and would be replaced; move it away, or name another folder";
            Err(RecordError::not_ours(path, is_changed, problem))
        }
    }
}

fn split(path: &Path) -> (PathBuf, String) {
    let folder = path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    (folder.to_owned(), path.file_name().unwrap_or_default().to_string_lossy().into_owned())
}

fn read(path: &Path) -> Result<Manifest, RecordError> {
    let text = &read::text(path, LARGEST_BYTES, "a list of results")?;
    let bad = |line: usize, problem: String| {
        RecordError::syntax(Place::line(path, line), format!("{problem}; move the folder away, or name another one"))
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

#[cfg(test)]
mod tests {
    use std::io::Write as _;

    use super::*;

    fn put(path: &Path, content: &str) -> Result<(), RecordError> {
        take_own_place(Prepared::new(path, |out| out.write_all(content.as_bytes()))?)
    }

    #[test]
    fn a_file_is_replaced_only_while_it_is_what_froude_wrote() {
        let folder = tempfile::tempdir().unwrap();
        let (ours, theirs) = (folder.path().join("a.csv"), folder.path().join("b.csv"));
        put(&ours, "1").unwrap();
        put(&ours, "2").unwrap();
        // Killed before the rename: the old content under the new list.
        std::fs::write(&ours, "1").unwrap();
        put(&ours, "3").unwrap();
        std::fs::write(&ours, "mine").unwrap();
        let said = put(&ours, "4").unwrap_err().to_string();
        assert!(said.contains("a.csv was changed after Froude wrote it, and would be replaced"), "{said}");
        std::fs::write(&theirs, "mine").unwrap();
        let said = may_replace(&theirs).unwrap_err().to_string();
        assert!(said.contains("b.csv was not written by Froude, and would be replaced"), "{said}");
        assert_eq!(std::fs::read_to_string(&theirs).unwrap(), "mine");
        // A folder of results takes no account of them: they are not replaced as a whole.
        assert!(first_alien(folder.path()).unwrap().is_some());
    }
}
