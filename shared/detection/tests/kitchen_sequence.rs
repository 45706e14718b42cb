//! The table of a kitchen with a floor, walls, cupboards and chairs.

use dataset::rgbd_sequence::{RgbdSequence, Scratch};
use detection::{Config, Detection, Frame, Table, Workspace, detect};
use nalgebra::{Unit, Vector3};
use point_cloud::{OrganizedCloud, Point};
use std::path::PathBuf;

/// Every n-th frame is looked at.
const STEP: usize = 5;

fn sequence() -> RgbdSequence {
    let root = std::env::var("TABULA_DATA")
        .unwrap_or_else(|_| concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data").into());
    RgbdSequence::open(&PathBuf::from(root).join("kitchen-sequence")).unwrap()
}

/// Height of a table over the world's origin against gravity, where its normal
/// is within 12 degrees of up.
fn height_m(table: Option<&Table>, world_from_camera: &geometry::RigidTransform, up: &Vector3<f64>) -> Option<f64> {
    let plane = table?.plane.transformed(world_from_camera);
    let cosine = plane.normal.dot(up);
    (cosine > 12_f64.to_radians().cos()).then_some(-plane.offset_m / cosine)
}

#[test]
#[ignore = "needs TABULA_DATA"]
fn the_table_wins_over_walls_and_floor_with_and_without_gravity() {
    let sequence = sequence();
    let mut points = vec![Point::default(); sequence.camera().n_pixels()];
    let (mut workspace, mut detection) = (Workspace::default(), Detection::default());
    let mut scratch = Scratch::default();
    let up = -sequence.gravity_in_world().unwrap().into_inner();
    let mut heights = Vec::new();
    for index in (0..sequence.n_frames()).step_by(STEP) {
        let world_from_camera = sequence.fill(index, &mut scratch, &mut points).unwrap().unwrap();
        let cloud = OrganizedCloud::new(&points, 640, 480).unwrap();
        let up_in_camera = Unit::new_normalize(world_from_camera.rotation.inverse() * up);
        let mut found = [None, Some(up_in_camera)].map(|up_in_camera| {
            let frame = Frame { cloud, up_in_camera, seed: index as u64 };
            detect(&frame, &Config::default(), &mut workspace, &mut detection).unwrap();
            (detection.table.is_some(), height_m(detection.table.as_ref(), &world_from_camera, &up), detection.candidates.len())
        });
        println!("{index} {found:?}");
        heights.push(found);
    }
}
