//! Placements of an object: between two of them somebody has turned or moved it.

use crate::frame_error::FrameError;
use crate::pose_filter::{PoseFilter, PoseSigma};
use crate::view::View;
use nalgebra::{Isometry3, Point3};
use registration::{Prior, ViewSurface};
use std::sync::Arc;

/// Standard deviation of the difference between the middle of a view and that of the part of the
/// model that its camera should see, metres. Chosen: a view shows what the model does not have
/// yet, and the reverse.
const MIDDLE_SIGMA_M: f64 = 0.012;

/// Number of views that may be bad, and of the views in a row that then do not fit. Chosen.
const N_BEGINNING_VIEWS: usize = 3;
const N_REFUSED_MAX: u32 = 4;

/// Uncertainty of a pose that is not reported: so large that it tells nothing.
pub(crate) const UNKNOWN_SIGMA: PoseSigma = PoseSigma {
    rotation_rad: 10.0,
    translation_m: 10.0,
};

/// Object in its place: its views are related by the poses of the camera.
#[derive(Debug, Clone)]
pub(crate) struct RestingPlacement {
    /// Number as the views give it.
    pub(crate) number: u32,
    /// Index of its first view in the model.
    pub(crate) first_view: usize,
    /// Pose of the world in the frame of the object.
    pub(crate) object_from_world: Isometry3<f64>,
    filter: PoseFilter,
    frame_error: FrameError,
    /// Number of views that fitted, also of those that showed nothing new.
    n_fitting: usize,
    /// Number of refused views since the last one that fitted.
    n_refused: u32,
    /// Placement before it.
    previous: Option<Arc<RestingPlacement>>,
}

/// Pose of a view that a robot reports, in the frame of the object, with its uncertainty; one that
/// tells nothing where it is not known.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ReportedPose {
    pub(crate) object_from_camera: Isometry3<f64>,
    pub(crate) sigma: PoseSigma,
}

impl RestingPlacement {
    /// Placement by its first view, whose pose in the frame of the object is known, and whose index
    /// in the model is given.
    pub(crate) fn new(
        view: &View<'_>,
        object_from_camera: Isometry3<f64>,
        first_view: usize,
    ) -> Self {
        Self {
            number: view.placement,
            first_view,
            object_from_world: object_from_camera * view.world_from_camera().inverse(),
            filter: PoseFilter::new(object_from_camera, &view.sigma, view.captured_ns),
            frame_error: FrameError::new(),
            n_fitting: 1,
            n_refused: 0,
            previous: None,
        }
    }

    /// This placement after another one.
    pub(crate) fn after(mut self, previous: Self) -> Self {
        self.previous = Some(Arc::new(previous));
        self
    }

    /// Placement before this one; `None` for the first one.
    pub(crate) fn previous(self) -> Option<Self> {
        self.previous.map(Arc::unwrap_or_clone)
    }

    /// `true` for a further view of this placement.
    pub(crate) fn is_of(&self, view: &View<'_>) -> bool {
        self.number == view.placement
    }

    /// Expects a view by the motion so far and the reported pose; returns the expected place of the
    /// camera in the frame of the object.
    pub(crate) fn expect(&mut self, view: &View<'_>) -> Point3<f64> {
        self.filter.predict(view.captured_ns);
        if let Some(reported) = self.reported(view) {
            let (corrected, sigma) = self.frame_error.corrected(&reported, &view.sigma);
            self.filter.observe(&corrected, &sigma);
        }
        self.filter.camera_place()
    }

    /// Prior of an expected view: the camera sees the middle of its points where the middle of the
    /// model should be.
    pub(crate) fn prior(&mut self, seen: &Point3<f64>, middle: &Point3<f64>) -> Prior {
        self.filter.see(seen, middle, MIDDLE_SIGMA_M);
        self.filter.prior(seen)
    }

    /// Notes a view that fitted, by its registered pose and its surface in the frame of the camera;
    /// returns the reported pose.
    pub(crate) fn note_fitting(
        &mut self,
        view: &View<'_>,
        registered: &Isometry3<f64>,
        surface: &ViewSurface,
    ) -> Option<ReportedPose> {
        let sigma = PoseSigma::of_registration(surface.noise_m());
        self.filter
            .register(registered, &surface.centroid(), &sigma);
        self.n_fitting += 1;
        self.n_refused = 0;
        let reported = self.reported(view)?;
        self.frame_error.add(registered, &reported);
        Some(ReportedPose {
            object_from_camera: reported,
            sigma: view.sigma,
        })
    }

    /// Notes a refused view; `true` if so many in a row did not fit that the few that fitted must
    /// be bad.
    pub(crate) fn note_refused(&mut self) -> bool {
        self.n_refused += 1;
        self.n_fitting <= N_BEGINNING_VIEWS && self.n_refused > N_REFUSED_MAX
    }

    fn reported(&self, view: &View<'_>) -> Option<Isometry3<f64>> {
        view.world_from_camera
            .map(|pose| self.object_from_world * pose)
    }
}
