//! Construction of an object model from views, one after the other.

mod view_registration;

use crate::Error;
use crate::config::Config;
use crate::depth_view::DepthView;
use crate::loop_closure::{close_loop, is_orbit_closed};
use crate::placement::RestingPlacement;
use crate::surface_points::SurfacePoint;
use crate::tsdf_volume::TsdfVolume;
use crate::view::{BuiltView, View};
use mesh::TriangleMesh;
use nalgebra::Translation3;
use registration::Registration;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Weight of the surface of the mesh, as a share of the number of views, and its limits. Chosen:
/// what only one of many views saw is noise.
const MESH_WEIGHT_SHARE: f32 = 0.02;
const MESH_WEIGHT: std::ops::RangeInclusive<f32> = 0.1..=3.0;

/// Object model under construction.
///
/// The frame of the object has the axes of the world, and its origin in the centre of the first
/// view. Without a camera pose the first view counts as that of a level camera, or of one with the
/// up direction that is known.
#[derive(Debug)]
pub struct ModelBuilder {
    config: Config,
    volume: TsdfVolume,
    views: Vec<BuiltView>,
    placement: Option<RestingPlacement>,
    is_closed: bool,
    stop: Arc<AtomicBool>,
}

impl ModelBuilder {
    /// Model without views.
    pub fn new(config: Config) -> Self {
        Self {
            volume: TsdfVolume::new(config.voxel_m),
            config,
            views: Vec::new(),
            placement: None,
            is_closed: false,
            stop: Arc::default(),
        }
    }

    /// This model, which stops bringing its views into agreement when the flag is set.
    #[must_use]
    pub fn stopped_by(mut self, stop: Arc<AtomicBool>) -> Self {
        self.stop = stop;
        self
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
    /// fit to the few before them in a placement, those were bad and are removed; a model without
    /// other views begins anew with this one.
    ///
    /// *Cost*: milliseconds to tens of milliseconds for a view of 10 000 points; some seconds when
    /// the loop closes.
    ///
    /// # Errors
    /// When the view cannot be used, or does not fit.
    pub fn add(&mut self, view: &View<'_>) -> Result<Option<Registration>, Error> {
        if !view.is_pose_finite() {
            return Err(Error::PoseNotFinite);
        }
        let depth = DepthView::new(view.points, view.camera, self.config.depth_noise)?;
        let found = match self.placement.clone() {
            None => {
                self.begin(view, depth);
                return Ok(None);
            }
            Some(placement) if placement.is_of(view) => self.follow(placement, view, &depth),
            Some(last) => self.place_anew(last, view, &depth),
        };
        let (placement, placed) = match found {
            Ok(found) => found,
            Err(error) => {
                if self.note_refused(view) {
                    self.take_back_placement();
                    return self.add(view);
                }
                return Err(error);
            }
        };
        let registration = placed.registration;
        let built = BuiltView {
            captured_ns: view.captured_ns,
            object_from_camera: registration.target_from_source,
            reported: placed.reported.object_from_camera,
            expected: placed.expected,
            sigma: placed.reported.sigma,
            depth,
        };
        self.accept(built, placement);
        Ok(Some(registration))
    }

    /// Notes a refused view; `true` if its placement must be bad.
    fn note_refused(&mut self, view: &View<'_>) -> bool {
        let placement = self.placement.as_mut().filter(|last| last.is_of(view));
        placement.is_some_and(RestingPlacement::note_refused)
    }

    /// Removes the views of the present placement; the one before it is the last one again.
    fn take_back_placement(&mut self) {
        let Some(placement) = self.placement.take() else {
            return;
        };
        self.views.truncate(placement.first_view);
        self.placement = placement.previous();
        if self.views.is_empty() {
            *self = Self::new(self.config).stopped_by(self.stop.clone());
        } else {
            self.fuse_again();
        }
    }

    /// Begins the model with its first view.
    fn begin(&mut self, view: &View<'_>, depth: DepthView) {
        let world_from_camera = view.world_from_camera();
        let centre = world_from_camera * depth.surface.centroid();
        let object_from_camera = Translation3::from(-centre.coords) * world_from_camera;
        self.placement = Some(RestingPlacement::new(
            view,
            object_from_camera,
            self.views.len(),
        ));
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
        self.volume.fuse(&view.depth, &view.object_from_camera);
        self.views.push(view);
    }

    /// Fuses a registered view, unless it shows nothing new.
    fn accept(&mut self, view: BuiltView, placement: RestingPlacement) {
        self.placement = Some(placement);
        let direction = view.direction();
        let is_known =
            |other: &BuiltView| other.direction().angle(&direction) < self.config.step_min_rad;
        if self.views.iter().any(is_known) {
            return;
        }
        self.fuse(view);
        if !self.is_closed && is_orbit_closed(&self.views) {
            self.is_closed = self.finish();
        }
    }

    /// Brings all views into agreement, and fuses them again; `false` if it was stopped, which
    /// leaves the model as it is.
    ///
    /// *Cost*: some seconds.
    pub fn finish(&mut self) -> bool {
        let is_agreed = close_loop(&mut self.views, &self.stop);
        if is_agreed {
            self.fuse_again();
        }
        is_agreed
    }

    fn fuse_again(&mut self) {
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
