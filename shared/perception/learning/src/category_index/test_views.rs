//! Synthetic views shared by the tests of the index.

use crate::test_noise::noise;
use crate::{CategoryName, ViewId};

/// Test name of a numbered category.
pub(super) fn name(number: u8) -> CategoryName {
    CategoryName::new(&format!("category {number}")).unwrap()
}

/// Id of a numbered view; three views for each track.
pub(super) fn id(number: usize) -> ViewId {
    ViewId {
        track_id: number as u64 / 3,
        view_id: number as u32 % 3,
    }
}

/// Clustered descriptor: a point near one of seven centres, so that few views are near a query.
pub(super) fn clustered(seed: u64, dimension: usize, spread: f32) -> Vec<f32> {
    let centre = noise(1000 + seed % 7);
    let values = centre.zip(noise(seed)).take(dimension);
    values.map(|(centre, own)| centre + spread * own).collect()
}
