//! How good the meshes are, and the y+ of the flows on them.

use froude_records::block::{Block, TableBuilder};

use super::solved::Solved;
use crate::again::Again;
use crate::poly_mesh::PolyMesh;
use crate::quality::Quality;

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
}

pub(super) fn blocks(solved: &[Solved]) -> Vec<Block> {
    let meshes = Meshed::of(solved);
    let problems = meshes.iter().filter_map(|m| Some(format!("{}: {}", m.name, m.quality.as_ref().err()?)));
    let caption = "Meshes by the measures of checkMesh where they are worst, and y+ of the cases that count.";
    let t = TableBuilder::new("meshes", caption, &meshes);
    let of = |m: &Meshed, of: fn(&Quality) -> f64| m.quality.as_ref().ok().map(of);
    let table = t.build(vec![
        t.text("mesh", "body", |m| m.name.clone()),
        t.count("cells", "cells", |m| m.cells),
        t.number("max_non_orthogonality_rad", "non-orthogonality [deg]", |m| {
            of(m, |q| q.max_non_orthogonality_rad.value)
        })
        .significant(3),
        t.number("max_skewness", "skewness", |m| of(m, |q| q.max_skewness.value)).significant(3),
        t.number("max_aspect", "aspect ratio", |m| of(m, |q| q.max_aspect.value)).significant(3),
        t.interval("y_plus_mean", "y+, mean of a case", |m| m.y_plus.map(|y| [y[0], y[1]])).range(),
        t.number("y_plus_largest", "y+, largest", |m| m.y_plus.map(|y| y[2])).significant(2),
        t.text("problem", "", |m| m.quality.as_ref().err().cloned()),
    ]);
    vec![Block::text("", problems.collect()), table.into()]
}
