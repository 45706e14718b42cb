//! Tracking of simulated scenarios.

use super::RATE_HZ;
use super::ground_truth::{GroundTruth, LabelledDepthImage};
use super::person_tracks::tracks_of_people;
use super::scenario::Scenario;
use super::track_pixels::track_pixels;
use super::tracking_pipeline::TrackingPipeline;
use super::tracking_run::TrackedSequence;
use crate::frame_detector::up_in_camera;
use evaluation::tracked_frame::TrackedFrame;
use geometry::{Capsule, PinholeCamera};
use nalgebra::Vector3;
use pipeline::{FramePose, SequentialFrame};
use point_cloud::{OrganizedCloud, Point};
use service::Failure;
use simulated_world::{SimulatedKinect, World};
use std::collections::BTreeMap;

/// Default duration of a scene, seconds. Chosen.
const DURATION_S: f64 = 10.0;
/// Capture time of the first frame, nanoseconds; not zero, as with a real camera.
const FIRST_CAPTURE_NS: u64 = 1_000_000_000;

/// Simulates a scenario with a seed and tracks its objects. With `hidden_people` the poses of
/// people are not told.
pub(super) fn play(
    scenario: &Scenario,
    seed: u64,
    hidden_people: bool,
) -> Result<TrackedSequence, Failure> {
    let (scene, library) = scenario.scene(seed)?;
    let duration_s = scene.duration_s.unwrap_or(DURATION_S);
    let mut world = World::new(scene, library).map_err(Failure::general)?;
    let camera = PinholeCamera::KINECT_V1;
    let mut kinect = SimulatedKinect::new(&world, camera).map_err(Failure::general)?;
    let mut points = vec![Point::default(); camera.n_pixels()];
    let mut truth = GroundTruth::new(camera);
    let mut tracker = TrackingPipeline::new().map_err(Failure::general)?;
    let mut sequence = TrackedSequence {
        frames: Vec::new(),
        names: BTreeMap::new(),
        notes: world.take_notes(),
    };
    for number in 0..(duration_s * RATE_HZ) as u64 {
        while world.time_s() * RATE_HZ + 1e-6 < number as f64 {
            world.step();
        }
        let objects = kinect
            .look(&world, number, &mut points)
            .map_err(Failure::general)?;
        for object in world.objects() {
            truth.know(object.id, &object.model);
            let name = sequence.names.entry(u64::from(object.id));
            name.or_insert_with(|| object.model.name.clone());
        }
        let objects = truth.of_frame(&exact_view(&kinect, &world), &objects);
        let capture_ns = FIRST_CAPTURE_NS + (world.time_s() * 1e9).round() as u64;
        track(&mut tracker, &world, capture_ns, &points, hidden_people)?;
        let tracks = tracker.track_states();
        sequence.frames.push(TrackedFrame {
            time_s: world.time_s(),
            objects,
            pixels: track_pixels(&tracker, kinect.mask()),
            tracks_of_people: tracks_of_people(&kinect, &world, &tracks),
            tracks,
            ended: tracker.update().ended_tracks.clone(),
        });
        sequence.notes.append(&mut world.take_notes());
    }
    Ok(sequence)
}

/// Exact depth image, without sensor errors, with the object mask.
fn exact_view<'a>(kinect: &'a SimulatedKinect, world: &World) -> LabelledDepthImage<'a> {
    LabelledDepthImage {
        depth_m: kinect.image().depth_m(),
        is_exact: true,
        mask: kinect.mask(),
        world_from_camera: world.world_from_camera(),
        up_in_world: Vector3::z_axis(),
    }
}

/// Tracks the objects of a frame of a world, given by its capture time, nanoseconds.
/// With `hidden_people` the poses of people are not told.
pub(in super::super) fn track(
    tracker: &mut TrackingPipeline,
    world: &World,
    capture_ns: u64,
    points: &[Point],
    hidden_people: bool,
) -> Result<(), Failure> {
    let camera = PinholeCamera::KINECT_V1;
    let (width, height) = (camera.width as usize, camera.height as usize);
    let world_from_camera = world.world_from_camera();
    let camera_from_world = world_from_camera.inverse();
    let in_camera = |capsules: Vec<Capsule>| -> Vec<Capsule> {
        let in_camera = |capsule: &Capsule| capsule.transformed(&camera_from_world);
        capsules.iter().map(in_camera).collect()
    };
    let people = in_camera(world.person_capsules());
    let arm = in_camera(world.arm_capsules());
    let frame = SequentialFrame {
        pose: FramePose {
            capture_ns,
            world_from_camera,
            up_in_camera: Some(up_in_camera(&world_from_camera, &Vector3::z_axis())),
            camera: Some(camera),
        },
        cloud: OrganizedCloud::new(points, width, height).map_err(Failure::general)?,
        people: (!hidden_people).then_some(&people[..]),
        robot: (!arm.is_empty()).then_some(&arm[..]),
    };
    tracker.step(&frame).map_err(Failure::general)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluate::tracking::scenario::built_in;

    #[test]
    fn every_scenario_shows_at_least_six_scored_objects_at_first() {
        let camera = PinholeCamera::KINECT_V1;
        let mut points = vec![Point::default(); camera.n_pixels()];
        for (scenario, seed) in built_in().iter().flat_map(|s| [(s, 2), (s, 13)]) {
            let (scene, library) = scenario.scene(seed).unwrap();
            let world = World::new(scene, library).unwrap();
            let mut kinect = SimulatedKinect::new(&world, camera).unwrap();
            let objects = kinect.look(&world, 0, &mut points).unwrap();
            let mut truth = GroundTruth::new(camera);
            for object in world.objects() {
                truth.know(object.id, &object.model);
            }
            let objects = truth.of_frame(&exact_view(&kinect, &world), &objects);
            let n_counted = objects.iter().filter(|object| object.counts).count();
            assert!(
                n_counted >= 6,
                "{n_counted} in {} from {seed}",
                scenario.name
            );
            // The seen part of an object lies within its whole box.
            for object in &objects {
                let seen_m3 = object.seen_box.map_or(0.0, |seen_box| seen_box.volume_m3());
                let whole_m3 = object.whole_box.volume_m3();
                assert!(seen_m3 < 1.02 * whole_m3, "{seen_m3} of {whole_m3} m³");
            }
        }
    }
}
