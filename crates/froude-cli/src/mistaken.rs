//! A file that a verb does not take: what it is instead, and the command that takes it.
//!
//! Readers say what is wrong with a file as the kind that they read. Where it is another kind altogether, that says nothing: a campaign is no
//! broken run. So when a verb was refused its input, what was named is looked at again.

use std::path::{Path, PathBuf};

use froude::cfd::forces::inspect::{DatFile, dat_file};
use froude::records::kind::Kind;
use froude::records::table_file::is_table;

use crate::failure::Failure;

pub struct Takes {
    verb: &'static str,
    kinds: &'static [Kind],
    words: &'static str,
}

pub const IDENTIFY: Takes = Takes {
    verb: "identify",
    kinds: &[Kind::Campaign, Kind::Drive, Kind::Table],
    words: "a campaign (.toml) or a table (.csv, .xlsx, .parquet, …)",
};
pub const INSPECT: Takes = Takes {
    verb: "inspect",
    kinds: &[Kind::Campaign, Kind::Drive, Kind::Table, Kind::Record, Kind::Run, Kind::RunSidecar, Kind::Runs],
    words: "a table (.csv, .xlsx, .parquet, …), a campaign (.toml), a record (.json), a run (.mcap) or a folder of runs",
};
pub const COMPARE: Takes = Takes { verb: "compare", kinds: &[Kind::Record], words: "records (estimate.json)" };
pub const PREDICT: Takes = Takes {
    verb: "predict",
    kinds: &[Kind::Record, Kind::Table],
    words: "a record (estimate.json) and then a table (.csv, .xlsx, .parquet, …)",
};
pub const SIMULATE: Takes =
    Takes { verb: "simulate", kinds: &[Kind::Campaign, Kind::Drive], words: "a campaign with plan and truth (.toml)" };
pub const PLAN: Takes =
    Takes { verb: "plan", kinds: &[Kind::Campaign, Kind::Drive], words: "a campaign with a plan of runs (.toml)" };
pub const RUN: Takes =
    Takes { verb: "run", kinds: &[Kind::Campaign, Kind::Drive], words: "a campaign with [rig] and [carriage] (.toml)" };
pub const TUNE: Takes = Takes { verb: "carriage tune", ..RUN };
pub const RESONANCE: Takes = Takes { verb: "carriage resonance", ..RUN };
pub const DRAG: Takes = Takes {
    verb: "carriage drag",
    kinds: &[Kind::Run, Kind::RunSidecar, Kind::Runs],
    words: "folders of runs, or runs (.mcap)",
};
pub const CALIBRATE: Takes = Takes { verb: "carriage calibrate", ..DRAG };
pub const SERVO: Takes = Takes {
    verb: "carriage identify",
    kinds: &[Kind::Run, Kind::RunSidecar, Kind::Runs, Kind::Table],
    words: "folders of runs, runs (.mcap), or a servo log (.csv)",
};
pub const ADDED_MASS: Takes = Takes {
    verb: "added-mass",
    kinds: &[Kind::Body, Kind::Mesh],
    words: "a body file (.toml) or a closed mesh (.stl, .obj, …)",
};

pub const ROBOT: Takes =
    Takes { verb: "robot inspect", kinds: &[Kind::Robot], words: "a robot file (.toml, or .urdf with a sidecar)" };

impl Takes {
    /// What the verb found; else its error, or what was named instead of what the verb takes.
    pub fn or<T, E: Into<Failure>>(&self, found: Result<T, E>, paths: &[PathBuf]) -> Result<T, Failure> {
        let error = match found {
            Ok(found) => return Ok(found),
            Err(error) => error.into(),
        };
        if error.exit_code() != 2 {
            return Err(error);
        }
        // A folder with logs of other programs is one of runs, of another method: the reader has said which reads them.
        let is_taken = |path: &PathBuf, kind: Kind| {
            self.kinds.contains(&kind) || (kind == Kind::Folder && self.kinds.contains(&Kind::Runs) && has_logs(path))
        };
        let other = |path: &PathBuf| Some((path.clone(), kind_of(path).filter(|kind| !is_taken(path, *kind))?));
        Err(paths.iter().find_map(other).map_or(error, |(path, kind)| {
            let (found, instead) = (kind.words(), self.instead(kind, &path));
            let takes = format_args!("froude {} takes {}", self.verb, self.words);
            Failure::refused(format_args!("{} is {found}; {takes}. {instead}", path.display()))
        }))
    }

