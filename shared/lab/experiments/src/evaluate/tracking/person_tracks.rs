//! Tracks made of a person: output tracks whose box holds more of a person than of objects.

use evaluation::tracked_frame::TrackState;
use simulated_world::{ARM_ID, PERSON_ID, SimulatedKinect, World};

/// Tolerance around a track's box, metres. Part of the metric definition.
const MARGIN_M: f64 = 0.005;
/// Least number of pixels of a person in the box of a track made of it. Part of the metric
/// definition.
const PIXELS_MIN: u32 = 20;
/// Distance of the compared pixels, pixels.
const STRIDE_PX: usize = 2;

/// Ids of the output tracks made of a person in the last frame of a sensor.
pub(super) fn tracks_of_people(
    kinect: &SimulatedKinect,
    world: &World,
    tracks: &[TrackState],
) -> Vec<u64> {
    if !kinect.mask().contains(&PERSON_ID) {
        return Vec::new();
    }
    let outputs = tracks.iter().filter(|track| track.is_output);
    let of_people = outputs.filter(|track| {
        let [n_person, n_objects] = pixels_inside(kinect, world, track);
        n_person >= PIXELS_MIN / (STRIDE_PX * STRIDE_PX) as u32 && n_person > n_objects
    });
    of_people.map(|track| track.id).collect()
}

/// Number of compared pixels of people and of objects within the box of a track.
fn pixels_inside(kinect: &SimulatedKinect, world: &World, track: &TrackState) -> [u32; 2] {
    let (camera, world_from_camera) = (kinect.camera(), world.world_from_camera());
    let width = camera.width as usize;
    let depths_m = kinect.image().depth_m();
    let mut counts = [0; 2];
    for (pixel, &id) in kinect.mask().iter().enumerate() {
        let (column, row) = (pixel % width, pixel / width);
        let is_compared = column % STRIDE_PX == 0 && row % STRIDE_PX == 0;
        if !is_compared || id == 0 || id == ARM_ID {
            continue;
        }
        let depth_m = f64::from(depths_m[pixel]);
        let point = world_from_camera * camera.back_project(column as f64, row as f64, depth_m);
        if track.box_in_world.contains(&point, MARGIN_M) {
            counts[usize::from(id != PERSON_ID)] += 1;
        }
    }
    counts
}
