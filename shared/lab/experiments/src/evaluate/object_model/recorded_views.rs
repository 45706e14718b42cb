//! Views of the objects of a recorded sequence with camera poses.

use super::orbit::{Orbit, OrbitView, Path};
use crate::frame_detector::{FrameDetector, up_in_camera};
use command_line::{Output, progress_bar};
use dataset::rgbd_sequence::{RgbdSequence, Scratch};
use detection::{Candidate, Detection};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use point_cloud::{OrganizedCloud, Point};
use service::Failure;

/// Every so many frames are looked at: six a second.
const FRAME_STEP: usize = 5;
const FRAME_NS: u64 = 33_333_333;

/// Distance within which candidates of different frames are one object, metres. Chosen: the scene
/// stands still, and a candidate's centre moves with the side that is seen.
const SAME_M: f64 = 0.04;

/// Minimum number of views of an object, and of the angle between two of its views, degrees.
const N_VIEWS_MIN: usize = 12;
const ANGLE_MIN_DEG: f64 = 20.0;

/// Object of a sequence.
struct RecordedObject {
    /// Centres of its candidates, world frame: their sum.
    sum: Point3<f64>,
    views: Vec<OrbitView>,
}

impl RecordedObject {
    fn centre(&self) -> Point3<f64> {
        self.sum / self.views.len() as f64
    }

    /// Greatest angle between the directions from which it was seen, degrees.
    fn angle_deg(&self) -> f64 {
        let centre = self.centre();
        let direction =
            |view: &OrbitView| view.world_from_camera.translation.vector - centre.coords;
        let directions: Vec<_> = self.views.iter().map(direction).collect();
        let angles = directions
            .iter()
            .flat_map(|a| directions.iter().map(|b| a.angle(b)));
        angles.fold(0.0, f64::max).to_degrees()
    }
}

/// Orbits around the objects of a sequence that were seen often and from different sides, largest
/// angle first, at most a number.
pub(super) fn read(
    folder: &std::path::Path,
    n_objects: usize,
    output: &Output,
) -> Result<Vec<Orbit>, Failure> {
    let sequence = RgbdSequence::open(folder).map_err(Failure::usage)?;
    let camera = *sequence.camera();
    let mut points = vec![Point::default(); camera.n_pixels()];
    let (mut scratch, mut detector) = (Scratch::default(), FrameDetector::default());
    let mut objects: Vec<RecordedObject> = Vec::new();
    let bar = progress_bar(sequence.n_frames() as u64, "frames", output);
    for index in (0..sequence.n_frames()).step_by(FRAME_STEP) {
        bar.inc(FRAME_STEP as u64);
        let pose = sequence
            .fill(index, &mut scratch, &mut points)
            .map_err(Failure::general)?;
        let Some(world_from_camera) = pose else {
            continue;
        };
        let gravity = sequence.gravity_in_world();
        let up = gravity.map(|down| up_in_camera(&world_from_camera, &-down));
        let cloud = OrganizedCloud::new(&points, camera.width as usize, camera.height as usize)
            .map_err(Failure::general)?;
        let detection = detector.detect(cloud, up);
        for (points, centre) in whole_objects(detection, &points) {
            let view = OrbitView {
                points,
                world_from_camera,
                captured_ns: index as u64 * FRAME_NS,
            };
            add(&mut objects, world_from_camera * centre, view);
        }
    }
    bar.finish_and_clear();
    objects
        .retain(|object| object.views.len() >= N_VIEWS_MIN && object.angle_deg() >= ANGLE_MIN_DEG);
    objects.sort_by(|a, b| b.angle_deg().total_cmp(&a.angle_deg()));
    let up = sequence
        .gravity_in_world()
        .map_or_else(Vector3::z, |down| -down.into_inner());
    let upright = UnitQuaternion::rotation_between(&Vector3::z(), &up).unwrap_or_default();
    let orbit = |object: RecordedObject| Orbit {
        path: Path::Recorded,
        view_step: 1,
        turn_rad: None,
        camera,
        cameras: object
            .views
            .iter()
            .map(|view| view.world_from_camera)
            .collect(),
        // Upright, with the origin in the object.
        world_from_object: Isometry3::from_parts(object.centre().coords.into(), upright),
        views: object.views,
    };
    Ok(objects.into_iter().take(n_objects).map(orbit).collect())
}

/// Adds a view to the object at its place.
fn add(objects: &mut Vec<RecordedObject>, centre: Point3<f64>, view: OrbitView) {
    let distance = |object: &RecordedObject| (object.centre() - centre).norm();
    let nearest = objects
        .iter_mut()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)));
    match nearest {
        Some(object) if distance(object) < SAME_M => {
            object.sum += centre.coords;
            object.views.push(view);
        }
        _ => objects.push(RecordedObject {
            sum: centre,
            views: vec![view],
        }),
    }
}

/// Points and centres of the objects of a frame that are seen whole, camera frame.
fn whole_objects(detection: &Detection, points: &[Point]) -> Vec<(Vec<Point>, Point3<f64>)> {
    let is_whole =
        |candidate: &&Candidate| candidate.is_hypothesis() && !candidate.touches_image_border;
    let points = |candidate: &Candidate| -> Vec<Point> {
        let indices = detection.points_of(candidate).iter();
        indices.map(|&index| points[index as usize]).collect()
    };
    let candidates = detection.candidates.iter().filter(is_whole);
    candidates
        .map(|c| (points(c), c.oriented_box.centre()))
        .collect()
}
