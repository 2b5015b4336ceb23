//! OpenFOAM's own opinion of a mesh.

use std::path::Path;
use std::process::Command;

use froude_cfd::poly_mesh::PolyMesh;
use froude_cfd::quality::Quality;

/// `checkMesh` has nothing to say of a mesh, and its measures are ours.
///
/// # Panics
///
/// Where that is not so.
pub fn assert_openfoam_agrees(name: &str, mesh: &PolyMesh, quality: &Quality) {
    let folder = tempfile::tempdir().unwrap();
    let written = mesh.write(folder.path()).unwrap();
    assert_eq!(written, mesh.write(folder.path()).unwrap());
    let Some(log) = check_mesh(&written) else { return };
    assert!(log.contains("\nMesh OK."), "{name}: {log}");
    assert!(!log.contains("***"), "{name}: {log}");
    let agrees = |text: &str, ours: f64, zero: f64| {
        let theirs = number_after(&log, text);
        // Six digits are printed, and an angle near 0 has half of them.
        assert!((theirs - ours).abs() < 1e-5 * (ours.abs() + zero), "{name}: {text} {theirs}, here {ours}");
    };
    assert_eq!(number_after(&log, "cells:            ") as usize, mesh.cells);
    agrees("Mesh non-orthogonality Max: ", quality.max_non_orthogonality_rad.value.to_degrees(), 1.0);
    agrees(" average: ", quality.mean_non_orthogonality_rad.to_degrees(), 1.0);
    agrees("Max skewness = ", quality.max_skewness.value, 1.0);
    agrees("Max aspect ratio = ", quality.max_aspect.value, 0.0);
    agrees("Total volume = ", quality.volume_m3, 0.0);
    agrees("Min volume = ", quality.least_volume_m3.value, 0.0);
}

/// What `checkMesh` prints of a mesh; `None` where there is no OpenFOAM, which a pipeline does not take.
///
/// # Panics
///
/// On a pipeline without OpenFOAM, or where files cannot be written.
fn check_mesh(mesh: &Path) -> Option<String> {
    let case = tempfile::tempdir().unwrap();
    let system = case.path().join("system");
    std::fs::create_dir_all(&system).unwrap();
    let header = "FoamFile\n{\n version 2.0;\n format ascii;\n class dictionary;\n object any;\n}\n";
    let control = "application simpleFoam;\nstartFrom startTime;\nstartTime 0;\nstopAt endTime;\nendTime 1;\ndeltaT 1;\nwriteControl timeStep;\nwriteInterval 1;\n";
    let schemes = "ddtSchemes\n{\n}\ngradSchemes\n{\n}\ndivSchemes\n{\n}\nlaplacianSchemes\n{\n}\ninterpolationSchemes\n{\n}\nsnGradSchemes\n{\n}\n";
    for (name, text) in [("controlDict", control), ("fvSchemes", schemes), ("fvSolution", "")] {
        std::fs::write(system.join(name), format!("{header}{text}")).unwrap();
    }
    let inside = case.path().join("constant/polyMesh");
    std::fs::create_dir_all(&inside).unwrap();
    for file in std::fs::read_dir(mesh).unwrap() {
        let file = file.unwrap().path();
        std::fs::copy(&file, inside.join(file.file_name().unwrap())).unwrap();
    }
    let found =
        Command::new("checkMesh").arg("-case").arg(case.path()).env("WM_PROJECT_DIR", "/usr/share/openfoam").output();
    match found {
        Ok(output) => {
            Some(String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr))
        }
        Err(error) => {
            assert!(std::env::var_os("CI").is_none(), "checkMesh does not run: {error}; install openfoam");
            println!("left out: checkMesh does not run here: {error}");
            None
        }
    }
}

/// The number that follows a text in a log.
///
/// # Panics
///
/// Where there is none.
pub fn number_after(log: &str, text: &str) -> f64 {
    let rest = log.split(text).nth(1).unwrap_or_else(|| panic!("{text:?} is not in {log}"));
    let end = rest.find(|c: char| !(c.is_ascii_digit() || ".e+-".contains(c))).unwrap_or(rest.len());
    rest[..end].trim_end_matches('.').parse().unwrap_or_else(|e| panic!("{text:?} {:?}: {e}", &rest[..end]))
}
