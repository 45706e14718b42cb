//! Captured view of a scene: true visible areas, and the measured points with what detection found
//! in them.

use super::bin_scene::{BinScene, Workspace};
use super::known_objects::KnownObjects;
use super::segment_matching::{MatchedSegments, SegmentMatcher};
use super::simulated_bin::SimulatedBin;
use geometry::{PinholeCamera, RigidTransform};
use nalgebra::{Unit, Vector3};
use next_best_view::{SurfaceModel, TotalArea, view_entropy};
use point_cloud::Point;
use service::Failure;
use simulated_world::{ObjectTruth, SimulatedKinect};

/// Camera of all simulated views.
pub(super) const CAMERA: PinholeCamera = PinholeCamera::KINECT_V1;
/// Base of the logarithm of all entropies: bit.
pub(super) const LOG_BASE: f64 = 2.0;
/// Spacing of the measured points that are kept, metres. Chosen: closed by the splats of 3 mm.
pub(super) const MEASURED_SPACING_M: f64 = 0.005;
/// Stride over rows and columns of the rays that mark the occupancy. Chosen: neighbouring rays are
/// 6 mm apart, less than a voxel.
const RAY_STRIDE: usize = 4;

/// View of a scene from one camera.
#[derive(Debug)]
pub(super) struct CapturedView {
    pub(super) world_from_camera: RigidTransform,
    /// Entropy of the true visible areas over all visible area of the workspace, bit.
    pub(super) entropy: f64,
    /// The same over the area of the objects alone.
    pub(super) object_entropy: f64,
    /// Visible share of each object's unoccluded pixels.
    pub(super) visible_shares: Vec<f64>,
    /// Segments that detection found, matched with the objects.
    pub(super) segments: MatchedSegments,
    /// Measured points in the workspace, world frame, metres.
    pub(super) measured: Vec<[f32; 3]>,
    /// Thinned measured points in the camera frame, for occupancy.
    pub(super) rays: Vec<Point>,
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

impl LabelledImage<'_> {
    /// Measured points of every so many rows and columns.
    pub(super) fn strided_points(&self, stride: usize) -> impl Iterator<Item = &Point> {
        let rows = self.points.chunks(self.camera.width as usize);
        let strided = rows
            .step_by(stride)
            .flat_map(move |row| row.iter().step_by(stride));
        strided.filter(|point| point.is_finite())
    }
}

impl CapturedView {
    /// View of an image, in which known objects are identified; the number selects the draws of
    /// detection.
    pub(super) fn new(
        scene: &BinScene,
        image: LabelledImage<'_>,
        number: usize,
        (matcher, known): (&mut SegmentMatcher, Option<&KnownObjects>),
    ) -> Result<Self, Failure> {
        let mut segments = matcher.find(scene, &image, number)?;
        if let Some(known) = known {
            known.identify(scene, &image, &mut segments);
        }
        let (areas_m2, background_m2) = true_areas(scene, &image);
        let entropy = |total| view_entropy(&areas_m2, background_m2, total, LOG_BASE);
        Ok(Self {
            world_from_camera: image.world_from_camera,
            entropy: entropy(TotalArea::Visible),
            object_entropy: entropy(TotalArea::Objects),
            segments,
            measured: measured(&image, &scene.workspace)?,
            rays: image.strided_points(RAY_STRIDE).copied().collect(),
            colors: Vec::new(),
            visible_shares: image.visible_shares,
        })
    }

    /// Mean visible share of the objects.
    pub(super) fn visibility(&self) -> f64 {
        self.visible_shares.iter().sum::<f64>() / self.visible_shares.len().max(1) as f64
    }
}

/// Captures all views of a simulated scene, in which known objects are identified;
/// `keeps_colors` for pictures.
pub(super) fn capture_all(
    bin: &SimulatedBin,
    known: Option<&KnownObjects>,
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
            up_in_camera: Some(up_in_camera(&world_from_camera)),
            points: &points,
            depth_m: kinect.image().depth_m(),
            mask: kinect.mask(),
            visible_shares: visible_shares(&bin.scene, &truth),
        };
        let mut view = CapturedView::new(&bin.scene, image, number, (&mut matcher, known))?;
        if keeps_colors {
            view.colors = points.iter().flat_map(|point| point.color.rgb()).collect();
        }
        views.push(view);
    }
    Ok(views)
}

/// Direction against gravity in a camera.
pub(super) fn up_in_camera(world_from_camera: &RigidTransform) -> Unit<Vector3<f64>> {
    Unit::new_normalize(world_from_camera.rotation.inverse() * Vector3::z())
}

/// Visible area of each object, and of all else in the workspace, square metres, by the true
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
        if !scene.workspace.contains(&(image.world_from_camera * place)) {
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

/// Measured points in the workspace, world frame, thinned.
fn measured(image: &LabelledImage<'_>, workspace: &Workspace) -> Result<Vec<[f32; 3]>, Failure> {
    let finite = image.points.iter().filter(|point| point.is_finite());
    let in_world = finite.map(|point| image.world_from_camera * point.position());
    let inside: Vec<[f32; 3]> = in_world
        .filter(|place| workspace.contains(place))
        .map(|place| place.cast::<f32>().into())
        .collect();
    if inside.is_empty() {
        return Ok(inside);
    }
    let thinned = SurfaceModel::of_points(&inside, MEASURED_SPACING_M);
    Ok(thinned.map_err(Failure::general)?.points().to_vec())
}
