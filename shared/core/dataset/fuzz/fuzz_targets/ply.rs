//! Fuzz target: arbitrary bytes as a PLY file, with a round trip of valid content.
#![no_main]

use dataset::ply::{self, Encoding};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let mesh = match ply::read(bytes) {
        Ok(mesh) => mesh,
        Err(error) => return assert!(error.to_string().contains(' ')),
    };
    for encoding in [
        Encoding::Ascii,
        Encoding::BinaryLittleEndian,
        Encoding::BinaryBigEndian,
    ] {
        let file = ply::write(mesh.view(), encoding).expect("parsed content can be written");
        assert_eq!(
            ply::read(&file).expect("written content can be parsed"),
            mesh
        );
    }
});
