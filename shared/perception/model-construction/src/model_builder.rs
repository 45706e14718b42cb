//! Construction of an object model from views, one after the other.

use crate::Error;
use crate::depth_view::DepthView;
use crate::error::Misfit;
use crate::frame_error::FrameError;
use crate::loop_closure::{close_loop, is_orbit_closed};
use crate::pose_filter::{PoseFilter, PoseSigma};
use crate::surface_points::SurfacePoint;
use crate::tsdf_volume::TsdfVolume;
use geometry::PinholeCamera;
use mesh::TriangleMesh;
use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use point_cloud::Point;
use registration::{Prior, Registration, ViewOrigin, ViewSurface, register};

/// Weight of the surface to which a view is registered. Chosen: one pixel at 45° and 1.8 m.
const TARGET_WEIGHT_MIN: f32 = 0.1;

/// Weight of a colour of the model that takes part in a registration. Chosen: a view from 1.2 m
/// that is not at a border.
const COLOR_WEIGHT_MIN: f32 = 0.1;

/// Weight of the surface of the mesh, as a share of the number of views, and its limits. Chosen:
/// what only one of many views saw is noise.
const MESH_WEIGHT_SHARE: f32 = 0.02;
const MESH_WEIGHT: std::ops::RangeInclusive<f32> = 0.1..=3.0;

/// Cosine of the greatest angle at which the model's surface takes part in a registration, 80°.
const FACING_COSINE_MIN: f32 = 0.17;

/// Standard deviation of the difference between the middle of a view and that of the part of the
/// model that its camera should see, metres. Chosen: a view shows what the model does not have
/// yet, and the reverse.
const MIDDLE_SIGMA_M: f64 = 0.012;

/// Number of views that may be bad, and of the views in a row that then do not fit. Chosen.
const N_BEGINNING_VIEWS: usize = 3;
const N_REFUSED_MAX: u32 = 4;

/// Uncertainty of a pose that is not reported: so large that it tells nothing.
const UNKNOWN_SIGMA: PoseSigma = PoseSigma {
    rotation_rad: 10.0,
    translation_m: 10.0,
};

/// Configuration of model construction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Config {
    /// Side length of the voxels, metres. Chosen: 2 mm, of the order of a Kinect's noise.
    pub voxel_m: f32,
    /// Share of the view's surface that must lie within 4 mm of the model, 0 to 1.
    pub common_share_min: f64,
    /// Contradiction of model and view from which a view is refused, 0 to 2.
    pub contradiction_max: f64,
    /// Distance from the expected pose from which a view is refused, in standard deviations.
    pub off_sigmas_max: f64,
    /// Angle between viewing directions below which a view is registered only, and not fused,
    /// radians.
    pub step_min_rad: f64,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            voxel_m: 0.002,
            common_share_min: 0.35,
            contradiction_max: 1.0,
            off_sigmas_max: 4.0,
            step_min_rad: 0.0,
        }
    }
}

/// View of an object.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// Segmented points of the object in the frame of the camera.
    pub points: &'a [Point],
    /// Intrinsics of the camera.
    pub camera: PinholeCamera,
    /// Capture time, nanoseconds.
    pub captured_ns: u64,
    /// Pose of the camera that the robot reports; `None` when it is not known, as for a camera that
    /// is held in the hand.
    pub world_from_camera: Option<Isometry3<f64>>,
    /// Uncertainty of the reported pose.
    pub sigma: PoseSigma,
}

/// Accepted view of a model.
#[derive(Debug)]
pub struct BuiltView {
    pub(crate) depth: DepthView,
    /// Capture time, nanoseconds.
    pub captured_ns: u64,
    /// Pose of the camera in the frame of the object.
    pub object_from_camera: Isometry3<f64>,
    /// Pose that the robot reported, in the frame of the object; the expected one when it is not
    /// known.
    pub reported: Isometry3<f64>,
    /// Pose that was expected before the registration: the reported one, filtered.
    pub expected: Isometry3<f64>,
    pub(crate) sigma: PoseSigma,
}

impl BuiltView {
    /// Unit vector from the centre of the object's frame to the camera.
    pub fn direction(&self) -> Vector3<f64> {
        let camera = self.object_from_camera.translation.vector;
        camera.try_normalize(0.0).unwrap_or_else(Vector3::z)
    }
}

/// Expected pose of a view, and the surface that it should show.
#[derive(Debug)]
struct Expectation {
    target: ViewSurface,
    prior: Prior,
    reported: Isometry3<f64>,
    sigma: PoseSigma,
}

/// Object model under construction.
///
/// The frame of the object has the axes of the world, and its origin in the centre of the first
/// view. Without a camera pose the first view counts as that of a level camera.
#[derive(Debug)]
pub struct ModelBuilder {
    config: Config,
    volume: TsdfVolume,
    views: Vec<BuiltView>,
    filter: Option<(PoseFilter, Translation3<f64>)>,
    frame_error: FrameError,
    /// Number of refused views since the last accepted one.
    n_refused: u32,
    is_closed: bool,
}

