//! Files that a result stands on, by their checksums.

use std::collections::BTreeMap;
use std::path::Path;

use froude_records::hash::sha256_of_file;

use crate::store_error::StoreError;

/// Larger files are fields and pictures; forces, settings and logs are smaller.
const LARGEST_BYTES: u64 = 4 << 20;

/// Checksums of the files below the folder of an attempt, by their paths from there.
///
/// Left out are large files, links, results, and folders with the name of a time, whose fields may be taken away.
#[must_use]
pub fn record(folder: &Path) -> BTreeMap<String, String> {
    let mut files = BTreeMap::new();
    gather(folder, "", &mut files);
    files
}

fn gather(folder: &Path, before: &str, files: &mut BTreeMap<String, String>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let (name, path) = (entry.file_name().to_string_lossy().into_owned(), entry.path());
        let Ok(data) = entry.metadata() else { continue };
        let is_time = before.is_empty() && name.parse::<f64>().is_ok();
        if data.is_dir() && !is_time {
            gather(&path, &format!("{before}{name}/"), files);
        } else if data.is_file() && data.len() <= LARGEST_BYTES && !name.starts_with('.') {
            // What cannot be read cannot be compared later.
            files.extend(sha256_of_file(&path).ok().map(|sum| (format!("{before}{name}"), sum)));
        }
    }
}

/// Compares files with what was recorded; one that is gone says nothing.
///
/// # Errors
///
/// [`StoreError::Refused`] with the first that differs.
pub fn verify(folder: &Path, files: &BTreeMap<String, String>) -> Result<(), StoreError> {
    for (name, expected) in files {
        let path = folder.join(name);
        if let Ok(found) = sha256_of_file(&path)
            && found != *expected
        {
            let next = "froude cfd retry with the case's name computes it again";
            return Err(StoreError::edited(&path, [&found, expected], next));
        }
    }
    Ok(())
}
