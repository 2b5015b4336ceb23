//! How good the meshes are, and the y+ of the flows on them.

use froude_cfd::again::Again;
use froude_cfd::poly_mesh::PolyMesh;
use froude_cfd::quality::Quality;
use froude_records::number::{count, significant};
use froude_records::page::{DocumentSection, TextTable};
use serde_json::{Value, json};

use super::Solved;

/// A mesh with the y+ of its cases that count.
struct Meshed {
    /// The configuration, and what is computed again on it.
    name: String,
    cells: usize,
    quality: Result<Quality, String>,
    /// Least and largest of the means, largest of all.
    y_plus: Option<[f64; 3]>,
}

impl Meshed {
    fn of(solved: &[Solved]) -> Vec<Self> {
        let mut first: Vec<&Solved> = Vec::new();
        for own in solved {
            if !first.iter().any(|f| f.case.mesh == own.case.mesh) {
                first.push(own);
            }
        }
        let meshed = |own: &Solved| {
            let same = solved.iter().filter(|s| s.case.mesh == own.case.mesh && s.outcome.status.is_usable());
            let y_plus =
                same.filter_map(|s| s.outcome.y_plus).fold(None, |found: Option<[f64; 3]>, [_, mean, most]| {
                    let [low, high, largest] = found.unwrap_or([mean, mean, most]);
                    Some([low.min(mean), high.max(mean), largest.max(most)])
                });
            let mesh = PolyMesh::read(&own.mesh).map_err(|e| e.to_string());
            Self {
                name: match Again::of(&own.case.id) {
                    None | Some((_, Again::Cold)) => own.case.configuration.clone(),
                    Some((_, again)) => format!("{}, {}", own.case.configuration, again.suffix()),
                },
                cells: own.outcome.cells,
                quality: mesh.map(|mesh| Quality::of(&mesh)),
                y_plus,
            }
        };
        first.into_iter().map(meshed).collect()
    }

    fn row(&self) -> Vec<String> {
        let measure = |of: &dyn Fn(&Quality) -> f64| match &self.quality {
            Ok(quality) => significant(of(quality), 3),
            Err(_) => "—".to_owned(),
        };
        let y_plus = |of: &dyn Fn(&[f64; 3]) -> String| self.y_plus.as_ref().map_or_else(|| "—".to_owned(), of);
        vec![
            self.name.clone(),
            count(self.cells),
            measure(&|q| q.max_non_orthogonality_rad.value.to_degrees()),
            measure(&|q| q.max_skewness.value),
            measure(&|q| q.max_aspect.value),
            y_plus(&|y| format!("{} to {}", significant(y[0], 2), significant(y[1], 2))),
            y_plus(&|y| significant(y[2], 2)),
        ]
    }

    fn as_json(&self) -> Value {
        json!({
            "mesh": self.name,
            "cells": self.cells,
            "max_non_orthogonality_rad": self.quality.as_ref().ok().map(|q| q.max_non_orthogonality_rad.value),
            "max_skewness": self.quality.as_ref().ok().map(|q| q.max_skewness.value),
            "max_aspect": self.quality.as_ref().ok().map(|q| q.max_aspect.value),
            "problem": self.quality.as_ref().err(),
            "y_plus_mean": self.y_plus.map(|y| [y[0], y[1]]),
            "y_plus_largest": self.y_plus.map(|y| y[2]),
        })
    }
}

/// The section, and the same for a program.
pub(super) fn section(solved: &[Solved]) -> (DocumentSection, Value) {
    let meshes = Meshed::of(solved);
    let problems = meshes.iter().filter_map(|m| Some(format!("{}: {}", m.name, m.quality.as_ref().err()?)));
    let head =
        ["body", "cells", "non-orthogonality, deg", "skewness", "aspect ratio", "y+, mean of a case", "y+, largest"];
    let table = TextTable {
        caption: "Meshes by the measures of checkMesh where they are worst, and y+ of the cases that count.".to_owned(),
        head: head.map(str::to_owned).to_vec(),
        rows: meshes.iter().map(Meshed::row).collect(),
    };
    let section = DocumentSection {
        title: "Meshes and y+".to_owned(),
        paragraphs: problems.collect(),
        tables: if meshes.is_empty() { Vec::new() } else { vec![table] },
        charts: Vec::new(),
    };
    (section, meshes.iter().map(Meshed::as_json).collect())
}
