//! Fuzz target: arbitrary bytes as an OBJ file and, after the first NUL, its materials.
#![no_main]

use dataset::obj::{self, Materials};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mut parts = bytes.splitn(2, |byte| *byte == 0);
    let (model, library) = (parts.next().unwrap_or_default(), parts.next());
    let mut materials = Materials::default();
    if let Err(error) = materials.read(library.unwrap_or_default()) {
        assert!(error.to_string().contains(' '));
    }
    match obj::material_libraries(model) {
        Ok(names) => assert!(names.iter().all(|name| !name.is_empty())),
        Err(error) => assert!(error.to_string().contains(' ')),
    }
    let mesh = match obj::read(model, &materials) {
        Ok(mesh) => mesh,
        Err(error) => return assert!(error.to_string().contains(' ')),
    };
    let n_vertices = mesh.vertices.len();
    assert!(n_vertices > 0 && mesh.vertices.iter().all(|vertex| vertex.x.is_finite()));
    let mut indices = mesh.triangles.as_flattened().iter();
    assert!(indices.all(|index| (*index as usize) < n_vertices));
});
