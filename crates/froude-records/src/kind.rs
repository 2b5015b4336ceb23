//! What kind of file something is, where a verb was given another than it takes.

use std::io::Read as _;
use std::path::Path;

use crate::read;

/// As much of a file of TOML as is looked at.
const MOST_BYTES: u64 = 1 << 20;

/// What a file or a folder is, by its name and its first words.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// A campaign that drives a rig.
    Drive,
    /// One that is fitted, planned or simulated.
    Campaign,
    /// A body of a known shape.
    Body,
    /// A robot, planar or in space.
    Robot,
    /// What the columns of a table are.
    TableSidecar,
    /// What is known of a run.
    RunSidecar,
    /// A recorded run.
    Run,
    /// A table, in any format that is read.
    Table,
    /// Estimates.
    Record,
    /// A surface.
    Mesh,
    /// A folder of runs.
    Runs,
    /// A folder that a verb wrote its results into.
    Results,
    /// Any other folder.
    Folder,
}

impl Kind {
    /// In a sentence.
    #[must_use]
    pub fn words(self) -> &'static str {
        match self {
            Self::Drive | Self::Campaign => "a campaign",
            Self::Body => "a body file",
            Self::Robot => "a robot file",
            Self::TableSidecar => "the sidecar of a table",
            Self::RunSidecar => "the sidecar of a run",
            Self::Run => "a run",
            Self::Table => "a table",
            Self::Record => "a record",
            Self::Mesh => "a mesh",
            Self::Runs => "a folder of runs",
            Self::Results => "a folder of results",
            Self::Folder => "a folder",
        }
    }

    /// What a file of TOML is: by its sections and first keys, also where it has a fault that a reader would stop at.
    #[must_use]
    pub fn of_toml(path: &Path) -> Option<Self> {
        let mut bytes = Vec::new();
        read::open(path).ok()?.take(MOST_BYTES).read_to_end(&mut bytes).ok()?;
        let text = String::from_utf8_lossy(&bytes);
        let lines = || text.lines().map(str::trim);
        let has_section = |name: &str| {
            let head = |line: &str| line.trim_start_matches('[').split([']', '.', ' ']).next() == Some(name);
            lines().any(|line| line.starts_with('[') && head(line))
        };
        // Keys of the file itself stand before its first section.
        let key = |line: &str| line.split('=').next().unwrap_or_default().trim().to_owned();
        let keys: Vec<String> = lines().take_while(|line| !line.starts_with('[')).map(key).collect();
        let has_key = |name: &str| keys.iter().any(|key| key == name);
        // A rig of which there are only logs is not driven.
        let is_of_logs = lines().any(|line| line.replace(' ', "").starts_with("kind=\"logs\""));
        let shape = || lines().any(|line| key(line) == "shape");
        Some(if has_key("id") && has_key("campaign") {
            Self::RunSidecar
        } else if has_section("rig") && !is_of_logs {
            Self::Drive
        } else if has_section("module") && has_section("fluid") {
            Self::Robot
        } else if has_section("source") {
            Self::Campaign
        } else if has_section("columns") || has_section("constants") {
            Self::TableSidecar
        } else if has_section("body") && shape() {
            Self::Body
        } else {
            return None;
        })
    }
}
