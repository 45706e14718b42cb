//! Grasp scene of a snapshot.

use crate::model_contacts::model_contacts;
use geometry::{Capsule, ConvexPolygon};
use grasping::{GraspObject, GraspScene, ObservedSpace, SupportPlane};
use message::SurfaceKind;
use nalgebra::{Point2, Point3};
use scene_client::{ModelShelf, PlanningFrame, SceneSurface, Snapshot};

/// Height over the objects from which a place is above every surface, metres.
const OVERHEAD_M: f64 = 100.0;
/// Half side of a surface of whose outline nothing is known, metres.
const WIDE_M: f64 = 3.0;

/// Bodies of people and of the robot, capsules in the world.
#[derive(Debug, Clone, Default)]
pub struct SceneBodies {
    /// Bodies of people.
    pub people: Vec<Capsule>,
    /// Links of the robot's arm.
    pub robot: Vec<Capsule>,
}

/// Grasp scene of a snapshot in a frame of planning. Objects whose stored model fits have its
/// surface.
pub fn grasp_scene<'a>(
    snapshot: &'a Snapshot,
    frame: &PlanningFrame,
    shelf: &ModelShelf,
    bodies: &SceneBodies,
) -> GraspScene<'a> {
    let space = ObservedSpace::new(snapshot.camera, frame.plan_from_camera, &snapshot.points);
    let thinned = snapshot.thinned();
    let objects = snapshot.objects.iter().map(|object| GraspObject {
        track: object.track,
        points_in_camera: object.points.clone(),
        model: match shelf.place(object, &thinned) {
            Ok(Some(placed)) => {
                let pose = frame.plan_from_camera * placed.pose.camera_from_model;
                model_contacts(placed.mesh, &pose)
            }
            Ok(None) | Err(_) => Vec::new(),
        },
    });
    let surfaces = snapshot.surfaces.iter();
    let plan_from_world = frame.world_from_plan.inverse();
    let in_plan = |bodies: &[Capsule]| -> Vec<Capsule> {
        bodies
            .iter()
            .map(|body| body.transformed(&plan_from_world))
            .collect()
    };
    GraspScene::new(
        space,
        objects.collect(),
        surfaces.map(|surface| support(surface, frame)).collect(),
        in_plan(&bodies.people),
        in_plan(&bodies.robot),
    )
}

fn support(surface: &SceneSurface, frame: &PlanningFrame) -> SupportPlane {
    let plan_from_world = frame.world_from_plan.inverse();
    let corners = surface.corners_in_world.iter();
    let mut corners: Vec<Point2<f64>> = corners
        .map(|corner| (plan_from_world * corner).xy())
        .collect();
    if corners.len() < 3 {
        let wide = [-WIDE_M, WIDE_M];
        corners = wide
            .iter()
            .flat_map(|x| wide.map(|y| Point2::new(*x, y)))
            .collect();
    }
    let name = match surface.kind {
        SurfaceKind::Table => "the table",
        SurfaceKind::Level | SurfaceKind::NewLevel => "another level",
        SurfaceKind::Floor => "the floor",
    };
    SupportPlane {
        plane: surface
            .plane_in_world
            .transformed(&plan_from_world)
            .facing(&Point3::new(0.0, 0.0, OVERHEAD_M)),
        outline: ConvexPolygon::convex_hull_of(&mut corners),
        name: name.to_owned(),
        is_solid_below: matches!(surface.kind, SurfaceKind::Table | SurfaceKind::Floor),
    }
}
