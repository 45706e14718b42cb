//! View of a simulated world: a snapshot whose objects are what detection finds in one image.

use crate::frame_detector::{FrameDetector, up_in_camera};
use geometry::{Capsule, PinholeCamera};
use message::{SurfaceKind, TrackState};
use nalgebra::{Point3, Vector3};
use point_cloud::{OrganizedCloud, Point};
use scene_client::{SceneSurface, Snapshot, SnapshotObject};
use service::Failure;
use simulated_world::{SimulatedKinect, World};
use std::collections::BTreeMap;

/// Camera of the view.
pub(super) const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;

/// Distance below which places belong to a link of the robot, metres: the default of perception.
const ROBOT_MARGIN_M: f64 = 0.03;

/// View of a world, with the truth about what it shows.
pub(super) struct WorldView {
    pub(super) snapshot: Snapshot,
    /// Pixels of each object of the snapshot by the number of the object in the world.
    shown: Vec<BTreeMap<u16, usize>>,
}

impl WorldView {
    /// Looks at a world once.
    pub(super) fn of(world: &World) -> Result<Self, Failure> {
        let mut kinect = SimulatedKinect::new(world, CAMERA).map_err(Failure::general)?;
        let mut points = vec![Point::default(); CAMERA.n_pixels()];
        kinect
            .look(world, 0, &mut points)
            .map_err(Failure::general)?;
        let pose = world.world_from_camera();
        let up = up_in_camera(&pose, &Vector3::z_axis());
        let (width, height) = (CAMERA.width as usize, CAMERA.height as usize);
        let cloud = OrganizedCloud::new(&points, width, height).map_err(Failure::general)?;
        let mut detector = FrameDetector::default();
        let detection = detector.detect(cloud, Some(up));
        let (mut objects, mut shown) = (Vec::new(), Vec::new());
        let robot = world.arm_capsules();
        for (candidate, track) in detection.candidates.iter().zip(1..) {
            let pixels = detection.points_of(candidate);
            let places = pixels
                .iter()
                .map(|&pixel| pose * points[pixel as usize].position());
            if is_robot(&robot, places) {
                continue;
            }
            let mut counts = BTreeMap::new();
            for &pixel in pixels {
                *counts.entry(kinect.mask()[pixel as usize]).or_default() += 1;
            }
            shown.push(counts);
            let places = pixels.iter().map(|&pixel| points[pixel as usize]);
            objects.push(SnapshotObject {
                track,
                label: None,
                categories: Vec::new(),
                state: TrackState::Tracked,
                middle_in_world: pose * candidate.centroid,
                points: places.map(|point| [point.x, point.y, point.z]).collect(),
            });
        }
        let surfaces = detection.surfaces.iter().zip(0..);
        let surfaces = surfaces.map(|(surface, number)| SceneSurface {
            kind: if number == 0 {
                SurfaceKind::Table
            } else {
                SurfaceKind::Level
            },
            plane_in_world: surface.plane.transformed(&pose),
            corners_in_world: surface.corners(&pose).collect(),
        });
        let surfaces = surfaces.collect();
        Ok(Self {
            shown,
            snapshot: Snapshot {
                world_from_camera: Some(pose),
                up_in_camera: Some(up),
                surfaces,
                objects,
                ..Snapshot::of_points(CAMERA, points)
            },
        })
    }

    /// Index of the object of the snapshot that shows most of an object of the world; `None` when
    /// detection did not find it.
    pub(super) fn index_of(&self, object: u16) -> Option<usize> {
        let n_shown = |index: &usize| self.shown[*index].get(&object).copied().unwrap_or(0);
        let most = (0..self.shown.len()).max_by_key(n_shown);
        most.filter(|index| n_shown(index) > 0)
    }
}

/// True for a candidate most of whose places belong to the robot, as by the rule of perception.
fn is_robot(robot: &[Capsule], places: impl ExactSizeIterator<Item = Point3<f64>>) -> bool {
    let n = places.len();
    let is_near = |place: &Point3<f64>| {
        let mut links = robot.iter();
        links.any(|link| link.distance_m(place) < ROBOT_MARGIN_M)
    };
    2 * places.filter(is_near).count() > n
}
