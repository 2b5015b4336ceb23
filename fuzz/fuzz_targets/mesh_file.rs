//! Mesh files: any bytes give a mesh or an error that names the file, and panels have corners that exist.
//!
//! The first byte picks the format. What is read is written and read back, checked, united, repaired
//! and refined without a panic.
#![no_main]

use froude_mesh::check::check;
use froude_mesh::crossing::crossings;
use froude_mesh::files::{read, vtk::vtp, write_obj, write_stl_binary};
use froude_mesh::parts::part_troubles;
use froude_mesh::plausible::{crosses, too_large};
use froude_mesh::refine::{rounded, without_warp};
use froude_mesh::repair::repaired;
use froude_mesh::solids::deck_trouble;
use froude_mesh::union::united;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some((first, bytes)) = bytes.split_first() else { return };
    let names = ["a.stl", "a.obj", "a.ply", "a.gdf", "a.dat", "a.msh", "a"];
    let name = names[usize::from(*first) % names.len()];
    match read(name, bytes) {
        Ok(file) => {
            let (vertices, panels) = (file.mesh.vertices.len(), file.mesh.panels.len());
            assert!(file.mesh.panels.iter().all(|p| p.corners().iter().all(|v| (*v as usize) < vertices)));
            assert!(24 * vertices + 16 * panels <= 24 * bytes.len());
            assert!(file.notes.iter().all(|note| !note.is_empty()));
            let again = read("a.obj", write_obj(&file.mesh).as_bytes()).expect("a written mesh is a mesh");
            assert_eq!(again.mesh.panels.len(), panels);
            read("a.stl", &write_stl_binary(&file.mesh)).expect("a written mesh is a mesh");
            let _ = (vtp(&file.mesh, &[]), too_large(&file.mesh), crosses(&file.mesh, 2, 0.0));
            let _ = (check(&file.mesh), crossings(&file.mesh), part_troubles(&file.mesh));
            if panels < 200 {
                let _ = (deck_trouble(&file.mesh), united(&file.mesh));
            }
            let (mesh, _) = repaired(&file.mesh, 1e-6);
            assert_eq!(rounded(&without_warp(&mesh, 0.1), 0.7).panels.len() % 4, 0);
        }
        Err(error) => assert!(error.to_string().starts_with(name), "{error}"),
    }
});
