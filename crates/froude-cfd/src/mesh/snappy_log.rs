//! What a mesh by snappyHexMesh came to, by what its programs print.

use serde::{Deserialize, Serialize};

/// A mesh that was made, and how good it is.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Made {
    /// Its folder under `meshes/`, which is the hash of its content.
    pub mesh: String,
    /// Cells.
    pub cells: usize,
    /// Largest non-orthogonality, rad.
    pub max_non_orthogonality_rad: f64,
    /// Largest skewness \[-\].
    pub max_skewness: f64,
    /// Faces of the body.
    pub wall_faces: usize,
    /// Layers that were asked for.
    pub layers_asked: usize,
    /// Layers on a face of the body, mean \[-\].
    pub layers: f64,
    /// Thickness of all layers on a face, mean, m.
    pub layers_m: f64,
    /// Part of the thickness that was asked for \[-\].
    pub coverage: f64,
    /// Part of the body's area whose cell at the wall is a layer \[-\].
    pub area_coverage: f64,
    /// Version of OpenFOAM that made it.
    pub openfoam: String,
}

/// Faces, layers, thickness in m and its part of what was asked, in the last table of `log.snappyHexMesh`.
pub(crate) fn layers_of(log: &str, patch: &str) -> Option<(usize, f64, f64, f64)> {
    log.lines().rev().find_map(|line| {
        let mut words = line.split_whitespace();
        if words.next() != Some(patch) {
            return None;
        }
        let faces = words.next()?.parse().ok()?;
        let mut number = || words.next()?.parse::<f64>().ok();
        Some((faces, number()?, number()?, 0.01 * number()?))
    })
}

/// Cells, largest non-orthogonality in degrees and largest skewness, in `log.checkMesh`.
pub(crate) fn quality_of(log: &str) -> Option<(usize, f64, f64)> {
    let number = |line: &str, behind: &str| {
        let rest = line.split(behind).nth(1)?.trim_start();
        rest.split([' ', ',', ';']).next()?.trim_end_matches('.').parse::<f64>().ok()
    };
    let find = |behind: &str| log.lines().find_map(|line| number(line, behind));
    let cells =
        log.lines().find_map(|line| number(line.trim_start().strip_prefix("cells:").map(|_| line)?, "cells:"))?;
    Some((cells as usize, find("Mesh non-orthogonality Max:")?, find("Max skewness =")?))
}

/// The program's own words of what is wrong: its fatal error, or the lines that it marks.
pub(crate) fn fault_of(log: &str) -> Option<String> {
    let marked: Vec<&str> = log.lines().filter(|line| line.contains("***")).map(str::trim).collect();
    if !marked.is_empty() {
        return Some(marked.join("; "));
    }
    crate::solver_log::SolverLog::of(log).fatal
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    const SNAPPY: &str = "patch faces    layers   overall thickness\n                        [m]       [%]\n----- -----    ------   ---      ---\nbody  1024     3.5      0.004    80      \n\nDoing final balancing\npatch faces    layers   overall thickness\n                        [m]       [%]\n----- -----    ------   ---      ---\nbody  1024     2.97     0.00398  99.6     \n\nLayer mesh : cells:20484  faces:64242  points:23468\n";
    const CHECK: &str = "Mesh stats\n    points:           23468\n    faces:            64242\n    cells:            20484\n\n    Max aspect ratio = 12.4 OK.\n    Mesh non-orthogonality Max: 61.25 average: 10.3\n    Max skewness = 1.75 OK.\n\nMesh OK.\n";

    #[test]
    fn the_programs_say_how_good_a_mesh_is() {
        assert_eq!(layers_of(SNAPPY, "body"), Some((1024, 2.97, 0.00398, 0.996)));
        assert_eq!(quality_of(CHECK), Some((20484, 61.25, 1.75)));
        assert_eq!((fault_of(SNAPPY), fault_of(CHECK)), (None, None));
    }

    #[test]
    fn a_fault_is_told_in_the_programs_own_words() {
        let of = |text: &str| fault_of(text).unwrap();
        assert_eq!(of(" ***Max skewness = 7, 3 highly skew faces\n"), "***Max skewness = 7, 3 highly skew faces");
        assert_eq!(of("--> FOAM FATAL ERROR: \n Point is not inside the mesh\n"), "Point is not inside the mesh");
    }

    proptest! {
        #[test]
        fn no_text_brings_the_reader_down(cut in 0..SNAPPY.len(), text in "[a-z0-9.:= \n*]{0,80}") {
            let _ = layers_of(&SNAPPY[..cut], "body");
            let _ = (layers_of(&text, "body"), quality_of(&text), quality_of(&CHECK[..cut.min(CHECK.len())]), fault_of(&text));
        }
    }
}
