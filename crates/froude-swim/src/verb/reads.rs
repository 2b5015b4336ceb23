//! The files that a swim reads: listed in its result with their fingerprints, and never replaced by it.

use std::path::{Path, PathBuf};

use froude_records::estimate::DataFile;
use froude_records::hash::sha256_of_file;
use froude_records::results::spares;

use super::VerbError;
use super::moves::Moves;
use crate::robot_file::{AddedFile, RobotFile, is_urdf, sidecar_of_urdf};

/// Files with what each was read as.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Reads(Vec<(&'static str, PathBuf)>);

impl Reads {
    pub(super) fn of(file: &RobotFile, robot: &Path, moves: &Moves, motor: Option<&Path>) -> Self {
        let mut all = vec![("robot", robot.to_owned())];
        if is_urdf(robot) {
            all.push(("robot", sidecar_of_urdf(robot)));
        }
        all.push(("drag", file.drag.path.clone()));
        let own = file.modules.iter().filter_map(|module| module.added.as_ref());
        for from in own.chain([&file.added_mass]) {
            if let AddedFile::Record(from) = from {
                all.push(("added mass", from.path.clone()));
            }
        }
        if let Moves::File { path, .. } | Moves::Track(path) = moves {
            all.push(("gait", path.clone()));
        }
        all.extend(motor.map(|path| ("motor", path.to_owned())));
        let mut out: Vec<(&'static str, PathBuf)> = Vec::new();
        for read in all {
            if !out.contains(&read) {
                out.push(read);
            }
        }
        Self(out)
    }

    /// Those that the robot's numbers depend on.
    pub(super) fn but_the_gait(&self) -> Vec<PathBuf> {
        self.0.iter().filter(|(role, _)| *role != "gait").map(|(_, path)| path.clone()).collect()
    }

    /// Refuses results in a folder that holds one of them, or in place of one.
    pub(super) fn spared_by(&self, out: &Path) -> Result<(), VerbError> {
        Ok(spares(out, self.0.iter().map(|(_, path)| path.as_path()))?)
    }

    /// With their fingerprints.
    pub(super) fn data(&self) -> Result<Vec<DataFile>, VerbError> {
        let one = |(role, path): &(&'static str, PathBuf)| {
            Ok(DataFile {
                path: path.display().to_string(),
                sha256: sha256_of_file(path)?,
                role: Some((*role).to_owned()),
                steps: Vec::new(),
            })
        };
        self.0.iter().map(one).collect()
    }
}