impl ModelBuilder {
    /// Model without views.
    pub fn new(config: Config) -> Self {
        Self {
            volume: TsdfVolume::new(config.voxel_m),
            config,
            views: Vec::new(),
            filter: None,
            frame_error: FrameError::default(),
            n_refused: 0,
            is_closed: false,
        }
    }

    /// Accepted views.
    pub fn views(&self) -> &[BuiltView] {
        &self.views
    }

    /// `true` once the views lead around the object, and the loop was closed.
    pub fn is_closed(&self) -> bool {
        self.is_closed
    }

    /// Registers a view with the model and fuses it; the first one makes the frame of the object.
    /// Returns the registration, `None` for the first view. Where several views in a row do not
    /// fit to the few before them, those were bad, and the model begins anew with this view.
    ///
    /// *Cost*: milliseconds to tens of milliseconds for a view of 10 000 points; some seconds when
    /// the loop closes.
    ///
    /// # Errors
    /// When the view cannot be used, or does not fit.
    pub fn add(&mut self, view: &View<'_>) -> Result<Option<Registration>, Error> {
        if view.world_from_camera.is_some_and(|pose| !is_finite(&pose)) {
            return Err(Error::PoseNotFinite);
        }
        let depth = DepthView::new(view.points, view.camera)?;
        let Some((filter, object_from_world)) = self.filter.clone() else {
            self.begin(view, depth);
            return Ok(None);
        };
        let found = self.expect(filter, &object_from_world, view, &depth);
        let found = found.and_then(|(filter, expectation)| {
            let registration = self.register(&expectation, &depth)?;
            Ok((filter, expectation, registration))
        });
        let (filter, expectation, registration) = match found {
            Ok(found) => found,
            Err(_) if self.is_bad_beginning() => {
                *self = Self::new(self.config);
                self.begin(view, depth);
                return Ok(None);
            }
            Err(error) => {
                self.n_refused += 1;
                return Err(error);
            }
        };
        self.n_refused = 0;
        let built = BuiltView {
            captured_ns: view.captured_ns,
            object_from_camera: registration.target_from_source,
            reported: expectation.reported,
            expected: expectation.prior.target_from_source,
            sigma: expectation.sigma,
            depth,
        };
        self.accept(built, filter, object_from_world);
        Ok(Some(registration))
    }

    /// `true` if so many views in a row did not fit that the few accepted ones must be bad.
    fn is_bad_beginning(&self) -> bool {
        self.views.len() <= N_BEGINNING_VIEWS && self.n_refused >= N_REFUSED_MAX
    }

    /// Begins the model with its first view.
    fn begin(&mut self, view: &View<'_>, depth: DepthView) {
        let world_from_camera = view.world_from_camera.unwrap_or_else(level_camera);
        let centre = world_from_camera * depth.surface.centroid();
        let object_from_world = Translation3::from(-centre.coords);
        let object_from_camera = object_from_world * world_from_camera;
        let filter = PoseFilter::new(object_from_camera, &view.sigma, view.captured_ns);
        self.filter = Some((filter, object_from_world));
        self.fuse(BuiltView {
            depth,
            captured_ns: view.captured_ns,
            object_from_camera,
            reported: object_from_camera,
            expected: object_from_camera,
            sigma: view.sigma,
        });
    }

    /// Fuses a view with its pose into the model.
    fn fuse(&mut self, view: BuiltView) {
        self.frame_error
            .add(&view.object_from_camera, &view.reported);
        self.volume.fuse(&view.depth, &view.object_from_camera);
        self.views.push(view);
    }

    /// Expected pose of a view: the motion so far, the reported pose, and the place at which the
    /// camera sees the object. With the filter after them.
    fn expect(
        &self,
        mut filter: PoseFilter,
        object_from_world: &Translation3<f64>,
        view: &View<'_>,
        depth: &DepthView,
    ) -> Result<(PoseFilter, Expectation), Error> {
        filter.predict(view.captured_ns);
        let reported = view.world_from_camera.map(|pose| object_from_world * pose);
        if let Some(reported) = &reported {
            let (corrected, sigma) = self.frame_error.corrected(reported, &view.sigma);
            filter.observe(&corrected, &sigma);
        }
        let centre = depth.surface.centroid();
        let target = self.target(&filter.camera_place())?;
        filter.see(&centre, &target.centroid(), MIDDLE_SIGMA_M);
        let prior = filter.prior(&centre);
        let expectation = Expectation {
            target,
            prior,
            reported: reported.unwrap_or(prior.target_from_source),
            sigma: reported.map_or(UNKNOWN_SIGMA, |_| view.sigma),
        };
        Ok((filter, expectation))
    }

