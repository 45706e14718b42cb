//! Simulated turntable: single-object views for learning, segmented by the project's own
//! detection.
//!
//! As in the Washington RGB-D Object Dataset (Lai et al. 2011) the camera looks down at 30, 45
//! and 60 degrees, here from 0.7 to 1.3 m. All sensor errors are on. The distance, and unless a
//! lighting is given the colour and strength of the lamps, are drawn for every view.

use crate::frame_detector::{FrameDetector, up_in_camera};
use description::{LightColor, WhiteBalance};
use detection::Candidate;
use geometry::PinholeCamera;
use nalgebra::{Isometry3, Point3, Unit, Vector3};
use point_cloud::{OrganizedCloud, Point};
use random::Random;
use rendering::{Illuminant, Light, Lights};
use simulated_world::Error;
use simulated_world::ModelLibrary;
use simulated_world::SimulatedKinect;
use simulated_world::SimulatedObject;
use simulated_world::World;
use simulated_world::random_stream;
use simulated_world::{
    CameraMount, Lighting, ModelChoice, ObjectPlacement, ObjectPlan, Scene, TableFinish,
};

/// Sequence numbers of the Washington dataset with their camera elevations, degrees.
pub(crate) const ELEVATIONS: [(u32, f64); 3] = [(1, 30.0), (2, 45.0), (4, 60.0)];

/// Range of the camera's distance from the object, metres.
const DISTANCES_M: [f64; 2] = [0.7, 1.3];
/// Ranges of the lamps' colour temperature, kelvin, and relative strength.
const TEMPERATURES_K: [f64; 2] = [2700.0, 6500.0];
const INTENSITIES: [f64; 2] = [0.7, 1.3];
/// Maximum distance of the object's candidate from the turntable's centre, metres. Chosen:
/// farther candidates are not the object.
const CENTRE_DISTANCE_MAX_M: f64 = 0.12;
/// Random stream of camera distances and lamps.
const VIEW_STREAM: u64 = 5;

/// Room around the turntable.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct TurntableRoom {
    /// Lamps and walls; `None` for lamps that are drawn for every view.
    pub(crate) lighting: Option<Lighting>,
    /// Colour and pattern of the table.
    pub(crate) table_finish: TableFinish,
}

/// Simulated turntable: an object on the table, seen by a camera on a circle around it.
#[derive(Debug)]
pub(crate) struct Turntable {
    world: World,
    lighting: Option<Lighting>,
    kinect: SimulatedKinect,
    /// Seed of this object's camera distances and lamps.
    seed: u64,
    detector: FrameDetector,
    points: Vec<Point>,
}

/// View of the object as segmented by detection.
#[derive(Debug)]
pub(crate) struct SegmentedView<'a> {
    /// Points of the whole frame, camera frame, row-major.
    pub(crate) cloud: &'a [Point],
    /// Indices of the object's points in `cloud`, ascending.
    pub(crate) point_indices: &'a [u32],
    /// Direction against gravity, camera frame.
    pub(crate) up_in_camera: Unit<Vector3<f64>>,
    /// Pose of the camera in the world.
    pub(crate) world_from_camera: Isometry3<f64>,
    /// Intersection over union of segmented and true pixels, 0 to 1.
    pub(crate) overlap: f64,
}

impl SegmentedView<'_> {
    /// White balance that perception finds in the whole frame.
    pub(crate) fn white_balance(&self) -> WhiteBalance {
        LightColor::of_frame(self.cloud).unwrap_or_default().into()
    }
}

impl Turntable {
    /// Places an object upright on the table in front of a camera. Each object has its own
    /// series of camera distances and lamps.
    ///
    /// # Errors
    /// If the model cannot be used or the intrinsics are invalid.
    pub(crate) fn new(
        model: &ModelChoice,
        library: ModelLibrary,
        camera: PinholeCamera,
        room: TurntableRoom,
        (seed, object): (u64, u64),
    ) -> Result<Self, Error> {
        let plan = ObjectPlan {
            model: model.clone(),
            placement: ObjectPlacement::Upright {
                position_m: [0.0, 0.0],
                yaw_rad: 0.0,
                raised_m: 0.0,
            },
        };
        let scene = Scene {
            seed,
            objects: vec![plan],
            table_finish: room.table_finish,
            lighting: room.lighting.unwrap_or_default(),
            ..Scene::default()
        };
        let world = World::new(scene, library)?;
        Ok(Self {
            kinect: SimulatedKinect::new(&world, camera)?,
            world,
            lighting: room.lighting,
            seed: Random::substream(seed, object).next_u64(),
            detector: FrameDetector::default(),
            points: vec![Point::default(); camera.n_pixels()],
        })
    }

