//! Collada files: any bytes give a mesh or an error that names the file, and panels have corners that exist.
//!
//! The solids of what is read are united, where they are few, without a panic.
#![no_main]

use froude_mesh::files::{read, write_obj};
use froude_mesh::repair::{merged, repaired};
use froude_mesh::solids::deck_trouble;
use froude_mesh::union::united;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| match read("a.dae", bytes) {
    Ok(file) => {
        let vertices = file.mesh.vertices.len();
        assert!(file.mesh.panels.iter().all(|p| p.corners().iter().all(|v| (*v as usize) < vertices)));
        assert!(file.unit_m.is_some_and(|m| m > 0.0));
        let again = read("a.obj", write_obj(&file.mesh).as_bytes()).expect("a written mesh is a mesh");
        assert_eq!(again.mesh.panels.len(), file.mesh.panels.len());
        if file.mesh.panels.len() < 200 {
            let (mesh, _) = merged(file.mesh);
            let _ = (deck_trouble(&mesh), united(&mesh), repaired(&mesh, 1e-6));
        }
    }
    Err(error) => assert!(error.to_string().starts_with("a.dae"), "{error}"),
});
