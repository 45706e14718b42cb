//! Fuzz target: arbitrary bytes as a DAE file.
#![no_main]

use dataset::dae;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mesh = match dae::read(bytes) {
        Ok(model) => model.mesh,
        Err(error) => return assert!(error.to_string().contains(' ')),
    };
    let n_vertices = mesh.vertices.len();
    assert!(mesh.vertices.iter().all(|vertex| vertex.x.is_finite()));
    let mut indices = mesh.triangles.as_flattened().iter();
    assert!(indices.all(|index| (*index as usize) < n_vertices));
});
