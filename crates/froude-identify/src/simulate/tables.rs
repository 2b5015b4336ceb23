//! The statistical twin of a campaign: its tables, written where the campaign expects them.
//!
//! A campaign may come from anybody: its tables are written inside its own folder only, in the format that their names say.

use std::path::{Component, Path, PathBuf};

use froude_records::RecordError;
use froude_records::campaign::{Campaign, Input, Source};
use froude_records::campaign_file::read_campaign;
use froude_records::manifest::{may_replace, take_own_place};
use froude_records::table_file::prepare_table;

use super::{observations, table};
use crate::error::IdentifyError;

/// Why no table was written, or not all of them.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimulateError {
    /// A file could not be read or written, or says something impossible.
    #[error(transparent)]
    Record(#[from] RecordError),

    /// The truth of the campaign gives no observations.
    #[error(transparent)]
    Identify(#[from] IdentifyError),

    /// Nothing is planned.
    #[error("{}: no source of a tank has a [[source.plan]], which says the configurations, speeds and angles that are run (computed flows are planned by froude cfd plan)", .path.display())]
    NoPlan {
        /// The campaign.
        path: PathBuf,
    },

    /// A plan without a place for its observations.
    #[error("source {source_name:?}: a plan needs `table`, where its observations go")]
    NoTable {
        /// The source.
        source_name: String,
    },

    /// A table that is not to be replaced.
    #[error("{} exists; give --replace to write the twin's observations over it", .path.display())]
    Exists {
        /// The table.
        path: PathBuf,
    },

    /// Some of several files took their places, and the others did not.
    #[error("{source}; written before it: {done}")]
    HalfWay {
        /// The files.
        done: String,
        /// Why the next one failed.
        source: RecordError,
    },
}

impl SimulateError {
    /// True where the input is at fault, false where the machine is.
    #[must_use]
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Record(e) | Self::Identify(IdentifyError::Record(e)) => !e.is_output(),
            Self::HalfWay { .. } => false,
            _ => true,
        }
    }
}

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
/// An existing table is replaced only when `replace` is true, it was written by Froude, and nobody changed it since: a campaign may name a measured one. All tables lie whole on the disk before the first takes its place.
///
/// # Errors
///
/// See [`SimulateError`]: a campaign without plan or without `[simulate]`; a table outside of the campaign's folder, of two sources, or of no format.
pub fn write(campaign: &Path, replace: bool) -> Result<Vec<Written>, SimulateError> {
    let campaign = read_campaign(campaign)?;
    let planned: Vec<(usize, &Source)> = campaign
        .sources
        .iter()
        .enumerate()
        .filter(|(_, source)| !source.plan.is_empty() && !source.plans_runs())
        .collect();
    if planned.is_empty() {
        return Err(SimulateError::NoPlan { path: campaign.path });
    }
    let mut places: Vec<(PathBuf, &Source)> = Vec::new();
    for (_, source) in &planned {
        let path = table_of(source)?;
        let place = place_inside(path, &campaign, source)?;
        if let Some((_, other)) = places.iter().find(|(taken, _)| *taken == place) {
            return Err(refused(
                source,
                format!("is the table of source {:?}, too; give each source a table of its own", other.name),
            ));
        }
        if path.exists() && !replace {
            return Err(SimulateError::Exists { path: path.to_owned() });
        }
        may_replace(path)?;
        places.push((place, source));
    }
    let mut prepared = Vec::new();
    for (stream, source) in planned {
        let data = observations(&campaign, source, stream as u64)?;
        let table = table(&data, source)?;
        let written = Written { source: source.name.clone(), path: table.path.clone(), rows: table.n_rows };
        prepared.push((prepare_table(&table, &table.path)?, written));
    }
    let mut written: Vec<Written> = Vec::new();
    for (table, done) in prepared {
        take_own_place(table).map_err(|error| half_way(error, &written))?;
        written.push(done);
    }
    Ok(written)
}

fn table_of(source: &Source) -> Result<&Path, SimulateError> {
    match &source.input {
        Input::Table(path) => Ok(path),
        _ => Err(SimulateError::NoTable { source_name: source.name.clone() }),
    }
}

fn refused(source: &Source, problem: String) -> SimulateError {
    RecordError::Value { place: source.place.clone(), key: "table".to_owned(), problem }.into()
}

/// One name for each place below the campaign's folder, also where a disk does not tell `A.csv` from `a.csv`.
fn place_inside(path: &Path, campaign: &Campaign, source: &Source) -> Result<PathBuf, SimulateError> {
    let folder = campaign.path.parent().unwrap_or(Path::new(""));
    let inside = path.strip_prefix(folder).unwrap_or(path);
    let outside = || {
        refused(
            source,
            format!(
                "is {:?}, which leads out of the campaign's folder; froude simulate writes inside it only: name a table there, such as \
                 table = \"twin.csv\"",
                inside.display().to_string()
            ),
        )
    };
    if !inside.components().all(|c| matches!(c, Component::Normal(_) | Component::CurDir)) {
        return Err(outside());
    }
    let ending = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    if !matches!(ending.as_deref(), Some("csv" | "parquet")) {
        return Err(refused(
            source,
            format!("is {:?}; a table is written as .csv or .parquet", inside.display().to_string()),
        ));
    }
    // A link on the way may lead anywhere.
    let real = |folder: &Path| if folder.as_os_str().is_empty() { Path::new(".") } else { folder }.canonicalize();
    let (Ok(own), Ok(parent)) = (real(folder), real(path.parent().unwrap_or(folder))) else {
        return Err(refused(
            source,
            format!("is {:?}, and its folder does not exist; make it first", inside.display().to_string()),
        ));
    };
    if !parent.starts_with(&own) {
        return Err(outside());
    }
    Ok(parent.join(path.file_name().unwrap_or_default().to_string_lossy().to_lowercase()))
}

/// A failure after some tables had taken their places.
fn half_way(error: RecordError, written: &[Written]) -> SimulateError {
    if written.is_empty() {
        return error.into();
    }
    let done: Vec<String> = written.iter().map(|w| w.path.display().to_string()).collect();
    SimulateError::HalfWay { done: done.join(", "), source: error }
}
