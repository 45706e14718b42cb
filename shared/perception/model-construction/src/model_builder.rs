//! Construction of an object model from views, one after the other.

use crate::Error;
use crate::config::Config;
use crate::depth_view::DepthView;
use crate::error::Misfit;
use crate::facing_surface::facing_surface;
use crate::loop_closure::{close_loop, is_orbit_closed};
use crate::placement::{ReportedPose, RestingPlacement, UNKNOWN_SIGMA};
use crate::surface_points::SurfacePoint;
use crate::tsdf_volume::TsdfVolume;
use crate::turn_search::TurnSearch;
use crate::view::{BuiltView, View};
use mesh::TriangleMesh;
use nalgebra::{Isometry3, Point3, Translation3, Vector3};
use registration::{Prior, Registration, ViewSurface, register};

/// Weight of the surface to which a view is registered. Chosen: one pixel at 45° and 1.8 m.
const TARGET_WEIGHT_MIN: f32 = 0.1;

/// Weight of the surface of the mesh, as a share of the number of views, and its limits. Chosen:
/// what only one of many views saw is noise.
const MESH_WEIGHT_SHARE: f32 = 0.02;
const MESH_WEIGHT: std::ops::RangeInclusive<f32> = 0.1..=3.0;

/// Registered view, before it is fused.
#[derive(Debug)]
struct PlacedView {
    registration: Registration,
    expected: Isometry3<f64>,
    reported: ReportedPose,
}

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
            *self = Self::new(self.config);
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

    /// Registers a view of an object that stands still: with the motion so far, the reported pose,
    /// and the place at which the camera sees the object.
    fn follow(
        &self,
        mut placement: RestingPlacement,
        view: &View<'_>,
        depth: &DepthView,
    ) -> Result<(RestingPlacement, PlacedView), Error> {
        let camera = placement.expect(view);
        let middle = depth.surface.centroid();
        let target = facing_surface(&self.target_points(), &camera)?;
        let prior = placement.prior(&middle, &target.centroid());
        let registration = self.register(&target, &depth.surface, &prior)?;
        let registered = registration.target_from_source;
        let reported = placement.note_fitting(view, &registered, &depth.surface);
        let placed = PlacedView {
            registration,
            expected: prior.target_from_source,
            reported: reported.unwrap_or(ReportedPose {
                object_from_camera: prior.target_from_source,
                sigma: UNKNOWN_SIGMA,
            }),
        };
        Ok((placement, placed))
    }

    /// Finds the placement of an object that was turned or moved, by the first view of it there.
    fn place_anew(
        &self,
        last: RestingPlacement,
        view: &View<'_>,
        depth: &DepthView,
    ) -> Result<(RestingPlacement, PlacedView), Error> {
        let points = self.target_points();
        let sum = points.iter().map(|point| point.place.coords.cast::<f64>());
        let middle = Point3::from(sum.sum::<Vector3<f64>>() / points.len().max(1) as f64);
        let last_pose = last.object_from_world * view.world_from_camera();
        let n_turns = view.placement.wrapping_sub(last.number);
        let search = TurnSearch {
            object_from_camera: last_pose,
            middle,
            expected_rad: self.config.turn_rad.map(|turn| turn * f64::from(n_turns)),
        };
        let target = |camera: &Point3<f64>| facing_surface(&points, camera);
        let turned = search
            .run(&depth.surface, target)
            .ok_or(Error::Misfit(Misfit::NoTurn))?;
        let registration = turned.registration;
        let found = registration.target_from_source;
        let placed = PlacedView {
            registration,
            expected: turned.expected,
            reported: ReportedPose {
                object_from_camera: last_pose,
                sigma: UNKNOWN_SIGMA,
            },
        };
        let placement = RestingPlacement::new(view, found, self.views.len()).after(last);
        Ok((placement, placed))
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
            self.finish();
            self.is_closed = true;
        }
    }

    /// Surface of the model to which views are registered.
    fn target_points(&self) -> Vec<SurfacePoint> {
        self.volume.surface_points(TARGET_WEIGHT_MIN)
    }

    /// Registers a view with the surface that it should show.
    fn register(
        &self,
        target: &ViewSurface,
        view: &ViewSurface,
        prior: &Prior,
    ) -> Result<Registration, Error> {
        let found = register(target, view, prior).map_err(Error::Surface)?;
        let sigmas = self.config.off_sigmas_max;
        let misfit = self.misfit(&found);
        let misfit = misfit.or_else(|| Misfit::far_from(prior, &found, view, sigmas));
        misfit.map_or(Ok(found), |misfit| Err(Error::Misfit(misfit)))
    }

    /// Reason to refuse a registered view, by what model and view have in common.
    fn misfit(&self, found: &Registration) -> Option<Misfit> {
        let least = self.config.common_share_min;
        Misfit::in_surface(found, least, self.config.contradiction_max)
    }

    /// Brings all views into agreement, and fuses them again.
    pub fn finish(&mut self) {
        close_loop(&mut self.views);
        self.fuse_again();
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