    /// What to write instead.
    fn instead(&self, kind: Kind, path: &Path) -> String {
        let shown = path.display();
        let is_of_runs = self.kinds.contains(&Kind::Runs);
        match kind {
            Kind::Drive if is_of_runs => {
                let stem = path.file_stem().unwrap_or_default().to_string_lossy();
                let runs = path.with_file_name(format!("{stem}-runs"));
                if runs.is_dir() {
                    format!("Its runs are in {0}: froude {1} {0}", runs.display(), self.verb)
                } else {
                    format!("Drive it first: froude run {shown}")
                }
            }
            Kind::Drive => format!("To drive it: froude run {shown}"),
            Kind::Campaign => format!("To fit it: froude identify {shown}"),
            Kind::Body | Kind::Mesh => format!("To compute with it: froude added-mass {shown}"),
            Kind::Robot => format!("To see what is in it: froude robot inspect {shown}"),
            Kind::TableSidecar => {
                let tables = ["csv", "parquet"].map(|extension| path.with_extension(extension));
                let table = tables.iter().find(|table| table.exists()).unwrap_or(&tables[0]).display();
                format!("It describes the columns of {table}; name the table instead: froude inspect {table}")
            }
            Kind::RunSidecar | Kind::Run => format!("To see it: froude inspect {shown}"),
            Kind::Table | Kind::Record => format!("To see what is in it: froude inspect {shown}"),
            Kind::Runs => {
                format!("To reduce it: froude carriage drag {shown}; to see what is in it: froude inspect {shown}")
            }
            Kind::Results => {
                let [record, report] = ["estimate.json", "report.html"].map(|name| path.join(name));
                if record.exists() {
                    format!("Its record: froude inspect {}; its report: {}", record.display(), report.display())
                } else {
                    format!("Open {} in a browser", report.display())
                }
            }
            Kind::Folder if is_of_runs => {
                "It holds no run; froude run CAMPAIGN drives them and prints where they are".to_owned()
            }
            Kind::Folder => "Name a file in it".to_owned(),
        }
    }
}

/// Whether a folder holds tables, as other programs write logs.
fn has_logs(folder: &Path) -> bool {
    let is_log = |file: PathBuf| matches!(kind_of(&file), Some(Kind::Table));
    std::fs::read_dir(folder).is_ok_and(|entries| entries.filter_map(Result::ok).any(|entry| is_log(entry.path())))
}

/// What is there under a name; `None` where nothing is, or nothing that is known.
fn kind_of(path: &Path) -> Option<Kind> {
    if path.is_dir() {
        let is_run = |file: PathBuf| match file.extension().map(|e| e.to_string_lossy().into_owned()).as_deref() {
            Some("mcap") => true,
            Some("toml") => Kind::of_toml(&file) == Some(Kind::RunSidecar),
            _ => false,
        };
        let has_run = std::fs::read_dir(path).ok()?.filter_map(Result::ok).any(|entry| is_run(entry.path()));
        let has_results = ["estimate.json", "report.html"].iter().any(|name| path.join(name).exists());
        return Some(if has_run {
            Kind::Runs
        } else if has_results {
            Kind::Results
        } else {
            Kind::Folder
        });
    }
    if !path.exists() {
        return None;
    }
    match path.extension()?.to_string_lossy().to_lowercase().as_str() {
        "json" => Some(Kind::Record),
        "mcap" => Some(Kind::Run),
        "stl" | "obj" | "ply" | "gdf" | "msh" | "dae" => Some(Kind::Mesh),
        "dat" if dat_file(path) == Some(DatFile::Mesh) => Some(Kind::Mesh),
        "dat" if dat_file(path) == Some(DatFile::Forces) => None,
        "urdf" => Some(Kind::Robot),
        "toml" => Kind::of_toml(path),
        _ => is_table(path).then_some(Kind::Table),
    }
}
