//! The statistical twin of a campaign: its tables, written where the campaign expects them.

use std::path::{Path, PathBuf};

use froude_identify::simulate;
use froude_records::campaign::{Input, read_campaign};
use froude_records::csv_table::write_csv;

use crate::Error;

/// A table that was written.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// Name of the source.
    pub source: String,
    /// Where the table lies.
    pub path: PathBuf,
    /// Its rows.
    pub rows: usize,
}

/// Writes the table of every source with a `plan`.
///
/// An existing table is replaced only when `replace` is true.
///
/// # Errors
///
/// See [`Error`]; a campaign without plan or without `[simulate]`.
pub fn simulate(campaign: &Path, replace: bool) -> Result<Vec<Written>, Error> {
    let campaign = read_campaign(campaign)?;
    let mut tables = Vec::new();
    for (stream, source) in campaign.sources.iter().enumerate() {
        if source.plan.is_empty() {
            continue;
        }
        let Input::Table(path) = &source.input else {
            return Err(Error::Nothing(format!(
                "source {:?}: a plan needs `table`, where its observations go",
                source.name
            )));
        };
        if path.exists() && !replace {
            return Err(Error::Nothing(format!(
                "{} exists; say --replace to write the twin's observations over it",
                path.display()
            )));
        }
        let data = simulate::observations(&campaign, source, stream as u64)?;
        tables.push((source.name.clone(), simulate::table(&data, source)?));
    }
    if tables.is_empty() {
        return Err(Error::Nothing(format!(
            "{}: no source has a [[source.plan]]: say which configurations, speeds and angles are run",
            campaign.path.display()
        )));
    }
    let mut written = Vec::new();
    for (source, table) in tables {
        write_csv(&table, &table.path)?;
        written.push(Written { source, path: table.path.clone(), rows: table.n_rows });
    }
    Ok(written)
}
