//! The files that a record names, each once, with its fingerprint and a short key.

use std::path::{Path, PathBuf};

use froude_records::RecordError;
use froude_records::estimate::{DataFile, keyed};
use indexmap::IndexMap;

use crate::result::ReadFile;

/// Role of a file that was not read: observations behind a record that numbers were taken from.
pub const INHERITED: &str = "inherited";

/// Step that says which part of a file was read, as a sheet of a workbook.
pub const PART: &str = "part";

/// Whether two files are the same data: of one fingerprint, and not of two different parts.
#[must_use]
pub fn is_same_data(a: &DataFile, b: &DataFile) -> bool {
    let parts = |file: &DataFile| {
        file.steps.iter().filter(|step| step.step == PART).map(|step| step.words.clone()).collect::<Vec<_>>()
    };
    let [of_a, of_b] = [parts(a), parts(b)];
    // Of a file that was read twice, or as a whole, any part is the same.
    let are_other = of_a.len() == 1 && of_b.len() == 1 && of_a != of_b;
    a.sha256 == b.sha256 && !are_other
}

/// Files in the order of their first naming.
pub struct DataFiles<'a> {
    /// How a path is written.
    named: &'a dyn Fn(&Path) -> String,
    files: Vec<(PathBuf, DataFile)>,
}

impl<'a> DataFiles<'a> {
    /// None yet; `named` says how a path is written in the record.
    #[must_use]
    pub fn new(named: &'a dyn Fn(&Path) -> String) -> Self {
        Self { named, files: Vec::new() }
    }

    /// Takes a file in, if it is new; its key.
    ///
    /// # Errors
    ///
    /// It cannot be read.
    pub fn key(&mut self, path: &Path, role: &str) -> Result<String, RecordError> {
        let at = match self.files.iter().position(|(known, _)| known == path) {
            Some(at) => at,
            None => {
                let file = DataFile { role: Some(role.to_owned()), ..DataFile::of(path, &(self.named)(path))? };
                self.files.push((path.to_owned(), file));
                self.files.len() - 1
            }
        };
        Ok(format!("d{}", at + 1))
    }

    /// Takes files in; the keys of those that hold the observations of `method`.
    ///
    /// # Errors
    ///
    /// As [`Self::key`].
    pub fn keys_of(&mut self, files: &[ReadFile], observed: impl Fn(&str) -> bool) -> Result<Vec<String>, RecordError> {
        let mut out = Vec::new();
        for file in files {
            let key = self.key(&file.path, &file.role)?;
            if let Some((_, data)) = self.files.iter_mut().find(|(known, _)| *known == file.path) {
                // Several methods may read one run; what they do alike is done once.
                let new = file.steps.iter().filter(|step| !data.steps.contains(step)).cloned().collect::<Vec<_>>();
                data.steps.extend(new);
            }
            if observed(&file.role) {
                out.push(key);
            }
        }
        Ok(out)
    }

    /// A file by its key.
    #[must_use]
    pub fn get(&self, key: &str) -> Option<&DataFile> {
        let at: usize = key.strip_prefix('d')?.parse().ok()?;
        self.files.get(at.checked_sub(1)?).map(|(_, file)| file)
    }

    /// Lists a file behind a record that numbers were taken from, as that record names it; once.
    pub fn inherit(&mut self, file: &DataFile) {
        if !self.files.iter().any(|(_, known)| is_same_data(known, file)) {
            let steps = file.steps.iter().filter(|step| step.step == PART).cloned().collect();
            let file = DataFile { role: Some(INHERITED.to_owned()), steps, ..file.clone() };
            self.files.push((PathBuf::new(), file));
        }
    }

    /// All of them by key.
    #[must_use]
    pub fn into_map(self) -> IndexMap<String, DataFile> {
        keyed(self.files.into_iter().map(|(_, file)| file).collect())
    }
}

#[cfg(test)]
mod tests {
    use froude_records::run::step::Step;

    use super::*;

    #[test]
    fn two_sheets_are_different_data_and_two_readings_of_one_are_not() {
        let file = |parts: &[&str]| DataFile {
            sha256: "1".to_owned(),
            steps: parts.iter().map(|words| Step::new(PART, "", *words)).collect(),
            ..DataFile::default()
        };
        assert!(!is_same_data(&file(&["sheet a"]), &file(&["sheet b"])));
        assert!(is_same_data(&file(&["sheet a"]), &file(&["sheet a"])));
        assert!(is_same_data(&file(&["sheet a"]), &file(&[])));
        assert!(is_same_data(&file(&["sheet a", "sheet b"]), &file(&["sheet b"])));
        assert!(!is_same_data(&file(&[]), &DataFile { sha256: "2".to_owned(), ..file(&[]) }));
    }
}
