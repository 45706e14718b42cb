//! Fuzz target: arbitrary bytes as a PCD file, with a round trip of valid content.
#![no_main]

use dataset::pcd::{self, Encoding};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let cloud = match pcd::read(bytes) {
        Ok(cloud) => cloud,
        Err(error) => return assert!(error.to_string().contains(' ')),
    };
    assert_eq!(cloud.points.len(), cloud.width * cloud.height);
    for encoding in [
        Encoding::Ascii,
        Encoding::Binary,
        Encoding::BinaryCompressed,
    ] {
        let file = pcd::write(cloud.view(), encoding).expect("parsed content can be written");
        let again = pcd::read(&file).expect("written content can be parsed");
        assert_eq!(again.labels, cloud.labels);
        for (left, right) in again.points.iter().zip(&cloud.points) {
            assert_eq!(left.is_finite(), right.is_finite());
            assert_eq!(left.color, right.color);
            assert!(!left.is_finite() || left == right);
        }
    }
});
