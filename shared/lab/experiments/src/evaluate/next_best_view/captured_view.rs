//! Captured view of a scene: true visible areas, what detection found, and the plans from it.

use super::bin_scene::BinScene;
use super::scene_planner::{ScenePlanner, ViewPlans};
use super::segment_matching::{MatchedSegments, SegmentMatcher};
use super::simulated_bin::SimulatedBin;
use crate::frame_detector::up_in_camera;
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::{Unit, Vector3};
use next_best_view::{TotalArea, view_entropy};
use point_cloud::Point;
use service::Failure;
use simulated_world::{ObjectTruth, SimulatedKinect};

/// Camera of all simulated views.
pub(super) const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;
/// Base of the logarithm of all entropies: bit.
const LOG_BASE: f64 = 2.0;

/// View of a scene from one camera.
#[derive(Debug)]
pub(super) struct CapturedView {
    /// Entropy of the true visible areas over all visible area of the space, bit.
    pub(super) entropy: f64,
    /// The same over the area of the objects alone.
    pub(super) object_entropy: f64,
    /// Visible share of each object's unoccluded pixels.
    pub(super) visible_shares: Vec<f64>,
    /// Segments that detection found, matched with the objects.
    pub(super) segments: MatchedSegments,
    /// Plans from the view.
    pub(super) plans: ViewPlans,
    /// Colour image, three bytes a pixel; kept for pictures only.
    pub(super) colors: Vec<u8>,
}

/// Image of a view: measured points, and the truth about each pixel; row-major.
#[derive(Debug)]
pub(super) struct LabelledImage<'a> {
    pub(super) camera: PinholeCamera,
    pub(super) world_from_camera: RigidTransform,
    /// Direction against gravity in the camera, if it is known.
    pub(super) up_in_camera: Option<Unit<Vector3<f64>>>,
    /// Measured points, camera frame, metres.
    pub(super) points: &'a [Point],
    /// True depth, metres; not finite where nothing is.
    pub(super) depth_m: &'a [f32],
    /// Number of the object that each pixel shows, or none of the scene's.
    pub(super) mask: &'a [u16],
    /// Visible share of each object.
    pub(super) visible_shares: Vec<f64>,
}

impl CapturedView {
    /// View of an image, from which plans are made if there is a planner; the number selects the
    /// draws of detection.
    pub(super) fn new(
        scene: &BinScene,
        image: LabelledImage<'_>,
        number: usize,
        (matcher, planner): (&mut SegmentMatcher, Option<&ScenePlanner<'_>>),
    ) -> Result<Self, Failure> {
        let mut segments = matcher.find(scene, &image)?;
        let plans = planner.map(|planner| planner.plan(&image, &mut segments, number));
        let plans = plans.transpose()?.unwrap_or_default();
        let (areas_m2, background_m2) = true_areas(scene, &image);
        let entropy = |total| view_entropy(&areas_m2, background_m2, total, LOG_BASE);
        Ok(Self {
            entropy: entropy(TotalArea::Visible),
            object_entropy: entropy(TotalArea::Objects),
            segments,
            plans,
            colors: Vec::new(),
            visible_shares: image.visible_shares,
        })
    }

    /// Mean visible share of the objects.
    pub(super) fn visibility(&self) -> f64 {
        self.visible_shares.iter().sum::<f64>() / self.visible_shares.len().max(1) as f64
    }
}

/// Captures all views of a simulated scene, from which plans are made if there is a planner;
/// `keeps_colors` for pictures.
pub(super) fn capture_all(
    bin: &SimulatedBin,
    planner: Option<&ScenePlanner<'_>>,
    keeps_colors: bool,
) -> Result<Vec<CapturedView>, Failure> {
    let mut world = bin.world.clone();
    let mut kinect = SimulatedKinect::new(&world, CAMERA).map_err(Failure::general)?;
    let mut matcher = SegmentMatcher::default();
    let mut points = vec![Point::default(); CAMERA.n_pixels()];
    let mut views = Vec::new();
    for (number, mount) in bin.mounts.iter().enumerate() {
        world.set_camera(*mount);
        let truth = kinect.look(&world, number as u64, &mut points);
        let truth = truth.map_err(Failure::general)?;
        let world_from_camera = world.world_from_camera();
        let image = LabelledImage {
            camera: CAMERA,
            world_from_camera,
            up_in_camera: Some(up_in_camera(&world_from_camera, &Vector3::z_axis())),
            points: &points,
            depth_m: kinect.image().depth_m(),
            mask: kinect.mask(),
            visible_shares: visible_shares(&bin.scene, &truth),
        };
        let mut view = CapturedView::new(&bin.scene, image, number, (&mut matcher, planner))?;
        if keeps_colors {
            view.colors = points.iter().flat_map(|point| point.color.rgb()).collect();
        }
        views.push(view);
    }
    Ok(views)
}

/// Visible area of each object, and of all else in the space around them, square metres, by the true
/// depth.
fn true_areas(scene: &BinScene, image: &LabelledImage<'_>) -> (Vec<f64>, f64) {
    let camera = &image.camera;
    let mut areas_m2 = vec![0.0; scene.objects.len()];
    let mut background_m2 = 0.0;
    let width = camera.width as usize;
    let pixels = image.depth_m.iter().zip(image.mask);
    for (pixel, (depth_m, id)) in pixels.enumerate() {
        let z = f64::from(*depth_m);
        if !z.is_finite() {
            continue;
        }
        let place = camera.back_project((pixel % width) as f64, (pixel / width) as f64, z);
        if !scene.space.contains(&(image.world_from_camera * place)) {
            continue;
        }
        let area_m2 = z * z / (camera.fx_px * camera.fy_px);
        match scene.objects.iter().position(|object| object.id == *id) {
            Some(object) => areas_m2[object] += area_m2,
            None => background_m2 += area_m2,
        }
    }
    (areas_m2, background_m2)
}

fn visible_shares(scene: &BinScene, truth: &[ObjectTruth]) -> Vec<f64> {
    let share = |id: u16| {
        let object = truth.iter().find(|object| object.id == id);
        object.map_or(0.0, ObjectTruth::visible_fraction)
    };
    scene
        .objects
        .iter()
        .map(|object| share(object.id))
        .collect()
}
