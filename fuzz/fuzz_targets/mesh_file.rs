//! Mesh files: any bytes give a mesh or an error that names the file, and panels have corners that exist.
//!
//! The first byte picks the format. What is read is written and read back, checked and repaired without a panic.
#![no_main]

use froude_mesh::files::{read, vtk::vtp, write_obj, write_stl_binary};
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
            let _ = vtp(&file.mesh, &[]);
        }
        Err(error) => assert!(error.to_string().starts_with(name), "{error}"),
    }
});