    /// Fuses a registered view, unless it shows nothing new.
    fn accept(
        &mut self,
        view: BuiltView,
        mut filter: PoseFilter,
        object_from_world: Translation3<f64>,
    ) {
        filter.register(&view.object_from_camera, &view.depth.surface.centroid());
        self.filter = Some((filter, object_from_world));
        let direction = view.direction();
        let is_known =
            |other: &BuiltView| other.direction().angle(&direction) < self.config.step_min_rad;
        if self.views.iter().any(is_known) {
            return;
        }
        self.fuse(view);
        if !self.is_closed && is_orbit_closed(&self.views) {
            self.finish();
            self.is_closed = true;
        }
    }

    /// Surface of the model that a camera should see.
    fn target(&self, camera: &Point3<f64>) -> Result<ViewSurface, Error> {
        let towards = camera.cast::<f32>();
        let is_facing = |point: &SurfacePoint| {
            let ray = (towards - point.place).normalize();
            point.normal.dot(&ray) > FACING_COSINE_MIN
        };
        let points = self.volume.surface_points(TARGET_WEIGHT_MIN);
        let facing: Vec<&SurfacePoint> = points.iter().filter(|p| is_facing(p)).collect();
        let places: Vec<[f32; 3]> = facing.iter().map(|p| p.place.coords.into()).collect();
        let color = |p: &&SurfacePoint| (p.color_weight >= COLOR_WEIGHT_MIN).then_some(p.color);
        let colors: Vec<Option<[u8; 3]>> = facing.iter().map(color).collect();
        let origin = Some(ViewOrigin::Camera(*camera));
        ViewSurface::with_colors(&places, &colors, origin).map_err(Error::Surface)
    }

    /// Registers a view with the surface of the model.
    fn register(
        &self,
        expectation: &Expectation,
        depth: &DepthView,
    ) -> Result<Registration, Error> {
        let Expectation { target, prior, .. } = expectation;
        let found = register(target, &depth.surface, prior).map_err(Error::Surface)?;
        match self.misfit(&found, prior, &depth.surface.centroid()) {
            Some(misfit) => Err(Error::Misfit(misfit)),
            None => Ok(found),
        }
    }

    /// Reason to refuse a registered view.
    fn misfit(&self, found: &Registration, prior: &Prior, centre: &Point3<f64>) -> Option<Misfit> {
        let percent = |share: f64| (100.0 * share).round() as u32;
        if found.common_share < self.config.common_share_min {
            return Some(Misfit::LittleOverlap {
                common_percent: percent(found.common_share),
            });
        }
        if found.contradiction > self.config.contradiction_max {
            return Some(Misfit::Contradiction {
                percent: percent(found.contradiction / 2.0),
            });
        }
        let (pose, expected) = (found.target_from_source, prior.target_from_source);
        let off_m = (pose * centre - expected * centre).norm();
        let off_rad = pose.rotation.angle_to(&expected.rotation);
        let sigmas = self.config.off_sigmas_max;
        // Three axes have a norm of up to the root of three times their standard deviation.
        let is_far = off_m > sigmas * (prior.translation_sigma_m + 0.003)
            || off_rad > sigmas * (prior.rotation_sigma_rad + 0.01);
        is_far.then(|| Misfit::FarFromPrior {
            off_mm: (1e3 * off_m).round() as u32,
            off_deg: off_rad.to_degrees().round() as u32,
        })
    }

    /// Brings all views into agreement, and fuses them again.
    pub fn finish(&mut self) {
        close_loop(&mut self.views);
        self.volume.clear();
        for view in &self.views {
            self.volume.fuse(&view.depth, &view.object_from_camera);
        }
    }

    /// Weight from which a surface counts as seen.
    fn mesh_weight_min(&self) -> f32 {
        let share = MESH_WEIGHT_SHARE * self.volume.n_views() as f32;
        share.clamp(*MESH_WEIGHT.start(), *MESH_WEIGHT.end())
    }

    /// Points of the surface, one or more a voxel.
    pub fn surface_points(&self) -> Vec<SurfacePoint> {
        self.volume.surface_points(self.mesh_weight_min())
    }

    /// Coloured mesh of the surface, in the frame of the object.
    pub fn mesh(&self) -> TriangleMesh {
        self.volume.mesh(self.mesh_weight_min())
    }
}

/// Pose of a camera that is held level, in a world whose x axis it looks along, and whose z axis is
/// up.
fn level_camera() -> Isometry3<f64> {
    let ahead = Point3::from(Vector3::x());
    Isometry3::face_towards(&Point3::origin(), &ahead, &-Vector3::z())
}

fn is_finite(pose: &Isometry3<f64>) -> bool {
    let rotation = pose.rotation.coords.iter();
    rotation
        .chain(&pose.translation.vector)
        .all(|value| value.is_finite())
}
