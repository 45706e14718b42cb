//! Registration of a view with the model: of an object that stands still, and of one that was
//! turned.

use super::ModelBuilder;
use crate::Error;
use crate::depth_view::DepthView;
use crate::error::Misfit;
use crate::facing_surface::facing_surface;
use crate::placement::{ReportedPose, RestingPlacement, UNKNOWN_SIGMA};
use crate::surface_points::SurfacePoint;
use crate::turn_search::TurnSearch;
use crate::view::View;
use nalgebra::{Isometry3, Point3, Vector3};
use registration::{Prior, Registration, ViewSurface, register};

/// Weight of the surface to which a view is registered. Chosen: one pixel at 45° and 1.8 m.
const TARGET_WEIGHT_MIN: f32 = 0.1;

/// Registered view, before it is fused.
#[derive(Debug)]
pub(super) struct PlacedView {
    pub(super) registration: Registration,
    pub(super) expected: Isometry3<f64>,
    pub(super) reported: ReportedPose,
}

impl ModelBuilder {
    /// Registers a view of an object that stands still: with the motion so far, the reported pose,
    /// and the place at which the camera sees the object.
    pub(super) fn follow(
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
    pub(super) fn place_anew(
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
}