    /// Notes on the loaded model, one sentence each; each call returns only new ones.
    pub(crate) fn take_notes(&mut self) -> Vec<String> {
        self.world.take_notes()
    }

    /// Renders and segments one view. `height` is an index into [`ELEVATIONS`], `turn` the
    /// fraction of a full revolution. `None` when detection does not find the object.
    ///
    /// # Errors
    /// If the camera cannot render the scene.
    pub(crate) fn view(
        &mut self,
        height: usize,
        turn: f64,
    ) -> Result<Option<SegmentedView<'_>>, Error> {
        let (sequence, elevation_deg) = ELEVATIONS[height % ELEVATIONS.len()];
        let frame = (f64::from(sequence) * 1e6 + turn * 1e5) as u64;
        let mut random = random_stream(self.seed, VIEW_STREAM + 16 * frame);
        let mount = CameraMount {
            look_at_m: self.centre().coords.into(),
            distance_m: random.between(DISTANCES_M[0], DISTANCES_M[1]),
            elevation_deg,
            azimuth_deg: 360.0 * turn,
            orbit_deg_s: 0.0,
        };
        if self.lighting.is_none() {
            self.kinect.set_lights(random_lamps(&mut random));
        }
        self.view_from(mount, frame)
    }

    /// Renders and segments the view of a camera; `frame` selects its noise. `None` when detection
    /// does not find the object.
    ///
    /// # Errors
    /// If the camera cannot render the scene.
    pub(crate) fn view_from(
        &mut self,
        mount: CameraMount,
        frame: u64,
    ) -> Result<Option<SegmentedView<'_>>, Error> {
        self.world.set_camera(mount);
        self.kinect.look(&self.world, frame, &mut self.points)?;
        let world_from_camera = self.world.world_from_camera();
        let up_in_camera = up_in_camera(&world_from_camera, &Vector3::z_axis());
        self.detect(up_in_camera);
        let centre_in_camera = world_from_camera.inverse() * self.centre();
        let detection = self.detector.detection();
        let Some(found) = candidate_at_centre(&detection.candidates, &centre_in_camera) else {
            return Ok(None);
        };
        let point_indices = detection.points_of(found);
        Ok(Some(SegmentedView {
            cloud: &self.points,
            up_in_camera,
            world_from_camera,
            overlap: overlap(point_indices, self.kinect.mask(), &self.points),
            point_indices,
        }))
    }

    /// Object on the turntable.
    pub(crate) fn object(&self) -> Option<&SimulatedObject> {
        self.world.objects().first()
    }

    /// Centre of the object, world frame.
    pub(crate) fn centre(&self) -> Point3<f64> {
        self.object().map_or_else(
            || self.world.scene().table.middle(),
            |object| object.world_from_object.translation.vector.into(),
        )
    }

    fn detect(&mut self, up_in_camera: Unit<Vector3<f64>>) {
        let camera = self.kinect.camera();
        let size = (camera.width as usize, camera.height as usize);
        let Ok(cloud) = OrganizedCloud::new(&self.points, size.0, size.1) else {
            return;
        };
        self.detector.detect(cloud, Some(up_in_camera));
    }
}

fn random_lamps(random: &mut Random) -> Lights {
    let temperature_k = random.between(TEMPERATURES_K[0], TEMPERATURES_K[1]) as f32;
    let strength = random.between(INTENSITIES[0], INTENSITIES[1]) as f32;
    let lit = |given: Illuminant| Illuminant {
        temperature_k,
        intensity: given.intensity * strength,
    };
    let Lights { ambient, main, .. } = Lights::ROOM;
    Lights {
        ambient: lit(ambient),
        main: Light {
            illuminant: lit(main.illuminant),
            ..main
        },
        ..Lights::ROOM
    }
}

/// Detection candidate nearest to the turntable's centre.
fn candidate_at_centre<'a>(
    candidates: &'a [Candidate],
    centre: &Point3<f64>,
) -> Option<&'a Candidate> {
    let distance = |candidate: &Candidate| (candidate.oriented_box.centre() - centre).norm();
    candidates
        .iter()
        .filter(|candidate| {
            candidate.is_hypothesis() && distance(candidate) < CENTRE_DISTANCE_MAX_M
        })
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
}

/// Intersection over union with the true pixels that have depth.
fn overlap(found: &[u32], truth: &[u16], points: &[Point]) -> f64 {
    let is_object = |index: &usize| truth[*index] == 1 && points[*index].is_finite();
    let n_true = (0..truth.len()).filter(is_object).count();
    let n_common = found.iter().filter(|&&i| truth[i as usize] == 1).count();
    n_common as f64 / (n_true + found.len() - n_common).max(1) as f64
}
