//! Fuzz target: arbitrary bytes as a file or name of a Washington view; the first byte selects
//! the parser.
#![no_main]

use dataset::ContentError;
use dataset::washington::{
    CAMERA, CroppedView, ViewName, decode_color, decode_depth, decode_mask, format_location,
    parse_location, read_cloud, write_cloud,
};
use libfuzzer_sys::fuzz_target;

/// Size of the seeds' depth images and masks.
const SIZE: (u32, u32) = (16, 8);

fuzz_target!(|bytes: &[u8]| {
    let Some((kind, file)) = bytes.split_first() else {
        return;
    };
    let result = match kind % 6 {
        0 => color(file),
        1 => decode_depth(file, SIZE, &mut Vec::new()),
        2 => mask(file),
        3 => parse_location(file).map(|location| {
            let text = format_location(location);
            assert_eq!(
                parse_location(text.as_bytes()).expect("written location can be parsed"),
                location
            );
        }),
        4 => read_cloud(file).map_err(ContentError::from).map(|_| ()),
        _ => {
            name(file);
            Ok(())
        }
    };
    if let Err(error) = result {
        assert!(error.to_string().contains(' '));
    }
});

/// Decodes a colour image; round-trips a view of it with constant depth through PCD.
fn color(file: &[u8]) -> Result<(), ContentError> {
    let mut view = CroppedView::default();
    view.size = decode_color(file, &mut view.color)?;
    let n_pixels = view.size.0 as usize * view.size.1 as usize;
    assert_eq!(view.color.len(), 3 * n_pixels);
    view.depth_mm = vec![1000; n_pixels];
    view.mask = vec![1; n_pixels];
    let cloud = write_cloud(&view, &CAMERA).expect("parsed content can be written");
    let points = read_cloud(&cloud).expect("written content can be parsed");
    assert_eq!(points, view.points(&CAMERA).expect("a valid view"));
    Ok(())
}

/// Decodes a mask of the seeds' size.
fn mask(file: &[u8]) -> Result<(), ContentError> {
    let mut mask = Vec::new();
    decode_mask(file, SIZE, &mut mask)?;
    assert_eq!(mask.len(), 16 * 8);
    Ok(())
}

/// Parses a file name of a view and round-trips it.
fn name(file: &[u8]) {
    let text = String::from_utf8_lossy(file);
    if let Some(name) = ViewName::parse(&text) {
        assert_eq!(name.to_string(), text);
        assert!(!name.category().contains(['/', '.']));
    }
}
