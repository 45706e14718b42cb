//! Fuzz target: arbitrary bytes as a file of an RGB-D sequence or of registered images; the first byte selects the
//! parser.
#![no_main]

use dataset::ContentError;
use dataset::registered_images::parse_intrinsics_json;
use dataset::rgbd_sequence::{
    decode_color, decode_depth, decode_mask, depth_image_size, parse_gravity, parse_intrinsics,
    parse_pose,
};
use libfuzzer_sys::fuzz_target;

/// Size of the seeds' colour images.
const COLOR_SIZE: (u32, u32) = (16, 8);

fuzz_target!(|bytes: &[u8]| {
    let Some((kind, file)) = bytes.split_first() else {
        return;
    };
    let result = match kind % 7 {
        6 => return intrinsics_json(file),
        0 => depth(file),
        1 => decode_color(file, COLOR_SIZE).map(|color| assert_eq!(color.len(), 3 * 16 * 8)),
        2 => parse_pose(file).map(|pose| assert!(pose.rotation.coords.norm() > 0.99)),
        3 => parse_intrinsics(file, COLOR_SIZE).map(|camera| assert!(camera.fx_px > 0.0)),
        4 => parse_gravity(file).map(|down| assert!((down.norm() - 1.0).abs() < 1e-9)),
        _ => mask(file),
    };
    if let Err(error) = result {
        assert!(error.to_string().contains(' '));
    }
});

/// Parses intrinsics in JSON.
fn intrinsics_json(file: &[u8]) {
    match parse_intrinsics_json(file, COLOR_SIZE) {
        Ok(read) => assert!(read.camera.fx_px > 0.0 && read.depth_unit_mm > 0.0),
        Err(error) => assert!(error.to_string().contains(' ')),
    }
}

/// Decodes a depth image of any size.
fn depth(file: &[u8]) -> Result<(), ContentError> {
    let size = depth_image_size(file)?;
    let mut depth_mm = Vec::new();
    decode_depth(file, size, &mut depth_mm)?;
    assert_eq!(depth_mm.len(), size.0 as usize * size.1 as usize);
    Ok(())
}

/// Decodes a mask of the seeds' size.
fn mask(file: &[u8]) -> Result<(), ContentError> {
    let mut instances = Vec::new();
    decode_mask(file, COLOR_SIZE, &mut instances)?;
    assert_eq!(instances.len(), 16 * 8);
    Ok(())
}
