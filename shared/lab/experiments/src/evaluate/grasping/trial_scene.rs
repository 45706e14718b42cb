//! Scene of a trial: one object at rest on the table in a random pose, and one view of it.

use crate::frame_detector::{FrameDetector, up_in_camera};
use geometry::{PinholeCamera, RigidTransform};
use message::{SurfaceKind, TrackState};
use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use point_cloud::{OrganizedCloud, Point};
use random::Random;
use scene_client::{SceneSurface, Snapshot, SnapshotObject};
use service::Failure;
use simulated_world::{
    ArmMount, ModelChoice, ModelLibrary, ObjectPlacement, ObjectPlan, Scene, SimulatedKinect, World,
};

/// Camera of the trials.
pub(super) const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;
/// Half side of the square in the middle of the table above which objects are dropped, metres:
/// everything in it is in reach of the arm and in view.
const DROP_HALF_M: f64 = 0.08;
/// Height of the lowest point of a dropped object over the table, metres.
const DROP_HEIGHT_M: f64 = 0.02;

/// World with one object at rest.
pub(super) fn world(
    model: &ModelChoice,
    seed: u64,
    mut library: ModelLibrary,
) -> Result<World, Failure> {
    let loaded = library.load(model).map_err(Failure::general)?;
    let mut random = Random::from_seed(seed);
    let rotation = random_rotation(&mut random);
    let mut scene = Scene {
        seed,
        arm: Some(ArmMount::default()),
        ..Scene::default()
    };
    let radius_m = loaded.half_sides_m.norm();
    let place = Vector3::new(
        random.between(-DROP_HALF_M, DROP_HALF_M),
        random.between(-DROP_HALF_M, DROP_HALF_M),
        scene.table.height_m + radius_m + DROP_HEIGHT_M,
    );
    scene.objects = vec![ObjectPlan {
        model: model.clone(),
        placement: ObjectPlacement::Dropped {
            world_from_object: RigidTransform::from_parts(place.into(), rotation),
        },
    }];
    World::new(scene, library).map_err(Failure::general)
}

/// Uniform random rotation (Shoemake 1992).
fn random_rotation(random: &mut Random) -> UnitQuaternion<f64> {
    let [a, b, c] = [(); 3].map(|()| random.unit());
    let (turn, other) = (std::f64::consts::TAU * b, std::f64::consts::TAU * c);
    let (near, far) = ((1.0 - a).sqrt(), a.sqrt());
    UnitQuaternion::new_normalize(Quaternion::new(
        far * other.cos(),
        near * turn.sin(),
        near * turn.cos(),
        far * other.sin(),
    ))
}

/// View of a world: a snapshot whose objects are the candidates of detection.
pub(super) struct TrialView {
    pub(super) snapshot: Snapshot,
    /// Index of the object of the trial in the snapshot; `None` when it was not detected.
    pub(super) target: Option<usize>,
}

/// Looks at the world once, and finds the object in what detection found.
pub(super) fn look(world: &World, object: u16) -> Result<TrialView, Failure> {
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
    let mut objects = Vec::new();
    let mut shares = Vec::new();
    for (candidate, track) in detection.candidates.iter().zip(1..) {
        let pixels = detection.points_of(candidate);
        let is_target = |pixel: &&u32| kinect.mask()[**pixel as usize] == object;
        shares.push(pixels.iter().filter(is_target).count());
        objects.push(SnapshotObject {
            track,
            label: None,
            categories: Vec::new(),
            state: TrackState::Tracked,
            middle_in_world: pose * candidate.centroid,
            points: pixels
                .iter()
                .map(|&pixel| points[pixel as usize])
                .map(|point| [point.x, point.y, point.z])
                .collect(),
        });
    }
    let most = shares.iter().enumerate().max_by_key(|(_, share)| **share);
    let target = most
        .filter(|(_, share)| **share > 0)
        .map(|(index, _)| index);
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
    Ok(TrialView {
        target,
        snapshot: Snapshot {
            world_from_camera: Some(pose),
            up_in_camera: Some(up),
            surfaces,
            objects,
            ..Snapshot::of_points(CAMERA, points)
        },
    })
}
